"""How inverse and forward dynamics change with the state, by recursion instead of differentiation.

A coordinate is varied along its screw: body b and all it carries are displaced by s_j, a rigid
motion of the whole subtree.  For a floating or planar joint that is the tangent space, displacements
in the moving frame; for all others the coordinate itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..model.robot import Joint, Robot
from ..scalars import Scalar
from ..spatial.inertia import Connection, Inertia
from ..spatial.vector import ZERO_MOTOR, Twist, Wrench, power
from .aba import aba, factorised, inverse, solve_factorised
from .crba import Matrix, square
from .kinematics import joint_poses


class Response(NamedTuple):
    """What a screw does to the motion of all it carries."""

    velocity: Twist
    """P: the twist changes by it, for a unit displacement along the screw."""
    acceleration: Twist
    """R: the acceleration changes by it, for a unit displacement."""
    rate: Twist
    """Q: the acceleration changes by it, for a unit velocity along the screw."""

    @classmethod
    def to(cls, s: Twist, V_parent: Twist, A_parent: Twist, V: Twist) -> Response:
        P = V_parent.cross(s)
        return cls(P, A_parent.cross(s) + V_parent.cross(P), P + V.cross(s))


def rnea_derivatives(
    robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar]
) -> tuple[Matrix, Matrix, Matrix]:
    """d tau / dq, d tau / dv and d tau / da = M.  (Singh, Russell, Wensing 2022)

    With V_p, A_p those of the parent, what a screw does to velocity and acceleration beyond it (`Response`):

        P_j = V_p x s_j,   R_j = A_p x s_j + V_p x P_j,   Q_j = P_j + V_j x s_j

    and with I, B, F summed over the subtree of k, for j on the way from k to the ground,

        d tau_j / dq_k = s_j . (2 B P_k + I R_k + s_k x F)      d tau_j / dv_k = s_j . (2 B s_k + I Q_k)
        d tau_k / dq_j = s_k . (2 B P_j + I R_j)                d tau_k / dv_j = s_k . (2 B s_j + I Q_j)
        d tau_j / da_k = s_j . I s_k

    B is the connection of `coriolis`.
    """
    X = joint_poses(robot, q)
    V: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    A: dict[Joint | None, Twist] = {None: robot.at_rest}
    I: dict[Joint | None, Inertia] = {b: b.inertia for b in robot}
    B: dict[Joint | None, Connection] = {}
    F: dict[Joint | None, Wrench] = {}
    responses: dict[Joint, list[Response]] = {}
    # pass 1, from the root to the leaves: how the bodies move, and what each screw does to that
    for b in robot:
        V_parent, A_parent = X[b].pull(V[b.parent]), X[b].pull(A[b.parent])
        Sv, Sa = b.model.twist(v[b.v]), b.model.twist(a[b.v])
        V[b] = V_parent + Sv
        A[b] = A_parent + Sa + V[b].cross(Sv)
        B[b] = Connection.of(b.inertia, V[b])
        F[b] = b.inertia(A[b]) + V[b].cross(b.inertia(V[b]))
        responses[b] = [Response.to(s, V_parent, A_parent, V[b]) for s in b.model.screws]
    # pass 2, from the leaves to the root: the wrench each screw causes is felt by all joints down to the ground
    dq, dv, da = square(robot), square(robot), square(robot)
    for b in reversed(robot):
        for (k, s, rotor), response in zip(b.driven, responses[b], strict=True):
            by_acceleration = I[b](s)
            by_velocity = B[b](s) * 2 + I[b](response.rate)
            by_position = B[b](response.velocity) * 2 + I[b](response.acceleration)
            transposed = B[b].transposed(s) * 2
            for c in b.chain:
                for (j, t), before in zip(c.dofs, responses[c], strict=True):
                    dq[j][k] = dq[j][k] + power(t, by_position)
                    dv[j][k] = dv[j][k] + power(t, by_velocity)
                    da[j][k] = da[j][k] + power(t, by_acceleration)
                    if c is not b:
                        dq[k][j] = dq[k][j] + power(before.velocity, transposed)
                        dq[k][j] = dq[k][j] + power(before.acceleration, by_acceleration)
                        dv[k][j] = dv[k][j] + power(t, transposed) + power(before.rate, by_acceleration)
                        da[k][j] = da[k][j] + power(t, by_acceleration)
                if c is b:  # the joint's own screws are displaced with the body, those before it are not
                    by_position = by_position + s.cross(F[b])
                by_acceleration, transposed = X[c] @ by_acceleration, X[c] @ transposed
                by_position, by_velocity = X[c] @ by_position, X[c] @ by_velocity
            da[k][k] = da[k][k] + rotor
        if b.parent:
            I[b.parent] = I[b.parent] + X[b] @ I[b]
            B[b.parent] = B[b.parent] + X[b] @ B[b]
            F[b.parent] = F[b.parent] + X[b] @ F[b]
    return dq, dv, da


def aba_derivatives(
    robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], tau: Sequence[Scalar]
) -> tuple[Matrix, Matrix, Matrix]:
    """d a / dq, d a / dv and d a / d tau = M^-1.  (Carpentier & Mansard 2018)

    Differentiate tau = rnea(q, v, a) with tau fixed:  d a / dq = -M^-1 d tau / dq,  likewise for v.
    """
    dq, dv, M = rnea_derivatives(robot, q, v, aba(robot, q, v, tau))
    factors = factorised(M)
    return _solved(factors, dq, -1), _solved(factors, dv, -1), inverse(*factors)


def _solved(factors: tuple[Matrix, list[Scalar]], matrix: Matrix, sign: int) -> Matrix:
    columns = [solve_factorised(*factors, [sign * x for x in column]) for column in zip(*matrix, strict=True)]
    return [list(row) for row in zip(*columns, strict=True)]
