"""How many mistakes are named that nobody knew: `python -m validation.referee.unseen [ROBOT...]`.

Ten codes of other people's kinds (`tests/crosscheck/unseen_codes.py`) make one mistake at a time, or two.  What is
asked already (unseen.json) is kept, so an interrupted run continues; `--again` asks all again, and what was read of
the answers before goes with them.  Writes unseen.json and unseen.md beside this file; `--page` asks nothing.
`--read GROUP` asks mistakes of three more codes, of which a sentence tells what counts, and prints all to be read.
"""

from __future__ import annotations

import json
import os
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from dualpin.crosscheck.diagnosis import Case, Diagnosis, diagnose
from dualpin.crosscheck.findings import Finding
from dualpin.crosscheck.subjects import QUESTIONS, Asking, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.unseen_codes import BESIDES, CAN_FLOAT, MISTAKES, READ, SENTENCES, Mistake, written

HERE = Path(__file__).parent
FILE = HERE / "unseen.json"
PROBE = str(HERE.parents[1] / "urdf/probe/probe.urdf")
ROBOTS = {"probe": PROBE, "panda": "panda", "ur5": "ur5", "solo8": "solo8", "solo12": "solo12"}
ALWAYS_FLOATING = {"solo8", "solo12"}
SAMPLES = 8
MEANINGS = {
    "invisible": "nothing on this robot depends on it",
    "named": "by what it is, in all terms, and nothing else is said",
    "in part": "by what it is, and nothing else is said, but a term stays without a cause",
    "unnamed": "no cause is given; rows, entries or frames are",
    "other": "something else is said, alone or besides: wrong, or another description of the same",
}
"""The verdicts."""
READINGS = {
    "in full": "the cause is said, all terms that differ because of it are explained, nothing untrue is said",
    "equivalent": "another sentence, which is the same mathematics; all terms are explained",
    "in part": "the cause is said, for some terms (or of one of two mistakes)",
    "located": "where it is, in rows, frames or joints, or a fit, but no cause",
    "false": "something untrue is said, alone or besides",
}
"""The verdicts of those who read all answers."""
GOES_WITH = {
    "named": {"in full"},
    "in part": {"in part", "false"},
    "unnamed": {"in part", "located", "false"},
    "other": {"in part", "equivalent", "located", "false"},
}
"""What can have been read where the expressions say so: they take a sentence that says nearly, or for some terms, as
nothing said, and a fit as a cause."""


