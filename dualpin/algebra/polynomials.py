"""Polynomials with dual coefficients."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..dual import Dual
from ..errors import ArgumentError
from .arguments import EPSILON, AssumptionError, SingularError, dual_array, finite, where


def polyval(x: Any, c: Any) -> Dual:
    """c_0 + c_1 x + ... + c_n x^n by Horner's rule; coefficients ascending along the last axis of c.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.algebra.polyval(dp.Dual(2.0, 1.0), dp.Dual([6, -5, 1], [1, 2, -1]))
    Dual(0.0, 0.0)
    """
    c = Dual(*dual_array("polyval: c", c, 1))
    x = x if isinstance(x, Dual) else Dual(np.asarray(x))
    total = c[..., -1] + 0 * x
    for k in range(c.shape[-1] - 2, -1, -1):
        total = total * x + c[..., k]
    return total


def polyroots(c: Any) -> Dual:
    """The roots of c_0 + c_1 x + ... + c_n x^n, c ascending as for ``numpy.polynomial``.

        x  a root of the real parts,   x' = -sum c'_k x^k / sum k c_k x^(k-1)

    The real parts' roots are eigenvalues of the companion matrix, refined by Newton's method.

    Parameters
    ----------
    c : Dual or array_like, shape (..., n + 1)

    Returns
    -------
    Dual, shape (..., n)
        By ascending real part, then imaginary part; complex where a root is.

    Raises
    ------
    AssumptionError
        At a repeated root of the real parts: no finite dual part exists, or any will do.
    SingularError
        If the leading coefficient is purely dual.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 10.1.

    Examples
    --------
    >>> import dualpin as dp
    >>> x = dp.algebra.polyroots(dp.Dual([6, -5, 1], [1, 2, -1]))
    >>> x.real.round(12).tolist(), x.dual.round(12).tolist()
    ([2.0, 3.0], [1.0, 2.0])
    """
    a, da = dual_array("polyroots: c", c, 1)
    while a.shape[-1] > 1 and not np.any(a[..., -1]) and not np.any(da[..., -1]):
        a, da = a[..., :-1], da[..., :-1]
    if a.shape[-1] < 2:
        raise ArgumentError("polyroots: a polynomial of degree 1 or more expected, with coefficients ascending")
    lead = a[..., -1:]
    if np.any(lead == 0):
        at = where(lead[..., 0] == 0)
        raise SingularError(f"polyroots: the leading coefficient{at} has no real part: a root lies at infinity")
    finite("polyroots: c", a)
    n = a.shape[-1] - 1
    companion = np.zeros((*a.shape[:-1], n, n), dtype=a.dtype)
    companion[..., np.arange(1, n), np.arange(n - 1)] = 1.0
    companion[..., :, -1] = -a[..., :-1] / lead
    x = np.linalg.eigvals(companion[..., ::-1, ::-1])
    slope = a[..., 1:] * np.arange(1, n + 1)
    steepest = _horner(np.abs(slope), np.abs(x))
    for _ in range(3):
        p, dp = _horner(a, x), _horner(slope, x)
        safe = np.abs(dp) > np.sqrt(EPSILON) * steepest
        x = x - np.where(safe, p / np.where(safe, dp, 1.0), 0.0)
    dp = _horner(slope, x)
    # a double root splits by sqrt(eps) in the companion matrix, which leaves so much of the derivative
    repeated = np.abs(dp) <= 64 * n * np.sqrt(EPSILON) * steepest
    change = _horner(da, x)
    if np.any(repeated):
        free = np.abs(change[repeated][0]) <= np.sqrt(EPSILON) * _horner(np.abs(da), np.abs(x))[repeated][0]
        raise AssumptionError(
            f"polyroots: the root {x[repeated][0]:.6g} of the real parts{where(repeated)} is repeated: "
            + ("every dual part solves" if free else "no finite dual part solves")
        )
    dx = -change / dp
    order = np.lexsort((x.imag, x.real), axis=-1)
    return Dual(np.take_along_axis(x, order, axis=-1), np.take_along_axis(dx, order, axis=-1))


def _horner(c: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The polynomial of each batch member at its n points."""
    total = np.broadcast_to(c[..., -1:], x.shape).astype(np.result_type(c, x))
    for k in range(c.shape[-1] - 2, -1, -1):
        total = total * x + c[..., k : k + 1]
    return total
