"""Progressive dynamics: the contribution of each link to M, C and g.  (Laus, Simoni, Martins)"""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import ZERO, Scalar
from ..spatial.inertia import Connection
from ..spatial.pose import IDENTITY_POSE
from ..spatial.vector import Twist, power
from .crba import Matrix, square
from .kinematics import body_twists, joint_poses


def link_terms(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar]) -> list[list[Matrix | list[Scalar]]]:
    """[M_i, C_i, g_i] of each moving body i, scattered by joint; their sums are M, C and g.

        M_i = J^T I J,   C_i = J^T (I dJ/dt + B J),   g_i = -J^T I (gravity)

    with J the body Jacobian of i, dJ_k = V_k x s_k, and B the connection of body i's own inertia.
    The rotors of the joint that moves body i are counted with it: they add to the diagonal of M_i.
    """
    X = joint_poses(robot, q)
    V = body_twists(robot, X, v)
    A: dict[Joint | None, Twist] = {None: robot.at_rest}
    terms: list[list[Matrix | list[Scalar]]] = []
    for b in robot:
        A[b] = X[b].pull(A[b.parent])
        B, weight = Connection.of(b.inertia, V[b]), b.inertia(A[b])
        M, C, g = square(robot), square(robot), [ZERO] * robot.nv
        outward, screws = IDENTITY_POSE, []
        for c in b.chain:
            screws += [(k, outward.pull(s), outward.pull(V[c].cross(s))) for k, s in c.dofs]
            outward = X[c] @ outward
        for k, s, ds in screws:
            H, F = b.inertia(s), b.inertia(ds) + B(s)
            for j, r, _ in screws:
                M[j][k] = M[j][k] + power(r, H)
                C[j][k] = C[j][k] + power(r, F)
            g[k] = g[k] + power(s, weight)
        for k, _, rotor in b.driven:
            M[k][k] = M[k][k] + rotor
        terms.append([M, C, g])
    return terms
