"""Velocities in two sets of columns, u = G w: what is written in u's columns is rewritten in w's.

    v = G w         tau_w = G^T tau               M_w = G^T M G            a_w = G^-1 (a - G' w)
    J_w = J G       h_w = G^T (h + M G' w)        C_w = G^T (C G + M G')   J'_w = J' G + J G'

G' is the rate of G.  G may have more rows than columns: joints that follow others are then columns of
u, and not of w.  This is the one place where quantities change their columns: a subject's answers are
predicted by it (u are dualpin's columns, w the subject's), and an oracle's are read by it (u are the
oracle's, w dualpin's).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np


def transposed(x: np.ndarray) -> np.ndarray:
    return np.swapaxes(x, -1, -2)


def product(A: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A x, of matrices and vectors (n, ...)."""
    return (A @ x[..., None])[..., 0]


class Change:
    """u = G w.

    Parameters
    ----------
    G : array
        (m, k), or (n, m, k) where it depends on the state.
    D : array, optional
        Its rate; none where G is constant.
    inverse : array, optional
        Of G, where it is known.
    """

    def __init__(self, G: np.ndarray, D: np.ndarray | None = None, inverse: np.ndarray | None = None) -> None:
        self.G, self.D = G, D
        self._known = inverse
        self.runs = _runs(G) if G.ndim == 2 else []

    @cached_property
    def inverse(self) -> np.ndarray:
        """G^-1, in the sense of least squares where G has more rows."""
        return np.linalg.pinv(self.G) if self._known is None else self._known

    @cached_property
    def back(self) -> Change:
        """w = G^-1 u, of a square G."""
        H = np.linalg.inv(self.G)
        return Change(H, None if self.D is None else -H @ self.D @ H, inverse=self.G)

    def times(self, runs: int) -> Change:
        """The same for so many runs of samples, one after another."""
        if self.G.ndim == 2:
            return self
        G, D, inverse = (None if x is None else np.tile(x, (runs, 1, 1)) for x in (self.G, self.D, self._known))
        return self if G is None else Change(G, D, inverse)

    def columns(self, x: np.ndarray) -> np.ndarray:
        """x G, of the last axis."""
        if self.runs:
            return x if len(self.runs) == 1 else np.concatenate([x[..., run] for run in self.runs], axis=-1)
        return x @ self._over(self.G, x)

    def rows(self, x: np.ndarray) -> np.ndarray:
        """G^T x, of axis 1."""
        if self.runs:
            return x if len(self.runs) == 1 else np.concatenate([x[:, run] for run in self.runs], axis=1)
        if self.G.ndim == 2:
            return np.moveaxis(np.tensordot(x, self.G, axes=(1, 0)), -1, 1)
        return product(transposed(self.G), x) if x.ndim == 2 else transposed(self.G) @ x

    def solved(self, x: np.ndarray) -> np.ndarray:
        """G^-1 x, of axis 1."""
        if self.runs:
            return self.rows(x)
        return product(self.inverse, x) if x.ndim == 2 else self.inverse @ x

    def turned(self, A: np.ndarray) -> np.ndarray:
        """A G', of the last axis."""
        return np.zeros(self.G.shape[-1]) if self.D is None else A @ self._over(self.D, A)

    def rate(self, w: np.ndarray) -> np.ndarray:
        """G' w."""
        return np.zeros(self.G.shape[-2]) if self.D is None else product(self.D, w)

    @staticmethod
    def _over(G: np.ndarray, x: np.ndarray) -> np.ndarray:
        """One G for each sample, whatever axes stand between: frames."""
        return G if G.ndim == 2 else G.reshape(len(G), *[1] * (x.ndim - 3), *G.shape[1:])


def _runs(G: np.ndarray) -> list[slice]:
    """Which rows of G hold the ones of its columns, as runs of neighbours; none where G does more than permute."""
    square = 0 < G.shape[0] == G.shape[1]
    if not (square and ((G == 0) | (G == 1)).all() and (G.sum(axis=0) == 1).all() and (G.sum(axis=1) == 1).all()):
        return []
    order = G.argmax(axis=0)
    return [slice(run[0], run[-1] + 1) for run in np.split(order, np.flatnonzero(np.diff(order) != 1) + 1)]


Rewriting = Callable[[Change, np.ndarray, np.ndarray, np.ndarray | None], np.ndarray]
"""(change, x, w, other) -> x in w's columns; `other` is M for the forms "bias" and "coriolis", J for "six_rate"."""


def _bias(to: Change, h: np.ndarray, w: np.ndarray, M: np.ndarray | None) -> np.ndarray:
    return to.rows(h if M is None else h + product(M, to.rate(w)))


def _coriolis(to: Change, C: np.ndarray, w: np.ndarray, M: np.ndarray | None) -> np.ndarray:
    return to.rows(to.columns(C) if M is None else to.columns(C) + to.turned(M))


def _six_rate(to: Change, Jd: np.ndarray, w: np.ndarray, J: np.ndarray | None) -> np.ndarray:
    return to.columns(Jd) if J is None else to.columns(Jd) + to.turned(J)


def _inverse(to: Change, W: np.ndarray, w: np.ndarray, other: np.ndarray | None) -> np.ndarray:
    return to.solved(transposed(to.solved(transposed(W))))


def _derivatives(to: Change, x: np.ndarray, w: np.ndarray, other: np.ndarray | None) -> np.ndarray:
    """Of forces by q, v and a; G is constant."""
    return np.stack([to.rows(to.columns(x[:, k])) for k in range(3)], axis=1)


def _each(rewritten: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    """The vectors of each frame, (n, frames, nv)."""
    return np.stack([rewritten(x[:, k]) for k in range(x.shape[1])], axis=1)


REWRITINGS: dict[str, Rewriting] = {
    "plain": lambda to, x, w, other: x,
    "twist": lambda to, x, w, other: x,
    "force": lambda to, x, w, other: to.rows(x),
    "velocity": lambda to, x, w, other: x @ to.inverse.T,
    "acceleration": lambda to, x, w, other: to.solved(x - to.rate(w)),
    "matrix": lambda to, x, w, other: to.rows(to.columns(x)),
    "columns": lambda to, x, w, other: to.columns(x),
    "six": lambda to, x, w, other: to.columns(x),
    "regressor": lambda to, x, w, other: to.rows(x),
    "rows": lambda to, x, w, other: to.rows(x),
    "pushed_force": lambda to, x, w, other: _each(to.rows, x),
    "pushed_acceleration": lambda to, x, w, other: _each(lambda a: to.solved(a - to.rate(w)), x),
    "inverse": _inverse, "bias": _bias, "coriolis": _coriolis, "six_rate": _six_rate, "derivatives": _derivatives,
}  # fmt: skip
"""How each kind of quantity is rewritten."""
SIX = {"twist": -1, "six": -2, "six_rate": -2}
"""The axis of the six rows, of the forms that have them."""
