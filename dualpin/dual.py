"""Dual numbers a + eps b with eps^2 = 0, over any scalar, and the elementary functions.

A differentiable real function has one natural extension, f(a + eps b) = f(a) + eps f'(a) b.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from . import parts
from .delegates import home
from .errors import ArgumentError, ArgumentTypeError
from .extras import extra
from .parts import SEQUENCES, Parts, aligned, array, array_function, joined, product, raise_where, refuse, shown, unfit
from .scalars import ONE, ZERO, Compound, Exact, Scalar, exact, library

_on_duals = cache(lambda ufunc: home("numpy.ufunc")(ufunc))  # `ufuncs` uses this file, so it is imported when called


class Dual(Parts):
    """The dual number  real + eps dual, or an array of them.

    Parameters
    ----------
    real, dual : scalar or array_like
        Floats, complex numbers, symbols, mpmath or SymPy numbers; or arrays (lists become arrays) whose
        shapes are broadcast together.

    Notes
    -----
    ``==`` compares both parts.  The order is that of the dual numbers as an ordered ring, eps being positive
    and smaller than every positive number: real parts decide, dual parts where these are equal.

    NumPy's universal functions and its linear functions of arrays act on dual arrays; ``@`` is the product of
    (stacks of) matrices.  Operations without a value (division by eps, the derivative of a root at 0) raise
    `DualDivisionError` with the index of the entry.

    References
    ----------
    Clifford (1873); Study (1903).

    Examples
    --------
    >>> from dualpin import Dual
    >>> Dual(3.0, 1.0) * Dual(2.0, 5.0)
    Dual(6.0, 17.0)
    >>> import numpy as np
    >>> np.sin(Dual(0.0, 2.0))
    Dual(0.0, 2.0)
    >>> A = Dual([[1, 2], [3, 3]], [[1, 3], [9, 1]])
    >>> (A @ A).dual.tolist()
    [[29.0, 16.0], [42.0, 33.0]]
    >>> f"{Dual(2.0, 1.0):exponential}"
    '2.0 exp(0.5 eps)'
    """

    __slots__ = ("dual", "real")

    def __init__(self, real: Scalar, dual: Scalar = 0) -> None:
        if real.__class__ in SEQUENCES or dual.__class__ in SEQUENCES:
            real, dual = aligned(real, dual)
        self.real, self.dual = real, dual

    def __repr__(self) -> str:
        text = f"Dual({shown(self.real)}, {shown(self.dual)})"
        return text if text.count("\n") < 9 else f"<Dual of shape {np.shape(self.real)}>"

    # the ring

    def __neg__(self) -> Dual:
        return _dual(-self.real, -self.dual)

    def __pos__(self) -> Dual:
        return self

    def __add__(self, b: Scalar) -> Dual:
        try:
            if type(b) is Dual:
                return _dual(self.real + b.real, self.dual + b.dual)
            return NotImplemented if isinstance(b, Compound) else Dual(self.real + b, self.dual)
        except ValueError as e:
            raise unfit("+", self, b, e) from None

    def __sub__(self, b: Scalar) -> Dual:
        try:
            if type(b) is Dual:
                return _dual(self.real - b.real, self.dual - b.dual)
            return NotImplemented if isinstance(b, Compound) else Dual(self.real - b, self.dual)
        except ValueError as e:
            raise unfit("-", self, b, e) from None

    def __rsub__(self, b: Scalar) -> Dual:
        try:
            return Dual(b - self.real, -self.dual)
        except ValueError as e:
            raise unfit("-", b, self, e) from None

    def __mul__(self, b: Scalar) -> Dual:
        """(a + eps a')(b + eps b') = a b + eps (a b' + a' b)"""
        try:
            if type(b) is Dual:
                x, dx, y, dy = self.real, self.dual, b.real, b.dual
                if x is ZERO or dy is ZERO:  # what is not there is not added
                    return _dual(x * y, dx * y)
                return _dual(x * y, x * dy if y is ZERO or dx is ZERO else x * dy + dx * y)
            return NotImplemented if isinstance(b, Compound) else Dual(self.real * b, self.dual * b)
        except ValueError as e:
            raise unfit("*", self, b, e) from None

    def __truediv__(self, b: Scalar) -> Dual:
        """(a + eps a') / (b + eps b') = q + eps (a' - q b') / b  with q = a / b"""
        try:
            if type(b) is Dual:
                refuse(b.real, "division by {}: only numbers with a real part have an inverse", b)
                q = self.real / b.real
                return Dual(q, (self.dual - q * b.dual) / b.real)
            refuse(b, "division of a dual number by {}", b)
            return Dual(self.real / b, self.dual / b)
        except ValueError as e:
            raise unfit("/", self, b, e) from None

    def __rtruediv__(self, b: Scalar) -> Dual:
        return Dual(b, b * 0) / self

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, n: Scalar) -> Dual:
        return power(self, n)

    def __rpow__(self, b: Scalar) -> Dual:
        return power(b, self)

    def __abs__(self) -> Dual:
        """|a| + eps sign(a) a'; of complex numbers |a| + eps Re(conj(a) a') / |a|."""
        if not self.shape and not self.real and not self.dual:
            return self
        a, b = self.real, self.dual
        if self.shape:
            raise_where((a == 0) & (b != 0), f"abs of a pure dual number in {self}: |x| has no derivative at 0")
            size = np.abs(a)
            return Dual(size, np.real(np.conj(a / np.where(size == 0, 1.0, size)) * b))
        refuse(a, "abs of {}: |x| has no derivative at 0", self)
        if isinstance(a, complex) or isinstance(b, complex):
            return Dual(abs(a), (a.conjugate() / abs(a) * b).real)
        return self if a > 0 else -self

    def __matmul__(self, b: Any) -> Dual:
        """A B + eps (A B' + A' B)"""
        return NotImplemented if isinstance(b, Compound) else product(np.matmul, Dual, self, b)

    def __rmatmul__(self, a: Any) -> Dual:
        return product(np.matmul, Dual, a, self)

    # comparison

    def __eq__(self, b: object) -> Any:
        if isinstance(b, Compound):
            return NotImplemented
        c, d = (b.real, b.dual) if type(b) is Dual else (b, 0)
        real, dual = self.real == c, self.dual == d
        return real & dual if isinstance(real, np.ndarray) or isinstance(dual, np.ndarray) else bool(real and dual)

    def __ne__(self, b: object) -> Any:
        same = self.__eq__(b)
        return same if same is NotImplemented else np.logical_not(same) if isinstance(same, np.ndarray) else not same

    def __hash__(self) -> int:
        return hash(self.real) if self.dual == 0 else hash((self.real, self.dual))

    def _before(self, b: Any, compare: Callable[[Any, Any], Any]) -> Any:
        c, d = (b.real, b.dual) if type(b) is Dual else (b, 0)
        return where(self.real == c, compare(self.dual, d), compare(self.real, c))

    def __lt__(self, b: Any) -> Any:
        return self._before(b, operator.lt)

    def __le__(self, b: Any) -> Any:
        return self._before(b, operator.le)

    def __gt__(self, b: Any) -> Any:
        return self._before(b, operator.gt)

    def __ge__(self, b: Any) -> Any:
        return self._before(b, operator.ge)

    def __bool__(self) -> bool:
        if self.size != 1:
            raise ArgumentError(f"a dual array of shape {self.shape} is neither true nor false; take np.any or np.all")
        return bool(np.any(self.real != 0)) or bool(np.any(self.dual != 0))

    # NumPy

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """With dtype=object an array of dual numbers; there is no other array that holds both parts."""
        if dtype is None or np.dtype(dtype) != object:
            raise ArgumentTypeError(
                "a dual array is not one array of numbers: take .real and .dual, np.stack a list of dual numbers, "
                "or ask for dtype=object"
            )
        entries = np.empty(self.shape, dtype=object)
        for index in np.ndindex(self.shape):
            entries[index] = self[index] if index else self
        return entries

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *args: Any, **options: Any) -> Any:
        f = _on_duals(ufunc)
        if f is None or method != "__call__" or options or any(isinstance(x, Compound) for x in args):
            return NotImplemented
        return f(*args)

    def __array_function__(self, func: Any, types: Any, args: Any, options: Any) -> Any:
        return array_function(Dual, func, args, options)


_new, _ARRAY = object.__new__, np.ndarray


def _dual(real: Scalar, dual: Scalar) -> Dual:
    """The dual number of parts that were computed: only arrays may have to be broadcast."""
    if real.__class__ is _ARRAY or dual.__class__ is _ARRAY:
        real, dual = aligned(real, dual)
    made = _new(Dual)
    made.real, made.dual = real, dual
    return made


EPS = Dual(ZERO, ONE)


def stack(items: Sequence[Any], axis: int = 0) -> Dual:
    """Dual and plain numbers or arrays of one shape along a new axis, as np.stack."""
    return joined(np.stack, Dual, items, axis=axis)


# --- functions over any scalar -------------------------------------------------------------------


class Function:
    """An elementary function over any scalar, with f(a + eps b) = f(a) + eps f'(a) b.

    poles : where f' is infinite; f may have a real value there, but no dual one.
    """

    def __init__(self, name: str, derivative: Callable[[Scalar], Scalar], poles: tuple[complex, ...] = ()) -> None:
        self.name, self.derivative, self.poles = name, derivative, poles
        self.__doc__ = f"{name}(x) for any scalar x."

    def __repr__(self) -> str:
        return f"<dualpin {self.name}>"

    def __call__(self, x: Scalar) -> Scalar:
        if type(x) is Dual:
            for pole in self.poles:
                refuse(x.real, f"{self.name} of {{}}: its derivative at {pole} is infinite", x, pole)
            return Dual(self._value(x), self.derivative(x.real) * x.dual)
        if type(x) is Exact:
            return exact(self(float(x)))
        if type(x) is np.ndarray and x.dtype == object:
            return np.frompyfunc(self, 1, 1)(x)
        return getattr(library(x), self.name)(x)

    def _value(self, x: Dual) -> Scalar:
        """f(a), with a clear error outside its domain."""
        try:
            if type(x.real) is not np.ndarray or x.real.dtype.kind != "f":
                return self(x.real)
            with np.errstate(invalid="ignore"):
                value = self(x.real)
        except ValueError as e:
            raise ArgumentError(f"{self.name} of {x}: no real value there ({e}); complex parts have one") from None
        wrong = np.isnan(value) & ~np.isnan(x.real)
        if np.any(wrong):
            at = tuple(int(i) for i in np.argwhere(wrong)[0])
            raise ArgumentError(
                f"{self.name} of {x.real[at]} at index {at}: no real value there; complex parts have one"
            )
        return value


def _square(x: Scalar) -> Scalar:
    return x * x


sin: Function = Function("sin", lambda x: cos(x))
cos: Function = Function("cos", lambda x: -sin(x))
tan: Function = Function("tan", lambda x: 1 + _square(tan(x)))
asin: Function = Function("asin", lambda x: 1 / sqrt(1 - x * x), (1, -1))
acos: Function = Function("acos", lambda x: -1 / sqrt(1 - x * x), (1, -1))
atan: Function = Function("atan", lambda x: 1 / (1 + x * x), (1j, -1j))
sinh: Function = Function("sinh", lambda x: cosh(x))
cosh: Function = Function("cosh", lambda x: sinh(x))
tanh: Function = Function("tanh", lambda x: 1 / (cosh(x) * cosh(x)))
exp: Function = Function("exp", lambda x: exp(x))
log: Function = Function("log", lambda x: 1 / x, (0,))
sqrt: Function = Function("sqrt", lambda x: 1 / (2 * sqrt(x)), (0,))


def power(x: Scalar, n: Scalar) -> Scalar:
    """x^n for dual x and n:  a^n + eps (n a^(n-1) a' + a^n log(a) n').

    An integer n >= 0 is a product; a negative n needs a real part other than zero; a fractional n needs a
    positive real part (or 0, if the derivative is finite, n > 1).
    """
    n = np.asarray(n) if isinstance(n, (list, tuple)) else n
    if type(n) is Dual:
        a = x.real if type(x) is Dual else x
        value = parts.real_power(a, n.real, x)
        if np.any(array(n.dual) != 0) and isinstance(a, (float, int, np.ndarray)) and np.any(np.asarray(a) <= 0):
            raise ArgumentError(f"power: {x} to the {n}: an exponent with a dual part needs a positive base")
        slope = value * log(a) * n.dual if np.any(array(n.dual) != 0) else ZERO
        return Dual(value, (power(x, n.real).dual if type(x) is Dual else ZERO) + slope)
    if type(x) is not Dual:
        return x**n
    if not isinstance(n, np.ndarray) and n == 0:
        return x * 0 + 1
    if not isinstance(n, np.ndarray) and n == 1:
        return x
    less = np.where(n == 0, 0, n - 1) if isinstance(n, np.ndarray) else n - 1  # 0 a^0, not 0 a^-1
    return Dual(parts.real_power(x.real, n, x), n * parts.real_power(x.real, less, x) * x.dual)


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
        r = hypot(s, c)
        refuse(r, "atan2 of {}: both real parts are zero", (y, x))
        return Dual(atan2(s, c), (ds * (c / r) - dc * (s / r)) / r)
    y, x = (float(v) if type(v) is Exact else v for v in (y, x))
    if any(type(v) is np.ndarray and v.dtype == object for v in (y, x)):
        return np.frompyfunc(atan2, 2, 1)(y, x)
    owner = y if not isinstance(y, (int, float)) else x
    return library(owner).atan2(y, x)


def hypot(a: Scalar, b: Scalar) -> Scalar:
    """sqrt(a^2 + b^2) of dual and other scalars; of numbers also where the squares over- or underflow."""
    if type(a) is Dual or type(b) is Dual:
        x, y = a.real, b.real
        dx, dy, r = a.dual if type(a) is Dual else ZERO, b.dual if type(b) is Dual else ZERO, hypot(x, y)
        refuse(r, "hypot of {}: its derivative at 0 is infinite", (a, b))
        return Dual(r, (x / r) * dx + (y / r) * dy)
    a, b = (float(v) if type(v) is Exact else v for v in (a, b))
    owner = a if not isinstance(a, (int, float)) else b
    known = None if np.asarray(owner).dtype.hasobject else getattr(library(owner), "hypot", None)
    return known(a, b) if known else sqrt(a * a + b * b)


def stumpff(k: int, y: Scalar) -> Scalar:
    """Stumpff's functions  c_k(y) = sum_i (-y)^i / (2 i + k)!  for k = 0 ... 3 and y >= 0.

        c_0 = cos r,   c_1 = sin r / r,   c_2 = (1 - cos r) / r^2,   c_3 = (r - sin r) / r^3,   r^2 = y

    They are entire, so exp and log are exact near the identity, and closed under differentiation:
    c_k' = (k c_{k+2} - c_{k+1}) / 2.
    """
    if type(y) is Dual:
        slope = -stumpff(1, y.real) if k == 0 else stumpff(3, y.real) - stumpff(2, y.real)
        return Dual(stumpff(k, y.real), slope * y.dual / 2)
    if type(y) is np.ndarray and y.dtype == object:
        return np.frompyfunc(lambda x: stumpff(k, x), 1, 1)(y)
    return library(y).stumpff(k, y)


def real_part(x: Scalar) -> Scalar:
    """The real part of a dual number; any other scalar unchanged."""
    return x.real if type(x) is Dual else x


def where(condition: Any, a: Scalar, b: Scalar) -> Scalar:
    """a where the condition holds, else b; elementwise in a batch."""
    choose = getattr(condition, "choose", None)  # a comparison of symbols; arrays have another choose
    symbolic = choose is not None and not isinstance(condition, (np.ndarray, np.generic))
    formula = getattr(condition, "is_Relational", False)  # of SymPy
    if not symbolic and not formula and not isinstance(condition, np.ndarray):
        return a if condition else b
    if type(a) is Dual or type(b) is Dual:
        a, b = (x if type(x) is Dual else Dual(x, ZERO) for x in (a, b))
        return Dual(where(condition, a.real, b.real), where(condition, a.dual, b.dual))
    if symbolic:
        return condition.choose(a, b)
    if formula:
        return extra("sympy", "exact", "a choice between formulas").Piecewise((a, condition), (b, True))
    a, b = (float(x) if type(x) is Exact else x for x in (a, b))
    return np.where(condition, a, b)
