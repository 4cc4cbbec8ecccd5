"""Every term explained, then the fewest hypotheses that explain them all."""

from __future__ import annotations

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial

from ..findings import Finding
from .apart import told_apart
from .case import Case
from .catalogue import Catalogue
from .choice import as_causes, cause_of, cheapest, grounded, lonely, prices, rivals, sharing
from .doubts import contradicted, doubtful
from .hypothesis import Hypothesis, Story, cost, identity
from .locate import in_single, located, no_factor, partly, precision
from .rules import SHIPPED
from .rules.composed import follows_from
from .rules.register import WEIGHED
from .search import DOUBTFUL, Search
from .several import distinct_causes, few_of_each
from .spared import spared
from .stories import Explanation, together, united

BUDGETS = (9.6, 58.0)
"""Seconds of processor time for all terms of a subject, on an arm and on a larger robot: the aim is 10 and 60."""
SEARCHED = 0.8
"""The share of them after which nothing new is looked for: what is known then is tried on all terms."""
ARM = 12  # degrees of freedom up to which a robot counts as an arm
PLAINEST = (
    "fk", "com", "potential_energy", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration",
    "kinetic_energy",
)  # fmt: skip
"""Terms that are looked at first: fewest mistakes can be behind them, and most others rest on them."""
SCALAR = ("kinetic_energy", "potential_energy")  # one number tells little of two causes apart
WIDE = 5  # terms that one cause explains, at least, where it may be behind all others
FIRST = 2  # terms of which slips are tried too, where others have no cause
BESIDES = 3  # causes of other terms beside which slips are looked for
OUTDONE = 3  # terms that others explain, and a story that was found before does not
EARLIER = 16  # stories of a term that are tried on the next ones before anything else
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
    """Explain what deviates, within so many seconds of processor time (by default `BUDGETS`)."""
    budget = BUDGETS[case.robot.nv > ARM] if budget is None else budget
    start, kept_back = time.process_time(), FRESH_SHARE * budget * bool(case.answers.history)
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
        told = _explained(case, off, start + budget - kept_back, tick)
        _report(case, told, errors, found)
    said = {(f.key, f.says) for f in found.findings}
    for finding in _besides_history(case, start + budget, tick):
        if (finding.key, finding.says) not in said:
            finding.says += ", as the first answer shows"
        _add(found.findings, finding)
    case.shared.slips.save(SHIPPED)
    found.predictions, found.seconds = case.tried, time.process_time() - start
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
    told = {t: e for t, e in _explained(first, off, until, tick).items() if e.named}
    for e in told.values():
        e.stories = [s for s in e.stories if not any(h.key in (*DOUBTFUL, "damped_inverse", "follows") for h in s)]
    found = Diagnosis()
    _report(first, {t: e for t, e in told.items() if e.named}, errors, found)
    return found.findings


