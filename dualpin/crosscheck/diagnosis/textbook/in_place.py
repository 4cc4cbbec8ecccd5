"""Arrays that are changed in place where new ones were meant: w = w_p, then w += z qd.

All links then share one array, to which each adds its own in the order of the list.  What reads it in the loop finds
the sum so far, which is that of the link before; what reads it behind the loop finds the sum over all links.

    w_up = steps.pick(array("velocity"), w_up, **found(w[-1], whole))       # in the loop
    w = afterwards(steps, "velocity", w, whole)                             # behind it
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .steps import Steps

SO_FAR = "its parent's, changed in place: the sum so far"
GROWING = "its parent's, changed in place: the sum so far in the loop, that over all links behind it"
WHOLE = "its parent's, changed in place: the sum over all links"
ADDED = "that of all links, since the list repeats one array: the sum over all links"
LAST = "that of all links, since the list repeats one array: what the last link leaves"
KEPT = "that of the body before, not set to zero: columns of joints that do not move this body are left in it"
SPIN, SPEED = "angular velocity", "linear velocity"
Whole = Callable[[], np.ndarray] | None
"""The sum over all links, where it is known before the loop."""


def array(of: str) -> str:
    """The site."""
    return f"the array of a link's {of}"


def found(before: np.ndarray, whole: Whole = None) -> dict[str, np.ndarray | Callable[[], np.ndarray]]:
    """What a link finds in the loop, in the place of what its parent has."""
    return {SO_FAR: before, GROWING: before} | ({} if whole is None else {WHOLE: whole})


def afterwards(steps: Steps, of: str, xs: list[np.ndarray], whole: Whole = None) -> list[np.ndarray]:
    """What is found behind the loop, in the place of what links have."""
    others = {GROWING: xs[-1]} | ({} if whole is None else {WHOLE: whole})
    return [steps.pick(array(of), x, **others) for x in xs]


def repeated(rows: list[np.ndarray]) -> dict[str, np.ndarray]:
    """What any link has where a list repeats one array, [x] * n, and links add to it or write into it."""
    return {ADDED: sum(rows[1:], rows[0]), LAST: rows[-1]} if rows else {}


def in_one_array(J: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """(..., bodies, 6, axes): what bodies find in one array in which each writes the columns that are `moved`."""
    found, mine = J.copy(), np.broadcast_to(moved, J.shape).astype(bool)
    for k in range(1, J.shape[-3]):
        found[..., k, :, :] = np.where(mine[..., k, :, :], J[..., k, :, :], found[..., k - 1, :, :])
    return found
