"""The steps of a textbook algorithm, and everything that can go wrong at one of them.

An algorithm written with `Steps` reads as in the book.  Run without a slip it is right, and it lists every
single slip that each of its steps allows; run with some of those, it makes them:

    steps = Steps()
    alpha = steps.add("the angular acceleration", **{"z qdd": z * qdd, "w x z qd": cross(w, z * qd)})
    steps.found      # "w x z qd is left out of the angular acceleration", ...

Many slips are tried in one run, `Steps.together`: then the first axis of every array is that of the slips (length 1
where they make no difference), constants of the robot included.

Words: a site is what the step makes, as a noun with its article ("the moment about the centre of mass").
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import accumulate, pairwise
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ...subjects.layout import product, transposed
from . import words

T = TypeVar("T")


class Slip(NamedTuple):
    """One thing that went wrong: at which step, with what, and how (a key of `words.KINDS`)."""

    site: str
    what: str
    how: str

    @property
    def says(self) -> str:
        return words.says(*self)

    @property
    def fix(self) -> str:
        return words.fix(*self)


_WEIGHTS = {"step_left_out": 0.0, "step_sign": -1.0, "step_half": 0.5, "step_twice": 2.0}
_TURNS = ("step_unturned", "step_turned_back")
_PRODUCTS: dict[str, Callable[[Any, Any, Any], Any]] = {
    "step_turned_back": lambda R, I, T: T @ I @ R,
    "step_from_left": lambda R, I, T: R @ I,
    "step_from_right": lambda R, I, T: I @ T,
    "R I R, the second matrix not transposed": lambda R, I, T: R @ I @ R,
    "R^T I R^T, the first matrix transposed too": lambda R, I, T: T @ I @ T,
    "R^T I, without the matrix on the right": lambda R, I, T: T @ I,
    "I R, with R alone on the right": lambda R, I, T: I @ R,
    "R, I and R^T multiplied entry by entry": lambda R, I, T: R * I * T,
    "R I R^T with R and I multiplied entry by entry": lambda R, I, T: (R * I) @ T,
    "R I R^T with R I and R^T multiplied entry by entry": lambda R, I, T: (R @ I) * T,
}
"""What may stand in the place of R I R^T."""
_ONE = np.eye(3)
_COMPONENTS: dict[str, np.ndarray] = {
    **{f"that with {c} of the other sign": np.diag(1 - 2 * e) for c, e in zip("xyz", _ONE, strict=True)},
    **{f"that without {c}": np.diag(1 - e) for c, e in zip("xyz", _ONE, strict=True)},
    "that with x and y exchanged": _ONE[[1, 0, 2]], "that with x and z exchanged": _ONE[[2, 1, 0]],
    "that with y and z exchanged": _ONE[[0, 2, 1]], "that with y, z, x in the places of x, y, z": _ONE[[2, 0, 1]],
    "that with z, x, y in the places of x, y, z": _ONE[[1, 2, 0]],
}  # fmt: skip
"""What may become of a vector."""
EVERYWHERE = "every equation where it belongs"
"""The site of a slip that is made wherever a term of that name is added."""
HAVE = "the sum so far (its own and of earlier children)"
"""What a child's share is added to."""
Words = Mapping[tuple[str, str], Sequence[tuple[str, str]]]
_Row = Callable[[Any], Any]
_Mine = tuple[int, "Slip"]