BY_READING = {
    "composite bodies, first half": ("3a482de", 14, 2, 2, 6, 1),
    "composite bodies, second half": ("efb2491", 24, 1, 1, 4, 0),
    "composite bodies, further 30": ("efb2491", 19, 1, 0, 8, 2),
    "composite bodies, third 30": ("4518e1b, another reader", 25, 1, 1, 3, 0),
    "exponentials, first half": ("3a482de", 4, 1, 0, 7, 0),
    "exponentials, second half": ("efb2491", 10, 0, 0, 4, 1),
    "exponentials, 15 more": ("4518e1b, another reader", 5, 1, 0, 9, 0),
    "Jacobians of links, first half": ("3a482de", 8, 1, 1, 2, 0),
    "Jacobians of links, second half": ("efb2491", 13, 1, 1, 0, 0),
    "Jacobians of links, 15 more": ("4518e1b, another reader", 10, 2, 0, 2, 1),
    "Jacobians of links, floating base": ("efb2491", 3, 0, 0, 1, 0),
    "pairs of all three": ("efb2491", 5, 3, 6, 2, 0),
    "world axes, first question": ("d04124b", 13, 2, 3, 2, 0),
    "world axes, second question": ("2adc14f", 22, 1, 2, 0, 0),
    "world axes, 23 more": ("2adc14f", 17, 4, 1, 1, 0),
    "world axes, pairs, first question": ("d04124b", 2, 2, 2, 0, 0),
    "world axes, pairs, second question": ("2adc14f", 2, 1, 5, 0, 0),
    "body twists, first question": ("d04124b", 6, 2, 2, 2, 0),
    "body twists, second question": ("2adc14f", 8, 2, 2, 1, 0),
    "body twists, 12 more": ("2adc14f", 9, 1, 1, 0, 1),
    "spatial vectors, first question": ("d04124b", 8, 1, 3, 0, 0),
    "spatial vectors, second question": ("2adc14f", 7, 3, 1, 1, 0),
    "spatial vectors, 12 more": ("2adc14f", 3, 3, 2, 4, 0),
    "spatial vectors, floating base": ("d04124b, 2adc14f", 5, 2, 1, 0, 0),
    "body twists and spatial vectors, pairs, first question": ("d04124b", 3, 2, 1, 0, 0),
    "body twists and spatial vectors, pairs, second question": ("2adc14f", 2, 0, 4, 2, 0),
    "merged bodies, first question": ("8a24c7f", 14, 1, 1, 3, 1),
    "merged bodies, 20 at the end": ("e663a6f, another reader", 14, 2, 0, 2, 2),
    "merged bodies, pairs, first question": ("8a24c7f", 3, 0, 6, 5, 0),
    "merged bodies, pairs, 14 at the end": ("e663a6f, another reader", 9, 3, 2, 0, 0),
    "homogeneous matrices, first question": ("8a24c7f", 3, 3, 10, 3, 1),
    "homogeneous matrices, 20 at the end": ("e663a6f, another reader", 14, 6, 0, 0, 0),
    "homogeneous matrices, pairs, first question": ("8a24c7f", 0, 0, 10, 2, 2),
    "homogeneous matrices, pairs, 14 at the end": ("e663a6f, another reader", 7, 3, 3, 0, 1),
    "lab arm, first 40": ("207259d, another reader", 33, 5, 0, 2, 0),
    "lab arm, second 40": ("781f37e, another reader", 22, 6, 0, 10, 2),
    "lab arm, 36 more": ("7c17032, another reader", 27, 5, 1, 2, 1),
    "lab arm, pairs, 20 at the end": ("7c17032, another reader", 6, 4, 7, 1, 2),
    "lumped arm, first 40": ("fa393e5, another reader", 26, 5, 3, 5, 1),
    "lumped arm, pairs, first 20": ("fa393e5, another reader", 13, 2, 5, 0, 0),
    "walks to the root, first 40": ("7f08234, another reader", 31, 5, 0, 2, 2),
    "walks to the root, pairs, first 20": ("7f08234, another reader", 12, 1, 5, 1, 1),
    "lumped arm, second 40": ("97b1c88, another reader", 30, 7, 1, 0, 2),
    "lumped arm, pairs, second 20": ("97b1c88, another reader", 12, 4, 3, 0, 1),
    "walks to the root, second 40": ("f384c82, another reader", 31, 5, 2, 1, 1),
    "walks to the root, pairs, second 20": ("f384c82, another reader", 13, 4, 3, 0, 0),
    "lumped arm, third 40": ("f384c82, another reader", 33, 6, 0, 1, 0),
    "walks to the root, 40 at the end": ("95b1b3c, another reader", 29, 8, 1, 2, 0),
    "lumped arm, 40 at the end": ("95b1b3c, another reader", 33, 6, 1, 0, 0),
    "both, pairs of all their mistakes, 40": ("f44941e, another reader", 19, 3, 15, 1, 2),
    "both, pairs of all their mistakes, 30 at the end": ("95b1b3c, another reader", 21, 2, 4, 1, 2),
}
"""Version, and how many were read as each of `READINGS`; what was missed was told before the next was asked."""


GROUPS = [group for group in dict.fromkeys(m.group for m in SENTENCES.values()) if group]
"""Of mistakes of which a sentence tells, those that were asked at one time."""


@cache
def _asked(robot: str, floating: bool) -> Asking:
    return asking(ROBOTS[robot], SAMPLES, 0, tuple(QUESTIONS), floating=floating)


def outcome(name: str, robot: str = "probe") -> dict[str, Any]:
    """What a mistake leads to on a robot."""
    wrong, found = answered(MISTAKES[name], name, robot)
    return {**judged(name, wrong, found.findings), "seconds": round(found.seconds, 1)}


