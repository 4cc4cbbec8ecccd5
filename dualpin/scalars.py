"""Scalars: any type that adds, multiplies and divides.

Floats, NumPy arrays (one number for each member of a batch), mpmath and SymPy numbers, traced
symbols and dual numbers are used in the same formulas.  This module provides what is needed besides
arithmetic: the exact constants -1, 0, 1, and the library of elementary functions of each type of scalar.
"""

from __future__ import annotations

import cmath
import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from .errors import DualpinError
from .extras import extra

Scalar = Any
"""A float, an array, a symbol, an mpmath or SymPy number, an `Exact` constant or a `Dual`."""


class Compound:
    """Objects made of scalars (vectors, rotations, ...): they define products with a scalar on the left."""

    __slots__ = ()
    __array_ufunc__ = None


class Exact:
    """One of the exact constants -1, 0, 1: 0 x is 0, and 0 + x and 1 x are x, for every x.

    Since exact zeros eliminate operations, formulas keep their textbook form and cost no more than
    hand-specialised ones.
    """

    __slots__ = ("n",)
    __array_ufunc__ = None  # NumPy leaves mixed operations to this class

    def __init__(self, n: int) -> None:
        self.n = n

    def __repr__(self) -> str:
        return f"{self.n}"

    @property
    def real(self) -> Exact:
        return self

    @property
    def dual(self) -> Exact:
        return ZERO

    def __float__(self) -> float:
        return float(self.n)

    def __eq__(self, other: object) -> Any:
        return self.n == (other.n if type(other) is Exact else other)

    def __hash__(self) -> int:
        return hash(self.n)

    def __lt__(self, x: Scalar) -> Any:
        return self.n < (x.n if type(x) is Exact else x)

    def __gt__(self, x: Scalar) -> Any:
        return self.n > (x.n if type(x) is Exact else x)

    def __neg__(self) -> Exact:
        return self if self is ZERO else _EXACT[-self.n]

    # ZERO itself is asked for first: most operations with a constant are with it

    def __add__(self, x: Scalar) -> Scalar:
        if self is ZERO or self.n == 0:
            return x
        return self if x is ZERO else exact(self.n + (x.n if type(x) is Exact else x))

    def __sub__(self, x: Scalar) -> Scalar:
        if x is ZERO:
            return self
        return -x if self.n == 0 else exact(self.n - (x.n if type(x) is Exact else x))

    def __rsub__(self, x: Scalar) -> Scalar:
        return x if self.n == 0 else x - self.n

    def __mul__(self, x: Scalar) -> Scalar:
        if x is ZERO:
            return x
        if self.n == 0:
            return NotImplemented if isinstance(x, Compound) else ZERO
        return x if self.n == 1 else -x

    def __truediv__(self, x: Scalar) -> Scalar:
        if type(x) is Exact:
            return exact(self.n * x.n) if x.n else math.nan
        return self.n / x if self.n else ZERO

    def __rtruediv__(self, x: Scalar) -> Scalar:
        # nan: a whole batch is singular, which must be visible in the result
        return x * self if self.n else x * math.nan

    def _sympy_(self) -> Any:
        return extra("sympy", "exact", "a symbolic number").Integer(self.n)

    __radd__, __rmul__ = __add__, __mul__


_EXACT = {n: Exact(n) for n in (-1, 0, 1)}
ZERO, ONE = _EXACT[0], _EXACT[1]


def exact(x: Scalar) -> Scalar:
    """The same number, as an exact constant if it is -1, 0 or 1."""
    return _EXACT[int(x)] if isinstance(x, (int, float)) and x in (-1, 0, 1) else x


# --- the library of each type ------------------------------------------------------------------

NAMES = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")
_TERMS = 13  # terms of a Stumpff series: for arguments below 1 the last is under 1e-26


def _stumpff_series(k: int, y: Scalar) -> Scalar:
    """c_k(y) = sum_i (-y)^i / (2 i + k)!, by Horner's rule."""
    value = 1.0
    for i in range(_TERMS, 0, -1):
        value = 1.0 - y * value / ((2 * i + k) * (2 * i + k - 1))
    return value / math.factorial(k)


