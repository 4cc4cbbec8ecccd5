"""Rules for arguments that know no robot: each stands here once, and names what was expected."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .errors import ArgumentError, ShapeError, nearest


def numbers(what: str, value: ArrayLike) -> np.ndarray:
    """`value` as float64; complex, text and objects are refused rather than cut."""
    try:
        x = np.asarray(value)
    except ValueError as e:
        raise ShapeError(f"{what}: not an array ({e})") from None
    if x.dtype.kind not in "fiub":
        raise ArgumentError(f"{what}: real numbers expected, got {x.dtype} ({type(value).__name__})")
    return x.astype(np.float64, copy=False)


def choice(what: str, value: object, choices: tuple[str, ...]) -> str:
    """`value` if it is one of the choices, else an error that offers the nearest."""
    if not isinstance(value, str) or value not in choices:
        raise ArgumentError(f"{what} {value!r} is not known; {nearest(str(value), choices)}")
    return value


def flag(what: str, value: object) -> bool:
    """True or False, or a number that equals one of them."""
    if not isinstance(value, (bool, int, float, np.bool_, np.number)) or value not in (0, 1):
        raise ArgumentError(f"{what}: True or False expected, got {value!r}")
    return bool(value)


def count(what: str, value: object, least: int = 0) -> int:
    """A whole number from `least` on, of Python's or NumPy's types."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
        raise ArgumentError(f"{what}: a whole number from {least} on expected, got {value!r}")
    return int(value)
