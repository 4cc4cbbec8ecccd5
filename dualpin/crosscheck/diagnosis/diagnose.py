"""Every term explained, then the fewest hypotheses that explain them all."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial

from ... import collector
from ..findings import Finding
from .apart import told_apart
from .case import Case
from .choice import as_causes, cause_of, cheapest, prices
from .doubts import contradicted, doubtful
from .hypothesis import Hypothesis, Story, cost, identity
from .locate import in_single, located, no_factor, partly, precision
from .rules import SHIPPED
from .rules.composed import follows_from
from .schedule import Schedule
from .search import DOUBTFUL
from .spared import spared
from .stories import Explanation

BUDGETS = (8.6, 57.0)
"""Seconds of the thread, for all terms of a subject, on an arm and on a larger robot: 10 and 60 is the aim.

The last step begins before they are over, and takes up to 1 s; then findings are told.
"""
ARM = 12  # degrees of freedom up to which a robot counts as an arm
PLAINEST = (
    "fk", "com", "potential_energy", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration",
    "kinetic_energy",
)  # fmt: skip
"""Terms that are looked at first: fewest mistakes can be behind them, and most others rest on them."""
FRESH_SHARE = 0.5  # of the time that the first answers to terms with a history have at least


@dataclass
class Diagnosis:
    """What was found of one subject on one robot.

    Attributes
    ----------
    findings : list of Finding
    located : dict of str
        Of terms without a named cause: where they are off.
    predictions : int
        How many answers were predicted.
    """

    findings: list[Finding] = field(default_factory=list)
    located: dict[str, str] = field(default_factory=dict)
    predictions: int = 0
    seconds: float = 0.0

    def of(self, term: str) -> list[Finding]:
        return [f for f in self.findings if term in f.terms]


def diagnose(case: Case, budget: float | None = None, tick: Callable[[str], None] = lambda what: None) -> Diagnosis:
    """Explain what deviates, within so many seconds of this thread (by default `BUDGETS`)."""
    with collector.paused():  # looking for cycles among all hypotheses takes a tenth of the time
        return _diagnose(case, BUDGETS[case.robot.nv > ARM] if budget is None else budget, tick)


def _diagnose(case: Case, budget: float, tick: Callable[[str], None]) -> Diagnosis:
    start, kept_back = time.thread_time(), FRESH_SHARE * budget * bool(case.answers.history)
    found = Diagnosis()
    found.findings += _history(case)
    errors = {t: case.score(t).error for t in case.observed}
    off = [t for t, e in errors.items() if not e <= case.tolerance and t not in case.answers.history]
    plainest = PLAINEST[: -1 if "crba" in off else None]  # M tells more than an energy
    off.sort(key=lambda t: plainest.index(t) if t in plainest else len(plainest))
    for term in [t for t in off if in_single(case, t)]:  # a slip beside it would not be seen
        off.remove(term)
        _add(found.findings, precision(case, term, Explanation(term, case.score(term))))
    complete = case.complete()
    if not any(complete.score(t).right for t in off):  # rules that compare terms need them at the same states
        case = complete
    if off:
        told = Schedule(case, off, start + budget - kept_back, tick).run()
        _report(case, told, errors, found)
    said = {(f.key, f.says) for f in found.findings}
    for finding in _besides_history(case, start + budget, tick):
        if (finding.key, finding.says) not in said:
            finding.says += ", as the first answer shows"
        _add(found.findings, finding)
    case.shared.slips.save(SHIPPED)
    found.predictions, found.seconds = case.tried, time.thread_time() - start
    return found


def _history(case: Case) -> list[Finding]:
    """Subjects whose answers depend on what was asked before are named first."""
    apart = case.answers.history
    if not apart:
        return []
    says = "the same state asked twice gives other numbers: the answer depends on what was asked before"
    fix, worst = "compute everything from the arguments of the call", max(apart.values())
    evidence = {t: [x, x] for t, x in apart.items()}
    return [Finding("history", says, list(apart), worst, worst, fix=fix, evidence=evidence)]


def _besides_history(case: Case, until: float, tick: Callable[[str], None]) -> list[Finding]:
    """Causes of the very first answers to terms with a history, which no call before has spoilt; nothing is fitted."""
    first = case.few(1)
    errors = {t: first.score(t).error for t in case.answers.history if t in case.observed}
    off = [t for t, e in errors.items() if not first.score(t).right and math.isfinite(e)]
    if not off:  # the very first answers are right: nothing but the history is wrong
        return []
    told = {t: e for t, e in Schedule(first, off, until, tick).run().items() if e.named}
    for e in told.values():
        e.stories = [s for s in e.stories if not any(h.key in (*DOUBTFUL, "damped_inverse", "follows") for h in s)]
    found = Diagnosis()
    _report(first, {t: e for t, e in told.items() if e.named}, errors, found)
    return found.findings


def _report(case: Case, told: Mapping[str, Explanation], errors: Mapping[str, float], found: Diagnosis) -> None:
    options = {t: e.stories for t, e in told.items() if e.named}
    picked = cheapest(options, prices(case, options))
    whose: dict[tuple[object, ...], tuple[list[Hypothesis], list[str]]] = {}
    for term, story in picked.items():
        for h in story:
            variants, terms = whose.setdefault(cause_of(h), ([], []))
            if term not in terms:
                terms.append(term)
            if h not in variants:
                variants.append(h)
    for variants, terms in whose.values():
        h = variants[0]
        after = {t: case.score(t, picked[t]).error for t in terms}
        against = contradicted(case, h, told)
        if len(against) > len(terms):
            found.findings.append(doubtful(h, terms, against, errors, after))
            found.located |= {t: located(case, t, Explanation(t, told[t].before)) for t in terms}
            continue
        others, apart = _alternatives(case, h, terms, picked, told)
        found.findings.append(
            Finding(
                h.key, str(h) + _elsewhere(case, variants), terms, max(errors[t] for t in terms), max(after.values()),
                list(h.items), others, apart, h.fix, {t: [errors[t], after[t]] for t in terms},
            )
        )  # fmt: skip
    known = {h.cause for story in picked.values() for h in story if h.key != "follows"}
    for term, e in told.items():
        if not e.named:
            rounded = no_factor(case, term) or precision(case, term, e)
            where = located(case, term, Explanation(term, e.before))
            finding = rounded or partly(case, term, e, located(case, term, e), known)
            _add(found.findings, finding)
            if not rounded:
                found.located[term] = where


def _add(findings: list[Finding], new: Finding | None) -> None:
    """One more finding; the same of several terms is one."""
    if new is None:
        return
    for f in findings:
        if (f.key, f.says, f.items) == (new.key, new.says, new.items):
            f.terms += new.terms
            f.before, f.after = max(f.before, new.before), max(f.after, new.after)
            f.evidence |= new.evidence
            return
    findings.append(new)


def _elsewhere(case: Case, variants: Sequence[Hypothesis]) -> str:
    """Terms that all variants of a cause would have changed, and that are right without."""
    first, *more = (spared(case, h) for h in variants)
    others = [t for t in first if all(t in other for other in more)]
    return f"; not in {', '.join(others)}" if others else ""


def _alternatives(
    case: Case, h: Hypothesis, terms: Sequence[str], picked: Mapping[str, Story], told: Mapping[str, Explanation]
) -> tuple[list[str], dict[str, object]]:
    """What would explain these terms as well, at about the same cost; and a state that would tell one of them apart."""
    others: dict[frozenset[object], Story] = {}
    for t in terms:
        for s in told[t].stories:
            if as_causes(s) != as_causes(picked[t]) and h not in s and cost(s) <= cost(picked[t]) + 0.51:
                others.setdefault(identity(s), s)
    found = {t: set(map(as_causes, told[t].stories)) for t in terms}
    parts = cache(partial(follows_from, case))

    def whole_of(s: Story) -> bool:
        """Only what explains all of its terms stands in its place, or some from which the others follow."""
        by = {t for t in terms if as_causes(s) in found[t]}
        return all(t in by or any(some <= by for some in parts(t)) for t in terms)

    whole = [s for s in others.values() if whole_of(s)]
    whole = list({tuple(g.says for g in s): s for s in reversed(whole)}.values())[::-1]  # in one of its variants
    words = [" and ".join(map(str, s)) for s in whole[:4]]
    for s in whole[:4]:
        state = told_apart(case, terms[0], picked[terms[0]], s)
        if state:
            return words, state
    return words, {}
