"""The Coriolis matrix of the Christoffel symbols, computed by a recursion."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import Scalar
from ..spatial.inertia import Connection, Inertia
from ..spatial.vector import power
from .crba import Matrix, square
from .kinematics import body_twists, joint_poses


def coriolis(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar]) -> Matrix:
    """The C of the Christoffel symbols, with dM/dt = C + C^T.  (Echeandia & Wensing 2021)

        B = [V x I( ) + ( ) x I(V) - I(V x ( ))] / 2,  summed over the subtree like I
        C_jk = s_j . (I V x s_k + B s_k)
        C_kj = s_j . (I s_k x V_j + B^T s_k)         since  (V_j x s_j) . H = s_j . (H x V_j)

    For joints whose velocities are not derivatives of coordinates (floating, planar) it is the
    matrix of the Levi-Civita connection in those quasi-velocities, as in Echeandia & Wensing.
    """
    X = joint_poses(robot, q)
    V = body_twists(robot, X, v)
    I: dict[Joint | None, Inertia] = {b: b.inertia for b in robot}
    B: dict[Joint | None, Connection] = {b: Connection.of(b.inertia, V[b]) for b in robot}
    C = square(robot)
    for b in reversed(robot):
        for k, s in b.dofs:
            H, F, G = I[b](s), I[b](V[b].cross(s)) + B[b](s), B[b].transposed(s)
            for c in b.chain:
                for j, r in c.dofs:
                    C[j][k] = C[j][k] + power(r, F)
                    if c is not b:
                        C[k][j] = C[k][j] + power(r, H.cross(V[c]) + G)
                H, F, G = X[c] @ H, X[c] @ F, X[c] @ G
        if b.parent:
            I[b.parent] = I[b.parent] + X[b] @ I[b]
            B[b.parent] = B[b.parent] + X[b] @ B[b]
    return C
