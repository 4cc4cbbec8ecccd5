"""Mistakes in reading a joint's <origin>, <axis> and type."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ....model.robot import Mimic
from ..description import Description, Part, homogeneous, turn
from .register import joint_rule

ORIGIN = "place a joint by xyz, then turn it by Rz(yaw) Ry(pitch) Rx(roll)"
AXIS = "read <axis> in the joint's own frame (after rpy), with its sign; without one it is 1 0 0"


def _along(p: Part, axis: np.ndarray) -> Part:
    if not p.axial:
        return p
    return p if np.abs(axis - p.unit_axis).max() <= 1e-12 else replace(p, axis=axis)


def _turned(H: np.ndarray) -> np.ndarray:
    return homogeneous(H[:3, :3], np.zeros(3))


def _shifted(H: np.ndarray) -> np.ndarray:
    return homogeneous(np.eye(3), H[:3, 3])


@joint_rule("axis_sign", "the sign of joint axes is dropped", AXIS)
def axis_sign(p: Part, d: Description) -> Part:
    return _along(p, np.abs(p.unit_axis))


@joint_rule("axis_reversed", "joints move the other way", AXIS, cost=1.2)
def axis_reversed(p: Part, d: Description) -> Part:
    return _along(p, -p.unit_axis)


@joint_rule("axis_default_z", "a joint without <axis> is about z", AXIS)
def axis_default_z(p: Part, d: Description) -> Part:
    return _along(p, np.array([0.0, 0.0, 1.0])) if p.axis is None else p


@joint_rule("axis_default_y", "a joint without <axis> is about y", AXIS)
def axis_default_y(p: Part, d: Description) -> Part:
    return _along(p, np.array([0.0, 1.0, 0.0])) if p.axis is None else p


@joint_rule("axis_always_z", "every joint is about z", AXIS)
def axis_always_z(p: Part, d: Description) -> Part:
    return _along(p, np.array([0.0, 0.0, 1.0]))


@joint_rule("axis_always_x", "every joint is about x, <axis> is not read", AXIS)
def axis_always_x(p: Part, d: Description) -> Part:
    return _along(p, np.array([1.0, 0.0, 0.0]))


@joint_rule("axis_rounded", "of <axis> only the largest component counts", AXIS, cost=1.05)
def axis_largest(p: Part, d: Description) -> Part:
    """With its sign."""
    a = p.unit_axis
    return _along(p, np.sign(a) * (np.arange(3) == np.abs(a).argmax()))


@joint_rule("axis_rounded", "of <axis> only the largest component counts, without its sign", AXIS, cost=1.1)
def axis_largest_positive(p: Part, d: Description) -> Part:
    return _along(p, 1.0 * (np.arange(3) == np.abs(p.unit_axis).argmax()))


@joint_rule("axis_rounded", "components of the unit axis are rounded to whole numbers", AXIS, cost=1.1)
def axis_whole(p: Part, d: Description) -> Part:
    near = np.round(p.unit_axis)
    size = float(np.linalg.norm(near))
    return replace(_along(p, near / size), rate=size) if p.axial and size > 0 else p


@joint_rule("axis_rounded", "components of <axis> are read as whole numbers, what follows the point is cut off", AXIS,
            cost=1.1)  # fmt: skip
def axis_cut(p: Part, d: Description) -> Part:
    whole = np.zeros(3) if p.axis is None else np.trunc(p.axis)
    return _along(p, whole / np.linalg.norm(whole)) if whole.any() else p


@joint_rule("axis_in_parent", "axes are read in the parent's frame", AXIS)
def axis_in_parent(p: Part, d: Description) -> Part:
    return _along(p, p.rotation.T @ p.unit_axis)


@joint_rule("axis_turned", "axes are turned by the rpy of their joint once more", AXIS, cost=1.1)
def axis_turned(p: Part, d: Description) -> Part:
    return _along(p, p.rotation @ p.unit_axis)


@joint_rule("rpy_order", "rpy of joints is multiplied in the other order", ORIGIN)
def rpy_order(p: Part, d: Description) -> Part:
    return replace(p, rotation=turn(0, p.rpy[0]) @ turn(1, p.rpy[1]) @ turn(2, p.rpy[2]))


@joint_rule("rpy_ignored", "rpy of joints is ignored", ORIGIN)
def rpy_ignored(p: Part, d: Description) -> Part:
    return replace(p, rotation=np.eye(3))


@joint_rule("rpy_transposed", "rotations of joint origins are transposed", ORIGIN)
def rpy_transposed(p: Part, d: Description) -> Part:
    return replace(p, rotation=p.rotation.T)


@joint_rule("xyz_ignored", "xyz of joints is ignored", ORIGIN)
def xyz_ignored(p: Part, d: Description) -> Part:
    return replace(p, position=np.zeros(3))


@joint_rule("xyz_after_rpy", "xyz of joints is turned by their rpy", ORIGIN)
def xyz_after_rpy(p: Part, d: Description) -> Part:
    return replace(p, position=p.rotation @ p.position)


@joint_rule("xyz_sign", "xyz of joints has the other sign", ORIGIN, cost=1.1)
def xyz_sign(p: Part, d: Description) -> Part:
    return replace(p, position=-p.position)


@joint_rule("origin_ignored", "the origin of joints is ignored", ORIGIN)
def origin_ignored(p: Part, d: Description) -> Part:
    return p.placed(np.eye(4))


@joint_rule("origin_inverted", "the pose of joint origins is inverted", ORIGIN)
def origin_inverted(p: Part, d: Description) -> Part:
    return p.placed(np.linalg.inv(p.pose))


@joint_rule("origin_twice", "the pose of joint origins is multiplied in twice", ORIGIN, cost=1.1)
def origin_twice(p: Part, d: Description) -> Part:
    return p.placed(p.pose @ p.pose)


@joint_rule("motion_first", "the joint moves before its origin is applied", "a joint's pose is origin times motion")
def motion_first(p: Part, d: Description) -> Part:
    if not p.axial or np.abs(p.pose - np.eye(4)).max() < 1e-12:
        return p
    return replace(p.placed(np.eye(4)), after=p.pose @ p.after)


@joint_rule(
    "motion_first", "the joint moves before its rpy is applied", "a joint's pose is origin times motion", cost=1.05
)
def motion_before_rpy(p: Part, d: Description) -> Part:
    if not p.axial or np.abs(p.rotation - np.eye(3)).max() < 1e-12:
        return p
    return replace(p.placed(_shifted(p.pose)), after=_turned(p.pose) @ p.after)


COUPLED: dict[str, Callable[[Mimic], Mimic]] = {
    "the multiplier of <mimic> is ignored": lambda m: replace(m, multiplier=1.0),
    "the multiplier of <mimic> has the other sign": lambda m: replace(m, multiplier=-m.multiplier),
    "joints are divided by the multiplier of <mimic>": lambda m: replace(m, multiplier=1.0 / (m.multiplier or 1.0)),
    "the offset of <mimic> is ignored": lambda m: replace(m, offset=0.0),
    "the offset of <mimic> has the other sign": lambda m: replace(m, offset=-m.offset),
    "the offset of <mimic> is multiplied too": lambda m: replace(m, offset=m.multiplier * m.offset),
    "multiplier and offset of <mimic> are ignored": lambda m: replace(m, multiplier=1.0, offset=0.0),
}
"""Of joints that follow others, where they are to do so."""


def _coupled(says: str, change: Callable[[Mimic], Mimic]) -> None:
    @joint_rule(
        "mimic_part", says, "q of a joint that follows is multiplier times q of its leader, plus offset", cost=1.05
    )
    def coupled(p: Part, d: Description) -> Part:
        return p if p.mimic is None else replace(p, mimic=change(p.mimic))


for _words, _change in COUPLED.items():
    _coupled(_words, _change)


@joint_rule("prismatic_as_revolute", "prismatic joints turn", "a prismatic joint slides along its axis")
def prismatic_as_revolute(p: Part, d: Description) -> Part:
    return replace(p, type="revolute") if p.slides else p


def _between(p: Part, d: Description) -> np.ndarray:
    """The pose of a joint's parent on the link that carries it; of links that nothing moves too."""
    between, on = np.eye(4), d.part_of_link(p.parent)
    while on is not None and not on.moves:
        between, on = on.pose @ between, d.part_of_link(on.parent)
    return between


