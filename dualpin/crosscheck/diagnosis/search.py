"""The smallest stories under which the subject's answer to one term is right.

Single hypotheses first, those about one link or joint too; then the links and joints of a promising
family together; then pairs and triples, from the stories that came nearest.  Nearness is the share of
entries that are right, and the root mean square: the worst entry hides what a partial story repairs.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..subjects.questions import QUESTIONS
from .case import Case
from .fits import fits, pairs_of_forces
from .hypothesis import ESTIMATED, Hypothesis, Story, cost, identity, ordered
from .rules import RULES
from .scores import Score
from .textbook.slipped import made_of

DEPTH = 3
BEAM = 8
SMALL = 1e-5  # an error below which two causes together are not looked for: precision has one
PLAIN = 2.0
"""The cost of two plain causes: where only dearer stories explain a term, two causes are looked for all the same."""
SAME = ("same_cv", "same_product")
"""Matrices that need only do the same as what an earlier term's story predicts."""
SQUARE = ("matrix", "inverse", "coriolis", "derivatives")
"""Forms of which one state tells enough to look at slips first."""
FEW = 1e-7
"""The error of a slip at these states up to which it is looked at in all."""
LARGE = 40  # joints from which pairs of single links are not tried


@dataclass
class Explanation:
    """What was found about one term.

    Attributes
    ----------
    before : float
        The error without a story.
    stories : list of Story
        Those that explain it, the cheapest first.
    nearest : Story
        Where none does: the one that comes nearest, with its score.
    """

    term: str
    before: Score
    stories: list[Story] = field(default_factory=list)
    nearest: Story = ()
    left: Score | None = None

    @property
    def named(self) -> bool:
        return bool(self.stories)

    def joined(self, other: Explanation) -> None:
        """What was found of the same term at another time besides."""
        known = {identity(s) for s in self.stories}
        self.stories += [s for s in other.stories if identity(s) not in known]
        self.stories.sort(key=cost)


class Catalogue:
    """All hypotheses of a case, proposed once; those of late rules when they are first needed."""

    def __init__(self, case: Case) -> None:
        self.case, self._cases = case, dict[int, Case]()
        self.all: list[Hypothesis] = [h for rule in RULES if not rule.late for h in rule.propose(case)]

    @cached_property
    def late(self) -> list[Hypothesis]:
        return [h for rule in RULES if rule.late for h in rule.propose(self.case)]

    def of(self, term: str, single: bool, error: float) -> list[Hypothesis]:
        return [h for h in self.all if term in h.terms and h.single == single and error < h.most]

    def slips(self, term: str) -> list[Story]:
        """Single slips of textbook algorithms: those that explain the first states, and those that come nearest."""
        few = self._few(1 if QUESTIONS[term].form in SQUARE else 2)
        groups: dict[Any, list[Hypothesis]] = {}
        for h in (h for h in self.late if term in h.terms):
            groups.setdefault(made_of(h.act, term), []).append(h)
        scores = few.scores(term, [(same[0],) for same in groups.values()])
        told = list(zip(groups.values(), scores, strict=True))
        right: list[Story] = [(h,) for same, score in told if score.error <= FEW for h in same]
        return right or _kept([_near((same[0],), x) for same, x in told if np.isfinite(x.error)])

    def variants(self, stories: Iterable[Story]) -> list[Story]:
        """The same causes by other computations: what one variant explains of a term, another may of the next."""
        if "late" not in self.__dict__:
            return []
        single = [s[0] for s in stories if len(s) == 1]
        return [(h,) for one in single for h in self._by_cause.get(one.cause, ()) if h is not one]

    @cached_property
    def _by_cause(self) -> dict[Any, list[Hypothesis]]:
        groups: dict[Any, list[Hypothesis]] = {}
        for h in self.late:
            groups.setdefault(h.cause, []).append(h)
        return groups

    def _few(self, samples: int) -> Case:
        if samples not in self._cases:
            self._cases[samples] = self.case.few(samples)
        return self._cases[samples]


