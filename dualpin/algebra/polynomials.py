"""Polynomials with dual coefficients."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from ..dual import Dual
from ..errors import ArgumentError, DualpinWarning
from .arguments import (
    EPSILON,
    AssumptionError,
    SingularError,
    dual_array,
    eigenvalues,
    finite,
    real_if_real,
    where,
)

SENSITIVE = 1e3
"""Condition of a root, sum |c_k x^k| / |x p'(x)|, above which it is computed in multiple precision; below, double
precision loses at most three of sixteen digits."""
DIGITS = 50  # of multiple precision, plus two for each degree
APART = 1e-9 * (1 + 1j)  # relative, and absolute at 0: the least distance of initial approximations
STEPS = 600  # of the simultaneous iteration: simple roots need some tens, double ones one step for each bit


def polyval(x: Any, c: Any) -> Dual:
    """c_0 + c_1 x + ... + c_n x^n by Horner's rule; coefficients ascending along the last axis of c.

    Parameters
    ----------
    x : Dual, number or array of them
    c : Dual or array_like, shape (..., n + 1)
        Coefficients, that of x^0 first.

    Returns
    -------
    Dual

    Raises
    ------
    ShapeError
        If the shapes do not broadcast.

    References
    ----------
    Horner (1819).

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

        x  a root of the real parts p,   x' = -sum c'_k x^k / p'(x)

    The real parts' roots are eigenvalues of the companion matrix, refined by Newton's method.  If roots are
    so sensitive that double precision would lose digits, all roots of the polynomial are computed again in
    multiple precision, as the roots of the given coefficients.

    Parameters
    ----------
    c : Dual or array_like, shape (..., n + 1)
        Python integers of any size are taken exactly.

    Returns
    -------
    Dual, shape (..., n)
        By ascending real part, then imaginary part; complex if a root is.

    Raises
    ------
    AssumptionError
        For a repeated root of the real parts, where no finite dual part exists or every one is a solution.  A root
        counts as repeated if a rounding of the coefficients can make it so,  |p'|^2 / |2 p''| <= u sum |c_k x^k|.
    SingularError
        If the leading coefficient is purely dual.

    Warns
    -----
    DualpinWarning
        If the rounding of the coefficients, u sum |c_k x^k| / |p'(x)|, determines a root to fewer than eight digits.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 10.1; Wilkinson (1963), ch. 2, on the condition of roots.

    Examples
    --------
    >>> import dualpin as dp
    >>> x = dp.algebra.polyroots(dp.Dual([6, -5, 1], [1, 2, -1]))
    >>> x.real.round(12).tolist(), x.dual.round(12).tolist()
    ([2.0, 3.0], [1.0, 2.0])
    """
    exact = _whole_numbers(c)
    a, da = dual_array("polyroots: c", c if exact is None else exact.astype(float), 1)
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
    x = eigenvalues(companion[..., ::-1, ::-1])
    slope = a[..., 1:] * np.arange(1, n + 1)
    for _ in range(3):
        p, dp = _horner(a, x), _horner(slope, x)
        safe = np.abs(dp) * np.abs(x) * SENSITIVE > _horner(np.abs(a), np.abs(x))
        x = x - np.where(safe, p / np.where(safe, dp, 1.0), 0.0)
    dp = _horner(slope, x)
    with np.errstate(divide="ignore", invalid="ignore"):
        dx = 0.0 - _horner(da, x) / dp
    firm = (np.abs(dp) * np.abs(x) * SENSITIVE > _horner(np.abs(a), np.abs(x))) | ((x == 0) & (dp != 0))
    given = a if exact is None else exact[..., : n + 1]
    doubtful = [tuple(map(int, i)) for i in np.argwhere(~firm.all(axis=-1))]
    for i in doubtful:
        root, slide = _refined(given[i], da[i], x[i], u=0.0 if exact is not None else EPSILON / 2, at=i)
        if root.dtype.kind == "c" and x.dtype.kind != "c":
            x, dx = x.astype(complex), dx.astype(complex)
        x[i], dx[i] = root, slide
    if a.dtype.kind != "c":
        x, dx = real_if_real(x, dx)
    order = np.lexsort((x.imag, x.real), axis=-1)
    return Dual(np.take_along_axis(x, order, axis=-1), np.take_along_axis(dx, order, axis=-1))


def _whole_numbers(c: Any) -> np.ndarray | None:
    """Lists of Python integers, unchanged: doubles would round those beyond 2^53."""
    if not isinstance(c, (list, tuple)):
        return None
    entries = np.asarray(c, dtype=object)
    return entries if entries.size and all(type(k) is int for k in entries.flat) else None


def _refined(c: np.ndarray, dc: np.ndarray, near: np.ndarray, u: float, at: tuple[int, ...]) -> tuple[np.ndarray, ...]:
    """Roots and their dual parts in multiple precision, from approximations, for coefficients known to the relative
    rounding u."""
    import mpmath

    n = len(c) - 1
    with mpmath.workdps(DIGITS + 2 * n):
        a, da = ([mpmath.mpmathify(k) for k in x] for x in (c.tolist(), dc.tolist()))
        slope = [k * a[k] for k in range(1, n + 1)]
        curve = [k * slope[k] for k in range(1, n)]
        u_ = mpmath.mpf(u) if u else mpmath.mpf(10) ** -DIGITS
        try:
            # a root of multiplicity m converges slowly, to 1/m of the digits
            extra = min(n, 6) * mpmath.mp.prec
            # the iteration cannot separate equal approximations
            start = [mpmath.mpmathify(complex(z)) * (1 + k * APART) + k * APART for k, z in enumerate(near.tolist(), 1)]
            found = mpmath.polyroots(a[::-1], maxsteps=STEPS, extraprec=extra, roots_init=start)
        except mpmath.mp.NoConvergence:
            place = f" at index {at}" if at else ""
            raise AssumptionError(f"polyroots: roots of the real parts{place} are repeated many times") from None
        roots: list[complex] = []
        slides: list[complex] = []
        digits: list[tuple[float, int]] = []
        for x in found:
            d, bend, noise = _at(slope, x), abs(_at(curve, x)), u_ * _at([abs(k) for k in a], abs(x))
            change = _at(da, x)
            if abs(d) ** 2 <= 2 * bend * noise:
                free = abs(change) <= mpmath.sqrt(u_) * _at([abs(k) for k in da], abs(x))
                place, within = f" at index {at}" if at else "", " to one rounding of the coefficients" if u else ""
                raise AssumptionError(
                    f"polyroots: the root {_short(complex(x))} of the real parts{place} is repeated{within}: "
                    + ("every dual part solves" if free else "no finite dual part solves")
                )
            if x != 0 and noise:
                digits.append((float(mpmath.log10(abs(x * d) / noise)), len(roots)))
            roots.append(complex(x))
            slides.append(complex(-change / d))
    fewest, worst = min(digits, default=(np.inf, 0))
    if u and fewest < 8:
        warnings.warn(
            f"polyroots: the rounding of the coefficients leaves the root {_short(roots[worst])} about "
            f"{max(int(fewest), 0)} digits; whole numbers as Python integers would be taken exactly",
            DualpinWarning,
            stacklevel=3,
        )
    x, dx = np.array(roots), np.array(slides)
    return (x, dx) if np.iscomplexobj(c) else real_if_real(x, dx)


def _short(x: complex) -> str:
    return f"{x.real:.6g}" if abs(x.imag) <= 1e-12 * abs(x) else f"{x:.6g}"


def _at(c: list[Any], x: Any) -> Any:
    """The polynomial at one point, over any scalar."""
    total = c[-1] if c else 0
    for k in reversed(c[:-1]):
        total = total * x + k
    return total


def _horner(c: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The polynomial of each batch member at its n points."""
    total = np.broadcast_to(c[..., -1:], x.shape).astype(np.result_type(c, x))
    for k in range(c.shape[-1] - 2, -1, -1):
        total = total * x + c[..., k : k + 1]
    return total
