"""How inverse and forward dynamics change with the state, by recursion instead of differentiation.

A coordinate is varied along its screw: body b and all it carries are displaced by s_j, a rigid
motion of the whole subtree.  For a floating or planar joint that is the tangent space, displacements
in the moving frame; for all others the coordinate itself.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import Scalar
from ..spatial.inertia import Connection, Inertia
from ..spatial.vector import REST, Vector3, power
from .aba import aba, factorised, inverse, solve_factorised
from .crba import Matrix, square
from .kinematics import joint_poses


def rnea_derivatives(
    robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar]
) -> tuple[Matrix, Matrix, Matrix]:
    """d tau / dq, d tau / dv and d tau / da = M.  (Singh, Russell, Wensing 2022)

    With V_p, A_p those of the parent, what a screw does to velocity and acceleration beyond it:

        P_j = V_p x s_j,   R_j = A_p x s_j + V_p x P_j,   Q_j = P_j + V_j x s_j

    and with I, B, F summed over the subtree of k, for j on the way from k to the ground,

        d tau_j / dq_k = s_j . (2 B P_k + I R_k + s_k x F)      d tau_j / dv_k = s_j . (2 B s_k + I Q_k)
        d tau_k / dq_j = s_k . (2 B P_j + I R_j)                d tau_k / dv_j = s_k . (2 B s_j + I Q_j)
        d tau_j / da_k = s_j . I s_k

    B is the connection of `coriolis`.
    """
    X = joint_poses(robot, q)
    V: dict[Joint | None, Vector3] = {None: REST}
    A: dict[Joint | None, Vector3] = {None: robot.at_rest}
    I: dict[Joint | None, Inertia] = {b: b.inertia for b in robot}
    B: dict[Joint | None, Connection] = {}
    F: dict[Joint | None, Vector3] = {}
    P: dict[int, list[Vector3]] = {}
    for b in robot:
        Vp, Ap = X[b].pull(V[b.parent]), X[b].pull(A[b.parent])
        Sv, Sa = b.model.twist(v[b.v]), b.model.twist(a[b.v])
        V[b] = Vp + Sv
        A[b] = Ap + Sa + V[b].cross(Sv)
        B[b] = Connection.of(b.inertia, V[b])
        F[b] = b.inertia(A[b]) + V[b].cross(b.inertia(V[b]))
        P[b.index] = []
        for s in b.model.screws:
            p = Vp.cross(s)
            P[b.index] += [p, Ap.cross(s) + Vp.cross(p), p + V[b].cross(s)]
    dq, dv, da = square(robot), square(robot), square(robot)
    for b in reversed(robot):
        for i, (k, s, rotor) in enumerate(b.driven):
            p, r, Q = P[b.index][3 * i : 3 * i + 3]
            H = I[b](s)
            G = B[b].transposed(s) * 2
            Fq, Fv = B[b](p) * 2 + I[b](r), B[b](s) * 2 + I[b](Q)
            for c in b.chain:
                for n, (j, t) in enumerate(c.dofs):
                    dq[j][k] = dq[j][k] + power(t, Fq)
                    dv[j][k] = dv[j][k] + power(t, Fv)
                    da[j][k] = da[j][k] + power(t, H)
                    if c is not b:
                        pc, rc, Qc = P[c.index][3 * n : 3 * n + 3]
                        dq[k][j] = dq[k][j] + power(pc, G) + power(rc, H)
                        dv[k][j] = dv[k][j] + power(t, G) + power(Qc, H)
                        da[k][j] = da[k][j] + power(t, H)
                if c is b:  # the joint's own screws are displaced with the body, those before it are not
                    Fq = Fq + s.cross(F[b])
                H, G, Fq, Fv = X[c] @ H, X[c] @ G, X[c] @ Fq, X[c] @ Fv
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
