"""Every term explained, then the fewest hypotheses that explain them all."""

from __future__ import annotations

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from ..findings import Finding
from .apart import told_apart
from .case import Case
from .hypothesis import Hypothesis, Story, cost, identity, ordered
from .locate import located, partly, precision
from .search import Catalogue, Explanation, explain

BUDGETS = (8.0, 50.0)
"""Seconds of processor time for all terms of a subject, on an arm and on a larger robot; a term gets a share.

The aim is 10 and 60: what is being predicted when time is over is finished."""
ARM = 12  # degrees of freedom up to which a robot counts as an arm
VISITS = 50_000  # of the search for the cheapest common story
EARLIER = 16  # stories of a term that are tried on the next ones before anything else
MOST = 16  # stories of a term that it looks at


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
    """Explain what deviates, within so many seconds of processor time (by default `BUDGETS`)."""
    budget = BUDGETS[case.robot.nv > ARM] if budget is None else budget
    start = time.process_time()
    found = Diagnosis()
    found.findings += _history(case)
    errors = {t: case.score(t).error for t in case.observed}
    off = [t for t, e in errors.items() if not e <= case.tolerance and t not in case.answers.history]
    if off:
        told = _explained(case, off, start + budget, tick)
        _report(case, told, errors, found)
    found.predictions, found.seconds = case.tried, time.process_time() - start
    return found


def _history(case: Case) -> list[Finding]:
    """Subjects whose answers depend on what was asked before are named first: nothing else can be said of them."""
    return [
        Finding(
            "history", "the same state asked twice gives other numbers: the answer depends on what was asked before",
            [term], apart, apart, fix="compute everything from the arguments of the call",
            evidence={term: [apart, apart]},
        )
        for term, apart in case.answers.history.items()
    ]  # fmt: skip


def _explained(case: Case, off: Sequence[str], until: float, tick: Callable[[str], None]) -> dict[str, Explanation]:
    catalogue = Catalogue(case)
    told: dict[str, Explanation] = {}
    first: list[Story] = []
    lost = 0
    for k, term in enumerate(off):
        left = max(1.0, until - time.process_time())
        share = min(left, left / (len(off) - k) * 2)
        e = told[term] = explain(case, term, catalogue, first, share if lost < 2 else share / 4, tick)
        lost += not e.named
        first += [s for s in e.stories[:EARLIER] if s not in first]
        first = _united(first)[: 4 * EARLIER]
    picked = cheapest({t: e.stories for t, e in told.items() if e.named})
    several = len({h.cause for s in picked.values() for h in s}) > 1
    if len(off) > 1 and (several or lost):  # of several causes: one slip may be behind all of them
        for term in off:
            if time.process_time() < until:
                tick(f"{term}: slips of textbook algorithms")
                told[term].joined(explain(case, term, catalogue, depth=0, slips=True))
    shared = _united([s for e in told.values() for s in e.stories[:EARLIER]])
    for term in off if len(off) > 1 else ():  # what explains one term may explain another
        more = _together(told) if not told[term].named else []
        told[term].joined(explain(case, term, catalogue, [*shared, *more], depth=0))
    return told


def _together(told: Mapping[str, Explanation]) -> list[Story]:
    """Two and three of the causes that were found, together."""
    found = {h.identity: h for e in told.values() if e.named for h in e.stories[0]}
    causes = list(found.values())[:8]
    return [ordered(c) for n in (2, 3) for c in itertools.combinations(causes, n)]


def _united(stories: Sequence[Story]) -> list[Story]:
    """Each once."""
    return list({identity(s): s for s in stories}.values())


def _report(case: Case, told: Mapping[str, Explanation], errors: Mapping[str, float], found: Diagnosis) -> None:
    picked = _uncontradicted(case, told, cheapest({t: e.stories for t, e in told.items() if e.named}))
    whose: dict[tuple[object, ...], tuple[list[Hypothesis], list[str]]] = {}
    for term, story in picked.items():
        for h in story:
            variants, terms = whose.setdefault(h.cause, ([], []))
            terms.append(term)
            if h not in variants:
                variants.append(h)
    for variants, terms in whose.values():
        h = variants[0]
        after = {t: case.score(t, picked[t]).error for t in terms}
        others, apart = _alternatives(case, h, terms, picked, told)
        found.findings.append(
            Finding(
                h.key, str(h) + _elsewhere(case, variants), terms, max(errors[t] for t in terms), max(after.values()),
                list(h.items), others, apart, h.fix, {t: [errors[t], after[t]] for t in terms},
            )
        )  # fmt: skip
    for term, e in told.items():
        if not e.named:
            rounded = precision(case, term, e)
            where = located(case, term, e)
            finding = rounded or partly(case, term, e, where)
            if finding:
                _add(found.findings, finding)
            if not rounded:
                found.located[term] = where


