"""Dual factorisations: QR, singular values, eigenvalues.

Differentiating A = Q R, A = U S V^H, A V = V w splits the derivative into a skew part, which turns the
orthogonal factors, and a remainder, which changes the other factor; LAPACK factors the real part.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from ..dual import Dual
from ..errors import ArgumentError, DualpinWarning
from .arguments import (
    EPSILON,
    AssumptionError,
    H,
    SingularError,
    diagonals,
    eigenpairs,
    finite,
    length,
    matrices,
    scaled,
    where,
)  # fmt: skip

GAP = 64  # singular values and eigenvalues nearer than this many roundings of the largest count as repeated


def qr(A: Any) -> tuple[Dual, Dual]:
    """The economic factorisation A = Q R with the diagonal of R positive.

        X = Q^H A' R^-1,   W = skew matrix with X's lower triangle,   Q' = A' R^-1 - Q (X - W),   R' = (X - W) R

    Parameters
    ----------
    A : Dual or array_like, shape (..., m, n)

    Returns
    -------
    Q : Dual, shape (..., m, k),  R : Dual, shape (..., k, n),  with k = min(m, n)
        Q^H Q = 1.

    Raises
    ------
    SingularError
        If the first k columns of the real part are linearly dependent.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.8 (there by Gram-Schmidt in dual numbers; the result is the same).

    Examples
    --------
    >>> import dualpin as dp
    >>> Q, R = dp.algebra.qr(dp.Dual([[1, 2], [3, 3]], [[1, 3], [9, 1]]))
    >>> R.dual.round(4).tolist()
    [[8.8544, 1.3282], [0.0, 4.6169]]
    """
    a, da = matrices("qr: A", A)
    k = min(a.shape[-2:])
    q, r = np.linalg.qr(a)
    d = diagonals(r)
    dependent = np.abs(d).min(axis=-1, initial=np.inf) <= EPSILON * max(a.shape[-2:]) * length(a, (-2, -1))
    if np.any(dependent & (k > 0)):
        raise SingularError(f"qr: the first {k} columns of the real part{where(dependent)} are linearly dependent")
    sign = d / np.abs(d)
    q, r = q * sign[..., None, :], r * sign.conj()[..., :, None]
    y = _right_divided(da[..., :k], r[..., :k])
    x = H(q) @ y
    lower = np.tril(x, -1)
    turn = lower - H(lower)
    if x.dtype.kind == "c":
        turn = turn + 1j * _diagonal(diagonals(x).imag)
    dq = y - q @ (x - turn)
    dr = np.triu(H(q) @ da - turn @ r)
    return Dual(q, dq), Dual(r, dr)


def _right_divided(a: np.ndarray, r: np.ndarray) -> np.ndarray:
    """a r^-1"""
    return np.linalg.solve(r.swapaxes(-1, -2), a.swapaxes(-1, -2)).swapaxes(-1, -2)


def _diagonal(d: np.ndarray) -> np.ndarray:
    return d[..., None] * np.eye(d.shape[-1])


def svd(A: Any) -> tuple[Dual, Dual, Dual]:
    """The thin singular value decomposition A = U diag(S) Vh, singular values descending.

        P = U^H A' V,   s' = diag P,   V' = V F*(S P + P^H S),   U' = U F*(P S + S P^H) + (1 - U U^H) A' V S^-1

    with F_ij = 1 / (s_j^2 - s_i^2), for a tall matrix; a wide one is transposed.

    Parameters
    ----------
    A : Dual or array_like, shape (..., m, n)

    Returns
    -------
    U : Dual, shape (..., m, k);  S : Dual, shape (..., k);  Vh : Dual, shape (..., k, n);  k = min(m, n)
        In each column of the smaller factor (V if m >= n, else U) the entry of largest modulus in the real part
        is positive; of equal ones the last.

    Raises
    ------
    AssumptionError
        If singular values of the real part coincide or vanish: then the vectors (or the root) have no derivative.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.11.

    Examples
    --------
    >>> import dualpin as dp
    >>> U, S, Vh = dp.algebra.svd(dp.Dual([[1, 3], [2, 1], [6, 8]], [[1, 5], [0, 1], [4, 2]]))
    >>> S.dual.round(4).tolist()
    [5.2039, 1.1906]
    """
    a, da = matrices("svd: A", A)
    if a.shape[-2] < a.shape[-1]:
        V, S, Uh = svd(Dual(H(a), H(da)))
        return Uh.H, S, V.H
    finite("svd: A", a)
    a, scale = scaled(a, (-2, -1))  # prevents overflow and underflow of the squares below
    da, scale = da / scale, scale[..., 0]
    u, s, vh = np.linalg.svd(a, full_matrices=False)
    _distinct("svd: singular values", s, s[..., :1], nonzero=True)
    v = H(vh)
    sign = _column_signs(v)
    u, v = u * sign, v * sign
    dav = da @ v
    p = H(u) @ dav
    f = _gaps(s, lambda x, y: (x - y) * (x + y))
    column, row = s[..., :, None], s[..., None, :]
    turn_u, turn_v = f * (p * row + column * H(p)), f * (column * p + H(p) * row)
    ds = diagonals(p).real
    du = u @ (turn_u - p / row) + dav / row
    if p.dtype.kind == "c":  # the phase is free; it is chosen such that V' has no component i V
        du = du + u * (1j * diagonals(p).imag / s)[..., None, :]
    return Dual(u, du), Dual(s * scale, ds * scale), Dual(H(v), H(v @ turn_v))


def _column_signs(v: np.ndarray) -> np.ndarray:
    """Factors of modulus one that make the largest entry of each column real and positive."""
    top = _largest(v)
    return (np.abs(top) / np.where(top == 0, 1.0, top)) + (top == 0)


def _largest(v: np.ndarray) -> np.ndarray:
    """The entry of largest modulus in each column, the last of those equal to rounding: shape (..., 1, n)."""
    size = np.abs(v)
    near = size >= size.max(axis=-2, keepdims=True) * (1 - 1e-9)
    last = v.shape[-2] - 1 - np.argmax(near[..., ::-1, :], axis=-2, keepdims=True)
    return np.take_along_axis(v, last, axis=-2)


def _gaps(s: np.ndarray, difference: Any) -> np.ndarray:
    """F_ij = 1 / difference(s_j, s_i), 0 on the diagonal."""
    n = s.shape[-1]
    gap = difference(s[..., None, :], s[..., :, None])
    return np.where(np.eye(n, dtype=bool), 0.0, 1 / np.where(np.eye(n, dtype=bool), 1.0, gap))


def _distinct(what: str, s: np.ndarray, scale: np.ndarray, *, nonzero: bool = False) -> None:
    n = s.shape[-1]
    if n == 0:
        return
    tolerance = GAP * EPSILON * n * scale
    if nonzero and np.any(bad := s[..., -1] <= tolerance[..., 0]):
        raise SingularError(f"{what} of the real part{where(bad)} vanish ({s[bad][0]}): full rank is needed")
    far = np.where(np.eye(n, dtype=bool), np.inf, np.abs(s[..., :, None] - s[..., None, :]))
    if np.any(bad := far.min(axis=(-1, -2)) <= tolerance[..., 0]):
        raise AssumptionError(
            f"{what} of the real part{where(bad)} are repeated ({s[bad][0]}): simple ones are needed, since "
            "the vectors of repeated ones have no derivative"
        )


def eig(A: Any, normalize: str = "transpose") -> tuple[Dual, Dual]:
    """Eigenvalues and right eigenvectors, A V = V diag(w), with v^T v = 1 (no conjugate).

        D = V^-1 A' V,   w' = diag D,   V' = V (F*D) + V diag(c),   F_ij = 1 / (w_j - w_i)

    with c such that the normalisation holds in dual numbers.

    Parameters
    ----------
    A : Dual or array_like, shape (..., n, n)
    normalize : "transpose" or "unit"
        v^T v = 1, or v^H v = 1 with v^H v' = 0.

    Returns
    -------
    w : Dual, shape (..., n)
        By ascending real part, then imaginary part; complex where a real part has complex eigenvalues.
    V : Dual, shape (..., n, n)
        Columns; the entry largest in modulus (of equal ones the last) has a positive real part.

    Raises
    ------
    AssumptionError
        If eigenvalues of the real part are repeated (nearer than their rounding, estimated with the
        condition of the eigenvectors).

    Warns
    -----
    DualpinWarning
        Isotropic vectors (v^T v = 0, such as (1, i, 0) of a plane rotation) cannot be normalised by
        v^T v = 1; they are returned with v^H v = 1.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.10; Magnus (1985).

    Examples
    --------
    >>> import dualpin as dp
    >>> w, V = dp.algebra.eig(dp.Dual([[2, 1], [1, 3]], [[1, -1], [2, 4]]))
    >>> w.dual.round(6).tolist()
    [1.381966, 3.618034]
    """
    if normalize not in ("transpose", "unit"):
        raise ArgumentError(f"eig: normalize {normalize!r} is not known; 'transpose' (v^T v = 1) or 'unit' (v^H v = 1)")
    a, da = matrices("eig: A", A, square=True)
    w, v, d = _spectrum("eig", a, da)
    dv = v @ (_gaps(w, lambda x, y: x - y) * d)
    unit = np.full(w.shape, normalize == "unit")
    square = (v * v).sum(axis=-2)  # v^H v = 1 here
    if normalize == "transpose" and v.dtype.kind == "c":
        unit = np.abs(square) < 1e-10  # rounding of an isotropic vector leaves eps times the condition of v
        if np.any(unit):
            at = tuple(int(i) for i in np.argwhere(unit)[0])
            warnings.warn(
                f"eig: eigenvector {at} is isotropic (v^T v = 0) and is returned with v^H v = 1",
                DualpinWarning,
                stacklevel=2,
            )
    root = np.where(unit, 1.0, np.sqrt(np.where(unit, 1.0, square)))[..., None, :]
    v, dv = v / root, dv / root
    left = np.where(unit[..., None, :], v.conj(), v)
    dv = dv - v * (left * dv).sum(axis=-2, keepdims=True)
    flip = np.where(_largest(v).real < 0, -1.0, 1.0)
    return Dual(w, diagonals(d).copy()), Dual(v * flip, dv * flip)


def eigvals(A: Any) -> Dual:
    """The eigenvalues alone, in the order of `eig`, shape (..., n).

    Parameters
    ----------
    A : Dual or array_like, shape (..., n, n)

    Returns
    -------
    Dual, shape (..., n)

    Raises
    ------
    AssumptionError
        If eigenvalues of the real part are repeated.

    References
    ----------
    Pennestri & Stefanelli (2007), as for `eig`.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.algebra.eigvals(dp.Dual([[2, 0], [0, 3]], [[1, 5], [5, 4]])).dual.round(12).tolist()
    [1.0, 4.0]
    """
    a, da = matrices("eigvals: A", A, square=True)
    w, _, d = _spectrum("eigvals", a, da)
    return Dual(w, diagonals(d).copy())


def _spectrum(name: str, a: np.ndarray, da: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """w, V of the real part with |v| = 1, sorted, and V^-1 A' V."""
    finite(f"{name}: A", a)
    w, v = eigenpairs(a)
    order = np.lexsort((w.imag, w.real), axis=-1)
    w, v = np.take_along_axis(w, order, axis=-1), np.take_along_axis(v, order[..., None, :], axis=-1)
    size = length(a, (-2, -1))[..., None]
    with np.errstate(all="ignore"):
        try:
            left = np.linalg.inv(v)
        except np.linalg.LinAlgError:
            left = np.full_like(v, np.inf)
        # error bound of a computed eigenvalue: eps |A| |left vector| (Bauer & Fike)
        shaky = np.nan_to_num(np.linalg.norm(left, axis=-1).max(axis=-1, keepdims=True), nan=np.inf)
    apart = np.abs(w[..., :, None] - w[..., None, :])
    spread = np.where(np.eye(w.shape[-1], dtype=bool), np.inf, apart).min(axis=(-1, -2))
    bad = ~(spread > GAP * EPSILON * (size * np.minimum(shaky, 1 / EPSILON))[..., 0]) & (w.shape[-1] > 1)
    if np.any(bad):
        raise AssumptionError(
            f"{name}: eigenvalues of the real part{where(bad)} are repeated ({w[bad][0]}): simple ones are "
            "needed, since repeated ones and their vectors have no derivative"
        )
    return w, v, left @ da @ v


