"""Mistakes in reading a joint's <origin>, <axis> and type."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..description import Description, Part, homogeneous, turn
from .register import joint_rule

ORIGIN = "place a joint by xyz, then turn it by Rz(yaw) Ry(pitch) Rx(roll)"
AXIS = "read <axis> in the joint's own frame (after rpy), with its sign; without one it is 1 0 0"


def _along(p: Part, axis: np.ndarray) -> Part:
    if not p.axial:
        return p
    return p if np.abs(axis - p.unit_axis).max() <= 1e-12 else replace(p, axis=axis)


@joint_rule("axis_sign", "the sign of joint axes is dropped", AXIS)
def axis_sign(p: Part, d: Description) -> Part:
    return _along(p, np.abs(p.unit_axis))


@joint_rule("axis_reversed", "joints move the other way", AXIS, cost=1.2)
def axis_reversed(p: Part, d: Description) -> Part:
    return _along(p, -p.unit_axis)


@joint_rule("axis_default_z", "a joint without <axis> is about z", AXIS)
def axis_default_z(p: Part, d: Description) -> Part:
    return _along(p, np.array([0.0, 0.0, 1.0])) if p.axis is None else p


@joint_rule("axis_always_z", "every joint is about z", AXIS)
def axis_always_z(p: Part, d: Description) -> Part:
    return _along(p, np.array([0.0, 0.0, 1.0]))


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


@joint_rule("prismatic_as_revolute", "prismatic joints turn", "a prismatic joint slides along its axis")
def prismatic_as_revolute(p: Part, d: Description) -> Part:
    return replace(p, type="revolute") if p.slides else p


@joint_rule(
    "fixed_parent", "a joint on a fixed link loses the fixed link's placement", "multiply the poses of fixed joints in"
)
def fixed_parent(p: Part, d: Description) -> Part:
    """On the moving link itself: what lies between is undone."""
    if not p.moves:
        return p
    between, on = np.eye(4), d.part_of_link(p.parent)
    while on is not None and not on.moves:
        between, on = on.pose @ between, d.part_of_link(on.parent)
    if on is None or np.abs(between - np.eye(4)).max() < 1e-12:
        return p
    return p.placed(np.linalg.inv(between) @ p.pose)


@joint_rule(
    "fixed_placement", "placements of fixed joints are ignored", "multiply the poses of fixed joints in", cost=1.1
)
def fixed_ignored(p: Part, d: Description) -> Part:
    return p if p.moves else p.placed(homogeneous(np.eye(3), np.zeros(3)))
