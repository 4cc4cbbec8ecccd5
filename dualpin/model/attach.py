"""Combine models: a robot that carries bodies, tools or other robots."""

from __future__ import annotations

from ..errors import ArgumentError
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from .builder import Builder
from .joints import JointModel, revolute
from .robot import Frame, Limits, Robot


def attached(
    robot: Robot,
    other: Robot | Inertia,
    on: str | Frame | None = None,
    placement: Pose = IDENTITY_POSE,
    *,
    passive: bool = False,
    joint: JointModel | None = None,
    name: str | None = None,
    prefix: str = "",
) -> Robot:
    """A new robot that carries a body or another robot.

    The old joints keep their indices in q and v; the new ones follow.  The terms of the old links do not
    change in any bit, except for the body to which something is fixed: its inertia includes that.

    Parameters
    ----------
    other : Inertia or Robot
        A body, in the frame it is attached at or, on a joint, in the joint's moving frame; or a
        robot, whose ground is fixed there.  The gravity of that robot is not used.
    on : str or Frame, optional
        The frame to which it is attached; by default the last one.
    placement : Pose, optional
        Pose of the attached body or robot (or of its joint's fixed side) in that frame.
    passive : bool
        Attach it by a joint without a motor, by default about the z-axis of `placement`:
        `dualpin.simulate` gives that joint no torque.
    joint : JointModel, optional
        Attach it by this joint.
    name : str, optional
        Name of the new link and of its joint; by default "payload", "payload_2", ..., or the robot's name.
    prefix : str
        Added before every name of the other robot, to make the names differ.

    Returns
    -------
    Robot

    Raises
    ------
    FrameNotFoundError
        If there is no frame `on`.
    ArgumentError
        If both robots use a name, or something else is attached.

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
    >>> finger = dp.from_dh([(0, 0, 0.05, 0)] * 2, joints="RR", name="finger")
    >>> hand = arm.attach(finger, on="tool0", prefix="left_").attach(finger, on="tool0", prefix="right_")
    >>> hand.nv, hand.joint_names[-1]
    (10, 'right_joint_2')
    """
    if not isinstance(other, (Robot, Inertia)):
        raise ArgumentError(f"attach: an Inertia or a Robot expected, got {type(other).__name__}")
    if joint is not None and not isinstance(joint, JointModel):
        raise ArgumentError(f"attach: joint: a joint model (revolute(), ...) expected, got {type(joint).__name__}")
    at = robot.frames[-1] if on is None else robot.frame(on)
    b = Builder.of(robot)
    inertia, default = (other, "payload") if isinstance(other, Inertia) else (None, f"{prefix}{other.name}_mount")
    place: tuple[str | Frame, Pose] = at, placement
    if passive or joint is not None:
        mount = name or _free(robot, default)
        limits = Limits(effort=0.0) if passive else None
        b.joint(mount, joint or revolute(), at, placement, inertia, limits=limits, passive=passive)
        place = mount, IDENTITY_POSE
    elif inertia is not None:
        b.fixed(name or _free(robot, default), at, placement, inertia)
    if isinstance(other, Robot):
        b.include(other, *place, prefix=prefix)
        b.notes += [f"{other.name}: {note}" for note in other.notes]
    return b.robot()


def _free(robot: Robot, name: str) -> str:
    """The name, or the first of name_2, name_3, ... that is not taken."""
    taken, count, found = {*robot.frame_names}, 1, name
    while found in taken:
        count += 1
        found = f"{name}_{count}"
    return found
