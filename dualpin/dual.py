"""Dual numbers a + eps b with eps^2 = 0, over any scalar, and the elementary functions.

A differentiable real function has one natural extension, f(a + eps b) = f(a) + eps f'(a) b.
Everything in this file is that sentence, and the ring.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .errors import ArgumentError, DualDivisionError
from .scalars import ONE, ZERO, Exact, Scalar, exact, library


class Compound:
    """Things made of scalars (vectors, rotations, ...): a scalar on their left leaves the product to them."""

    __slots__ = ()
    __array_ufunc__ = None


class Dual:
    """The dual number  real + eps dual.

    Parameters
    ----------
    real, dual : scalar or array_like
        Floats, arrays (lists become arrays), symbols, mpmath or SymPy numbers.

    Examples
    --------
    >>> from dualpin import Dual
    >>> Dual(3.0, 1.0) * Dual(2.0, 5.0)
    Dual(6.0, 17.0)
    >>> import numpy as np
    >>> np.sin(Dual(0.0, 2.0))
    Dual(0.0, 2.0)
    """

    __slots__ = ("dual", "real")

    def __init__(self, real: Scalar, dual: Scalar = 0) -> None:
        if real.__class__ in _SEQUENCES or dual.__class__ in _SEQUENCES:
            real, dual = _parts(real, dual)
        self.real, self.dual = real, dual

    def __repr__(self) -> str:
        return f"Dual({self.real!r}, {self.dual!r})"

    # the ring

    def __neg__(self) -> Dual:
        return Dual(-self.real, -self.dual)

    def __pos__(self) -> Dual:
        return self

    def __add__(self, b: Scalar) -> Dual:
        if type(b) is Dual:
            return Dual(self.real + b.real, self.dual + b.dual)
        return NotImplemented if isinstance(b, Compound) else Dual(self.real + b, self.dual)

    def __sub__(self, b: Scalar) -> Dual:
        if type(b) is Dual:
            return Dual(self.real - b.real, self.dual - b.dual)
        return NotImplemented if isinstance(b, Compound) else Dual(self.real - b, self.dual)

    def __rsub__(self, b: Scalar) -> Dual:
        return Dual(b - self.real, -self.dual)

    def __mul__(self, b: Scalar) -> Dual:
        """(a + eps a')(b + eps b') = a b + eps (a b' + a' b)"""
        if type(b) is Dual:
            return Dual(self.real * b.real, self.real * b.dual + self.dual * b.real)
        return NotImplemented if isinstance(b, Compound) else Dual(self.real * b, self.dual * b)

    def __truediv__(self, b: Scalar) -> Dual:
        """(a + eps a') / (b + eps b') = q + eps (a' - q b') / b  with q = a / b"""
        if type(b) is Dual:
            _refuse(b.real, "division by the pure dual number {}: only numbers with a real part have an inverse", b)
            q = self.real / b.real
            return Dual(q, (self.dual - q * b.dual) / b.real)
        return Dual(self.real / b, self.dual / b)

    def __rtruediv__(self, b: Scalar) -> Dual:
        return Dual(b, b * 0) / self

    __radd__, __rmul__ = __add__, __mul__


_SEQUENCES = {list, tuple, int}


def _parts(real: Scalar, dual: Scalar) -> tuple[Scalar, Scalar]:
    """Lists become arrays, and a missing dual part zeros of the same shape."""
    if isinstance(real, (list, tuple, np.ndarray)) or isinstance(dual, (list, tuple, np.ndarray)):
        try:
            real, dual = (np.asarray(x, dtype=None) for x in (real, dual))
            real, dual = np.broadcast_arrays(real, dual)
        except ValueError as e:
            raise ArgumentError(f"Dual: the parts do not form arrays of one shape ({e})") from None
        if real.dtype.kind in "biu":
            real = real.astype(float)
        if dual.dtype.kind in "biu":
            dual = dual.astype(float)
        return real.copy(), dual.copy()
    return real, dual


def _refuse(x: Scalar, message: str, shown: object, bad: float = 0) -> None:
    """Raise where a real part is `bad`; symbols cannot be compared and pass."""
    if isinstance(x, (float, int, complex, np.ndarray)) and np.any(x == bad):
        where = f" at index {tuple(int(i) for i in np.argwhere(np.asarray(x) == bad)[0])}" if np.ndim(x) else ""
        raise DualDivisionError(message.format(shown) + where)


EPS = Dual(ZERO, ONE)


# --- functions over any scalar -------------------------------------------------------------------


class Function:
    """An elementary function over any scalar, with f(a + eps b) = f(a) + eps f'(a) b."""

    def __init__(self, name: str, derivative: Callable[[Scalar], Scalar]) -> None:
        self.name, self.derivative = name, derivative
        self.__doc__ = f"{name}(x) for any scalar x."

    def __repr__(self) -> str:
        return f"<dualpin {self.name}>"

    def __call__(self, x: Scalar) -> Scalar:
        if type(x) is Dual:
            return Dual(self(x.real), self.derivative(x.real) * x.dual)
        if type(x) is Exact:
            return exact(self(float(x)))
        return getattr(library(x), self.name)(x)