RIVALS = 8
"""How many causes of about the same cost are compared by the right terms that contradict them."""


def _uncontradicted(case: Case, told: Mapping[str, Explanation], picked: Mapping[str, Story]) -> Mapping[str, Story]:
    """Of single causes that explain the same terms at the same cost: the one that fewest right terms contradict."""
    terms_of: dict[Hypothesis, list[str]] = {}
    for term, story in picked.items():
        if len(story) == 1:
            terms_of.setdefault(story[0], []).append(term)
    better = dict(picked)
    for h, terms in terms_of.items():
        least = len(case.spared(h))
        rivals = [s[0] for s in told[terms[0]].stories if len(s) == 1 and s[0].cost <= h.cost + 0.011 and s[0] is not h]
        for g in rivals[:RIVALS] if least else ():
            everywhere = all(any(s == (g,) for s in told[t].stories) for t in terms)
            if everywhere and len(case.spared(g)) < least:
                least = len(case.spared(g))
                better |= dict.fromkeys(terms, (g,))
    return better


def _add(findings: list[Finding], new: Finding) -> None:
    """One more finding; the same of several terms is one."""
    for f in findings:
        if (f.key, f.says, f.items) == (new.key, new.says, new.items):
            f.terms += new.terms
            f.before, f.after = max(f.before, new.before), max(f.after, new.after)
            f.evidence |= new.evidence
            return
    findings.append(new)


def _elsewhere(case: Case, variants: Sequence[Hypothesis]) -> str:
    """Terms that all variants of a cause would have changed, and that are right without."""
    first, *more = map(case.spared, variants)
    spared = [t for t in first if all(t in other for other in more)]
    return f"; not in {', '.join(spared)}" if spared else ""


def _alternatives(
    case: Case, h: Hypothesis, terms: Sequence[str], picked: Mapping[str, Story], told: Mapping[str, Explanation]
) -> tuple[list[str], dict[str, object]]:
    """What would explain these terms as well, at about the same cost; and a state that would tell one of them apart."""
    others: dict[frozenset[object], Story] = {}
    for t in terms:
        for s in told[t].stories:
            if _causes(s) != _causes(picked[t]) and h not in s and cost(s) <= cost(picked[t]) + 0.51:
                others.setdefault(identity(s), s)
    # only what explains all of its terms stands in its place
    whole = [s for s in others.values() if all(identity(s) in map(identity, told[t].stories) for t in terms)]
    whole = list({tuple(g.says for g in s): s for s in reversed(whole)}.values())[::-1]  # in one of its variants
    words = [" and ".join(map(str, s)) for s in whole[:4]]
    for s in whole[:4]:
        state = told_apart(case, terms[0], picked[terms[0]], s)
        if state:
            return words, state
    return words, {}


def _causes(story: Story) -> frozenset[object]:
    return frozenset(h.cause for h in story)


def cheapest(options: Mapping[str, Sequence[Story]]) -> dict[str, Story]:
    """One story for each term, so that all hypotheses together cost least: by branch and bound."""
    terms = sorted(options, key=lambda t: len(options[t]))
    told_by = Counter(identity(s) for stories in options.values() for s in stories)
    likely = {t: sorted(x, key=lambda s: (-told_by[identity(s)], cost(s)))[:MOST] for t, x in options.items()}
    best: tuple[float, float] = (math.inf, math.inf)
    picked: dict[str, Story] = {}
    visits = 0

    def branch(k: int, claimed: Mapping[tuple[object, ...], float], told: float, chosen: tuple[Story, ...]) -> None:
        nonlocal best, picked, visits
        visits += 1
        spent = round(sum(claimed.values()), 6)
        if (spent, told) >= best or visits > VISITS:
            return
        if k == len(terms):
            best, picked = (spent, told), dict(zip(terms, chosen, strict=True))
            return

        def more(s: Story) -> tuple[float, float]:
            return cost(h for h in s if h.cause not in claimed), cost(s)

        for s in sorted(likely[terms[k]], key=more):
            branch(k + 1, {**claimed, **{h.cause: h.cost for h in s}}, told + cost(s), (*chosen, s))

    branch(0, {}, 0.0, ())
    return picked
