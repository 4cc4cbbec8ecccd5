"""The smallest stories under which the subject's answer to one term is right.

Here are single causes, and those about one link or joint that hold for several.  Nearness is the share of
entries that are right, and the root mean square: the worst entry hides what a partial story repairs.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import partial

import numpy as np

from ..subjects.questions import QUESTIONS
from .case import Case
from .catalogue import Catalogue
from .choice import as_causes
from .fits import fits
from .hypothesis import ESTIMATED, Hypothesis, Story, cost, identity, ordered
from .rules.composed import PARTS
from .rules.derived import made_of
from .rules.register import READINGS, SLIPS
from .several import far, growing, strange
from .spared import contradicted, instead, spared
from .stories import (
    Explanation,
    Near,
    cheapest,
    in_every_way,
    in_time,
    joins,
    nearness,
    throughout,
    to_rounding,
)

STORIES = 64  # scored before the time is looked at, at most
KIN = 0.6  # seconds for what explains other terms as other formulations show it, the likeliest of them first
SMALL = 1e-5  # an error below which two causes together are not looked for: precision has one
PLAIN = 2.0
"""The cost of two plain causes: where only dearer stories explain a term, two causes are looked for all the same."""
KNOWN = 1.06
"""The cost of a number that is well known, such as a unit."""
SAME = ("same_cv", "same_product")
"""Matrices that need only do the same as what an earlier term's story predicts."""
PAIRED = 0.25  # of the time that is left, for two causes of the whole robot or for several links: slips come later
DOUBTFUL = ESTIMATED | {"gravity", "tool_offset", "base_offset", "origin_fit", "saturated"}
"""Keys of numbers that imitate much: slips are looked for all the same."""


class Search:
    """The search for the stories of one term, in stages that may be left out, each of which knows what was found.

    Parameters
    ----------
    until : float
        The time of the thread at which the last stage ends, whatever was found.
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
        return time.thread_time() > self.until

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
            if len(story) > 1:
                everyone = list(itertools.chain(*shown))
                shown = [self.catalogue.together(h, s, everyone, self.term) for h, s in zip(story, shown, strict=True)]
            fresh |= {identity(s): s for s in itertools.chain(in_every_way(shown), *shown)}
        mine |= {identity(s): s for s in self._likeliest(fresh)}
        mine |= {identity(story): story for story in made_of(self.case, self.term, others, self.exact)}
        self._others |= set(mine)
        self.consider(mine.values())
        if not self.good:
            each = {h.mistake: h for story in others for h in story}.values()
            helpers = [s for h in each for s in throughout(k for (k,) in self._shown(h))]
            self.consider(self._likeliest({identity(s): s for s in helpers}))
        if not self.exact:  # it may follow from other terms; not from what may as well follow from it
            alike = [h for h in self._whole if h.key in SAME]
            self.consider([ordered((*s, h)) for s in mine.values() for h in alike])
            apart = [h for h in self._whole if h.made_of and not any(self.term in PARTS.get(t, ()) for t in h.made_of)]
            self.consider([(h,) for h in apart])

    def _likeliest(self, fresh: Mapping[frozenset[object], Story]) -> Sequence[Story]:
        """Of what explains other terms, as other formulations show it: what comes nearest."""
        new = sorted((s for key, s in fresh.items() if key not in self.seen), key=partial(strange, self.case))
        self._others |= {key for key in fresh if key in self.seen}
        return self.catalogue.nearest(self.term, new, min(self.until, time.thread_time() + KIN), first=True)

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

    def sums(self) -> None:
        """Two causes whose changes add up, of all that were looked at."""
        if self.before.error >= SMALL:
            self.consider(self.catalogue.sums(self.term, [*self._whole, *self._single]))

    def readings(self) -> None:
        """Rare readings of the file and of inputs: few beside the slips, and one may explain all terms."""
        self._late_rules(READINGS)
        self.reread = True

    def _nearest(self, causes: Sequence[Story]) -> list[Near]:
        """Causes of other terms as they show in this one, alone and as they hold together there, the nearest first."""
        shown = [(s, s[0].variant == h.variant) for c in causes for h in c for s in self._shown(h)]
        shown += [(c, True) for c in causes if len(c) > 1 and all(self.term in h.terms for h in c)]
        here = {identity(s): (s, alike) for s, alike in shown if identity(s) not in self.good}
        scores = self.case.scores(self.term, [s for s, _ in here.values()])
        near = [(nearness(s, x), alike) for (s, alike), x in zip(here.values(), scores, strict=True)]
        return [n for n, _ in sorted(near, key=lambda x: far(*x)) if np.isfinite(n.score.error)]

    def _shown(self, h: Hypothesis) -> list[Story]:
        """A cause of other terms as it shows in this one."""
        same = [(h,)] if self.term in h.terms else []
        return [*same, *((k,) for k in self.catalogue.kin(h, self.term))]

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
                if score.numberless and not self._told_of_others(story):
                    continue
                if right and not contradicted(self.case, story):
                    self.good[identity(story)] = story
                elif np.isfinite(score.error):
                    found.append(nearness(story, score))
        self.near += found
        return found

    def _told_of_others(self, story: Story) -> bool:
        """Whether other terms tell its causes: no number tells one from another."""
        told = {
            cause for t, stories in self.case.told.items() if t != self.term for s in stories for cause in as_causes(s)
        }
        return as_causes(story) <= told

    def _part(self) -> float:
        return PAIRED * self.until + (1 - PAIRED) * min(time.thread_time(), self.until)