def _explained(case: Case, off: Sequence[str], until: float, tick: Callable[[str], None]) -> dict[str, Explanation]:
    """Stage by stage for all terms, so that the long search for one does not take the time of a short one for another.

    What explains a term is tried on the others before anything else.
    """
    catalogue, begun = Catalogue(case), time.process_time()
    searches = {t: Search(case, t, catalogue, begun + SEARCHED * (until - begun)) for t in off}
    found: list[Story] = []

    def stage(what: str, of: Callable[[Search], None], wanted: Callable[[Search], bool], terms: Sequence[str]) -> None:
        for term in terms:
            search = searches[term]
            if search.late:  # what is known then is tried at the end
                return
            search.known(found)
            if wanted(search):
                tick(f"{term}: {what}")
                of(search)
            told = united([*found, *few_of_each(search.stories)[:EARLIER]])
            found[:] = [s for s in told if not _outdone(s, searches.values())]
            case.told = {t: s.stories for t, s in searches.items() if not s.open}
            _settle(catalogue.settled, searches)

    def unknown(search: Search) -> bool:
        return not search.good

    def unexplained(search: Search) -> bool:  # also where it follows from terms that have no cause
        return search.open

    def uncertain(search: Search, looked_at: Callable[[Search], bool]) -> bool:
        explained = [t for t, s in searches.items() if not s.open]
        examined = {h.cause for s in searches.values() if looked_at(s) for story in s.stories for h in story}
        return not (looked_at(search) or search.open) and search.doubtful(explained, examined)

    def known_together(search: Search) -> None:
        likely = [distinct_causes(s.stories)[:BESIDES] for s in searches.values() if not s.open]
        search.known(together(united([*_causes(case, searches), *itertools.chain(*likely)])))

    def one_more(search: Search) -> None:
        together = [s for s in _picked(case, searches).values() if len(s) > 1]
        told = {h.cause for other in searches.values() for s in other.stories if len(s) == 1 for h in s}
        search.added([*united(together), *_causes(case, searches)], told)

    def one_more_reading(search: Search) -> None:
        search.added_readings(_causes(case, searches))

    def first_causes() -> list[Story]:
        causes = _causes(case, searches)[:BESIDES]
        return [*causes, *rivals(causes, [s.good.values() for s in searches.values() if not s.open])[:BESIDES]]

    def most() -> bool:  # one cause of most terms, such as a wrong pose, is behind the others too
        explained = max(_counted(case, searches).values(), default=0)
        return explained >= max(WIDE, len(off) / 2)

    def besides(search: Search) -> None:
        search.slips_besides(first_causes(), most())

    def besides_nearer(search: Search) -> None:
        search.slips_besides(first_causes(), most(), nearer=True)

    def merging(search: Search) -> None:
        search.merging(first_causes())

    slips, beside = "slips of textbook algorithms", "slips beside a cause of other terms"
    rare, read_besides = "rare readings of the file and of inputs", "readings beside a slip"
    lumped, reading = "slips of merging fixed links", "a slip of other terms and a reading"
    adding_up, several = "two causes whose changes add up", "several links or joints"
    one_more_cause, two_causes, two_slips = (
        "a cause of other terms and one more", "two causes together", "two slips of one algorithm",
    )  # fmt: skip
    for term in off:
        stage("single causes", Search.singles, lambda s: not s.exact, [term])
        stage("causes of other terms together", known_together, unknown, [term])
        if sum(s.tried and not s.good for s in searches.values()) == 1:  # what it has may be behind all others
            stage(several, Search.several, unexplained, [term])
            stage(adding_up, Search.sums, unknown, [term])
            stage(one_more_cause, one_more, unknown, [term])
            stage(beside, besides_nearer, unknown, [term])
            if term in WEIGHED and not any(_sure(s) for s in searches.values()):
                stage("two causes of the whole robot", Search.plain_pairs, unknown, [term])
            stage(rare, Search.readings, unknown, [term])
            if not (searches[term].good or most()):  # poses may be wrong in a way of which a reading tells otherwise
                stage(slips, Search.slips, lambda s: not (s.slipped or s.open), [t for t in off if t in ("fk",)])
            stage(slips, Search.slips, unknown, [term])
            if not searches[term].good:  # a slip may be what a doubtful cause of the terms before describes
                before = [t for t in off if not searches[t].open][:FIRST]
                stage(slips, Search.slips, lambda s: uncertain(s, lambda x: x.slipped), before)
            stage(beside, besides, unknown, [term])
            stage(two_slips, Search.two_slips, lambda s: s.slipped and not s.good, [term])
            stage(read_besides, Search.readings_near, lambda s: s.slipped and not s.good, [term])
            if term == "fk":  # without a cause of wrong poses hardly any other term has one
                stage("two causes of the whole robot", Search.plain_pairs, unknown, [term])
                stage(two_causes, Search.pairs, unknown, [term])
            stage(lumped, merging, unknown, [term])
            stage(adding_up, Search.sums, unknown, [term])
    stage(one_more_cause, one_more, unknown, off)
    first = [t for t in off if t not in SCALAR][:1] or off[:1]
    if not catalogue.settled:
        stage("two causes of the whole robot", Search.plain_pairs, unknown, first)
        stage(one_more_cause, one_more, unknown, [t for t in off if t not in first])
    stage(beside, besides_nearer, unknown, off)
    stage(rare, Search.readings, lambda s: not (s.good or s.reread), off)
    stage(slips, Search.slips, lambda s: not (s.good or s.slipped), off)
    stage(lumped, merging, lambda s: not (s.good or s.remerged), off)
    stage(several, Search.several, lambda s: not (s.good or s.toggled), off)
    if not catalogue.settled:
        stage("slips beside a cause of the whole robot", Search.slips_near, unknown, first)
    stage(beside, besides, unknown, off)
    stage(reading, one_more_reading, unknown, off)
    stage(adding_up, Search.sums, unknown, off)
    if any(s.open for s in searches.values()):  # what else explains the first terms may explain these too
        plain = [t for t in off if not searches[t].open and not searches[t].slipped][:FIRST]
        stage(slips, Search.slips, lambda s: True, plain)
        stage(beside, besides, unknown, off)
    for term in off:  # what is soon looked at comes first; what explains one of them may explain the next
        stage(rare, Search.readings, lambda s: uncertain(s, lambda x: x.reread), [term])
        stage(slips, Search.slips, lambda s: uncertain(s, lambda x: x.slipped), [term])
        stage(lumped, merging, lambda s: uncertain(s, lambda x: x.remerged), [term])
    stage(two_causes, Search.pairs, unknown, off)
    # then terms that follow from others which have no cause
    stage("single causes", Search.singles, lambda s: s.open and not s.tried, off)
    stage(several, Search.several, lambda s: s.open and not s.toggled, off)
    stage(beside, besides, unexplained, off)
    stage(rare, Search.readings, lambda s: s.open and not s.reread, off)
    stage(slips, Search.slips, lambda s: s.open and not s.slipped, off)
    stage(lumped, merging, lambda s: s.open and not s.remerged, off)
    stage(two_causes, Search.pairs, lambda s: True, off)
    stage("three causes together", Search.triples, unexplained, off)
    causes = _causes(case, searches)
    for term, search in sorted(searches.items(), key=lambda x: not x[1].open):  # what was found last may explain these
        tick(f"{term}: what explains other terms")
        in_time = time.process_time() < until
        if in_time:
            search.known([*causes, *together(causes), *found])
        search.composed()
        if in_time and search.open:
            search.sums()
        if in_time:
            search.exchanged(searches.values())
    for _ in range(2):  # the first round may find what the second one needs
        known = {t: list(s.good.values()) for t, s in searches.items() if not s.open}
        for term, others in sharing(_picked(case, searches), known):
            if time.process_time() < until:
                searches[term].shared(others)
    for term in lonely(_picked(case, searches)):
        if time.process_time() < until:
            searches[term].shared(_causes(case, searches)[:FIRST])
    return grounded({t: s.explanation() for t, s in searches.items()})


