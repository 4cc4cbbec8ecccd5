"""What is looked for in which order, stage by stage for all terms of a subject.

A long search for one term does not take the time of a short one for another, and what explains a term is tried on the
others before anything else.
"""

from __future__ import annotations

import itertools
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from .case import Case
from .catalogue import Catalogue
from .choice import cheapest, grounded, lonely, prices, rivals, sharing
from .hypothesis import Story, identity
from .rules.derived import SOURCES
from .search import DOUBTFUL
from .several import distinct_causes, few_of_each
from .stories import Explanation, together, united
from .together import Together

SEARCHED = 0.88
"""The share of the time after which nothing new is looked for: what is known then is tried on all terms."""
SCALAR = ("kinetic_energy", "potential_energy")  # one number tells little of two causes apart
WIDE = 5  # terms that one cause explains, at least, where it may be behind all others
FIRST = 2  # terms of which slips are tried too, where others have no cause
BESIDES = 3  # causes of other terms beside which slips are looked for
DEEP = 2  # terms without a cause that are looked at by all means before the others are looked at
APART = 3  # terms of which each is looked at by itself first
OUTDONE = 3  # terms that others explain, and a story that was found before does not
EARLIER = 16  # stories of a term that are tried on the next ones before anything else

SINGLE, SEVERAL = "single causes", "several links or joints"
SLIPS, BESIDE = "slips of textbook algorithms", "slips beside a cause of other terms"
RARE, LUMPED = "rare readings of the file and of inputs", "slips of merging fixed links"
ADDING_UP, ONE_MORE = "two causes whose changes add up", "a cause of other terms and one more"
READ_BESIDE, READ_TOO = "readings beside a slip", "a slip of other terms and a reading"
PLAIN, TWO, TWO_SLIPS = "two causes of the whole robot", "two causes together", "two slips of one algorithm"

MADE = {"rnea_f_ext": ("rnea",), "aba_f_ext": ("aba",), **SOURCES}
"""Terms that are hardly anything else than others, which are looked at first."""

Wanted = Callable[[Together], bool]


def unknown(search: Together) -> bool:
    return not search.good


def unexplained(search: Together) -> bool:
    """Also where it follows from terms that have no cause."""
    return search.open


def never(done: Wanted, unless: Wanted) -> Wanted:
    """Neither done nor otherwise out of the question."""
    return lambda s: not (unless(s) or done(s))


