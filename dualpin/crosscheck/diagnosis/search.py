"""The smallest stories under which the subject's answer to one term is right.

Single hypotheses first, those about one link or joint too; then the links and joints of a promising
family together; then pairs and triples, from the stories that came nearest.  Nearness is the share of
entries that are right, and the root mean square: the worst entry hides what a partial story repairs.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Collection, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np

from ..subjects.questions import QUESTIONS
from .case import Case
from .catalogue import Catalogue
from .choice import as_causes
from .fits import fits, pairs_of_forces
from .hypothesis import ESTIMATED, Hypothesis, Story, cost, identity, ordered
from .rules.composed import PARTS
from .rules.derived import made_of, of_symbols
from .rules.register import INERTIAL, MERGING, READINGS, SLIPS
from .several import bases, distinct, far, growing, mostly, strange
from .spared import POSES, READ, contradicted, in_poses, instead, shows, spared
from .stories import (
    BEAM,
    Explanation,
    Near,
    cheapest,
    in_one_run,
    in_time,
    joins,
    kept,
    nearness,
    reads,
    to_rounding,
    united,
)

STORIES = 64  # scored before the time is looked at, at most
VARIANTS = 2304  # of a story of several causes, as other formulations show them: all of two causes
KIN = 0.6  # seconds for what explains other terms as other formulations show it, the likeliest of them first
QUICK = 1.0  # seconds of processor time for variants of a cause beside which slips are looked for, but for the first
NEAREST = 4  # slips beside which others of the same algorithm are looked for
FEW_CAUSES = 4  # found for other terms, to which another one is added
OF_MASSES = ("crba", "centroidal_momentum_matrix", "kinetic_energy", "rnea")
SMALL = 1e-5  # an error below which two causes together are not looked for: precision has one
PLAIN = 2.0
"""The cost of two plain causes: where only dearer stories explain a term, two causes are looked for all the same."""
WHOLE = 1.2
"""The cost up to which a cause holds for the whole robot, and nothing is estimated for it."""
KNOWN = 1.06
"""The cost of a number that is well known, such as a unit."""
SAME = ("same_cv", "same_product")
"""Matrices that need only do the same as what an earlier term's story predicts."""
BESIDE = 0.5  # of the time that is left, for slips beside the causes that are known then
PAIRED = 0.25  # of the time that is left, for two causes of the whole robot or for several links: slips come later
PLACED = 0.5  # the same for two mistakes in reading placements
LITTLE = 0.05  # of the root mean square: causes that leave no more are looked at with one more
NEAR = 0.5  # of it: slips that leave no more are looked at with a reading
BESIDES = 2  # slips beside which readings are looked for
LARGE = 40  # joints from which pairs of single links are not tried
DOUBTFUL = ESTIMATED | {"gravity", "tool_offset", "base_offset", "origin_fit", "saturated"}
"""Keys of numbers that imitate much: slips are looked for all the same."""


