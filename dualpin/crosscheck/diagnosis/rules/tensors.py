"""Numbers of <mass> and <inertia> taken in other units, in each other's place, or left out."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import permutations

import numpy as np

from ..case import Case
from ..description import ENTRIES, Body, Description
from ..hypothesis import Hypothesis
from .register import INERTIAL, MASSIVE, READINGS, changes, proposer

Six = np.ndarray
"""ixx, ixy, ixz, iyy, iyz, izz."""
Read = Callable[[float, Six], tuple[float, Six]]
"""What becomes of a link's mass and six numbers."""
PLACES = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
MOMENTS, PRODUCTS = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")
AT = {name: k for k, name in enumerate(ENTRIES)}
BY_NAME = "read ixx, ixy, ixz, iyy, iyz and izz each by its own name"


def _numbers(b: Body) -> Six:
    return np.array([b.inertia[at] for at in PLACES])


def _body(read: Read, b: Body) -> Body:
    mass, six = read(b.mass, _numbers(b))
    I = np.zeros((3, 3))
    for (i, j), x in zip(PLACES, six, strict=True):
        I[i, j] = I[j, i] = x
    return replace(b, mass=mass, inertia=I)


def _linear(A: np.ndarray) -> Read:
    return lambda m, six: (m, A @ six)


def _from(**of: str) -> Read:
    """These entries are filled with others."""
    A = np.eye(6)
    for to, name in of.items():
        A[AT[to]] = np.eye(6)[AT[name]]
    return _linear(A)


def _times(factors: Mapping[str, float]) -> Read:
    return _linear(np.diag([factors.get(name, 1.0) for name in ENTRIES]))


def _both(mass: float, inertia: float) -> Read:
    return lambda m, six: (mass * m, inertia * six)


def _in_order(order: str) -> Read:
    """The file's xx xy xz yy yz zz, taken for `order`."""
    return _from(**{f"i{to}": name for to, name in zip(order.split(), ENTRIES, strict=True)})


def _swaps() -> dict[str, Read]:
    return {f"{a} and {b}": _from(**{a: b, b: a}) for a, b in (("ixz", "iyz"), ("ixy", "iyz"), ("ixy", "ixz"))}


def _moments() -> dict[str, Read]:
    """But for ixx and izz, which have a rule of their own, also for single links."""
    orders = [p for p in permutations(MOMENTS) if p not in (MOMENTS, MOMENTS[::-1])]
    return {" ".join(p): _from(**dict(zip(MOMENTS, p, strict=True))) for p in orders}


def _copies(alike: bool) -> dict[str, Read]:
    """Of moments for moments and products for products, or of one for the other."""
    pairs = [(a, b) for a, b in permutations(ENTRIES, 2) if ((a in MOMENTS) == (b in MOMENTS)) == alike]
    return {f"{of} stands for {to}": _from(**{to: of}) for to, of in pairs}


ORDERS = ("xx xy yy xz yz zz", "xx yy zz xy xz yz", "xx yy zz yz xz xy", "xx yy zz xy yz xz")
UNITS = {
    "1000": 1e3, "1/1000": 1e-3, "1e6": 1e6, "1e-6": 1e-6, "1e9": 1e9, "1e-9": 1e-9, "2": 2.0, "1/2": 0.5, "1e-4": 1e-4,
    "1e4": 1e4,
}  # fmt: skip
MASSES = {"1000": 1e3, "1/1000": 1e-3, "0.45359237, pounds": 0.45359237, "1/0.45359237, to pounds": 1 / 0.45359237}
WEIGHTS = {"2": 2.0, "1/2": 0.5, "9.81, weights": 9.81, "1/9.81": 1 / 9.81}


def _replaced(mass: float, six: Sequence[float]) -> Read:
    return lambda m, _: (mass or m, np.array(six))


def _by_mass(power: int) -> Read:
    return lambda m, six: (m, six * (m or 1.0) ** power)