@dataclass(order=True)
class _Near:
    """A story that does not explain all, by how near it comes."""

    rank: tuple[float, float, float]
    story: Story = field(compare=False)
    score: Score = field(compare=False)


def _near(story: Story, score: Score) -> _Near:
    return _Near((0.02 * cost(story) - score.share, score.rms, cost(story)), story, score)


def explain(
    case: Case, term: str, catalogue: Catalogue, first: Sequence[Story] = (), budget: float = 30.0,
    tick: Callable[[str], None] = lambda what: None, depth: int = DEPTH, slips: bool = False,
) -> Explanation:  # fmt: skip
    """Look for the stories of one term; stories that explained other terms are tried first.

    Slips of textbook algorithms are tried where no single cause explains it, or where they are asked for.
    """
    search = _Search(case, term, time.process_time() + budget)
    found = Explanation(term, case.score(term))
    known = [*first, *catalogue.variants(first)]
    mine = [t for s in known if (t := tuple(h for h in s if term in h.terms))]
    search.consider([*mine, *(catalogue.slips(term) if slips else [])])
    whole, single = (catalogue.of(term, one, found.before.error) for one in (False, True))
    alike = [h for h in whole if h.key in SAME]
    search.consider([ordered((*s, h)) for s in mine for h in alike])
    beam: list[Story] = [(), *(n.story for n in sorted(search.near)[:BEAM])]
    if found.before.error < SMALL:
        depth = min(depth, 1)
    for size in range(1, depth + 1):
        least = min(map(cost, search.good.values()), default=np.inf)
        if search.late or least <= PLAIN or (search.good and size != 2):
            break
        if search.good:  # by numbers of one body: what they may imitate is two mistakes in reading the file
            beam, whole = [s for s in beam if _reads(s)], [h for h in whole if _reads([h])]
        tick(f"{term}: {'single causes' if size == 1 else f'{size} causes together'}")
        level = pairs_of_forces(case, term) if size == 2 and not search.good else []
        for story in beam:
            more = whole if search.good else [*fits(case, term, story), *whole]
            level += [ordered((*story, h)) for h in more if _joins(h, story)]
        if size == 1 or (size == 2 and len(case.robot) <= LARGE and not search.good):
            level += [ordered((*story, h)) for story in beam for h in single if _joins(h, story)]
        near = search.consider(level)
        if size == 1 and not search.good:
            near += search.consider(search.toggled(single, found.before))
        if size == 1 and all(any(h.key == "one_link" for h in s) for s in search.good.values()):
            tick(f"{term}: slips of textbook algorithms")
            slipped = search.consider(catalogue.slips(term))
            near += slipped
            whole = [*whole, *(n.story[0] for n in slipped)]
        beam = _kept(near)
    found.stories = _cheapest(search.good.values())
    told = {identity(s) for s in found.stories}  # what explains other terms too costs nothing more here
    found.stories += [s for s in mine if (key := identity(s)) in search.good and key not in told]
    if not found.stories and search.near:
        best = min(search.near)
        found.nearest, found.left = best.story, best.score
    return found


def _reads(story: Iterable[Hypothesis]) -> bool:
    """Whether it is about reading the file, and estimates nothing."""
    return all(h.place == "edit" and h.key not in ESTIMATED for h in story)


def _doubtful(h: Hypothesis, story: Story) -> bool:
    """Whether other terms must not contradict it: numbers, and several readings of the file, imitate much."""
    return h.key in ESTIMATED or (h.place == "edit" and sum(g.place == "edit" for g in story) > 1)


def _joins(h: Hypothesis, story: Story) -> bool:
    """Whether a hypothesis may join a story: its key is not there yet, but for other links of the same family."""
    return all(g.key != h.key or (g.single and h.single and not set(g.items) & set(h.items)) for g in story)


