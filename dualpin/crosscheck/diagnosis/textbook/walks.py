"""Walks from a link to the root that find the axes which move it, and those that find others."""

from __future__ import annotations

import numpy as np

from .lists import orders
from .poses import Poses

ALL = "those of all joints, also of those that do not move it"
CHAIN = "those of all joints with a smaller number, as in one chain"

ENDS = ("all but that of the last joint", "all but that of the first joint")


def walks(poses: Poses, base: np.ndarray, before: np.ndarray, links: list[int]) -> dict[str, np.ndarray]:
    """(links, axes): the axes that wrong walks find.

    Parameters
    ----------
    base, before : array
        (axes,): whether an axis is one of a floating base, and the axis of the nearest joint below, or -1.
    """
    right = poses.carries()[links]
    moved = np.array([a.link for a in poses.axes])
    last = np.array([max(np.flatnonzero(r & ~base), default=-1) for r in right])[:, None]
    numbers, own = np.arange(len(moved)), moved == np.array(links)[:, None]
    first = (before < 0) | base[before]
    found = {
        ALL: np.ones_like(right),
        CHAIN: (numbers <= last) | (right & base),
        ENDS[0]: right & (numbers != last),
        ENDS[1]: right & (base | ~first),
        "all but that of its own link": right & (base | ~own),
        "only that of the last joint": right & (base | (numbers == last)),
        "those of the joints, without the base": right & ~base,
        "those of joints up to the first fixed one on the way": np.array([_to_fixed(poses, k) for k in links]),
    }
    for words, order in orders(poses.parent).items():
        if words.endswith("(breadth first)"):
            rank = np.array([order.index(k) for k in moved])
            ends = np.array([max([rank[i] for i in np.flatnonzero(r & ~base)], default=-1) for r in right])
            earlier = (rank <= ends[:, None]) | (right & base)
            found["those of all joints with a smaller number, breadth first"] = earlier
    return found


def _to_fixed(poses: Poses, link: int) -> np.ndarray:
    """The axes that a walk finds which ends at the first fixed joint."""
    found = np.zeros(len(poses.axes), bool)
    while link >= 0 and poses.of_link[link]:
        found[poses.of_link[link]] = True
        link = poses.parent[link]
    return found
