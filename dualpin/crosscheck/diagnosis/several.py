"""Single links or joints that a cause holds for together, and stories beside which others are looked for, in turns."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from .case import Case
from .choice import as_causes
from .hypothesis import Hypothesis, Story, cost, style
from .rules.dynamics import FUSED
from .stories import Near, merged


def growing(case: Case, term: str, single: Sequence[Hypothesis], until: float) -> list[Story]:
    """For each family: the links or joints that together come nearest, added one at a time while that helps."""
    families: dict[tuple[str, str, str], list[Hypothesis]] = {}
    for h in single:
        families.setdefault((h.key, h.says, h.values), []).append(h)
    before = case.score(term).rms
    found = [(family, list[Hypothesis](), before) for family in families.values() if len(family) > 1]
    out = list[Story]()
    while found and time.thread_time() < until:  # all families in one run
        rest = [[h for h in family if h not in chosen] for family, chosen, _ in found]
        tried = [(merged([*chosen, h]),) for (_, chosen, _), more in zip(found, rest, strict=True) for h in more]
        scores = iter(case.scores(term, tried))
        grown = []
        for (family, chosen, rms), more in zip(found, rest, strict=True):
            best = min(((next(scores), k) for k in range(len(more))), key=lambda x: (x[0].rms, x[1]), default=None)
            better = best is not None and best[0].rms < rms * (1 - 1e-9)
            if best is not None and better:
                chosen = [*chosen, more[best[1]]]
            if best is not None and better and not best[0].right:
                grown.append((family, chosen, best[0].rms))
            elif len(chosen) > 1:
                out.append((merged(chosen),))
        found = grown
    return out


MADE, MOST_MADE = 6, 16  # variants of a cause beside which slips are looked for: at least, and where that is quick
READINGS = 2  # of the file: beside each all algorithms are run again


def bases(nearest: Sequence[Near]) -> list[tuple[Near, bool]]:
    """Stories beside which slips are looked for, in this order, and whether also where that takes long.

    A reading that stands first comes first; then slips, beside which only those of their own algorithms are.
    """
    made = [n for n in nearest if any(h.place == "formula" for h in n.story)]
    readings = [n for n in nearest if n not in made][:READINGS]
    first = readings[:1] if nearest and nearest[0] in readings else []
    turns = [(n, k < MADE) for k, n in enumerate(in_turns(made)[:MOST_MADE])]
    return [*((n, True) for n in first), *turns, *((n, True) for n in readings[len(first) :])]


OWN_PARTS = ("answer", "formula")
MOSTLY = 0.5
"""The share of right entries from which slips are looked for beside what explains these."""


def mostly(near: Iterable[Near]) -> list[Near]:
    """Of what alone explains most of a term: the best slip, and the best of the subject's own other answers."""
    found = sorted(n for n in near if n.score.share >= MOSTLY)
    alone = [next((n for n in found if {h.place for h in n.story} == {place}), None) for place in OWN_PARTS]
    return [n for n in alone if n is not None]


def far(n: Near, alike: bool) -> tuple[float, bool, float, float]:
    """What puts more entries right comes first, then the variant that explains other terms, then the plainest."""
    return -round(n.score.share, 2), not alike, float(f"{n.score.rms:.9g}"), cost(n.story)


def distinct(near: Iterable[Near]) -> list[Near]:
    """The first of those that come equally near."""
    return list({float(f"{n.score.rms:.9g}"): n for n in reversed([*near])}.values())[::-1]


OF_A_STEP = 4  # of a step that are tried on other terms as they are; others are its kin there


def few_of_each(stories: Iterable[Story]) -> list[Story]:
    """The first variants of the same causes, or of the same steps in whatever way rotations are made."""
    seen, found = Counter[frozenset[Any]](), list[Story]()
    for s in stories:
        steps = frozenset(h.mistake[:3] or h.cause for h in s)
        seen[steps] += 1
        if seen[steps] <= OF_A_STEP:
            found.append(s)
    return found


def distinct_causes(stories: Sequence[Story]) -> list[Story]:
    """The first story of each single cause."""
    first: dict[frozenset[Any], Story] = {as_causes(s): s for s in reversed(stories) if len(s) == 1}
    return [*first.values()][::-1]


def strange(case: Case, story: Story) -> int:
    """In how many formulations it is made in which nothing is told: one code has few."""
    told = {(style(h), h.variant) for stories in case.told.values() for s in stories[:1] for h in s}
    return len({(style(h), h.variant) for h in story} - told)


def in_turns(near: Sequence[Near]) -> list[Near]:
    """The nearest of each algorithm, then the next of each: of links that are merged, and of those that are not."""
    places: Counter[str] = Counter()
    ranked = []
    for n in near:
        algorithm = ", ".join(style(h) + h.variant.replace(FUSED, "").strip(", ") for h in n.story)
        ranked.append((places[algorithm], n))
        places[algorithm] += 1
    return [n for _, n in sorted(ranked, key=lambda x: x[0])]