class Schedule:
    """The searches for the causes of all terms.

    Parameters
    ----------
    off : sequence of str
        The terms that are wrong, in the order in which they are looked at.
    until : float
        The time of the thread at which the search ends.
    """

    def __init__(self, case: Case, off: Sequence[str], until: float, tick: Callable[[str], None]) -> None:
        self.case, self.off, self.until, self.tick = case, off, until, tick
        self.catalogue, begun = Catalogue(case), time.thread_time()
        end = begun + SEARCHED * (until - begun)
        self.searches = {t: Together(case, t, self.catalogue, end) for t in off}
        self.found: list[Story] = []

    def run(self) -> dict[str, Explanation]:
        if 1 < len(self.off) <= APART:
            self._each_alone()
        for term in self.off:
            self._one(term)
        self._all()
        self._doubted()
        self.stage(TWO, Together.pairs, unknown, self.off)
        self._what_follows()
        self._known_at_the_end()
        return grounded({t: s.explanation() for t, s in self.searches.items()})

    def stage(self, what: str, of: Callable[[Together], None], wanted: Wanted, terms: Sequence[str]) -> None:
        """One kind of causes, of those of the terms for which it is wanted."""
        for term in terms:
            search = self.searches[term]
            if search.late:  # what is known then is tried at the end
                return
            search.known(self.found)
            if wanted(search):
                self.tick(f"{term}: {what}")
                of(search)
            told = united([*self.found, *few_of_each(search.stories)[:EARLIER]])
            self.found = [s for s in told if not outdone(s, self.searches.values())]
            self.case.told = {t: s.stories for t, s in self.searches.items() if not s.open}
            self._settle()

    # the order

    def _each_alone(self) -> None:
        """Few terms: each may have a mistake of its own, which is soon found where another one has two."""
        apart = [t for t in self.off if t not in MADE or self.case.wrong.isdisjoint(MADE[t])]
        for term in apart if len(apart) > 1 else ():
            self.stage(SINGLE, Together.singles, lambda s: not s.exact, [term])
            self.stage(RARE, Together.readings, unknown, [term])
            self.stage(SLIPS, Together.slips, unknown, [term])

    def _one(self, term: str) -> None:
        """A term by itself; by all means if few before it have no cause: what they have may be behind all others."""
        stage, searches, one = self.stage, self.searches, [term]
        stage(SINGLE, Together.singles, lambda s: not s.exact, one)
        stage("causes of other terms together", self._together, unknown, one)
        if sum(s.tried and not s.good for s in searches.values()) > DEEP:
            return
        stage(SEVERAL, Together.several, unexplained, one)
        stage(ADDING_UP, Together.sums, unknown, one)
        stage(ONE_MORE, self._one_more, unknown, one)
        if not searches[term].good:  # a slip of all joints may be what a cause of one of them describes
            stage(SLIPS, Together.slips, narrow, [t for t in self.off if searches[t].good][:FIRST])
        stage(READ_BESIDE, self._readings_beside, unknown, one)
        stage(BESIDE, self._beside_nearer, unknown, one)
        if term != "fk" and not any(sure(s) for s in searches.values()):
            stage(PLAIN, Together.plain_pairs, unknown, one)
        stage(RARE, Together.readings, unknown, one)
        if not (searches[term].good or self._most):  # poses may be wrong in a way of which a reading tells otherwise
            stage(SLIPS, Together.slips, never(slipped, unexplained), [t for t in self.off if t == "fk"])
        stage(SLIPS, Together.slips, unknown, one)
        if not searches[term].good:  # a slip may be what a doubtful cause of the terms before describes
            before = [t for t in self.off if not searches[t].open][:FIRST]
            stage(SLIPS, Together.slips, self._uncertain(slipped), before)
        stage(LUMPED, self._merging, unknown, one)
        stage(BESIDE, self._beside, unknown, one)
        stage(TWO_SLIPS, Together.two_slips, lambda s: s.slipped and not s.good, one)
        stage(READ_BESIDE, Together.readings_near, lambda s: s.slipped and not s.good, one)
        if term == "fk":  # without a cause of wrong poses hardly any other term has one
            stage(PLAIN, Together.plain_pairs, unknown, one)
            stage(TWO, Together.pairs, unknown, one)
        stage(ADDING_UP, Together.sums, unknown, one)

    def _all(self) -> None:
        """All terms without a cause, beside the causes of the others."""
        stage, off, settled = self.stage, self.off, self.catalogue.settled
        stage(ONE_MORE, self._one_more, unknown, off)
        first = [t for t in off if t not in SCALAR][:1] or off[:1]
        if not settled:
            stage(PLAIN, Together.plain_pairs, unknown, first)
            stage(ONE_MORE, self._one_more, unknown, [t for t in off if t not in first])
        stage(BESIDE, self._beside_nearer, unknown, off)
        stage(RARE, Together.readings, never(reread, explained), off)
        stage(SLIPS, Together.slips, never(slipped, explained), off)
        stage(LUMPED, self._merging, never(remerged, explained), off)
        stage(SEVERAL, Together.several, never(toggled, explained), off)
        if not settled:
            stage("slips beside a cause of the whole robot", Together.slips_near, unknown, first)
        stage(BESIDE, self._beside, unknown, off)
        stage(READ_TOO, self._one_more_reading, unknown, off)
        stage(ADDING_UP, Together.sums, unknown, off)
        if any(s.open for s in self.searches.values()):  # what else explains the first terms may explain these too
            plain = [t for t in off if not self.searches[t].open and not self.searches[t].slipped][:FIRST]
            stage(SLIPS, Together.slips, lambda s: True, plain)
            stage(BESIDE, self._beside, unknown, off)

    def _doubted(self) -> None:
        """Terms of which the cause is doubtful: what is soon looked at first, since it may explain the next one too."""
        for term in self.off:
            self.stage(RARE, Together.readings, self._uncertain(reread), [term])
            self.stage(SLIPS, Together.slips, self._uncertain(slipped), [term])
            self.stage(LUMPED, self._merging, self._uncertain(remerged), [term])

    def _what_follows(self) -> None:
        """Terms that follow from others which have no cause."""
        stage, off = self.stage, self.off
        stage(SINGLE, Together.singles, lambda s: s.open and not s.tried, off)
        stage(SEVERAL, Together.several, lambda s: s.open and not s.toggled, off)
        stage(BESIDE, self._beside, unexplained, off)
        stage(RARE, Together.readings, lambda s: s.open and not s.reread, off)
        stage(SLIPS, Together.slips, lambda s: s.open and not s.slipped, off)
        stage(LUMPED, self._merging, lambda s: s.open and not s.remerged, off)
        stage(TWO, Together.pairs, lambda s: True, off)
        stage("three causes together", Together.triples, unexplained, off)

    def _known_at_the_end(self) -> None:
        """What was found last may explain the others, the first too."""
        causes, searches = self._causes, self.searches
        for term, search in sorted(searches.items(), key=lambda x: not x[1].open):
            self.tick(f"{term}: what explains other terms")
            if self._in_time:
                search.known([*causes, *together(causes), *self.found])
            search.composed()
            if self._in_time:
                if search.open:
                    search.sums()
                search.exchanged(searches.values())
        for _ in range(2):  # the first round may find what the second one needs
            known = {t: list(s.good.values()) for t, s in searches.items() if not s.open}
            for term, others in sharing(self._picked, known):
                if self._in_time:
                    searches[term].shared(others)
        for term in lonely(self._picked):
            if self._in_time:
                searches[term].shared(self._causes[:FIRST])

    # stages that need what was found of all terms

    def _together(self, search: Together) -> None:
        likely = [distinct_causes(s.stories)[:BESIDES] for s in self.searches.values() if not s.open]
        search.known(together(united([*self._causes, *itertools.chain(*likely)])))

    def _one_more(self, search: Together) -> None:
        several = [s for s in self._picked.values() if len(s) > 1]
        told = {h.cause for other in self.searches.values() for s in other.stories if len(s) == 1 for h in s}
        search.added([*united(several), *self._causes], told)

    def _one_more_reading(self, search: Together) -> None:
        search.added_readings(self._causes)

    def _beside(self, search: Together) -> None:
        search.slips_besides(self._first_causes, self._most)

    def _beside_nearer(self, search: Together) -> None:
        search.slips_besides(self._first_causes, self._most, nearer=True)

    def _readings_beside(self, search: Together) -> None:
        if causes := self._first_causes:
            search.readings_near(causes)

    def _merging(self, search: Together) -> None:
        search.merging(self._first_causes)

    # what was found

    @property
    def _in_time(self) -> bool:
        return time.thread_time() < self.until

    @property
    def _picked(self) -> dict[str, Story]:
        options = {t: few_of_each(s.stories) for t, s in self.searches.items() if not s.open}
        return cheapest(options, prices(self.case, options))

    @property
    def _counted(self) -> Counter[Story]:
        """How many terms each cause explains."""
        return Counter((h,) for story in self._picked.values() for h in story if h.key != "follows")

    @property
    def _causes(self) -> list[Story]:
        """The cheapest common causes of the terms that are explained so far, those of most terms first."""
        return [story for story, _ in self._counted.most_common()]

    @property
    def _first_causes(self) -> list[Story]:
        causes = self._causes[:BESIDES]
        return [*causes, *rivals(causes, [s.good.values() for s in self.searches.values() if not s.open])[:BESIDES]]

    @property
    def _most(self) -> bool:
        """Whether one cause is that of most terms: as a wrong pose, it is behind the others too."""
        return max(self._counted.values(), default=0) >= max(WIDE, len(self.off) / 2)

    def _uncertain(self, looked_at: Wanted) -> Wanted:
        """Explained, but doubtfully, and not looked at."""

        def wanted(search: Together) -> bool:
            searches = self.searches
            named = [t for t, s in searches.items() if not s.open]
            examined = {h.cause for s in searches.values() if looked_at(s) for story in s.stories for h in story}
            return not (looked_at(search) or search.open) and search.doubtful(named, examined)

        return wanted

    def _settle(self) -> None:
        """Add the terms that are explained now, and those that are made of them."""
        settled, before = self.catalogue.settled, -1
        while len(settled) != before:
            before = len(settled)
            settled |= {t for t, s in self.searches.items() if not s.open}


def explained(search: Together) -> bool:
    return bool(search.good)


def slipped(search: Together) -> bool:
    return search.slipped


def reread(search: Together) -> bool:
    return search.reread


def remerged(search: Together) -> bool:
    return search.remerged


def toggled(search: Together) -> bool:
    return search.toggled


def narrow(search: Together) -> bool:
    """Explained by nothing but what one link or joint has of its own."""
    return bool(search.held) and not search.slipped and all(any(h.items for h in s) for s in search.held)


def sure(search: Together) -> bool:
    """Whether a term is explained, not by numbers that are estimated."""
    return any(not any(h.key in DOUBTFUL for h in s) for s in search.held)


def outdone(story: Story, searches: Iterable[Together]) -> bool:
    """Whether it fails on several terms that others explain, and on more than it explains.

    Terms that one of its causes explains alone do not count: the others are mistakes of further functions.
    """
    key, parts = identity(story), [identity((h,)) for h in story] if len(story) > 1 else []
    tried = [key in s.good for s in searches if key in s.seen and not s.open and not any(p in s.good for p in parts)]
    return tried.count(False) >= OUTDONE and tried.count(False) > tried.count(True)