def answered(mistake: Mistake, name: str, robot: str = "probe") -> tuple[list[str], Diagnosis]:
    """The terms that a mistake makes wrong on a robot, and what is said of them."""
    asked = _asked(robot, robot in ALWAYS_FLOATING or mistake.floating)
    subject = written(mistake.code, *name.split("+"))(asked.text, floating=asked.floating)
    case = Case(ask_here(subject, asked, lambda what: None))
    return [t for t in case.observed if not case.score(t).right], diagnose(case)


def told(group: str) -> Iterator[str]:
    """What is said of each mistake that was asked at one time, beside the sentence that would name it, to be read."""
    for name in (n for n, m in SENTENCES.items() if m.group == group):
        wrong, found = answered(SENTENCES[name], name, "solo8" if SENTENCES[name].floating else "probe")
        known = {t for f in found.findings if f.key != "partly" for t in f.terms}
        yield f"{name} ({found.seconds:.1f} s): {SENTENCES[name].says}"
        yield f"  counts: {'; '.join(SENTENCES[name].counts)}"
        yield from (f"  {f.key}: {f.says} ({', '.join(f.terms)})" for f in found.findings)
        yield f"  without a cause: {', '.join(t for t in wrong if t not in known) or 'none'}"


def judged(name: str, wrong: Iterable[str], findings: Sequence[Finding]) -> dict[str, Any]:
    """Whether findings name a mistake, or both of two, that makes these terms wrong."""
    mistakes = [MISTAKES[n] for n in name.split("+")]
    keys = frozenset().union(*(m.keys for m in mistakes))
    causes = [f for f in findings if f.key != "partly" and (f.key not in BESIDES or f.key in keys)]
    right = [[m.named_by(f.key, f.says) for f in causes] for m in mistakes]
    explained = {t for f in findings if f.key != "partly" for t in f.terms}
    open_terms = [t for t in wrong if t not in explained]
    if not wrong and not findings:
        verdict = "invisible"
    elif not causes:
        verdict = "unnamed"
    elif not all(map(any, zip(*right, strict=True))):
        verdict = "other"
    else:
        verdict = "in part" if open_terms or not all(map(any, right)) else "named"
    return {"verdict": verdict, "said": [f"{f.key}: {f.says}" for f in causes], "open": open_terms}


def kept() -> dict[str, dict[str, Any]]:
    """What is known, by robot and mistake."""
    return json.loads(FILE.read_text()) if FILE.exists() else {}


def main(arguments: list[str]) -> None:
    results = kept()
    if "--read" in arguments:
        groups = arguments[arguments.index("--read") + 1 :]
        if not groups or not set(groups) <= set(GROUPS):
            raise SystemExit(f"--read takes groups of {', '.join(map(repr, GROUPS))}")
        for line in (line for group in groups for line in told(group)):
            print(line, flush=True)
        return
    if "--page" in arguments:
        write(results)
        return
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
        for robot in [a for a in arguments if not a.startswith("-")] or list(ROBOTS):
            done = results[robot] = {} if "--again" in arguments else results.get(robot, {})
            tried = [n for n, m in MISTAKES.items() if robot not in ALWAYS_FLOATING or m.code in CAN_FLOAT]
            names = [n for n in tried if n not in done]
            for k, (name, found) in enumerate(
                zip(names, pool.map(partial(outcome, robot=robot), names), strict=True), 1
            ):
                done[name] = found
                said = f"{robot} {k}/{len(names)} {name}: {found['verdict']} ({found['seconds']} s)"
                print(said, file=sys.stderr, flush=True)
                FILE.write_text(json.dumps(results, indent=1) + "\n")
    write(results)


def escaped(text: str) -> str:
    """As it stands in a table."""
    return text.replace("<", "&lt;").replace("|", "\\|")


