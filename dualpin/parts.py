"""Array operations of dual numbers, which act on both parts alike."""

from __future__ import annotations

import numbers
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from functools import partial
from typing import Any

import numpy as np

from .delegates import home
from .errors import ArgumentError, DualDivisionError, ShapeError
from .scalars import Exact, Scalar, exact

SEQUENCES = {list, tuple, int, np.ndarray, str, type(None)}
"""Types of parts that are converted when a dual number is made; others are not changed."""


FLOAT64 = np.dtype(float)
ARRAY = np.ndarray


def aligned(real: Scalar, dual: Scalar) -> tuple[Scalar, Scalar]:
    """Lists become arrays, parts of different shapes are broadcast; exact constants stay exact."""
    kind, other = real.__class__, dual.__class__
    if kind is ARRAY and real.dtype is FLOAT64:  # the usual ones first: this is done for every operation on arrays
        if (other is ARRAY and dual.dtype is FLOAT64 and real.shape == dual.shape) or other is Exact:
            return real, dual
    elif other is ARRAY and kind is Exact and dual.dtype is FLOAT64:
        return real, dual
    for x in (real, dual):
        if x is None or isinstance(x, str):
            raise ArgumentError(f"Dual: a number, a symbol or an array of them expected, got {x!r}")
    if kind is other is ARRAY and real.shape == dual.shape and _floating(real) and _floating(dual):
        return real, dual
    if not any(isinstance(x, (list, tuple, np.ndarray)) for x in (real, dual)):
        return real, dual
    try:
        real, dual = (x if type(x) is Exact else np.asarray(x) for x in (real, dual))
        shape = np.broadcast_shapes(*(x.shape for x in (real, dual) if type(x) is not Exact))
    except ValueError as e:
        raise ArgumentError(f"Dual: the parts do not form arrays of one shape ({e})") from None
    return _spread(real, shape), _spread(dual, shape)


def shown(x: Scalar) -> str:
    """A part as its repr, numbers of NumPy and decimals without the names of their types."""
    return str(x) if isinstance(x, (np.generic, Decimal)) else repr(x)


def _floating(x: np.ndarray) -> bool:
    return x.dtype.kind not in "biu"


def _spread(x: Scalar, shape: tuple[int, ...]) -> Scalar:
    if type(x) is Exact:
        return x
    if x.dtype.kind not in "biufcO":
        raise ArgumentError(f"Dual: numbers expected, got an array of {x.dtype}")
    x = x.astype(float) if x.dtype.kind in "biu" else x
    return x if x.shape == shape else np.broadcast_to(x, shape).copy()


def array(x: Scalar) -> np.ndarray:
    """A part as an array."""
    return np.asarray(float(x) if type(x) is Exact else x)


