"""Dual linear algebra: solutions, inverses, determinants.

LAPACK factors the real part; the dual part follows from the product rule, (A B)' = A' B + A B'.
Every function takes stacks of matrices (..., m, n), plain or dual, real or complex.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..dual import Dual
from ..errors import ShapeError
from .arguments import EPSILON, H, SingularError, dual_array, finite, length, matrices, scaled, where


def inv(A: Any) -> Dual:
    """The inverse, A^-1 - eps A^-1 A' A^-1.

    Parameters
    ----------
    A : Dual or array_like, shape (..., n, n)

    Returns
    -------
    Dual, shape (..., n, n)

    Raises
    ------
    SingularError
        If the real part is singular.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.6, eqs 27-28.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.algebra.inv(dp.Dual([[1, 2], [3, 3]], [[1, 3], [9, 1]])).dual.round(4).tolist()
    [[7.3333, -4.1111], [-4.6667, 2.2222]]
    """
    a, da = matrices("inv: A", A, square=True)
    x = _attempt("inv", a, lambda: np.linalg.inv(a))
    return Dual(x, -x @ da @ x)


def solve(A: Any, b: Any) -> Dual:
    """The solution of A x = b:  x = A^-1 b,  x' = A^-1 b' - (A^-1 A') x.

    The real part is factored once, with b, b' and A' as its right-hand sides.

    Parameters
    ----------
    A : Dual or array_like, shape (..., n, n)
    b : Dual or array_like, shape (n,) or (..., n, k)
        One-dimensional: a vector; else a stack of matrices, as for ``numpy.linalg.solve``.

    Returns
    -------
    Dual, of the shape of b

    Raises
    ------
    SingularError
        If the real part is singular.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.7, eqs 29-30.

    Examples
    --------
    >>> import dualpin as dp
    >>> x = dp.algebra.solve(dp.Dual([[4, 1], [2, 3]], [[1, 0], [-2, 5]]), dp.Dual([1, 2], [3, -1]))
    >>> x.real.round(12).tolist(), x.dual.round(12).tolist()
    ([0.1, 0.6], [1.25, -2.1])
    """
    a, da = matrices("solve: A", A, square=True)
    b, db, vector = _right_hand_side("solve", a, b)
    k, batch = b.shape[-1], np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    columns = [np.broadcast_to(c, (*batch, *c.shape[-2:])) for c in (b, db, da)]
    y = _attempt("solve", a, lambda: np.linalg.solve(a, np.concatenate(columns, axis=-1)))
    x, dx = y[..., :k], y[..., k : 2 * k] - y[..., 2 * k :] @ y[..., :k]
    return Dual(x[..., 0], dx[..., 0]) if vector else Dual(x, dx)


def lstsq(A: Any, b: Any, rcond: float | None = None) -> Dual:
    """The least squares solution A^+ b, of least norm where A is wide.

        x = A^+ b,   x' = A^+ (b' - A' x) + A^+ A^+H A'^H (b - A x) + (1 - A^+ A) A'^H A^+H x

    which solves the dual normal equations A^H (A x - b) = 0.

    Parameters
    ----------
    A : Dual or array_like, shape (..., m, n)
    b : Dual or array_like, shape (m,) or (..., m, k)
    rcond : float, optional
        See `pinv`.

    Returns
    -------
    Dual, shape (n,) or (..., n, k)

    Raises
    ------
    SingularError
        If the rank of the real part does not allow a dual solution, see `pinv`.

    References
    ----------
    Pennestri & Stefanelli (2007), whose solution is that of `pinv_simple` and not of least squares.

    Examples
    --------
    >>> import dualpin as dp
    >>> A = dp.Dual([[1, 3], [9, 22], [4, 4]], [[4, 0], [2, 4], [4, 1]])
    >>> x = dp.algebra.lstsq(A, dp.Dual([1, 2, 3], [0, 1, -1]))
    >>> x.dual.round(6).tolist()
    [-1.113943, 0.419731]
    """
    a, da = matrices("lstsq: A", A)
    b, db, vector = _right_hand_side("lstsq", a, b)
    p = _pseudo_inverse("lstsq", a, da, rcond)
    x = p @ b
    dx = p @ (db - da @ x) + p @ (H(p) @ (H(da) @ (b - a @ x)))
    y = H(da) @ (H(p) @ x)
    dx = dx + y - p @ (a @ y)
    return Dual(x[..., 0], dx[..., 0]) if vector else Dual(x, dx)


def pinv(A: Any, rcond: float | None = None) -> Dual:
    """The Moore-Penrose inverse, which satisfies all four Penrose conditions in dual arithmetic.

        A^+ + eps [-A^+ A' A^+ + A^+ A^+H A'^H (1 - A A^+) + (1 - A^+ A) A'^H A^+H A^+]

    The second term vanishes for wide matrices of full rank, the third for tall ones, both for regular ones.

    Parameters
    ----------
    A : Dual or array_like, shape (..., m, n)
    rcond : float, optional
        Singular values of the real part below rcond times the largest count as zero; by default
        eps max(m, n), the rounding of the singular value decomposition.

    Returns
    -------
    Dual, shape (..., n, m)

    Raises
    ------
    SingularError
        If the real part lacks full rank and A' does not respect its null spaces,
        (1 - A A^+) A' (1 - A^+ A) != 0: then no dual Moore-Penrose inverse exists.

    References
    ----------
    Golub & Pereyra (1973) for the derivative; Pennestri & Stefanelli (2007), eq 32.  Their eq 33 is
    `pinv_simple`.

    Examples
    --------
    >>> import dualpin as dp
    >>> A = dp.Dual([[1, 3], [9, 22], [4, 4]], [[4, 0], [2, 4], [4, 1]])
    >>> dp.algebra.pinv(A).dual.round(4).tolist()
    [[0.8221, -0.035, -0.4596], [-0.3493, 0.0117, 0.1675]]
    """
    a, da = matrices("pinv: A", A)
    p = _pseudo_inverse("pinv", a, da, rcond)
    y, z = H(da) @ H(p), H(p) @ H(da)
    dp = -p @ da @ p + p @ (z - (z @ a) @ p) + (y - p @ (a @ y)) @ p
    return Dual(p, dp)


def pinv_simple(A: Any, rcond: float | None = None) -> Dual:
    """The inverse A^+ - eps A^+ A' A^+ of Pennestri & Stefanelli (2007), eq 33.

    It is a left inverse of tall matrices and a right inverse of wide ones.  But A A^+ (or A^+ A) is not
    symmetric, so it is not the Moore-Penrose inverse and does not solve least squares problems.

    Parameters
    ----------
    A : Dual or array_like, shape (..., m, n)
    rcond : float, optional
        Singular values of the real part below this share of the largest count as zero.

    Returns
    -------
    Dual, shape (..., n, m)

    Raises
    ------
    ShapeError
        If it is not a matrix.

    References
    ----------
    Pennestri & Stefanelli (2007), eq 33.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> A = dp.Dual([[1, 3], [9, 22], [4, 4]], [[4, 0], [2, 4], [4, 1]])
    >>> P = dp.algebra.pinv_simple(A) @ A
    >>> bool(np.allclose(P.real, np.eye(2)) and np.allclose(P.dual, 0))
    True
    """
    a, da = matrices("pinv_simple: A", A)
    p = _pseudo_inverse("pinv_simple", a, da, rcond)
    return Dual(p, -p @ da @ p)


def _pseudo_inverse(name: str, a: np.ndarray, da: np.ndarray, rcond: float | None) -> np.ndarray:
    """A^+ of the real part; raises if the rank of A + eps A' is not constant."""
    if 0 in a.shape[-2:]:
        return np.zeros((*a.shape[:-2], a.shape[-1], a.shape[-2]), a.dtype)
    finite(f"{name}: A", a)
    u, s, vh = np.linalg.svd(a, full_matrices=False)
    small = s <= (EPSILON * max(a.shape[-2:]) if rcond is None else rcond) * s[..., :1]
    p = H(vh) @ (H(u) * np.where(small, 0.0, 1 / np.where(small, 1.0, s))[..., None])
    if np.any(small):
        left = da - a @ (p @ da)
        defect = left - (left @ p) @ a
        # if A' respects the null spaces, the defect is only the rounding of these products
        condition = np.where(small, 1.0, s[..., :1] / np.where(small, 1.0, s)).max(axis=-1)
        size = np.abs(da).max(axis=(-1, -2), initial=0.0) * condition
        wrong = np.abs(defect).max(axis=(-1, -2)) > 64 * EPSILON * max(a.shape[-2:]) * size
        if np.any(wrong):
            rank = (~small).sum(axis=-1)[wrong].flat[0]
            raise SingularError(
                f"{name}: the real part{where(wrong)} has rank {rank} of {min(a.shape[-2:])} and the dual part "
                "leaves its null spaces: full rank, or (1 - A A^+) A' (1 - A^+ A) = 0, is needed"
            )
    return p


def det(A: Any) -> Dual:
    """The determinant, det A + eps tr(adj(A) A'); singular real parts included.

    Parameters
    ----------
    A : Dual or array_like, shape (..., n, n)

    Returns
    -------
    Dual, shape (...)

    Raises
    ------
    ShapeError
        If the matrices are not square.

    References
    ----------
    Jacobi (1841), the derivative of a determinant.

    Examples
    --------
    >>> import dualpin as dp
    >>> d = dp.algebra.det(dp.Dual([[1.0, 0.0], [0.0, 0.0]], [[0.0, 7.0], [7.0, 3.0]]))
    >>> float(d.real), round(float(d.dual), 12)
    (0.0, 3.0)
    """
    a, da = matrices("det: A", A, square=True)
    finite("det: A", a)
    u, s, vh = np.linalg.svd(a)
    n = s.shape[-1]
    others = np.where(np.eye(n, dtype=bool), 1.0, s[..., None, :]).prod(axis=-1)  # products without one value
    slopes = np.einsum("...ji,...jk,...ik->...i", u.conj(), da, vh.conj())
    return Dual(np.linalg.det(a), np.linalg.det(u) * np.linalg.det(vh) * (others * slopes).sum(axis=-1))


def norm(x: Any, axis: int | tuple[int, ...] | None = None, keepdims: bool = False) -> Dual:
    """The Euclidean (Frobenius) norm sqrt(x . x), |x| + eps (x . x') / |x|; also of numbers whose squares overflow.

    Parameters
    ----------
    x : Dual or array_like
    axis : int or pair of int, optional
        The axes over which it is taken; by default all.
    keepdims : bool
        Keep those axes, of length 1.

    Returns
    -------
    Dual

    Raises
    ------
    DualDivisionError
        For pure duals: sqrt has no derivative at 0.

    References
    ----------
    Study (1903).

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.algebra.norm(dp.Dual([3.0, 4.0], [1.0, 2.0])).dual.round(12).item()
    2.2
    """
    a, da = dual_array("norm: x", x)
    size, across = (length(c, axis, keepdims) for c in (a, da))
    lost = np.asarray((size == 0) & (across != 0))
    if np.any(lost):
        raise SingularError(f"norm: purely dual{where(lost)}, and sqrt has no derivative at 0")
    unit, scale = scaled(a, axis)
    return Dual(size, (unit.conj() * da).real.sum(axis=axis, keepdims=keepdims) / np.where(
        size == 0, 1.0, size / scale.reshape(np.shape(size))))  # fmt: skip


def _right_hand_side(name: str, a: np.ndarray, b: Any) -> tuple[np.ndarray, np.ndarray, bool]:
    b, db = dual_array(f"{name}: b", b, 1)
    vector = b.ndim == 1
    if vector:
        b, db = b[:, None], db[:, None]
    if b.shape[-2] != a.shape[-2]:
        raise ShapeError(f"{name}: b with {a.shape[-2]} rows expected for A of shape {a.shape}, got {b.shape[-2]}")
    return b, db, vector


def _attempt(name: str, a: np.ndarray, compute: Any) -> np.ndarray:
    try:
        return compute()
    except np.linalg.LinAlgError:
        s = np.linalg.svd(a, compute_uv=False)
        wrong = s[..., -1] <= EPSILON * a.shape[-1] * s[..., 0]
        at = where(wrong) if np.any(wrong) else ""
        raise SingularError(f"{name}: the real part{at} is singular, so the matrix has no dual inverse") from None