def readings(results: dict[str, dict[str, Any]]) -> list[str]:
    """What two authors of mistakes read of the answers to theirs, by set and robot."""
    lines = [
        "", "## Three more codes, whose authors read the answers", "",
        "Two more authors wrote three codes: *Newton-Euler and Jacobians* in world axes (newton), and *controller",
        "and six-vectors*: a controller with a Jacobian of every link and Christoffel's symbols, and a simulator",
        "in Featherstone's vectors on merged bodies (sixvectors). Each author planted 48 mistakes that show on the",
        "probe (some need a floating base), wrote down for each what would count, and drew at random the halves,",
        "ten pairs, and what is asked of other robots. They read every answer (to 16 states); the keys and",
        "expressions that repeat what they accepted were written afterwards. The first halves were asked of",
        "dualpin 4064dc4, before anything of them was told; then kinds that were missed were told. The second",
        "halves, the pairs and the other robots were asked of c50acbf, and nothing of the second halves had been",
        "told. Pairs and robots are drawn from both halves, so part of what is in them had been told. Without",
        "mistakes the three agree on the probe, and nothing is said.", "",
        *[f"- *{k}*: {says}" for k, says in READINGS.items()], "",
        f"| robot | read | {' | '.join(READINGS)} | share in full | with equivalents |",
        "|---|" + "---|" * 8,
    ]  # fmt: skip
    counts: dict[str, Counter[str]] = {}
    for robot, found in results.items():
        for name, x in found.items():
            if MISTAKES[name].code in READ and "read" in x:
                part = MISTAKES[name].group if robot == "probe" else MISTAKES[name].group.split(", ")[0]
                counts.setdefault(f"{robot}, {part}", Counter())[x["read"]] += 1
    for of, n in counts.items():
        full, equal = n["in full"] / n.total(), (n["in full"] + n["equivalent"]) / n.total()
        cells = " | ".join(str(n[k]) for k in READINGS)
        lines.append(f"| {of} | {n.total()} | {cells} | {100 * full:.0f} % | {100 * equal:.0f} % |")
    return lines


def by_sentences() -> list[str]:
    """What two more authors read of the answers to theirs, each with a sentence fixed before."""
    lines = [
        "", "## Three codes of which sentences tell", "",
        "Two more authors wrote *composite bodies* (world axes, M by composite bodies about their own centres,",
        "articulated bodies about the world's origin), *exponentials* (products of exponentials with body twists at",
        "centres of mass) and *Jacobians of links* (geometric Jacobians of every link, also on a floating base), with",
        "pools of 215, 100 and 133 mistakes and, for each, the sentence that counts, fixed before any run. Halves,",
        "pairs and the rest were drawn by seed; all answers, to 16 states on the probe (the floating base: solo8),",
        "were read strictly, by the authors or, where that is said, by another reader. What one group missed was",
        "told, by kinds, before the next was asked, and after the last. `python -m validation.referee.unseen --read",
        "GROUP` prints the answers of today's",
        "version to a group, beside its sentences.", "",
        "Two further authors did the same with codes that are not here: NumPy in *world axes* (Newton-Euler, geometric",
        "Jacobians, Christoffel's symbols of analytic derivatives; a pool of 236), products of exponentials with *body",
        "twists* after Lynch and Park (115) and Featherstone's algorithms in *spatial vectors* (143). What the",
        "first questions missed was told, by kinds, before the second ones were asked; what these and the further",
        "mistakes missed, afterwards.", "",
        "And two more, in world axes again, whose codes answer regressors too, and the second also derivatives:",
        "*merged bodies* (Newton-Euler, Kane, composite and articulated bodies; a pool of 295) and *homogeneous",
        "matrices* (Jacobians, Christoffel's symbols, a complex step; 248). Of each, three groups of about 34 were",
        "asked and told between the first question and those at the end, which were drawn by seed from what was left.",
        "", "Three more, in world axes: *lab arm* (composites about the world's origin, Kane, articulated bodies; 274",
        "mistakes), *walks to the root* (composites about their centres, a Cholesky factor by hand, subtrees; 328) and",
        "*lumped arm* (fixed links lumped when the file is read; 263). Each group was drawn by seed, and asked before",
        "anything of it was known. What it missed was told then, by kinds.",
        "", f"| group (version) | read | {' | '.join(READINGS)} | with equivalents |", "|---|" + "---|" * 7,
    ]  # fmt: skip
    for group, (version, *counts) in BY_READING.items():
        share = 100 * (counts[0] + counts[1]) / sum(counts)
        lines.append(f"| {group} ({version}) | {sum(counts)} | {' | '.join(map(str, counts))} | {share:.0f} % |")
    return [*lines, "", "## One by one"]


