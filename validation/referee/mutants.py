"""Which mistakes has a hypothesis for: `python -m validation.referee.mutants [CODE...] [--seed S] [--max N] [--ask N]`.

Mutation analysis of the codes in `tests/crosscheck/unseen` (and `recursive`): so many mutants of each code are drawn
(`mutations.py` says which there are), run at two states of the probe, and every wrong term is compared with what all
single hypotheses predict.  Codes that are not asked keep their figures.  The predictions take half a minute of
processor time, once for all codes of one convention, and 200 mutants of a code half a minute; `--ask` takes some 15 s
for each mutant.
Writes mutants.json and mutants.md beside this file; each mutant that is not explained is printed.
"""

from __future__ import annotations

import argparse
import json
import random
import signal
import sys
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.rules.composed import PARTS
from dualpin.crosscheck.diagnosis.rules.register import RULES, Rule
from dualpin.crosscheck.diagnosis.scores import scaled
from dualpin.crosscheck.diagnosis.textbook.slipped import made_of
from dualpin.crosscheck.subjects import QUESTIONS, Asking, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.unseen_codes import CODES, FLOATING, source

from .mutations import Mutant, Source
from .units import rescaled

HERE = Path(__file__).parent
FILE = HERE / "mutants.json"
ROOT = HERE.parents[1]
PROBE = str(ROOT / "urdf/probe/probe.urdf")
ALL = (*CODES, "recursive")
SECONDS = 5.0
"""Of one mutant: a loop that was spoiled may never end."""
SHOWS, EXACT = 1e-7, 1e-8
"""Scaled errors: of a term that is wrong, and of a prediction that explains it; rounding stays below 1e-10."""
OPERATORS = {
    "left out": "a term of a sum, a number or a rotation in a product, what a loop adds",
    "sign": "+ for -, - for +, a minus left out", "order": "the operands of @ or x exchanged",
    "transposed": "a square matrix transposed, or a transposition left out", "by elements": "* for @",
    "not added": "= for +=", "case": "a condition taken as always or never true",
    "one fewer": "a loop without its first or last turn", "sine": "sin for cos, cos for sin",
    "another": "a name, an index or an attribute of the same kind and unit in the place of one (of all, one drawn)",
}  # fmt: skip
Answered = dict[str, np.ndarray]


