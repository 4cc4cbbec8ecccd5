"""Arguments and errors of the dual algebra."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arguments import entries
from ..dual import Dual, stack
from ..errors import ArgumentError, DualDivisionError, DualpinError, ShapeError

EPSILON = float(np.finfo(float).eps)


class AssumptionError(DualpinError, np.linalg.LinAlgError):
    """A decomposition without a dual value for this matrix; the message names the assumption that failed."""


class SingularError(AssumptionError, DualDivisionError):
    """A matrix whose real part is singular (or lacks full rank): a divisor that is purely dual."""


def dual_array(what: str, x: Any, ndim: int = 0, *, symbols: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Both parts, as float or complex arrays of one shape with at least `ndim` axes.

    `x` is a `Dual`, something with `.real` and `.dual` (a motor), a plain array, or nested lists of dual numbers.
    With `symbols`, parts that hold formulas stay arrays of objects.
    """
    x = gathered(x)
    a, b = x.arrays if isinstance(x, Dual) else (np.asarray(x), None)
    if symbols and any(y is not None and y.dtype.kind == "O" for y in (a, b)):
        a, b = entries(what, a), entries(what, np.zeros(a.shape) if b is None else b)
        if a.ndim < ndim:
            raise ShapeError(f"{what}: an array of at least {ndim} axes expected, got shape {a.shape}")
        return a, b
    if a.dtype.kind not in "biufc" or (b is not None and b.dtype.kind not in "biufc"):
        raise ArgumentError(f"{what}: float or complex parts expected, got {a.dtype}")
    if a.ndim < ndim:
        raise ShapeError(f"{what}: an array of at least {ndim} axes expected, got shape {a.shape}")
    kind = np.result_type(a, a if b is None else b, np.float64)
    a = a.astype(kind, copy=False)
    return a, np.zeros(a.shape, kind) if b is None else b.astype(kind, copy=False)


def gathered(x: Any) -> Any:
    """Nested lists of dual numbers, or motors, as one dual array."""
    if isinstance(x, (list, tuple)) and any(hasattr(i, "dual") for i in _leaves(x)):
        return stack([gathered(i) for i in x])
    return Dual(x.real, x.dual) if hasattr(x, "dual") and not isinstance(x, Dual) else x


def _leaves(x: Any) -> Any:
    for i in x:
        if isinstance(i, (list, tuple)):
            yield from _leaves(i)
        else:
            yield i


def matrices(what: str, A: Any, *, square: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Both parts of (..., m, n) matrices."""
    a, b = dual_array(what, A, 2)
    if square and a.shape[-1] != a.shape[-2]:
        raise ShapeError(f"{what}: square matrices (..., n, n) expected, got {a.shape}")
    return a, b


def finite(what: str, a: np.ndarray) -> None:
    """Refuse nan and inf, for which LAPACK's iterations may not end."""
    wrong = ~np.isfinite(a)
    if np.any(wrong):
        at = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise ArgumentError(f"{what}: finite entries expected, got {a[at]} at index {at}")


def H(A: np.ndarray) -> np.ndarray:
    """The conjugate transpose of each matrix."""
    return A.swapaxes(-1, -2).conj() if A.dtype.kind == "c" else A.swapaxes(-1, -2)


def diagonals(A: np.ndarray) -> np.ndarray:
    return np.diagonal(A, axis1=-2, axis2=-1)


def where(wrong: np.ndarray) -> str:
    """' at index (...)' of the first wrong matrix of a batch."""
    index = tuple(int(i) for i in np.argwhere(wrong)[0])
    return f" at index {index}" if index else ""


def eigenvalues(A: np.ndarray) -> np.ndarray:
    """Eigenvalues of each matrix; a real array if all are real, in every version of NumPy."""
    w = np.linalg.eigvals(A)
    return w if A.dtype.kind == "c" else real_if_real(w)[0]


def eigenpairs(A: np.ndarray) -> tuple[np.ndarray, ...]:
    """Eigenvalues and eigenvectors of each matrix; real where all eigenvalues are, as `eigenvalues`."""
    w, v = np.linalg.eig(A)
    return (w, v) if A.dtype.kind == "c" else real_if_real(w, v)


def real_if_real(w: np.ndarray, *others: np.ndarray) -> tuple[np.ndarray, ...]:
    """The real parts of all arrays, if no entry of the first has an imaginary part; else all complex.

    NumPy before 2.5 does so itself for real matrices; later versions always return complex arrays.
    """
    real = not np.any(w.imag)
    return tuple(x.real.copy() if real else x.astype(complex, copy=False) for x in (w, *others))


def scaled(x: np.ndarray, axis: Any = None) -> tuple[np.ndarray, np.ndarray]:
    """x / s and s, the power of two next to the largest entry along `axis` (kept as axes of one): squares of x / s
    neither over- nor underflow, and the division is exact."""
    largest = np.abs(x).max(axis=axis, keepdims=True, initial=0.0)
    exponent = np.frexp(np.where(np.isfinite(largest), largest, 1.0))[1]
    s = np.ldexp(1.0, np.clip(exponent, -1021, 1023))
    return x / s, s


def length(x: np.ndarray, axis: Any = None, keepdims: bool = False) -> np.ndarray:
    """The Euclidean length sqrt(sum |x|^2) along the axes, without over- and underflow."""
    y, s = scaled(x, axis)
    size = np.sqrt((y.conj() * y).real.sum(axis=axis, keepdims=True)) * s
    return size if keepdims else size.sum(axis=axis)  # over axes of one: only drops them
