"""Give a robot something to carry, without describing the robot again."""

from __future__ import annotations

from ..spatial.inertia import Inertia
from ..spatial.pose import GROUND, Pose
from .builder import Builder
from .joints import JointModel, revolute
from .robot import Limits, Robot


def attached(
    robot: Robot,
    payload: Inertia,
    on: str | None = None,
    placement: Pose = GROUND,
    *,
    passive: bool = False,
    joint: JointModel | None = None,
    name: str = "payload",
) -> Robot:
    """A new robot that carries a payload; the terms of the old links stay what they were.

    Parameters
    ----------
    payload : Inertia
        In the frame it is attached at, or, on a joint, in the joint's moving frame.
    on : str, optional
        The frame that carries it, by default the last.
    placement : Pose, optional
        Of the payload (or of its joint's fixed side) in that frame.
    passive : bool
        Hang it on a joint without a motor (effort limit 0), by default about the z-axis of `placement`.
    joint : JointModel, optional
        Put it on this joint.

    References
    ----------
    Laus, Simoni & Martins, progressive dynamics of a manipulator and its payload.

    Examples
    --------
    >>> import dualpin as dp
    >>> arm = dp.load("ur5")
    >>> held = arm.attach(dp.mechanisms.body(2.0, [0, 0, 0.1], [[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]]))
    >>> held.nv, round(held.mass - arm.mass, 12)
    (6, 2.0)
    """
    b = Builder.of(robot)
    on = robot.frame_names[-1] if on is None else on
    if passive or joint is not None:
        limits = Limits(effort=0.0) if passive else None
        b.joint(name, joint or revolute(), on=on, placement=placement, inertia=payload, limits=limits)
    else:
        b.fixed(name, on=on, placement=placement, inertia=payload)
    return b.robot()