def eigh(A: Any) -> tuple[Dual, Dual]:
    """Eigenvalues and orthonormal eigenvectors of a symmetric (Hermitian) dual matrix, ascending.

        D = V^H A' V,   w' = diag D,   V' = V (F*D),   F_ij = 1 / (w_j - w_i)

    Both parts are taken from the lower triangle.

    Parameters
    ----------
    A : Dual or array_like, shape (..., n, n)

    Returns
    -------
    w : Dual, shape (..., n);  V : Dual, shape (..., n, n), with V^H V = 1, signs as in `eig`

    Raises
    ------
    AssumptionError
        If eigenvalues of the real part are repeated.

    References
    ----------
    Magnus (1985), the differential of eigenvalues and eigenvectors.

    Examples
    --------
    >>> import dualpin as dp
    >>> w, V = dp.algebra.eigh(dp.Dual([[2, 0], [0, 3]], [[1, 5], [5, 4]]))
    >>> w.dual.round(12).tolist()
    [1.0, 4.0]
    """
    a, da = matrices("eigh: A", A, square=True)
    finite("eigh: A", a)
    w, v = np.linalg.eigh(a)
    _distinct("eigh: eigenvalues", w, np.abs(w).max(axis=-1, keepdims=True, initial=0.0))
    v = v * _column_signs(v)
    lower = np.tril(da, -1)
    mirrored = lower + H(lower) + _diagonal(diagonals(da).real)
    d = H(v) @ mirrored @ v
    return Dual(w, diagonals(d).real.copy()), Dual(v, v @ (_gaps(w, lambda x, y: x - y) * d))
