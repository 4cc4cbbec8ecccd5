"""The inverse of the mass matrix by its factors, row by row in the subject's order of joints.

    M = L^T D L  (from the tips, without fill-in along branches)   or   M = L D L^T  (from the base)
    H_ij = H_ij - (H_ki / H_kk) H_kj   for all i and j that are left, then  L_ki = H_ki / H_kk
    M^-1 = L^-1 D^-1 L^-T   or   L^-T D^-1 L^-1

References: Featherstone, Efficient Factorization of the Joint-Space Inertia Matrix for Branched Kinematic Trees, IJRR
24 (2005), section 3; Golub and Van Loan, Matrix Computations (2013), section 4.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .assembly import MOST_STEPS
from .steps import Steps

TERMS = ("minv", "aba")
DIAGONAL = "the reduced matrix: on the diagonal"
BESIDE = "the reduced matrix: beside the diagonal"


@dataclass(frozen=True)
class Factors:
    """Makes M^-1, and a = M^-1 (tau - h), of right M and h; `from_base` says at which joint the factors begin."""

    from_base: bool = False

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        """The term (runs, samples, ...)."""
        M, columns = view.compute("crba")[None], _columns(view)
        if columns is None or len(columns) > MOST_STEPS:
            return None
        rows, back = columns[:: -1 if self.from_base else 1], np.argsort(columns[:: -1 if self.from_base else 1])
        inverse = _inverse(steps, M[..., rows[:, None], rows])[..., back[:, None], back]
        if term == "minv":
            return inverse
        return product(inverse, (view.states["tau"] - view.compute("bias"))[None])


def _columns(view: View) -> np.ndarray | None:
    """Where the subject's columns are among dualpin's, since slips depend on the order of rows; of joints alone."""
    place = {j.name: j.v.start for j in view.robot if j.mimic is None and j.model.nv == 1}
    names = view.layout.how.v
    return np.array([place[n] for n in names]) if all(n in place for n in names) else None


def _inverse(steps: Steps, M: np.ndarray) -> np.ndarray:
    n = M.shape[-1]
    right, other = _factors(steps, M, range(n - 1, -1, -1)), _factors(Steps(), M, range(n))
    wrong = {"those of rows taken in the other order": other}
    H = steps.pick("the factors of M", right, **wrong)
    one = np.eye(n)
    L, D = H * np.tri(n, k=-1) + one, (H * one).sum(-1)
    X = _solved(steps, L)
    d = 1.0 / np.where(D == 0, np.nan, D)
    others = {"D, not inverted": D, "1": 1 + 0 * D, "D^-1/2": np.sqrt(np.abs(d))}
    d = steps.pick("D^-1 in M^-1", d, **others)
    made = X @ (d[..., None] * transposed(X))
    others = {
        "with its factors in the other order": lambda: transposed(X) @ (d[..., None] * X),
        "with L, not L^-1": lambda: L @ (d[..., None] * transposed(L)),
        "with L^-1 alone, on the left": lambda: X * d[..., None, :],
        "with L^-1 twice, neither transposed": lambda: X @ (d[..., None] * X),
    }  # fmt: skip
    return np.asarray(steps.pick("M^-1, the product of its factors,", made, **others))


def _factors(steps: Steps, M: np.ndarray, rows: Sequence[int]) -> np.ndarray:
    """(runs, samples, n, n): D on the diagonal, L below it."""
    n = M.shape[-1]
    H = {(i, j): M[..., i, j] for i in range(n) for j in range(i + 1)}
    for k in rows:
        for i in reversed(range(k)):
            others = {"that of the row which is reduced": H[i, i], "1": 1 + 0 * H[k, k]}
            f = H[k, i] / steps.pick("the pivot of a factor", H[k, k], **others)
            for j in range(i + 1):
                kept = {"the factor, which is kept there already": f} if j == i else {}
                of_k = steps.pick("H_kj, by which an entry is reduced,", H[k, j], **kept)
                site = DIAGONAL if i == j else BESIDE
                H[i, j] = steps.add(site, **{"H_ij": H[i, j], "-(H_ki / H_kk) H_kj": -f * of_k})
            H[k, i] = steps.pick("an entry of L", f, **{"H_ki, not divided by the pivot": H[k, i]})
    zero = np.zeros(np.broadcast_shapes(*(x.shape for x in H.values())))
    return np.stack([np.stack([H[i, j] + zero if j <= i else zero for j in range(n)], -1) for i in range(n)], -2)


def _solved(steps: Steps, L: np.ndarray) -> np.ndarray:
    """L^-1, row by row."""
    n, X = L.shape[-1], list[np.ndarray]()
    for k in range(n):
        one = np.eye(n)[k] + 0 * L[..., k, :]
        known = sum((L[..., k, i, None] * X[i] for i in range(k)), 0 * one)
        X.append(steps.add("a row of L^-1", **{"that of 1": one, "-L L^-1": -known}))
    lead = np.broadcast_shapes(*(x.shape for x in X))
    return np.stack([np.broadcast_to(x, lead) for x in X], -2)
