"""Give a robot something to carry, without describing the robot again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..spatial.inertia import Inertia
from ..spatial.pose import GROUND, Pose
from .builder import Builder
from .joints import JointModel, revolute
from .robot import Limits

if TYPE_CHECKING:
    from .robot import Robot


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
    """The robot with a payload held rigidly, or hanging on a passive joint (no torque, effort limit 0).

    Without `joint` a passive one is revolute about the z-axis of `placement`.
    """
    b = Builder.of(robot)
    on = robot.frame_names[-1] if on is None else on
    if passive or joint is not None:
        limits = Limits(effort=0.0) if passive else None
        b.joint(name, joint or revolute(), on=on, placement=placement, inertia=payload, limits=limits)
    else:
        b.fixed(name, on=on, placement=placement, inertia=payload)
    return b.robot()