def _stumpff_closed(k: int, y: Scalar, lib: Any) -> Scalar:
    if k == 2:  # (1 - cos r) / r^2 without cancellation
        return 2 * (lib.sin(lib.sqrt(y) / 2) ** 2) / y
    root = lib.sqrt(y)
    if k == 0:
        return lib.cos(root)
    return lib.sin(root) / root if k == 1 else (1 - lib.sin(root) / root) / y


def _stumpff_float(k: int, y: float) -> float:
    return _stumpff_series(k, y) if y < 1.0 else _stumpff_closed(k, y, FLOAT)


def _stumpff_complex(k: int, y: complex) -> complex:
    return _stumpff_series(k, y) if abs(y) < 1.0 else _stumpff_closed(k, y, COMPLEX)


def _stumpff_array(k: int, y: np.ndarray) -> np.ndarray:
    small = y < 1.0
    near, far = np.where(small, y, 0.0), np.where(small, 1.0, y)
    result: Any = np.where(small, _stumpff_series(k, near), _stumpff_closed(k, far, ARRAY))
    return result


def _library(module: Any, **more: Any) -> SimpleNamespace:
    functions = {n: getattr(module, n) for n in NAMES}
    atan2 = getattr(module, "atan2", None)
    return SimpleNamespace(**{"atan2": atan2, "hypot": getattr(module, "hypot", None), **functions, **more})


FLOAT = _library(math, stumpff=_stumpff_float)
COMPLEX = _library(cmath, stumpff=_stumpff_complex)
ARRAY = SimpleNamespace(
    sin=np.sin, cos=np.cos, tan=np.tan, asin=np.arcsin, acos=np.arccos, atan=np.arctan,
    sinh=np.sinh, cosh=np.cosh, tanh=np.tanh, exp=np.exp, log=np.log, sqrt=np.sqrt,
    atan2=np.arctan2, hypot=np.hypot, stumpff=_stumpff_array,
)  # fmt: skip


def _mpmath() -> SimpleNamespace:
    import mpmath

    def stumpff(k: int, y: Scalar) -> Scalar:
        half = mpmath.mpf(1) / 2
        return mpmath.hyper([1], [(k + 1) * half, (k + 2) * half], -y / 4) / math.factorial(k)

    return _library(mpmath, stumpff=stumpff)


def _sympy() -> SimpleNamespace:
    import sympy

    library = _library(sympy)
    library.stumpff = lambda k, y: sympy.Integer(1) / math.factorial(k) if y.is_zero else _stumpff_closed(k, y, library)
    return library


_EXACTS = _library(math, stumpff=lambda k, y: exact(_stumpff_float(k, float(y))))
_LIBRARIES: dict[type, Any] = {
    float: FLOAT, int: FLOAT, complex: COMPLEX, Exact: _EXACTS, np.float64: FLOAT, np.complex128: COMPLEX,
    np.generic: ARRAY, np.ndarray: ARRAY,
}  # fmt: skip
_LAZY = {"mpmath": _mpmath, "sympy": _sympy}  # imported with the first number of their type


def register(kind: type, library: Any) -> None:
    """Register the elementary functions of a new type of scalar.

    `library` has `sin`, `cos`, ..., `sqrt`, `atan2` and `stumpff` as attributes (those used).
    """
    _LIBRARIES[kind] = library


def library(x: Scalar) -> Any:
    """The functions that act on scalars of x's type."""
    kind = type(x)
    found = _LIBRARIES.get(kind)
    if found is None:
        for base in kind.__mro__:
            found = _LIBRARIES.get(base)
            root = (base.__module__ or "").partition(".")[0]  # None for SymPy's functions of time
            if found is None and root in _LAZY:
                found = _LAZY[root]()
            if found is not None:
                _LIBRARIES[kind] = found
                return found
        raise DualpinError(
            f"no elementary functions are known for {kind.__name__}; scalars are floats, NumPy arrays, mpmath and "
            "SymPy numbers, dual numbers, and types given to dualpin.scalars.register"
        )
    return found