def _outdone(story: Story, searches: Iterable[Search]) -> bool:
    """Whether it fails on several terms that others explain, and on more than it explains.

    Terms that one of its causes explains alone do not count: the others are mistakes of further functions.
    """
    key, parts = identity(story), [identity((h,)) for h in story] if len(story) > 1 else []
    tried = [key in s.good for s in searches if key in s.seen and not s.open and not any(p in s.good for p in parts)]
    return tried.count(False) >= OUTDONE and tried.count(False) > tried.count(True)


def _sure(search: Search) -> bool:
    """Whether a term is explained, not by numbers that are estimated."""
    return any(not any(h.key in DOUBTFUL for h in s) for s in search.held)


def _settle(settled: set[str], searches: Mapping[str, Search]) -> None:
    """Add the terms that are explained now, and those that are made of them."""
    before = -1
    while len(settled) != before:
        before = len(settled)
        settled |= {t for t, s in searches.items() if not s.open}


def _causes(case: Case, searches: Mapping[str, Search]) -> list[Story]:
    """The cheapest common causes of the terms that are explained so far, those of most terms first."""
    return [story for story, _ in _counted(case, searches).most_common()]


def _counted(case: Case, searches: Mapping[str, Search]) -> Counter[Story]:
    """How many terms each of them explains."""
    picked = _picked(case, searches).values()
    return Counter((h,) for story in picked for h in story if h.key != "follows")


def _picked(case: Case, searches: Mapping[str, Search]) -> dict[str, Story]:
    options = {t: few_of_each(s.stories) for t, s in searches.items() if not s.open}
    return cheapest(options, prices(case, options))


def _report(case: Case, told: Mapping[str, Explanation], errors: Mapping[str, float], found: Diagnosis) -> None:
    options = {t: e.stories for t, e in told.items() if e.named}
    picked = cheapest(options, prices(case, options))
    whose: dict[tuple[object, ...], tuple[list[Hypothesis], list[str]]] = {}
    for term, story in picked.items():
        for h in story:
            variants, terms = whose.setdefault(cause_of(h), ([], []))
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
