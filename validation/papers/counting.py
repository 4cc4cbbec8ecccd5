"""A scalar that counts: what an algorithm costs is measured by running it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from dualpin.scalars import NAMES, Exact, register


class Counted:
    """A number that is known only at run time; every operation on it is written down."""

    tally: Counter[str] = Counter()
    __array_ufunc__ = None

    def _did(self, what: str, other: Any = None) -> Counted:
        Counted.tally[what] += 1
        return Counted()

    def __neg__(self) -> Counted:
        return self  # signs are free, as in the papers' counts

    def __add__(self, b: Any) -> Any:
        return NotImplemented if isinstance(b, Exact) else self._did("sum")

    def __mul__(self, b: Any) -> Any:
        return NotImplemented if isinstance(b, Exact) else self._did("product")

    def __truediv__(self, b: Any) -> Any:
        return self._did("product")

    def __gt__(self, b: Any) -> bool:
        return True

    __sub__ = __rsub__ = __radd__ = __add__
    __rmul__, __rtruediv__ = __mul__, __truediv__


register(
    Counted,
    SimpleNamespace(**{name: (lambda x, n=name: x._did("call")) for name in (*NAMES, "atan2")}),
)


def count(f: Callable[..., Any], *args: Any) -> tuple[int, int, int]:
    """(products and divisions, sums, elementary calls) of one run."""
    Counted.tally = Counter()
    f(*args)
    return Counted.tally["product"], Counted.tally["sum"], Counted.tally["call"]
