"""NumPy's universal functions of dual numbers."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from .dual import (
    Dual,
    acos,
    asin,
    atan,
    atan2,
    cos,
    cosh,
    exp,
    hypot,
    log,
    power,
    raise_where,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)  # fmt: skip
from .parts import array, product
from .scalars import Scalar

_SLOPES: dict[np.ufunc, Callable[[Scalar], Scalar]] = {
    np.arcsinh: lambda x: 1 / np.sqrt(x * x + 1),
    np.arccosh: lambda x: 1 / (np.sqrt(x - 1) * np.sqrt(x + 1)),
    np.arctanh: lambda x: 1 / (1 - x * x),
    np.cbrt: lambda x: 1 / (3 * np.cbrt(x) ** 2),
    np.exp2: lambda x: np.exp2(x) * np.log(2.0),
    np.expm1: np.exp,
    np.log1p: lambda x: 1 / (1 + x),
    np.log2: lambda x: 1 / (x * np.log(2.0)),
    np.log10: lambda x: 1 / (x * np.log(10.0)),
    np.deg2rad: lambda x: np.pi / 180,
    np.radians: lambda x: np.pi / 180,
    np.rad2deg: lambda x: 180 / np.pi,
    np.degrees: lambda x: 180 / np.pi,
}
"""Functions of numbers only (floats and their arrays), with their derivatives."""


def _numeric(ufunc: np.ufunc, slope: Callable[[Scalar], Scalar]) -> Callable[[Dual], Dual]:
    def f(x: Dual) -> Dual:
        with np.errstate(divide="ignore", invalid="ignore"):
            value, k = ufunc(x.real), slope(np.asarray(x.real))
        raise_where(np.isinf(k), f"{ufunc.__name__} of {x}: its derivative is infinite")
        return Dual(value, k * x.dual)

    return f


def _either_sign(x: Dual) -> Any:
    return np.sign(array(x.real))


UFUNCS: dict[np.ufunc, Callable[..., Any]] = {
    np.add: lambda a, b: a + b if type(a) is Dual else b + a,
    np.subtract: lambda a, b: a - b if type(a) is Dual else b.__rsub__(a),
    np.multiply: lambda a, b: a * b if type(a) is Dual else b * a, np.negative: operator.neg,
    np.true_divide: lambda a, b: a / b if type(a) is Dual else b.__rtruediv__(a), np.positive: operator.pos,
    np.power: power, np.float_power: power, np.square: lambda x: x * x, np.reciprocal: lambda x: 1 / x,
    np.matmul: lambda a, b: product(np.matmul, Dual, a, b), np.absolute: abs, np.fabs: abs, np.sign: _either_sign,
    np.conjugate: lambda x: x.conj(), np.arctan2: lambda y, x: atan2(y, x),
    np.sin: sin, np.cos: cos, np.tan: tan, np.arcsin: asin, np.arccos: acos, np.arctan: atan,
    np.sinh: sinh, np.cosh: cosh, np.tanh: tanh, np.exp: exp, np.log: log, np.sqrt: sqrt,
    np.hypot: hypot,
    np.equal: lambda a, b: a == b if type(a) is Dual else b == a,
    np.not_equal: lambda a, b: ~np.asarray(a == b if type(a) is Dual else b == a),
    np.less: lambda a, b: a < b if type(a) is Dual else b > a,
    np.less_equal: lambda a, b: a <= b if type(a) is Dual else b >= a,
    np.greater: lambda a, b: a > b if type(a) is Dual else b < a,
    np.greater_equal: lambda a, b: a >= b if type(a) is Dual else b <= a,
    np.isfinite: lambda x: np.isfinite(array(x.real)) & np.isfinite(array(x.dual)),
    np.isnan: lambda x: np.isnan(array(x.real)) | np.isnan(array(x.dual)),
    **{ufunc: _numeric(ufunc, slope) for ufunc, slope in _SLOPES.items()},
}  # fmt: skip
"""NumPy's function -> the function of dual numbers."""


def on_duals(ufunc: np.ufunc) -> Callable[..., Any] | None:
    """The implementation of a universal function for dual numbers, or None."""
    return UFUNCS.get(ufunc)