def _table(key: str, says: str, fix: str, reads: Mapping[str, Read], terms: tuple[str, ...] = MASSIVE,
           cost: float = 1.05, late: int = 0) -> None:  # fmt: skip
    """One rule, of all links."""

    def propose(h: Hypothesis, case: Case) -> list[Hypothesis]:
        def edit(read: Read) -> Callable[[Description, Sequence[str]], Description]:
            return lambda d, items: d.with_bodies(partial(_body, read))

        d, found = case.description, {words: edit(read) for words, read in reads.items()}
        return [
            replace(h, place="edit", act=act, terms=terms, values=words, cost=cost)
            for words, act in found.items() if changes(d, act(d, ()))
        ]  # fmt: skip

    proposer(key, says, fix, late=late)(propose)


_table("products_swapped", "products of inertia are swapped", BY_NAME, _swaps(), cost=1.0)
_table("products_swapped", "products of inertia are read in another order", BY_NAME, {
    "ixz iyz ixy": _from(ixy="ixz", ixz="iyz", iyz="ixy"), "iyz ixy ixz": _from(ixy="iyz", ixz="ixy", iyz="ixz"),
}, late=READINGS)  # fmt: skip
_table("inertia_order", "the six numbers of <inertia> are read in another order", BY_NAME,
       {order: _in_order(order) for order in ORDERS}, cost=1.0)  # fmt: skip
_table("moments_swapped", "moments of inertia are in each other's place", BY_NAME, _moments())
_table(
    "inertia_entry_copied", "an entry of every <inertia> is filled with another one", BY_NAME, _copies(True), cost=1.1
)
_table("inertia_entry_copied", "an entry of every <inertia> is filled with one of another kind", BY_NAME, _copies(
    alike=False) | {"ixx stands for iyy and izz": _from(iyy="ixx", izz="ixx")}, cost=1.1, late=READINGS)  # fmt: skip
_table("inertia_entry", "an entry of every <inertia> is left out, or has the other sign", BY_NAME, {
    **{f"without {name}": _times({name: 0.0}) for name in ENTRIES},
    **{f"-{name}": _times({name: -1.0}) for name in PRODUCTS},
    **{f"without {a} and {b}": _times({a: 0.0, b: 0.0}) for a, b in itertools.combinations(PRODUCTS, 2)},
}, cost=1.1)  # fmt: skip
_table("products_scale", "products of inertia are multiplied by a number", "ixy, ixz, iyz are the matrix's entries",
       {words: _times(dict.fromkeys(PRODUCTS, k)) for words, k in (("1/2", 0.5), ("2", 2.0))})  # fmt: skip
_table("inertia_units", "all tensors of inertia are multiplied by a number (other units)", "give <inertia> in kg m^2",
       {words: _both(1.0, k) for words, k in UNITS.items()})  # fmt: skip
_table("mass_units", "masses are multiplied by a number (other units)", "give <mass> in kg",
       {words: _both(k, 1.0) for words, k in MASSES.items()}, INERTIAL)  # fmt: skip
_table("mass_units", "masses are multiplied by a number", "give <mass> in kg",
       {words: _both(k, 1.0) for words, k in WEIGHTS.items()}, INERTIAL, 1.1, late=READINGS)  # fmt: skip
_table("density", "masses and tensors of inertia are multiplied by a number", "give <mass> in kg, <inertia> in kg m^2",
       {words: _both(k, k) for words, k in (MASSES | WEIGHTS).items()}, INERTIAL, 1.1, late=READINGS)  # fmt: skip
_table("inertial_replaced", "masses, or tensors of inertia, are not those of the file", "use the numbers of the file", {
    "masses of 1": lambda m, six: (1.0 if m else m, six), "tensors of 1": _replaced(0.0, (1, 0, 0, 1, 0, 1)),
    "tensors multiplied by the mass": _by_mass(1), "tensors divided by the mass": _by_mass(-1),
}, INERTIAL, 1.15, late=READINGS)  # fmt: skip