class Steps:
    """Runs the steps of an algorithm, with the slips that it is given; without, it collects all that there can be.

    Parameters
    ----------
    *slips : Slip
        Of those that a run without a slip has `found`, made together.

    A site may name one of a group of steps, after a colon ("the arm: of turning links"): slips are made in
    each of them, and in all of the group.  Groups may have groups ("the arm: of turning links: to a frame").
    """

    def __init__(self, *slips: Slip) -> None:
        self._found: dict[Slip, None] = {}
        self._right = not slips
        self._seen: set[tuple[str, str]] = set()
        self._take([slips])

    @classmethod
    def together(cls, rows: Sequence[Sequence[Slip]]) -> Steps:
        """Many runs in one: every array of the algorithm then has a first axis, of these rows or of length 1."""
        steps = cls()
        steps._right = False
        steps._take(rows)
        return steps

    def through(self, words: Words, algorithm: Callable[[Steps], T]) -> T:
        """Run another algorithm, in which the same slips have other words: `words[site, what]` are those there."""
        if self._right:
            there, told = Steps(), {new: old for old, news in words.items() for new in news}
            x = algorithm(there)
            for slip in there._found:
                site, what = told.get((slip.site, slip.what), (slip.site, slip.what))
                self._found[Slip(site, what, slip.how)] = None
            return x

        def of(slip: Slip) -> Sequence[Slip]:
            found = words.get((slip.site, slip.what), [(slip.site, slip.what)])
            return [Slip(site, what, slip.how) for site, what in found]

        return algorithm(Steps.together([[x for slip in row for x in of(slip)] for row in self._rows]))

    def _take(self, rows: Sequence[Sequence[Slip]]) -> None:
        self._rows = rows
        self._at: dict[str, list[_Mine]] = {}
        for k, slips in enumerate(rows):
            for slip in slips:
                self._at.setdefault(slip.site, []).append((k, slip))

    @property
    def found(self) -> dict[Slip, None]:
        """Slips at one step; those of a group of steps, and those of one term wherever it stands."""
        members: dict[str, set[str]] = {}
        standing: dict[tuple[str, str], set[str]] = {}
        for slip in self._found:
            for group in _groups(slip.site):
                members.setdefault(group, set()).add(slip.site)
            if slip.how in _WEIGHTS:
                standing.setdefault((slip.what, slip.how), set()).add(_groups(slip.site)[0])
        out: dict[Slip, None] = {}
        for slip in self._found:
            groups = _groups(slip.site)
            out[slip._replace(site=groups[0])] = None
            for whole, group in pairwise(groups):
                if members[group] != members[whole]:
                    out[slip._replace(site=group)] = None
        out |= {Slip(EVERYWHERE, *which): None for which, where in standing.items() if len(where) > 1}
        return out

    @property
    def rows(self) -> int:
        return len(self._rows)

    # the steps

    def add(self, site: str, **terms: Any) -> Any:
        """The sum of the terms, which are named as in the book: `add("the force", **{"m a": ma, "m g": mg})`."""
        here = self._here(site, lambda: [(name, how) for name in terms for how in _WEIGHTS], "sum")
        mine = [m for m in here if m[1].how in _WEIGHTS and m[1].what in terms]
        mine = [*mine, *(m for m in self._at.get(EVERYWHERE, ()) if m[1].what in terms)]

        def wrong(slips: Sequence[Slip], of: _Row) -> Any:
            weights = {slip.what: _WEIGHTS[slip.how] for slip in slips}
            return sum(weights.get(name, 1.0) * of(x) for name, x in terms.items())

        first, *more = terms.values()
        return self._done(sum(more, first), mine, wrong)

    def cross(self, site: str, a: Any, b: Any) -> Any:
        """a x b, alone in its place; a product that is a term of a sum needs none, since its sign is turned there."""
        x = cross(a, b)
        return self._done(x, self._here(site, lambda: [("", "step_swapped")]), lambda slips, of: -of(x))

    def turn(self, site: str, R: Any, x: Any, **others: Callable[[], Any]) -> Any:
        """R x, of vectors or six-vectors; `others` are other matrices, by what they do ("by the inverse")."""
        possible = [("", how) for how in _TURNS]

        def wrong(slips: Sequence[Slip], of: _Row) -> Any:
            slip = slips[0]
            if slip.how == "step_unturned":
                return of(x)
            return product(of(others[slip.what]()) if slip.how == "step_other_turn" else transposed(of(R)), of(x))

        mine = self._here(site, lambda: possible + [(name, "step_other_turn") for name in others])
        mine = [m for m in mine if m[1].how in _TURNS or m[1].what in others]
        return self._done(product(R, x), mine, wrong)

    def congruent(self, site: str, R: Any, I: Any) -> Any:
        """R I R^T."""

        def wrong(slips: Sequence[Slip], of: _Row) -> Any:
            A, J, slip = of(R), of(I), slips[0]
            if slip.how == "step_unturned":
                return J + np.zeros_like(A)
            return _PRODUCTS[slip.what or slip.how](A, J, transposed(A))

        kinds = [("", "step_unturned"), *(("", x) if x.startswith("step_") else (x, "step_other") for x in _PRODUCTS)]
        mine = [m for m in self._here(site, lambda: kinds) if not m[1].what or m[1].what in _PRODUCTS]
        return self._done(R @ I @ transposed(R), mine, wrong)

    def transpose(self, site: str, A: Any) -> Any:
        """A^T."""
        mine = self._here(site, lambda: [("", "step_untransposed")])
        return self._done(transposed(A), mine, lambda slips, of: of(A))

    def pick(self, site: str, right: Any, **wrong: Any) -> Any:
        """The right quantity; `wrong` are others that may stand in its place, by name, or functions that make them.

        The words read on from the site: `pick("the lever arm", r, **{"that of the parent": s})`.
        """
        return self._replaced(site, "step_other", right, wrong)

    def mistaken(self, site: str, right: Any, **others: Any) -> Any:
        """As `pick`, for quantities of other kinds that are mistaken for it: `mistaken("alpha", alpha, w=w)`."""
        return self._replaced(site, "step_mistaken", right, others)

    def summed(self, site: str, right: Any, **alone: Any) -> Any:
        """What a child adds; `alone` is what is left of it where the children replace each other's."""
        return self._replaced(site, "step_overwritten", right, alone)

    def components(self, site: str, x: np.ndarray) -> Any:
        """A vector (..., 3) whose components may have another sign, be left out, or change places."""

        def wrong(slips: Sequence[Slip], of: _Row) -> Any:
            return of(x) @ _COMPONENTS[slips[0].what]

        mine = self._here(site, lambda: [(name, "step_other") for name in _COMPONENTS], "components")
        return self._done(x, [m for m in mine if m[1].what in _COMPONENTS], wrong)

    def _replaced(self, site: str, how: str, right: Any, wrong: Mapping[str, Any]) -> Any:
        def other(slips: Sequence[Slip], of: _Row) -> Any:
            what = slips[0].what
            if what not in made:
                x = wrong[what]
                made[what] = x() if callable(x) else x
            return of(made[what])

        made: dict[str, Any] = {}  # of all rows at once
        mine = self._here(site, lambda: [(name, how) for name in wrong], how)
        return self._done(right, [m for m in mine if m[1].how == how and m[1].what in wrong], other)

    def each(self, site: str, items: Sequence[T]) -> Sequence[T]:
        """All items; slips leave out the first or the last.  Of many runs in one, use `part`."""
        for _, slip in self._here(site, lambda: [("", "step_first"), ("", "step_last")]):
            items = items[1:] if slip.how == "step_first" else items[:-1]
        return items

    def part(self, site: str, x: Any, k: int, count: int, alone: bool = False) -> Any:
        """x, number k of so many that are summed; slips leave out the first or the last, or all others (`alone`)."""
        left_out = {"step_first": k == 0, "step_last": k == count - 1}
        if alone and count > 1:
            left_out |= {"step_last_alone": k != count - 1, "step_first_alone": k != 0}
        mine = self._here(site, lambda: [("", how) for how in left_out])
        return self._done(x, [m for m in mine if left_out.get(m[1].how)], lambda slips, of: 0 * of(x))

    # what they share

    def _here(self, site: str, possible: Callable[[], Sequence[tuple[str, str]]], of: str = "") -> Sequence[_Mine]:
        """The slips to be made at this step; where none is made at all, what is possible is noted once.

        `of` tells several steps at one site apart.
        """
        if self._right and (site, of) not in self._seen:
            self._seen.add((site, of))
            self._found |= {Slip(site, what, how): None for what, how in possible()}
        return [mine for group in _groups(site) for mine in self._at.get(group, ())]

    def _done(self, right: Any, mine: Sequence[_Mine], wrong: Callable[[Sequence[Slip], _Row], Any]) -> Any:
        """The right result, with a wrong one in the rows that make a slip here."""
        if not mine:
            return right
        if self.rows == 1:
            return wrong([slip for _, slip in mine], lambda x: x)
        rows: dict[int, list[Slip]] = {}
        for k, slip in mine:
            rows.setdefault(k, []).append(slip)
        alike: dict[tuple[Slip, ...], list[int]] = {}
        for k, slips in rows.items():
            alike.setdefault(tuple(slips), []).append(k)
        others = [(ks, wrong(slips, _rows(ks, self.rows))) for slips, ks in alike.items()]
        shape = np.broadcast_shapes(np.shape(right)[1:], *(np.shape(x)[1:] for _, x in others))
        out = np.empty((self.rows, *shape), np.result_type(right, *(x for _, x in others)))
        out[:] = right
        for ks, x in others:
            out[ks] = x
        return out


@cache
def _groups(site: str) -> list[str]:
    """The groups of which a step is one, the largest first, and the step itself."""
    return list(accumulate(site.split(": "), lambda group, one: f"{group}: {one}"))


def _rows(ks: list[int], count: int) -> _Row:
    """These rows of arrays whose first axis is that of the runs, or has length 1."""
    at = slice(ks[0], ks[0] + 1) if len(ks) == 1 else ks
    return lambda x: x if np.ndim(x) == 0 or len(x) != count else x[at]


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of the last axis; quicker than NumPy's for short arrays."""
    return a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT]


_NEXT, _LAST = [1, 2, 0], [2, 0, 1]
