"""Stories on their way through a search: which come nearest, which fit together, which claim least."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from .hypothesis import ESTIMATED, Hypothesis, Story, Wording, cost, identity, ordered
from .scores import Score
from .textbook import steiner
from .textbook.products import SKEW
from .textbook.slipped import Added, algorithm, in_one, made_with

T = TypeVar("T")
BEAM = 8
VARIANTS = 2304  # of a story of several causes, as formulations show them
ROUNDING = 1e-10
"""An error that two exact causes leave at most."""
BLOCK = 24  # stories that are scored before the time is looked at: at first
LONG = 0.25
"""Seconds of the thread after which it is looked at: blocks of what takes longer become smaller."""


@dataclass(order=True)
class Near:
    """A story that does not explain all, by how near it comes."""

    rank: tuple[float, float, float]
    story: Story = field(compare=False)
    score: Score = field(compare=False)


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


HELPERS = ((SKEW,), (steiner.SQUARE,), (steiner.OUTER,))
"""Mistakes in cross products and in Steiner's term."""


def nearness(story: Story, score: Score) -> Near:
    """By the share of right entries, then by the root mean square; dearer stories later."""
    return Near((0.02 * cost(story) - score.share, score.rms, cost(story)), story, score)


def in_time(todo: Sequence[T], until: float, most: int) -> Iterator[Sequence[T]]:
    """In blocks, until it is late; the first block in any case."""
    start, size = 0, BLOCK
    while start < len(todo) and not (start and time.thread_time() > until):
        begun = time.thread_time()
        yield todo[start : start + size]
        start += size
        took = time.thread_time() - begun
        size = min(most, max(1, int(size * min(4.0, LONG / max(took, 1e-3)))))


def reads(story: Iterable[Hypothesis]) -> bool:
    """Whether it is about reading the file, and estimates nothing."""
    return all(h.place == "edit" and h.key not in ESTIMATED for h in story)


def in_one_run(story: Story) -> bool:
    """Whether one algorithm makes all its slips: one term is not made by two."""
    return not isinstance(in_one([h.act for h in story if h.place == "formula"]), Added)


def in_every_way(shown: Sequence[Sequence[Story]]) -> list[Story]:
    """Stories of several causes, each as it shows in other formulations, where one algorithm makes all of it."""
    made: list[Story] = [()]
    for kin in shown:
        longer = (ordered((*story, *g)) for story in made for g in kin or [()])
        made = list(itertools.islice(filter(in_one_run, longer), VARIANTS))
    return made


def throughout(kin: Iterable[Hypothesis]) -> list[Story]:
    """A slip in a function that several algorithms of a code call: made in two and three of them that are one run.

    Merging fixed links is a robot of its own.
    """
    by_run: dict[Any, dict[Any, Hypothesis]] = {}
    for h in kin:
        if h.mistake[:1] in HELPERS:
            by_run.setdefault(algorithm(h.act), {})[h.identity] = h
    runs, merging = [run for run in by_run if run is not None], by_run.pop(None, {})
    found: list[Story] = [(h, g) for h in merging.values() for run in runs for g in by_run[run].values()]
    two = {pair: both for pair in itertools.combinations(runs, 2) if (both := made_with(*pair)) is not None}
    three = [(*pair, run) for pair, both in two.items() for run in runs if run not in pair and made_with(both, run)]
    found.extend(s for run in runs for s in itertools.combinations(by_run[run].values(), 2))
    for some in (*two, *three):
        found.extend(itertools.product(*(by_run[run].values() for run in some)))
    return list({identity(s): s for s in map(ordered, found)}.values())


def numbers_in(h: Hypothesis, story: Story) -> bool:
    """Whether other terms must not contradict it: numbers, and several readings of the file, imitate much."""
    return h.key in ESTIMATED or (h.place == "edit" and sum(g.place == "edit" for g in story if g.single) > 1)


def to_rounding(story: Story, score: Score) -> bool:
    """Whether several causes leave no more than rounding: of what one nearly explains many make a little less."""
    rounded = any(h.place == "relation" or h.key in ("finite_differences", "follows") for h in story)
    return len(story) == 1 or rounded or score.error <= ROUNDING


def joins(h: Hypothesis, story: Story) -> bool:
    """Whether a hypothesis may join a story: its key is not there yet, but for other links of its family, or steps."""

    def apart(g: Hypothesis) -> bool:
        if h.place == g.place == "formula":
            return h.cause != g.cause
        return g.key != h.key or (g.single and h.single and not set(g.items) & set(h.items))

    return all(map(apart, story))


def merged(chosen: Sequence[Hypothesis]) -> Hypothesis:
    """One hypothesis about several links or joints."""
    if len(chosen) == 1:
        return chosen[0]
    items = tuple(sorted(i for h in chosen for i in h.items))
    first = chosen[0]
    if first.place == "word":  # each names its columns itself
        acts = [h.act for h in chosen]

        def act(w: Wording) -> Wording:
            turned: list[tuple[str, float]] = []
            for f in acts:
                w = f(w)
                turned += w.turned
            return replace(w, turned=tuple(turned))

        return replace(first, items=items, act=act, cost=1.0 + 0.5 * len(chosen))
    return replace(first, items=items, cost=1.0 + 0.5 * len(chosen))


def kept(near: Sequence[Near]) -> list[Story]:
    """The most promising, by share and by root mean square; one of those that predict the same."""
    distinct: dict[tuple[float, float], Near] = {}
    for n in sorted(near):
        distinct.setdefault((round(n.score.share, 9), float(f"{n.score.rms:.9g}")), n)
    by_share = list(distinct.values())
    by_rms = sorted(by_share, key=lambda n: n.score.rms)
    chosen = {id(n): n for n in (*by_share[: BEAM // 2], *by_rms[: BEAM // 2])}
    return [n.story for n in chosen.values()]


def minimal(stories: Sequence[Story]) -> list[Story]:
    """Those that have no other of them as a part."""
    right = set(map(identity, stories))

    def parts(story: Story) -> Iterator[frozenset[Any]]:
        return (identity(some) for n in range(1, len(story)) for some in itertools.combinations(story, n))

    return [s for s in stories if right.isdisjoint(parts(s))]


def cheapest(stories: Iterable[Story]) -> list[Story]:
    """Those that claim little more than the cheapest."""
    found = sorted(stories, key=lambda s: (cost(s), len(s)))
    return [s for s in found if cost(s) <= cost(found[0]) + 1.01][:24]


def together(causes: Sequence[Story]) -> list[Story]:
    """Two and three of the causes that were found, together."""
    return [ordered(h for s in some for h in s) for n in (2, 3) for some in itertools.combinations(causes[:8], n)]


def united(stories: Sequence[Story]) -> list[Story]:
    """Each once."""
    return list({identity(s): s for s in stories}.values())