class _Search:
    """What was tried for one term."""

    def __init__(self, case: Case, term: str, until: float) -> None:
        self.case, self.term, self.until = case, term, until
        self.good: dict[frozenset[object], Story] = {}
        self.near: list[_Near] = []
        self.seen: set[frozenset[object]] = {frozenset()}

    @property
    def late(self) -> bool:
        return time.process_time() > self.until

    def consider(self, stories: Iterable[Story]) -> list[_Near]:
        """Score stories, in blocks so that time can run out between; those that do not explain all come back."""
        fresh = {}
        for s in stories:
            key = identity(s)
            if s and key not in self.seen:
                self.seen.add(key)
                fresh[key] = s
        todo, found = list(fresh.values()), []
        for start in range(0, len(todo), 200):
            if self.late and start:
                break
            block = todo[start : start + 200]
            for story, score in zip(block, self.case.scores(self.term, block), strict=True):
                if score.right and not any(self.case.spared(h) for h in story if _doubtful(h, story)):
                    self.good[identity(story)] = story
                elif np.isfinite(score.error):
                    found.append(_near(story, score))
        self.near += found
        return found

    def toggled(self, single: Sequence[Hypothesis], before: Score) -> list[Story]:
        """For each family: the links or joints that together come nearest, added one at a time while that helps."""
        families: dict[tuple[str, str, str], list[Hypothesis]] = {}
        for h in single:
            families.setdefault((h.key, h.says, h.values), []).append(h)
        out = []
        for family in families.values():
            story = self._toggle(family, before.rms)
            if story:
                out.append(story)
        return out

    def _toggle(self, family: Sequence[Hypothesis], rms: float) -> Story:
        chosen: list[Hypothesis] = []
        while not self.late:
            rest = [h for h in family if h not in chosen]
            scores = self.case.scores(self.term, [(_merged([*chosen, h]),) for h in rest])
            best = min(range(len(rest)), key=lambda k: scores[k].rms, default=None)
            if best is None or not scores[best].rms < rms * (1 - 1e-9):
                break
            chosen.append(rest[best])
            rms = scores[best].rms
            if scores[best].right:
                break
        return (_merged(chosen),) if len(chosen) > 1 else ()


def _merged(chosen: Sequence[Hypothesis]) -> Hypothesis:
    """One hypothesis about several links or joints."""
    if len(chosen) == 1:
        return chosen[0]
    items = tuple(sorted(i for h in chosen for i in h.items))
    first = chosen[0]
    if first.place == "word":  # each names its columns itself
        acts = [h.act for h in chosen]

        def act(w: object) -> object:
            turned: list[str] = []
            for f in acts:
                w = f(w)
                turned += w.turned  # type: ignore[attr-defined]
            return replace(w, turned=tuple(turned))  # type: ignore[type-var]

        return replace(first, items=items, act=act, cost=1.0 + 0.5 * len(chosen))
    return replace(first, items=items, cost=1.0 + 0.5 * len(chosen))


def _kept(near: Sequence[_Near]) -> list[Story]:
    """The most promising, by share and by root mean square; one of those that predict the same."""
    distinct: dict[tuple[float, float], _Near] = {}
    for n in sorted(near):
        distinct.setdefault((round(n.score.share, 9), float(f"{n.score.rms:.9g}")), n)
    by_share = list(distinct.values())
    by_rms = sorted(by_share, key=lambda n: n.score.rms)
    chosen = {id(n): n for n in (*by_share[: BEAM // 2], *by_rms[: BEAM // 2])}
    return [n.story for n in chosen.values()]


def _cheapest(stories: Iterable[Story]) -> list[Story]:
    """Those that claim little more than the cheapest."""
    found = sorted(stories, key=lambda s: (cost(s), len(s)))
    return [s for s in found if cost(s) <= cost(found[0]) + 1.01][:24]
