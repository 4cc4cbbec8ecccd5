"""Checks of arguments that do not depend on a robot; each error names what was expected."""

from __future__ import annotations

import operator
from math import inf, isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .errors import ArgumentError, ShapeError, nearest


def numbers(what: str, value: ArrayLike) -> np.ndarray:
    """`value` as float64; complex numbers, text and objects are refused, not truncated."""
    try:
        x = np.asarray(value)
    except ValueError as e:
        raise ShapeError(f"{what}: not an array ({e})") from None
    if x.dtype.kind not in "fiub":
        raise ArgumentError(f"{what}: real numbers expected, got {x.dtype} ({type(value).__name__}){_hint(x)}")
    if hasattr(value, "mask") and np.ma.is_masked(value):
        raise ArgumentError(f"{what}: numbers expected, some of this masked array have none; fill them first")
    return x.astype(np.float64, copy=False)


def shaped(what: str, value: ArrayLike, *tail: int, batch: bool = True) -> np.ndarray:
    """As `numbers`, and of this shape, after any axes of a batch where there may be some."""
    x = numbers(what, value)
    if x.shape[max(x.ndim - len(tail), 0) :] != tail or (x.ndim > len(tail) and not batch):
        wanted = f"(..., {', '.join(map(str, tail))})" if batch else tail
        raise ShapeError(f"{what} of shape {wanted} expected, got {x.shape}")
    return x


def is_symbol(x: object) -> bool:
    """Whether x is a formula of SymPy: a symbol, a function of time, a number of its own kind."""
    return hasattr(x, "free_symbols")


def entries(what: str, value: Any) -> np.ndarray:
    """As `numbers`, but symbols are allowed: the result is then an array of objects, each a float or a formula."""
    try:
        x = np.asarray(value)
    except ValueError as e:
        raise ShapeError(f"{what}: not an array ({e})") from None
    if x.dtype.kind != "O" or not any(map(is_symbol, x.flat)):
        return numbers(what, value)
    if is_symbol(value) and x.ndim == 2 and x.shape[1] == 1:
        x = x[:, 0]  # a column of SymPy is a vector
    found = np.empty(x.shape, dtype=object)
    for i, entry in np.ndenumerate(x):
        found[i] = entry if is_symbol(entry) else float(numbers(what, entry))
        if getattr(entry, "is_number", False) and not (entry.is_real and entry.is_finite):
            raise ArgumentError(f"{what}: a finite real number or a formula expected, got {entry}")
    return found


def _hint(x: np.ndarray) -> str:
    if x.dtype.kind != "O":
        return ""
    return "; dualpin.symbolic and the functions of dualpin.algorithms take symbols and other numbers"


def choice(what: str, value: object, choices: tuple[str, ...]) -> str:
    """`value` if it is one of the choices; the error lists the nearest ones."""
    if not isinstance(value, str) or value not in choices:
        raise ArgumentError(f"{what} {value!r} is not known; {nearest(str(value), choices)}")
    return value


def flag(what: str, value: object) -> bool:
    """True or False, or a number that equals one of them."""
    if not isinstance(value, (bool, int, float, np.bool_, np.number)) or value not in (0, 1):
        raise ArgumentError(f"{what}: True or False expected, got {value!r}")
    return bool(value)


def count(what: str, value: object, least: int = 0, most: int | None = None) -> int:
    """A whole number from `least` (to `most`), of Python's or NumPy's types; neither 2.0 nor True is one."""
    try:
        n = None if _boolean(value) else operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        n = None
    if n is None or n < least or (most is not None and n > most):
        to = "on" if most is None else f"to {most}"
        raise ArgumentError(f"{what} = {value!r}, a whole number from {least} {to} expected")
    return n


def real(
    what: str, value: Any, unit: str = "", *, least: float = -inf, above: float = -inf, most: float = inf,
    infinite: bool = False,
) -> float:  # fmt: skip
    """`value` as a float from `least` to `most`, more than `above`; `infinite` admits infinity.

    Raises
    ------
    ArgumentError
        If it is not; the message says what was expected and what was given.
    """
    x = None
    if not isinstance(value, (bool, str, bytes)) and getattr(value, "shape", ()) == () and not _boolean(value):
        try:
            x = float(value)
        except (TypeError, ValueError, OverflowError):
            x = None
    fits = x is not None and (isfinite(x) or (infinite and x == inf)) and least <= x <= most
    if x is None or not fits or not (x > above or above == -inf):
        bound = "a positive number" if above == 0 else "a finite number"
        if most < inf:
            bound += f" from {least:g} to {most:g}"
        elif least > -inf:
            bound += f" of {least:g} or more"
        elif above not in (0, -inf):
            bound += f" above {above:g}"
        raise ArgumentError(f"{what} = {value!r}, {bound}{f' [{unit}]' if unit else ''} expected")
    return x


def _boolean(value: Any) -> bool:
    return isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"
