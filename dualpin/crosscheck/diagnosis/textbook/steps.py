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
from .arrays import cross

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
STANDING = "the frame in which a body stands: in turning its tensor"
HANDING = "the links that hand on what they carry"
"""A loop from the tips to the base."""
Words = Mapping[tuple[str, str], Sequence[tuple[str, str]]]
_Of = Callable[[Any], Any]
"""Some rows of an array."""
_Rows = tuple[Any, _Of]
_Kinds = Sequence[tuple[str, str]]
"""What a slip is with, and how."""
_Alike = dict[tuple["Slip", ...], list[int]]
"""Slips that are made together, and the rows in which they are."""


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
        self._seen: set[tuple[str, str, tuple[str, ...]]] = set()
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
                site, what = told.get((_groups(slip.site)[0], slip.what), (slip.site, slip.what))
                self._found[Slip(site, what, slip.how)] = None
            return x

        def of(slip: Slip) -> Sequence[Slip]:
            found = words.get((slip.site, slip.what), [(slip.site, slip.what)])
            return [Slip(site, what, slip.how) for site, what in found]

        return algorithm(Steps.together([[x for slip in row for x in of(slip)] for row in self._rows]))

    def _take(self, rows: Sequence[Sequence[Slip]]) -> None:
        self._rows = rows
        self._at: dict[str, list[tuple[int, Slip]]] = {}
        for k, slips in enumerate(rows):
            for slip in slips:
                self._at.setdefault(slip.site, []).append((k, slip))
        self._plans: dict[Any, Any] = {}
        self._of: _Of = _same

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
            first, *further = _groups(slip.site)
            if not further:
                out[slip] = None
                continue
            out[Slip(first, slip.what, slip.how)] = None
            for whole, group in pairwise((first, *further)):
                if members[group] != members[whole]:
                    out[Slip(group, slip.what, slip.how)] = None
        out |= {Slip(EVERYWHERE, *which): None for which, where in standing.items() if len(where) > 1}
        return out

    @property
    def finding(self) -> bool:
        """Whether it makes no slip, and lists them."""
        return self._right

    @property
    def rows(self) -> int:
        return len(self._rows)

    # the steps

    def add(self, site: str, **terms: Any) -> Any:
        """The sum of the terms, which are named as in the book: `add("the force", **{"m a": ma, "m g": mg})`."""
        first, *more = terms.values()
        right = sum(more, first)

        def possible() -> _Kinds:
            return [(name, how) for name in terms for how in _WEIGHTS]

        def weighted(alike: _Alike) -> tuple[_Rows, list[Any]]:
            """The rows of all slips at once, and the weight of each term there."""
            each = [({slip.what: _WEIGHTS[slip.how] for slip in slips}, ks) for slips, ks in alike.items()]
            weights = [np.array([w.get(name, 1.0) for w, ks in each for _ in ks]) for name in terms]
            return self._chosen([k for _, ks in each for k in ks]), weights

        made = self._planned(site, "sum", tuple(terms), possible, weighted, (EVERYWHERE,))
        if made is None:
            return right
        (at, of), weights = made
        axes = [1] * (np.ndim(right) - 1)
        each = zip(weights, terms.values(), strict=True)
        parts = [(w.reshape(-1, *axes) if self.rows > 1 else w[0]) * of(x) for w, x in each]
        return self._placed(right, [(at, sum(parts))])

    def cross(self, site: str, a: Any, b: Any) -> Any:
        """a x b, alone in its place; a product that is a term of a sum needs none, since its sign is turned there."""
        x = cross(a, b)
        return self._done(x, site, "", (), lambda: [("", "step_swapped")], lambda slips, of: -of(x))

    def turn(self, site: str, R: Any, x: Any, **others: Callable[[], Any]) -> Any:
        """R x, of vectors or six-vectors; `others` are other matrices, by what they do ("by the inverse")."""

        def possible() -> _Kinds:
            return [*(("", how) for how in _TURNS), *((name, "step_other_turn") for name in others)]

        def wrong(slips: Sequence[Slip], of: _Of) -> Any:
            slip = slips[0]
            if slip.how == "step_unturned":
                return of(x)
            return product(of(others[slip.what]()) if slip.how == "step_other_turn" else transposed(of(R)), of(x))

        return self._done(product(R, x), site, "", tuple(others), possible, wrong)

    def congruent(self, site: str, R: Any, I: Any) -> Any:
        """R I R^T."""

        def possible() -> _Kinds:
            return [
                ("", "step_unturned"),
                *(("", x) if x.startswith("step_") else (x, "step_other") for x in _PRODUCTS),
            ]

        def wrong(slips: Sequence[Slip], of: _Of) -> Any:
            A, J, slip = of(R), of(I), slips[0]
            if slip.how == "step_unturned":
                return J + np.zeros_like(A)
            return _PRODUCTS[slip.what or slip.how](A, J, transposed(A))

        return self._done(R @ I @ transposed(R), site, "", ("R I R^T",), possible, wrong)

    def transpose(self, site: str, A: Any) -> Any:
        """A^T."""
        return self._done(
            transposed(A), site, "", ("A^T",), lambda: [("", "step_untransposed")], lambda slips, of: of(A)
        )

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

    def _replaced(self, site: str, how: str, right: Any, others: Mapping[str, Any]) -> Any:
        def wrong(slips: Sequence[Slip], of: _Of) -> Any:
            x = others[slips[0].what]
            return of(x() if callable(x) else x)

        return self._done(right, site, how, tuple(others), lambda: [(name, how) for name in others], wrong)

    def components(self, site: str, x: np.ndarray) -> Any:
        """A vector (..., 3) whose components may have another sign, be left out, or change places."""
        return self.tabled(site, x, _COMPONENTS, lambda C: (self.few(x)[..., None, :] @ C)[..., 0, :])

    def tabled(
        self, site: str, right: Any, matrices: Mapping[str, np.ndarray], wrong: _Of, own: int = 1, within: str = ""
    ) -> Any:  # fmt: skip
        """As `pick`, of what one function makes of constant matrices, for all slips at once.

        `own` says how many of the last axes of the right quantity are its own; slips of groups larger than `within` are
        not made here.
        """

        def chosen(alike: _Alike) -> tuple[_Rows, np.ndarray]:
            stacked = np.stack([matrices[slips[0].what] for slips, ks in alike.items() for _ in ks])
            return self._chosen([k for ks in alike.values() for k in ks]), stacked

        made = self._planned(site, "table", (), lambda: [(name, "step_other") for name in matrices], chosen, (), within)
        if made is None:
            return right
        ((at, of), C), outer = made, self._of
        axes, self._of = [1] * (np.ndim(right) - own - 1), of
        x = wrong(C.reshape(-1, *axes, *C.shape[1:]) if self.rows > 1 else C[0])
        self._of = outer
        return self._placed(right, [(at, x)])

    def each(self, site: str, items: Sequence[T]) -> Sequence[T]:
        """All items; slips leave out the first or the last.  Of many runs in one, use `part`."""
        ends = [("", "step_first"), ("", "step_last")]
        for slip in self._done((), site, "", ("each",), lambda: ends, lambda slips, of: slips):
            items = items[1:] if slip.how == "step_first" else items[:-1]
        return items

    def part(self, site: str, x: Any, k: int, count: int, alone: bool = False) -> Any:
        """x, number k of so many that are summed; slips leave out the first or the last, or all others (`alone`)."""
        left_out = {"step_first": k == 0, "step_last": k == count - 1}
        if alone and count > 1:
            left_out |= {"step_last_alone": k != count - 1, "step_first_alone": k != 0}
        here = tuple(how for how, out in left_out.items() if out or self._right)
        return self._done(x, site, "", here, lambda: [("", how) for how in here], lambda slips, of: 0 * of(x))

    def few(self, x: Any) -> Any:
        """In a function that makes what stands in the place of the right quantity: the rows of x where it does."""
        return self._of(x)

    # what they share

    def _planned(
        self, site: str, of: str, names: tuple[str, ...], possible: Callable[[], _Kinds],
        plan: Callable[[_Alike], Any], groups: Sequence[str] = (), within: str = "",
    ) -> Any:  # fmt: skip
        """The plan of the slips to be made at this step, which is made once; None where there are none.

        Where none is made at all, what is `possible` is noted, once for the same `names`: later links may allow more.
        `of` tells several steps at one site apart.
        """
        key = site, of, names
        if self._right:
            if key not in self._seen:
                self._seen.add(key)
                self._found |= {Slip(site, what, how): None for what, how in possible()}
            return None
        if key not in self._plans:
            some = [group for group in _groups(site) if group.startswith(within)]
            here = [mine for group in (*some, *groups) for mine in self._at.get(group, ())]
            kinds, rows = set(possible() if here else ()), dict[int, list[Slip]]()
            for k, slip in here:
                if (slip.what, slip.how) in kinds:
                    rows.setdefault(k, []).append(slip)
            alike: _Alike = {}
            for k, slips in rows.items():
                alike.setdefault(tuple(slips), []).append(k)
            self._plans[key] = plan(alike) if alike else None
        return self._plans[key]

    def _done(
        self, right: Any, site: str, of: str, names: tuple[str, ...], possible: Callable[[], _Kinds],
        wrong: Callable[[Sequence[Slip], _Of], Any],
    ) -> Any:  # fmt: skip
        """The right result, with a wrong one in the rows that make a slip here; `names` tell what is possible."""
        made = self._planned(site, of, names, possible, self._each)
        if made is None:
            return right
        parts, outer = [], self._of
        for slips, (at, self._of) in made:
            parts.append((at, wrong(slips, self._of)))
        self._of = outer
        return self._placed(right, parts)

    def _each(self, alike: _Alike) -> list[tuple[tuple[Slip, ...], _Rows]]:
        return [(slips, self._chosen(ks)) for slips, ks in alike.items()]

    def _chosen(self, ks: list[int]) -> _Rows:
        """Rows, and those of any array whose first axis is that of the runs, or has length 1."""
        count = self.rows
        if count == 1:
            return slice(None), _same
        at = slice(ks[0], ks[0] + 1) if len(ks) == 1 else np.array(ks)
        return at, lambda x: x[at] if getattr(x, "ndim", 0) and len(x) == count else x

    def _placed(self, right: Any, parts: Sequence[tuple[Any, Any]]) -> Any:
        """The right result but in these rows."""
        if self.rows == 1:
            return parts[0][1]
        shape, dtype = np.shape(right)[1:], getattr(right, "dtype", None)
        if any(np.shape(x)[1:] != shape or x.dtype != dtype for _, x in parts):
            shape = np.broadcast_shapes(shape, *(np.shape(x)[1:] for _, x in parts))
            dtype = np.result_type(right, *(x for _, x in parts))
        out = np.empty((self.rows, *shape), dtype)
        out[:] = right
        for at, x in parts:
            out[at] = x
        return out


@cache
def _groups(site: str) -> list[str]:
    """The groups of which a step is one, the largest first, and the step itself."""
    return list(accumulate(site.split(": "), lambda group, one: f"{group}: {one}"))


def _same(x: Any) -> Any:
    return x


class UncoveredError(ValueError):
    """An algorithm does not cover a robot, whatever its slips are."""
