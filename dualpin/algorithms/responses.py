"""The effect of a change of the state on the motion of the bodies; the basis of all derivatives of dynamics.

A coordinate is varied along its screw: the whole subtree of body b is displaced rigidly by s_j.  For a
floating, planar or spherical joint these are displacements in the moving frame (the tangent space);
for all other joints, changes of the coordinate.

In the frame of a body b of that subtree, all bodies outside of it are displaced the opposite way.  A
change of q_j, v_j or a_j therefore changes the motion of b by two twists (alpha, beta) that are the same for
all bodies beyond j:

    dV_b = alpha      dA_b = beta + alpha x V_b      df_b = I beta + 2 B alpha

    q_j: (P, R)       P = V_p x s,   R = A_p x s + V_p x P        V_p, A_p of the parent
    v_j: (s, Q)       Q = P + V x s
    a_j: (0, s)

f_b = I A + V x I V is the wrench that moves b, B the connection of `coriolis`.  The wrench F of the
displaced subtree also rotates with it: in a frame that is not displaced, it changes by s x F.

Singh, Russell & Wensing (2022), Efficient analytical derivatives of rigid-body dynamics using
spatial vector algebra; in motors, with the displacements in the bodies' own frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..model.robot import Joint, Robot
from ..scalars import Scalar
from ..spatial.inertia import Connection, Inertia
from ..spatial.pose import Pose
from ..spatial.vector import ZERO_MOTOR, Twist, Wrench
from .kinematics import joint_poses


class Response(NamedTuple):
    """The effect of a degree of freedom on the motion of its subtree."""

    screw: Twist
    """s: change of the twist for a unit velocity along the screw."""
    velocity: Twist
    """P: change of the twist for a unit displacement along the screw."""
    acceleration: Twist
    """R: change of the acceleration for a unit displacement."""
    rate: Twist
    """Q: change of the acceleration for a unit velocity along the screw."""

    @classmethod
    def to(cls, s: Twist, V_parent: Twist, A_parent: Twist, V: Twist) -> Response:
        P = V_parent.cross(s)
        return cls(s, P, A_parent.cross(s) + V_parent.cross(P), P + V.cross(s))


class Sweep(NamedTuple):
    """Quantities of each joint, in its own moving frame; I, B and F are those of its whole subtree."""

    X: dict[Joint, Pose]
    I: dict[Joint | None, Inertia]
    B: dict[Joint | None, Connection]
    F: dict[Joint | None, Wrench]
    responses: dict[Joint, list[Response]]
    """One for each degree of freedom of the joint, in the order of `Joint.dofs`."""
    own: dict[Joint, Connection]
    """The connection of the joint's body alone."""


def sweep(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> Sweep:
    """Outward pass: motions of the bodies and responses to each screw.  Inward pass: sums over the subtrees."""
    X = joint_poses(robot, q)
    V: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    A: dict[Joint | None, Twist] = {None: robot.at_rest}
    I: dict[Joint | None, Inertia] = {b: b.inertia for b in robot}
    own: dict[Joint, Connection] = {}
    F: dict[Joint | None, Wrench] = {}
    responses: dict[Joint, list[Response]] = {}
    for b in robot:
        V_parent, A_parent = X[b].pull(V[b.parent]), X[b].pull(A[b.parent])
        Sv, Sa = b.model.twist(v[b.v]), b.model.twist(a[b.v])
        V[b] = V_parent + Sv
        A[b] = A_parent + Sa + V[b].cross(Sv)
        own[b] = Connection.of(b.inertia, V[b])
        F[b] = b.inertia(A[b]) + V[b].cross(b.inertia(V[b]))
        if f_ext is not None:
            F[b] = F[b] - f_ext[b.index]  # it is fixed to its body, so its derivatives are zero
        responses[b] = [Response.to(s, V_parent, A_parent, V[b]) for s in b.model.screws]
    B: dict[Joint | None, Connection] = {b: own[b] for b in robot}
    for b in reversed(robot):
        if b.parent:
            I[b.parent] = I[b.parent] + X[b] @ I[b]
            B[b.parent] = B[b.parent] + X[b] @ B[b]
            F[b.parent] = F[b.parent] + X[b] @ F[b]
    return Sweep(X, I, B, F, responses, own)