class Parts:
    """Mixin of `Dual`: shape, indexing, transposition, sums, complex conjugation of both parts."""

    __slots__ = ()
    real: Any
    dual: Any

    def __init__(self, real: Scalar, dual: Scalar = 0) -> None:
        raise NotImplementedError  # defined by Dual

    def both(self, f: Callable[[np.ndarray], Any]) -> Any:
        """Dual(f(real part), f(dual part)), for an f that is linear and keeps dual numbers apart."""
        return type(self)(*map(f, self.arrays))

    @property
    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Both parts as arrays of one shape."""
        a, b = np.broadcast_arrays(array(self.real), array(self.dual))
        return a, b

    @property
    def shape(self) -> tuple[int, ...]:
        return np.broadcast_shapes(np.shape(array(self.real)), np.shape(array(self.dual)))

    @property
    def ndim(self) -> int:
        return len(self.shape)

    @property
    def size(self) -> int:
        return int(np.prod(self.shape, dtype=int))

    def __len__(self) -> int:
        if not self.shape:
            raise TypeError("a dual number without axes has no len()")
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, index: Any) -> Any:
        return self.both(lambda x: x[index])

    def __setitem__(self, index: Any, value: Any) -> None:
        a, b = (value.real, value.dual) if isinstance(value, Parts) else (value, 0.0)
        if not (isinstance(self.real, np.ndarray) and isinstance(self.dual, np.ndarray)):
            raise TypeError("this dual number does not support assignment to its entries")
        self.real[index], self.dual[index] = a, b

    def reshape(self, *shape: Any) -> Any:
        return self.both(lambda x: x.reshape(*shape))

    def ravel(self) -> Any:
        return self.both(np.ravel)

    def transpose(self, *axes: Any) -> Any:
        return self.both(lambda x: x.transpose(*axes))

    def swapaxes(self, i: int, j: int) -> Any:
        return self.both(lambda x: x.swapaxes(i, j))

    def astype(self, dtype: Any) -> Any:
        return self.both(lambda x: x.astype(dtype))

    def copy(self) -> Any:
        return self.both(np.copy)

    @property
    def T(self) -> Any:
        """All axes reversed, as of NumPy's arrays."""
        return self.both(np.transpose)

    @property
    def mT(self) -> Any:
        """The last two axes exchanged: the transpose of each matrix of a stack."""
        return self.both(lambda x: x.swapaxes(-1, -2))

    def sum(self, axis: Any = None, dtype: Any = None, out: Any = None, keepdims: bool = False) -> Any:
        _no_out(out)
        return self.both(partial(np.sum, axis=axis, dtype=dtype, keepdims=keepdims))

    def mean(self, axis: Any = None, dtype: Any = None, out: Any = None, keepdims: bool = False) -> Any:
        _no_out(out)
        return self.both(partial(np.mean, axis=axis, dtype=dtype, keepdims=keepdims))

    def conj(self) -> Any:
        """The complex conjugate of both parts; see `dual_conjugate` for the sign of eps."""
        return self.both(np.conj) if self.shape else type(self)(_conj(self.real), _conj(self.dual))

    conjugate = conj

    @property
    def H(self) -> Any:
        """Conjugate transpose of each matrix."""
        return self.mT.conj()

    @property
    def dual_conjugate(self) -> Any:
        """A - eps b."""
        return type(self)(self.real, -self.dual)

    @property
    def polar(self) -> tuple[Any, Any]:
        """(rho, t) of the polar form rho (1 + eps t), which is the exponential form rho e^(eps t) too.

        Products add t, powers multiply it.  (Pennestri & Stefanelli 2007, sec. 4)
        """
        t = self / self.real
        return self.real, t.dual

    @classmethod
    def from_polar(cls, rho: Scalar, t: Scalar) -> Any:
        """Rho (1 + eps t) = rho e^(eps t)."""
        rho, t = (np.asarray(x) if isinstance(x, (list, tuple)) else x for x in (rho, t))
        return cls(rho, rho * t)

    def __format__(self, spec: str) -> str:
        """f"{x}", f"{x:polar}", f"{x:exponential}"; digits follow as in f"{x:polar.3g}"."""
        forms = {"polar": "{} (1 + {} eps)", "exponential": "{} exp({} eps)", "gaussian": "{} + {} eps"}
        for form, text in forms.items():
            if spec.startswith(form):
                a, b = (self.real, self.dual) if form == "gaussian" else self.polar
                return text.format(*(format(x, spec[len(form) :]) for x in (a, b)))
        return format(repr(self), spec) if not spec else f"{self.real:{spec}} + {self.dual:{spec}} eps"


def _conj(x: Scalar) -> Scalar:
    return x.conjugate() if hasattr(x, "conjugate") else x


def refuse(x: Scalar, message: str, shown: object, bad: complex = 0) -> None:
    """Raise if a real part is `bad`; symbols are not checked."""
    kind = x.__class__
    if kind is np.ndarray:
        raise_where(x == bad, message.format("an entry of an array"))
    elif (kind is float or isinstance(x, numbers.Number)) and x == bad:
        raise DualDivisionError(message.format(shown))


def raise_where(wrong: np.ndarray, message: str) -> None:
    if np.any(wrong):
        where = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise DualDivisionError(f"{message}, at index {where}" if where else message)


def _no_out(out: Any) -> None:
    if out is not None:
        raise ArgumentError("dual numbers are not written into an array given as out=")


# --- NumPy's functions of arrays -----------------------------------------------------------------


def joined(f: Callable[..., np.ndarray], make: type, items: Sequence[Any], *args: Any, **options: Any) -> Any:
    """np.concatenate, np.stack, ... of dual and plain arrays."""
    pairs = [x.arrays if isinstance(x, Parts) else (np.asarray(x), np.zeros(np.shape(x))) for x in items]
    return make(*(f([p[i] for p in pairs], *args, **options) for i in (0, 1)))


