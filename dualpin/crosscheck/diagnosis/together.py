"""Several causes of one term: beside those that explain other terms, and beside those that come nearest."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from .additive import likeliest
from .choice import as_causes
from .fits import pairs_of_forces
from .hypothesis import Hypothesis, Story, cost, identity, ordered
from .rules.derived import of_symbols
from .rules.register import INERTIAL, MERGING, SLIPS
from .search import DOUBTFUL, PLAIN, SMALL, Search
from .several import bases, distinct, mostly
from .spared import POSES, READ, in_poses, shows, spared
from .stories import BEAM, Near, joins, kept, reads, united
from .textbook.slipped import algorithm

STEINER = "Steiner's term"
QUICK = 1.0  # seconds of the thread for variants of a cause beside which slips are looked for, but for the first
NEAREST = 4  # slips beside which others of the same algorithm are looked for
FEW_CAUSES = 4  # found for other terms, to which another one is added
OF_MASSES = ("crba", "centroidal_momentum_matrix", "kinetic_energy", "rnea")
WHOLE = 1.2
"""The cost up to which a cause holds for the whole robot, and nothing is estimated for it."""
REFERENCES = ("reference_local", "reference_world", "rows")
"""How frames and six-vectors are written: each function may have it for itself."""
BESIDE = 0.5  # of the time that is left, for slips beside the causes that are known then
PLACED = 0.5  # the same for two mistakes in reading placements
LITTLE = 0.05  # of the root mean square: causes that leave no more are looked at with one more
NEAR = 0.5  # of it: slips that leave no more are looked at with a reading
LIKELY = 24  # readings that are tried beside a slip of other terms
MORE_LIKELY = 96  # and beside another reading
BESIDES = 2  # slips beside which readings are looked for
LARGE = 40  # joints from which pairs of single links are not tried


class Together(Search):
    """The search for one cause, and for two and three."""

    def merging(self, causes: Sequence[Story]) -> None:
        """Slips in merging fixed links and in reading tensors: they take as long as all others, and explain less.

        A file is read once: where another term that they would change is right, or explained, they are no cause.
        Steiner's term is an exception: what is wrong with it in a recursion over links is so in merging them, too.
        """

        def unsure(h: Hypothesis) -> bool:
            return h.key in DOUBTFUL or bool(h.made_of) or STEINER in h.says

        sure = {t for t, s in self.case.told.items() if not any(map(unsure, s[0]))}
        known = sure.union(t for t in self.case.observed if t not in self.case.wrong)
        if self.term in INERTIAL and known.isdisjoint(OF_MASSES):
            self._late_rules(MERGING)
            self._slips_with(self._nearest(causes), MERGING)
            if self.open:
                self.consider(self._likeliest({identity(s): s for s in self.catalogue.helpers(self.term)}))
        self.remerged = True

    def slips_besides(self, causes: Sequence[Story], most: bool, nearer: bool = False) -> None:
        """Slips, beside a cause of other terms that does not explain all of this one; with both it may look worse.

        `most` says that most terms are explained: slips are looked for beside their causes first, and alone if there is
        time.  `nearer` says that only causes count that bring what is predicted nearer.
        """
        near = [n for n in self._nearest(causes) if not nearer or n.score.rms < self.before.rms]
        known, more = {identity(n.story) for n in near}, mostly(self.near if self.slipped else ())
        self._slips_with([*near, *(n for n in more if identity(n.story) not in known)], share=1.0 if most else BESIDE)

    def two_slips(self) -> None:
        """Two slips of one algorithm: those whose changes nearly add up, and beside the nearest."""
        self.consider(self.catalogue.two_slips(self.term, self._part()))
        self._slips_with(_by_rms(self.near)[:NEAREST])

    def readings_near(self, causes: Sequence[Story] = ()) -> None:
        """Readings of the whole file and of inputs, beside the slips that come nearest, of other terms if there are."""
        read = [h for h in self._whole if h.place in READ and shows(self.case, h)]
        until = self._part()
        for n in _by_rms(self._nearest(causes) if causes else self.near)[:BESIDES]:
            if self.open and n.score.rms < NEAR * self.before.rms:
                likely = likeliest(self.case, self.term, n.story, read)[: LIKELY if causes else None]
                self.consider(self._with(n.story, likely), until)

    def slips_near(self) -> None:
        """Slips, beside the causes of the whole robot that come nearest."""
        near = [n for n in self.near if len(n.story) == 1 and n.story[0].cost <= WHOLE]
        self._slips_with([n for n in sorted(near, key=lambda n: n.score.rms) if n.score.rms < self.before.rms])

    def _slips_with(self, nearest: Sequence[Near], late: int = SLIPS, share: float = BESIDE) -> None:
        begun = time.thread_time()
        until = begun + share * (self.until - begun)
        for k, (cause, soon) in enumerate(bases(nearest)):
            took = time.thread_time() - begun
            if (self.open or self._unsure) and (soon or took < QUICK) and not (k and begun + took > until):
                self.consider(self.catalogue.slips(self.term, until, cause.story, late), until)

    @property
    def _unsure(self) -> bool:
        """Whether all that explains it needs a wrong pose or velocity of links, against poses and velocities."""

        def against(h: Hypothesis) -> bool:
            return in_poses(h) and not POSES.isdisjoint(spared(self.case, h))

        return all(any(map(against, s)) for s in self.held)

    def added(self, found: Sequence[Story], told: set[Any]) -> None:
        """What explains other terms, and one cause more; beside a slip, one that changes what its algorithm answers.

        Of readings, beside a slip, only those that are `told` of another term: each makes a robot of its own.
        """
        for story in self._besides(found):
            whole = self.catalogue.of(self.term, False, self.case.score(self.term, story).error)
            for more in ([*self._fits(story), *whole], self._single):  # a link alone is rarer
                if self.open:
                    edits = all(algorithm(h.act) is None for h in story)
                    also = told.union(h.cause for h in more if h.key in REFERENCES or (edits and shows(self.case, h)))
                    some = [h for h in more if h.place not in READ or h.cause in also]
                    self._further(self.consider(self._with(story, some)), some)
        for story in of_symbols(self.case, self.term, found):
            more = [h for h in self._whole if h.place == "answer"]
            self.consider(self._with(story, [*self._fits(story), *more]))

    def added_readings(self, found: Sequence[Story]) -> None:
        """Slips that explain other terms, of a robot that is read wrongly: each such robot is computed by itself."""
        for story in self._besides(found):
            if self.open and any(h.place == "formula" for h in story):
                read = [h for h in self._whole if h.place in READ and shows(self.case, h) and not spared(self.case, h)]
                self.consider(self._with(story, read))

    def _besides(self, found: Sequence[Story]) -> list[Story]:
        """Causes of other terms to which another one is added: of each the variant told there, and the nearest."""
        first, nearest = dict[Any, Story](), dict[Any, Near]()
        for n in self._nearest(found):
            cause = as_causes(n.story)
            first.setdefault(cause, n.story)
            nearest[cause] = min(nearest.get(cause, n), n)
        causes = list(first)[:FEW_CAUSES]
        return united([s for c in causes for s in (first[c], nearest[c].story)])

    def plain_pairs(self) -> None:
        """Two causes that hold for the whole robot."""
        if self.before.error >= SMALL:
            whole = [h for h in self._whole if shows(self.case, h) or h.key in REFERENCES]
            near = [n for n in self.near if len(n.story) == 1 and n.story[0].cost <= WHOLE]
            beam = kept([n for n in near if n.story[0] in whole])
            more = pairs_of_forces(self.case, self.term)  # a spring with a rest position, and the like
            nearest = itertools.combinations([h for (h,) in kept(near)], 2)  # what other terms speak against too
            more += [ordered(two) for two in nearest if joins(two[1], two[:1])]
            edits, others = ([h for h in whole if (h.place == "edit") == edit] for edit in (True, False))
            for story in beam:
                more += self._with(story, [*others, *likeliest(self.case, self.term, story, edits)[:MORE_LIKELY]])
            level = self.consider(more, self._part())
            self._further(level, whole)
            if self.term == "fk" and self.open:
                self._two_readings(whole)

    def _two_readings(self, whole: Sequence[Hypothesis]) -> None:
        """Two mistakes in reading placements: rotations are a product, so that none alone comes near."""
        read = [h for h in whole if h.place == "edit"]
        two = [ordered(pair) for pair in itertools.combinations(read, 2) if joins(pair[1], pair[:1])]
        begun = time.thread_time()
        self.consider(self.catalogue.nearest(self.term, sorted(two, key=cost), begun + PLACED * (self.until - begun)))

    def _further(self, near: Sequence[Near], more: Sequence[Hypothesis]) -> None:
        """One cause more, beside what leaves little."""
        until = self._part()
        for n in sorted(near, key=lambda n: n.score.rms)[:FEW_CAUSES]:
            if self.open and n.score.rms < LITTLE * self.before.rms and time.thread_time() < until:
                self.consider(self._with(n.story, more), until)

    def pairs(self) -> None:
        """Two causes together, from those that come nearest; of numbers of one body, those that they may imitate."""
        if self.before.error < SMALL or min(map(cost, self.held), default=np.inf) <= PLAIN:
            return
        self._beam = [(), *(n.story for n in sorted(self.near)[:BEAM]), *kept(self.near)]
        self._beam = list({identity(s): s for s in self._beam}.values())
        if self.held:
            more = [h for h in self._whole if reads([h])]
            self.consider([s for story in self._beam if reads(story) for s in self._with(story, more)])
            return
        self.two_slips()
        single = self._single if len(self.case.robot) <= LARGE else []
        more = [*self._whole, *self._near_slips, *single]
        likely = [likeliest(self.case, self.term, story, more) for story in self._beam]
        level = pairs_of_forces(self.case, self.term)
        level += [s for story in self._beam for s in self._with(story, self._fits(story))]
        for some in zip(*likely, strict=True):  # the likeliest of each first
            level += [s for story, h in zip(self._beam, some, strict=True) for s in self._with(story, [h])]
        self._beam = kept(self.consider(level))

    def triples(self) -> None:
        """And three."""
        if self.open and self._beam:
            more = [*self._whole, *self._near_slips]
            self.consider([s for b in self._beam for s in self._with(b, [*self._fits(b), *more])])


def _by_rms(near: Iterable[Near]) -> list[Near]:
    """Single slips, the nearest first."""
    slips = [n for n in near if len(n.story) == 1 and n.story[0].place == "formula"]
    return distinct(sorted(slips, key=lambda n: n.score.rms))
