"""<origin> read otherwise: of joints, of <inertial>, or of both where one function reads them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from itertools import permutations, product
from typing import NamedTuple

import numpy as np

from ....spatial.adjoint import cross_matrix
from ..case import Case
from ..description import Body, Description, Part, fixed_axes, homogeneous, turn
from ..hypothesis import Hypothesis
from .register import ALL, INERTIAL, MASSIVE, READINGS, changes, proposer


class Origin(NamedTuple):
    """xyz, rpy, and the rotation that rpy gives."""

    xyz: np.ndarray
    rpy: np.ndarray
    R: np.ndarray


Edit = Callable[[Description, Sequence[str]], Description]
Placed = tuple[np.ndarray, np.ndarray]
"""Position and rotation."""


class Reading(NamedTuple):
    """One way to misread an <origin>."""

    key: str
    says: str
    values: str
    read: Callable[[Origin], Placed]
    fix: str
    known: str = ""
    """Whether joints (j) and <inertial> (i) have rules of their own for it."""
    rare: bool = False
    cost: float = 1.05


ANGLE = ("roll", "pitch", "yaw")
ANGLES = "read rpy as Rz(yaw) Ry(pitch) Rx(roll), in radians"
LENGTH = "read xyz as metres, in the order x y z"
POSE = "place by xyz, in the axes of the parent, then turn by rpy"


def _turns(made: Callable[[np.ndarray], np.ndarray]) -> Callable[[Origin], Placed]:
    """Of another rotation, where there is one."""
    return lambda o: (o.xyz, made(o.rpy) if o.rpy.any() else o.R)


def _lies(made: Callable[[np.ndarray], np.ndarray]) -> Callable[[Origin], Placed]:
    return lambda o: (made(o.xyz), o.R)


def _product(order: Iterable[int], rpy: np.ndarray) -> np.ndarray:
    R = np.eye(3)
    for axis in order:
        R = R @ turn(axis, rpy[axis])
    return R


def _vector(rpy: np.ndarray) -> np.ndarray:
    """Rodrigues' formula."""
    angle = float(np.linalg.norm(rpy))
    K = cross_matrix(rpy / (angle or 1.0))
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)


def _euler(axes: Sequence[int], rpy: np.ndarray) -> np.ndarray:
    a, b, c = (turn(axis, angle) for axis, angle in zip(axes, rpy, strict=True))
    return np.asarray(a @ b @ c)


def _instead(to: int, of: int, rpy: np.ndarray) -> np.ndarray:
    angles = rpy.copy()
    angles[to] = rpy[of]
    return fixed_axes(angles)


def _orders() -> Iterable[Reading]:
    """Products of the three turns, and other angles."""
    found: dict[str, Callable[[np.ndarray], np.ndarray]] = {}
    for order in permutations(range(3)):
        if order not in ((2, 1, 0), (0, 1, 2)):
            found[" ".join(f"R{'xyz'[k]}" for k in order)] = partial(_product, order)
    found["yaw pitch roll in the place of roll pitch yaw"] = lambda rpy: fixed_axes(rpy[::-1])
    found["as a rotation vector"] = _vector
    found["pitch and yaw exchanged"] = lambda rpy: fixed_axes(rpy[[0, 2, 1]])
    found["roll and pitch exchanged"] = lambda rpy: fixed_axes(rpy[[1, 0, 2]])
    found["Rz Ry Rz, as Euler's angles"] = partial(_euler, (2, 1, 2))
    says = "is multiplied in another order, or taken for other angles"
    rare: dict[str, Callable[[np.ndarray], np.ndarray]] = {
        "Rz Rx Rz, as Euler's angles": partial(_euler, (2, 0, 2)),
        "pitch yaw roll in the place of roll pitch yaw": lambda rpy: fixed_axes(rpy[[1, 2, 0]]),
        "yaw roll pitch in the place of roll pitch yaw": lambda rpy: fixed_axes(rpy[[2, 0, 1]]),
    }
    copied = [(a, b, c) for a, b, c in product(range(3), repeat=3) if sum((a == 2, b == 1, c == 0)) == 2]
    rare |= {" ".join(f"R{'xyz'[k]}({ANGLE[k]})" for k in order): partial(_product, order) for order in copied}
    rare |= {
        f"{ANGLE[of]} in the place of {ANGLE[to]}": partial(_instead, to, of) for to, of in permutations(range(3), 2)
    }  # fmt: skip
    for values, made in (found | rare).items():
        yield Reading("rpy_order", says, values, _turns(made), ANGLES, rare=values in rare)


