"""The steps of a textbook algorithm, and everything that can go wrong at one of them.

An algorithm written with `Steps` reads as in the book.  Run without a slip it is right, and it lists every
single slip that each of its steps allows; run with some of those, it makes them:

    steps = Steps()
    alpha = steps.add("the angular acceleration", **{"z qdd": z * qdd, "w x z qd": cross(w, z * qd)})
    steps.found      # "w x z qd is left out of the angular acceleration", ...

Words: a site is what the step makes, as a noun with its article ("the moment about the centre of mass").
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ...subjects.layout import product, transposed

T = TypeVar("T")


class Slip(NamedTuple):
    """One thing that went wrong: at which step, with what, and how (a key of `KINDS`)."""

    site: str
    what: str
    how: str

    @property
    def says(self) -> str:
        return KINDS[self.how].says.format(site=self.site, what=self.what)

    @property
    def fix(self) -> str:
        return KINDS[self.how].fix.format(site=self.site, what=self.what)


class Kind(NamedTuple):
    """A kind of slip: its words about one step, its fix, and its line in the table of keys."""

    says: str
    fix: str
    row: str


KINDS = {
    "step_left_out": Kind("{what} is left out of {site}", "add {what}", "a term of an equation is left out"),
    "step_sign": Kind("{what} has the other sign in {site}", "turn its sign", "a term of an equation has another sign"),
    "step_half": Kind("{what} is counted half in {site}", "count it once", "a term of an equation is counted half"),
    "step_twice": Kind("{what} is counted twice in {site}", "count it once", "a term of an equation is counted twice"),
    "step_swapped": Kind(
        "the factors of the cross product change places in {site}", "change them back",
        "the factors of a cross product change places",
    ),
    "step_unturned": Kind(
        "{site} is not brought into the other axes", "transform it", "a quantity is not brought into other axes"
    ),
    "step_turned_back": Kind(
        "{site} is transformed by the transposed matrix", "transpose the matrix",
        "a quantity is brought into other axes by the transposed matrix",
    ),
    "step_other_turn": Kind(
        "{site} is transformed {what}", "use the other matrix", "a quantity is transformed by another matrix"
    ),
    "step_from_left": Kind(
        "{site} is turned from the left alone (R I in place of R I R^T)", "multiply by R^T from the right",
        "a matrix is turned from the left alone",
    ),
    "step_from_right": Kind(
        "{site} is turned from the right alone (I R^T in place of R I R^T)", "multiply by R from the left",
        "a matrix is turned from the right alone",
    ),
    "step_untransposed": Kind("{site} is not transposed", "transpose it", "a matrix is not transposed"),
    "step_other": Kind("{site} is {what}", "take the right one", "another quantity stands in a place of an equation"),
    "step_first": Kind("the first of {site} is left out", "begin one earlier", "the first turn of a loop is left out"),
    "step_last": Kind("the last of {site} is left out", "end one later", "the last turn of a loop is left out"),
}  # fmt: skip

_WEIGHTS = {"step_left_out": 0.0, "step_sign": -1.0, "step_half": 0.5, "step_twice": 2.0}
_TURNS = ("step_unturned", "step_turned_back")


class Steps:
    """Runs the steps of an algorithm, with the slips that it is given; without, it collects all that there can be.

    Parameters
    ----------
    *slips : Slip
        Of those that a run without a slip has `found`.

    Attributes
    ----------
    found : dict of Slip
        In the order of the steps; collected where no slip is given.
    """

    def __init__(self, *slips: Slip) -> None:
        self.found: dict[Slip, None] = {}
        self._right = not slips
        self._seen: set[str] = set()
        self._at: dict[str, list[Slip]] = {}
        for slip in slips:
            self._at.setdefault(slip.site, []).append(slip)

    def add(self, site: str, **terms: Any) -> Any:
        """The sum of the terms, which are named as in the book: `add("the force", **{"m a": ma, "m g": mg})`."""
        mine = self._here(site, lambda: [(name, kind) for name in terms for kind in _WEIGHTS])
        total: Any = None
        for name, x in terms.items():
            for slip in mine:
                if slip.what == name:
                    x = _WEIGHTS[slip.how] * x
            total = x if total is None else total + x
        return total

    def cross(self, site: str, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """a x b, alone in its place; a product that is a term of a sum needs none, since its sign is turned there."""
        x = cross(a, b)
        return -x if self._here(site, lambda: [("", "step_swapped")]) else x

    def turn(self, site: str, R: np.ndarray, x: np.ndarray, **others: Callable[[], np.ndarray]) -> np.ndarray:
        """R x, of vectors or six-vectors; `others` are other matrices, by what they do ("by the inverse")."""
        possible = [("", kind) for kind in _TURNS]
        for slip in self._here(site, lambda: possible + [(name, "step_other_turn") for name in others]):
            if slip.how == "step_unturned":
                return x
            R = others[slip.what]() if slip.how == "step_other_turn" else transposed(R)
        return product(R, x)

    def congruent(self, site: str, R: np.ndarray, I: np.ndarray) -> np.ndarray:
        """R I R^T."""
        kinds = (*_TURNS, "step_from_left", "step_from_right")
        for slip in self._here(site, lambda: [("", kind) for kind in kinds]):
            if slip.how == "step_unturned":
                return I + np.zeros_like(R)
            if slip.how == "step_turned_back":
                return transposed(R) @ I @ R
            return R @ I if slip.how == "step_from_left" else I @ transposed(R)
        return R @ I @ transposed(R)

    def transpose(self, site: str, A: np.ndarray) -> np.ndarray:
        """A^T."""
        return A if self._here(site, lambda: [("", "step_untransposed")]) else transposed(A)

    def pick(self, site: str, right: T, **wrong: T | Callable[[], T]) -> T:
        """The right quantity; `wrong` are others that may stand in its place, by name, or functions that make them.

        The words read on from the site: `pick("the lever arm", r, **{"that of the parent": s})`.
        """
        for slip in self._here(site, lambda: [(name, "step_other") for name in wrong]):
            other = wrong[slip.what]
            return other() if callable(other) else other
        return right

    def each(self, site: str, items: Sequence[T]) -> Sequence[T]:
        """All items; slips leave out the first or the last."""
        for slip in self._here(site, lambda: [("", "step_first"), ("", "step_last")]):
            items = items[1:] if slip.how == "step_first" else items[:-1]
        return items

    def _here(self, site: str, possible: Callable[[], Sequence[tuple[str, str]]]) -> Sequence[Slip]:
        """The slips to be made at this step; where none is made at all, what is possible is noted once."""
        if self._right and site not in self._seen:
            self._seen.add(site)
            self.found |= {Slip(site, what, kind): None for what, kind in possible()}
        return self._at.get(site, ())


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of the last axis; quicker than NumPy's for short arrays."""
    return a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT]


_NEXT, _LAST = [1, 2, 0], [2, 0, 1]


def rows() -> Mapping[str, str]:
    """The lines of all kinds in the table of keys."""
    return {key: kind.row for key, kind in KINDS.items()}