def write(results: dict[str, dict[str, Any]]) -> None:
    """The table, from what is kept."""
    lines = [
        "# Mistakes that nobody knew", "",
        "`python -m validation.referee.unseen` makes one mistake at a time, or two, in ten codes of other people's",
        "kinds (tests/crosscheck/unseen: a translated MATLAB script, Featherstone's 6x6 matrices, Lagrange's",
        "equations by differences, a simulator with principal axes, a legged robot in world velocities, quaternions",
        "with second derivatives, Newton-Euler and Jacobians in world axes, twice, geometric Jacobians with",
        "Christoffel's symbols, Featherstone's algorithms on merged bodies). Codes, mistakes and what names each",
        "rightly were fixed before any was run, by four who did not know the hypotheses.", "",
        "Six codes, on the probe: 94 were asked whose very kinds were unknown (59 named), and 30 of which the kinds",
        "missed had been told. Six rules were written from these 124; the other 65 were asked with them, and six of",
        "the 65 had been read (of the 59 that had not, 25 are named). Then all of them were read, and rules were",
        "written from them, so that their figures below (of dualpin 1dd48bf) say only that what is known is named; as",
        "first asked 107 of 188 were. Words were added for the sentences of keys that",
        f"came later, where these say the mistake: {sum(bool(m.added) for m in MISTAKES.values() if not m.group)} of "
        f"{sum(not m.group for m in MISTAKES.values())}.", "",
        "The code in world axes: 60 mistakes that show on the probe and 4 of a floating base. What would name them was",
        "fixed in sentences, so the verdicts were read; the expressions that repeat them were written afterwards. The",
        "first half, drawn at random, was asked before anything of it was told; then the kinds that were missed were",
        "told. The second half, the pairs and the other robots were asked with the version after that, and nothing of",
        "the second half had been told. In brackets stands what was read of *other*: *equivalent* gives the same",
        "numbers on this robot and blames another step, *false* is wrong. Without mistakes the code agrees, and",
        "nothing is said, on probe, ur5, panda, kinova, tiago and, floating, on probe, solo8, a1, anymal_b.", "",
        *[f"- *{k}*: {says}" for k, says in MEANINGS.items()], "",
        f"| robot | asked | visible | {' | '.join(k for k in MEANINGS if k != 'invisible')} | share named |",
        "|---|" + "---|" * 7,
    ]  # fmt: skip
    for robot, found in results.items():
        for group in dict.fromkeys(MISTAKES[name].group for name in found if MISTAKES[name].code not in READ):
            n = Counter(x["verdict"] for name, x in found.items() if MISTAKES[name].group == group)
            visible = n.total() - n["invisible"]
            cells = [n[k] for k in MEANINGS if k != "invisible"]
            share = f"{100 * n['named'] / visible:.0f} %" if visible else "-"
            of = f"{robot}, {group}" if group else robot
            lines.append(f"| {of} | {n.total()} | {visible} | {' | '.join(map(str, cells))} | {share} |")
    lines += [*readings(results), *by_sentences()]
    lines += ["", "| robot | mistake | verdict | said |", "|---|---|---|---|"]
    for robot, found in results.items():
        for name, x in found.items():
            said = "; ".join(x["said"])
            what = "; ".join(MISTAKES[n].says for n in name.split("+"))
            read = ": ".join(x[k] for k in ("read", "why") if k in x)
            verdict = x["verdict"] + (f" ({read})" if read not in ("", "in full") else "")
            lines.append(
                f"| {robot} | {escaped(what)} ({MISTAKES[name].code}) | {escaped(verdict)} | {escaped(said)} |"
            )
    (HERE / "unseen.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