class Hangs(BaseException):
    """No error of the subject's own: it must not be taken for its answer."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """An end to what takes longer, where the system has a timer for it."""

    def stop(*_: Any) -> None:
        raise Hangs

    if not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def code(name: str) -> Source:
    """One of the committed codes."""
    if name == "recursive":
        return Source((ROOT / "tests/crosscheck/recursive.py").read_text(), "Recursive")
    return Source(source(name))


class Predictions:
    """What single hypotheses predict of right answers, term by term: made once for each way of writing."""

    def __init__(self, case: Case, terms: Sequence[str], rules: Sequence[Rule] = RULES) -> None:
        rng = np.random.default_rng(0)  # rules look for wrong answers only
        wrong = {t: case.observed[t] + rng.normal(size=case.observed[t].shape) for t in terms}
        self.right = {t: case.observed[t] for t in terms}
        self.told: dict[str, tuple[np.ndarray, list[Hypothesis]]] = {}
        case = Case(replace(case.answers, terms=wrong))
        proposed = [h for rule in rules for h in rule.propose(case)]
        proposed = [h for h in proposed if h.place != "relation" and not (h.made_of or h.afterwards)]
        for term, x in self.right.items():
            mine = [h for h in proposed if term in h.terms]
            slips = {
                made_of(h.act, term): h for h in mine if h.place == "formula"
            }  # one of those that predict the same
            some = [*slips.values(), *(h for h in mine if h.place != "formula")]
            both = zip(case.predictions(term, [(h,) for h in some]), some, strict=True)
            fits = [(p, h) for p, h in both if p is not None and p.shape == x.shape and np.isfinite(p).all()]
            self.told[term] = np.array([p.ravel() for p, _ in fits]).reshape(len(fits), x.size), [h for _, h in fits]

    def of(self, term: str, x: np.ndarray) -> list[Hypothesis]:
        """The hypotheses that predict an answer."""
        told, some = self.told[term]
        apart = np.abs(told - x.ravel()).max(axis=1) / max(1.0, float(np.abs(x).max()))
        return [some[k] for k in np.flatnonzero(apart < EXACT)]


def answers(made: Any, ask: Asking) -> Case:
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        return Case(ask_here(made(ask.text, floating=ask.floating), ask, lambda what: None))


def whole(case: Case) -> Answered:
    """The terms that were answered for every state, with finite numbers."""
    return {t: x for t, x in case.observed.items() if np.isfinite(x).all()}


def unexplained(case: Case, off: Sequence[str], predictions: Predictions) -> list[str]:
    """Of wrong terms, those that no hypothesis predicts, and that do not follow from others that one does."""
    told = {t for t in off if predictions.of(t, case.observed[t])}
    rest = [t for t in off if t not in told]
    rule = next(r for r in RULES if r.key == "follows")
    composed = any(set(PARTS.get(t, ())) & told for t in rest)
    follows = [h for h in rule.propose(case) if h.key == "follows"] if composed else []
    before = -1
    while len(told) != before:  # what follows from what follows
        before = len(told)
        known = [h for h in follows if h.terms[0] not in told and set(h.made_of) <= told]
        told |= {h.terms[0] for h in known if case.score(h.terms[0], (h,)).right}
    return [t for t in off if t not in told]


class Drawn:
    """Mutants of one code in an order drawn by seed, with what they make wrong."""

    def __init__(self, name: str, seed: int, ask: Asking) -> None:
        self.source, self.ask = code(name), ask
        for units in (ask, rescaled(ask)):
            answers(self.source.noting(), units)
        self.mutants = self.source.mutants(random.Random(f"{name} {seed}"))
        self.right = answers(self.source.right(), ask)
        self.terms = [t for t in whole(self.right) if self.right.score(t).right]

    def run(self, mutant: Mutant) -> tuple[Case | None, list[str]]:
        """What it answers, and which terms are wrong; None where it does not run."""
        try:
            with limited(SECONDS):
                case = answers(self.source.mutated(mutant), self.ask)
        except (Hangs, Exception):  # whatever a spoiled code raises
            return None, []
        found = whole(case)
        if any(t not in found or found[t].shape != self.right.observed[t].shape for t in self.terms):
            return None, []
        return case, [t for t in self.terms if scaled(found[t], self.right.observed[t]) > SHOWS]


@cache
def asked(floating: bool, samples: int = 2) -> Asking:
    return asking(PROBE, samples, 0, tuple(QUESTIONS), floating=floating)


def analysed(drawn: Drawn, name: str, most: int, kept: dict[Any, Predictions]) -> dict[str, Any]:
    """How many of a code's mutants run, show, and are explained; those that are not are printed."""
    key = drawn.right.how, tuple(drawn.terms), drawn.ask.floating
    if key not in kept:
        kept[key] = Predictions(drawn.right, drawn.terms)
    ran, shown, explained = Counter[str](), Counter[str](), Counter[str]()
    for mutant in drawn.mutants[:most]:
        case, off = drawn.run(mutant)
        ran[mutant.operator] += case is not None
        if case is None or not off:
            continue
        shown[mutant.operator] += 1
        rest = unexplained(case, off, kept[key])
        explained[mutant.operator] += not rest
        if rest:
            print(f"{name} {mutant}; wrong {len(off)}, unexplained {', '.join(rest)}", flush=True)
    counts = {"ran": ran, "shown": shown, "explained": explained}
    all_of_them = Counter(m.operator for m in drawn.mutants[:most])
    return {"there": len(drawn.mutants), "drawn": all_of_them, **counts}


def told(drawn: Drawn, name: str, many: int) -> list[dict[str, Any]]:
    """What `dp.judge` says of so many mutants that show: to be read."""
    found: list[dict[str, Any]] = []
    for mutant in drawn.mutants:
        if len(found) >= many:
            break
        _, off = drawn.run(mutant)
        if not off:
            continue
        subject = drawn.source.mutated(mutant)(drawn.ask.text, floating=drawn.ask.floating)
        result = dp.judge(PROBE, subject, floating=drawn.ask.floating).robots[0]
        findings = {(f.key, str(f)): f for t in result.terms for f in t.findings}.values()
        explained = {t for f in findings if f.key != "partly" for t in f.terms}
        rest = [t for t in off if t not in explained]
        said = [f"{f.key}: {f.says} ({', '.join(f.terms)})" for f in findings]
        found.append({"code": name, "mutant": str(mutant), "said": said, "open": rest})
        print(f"{name} {mutant}", *said, f"open: {', '.join(rest) or 'nothing'}", sep="\n   ", flush=True)
    return found


