"""The Coriolis matrix of the Christoffel symbols, computed by a recursion."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import Scalar
from ..spatial.inertia import ZERO_CONNECTION, Connection, Inertia
from ..spatial.vector import power
from .crba import Matrix, square
from .kinematics import body_twists, joint_poses


def coriolis(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar]) -> Matrix:
    """The C of the Christoffel symbols, with dM/dt = C + C^T.  (Echeandia & Wensing 2021)

        D = the connection of I and V                of the subtree as if it were rigid,
        B = sum X (B + D(S v)) of the children       for what moves in it, seen from the body,  T = B + D
        C_jk = s_j . (I(V x s_k) + T s_k)
        C_kj = s_j . (I s_k x V_j + T^T s_k)         since  (V_j x s_j) . H = s_j . (H x V_j)

    What the rigid subtree adds is antisymmetric in the screws of one joint, so that C_kk = s_k . B s_k: the zero
    of a joint with nothing that moves on it is exact.

    For joints whose velocities are not derivatives of coordinates (floating, planar) it is the
    matrix of the Levi-Civita connection in those quasi-velocities, as in Echeandia & Wensing.
    """
    X = joint_poses(robot, q)
    V = body_twists(robot, X, v)
    I: dict[Joint | None, Inertia] = {b: b.inertia for b in robot}
    B: dict[Joint | None, Connection] = dict.fromkeys(robot, ZERO_CONNECTION)
    C = square(robot)
    for b in reversed(robot):
        T = B[b] + Connection.of(I[b], V[b])
        for k, s in b.dofs:
            H, F, G, own = I[b](s), I[b](V[b].cross(s)) + T(s), T.transposed(s), B[b](s)
            for c in b.chain:
                for j, r in c.dofs:
                    C[j][k] = C[j][k] + power(r, own if c is b and r is s else F)
                    if c is not b:
                        C[k][j] = C[k][j] + power(r, H.cross(V[c]) + G)
                H, F, G = X[c] @ H, X[c] @ F, X[c] @ G
        if b.parent:
            I[b.parent] = I[b.parent] + X[b] @ I[b]
            B[b.parent] = B[b.parent] + X[b] @ (B[b] + Connection.of(I[b], b.model.twist(v[b.v])))
    return C