LINEAR = frozenset((
    np.transpose, np.moveaxis, np.swapaxes, np.squeeze, np.expand_dims, np.broadcast_to, np.reshape, np.ravel,
    np.sum, np.mean, np.trace, np.diagonal, np.cumsum, np.flip, np.roll, np.repeat, np.tile, np.take, np.diff, np.copy,
    np.diag, np.zeros_like, np.round, np.triu, np.tril, np.conj, np.take_along_axis,
))  # fmt: skip
JOINING = frozenset((np.concatenate, np.stack, np.vstack, np.hstack, np.column_stack))
PRODUCTS = frozenset((np.dot, np.cross, np.inner, np.outer, np.tensordot, np.kron, np.vdot))
SHAPES = {np.shape: lambda x: x.shape, np.ndim: lambda x: x.ndim, np.size: lambda x: x.size}


def array_function(make: type, func: Any, args: Sequence[Any], options: dict[str, Any]) -> Any:
    """NumPy's own functions on dual arrays, as far as they are linear in each argument."""
    if func in SHAPES:
        return SHAPES[func](*args)
    if func in LINEAR:
        return args[0].both(lambda x: func(x, *args[1:], **options))
    if func in JOINING:
        return joined(func, make, *args, **options)
    if func in PRODUCTS:
        return product(func, make, args[0], args[1], *args[2:], **options)
    if func is np.einsum:
        return _einsum(make, *args, **options)
    if func in (np.isclose, np.allclose):
        (a, da), (b, db) = (x.arrays if isinstance(x, Parts) else (np.asarray(x), 0.0) for x in args[:2])
        near = [func(x, y, *args[2:], **options) for x, y in ((a, b), (da, db))]
        return near[0] & near[1]
    if func is np.where and len(args) == 3:
        (a, da), (b, db) = (x.arrays if isinstance(x, Parts) else (np.asarray(x), 0.0) for x in args[1:])
        return make(np.where(args[0], a, b), np.where(args[0], da, db))
    if func.__module__ == "numpy.linalg":
        ours = getattr(home("numpy.linalg"), func.__name__, None)
        if ours is not None:
            return ours(*args, **options)
    return NotImplemented


def unfit(operation: str, a: Any, b: Any, e: ValueError) -> Exception:
    """A ValueError of an operation as ShapeError, if the shapes do not broadcast."""
    shapes = [x.shape if isinstance(x, Parts) else np.shape(x) for x in (a, b)]
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        return ShapeError(f"{operation}: dual numbers of shapes {shapes[0]} and {shapes[1]} do not go together")
    return e


def product(f: Callable[..., Any], make: type, a: Any, b: Any, *args: Any, **options: Any) -> Any:
    """A bilinear f over dual numbers: f(a, b) + eps (f(a, b') + f(a', b))."""
    (x, dx), (y, dy) = (c.arrays if isinstance(c, Parts) else (np.asarray(c), None) for c in (a, b))
    try:
        real = f(x, y, *args, **options)
    except ValueError as e:
        raise ShapeError(f"{f.__name__}: {np.shape(x)} and {np.shape(y)} do not go together ({e})") from None
    terms = [f(*pair, *args, **options) for pair in ((x, dy), (dx, y)) if pair[0] is not None and pair[1] is not None]
    return make(real, sum(terms[1:], terms[0]))


def _einsum(make: type, subscripts: str, *operands: Any, **options: Any) -> Any:
    parts = [x.arrays if isinstance(x, Parts) else (np.asarray(x), None) for x in operands]
    real = [p[0] for p in parts]
    duals = [(i, d) for i, (_, d) in enumerate(parts) if d is not None]
    terms = [np.einsum(subscripts, *real[:i], d, *real[i + 1 :], **options) for i, d in duals]
    return make(np.einsum(subscripts, *real, **options), sum(terms[1:], terms[0]))


def real_power(a: Scalar, n: Scalar, x: Scalar) -> Scalar:
    """a^n, refused at a = 0 with n < 0, and for a < 0 with a fractional n."""
    if type(a) is Exact:
        return exact(a.n**n)
    if isinstance(a, np.integer):
        a = float(a)
    known = all(isinstance(v, (float, int, np.ndarray)) and np.asarray(v).dtype != object for v in (a, n))
    if known:
        raise_where((np.asarray(a) == 0) & (np.asarray(n) < 0), f"power of {x}: infinite at 0")
        if np.any((np.asarray(a) < 0) & (np.asarray(n) % 1 != 0)):
            raise ArgumentError(f"power: {x} to the {n} has no real value; complex parts have one")
    return a**n