def _parts() -> Iterable[Reading]:
    """Angles that are left out, of the other sign, or of another size."""
    for k, name in enumerate(ANGLE):
        e = np.eye(3)[k]
        for values, factors in ((f"without {name}", 1 - e), (f"{name} alone", e), (f"-{name}", 1 - 2 * e)):
            yield _scaled("has an angle left out, or of the other sign", values, factors)
        two = " ".join(f"-{other}" for other in ANGLE if other != name)
        yield _scaled("has an angle left out, or of the other sign", two, 2 * e - 1)
    yield _scaled("has an angle left out, or of the other sign", "-roll -pitch -yaw", -np.ones(3))
    says = "has an angle left out, or of the other sign"
    yield Reading("rpy_part", says, "their absolute values", _turns(lambda x: fixed_axes(abs(x))), ANGLES, rare=True)
    for values, factor in (("half the angles", 0.5), ("twice the angles", 2.0), ("180 / pi times", 180 / np.pi)):
        yield _scaled("is taken for other angles", values, factor * np.ones(3), rare=True)


def _scaled(says: str, values: str, factors: np.ndarray, rare: bool = False) -> Reading:
    made = _turns(lambda rpy: fixed_axes(factors * rpy))
    return Reading("rpy_part", says, values, made, ANGLES, rare=rare, cost=1.15)


UNITS = {"1000": 1e3, "1/1000": 1e-3, "100": 1e2, "1/100": 1e-2, "0.0254, inches": 0.0254, "0.3048, feet": 0.3048}
SWAPPED = {("x", "y"): (1, 0, 2), ("y", "z"): (0, 2, 1), ("x", "z"): (2, 1, 0)}
PLACES = {f"{a} and {b} swapped": np.eye(3)[list(p)] for (a, b), p in SWAPPED.items()}
PLACES |= {f"-{'xyz'[k]}": np.eye(3) - 2 * np.diag(np.eye(3)[k]) for k in range(3)}
PLACES |= {f"{'xyz'[k]} ignored": np.eye(3) - np.diag(np.eye(3)[k]) for k in range(3)}
CYCLED = {"y z x as x y z": np.eye(3)[[1, 2, 0]], "z x y as x y z": np.eye(3)[[2, 0, 1]]}
"""What may happen to three components."""


def _positions() -> Iterable[Reading]:
    for values, k in UNITS.items():
        says = "is multiplied by a number (other units)"
        yield Reading("xyz_units", says, values, _lies(lambda x, k=k: k * x), LENGTH)  # type: ignore[misc]
    says = "has components that are swapped, left out, or of the other sign"
    for values, P in {**PLACES, **CYCLED}.items():
        made = _lies(lambda x, P=P: P @ x)  # type: ignore[misc]
        yield Reading("xyz_order", says, values, made, LENGTH, rare=values in CYCLED, cost=1.15)
    yield Reading("xyz_order", says, "their absolute values", _lies(np.abs), LENGTH, rare=True, cost=1.15)


def _inverse(o: Origin) -> Placed:
    return -o.R.T @ o.xyz, o.R.T


def _exchanged(o: Origin) -> Placed:
    return o.rpy, fixed_axes(o.xyz)


def _twice(o: Origin) -> Placed:
    return o.xyz + o.R @ o.xyz, o.R @ o.R


