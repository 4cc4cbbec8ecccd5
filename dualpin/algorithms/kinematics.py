"""Poses, twists and accelerations of bodies and frames."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..model.robot import Frame, Joint, Robot
from ..scalars import Scalar
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.quaternion import Quaternion
from ..spatial.rotation import IDENTITY
from ..spatial.vector import ZERO_MOTOR, ZERO_VECTOR, Twist, motor
from .sharing import shared

References = ("world", "local", "local_world_aligned")


@shared
def joint_poses(robot: Robot, q: Sequence[Scalar]) -> dict[Joint, Pose]:
    """X: each body's pose in its parent.   X = placement motion(q)"""
    return {b: b.placement @ b.model.motion(q[b.q]) for b in robot}


def path(joint: Joint | None) -> list[Joint]:
    """The joints from the root to this one."""
    return [] if joint is None else list(joint.chain)[::-1]


@shared
def forward_kinematics(
    robot: Robot, q: Sequence[Scalar], joints: Iterable[Joint] | None = None
) -> dict[Joint | None, Pose]:
    """Each body's pose in the world, for all joints or a subset with parents first.   X_b = X_parent X"""
    world: dict[Joint | None, Pose] = {None: IDENTITY_POSE}
    for b in robot if joints is None else joints:
        X = b.placement @ b.model.motion(q[b.q])
        world[b] = world[b.parent] @ X if b.parent else X
    return world


def frame_pose(robot: Robot, q: Sequence[Scalar], frame: Frame) -> Pose:
    """Pose of a frame in the world."""
    return forward_kinematics(robot, q, path(frame.joint))[frame.joint] @ frame.placement


def frame_quaternion(robot: Robot, q: Sequence[Scalar], frame: Frame) -> Quaternion:
    """The same as a unit dual quaternion, by products of dual quaternions alone."""
    total = IDENTITY_POSE.quaternion
    for b in path(frame.joint):
        total = total * b.placement.quaternion * b.model.quaternion(q[b.q])
    return total * frame.placement.quaternion


def viewpoint(pose: Pose, reference: str) -> Pose:
    """The frame in which motions of a frame at `pose` are expressed."""
    return {"world": IDENTITY_POSE, "local_world_aligned": Pose(IDENTITY, pose.position), "local": pose}[reference]


@shared
def twists(chain: Iterable[Joint], world: dict[Joint | None, Pose], v: Sequence[Scalar]) -> dict[Joint | None, Twist]:
    """Twists in world coordinates.   V_b = V_parent + S v"""
    V: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    for b in chain:
        V[b] = V[b.parent] + world[b] @ b.model.twist(v[b.v])
    return V


@shared
def accelerations(
    chain: Iterable[Joint], world: dict[Joint | None, Pose], v: Sequence[Scalar], a: Sequence[Scalar]
) -> dict[Joint | None, Twist]:
    """Spatial accelerations in world coordinates.   A_b = A_parent + S a + V x S v"""
    V, A = twists(chain, world, v), dict[Joint | None, Twist]({None: ZERO_MOTOR})
    for b in chain:
        Sv, Sa = world[b] @ b.model.twist(v[b.v]), world[b] @ b.model.twist(a[b.v])
        A[b] = A[b.parent] + Sa + V[b].cross(Sv)
    return A


@shared
def screws(chain: Iterable[Joint], world: dict[Joint | None, Pose]) -> list[tuple[Joint, int, Twist]]:
    """(joint, which velocity, screw in world coordinates) of all degrees of freedom of a chain."""
    return [(b, k, world[b] @ s) for b in chain for k, s in b.dofs]


def body_twists(robot: Robot, X: dict[Joint, Pose], v: Sequence[Scalar]) -> dict[Joint | None, Twist]:
    """Twists of the bodies, each in its own frame.   V_b = X^-1 V_parent + S v"""
    V: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    for b in robot:
        V[b] = X[b].pull(V[b.parent]) + b.model.twist(v[b.v])
    return V


def body_twists_change(
    robot: Robot, X: dict[Joint, Pose], V: dict[Joint | None, Twist], v: Sequence[Scalar], dq: Sequence[Scalar]
) -> dict[Joint | None, Twist]:
    """Change of these twists by a displacement dq of the joints.   dV_b = X^-1 dV_parent + (V_b - S v) x S dq"""
    dV: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    for b in robot:
        before = V[b] - b.model.twist(v[b.v])
        dV[b] = X[b].pull(dV[b.parent]) + before.cross(b.model.twist(dq[b.v]))
    return dV


def frame_velocity(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], frame: Frame, reference: str) -> Twist:
    """Twist of a frame, expressed in the reference."""
    chain = path(frame.joint)
    world = forward_kinematics(robot, q, chain)
    view = viewpoint(world[frame.joint] @ frame.placement, reference)
    return view.pull(twists(chain, world, v)[frame.joint])


def frame_acceleration(
    robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar], frame: Frame, reference: str,
    classical: bool = False,
) -> Twist:  # fmt: skip
    """Spatial acceleration of a frame, or the classical one of its origin.

    classical:  A + eps w x v, the acceleration of the point at the origin.
    """
    chain = path(frame.joint)
    world = forward_kinematics(robot, q, chain)
    V, A = twists(chain, world, v), accelerations(chain, world, v, a)
    view = viewpoint(world[frame.joint] @ frame.placement, reference)
    seen, twist = view.pull(A[frame.joint]), view.pull(V[frame.joint])
    return seen + motor(ZERO_VECTOR, twist.real.cross(twist.dual)) if classical else seen