def write(results: Mapping[str, Any]) -> None:
    """The page, from what is kept."""
    by_code = {k: x for k, x in results.items() if "drawn" in x}
    lines = [
        "# Mutants", "",
        "`python -m validation.referee.mutants` does one step of a code wrongly at a time, by the operators below,",
        "runs it at two states of the probe, and looks whether a single hypothesis predicts every wrong term to 1e-8,",
        "or whether the term follows from terms that are so predicted. This is mutation analysis (DeMillo, Lipton and",
        "Sayward, 1978). It says whether such a hypothesis *exists*, for mistakes that nobody chose. It does not say",
        "that the search tells it: several hypotheses may predict the same, a term may need two, and a user's question",
        "has a limit of time. Rules were written for kinds of mutants that were unexplained, of these codes among",
        "others, so the figures are no blind test. A mutant that *shows* changes an answer; *ran* leaves out",
        "those that raise, hang, or answer something that is no number.", "",
        *[f"- *{k}*: {says}" for k, says in OPERATORS.items()], "",
        "| code | seed | mutants | drawn | ran | show | explained | share |", "|---|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    total: dict[str, Counter[str]] = {k: Counter() for k in ("drawn", "ran", "shown", "explained")}
    for name, x in by_code.items():
        for k, counts in total.items():
            counts.update(x[k])
        lines.append(
            f"| {name} | {x['seed']} | {x['there']} | {' | '.join(_cells({k: sum(x[k].values()) for k in total}))} |"
        )
    lines.append(f"| all | | | {' | '.join(_cells({k: sum(c.values()) for k, c in total.items()}))} |")
    lines += ["", "| operator | drawn | ran | show | explained | share |", "|---|---|---|---|---|---|"]
    lines += [f"| {op} | {' | '.join(_cells({k: c[op] for k, c in total.items()}))} |" for op in OPERATORS]
    tried = [one for x in results.values() for one in x.get("told", ())]
    if tried:
        full = sum(not one["open"] for one in tried)
        lines += [
            "", "## Asked as a user would", "",
            f"{len(tried)} of the mutants that show, drawn by seed, judged by `dp.judge` with 16 states: {full} have a",
            "cause for every wrong term. Whether the cause is the mistake must be read.", "",
            "| code and mutant | said | no cause |", "|---|---|---|",
            *(f"| {_cell(o['code'])}: {_cell(o['mutant'])} | {_cell('; '.join(o['said']))} | {', '.join(o['open'])} |"
              for o in tried),
        ]  # fmt: skip
    (HERE / "mutants.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _cells(n: Mapping[str, int]) -> list[str]:
    share = f"{100 * n['explained'] / n['shown']:.0f} %" if n["shown"] else "-"
    return [*(str(n[k]) for k in ("drawn", "ran", "shown", "explained")), share]


def _cell(text: str) -> str:
    return text.replace("<", "&lt;").replace("|", "\\|")


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(prog="python -m validation.referee.mutants", description=__doc__.split(":")[0])
    parser.add_argument("codes", nargs="*", metavar="CODE", help=f"of {', '.join(ALL)}; all by default")
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--max", type=int, default=200, metavar="N", help="mutants of each code")
    parser.add_argument("--ask", type=int, metavar="N", help="judge N mutants of each code in full, instead")
    given = parser.parse_args(arguments)
    unknown = [c for c in given.codes if c not in ALL]
    if unknown:
        parser.error(f"no such code: {', '.join(unknown)}; there are {', '.join(ALL)}")
    results: dict[str, Any] = json.loads(FILE.read_text()) if FILE.exists() else {}
    predictions: dict[Any, Predictions] = {}
    for name in given.codes or ALL:
        drawn = Drawn(name, given.seed, asked(name in FLOATING))
        entry = results.setdefault(name, {})
        if given.ask:
            entry["told"] = told(drawn, name, given.ask)
        else:
            entry |= {"seed": given.seed, **analysed(drawn, name, given.max, predictions)}
            print(
                f"{name}: {sum(entry['explained'].values())} of {sum(entry['shown'].values())} explained",
                file=sys.stderr,
            )
        FILE.write_text(json.dumps(results, indent=1) + "\n")
        write(results)


if __name__ == "__main__":
    main(sys.argv[1:])