sin = Function("sin", lambda x: cos(x))
cos = Function("cos", lambda x: -sin(x))
tan = Function("tan", lambda x: 1 / (cos(x) * cos(x)))
asin = Function("asin", lambda x: 1 / sqrt(1 - x * x))
acos = Function("acos", lambda x: -1 / sqrt(1 - x * x))
atan = Function("atan", lambda x: 1 / (1 + x * x))
sinh = Function("sinh", lambda x: cosh(x))
cosh = Function("cosh", lambda x: sinh(x))
tanh = Function("tanh", lambda x: 1 / (cosh(x) * cosh(x)))
exp = Function("exp", lambda x: exp(x))
log = Function("log", lambda x: 1 / x)
sqrt = Function("sqrt", lambda x: 1 / (2 * sqrt(x)))


def cos_sin(x: Scalar) -> tuple[Scalar, Scalar]:
    """(cos x, sin x) for any scalar, each evaluated once: also of a dual angle."""
    if type(x) is Dual:
        c, s = cos_sin(x.real)
        return Dual(c, -(s * x.dual)), Dual(s, c * x.dual)
    return cos(x), sin(x)


def atan2(y: Scalar, x: Scalar) -> Scalar:
    """The angle of (x, y):  atan2(s + eps s', c + eps c') = atan2(s, c) + eps (s' c - c' s) / (s^2 + c^2)"""
    if type(y) is Dual or type(x) is Dual:
        s, c = y.real, x.real
        ds, dc = (v.dual if type(v) is Dual else ZERO for v in (y, x))
        return Dual(atan2(s, c), (ds * c - dc * s) / (s * s + c * c))
    y, x = (float(v) if type(v) is Exact else v for v in (y, x))
    owner = y if not isinstance(y, (int, float)) else x
    return library(owner).atan2(y, x)


def stumpff(k: int, y: Scalar) -> Scalar:
    """Stumpff's functions  c_k(y) = sum_i (-y)^i / (2 i + k)!  for k = 0 ... 3 and y >= 0.

        c_0 = cos r,   c_1 = sin r / r,   c_2 = (1 - cos r) / r^2,   c_3 = (r - sin r) / r^3,   r^2 = y

    They are entire, which is what exp and log near the identity need, and closed under
    differentiation: c_k' = (k c_{k+2} - c_{k+1}) / 2.
    """
    if type(y) is Dual:
        # k = 0 and 1 have their derivatives among c_1 ... c_3; no algorithm needs more
        slope = -stumpff(1, y.real) if k == 0 else stumpff(3, y.real) - stumpff(2, y.real)
        return Dual(stumpff(k, y.real), slope * y.dual / 2)
    return library(y).stumpff(k, y)


def real_part(x: Scalar) -> Scalar:
    """The real part of a dual number, the number itself of any other scalar."""
    return x.real if type(x) is Dual else x


def where(condition: Any, a: Scalar, b: Scalar) -> Scalar:
    """a where the condition holds, else b: a choice between numbers, or member by member in a batch."""
    if not isinstance(condition, np.ndarray):
        return a if condition else b
    if type(a) is Dual or type(b) is Dual:
        a, b = (x if type(x) is Dual else Dual(x, ZERO) for x in (a, b))
        return Dual(where(condition, a.real, b.real), where(condition, a.dual, b.dual))
    a, b = (float(x) if type(x) is Exact else x for x in (a, b))
    return np.where(condition, a, b)
