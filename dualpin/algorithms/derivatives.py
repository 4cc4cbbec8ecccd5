"""Derivatives of inverse and forward dynamics, by recursion.

`responses` defines the notation and displacements.  Products of the matrices with a vector, from the right (a
directional derivative) and from the left (the gradient of w . tau), are computed without the matrices.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import ZERO, Scalar
from ..spatial.vector import ZERO_MOTOR, Twist, Wrench, power
from .aba import aba, factorised, inverse, solve_factorised
from .crba import Matrix, square
from .responses import sweep

Vector = list[Scalar]


def rnea_derivatives(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> tuple[Matrix, Matrix, Matrix]:
    """d tau / dq, d tau / dv and d tau / da = M.  (Singh, Russell, Wensing 2022)

    With I, B, F summed over the subtree of k, for j on the way from k to the ground,

        d tau_j / dq_k = s_j . (2 B P_k + I R_k + s_k x F)      d tau_j / dv_k = s_j . (2 B s_k + I Q_k)
        d tau_k / dq_j = s_k . (2 B P_j + I R_j)                d tau_k / dv_j = s_k . (2 B s_j + I Q_j)
        d tau_j / da_k = s_j . I s_k
    """
    X, I, B, F, responses, _ = sweep(robot, q, v, a, f_ext)
    dq, dv, da = square(robot), square(robot), square(robot)
    # the wrench caused by each screw acts on all joints down to the ground
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
                if c is b:  # the joint's own screws move with the body, those of joints before it do not
                    by_position = by_position + s.cross(F[b])
                by_acceleration, transposed = X[c] @ by_acceleration, X[c] @ transposed
                by_position, by_velocity = X[c] @ by_position, X[c] @ by_velocity
            da[k][k] = da[k][k] + rotor
    return dq, dv, da


def rnea_vjp(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    w: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> tuple[Vector, Vector, Vector]:
    """The gradient of w . tau by q, v and a: w^T d tau / dq, w^T d tau / dv and w^T M, in O(n).

    w . tau is the power of the bodies' wrenches on the motion U with the joint velocities w,
    sum_b U_b . f_b.  With  K = sum I U,  L = sum 2 B^T U  over the subtree of j,

        d / dq_j = R . K + P . L + (U_p x s) . F     d / dv_j = Q . K + s . L     d / da_j = s . K
    """
    X, _, _, F, responses, own = sweep(robot, q, v, a, f_ext)
    U: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    before: dict[Joint, Twist] = {}
    K: dict[Joint | None, Wrench] = {None: ZERO_MOTOR}
    L: dict[Joint | None, Wrench] = {None: ZERO_MOTOR}
    for b in robot:
        before[b] = X[b].pull(U[b.parent])
        U[b] = before[b] + b.model.twist(w[b.v])
        K[b], L[b] = b.inertia(U[b]), own[b].transposed(U[b]) * 2
    dq, dv, da = [ZERO] * robot.nv, [ZERO] * robot.nv, [ZERO] * robot.nv
    for b in reversed(robot):
        for (k, s, rotor), (_, P, R, Q) in zip(b.driven, responses[b], strict=True):
            dq[k] = dq[k] + power(R, K[b]) + power(P, L[b]) + power(before[b].cross(s), F[b])
            dv[k] = dv[k] + power(Q, K[b]) + power(s, L[b])
            da[k] = da[k] + power(s, K[b]) + w[k] * rotor
        K[b.parent], L[b.parent] = K[b.parent] + X[b] @ K[b], L[b.parent] + X[b] @ L[b]
    return dq, dv, da


def rnea_jvp(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    dq: Sequence[Scalar],
    dv: Sequence[Scalar],
    da: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> Vector:
    """Directional derivative of tau, d tau / dq dq + d tau / dv dv + M da, in O(n).

    alpha, beta   summed over all joints on the way to b
    dF_b = I beta + 2 B alpha + sum X (dF + (S dq) x F) of the children
    d tau = S . dF
    """
    X, _, _, F, responses, own = sweep(robot, q, v, a, f_ext)
    alpha: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    beta: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    dF: dict[Joint | None, Wrench] = {None: ZERO_MOTOR}
    for b in robot:
        alpha[b], beta[b] = X[b].pull(alpha[b.parent]), X[b].pull(beta[b.parent])
        for (k, s), (_, P, R, Q) in zip(b.dofs, responses[b], strict=True):
            alpha[b] = alpha[b] + P * dq[k] + s * dv[k]
            beta[b] = beta[b] + R * dq[k] + Q * dv[k] + s * da[k]
        dF[b] = b.inertia(beta[b]) + own[b](alpha[b]) * 2
    tau = [ZERO] * robot.nv
    for b in reversed(robot):
        for k, s, rotor in b.driven:
            tau[k] = tau[k] + power(s, dF[b]) + da[k] * rotor
        turned = b.model.twist(dq[b.v]).cross(F[b])
        dF[b.parent] = dF[b.parent] + X[b] @ (dF[b] + turned)
    return tau


def aba_derivatives(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    tau: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> tuple[Matrix, Matrix, Matrix]:
    """d a / dq, d a / dv and d a / d tau = M^-1.  (Carpentier & Mansard 2018)

    Differentiate tau = rnea(q, v, a) with tau fixed:  d a / dq = -M^-1 d tau / dq,  likewise for v.
    """
    dq, dv, M = rnea_derivatives(robot, q, v, aba(robot, q, v, tau, f_ext), f_ext)
    factors = factorised(M)
    return _solved(factors, dq, -1), _solved(factors, dv, -1), inverse(*factors)


def _solved(factors: tuple[Matrix, list[Scalar]], matrix: Matrix, sign: int) -> Matrix:
    columns = [solve_factorised(*factors, [sign * x for x in column]) for column in zip(*matrix, strict=True)]
    return [list(row) for row in zip(*columns, strict=True)]
