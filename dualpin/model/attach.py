"""Model the pieces by themselves, then combine them: a robot that carries bodies, tools, other robots."""

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

    The old joints keep their places in q and v, the new ones come after them.  The terms of the old
    links stay what they were, to the bit; only the body that carries something rigidly gets its
    inertia too.

    Parameters
    ----------
    other : Inertia or Robot
        A body, in the frame it is attached at or, on a joint, in the joint's moving frame; or a
        robot, whose ground is fixed there with all that stands on it.  Its gravity is not asked.
    on : str or Frame, optional
        What carries it, by default the last frame.
    placement : Pose, optional
        Of what is attached (or of its joint's fixed side) in that frame.
    passive : bool
        Hang it on a joint without a motor, by default about the z-axis of `placement`:
        `dualpin.simulate` gives that joint no torque.
    joint : JointModel, optional
        Put it on this joint.
    name : str, optional
        Of the new link, and of its joint; by default "payload", "payload_2", ..., or the robot's name.
    prefix : str
        Put before every name of the other robot, where both have the same.

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