class Search:
    """The search for the stories of one term, in stages that may be left out, each of which knows what was found.

    Parameters
    ----------
    until : float
        The processor time at which the last stage ends, whatever was found.
    """

    def __init__(self, case: Case, term: str, catalogue: Catalogue, until: float) -> None:
        self.case, self.term, self.catalogue, self.until = case, term, catalogue, until
        self.before = case.score(term)
        self.good: dict[frozenset[object], Story] = {}
        self.near: list[Near] = []
        self.seen: set[frozenset[object]] = {frozenset()}
        self._whole, self._single = (catalogue.of(term, one, self.before.error) for one in (False, True))
        self._near_slips: list[Hypothesis] = []
        self._others: set[frozenset[object]] = set()
        self._heard: set[tuple[frozenset[object], frozenset[int]]] = set()
        self._beam: list[Story] = []
        self.tried = self.toggled = self.slipped = self.remerged = self.reread = False

    @property
    def late(self) -> bool:
        return time.process_time() > self.until

    @property
    def held(self) -> list[Story]:
        """What explains it, and rests on no term that has no cause itself."""
        return [s for s in self.good.values() if all(set(h.made_of) <= self.catalogue.settled for h in s)]

    @property
    def open(self) -> bool:
        return not self.held

    @property
    def exact(self) -> bool:
        """Whether something explains all of it, not what is the same with its velocities alone."""
        return any(all(h.key not in SAME for h in s) for s in self.good.values())

    def doubtful(self, explained: Collection[str], examined: Collection[object]) -> bool:
        """Whether nothing explains it but estimated numbers, what right terms contradict, or terms without a cause.

        Causes that were `examined` are those beside which slips were looked for already.
        """
        told = ([h for h in s if h.key not in SAME and h.cause not in examined] for s in self.good.values())
        return all(cost(some) > PLAIN or any(self._doubts(h, explained) for h in some) for some in told)

    def _doubts(self, h: Hypothesis, explained: Collection[str]) -> bool:
        unsure = (h.key in DOUBTFUL and h.cost > KNOWN) or not set(h.made_of) <= set(explained)
        return unsure or bool(spared(self.case, h))

    def known(self, others: Sequence[Story]) -> None:
        """Try what explains other terms: as it is, as other formulations show it, and with any factorisation."""
        mine = {identity(s): s for s in (tuple(h for h in story if self.term in h.terms) for story in others)}
        self.consider(mine.values())
        # finding what other formulations show takes long: where these explain it, what has a name of its own is told
        fresh: dict[frozenset[object], Story] = {}
        for story in others if not self.exact else [s for s in others if any(h.named for h in s)]:
            if (heard := (as_causes(story), self.catalogue.used)) in self._heard:
                continue
            self._heard.add(heard)
            shown = [self._shown(h) for h in story]
            several = itertools.islice(itertools.product(*(s or [()] for s in shown)), VARIANTS)
            made = (s for some in several if in_one_run(s := ordered(itertools.chain(*some))))
            fresh |= {identity(s): s for s in itertools.chain(made, *shown)}
        new = sorted((s for key, s in fresh.items() if key not in self.seen), key=partial(strange, self.case))
        soon = min(self.until, time.process_time() + KIN)
        mine |= {identity(s): s for s in self.catalogue.nearest(self.term, new, soon)}
        self._others |= {key for key in fresh if key in self.seen}
        mine |= {identity(story): story for story in made_of(self.case, self.term, others, self.exact)}
        self._others |= set(mine)
        alike = [h for h in self._whole if h.key in SAME]
        self.consider([*mine.values(), *(ordered((*s, h)) for s in mine.values() for h in alike)])
        if not self.exact:  # it may follow from other terms; not from what may as well follow from it
            apart = [h for h in self._whole if h.made_of and not any(self.term in PARTS.get(t, ()) for t in h.made_of)]
            self.consider([(h,) for h in apart])

    def shared(self, causes: Sequence[Story]) -> None:
        """Whether the causes of most terms are behind this one too, although it is explained."""
        mine = {h.mistake or h.cause for s in self.good.values() for h in s}
        shown = {identity(s): s for cause in causes for h in cause for s in self._shown(h)}
        new = (s for key, s in shown.items() if key not in self.seen and not mine & as_causes(s))
        self.consider(self.catalogue.nearest(self.term, sorted(new, key=partial(strange, self.case)), self.until))
        self._others |= shown.keys() & self.good.keys()

    def exchanged(self, others: Iterable[Search]) -> None:
        """In stories of several causes: what explains another term as well as a cause that right terms contradict."""
        told = [[s[0] for s in other.stories if len(s) == 1] for other in others]
        self.consider(instead(self.case, [s for s in self.stories if len(s) > 1], told, self._shown)[:STORIES])

    def composed(self) -> None:
        """Whether it follows from other terms: soon seen, so also where no time is left."""
        if self.open:
            self.consider([(h,) for h in self._whole if h.made_of])

    def singles(self) -> None:
        """Single causes."""
        self.tried = True
        self.consider([(h,) for h in (*self._fits(()), *self._whole, *self._single)])

    def several(self) -> None:
        """Causes of one link or joint that hold for several."""
        self.toggled = True
        self.consider(growing(self.case, self.term, self._single, self._part()))

    def slips(self) -> None:
        """Slips of textbook algorithms."""
        self._late_rules(SLIPS)
        self.slipped = True

    def _late_rules(self, late: int) -> None:
        near = self.consider(self.catalogue.slips(self.term, self.until, late=late))
        self._near_slips += [h for n in near for h in n.story]

    def merging(self, causes: Sequence[Story]) -> None:
        """Slips in merging fixed links and in reading tensors: they take as long as all others, and explain less.

        A file is read once: where another term that they would change is right, or explained, they are no cause.
        """
        sure = {t for t, s in self.case.told.items() if not any(h.key in DOUBTFUL or h.made_of for h in s[0])}
        known = sure.union(t for t in self.case.observed if t not in self.case.wrong)
        if self.term in INERTIAL and known.isdisjoint(OF_MASSES):
            self._late_rules(MERGING)
            self._slips_with(self._nearest(causes), MERGING)
        self.remerged = True

    def sums(self) -> None:
        """Two causes whose changes add up, of all that were looked at."""
        if self.before.error >= SMALL:
            self.consider(self.catalogue.sums(self.term, [*self._whole, *self._single]))

    def readings(self) -> None:
        """Rare readings of the file and of inputs: few beside the slips, and one may explain all terms."""
        self._late_rules(READINGS)
        self.reread = True

    def slips_besides(self, causes: Sequence[Story], most: bool, nearer: bool = False) -> None:
        """Slips, beside a cause of other terms that does not explain all of this one; with both it may look worse.

        `most` says that most terms are explained: slips are looked for beside their causes first, and alone if there is
        time.  `nearer` says that only causes count that bring what is predicted nearer.
        """
        near = [n for n in self._nearest(causes) if not nearer or n.score.rms < self.before.rms]
        known, more = {identity(n.story) for n in near}, mostly(self.near if self.slipped else ())
        self._slips_with([*near, *(n for n in more if identity(n.story) not in known)], share=1.0 if most else BESIDE)

    def two_slips(self) -> None:
        """Slips beside those of the same algorithm that come nearest."""
        self._slips_with(self._best_slips[:NEAREST])

    def readings_near(self) -> None:
        """Readings of the whole file and of inputs, beside the slips that come nearest."""
        read = [h for h in self._whole if h.place in READ and shows(self.case, h)]
        for n in self._best_slips[:BESIDES]:
            if self.open and n.score.rms < NEAR * self.before.rms:
                self.consider(self.catalogue.nearest(self.term, self._with(n.story, read), self._part()))

    @property
    def _best_slips(self) -> list[Near]:
        slips = [n for n in self.near if len(n.story) == 1 and n.story[0].place == "formula"]
        return distinct(sorted(slips, key=lambda n: n.score.rms))

    def slips_near(self) -> None:
        """Slips, beside the causes of the whole robot that come nearest."""
        near = [n for n in self.near if len(n.story) == 1 and n.story[0].cost <= WHOLE]
        self._slips_with([n for n in sorted(near, key=lambda n: n.score.rms) if n.score.rms < self.before.rms])

    def _nearest(self, causes: Sequence[Story]) -> list[Near]:
        """Causes of other terms as they show in this one, alone and as they hold together there, the nearest first."""
        shown = [(s, s[0].variant == h.variant) for c in causes for h in c for s in self._shown(h)]
        shown += [(c, True) for c in causes if len(c) > 1 and all(self.term in h.terms for h in c)]
        here = {identity(s): (s, alike) for s, alike in shown if identity(s) not in self.good}
        scores = self.case.scores(self.term, [s for s, _ in here.values()])
        near = [(nearness(s, x), alike) for (s, alike), x in zip(here.values(), scores, strict=True)]
        return [n for n, _ in sorted(near, key=lambda x: far(*x)) if np.isfinite(n.score.error)]

    def _slips_with(self, nearest: Sequence[Near], late: int = SLIPS, share: float = BESIDE) -> None:
        begun = time.process_time()
        until = begun + share * (self.until - begun)
        for k, (cause, soon) in enumerate(bases(nearest)):
            took = time.process_time() - begun
            if (self.open or self._unsure) and (soon or took < QUICK) and not (k and begun + took > until):
                self.consider(self.catalogue.slips(self.term, until, cause.story, late), until)

    @property
    def _unsure(self) -> bool:
        """Whether all that explains it needs a wrong pose or velocity of links, against poses and velocities."""

        def against(h: Hypothesis) -> bool:
            return in_poses(h) and not POSES.isdisjoint(spared(self.case, h))

        return all(any(map(against, s)) for s in self.held)

    def _shown(self, h: Hypothesis) -> list[Story]:
        """A cause of other terms as it shows in this one."""
        same = [(h,)] if self.term in h.terms else []
        return [*same, *((k,) for k in self.catalogue.kin(h, self.term))]

    def added(self, found: Sequence[Story], told: Collection[object]) -> None:
        """What explains other terms, and one cause more; beside a slip, one that changes what its algorithm answers.

        Of readings, beside a slip, only those that are `told` of another term: each makes a robot of its own.
        """
        for story in self._besides(found):
            whole = self.catalogue.of(self.term, False, self.case.score(self.term, story).error)
            for more in ([*self._fits(story), *whole], self._single):  # a link alone is rarer
                if self.open:
                    edits = not any(h.place == "formula" for h in story)
                    some = [
                        h for h in more if h.place not in READ or h.cause in told or (edits and shows(self.case, h))
                    ]
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
            whole = [h for h in self._whole if shows(self.case, h)]
            near = [n for n in self.near if len(n.story) == 1 and n.story[0].cost <= WHOLE]
            beam = kept([n for n in near if shows(self.case, n.story[0])])
            more = pairs_of_forces(self.case, self.term)  # a spring with a rest position, and the like
            nearest = itertools.combinations([h for (h,) in kept(near)], 2)  # what other terms speak against too
            more += [ordered(two) for two in nearest if joins(two[1], two[:1])]
            level = self.consider([*more, *(s for story in beam for s in self._with(story, whole))], self._part())
            self._further(level, whole)
            if self.term == "fk" and self.open:
                self._two_readings(whole)

    def _two_readings(self, whole: Sequence[Hypothesis]) -> None:
        """Two mistakes in reading placements: rotations are a product, so that none alone comes near."""
        read = [h for h in whole if h.place == "edit"]
        two = [ordered(pair) for pair in itertools.combinations(read, 2) if joins(pair[1], pair[:1])]
        begun = time.process_time()
        self.consider(self.catalogue.nearest(self.term, sorted(two, key=cost), begun + PLACED * (self.until - begun)))

    def _further(self, near: Sequence[Near], more: Sequence[Hypothesis]) -> None:
        """One cause more, beside what leaves little."""
        until = self._part()
        for n in sorted(near, key=lambda n: n.score.rms)[:FEW_CAUSES]:
            if self.open and n.score.rms < LITTLE * self.before.rms and time.process_time() < until:
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
        level = pairs_of_forces(self.case, self.term)
        single = self._single if len(self.case.robot) <= LARGE else []
        for story in self._beam:
            level += self._with(story, [*self._fits(story), *self._whole, *self._near_slips, *single])
        self._beam = kept(self.consider(level))

    def triples(self) -> None:
        """And three."""
        if self.open and self._beam:
            more = [*self._whole, *self._near_slips]
            self.consider([s for b in self._beam for s in self._with(b, [*self._fits(b), *more])])

    def explanation(self) -> Explanation:
        """What was found."""
        found = Explanation(self.term, self.before, self.stories)
        if not found.stories and self.near:
            best = min(self.near)
            found.nearest, found.left = best.story, best.score
        return found

    @property
    def stories(self) -> list[Story]:
        """The cheapest that explain it; what explains other terms too may cost more."""
        good = list(self.good.values())
        if any(len(s) == 1 and s[0].place != "relation" for s in good):  # what predicts all of it is no mere relation
            good = [s for s in good if all(h.place != "relation" for h in s)]
        found = cheapest(good)
        told, others = {identity(s) for s in found}, set(map(identity, good)) & self._others
        return found + [s for s in good if identity(s) in others - told]

    # how

    def _fits(self, story: Story) -> list[Hypothesis]:
        return fits(self.case, self.term, story)

    def _with(self, story: Story, more: Iterable[Hypothesis]) -> list[Story]:
        return [ordered((*story, h)) for h in more if joins(h, story)]

    def consider(self, stories: Iterable[Story], until: float | None = None) -> list[Near]:
        """Score stories, in blocks so that time can run out between; those that do not explain all come back."""
        fresh = {key: s for s in stories if s and (key := identity(s)) not in self.seen}
        found = []
        for block in in_time(list(fresh.values()), until or self.until, STORIES):
            self.seen |= set(map(identity, block))
            for story, score in zip(block, self.case.scores(self.term, block), strict=True):
                right = score.right and (QUESTIONS[self.term].solves or to_rounding(story, score))
                if right and not contradicted(self.case, story):
                    self.good[identity(story)] = story
                elif np.isfinite(score.error):
                    found.append(nearness(story, score))
        self.near += found
        return found

    def _part(self) -> float:
        return PAIRED * self.until + (1 - PAIRED) * min(time.process_time(), self.until)
