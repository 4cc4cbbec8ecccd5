"""The parts of Steiner's term, m (d.d 1 - d d^T), and what codes write in their places."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .steps import Steps

ONE = np.eye(3)
SQUARE, OUTER = "d.d 1 in Steiner's term", "d d^T in Steiner's term"
MERGING = " of merging"
"""Where fixed links are merged: the same mistake as elsewhere, of a function that both call."""


def square(steps: Steps, d: np.ndarray, where: str = "") -> np.ndarray:
    """d.d 1."""
    whole = (d * d).sum(-1)[..., None, None]
    return np.asarray(steps.pick(SQUARE + where, whole * ONE, **_each(d), **{"|d| 1": lambda: np.sqrt(whole) * ONE}))


def outer(steps: Steps, d: np.ndarray, where: str = "") -> np.ndarray:
    """d d^T."""
    right = d[..., :, None] * d[..., None, :]
    rows = np.broadcast_to((d * d)[..., None, :], right.shape)
    both = ("row", rows), ("column", rows.swapaxes(-1, -2))
    lines = {f"the product d d by elements, in each {x}": y for x, y in both}
    return np.asarray(steps.pick(OUTER + where, right, **_each(d), **lines))


def _each(d: np.ndarray) -> dict[str, Callable[[], np.ndarray]]:
    return {
        "d.d, in each entry": lambda: (d * d).sum(-1)[..., None, None] + 0 * ONE,
        "the product d d by elements, on the diagonal alone": lambda: (d * d)[..., None, :] * ONE,
    }
