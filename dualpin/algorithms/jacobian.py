"""Jacobians of frames and their time derivatives, for three references."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Frame, Robot
from ..scalars import Scalar
from ..spatial.vector import ZERO_MOTOR, ZERO_VECTOR, Twist, motor
from .kinematics import forward_kinematics, path, screws, twists, viewpoint


def jacobian(robot: Robot, q: Sequence[Scalar], frame: Frame, reference: str) -> list[Twist]:
    """Columns J_k = X_f^-1 s_k for the screws s_k that move the frame; other columns are zero.

    Twist = J v.  World, aligned and local differ by the pose X_f of the observer only.
    """
    chain = path(frame.joint)
    world = forward_kinematics(robot, q, chain)
    view = viewpoint(world[frame.joint] @ frame.placement, reference)
    J = [ZERO_MOTOR] * robot.nv
    for _, k, s in screws(chain, world):
        J[k] = J[k] + view.pull(s)
    return J


def jacobian_dot(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], frame: Frame, reference: str) -> list[Twist]:
    """Columns dJ_k/dt = X_f^-1 ((V_k - V_f) x s_k): a screw fixed in body k, relative to an observer.

    The observer moves with V_f: zero for `world`, the frame's twist for `local`, and the
    translation with the frame's origin, eps (v + w x p), for `local_world_aligned`.
    """
    chain = path(frame.joint)
    world = forward_kinematics(robot, q, chain)
    V = twists(chain, world, v)
    pose, twist = world[frame.joint] @ frame.placement, V[frame.joint]
    view = viewpoint(pose, reference)
    origin = motor(ZERO_VECTOR, twist.dual + twist.real.cross(pose.position))
    observer = {"world": ZERO_MOTOR, "local_world_aligned": origin, "local": twist}[reference]
    J = [ZERO_MOTOR] * robot.nv
    for b in chain:
        for k, s in b.dofs:
            J[k] = J[k] + view.pull((V[b] - observer).cross(world[b] @ s))
    return J
