"""Inverse dynamics by the recursive Newton-Euler algorithm.

Forces are the same for all inertial observers.  Each body is described by the inertial observer that moves, at
this instant, with the body's origin.  For this observer v = 0, and the eps-part of A is the classical
acceleration of the origin.  Since exact zeros cost nothing, this saves a fifth of the operations: it gives the
classical Newton-Euler recursion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model.robot import Joint, Robot
from ..scalars import ZERO, Scalar
from ..spatial.pose import Pose
from ..spatial.vector import ZERO_MOTOR, ZERO_VECTOR, Twist, Wrench, motor, power
from .kinematics import joint_poses


def ride(V: Twist, A: Twist) -> tuple[Twist, Twist]:
    """Change to the observer with the origin's velocity v:   V -> w,   A -> A + eps w x v."""
    w, v = V.real, V.dual
    return motor(w, ZERO_VECTOR), A + motor(ZERO_VECTOR, w.cross(v))


def carried(X: Pose, V: Twist, A: Twist) -> tuple[Twist, Twist]:
    """The parent's V and A in the frame of b, for the observer that moves with the origin of b."""
    V, A = ride(X.untranslate(V), X.untranslate(A))
    return X.rotation.T @ V, X.rotation.T @ A


def motions(
    robot: Robot, X: dict[Joint, Pose], v: Sequence[Scalar], a: Sequence[Scalar]
) -> tuple[dict[Joint | None, Twist], dict[Joint | None, Twist]]:
    """Twists and accelerations, for the observers that move with the bodies' origins.

    V = X^-1 V_parent + S v
    A = X^-1 A_parent + S a + V x S v              A_ground = -gravity
    """
    V: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    A: dict[Joint | None, Twist] = {None: robot.at_rest}
    for b in robot:
        W, B = carried(X[b], V[b.parent], A[b.parent])
        Sv, Sa = b.model.twist(v[b.v]), b.model.twist(a[b.v])
        V[b], A[b] = ride(W + Sv, B + Sa + W.cross(Sv))
    return V, A


def transmitted(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> Iterator[tuple[Joint, Wrench]]:
    """(b, F_b), leaves first: the wrench on each body from its parent, through its joint.

        F = I A + V x I V - F_ext + sum X F_children

    f_ext: a wrench for each body, in its own frame.
    """
    X = joint_poses(robot, q)
    V, A = motions(robot, X, v, a)
    F: dict[Joint | None, Wrench] = {None: ZERO_MOTOR}
    for b in robot:
        F[b] = b.inertia(A[b]) + V[b].cross(b.inertia(V[b]))
        if f_ext is not None:
            F[b] = F[b] - f_ext[b.index]
    for b in reversed(robot):
        yield b, F[b]
        F[b.parent] = F[b.parent] + X[b] @ F[b]


def joint_wrenches(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> list[Wrench]:
    """The wrenches F of `transmitted`, in the joints' order, each about and in the joint's moving frame."""
    F = dict(transmitted(robot, q, v, a, f_ext))
    return [F[b] for b in robot]


def rnea(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> list[Scalar]:
    """Inverse dynamics, tau = M a + C v + g.  (Luh, Walker, Paul 1980; Featherstone 2008, 5.3, Table 5.1)

    tau = S . F + rotor a               F as in `transmitted`
    """
    tau: list[Scalar] = [ZERO] * robot.nv
    for b, F in transmitted(robot, q, v, a, f_ext):
        for k, s, rotor in b.driven:
            tau[k] = tau[k] + power(s, F) + a[k] * rotor
    return tau


def bias(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], f_ext: Sequence[Wrench] | None = None) -> list[Scalar]:
    """C v + g: inverse dynamics without acceleration."""
    return rnea(robot, q, v, [ZERO] * robot.nv, f_ext)


def gravity(robot: Robot, q: Sequence[Scalar]) -> list[Scalar]:
    """g, the torques that hold the robot at rest."""
    return rnea(robot, q, [ZERO] * robot.nv, [ZERO] * robot.nv)
