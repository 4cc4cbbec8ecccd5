"""Name the place of one entry of a term: which joint, which axis, which parameter of which body."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..algorithms import regressor
from ..model.robot import Frame, Robot
from ..terms import TERMS

WRENCH = ("nx", "ny", "nz", "fx", "fy", "fz")
TWIST = ("wx", "wy", "wz", "vx", "vy", "vz")
MOMENTUM = ("lx", "ly", "lz", "px", "py", "pz")
PARAMETERS = ("mass", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")


def locate(robot: Robot, term: str, entry: int, options: Mapping[str, Any] | None = None) -> str:
    """The place of an entry of a term, in words.

    Parameters
    ----------
    robot : Robot
    term : str
        One of `dualpin.crosscheck.CHECKS`.
    entry : int
        The place in the flattened result of one sample.
    options : mapping, optional
        The variant: ``frame``, ``reference``, ``classical``.

    Returns
    -------
    str
        Such as ``"row panda_joint4, column panda_joint2"``; empty for a term with one number.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.crosscheck.where import locate
    >>> robot = dp.load("ur5")
    >>> locate(robot, "rnea", 2)
    'elbow_joint'
    >>> locate(robot, "crba", 1)
    'row shoulder_pan_joint, column shoulder_lift_joint'
    >>> locate(robot, "jacobian", 7, {"frame": robot.frame("tool0"), "reference": "local"})
    'row wy, column shoulder_lift_joint; frame tool0, reference local'
    """
    shape = (robot.nv,) if term == "difference" else TERMS[term].shape(robot, **(options or {}))
    shape = shape if np.prod(shape) else ()  # no entries: nothing to name
    index = tuple(int(i) for i in np.unravel_index(entry, shape)) if shape else ()
    names = [_label(robot, term, axis, size, i) for axis, (size, i) in enumerate(zip(shape, index, strict=True))]
    if len(names) == 2:
        place = f"row {names[0]}, column {names[1]}"
    elif len(names) == 3:
        place = f"{names[0]}, row {names[1]}, column {names[2]}"
    else:
        place = ", ".join(names)
    variant = ", ".join(
        f"{key} {value.name if isinstance(value, Frame) else value}" for key, value in (options or {}).items()
    )
    return "; ".join(x for x in (place, variant) if x)


def _label(robot: Robot, term: str, axis: int, size: int, i: int) -> str:
    """The name of index i along an axis of a term."""
    last = axis == 1
    if term == "joint_wrenches" and last:
        return WRENCH[i]
    if term in ("fk", "joint_wrenches") and axis == 0:
        return f"joint {robot.joint_names[i]}"
    if term in ("frame_pose", "fk"):
        return str(i)
    if term.endswith("_derivatives") and axis == 0:
        return ("by q", "by v", "by the last argument")[i]
    if term == "joint_torque_regressor" and last:
        if i >= 10 * len(robot):
            joint, n = regressor.rotors(robot)[i - 10 * len(robot)]
            return f"armature of {joint.name}" + (f", entry {n}" if joint.model.nv > 1 else "")
        body, parameter = divmod(i, 10)
        return f"{PARAMETERS[parameter]} of the body of {robot.joint_names[body]}"
    if term in ("com", "com_jacobian") and not last:
        return "xyz"[i]
    if term == "centroidal_momentum_matrix" and not last:
        return MOMENTUM[i]
    if term in ("jacobian", "jacobian_dot", "frame_velocity", "frame_acceleration") and not last:
        return TWIST[i]
    return velocity_names(robot)[i]


def velocity_names(robot: Robot) -> list[str]:
    """One name for each entry of v: the joint's, and which of its velocities where it has several."""
    names = [str(i) for i in range(robot.nv)]
    for j in robot:
        if j.mimic:
            continue
        parts = j.model.velocity_names
        for i, part in zip(range(j.v.start, j.v.stop), parts, strict=True):
            names[i] = j.name if len(parts) == 1 else f"{j.name} {part}"
    return names