Pair = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Of the pose of a fixed link on what carries it, and that of a joint on that link: what is put for their product."""
ON_FIXED: dict[str, tuple[str, Pair, float]] = {
    "loses the fixed link's placement": ("fixed_parent", lambda H, P: P, 1.0),
    "loses the fixed link's rotation": ("fixed_parent", lambda H, P: _shifted(H) @ P, 1.05),
    "loses the fixed link's position": ("fixed_parent", lambda H, P: _turned(H) @ P, 1.05),
    "has the two poses multiplied in the other order": ("fixed_order", lambda H, P: P @ H, 1.05),
    "has its xyz not turned by the fixed link's rpy": (
        "fixed_order", lambda H, P: homogeneous(H[:3, :3] @ P[:3, :3], H[:3, 3] + P[:3, 3]), 1.05
    ),
    "has the two rotations multiplied in the other order": (
        "fixed_order", lambda H, P: homogeneous(P[:3, :3] @ H[:3, :3], (H @ P)[:3, 3]), 1.05
    ),
    "has the fixed link's rotation left out of its own": (
        "fixed_order", lambda H, P: homogeneous(P[:3, :3], (H @ P)[:3, 3]), 1.1
    ),
    "has its own rotation left out": ("fixed_order", lambda H, P: homogeneous(H[:3, :3], (H @ P)[:3, 3]), 1.1),
    "has the fixed link's rotation transposed in its own": (
        "fixed_order", lambda H, P: homogeneous(H[:3, :3].T @ P[:3, :3], (H @ P)[:3, 3]), 1.1
    ),
    "has its xyz turned by the fixed link's transposed rotation": (
        "fixed_order", lambda H, P: homogeneous(H[:3, :3] @ P[:3, :3], H[:3, 3] + H[:3, :3].T @ P[:3, 3]), 1.1
    ),
    "loses its own xyz": ("fixed_order", lambda H, P: H @ _turned(P), 1.1),
    "has the fixed link's placement inverted": ("fixed_order", lambda H, P: np.linalg.inv(H) @ P, 1.1),
}  # fmt: skip


def _chained(p: Part, d: Description, pair: Pair) -> np.ndarray:
    """The pose of a joint on the link that carries it, multiplied up along a chain of fixed links."""
    chain, on = [p], d.part_of_link(p.parent)
    while on is not None and not on.moves:
        chain.append(on)
        on = d.part_of_link(on.parent)
    whole = chain.pop().pose
    while chain:
        whole = pair(whole, chain.pop().pose)
    return whole


def _on_fixed(key: str, says: str, pair: Pair, fixed: bool, cost: float) -> None:
    """A rule about joints on fixed links; if `fixed`, about fixed ones too, where a chain of links is."""

    @joint_rule(key, says, "multiply the pose of a fixed joint by that of what it carries, from the right", cost=cost)
    def placed(p: Part, d: Description) -> Part:
        on = d.part_of_link(p.parent)
        if on is None or on.moves or not (d.nests if fixed else p.moves):
            return p
        if not fixed:
            between = _between(p, d)
            return p.placed(np.linalg.inv(between) @ pair(between, p.pose))
        return p.placed(np.linalg.inv(_chained(on, d, pair)) @ _chained(p, d, pair))


for _words, (_key, _pair, _cost) in ON_FIXED.items():
    _on_fixed(_key, f"a joint on a fixed link {_words}", _pair, False, _cost)
    _on_fixed(_key, f"a joint on a fixed link, a fixed joint too, {_words}", _pair, True, _cost + 0.05)


@joint_rule(
    "motion_first", "the joint moves before the rpy of its origin, and of the fixed link that it is on, is applied",
    "a joint's pose is origin times motion", cost=1.1,
)  # fmt: skip
def motion_before_all_rpy(p: Part, d: Description) -> Part:
    between = _between(p, d)
    whole = between @ p.pose
    if not p.axial or np.abs(between - np.eye(4)).max() < 1e-12:
        return motion_before_rpy(p, d)
    return replace(p.placed(np.linalg.inv(between) @ _shifted(whole)), after=_turned(whole) @ p.after)


@joint_rule(
    "fixed_placement", "placements of fixed joints are ignored", "multiply the poses of fixed joints in", cost=1.09
)
def fixed_ignored(p: Part, d: Description) -> Part:
    return p if p.moves else p.placed(homogeneous(np.eye(3), np.zeros(3)))