WHOLE = (
    Reading("rpy_ignored", "is ignored", "", lambda o: (o.xyz, np.eye(3)), ANGLES, "ji"),
    Reading("rpy_transposed", "gives the transposed rotation", "", lambda o: (o.xyz, o.R.T), ANGLES, "ji"),
    Reading(
        "rpy_order", "is multiplied in the other order", "", _turns(partial(_product, (0, 1, 2))), ANGLES, known="ji"
    ),
    Reading("rpy_degrees", "is read as degrees", "", _turns(lambda x: fixed_axes(np.radians(x))), ANGLES),
    Reading("xyz_ignored", "is ignored", "", _lies(np.zeros_like), LENGTH, "ji"),
    Reading("xyz_sign", "has the other sign", "", _lies(np.negative), LENGTH, "ji"),
    Reading("xyz_after_rpy", "is turned by rpy", "", lambda o: (o.R @ o.xyz, o.R), POSE, "ji"),
    Reading("xyz_after_rpy", "is turned by rpy, the other way round", "", lambda o: (o.R.T @ o.xyz, o.R), POSE, "i"),
)
"""Mistakes of xyz or of rpy as a whole."""
POSES = (
    Reading("origin_ignored", "is ignored", "", lambda o: (0 * o.xyz, np.eye(3)), POSE, "ji"),
    Reading("origin_inverted", "is inverted", "", _inverse, POSE, "j"),
    Reading("origin_exchanged", "has xyz and rpy in each other's place", "", _exchanged, POSE),
    Reading("origin_twice", "is multiplied in twice", "", _twice, POSE, "j", rare=True),
)
"""And of both."""


def _edit(reading: Reading, joints: bool, bodies: bool) -> Edit:
    def part(p: Part, _: Description) -> Part:
        x, R = reading.read(Origin(p.position, p.rpy, p.rotation))
        return p.placed(homogeneous(R, x))

    def body(b: Body) -> Body:
        x, R = reading.read(Origin(b.com, b.rpy, b.rotation))
        return replace(b, com=x, rotation=R)

    def edit(d: Description, items: Sequence[str]) -> Description:
        d = d.with_parts(part) if joints else d
        return d.with_bodies(body) if bodies else d

    return edit


WHOSE = (("joints", True, False, 0.0), ("<inertial>", False, True, 0.0), ("joints and of <inertial>", True, True, 0.02))


def _register(what: str, readings: Sequence[Reading], whose: str, joints: bool, bodies: bool, more: float) -> None:
    """One rule for each key, and one for those of its readings that are rare."""
    mine = "j" if not bodies else "i" if not joints else "both"
    kinds: dict[tuple[str, str, bool], list[Reading]] = {}
    for r in readings:
        if mine not in r.known:
            kinds.setdefault((r.key, r.says, r.rare), []).append(r)
    for (key, says, rare), some in kinds.items():
        own = key if joints else f"inertial_{key}"
        terms = ALL if joints else MASSIVE if what == "rpy" else INERTIAL

        alone = [(joints, False), (False, bodies)] if mine == "both" else [(joints, bodies)]
        edits = [(r, [_edit(r, *one) for one in alone]) for r in some]
        proposer(own, f"{what} of {whose} {says}", some[0].fix, late=READINGS * rare)(
            partial(_proposed, edits, terms, more)
        )


def _proposed(
    edits: Sequence[tuple[Reading, Sequence[Edit]]], terms: tuple[str, ...], more: float, h: Hypothesis, case: Case
) -> list[Hypothesis]:
    """Of both, only where it changes both: else it is that of one."""
    d = case.description
    return [
        replace(h, place="edit", act=partial(_together, each), terms=terms, values=r.values, cost=r.cost + more)
        for r, each in edits if all(changes(d, edit(d, ())) for edit in each)
    ]  # fmt: skip


def _together(edits: Sequence[Edit], d: Description, items: Sequence[str]) -> Description:
    for edit in edits:
        d = edit(d, items)
    return d


ANGULAR = tuple(r for r in WHOLE if r.key.startswith("rpy"))
LINEAR = tuple(r for r in WHOLE if r not in ANGULAR)
for _whose in WHOSE:
    _register("rpy", (*ANGULAR, *_orders(), *_parts()), *_whose)
    _register("xyz", (*LINEAR, *_positions()), *_whose)
    _register("the origin", POSES, *_whose)
