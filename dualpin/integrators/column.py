"""A column of scalars that adds and scales like an array, so that one step function serves both."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ..scalars import Scalar


class Column(tuple):
    """Scalars of any kind, added and scaled entry by entry.

    A step written with ``+`` and ``* scalar`` runs on arrays (a batch of numbers) and on columns
    (floats, or the symbols of a kernel being traced).

    Examples
    --------
    >>> from dualpin.integrators import Column
    >>> Column([1.0, 2.0]) + Column([3.0, 4.0]) * 0.5
    Column(2.5, 4.0)
    """

    __slots__ = ()
    __array_ufunc__ = None

    def __repr__(self) -> str:
        return f"Column({', '.join(map(repr, self))})"

    def __getitem__(self, i: Any) -> Any:
        part = tuple.__getitem__(self, i)
        return Column(part) if isinstance(i, slice) else part

    def __add__(self, b: Iterable[Scalar]) -> Column:
        return Column(x + y for x, y in zip(self, b, strict=True))

    def __sub__(self, b: Iterable[Scalar]) -> Column:
        return Column(x - y for x, y in zip(self, b, strict=True))

    def __mul__(self, s: Scalar) -> Column:
        return Column(x * s for x in self)

    def __rmul__(self, s: Scalar) -> Column:
        return self * s


def combination(weights: Sequence[float], vectors: Sequence[Any], h: Any) -> Any:
    """h sum_j w_j k_j over arrays or columns; None where every weight is zero."""
    total = None
    for w, k in zip(weights, vectors, strict=False):
        if w:
            part = k * (h if w == 1 else h * w)
            total = part if total is None else total + part
    return total
