"""Walks from a link to the root that find the axes which move it, and those that find others."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from .lists import by_stack, orders
from .poses import Poses
from .tree import Tree

ALL = "those of all joints, also of those that do not move it"
CHAIN = "those of all joints with a smaller number, as in one chain"

OWN = "all but that of its own link"
TO_FIXED = "those of joints up to the first fixed one on the way"
ENDS = ("all but that of the last joint", "all but that of the first joint")


def walks(poses: Poses, base: np.ndarray, before: np.ndarray, links: list[int]) -> dict[str, np.ndarray]:
    """(links, axes): the axes that wrong walks find; not to be written to, since they are kept for the next run.

    Parameters
    ----------
    base, before : array
        (axes,): whether an axis is one of a floating base, and the axis of the nearest joint below, or -1.
    """
    tree = tuple(poses.parent), tuple(map(tuple, poses.of_link)), tuple(a.link for a in poses.axes)
    names = tuple(poses.d.listed), tuple(p.joint for p in poses.d.parts)
    key = tree, names, base.tobytes(), np.asarray(before).tobytes(), tuple(links)
    known = _FOUND.get(key)
    if known is None:
        if len(_FOUND) >= MOST:
            _FOUND.clear()
        known = _FOUND[key] = _found(poses, base, before, links)
    return known


MOST = 256  # questions whose answers are kept: those of a few trees
_FOUND: dict[Hashable, dict[str, np.ndarray]] = {}


def _found(poses: Poses, base: np.ndarray, before: np.ndarray, links: list[int]) -> dict[str, np.ndarray]:
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
        OWN: right & (base | ~own),
        "only that of the last joint": right & (base | (numbers == last)),
        "those of the joints, without the base": right & ~base,
        TO_FIXED: np.array([_to_fixed(poses, k) for k in links]),
    }
    for words, order in _listed(poses).items():
        rank = np.array([order.index(k) for k in moved])
        ends = np.array([max([rank[i] for i in np.flatnonzero(r & ~base)], default=-1) for r in right])
        own_ends = np.array([order.index(k) for k in links])
        for what, upto in (("with a smaller number", ends), ("with a smaller number than the link", own_ends)):
            earlier = (rank <= upto[:, None]) | (right & base)
            if not any(np.array_equal(earlier, x) for x in found.values()):
                found[f"those of all joints {what}, {words}"] = earlier
    return found


def of_joints(tree: Tree) -> dict[str, np.ndarray]:
    """(links, links): the joints that walks from the link of a joint find, the right one first."""
    numbers, moves = np.arange(len(tree.links)), np.array([k.moves for k in tree.links])
    right = np.zeros((len(numbers), len(numbers)), bool)
    for k in tree.links:
        right[k.number, [x.number for x in tree.joints_of(k)]] = True
    first = np.array([min(np.flatnonzero(r), default=-1) for r in right])[:, None]
    to_fixed = right.copy()
    for k in tree.links[1:]:
        to_fixed[k.number] &= k.moves * (to_fixed[k.parent] | (numbers == k.number))
    found = {
        "": right,
        OWN: right & ~np.eye(len(right), dtype=bool),
        ENDS[1]: right & (numbers != first),
        TO_FIXED: to_fixed,
    }
    for words, order in orders([k.parent for k in tree.links]).items():
        rank = np.array([order.index(k) for k in range(len(order))])
        name = "those of all joints with a smaller number, breadth first" if "breadth" in words else CHAIN
        found[name] = moves & (rank <= rank[:, None])
    return found


def _listed(poses: Poses) -> dict[str, list[int]]:
    """The links in the orders of codes."""
    place = {joint: k for k, joint in enumerate(poses.d.listed)}
    of_file = sorted(range(len(poses.d.parts)), key=lambda k: place.get(poses.d.parts[k].joint, k))
    by_level = orders(poses.parent).get(" (breadth first)", [*range(len(poses.parent))])
    return {
        "depth first": [*range(len(poses.parent))], "breadth first": by_level,
        "in the order of a stack": by_stack(poses.parent), "in the order of the file": [0, *(k + 1 for k in of_file)],
    }  # fmt: skip


def _to_fixed(poses: Poses, link: int) -> np.ndarray:
    """The axes that a walk finds which ends at the first fixed joint."""
    found = np.zeros(len(poses.axes), bool)
    while link >= 0 and poses.of_link[link]:
        found[poses.of_link[link]] = True
        link = poses.parent[link]
    return found
