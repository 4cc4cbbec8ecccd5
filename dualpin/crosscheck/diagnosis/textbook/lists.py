"""The orders in which codes list links and joints, and what stands beside a joint there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..description import Description, Part
from .lumps import listed

Neighbours = dict[str, np.ndarray]
"""For each axis, by words, the number of another one, or -1."""


def orders(parent: Sequence[int]) -> dict[str, list[int]]:
    """The links, which are numbered branch by branch; level by level too where that differs."""
    by_branch, by_level = list(range(len(parent))), by_queue(parent)
    return {"": by_branch} if by_level == by_branch else {" (depth first)": by_branch, " (breadth first)": by_level}


def by_queue(parent: Sequence[int]) -> list[int]:
    """The links level by level."""
    found = [0]
    for k in found:
        found += [child for child, up in enumerate(parent) if up == k]
    return found


def by_stack(parent: Sequence[int]) -> list[int]:
    """The links as a stack gives them, on which the children of each are laid: the last child first."""
    stack, found = [0], list[int]()
    while stack:
        found.append(stack.pop())
        stack += [k for k, up in enumerate(parent) if up == found[-1]]
    return found


ORDERS = {"breadth first": by_queue, "as a stack gives them": by_stack}
"""Other orders of links, of the numbers of their parents where these are numbered branch by branch."""
LISTED = {"breadth first": " (breadth first)", "as a stack gives them": " (depth first)"}
"""What they are called."""


def branched(d: Description) -> bool:
    """Whether level by level is another order than branch by branch."""
    return [p.joint for p in by_levels(d).parts] != [p.joint for p in listed(d)]


def by_levels(d: Description) -> Description:
    """With its parts level by level, siblings as in the file."""
    parts = listed(d)
    level, found = [d.root], list[Part]()
    for link in level:
        below = [p for p in parts if p.parent == link]
        found += below
        level += [p.link for p in below]
    return replace(d, parts=tuple(found))


def beside(parent: Sequence[int], links: Sequence[int], apart: Sequence[np.ndarray]) -> tuple[Neighbours, Neighbours]:
    """The axes before and after each one in these lists, where that is none of `apart` for some."""
    before, after = Neighbours(), Neighbours()
    for words, order in orders(parent).items():
        ranked = sorted(range(len(links)), key=[order.index(k) for k in links].__getitem__)
        previous, following = np.full(len(links), -1), np.full(len(links), -1)
        previous[ranked[1:]], following[ranked[:-1]] = ranked[:-1], ranked[1:]
        if not any(np.array_equal(previous, x) for x in apart):
            before[f"the joint before in the list{words}"] = previous
        if not any(np.array_equal(following, x) for x in apart):
            after[f"the next joint in the list{words}"] = following
    return before, after
