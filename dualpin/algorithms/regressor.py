"""Inverse dynamics as a linear function of the inertial parameters."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Robot
from ..scalars import Scalar
from ..spatial.inertia import Inertia
from ..spatial.pose import GROUND
from ..spatial.vector import power
from .crba import Matrix, square
from .kinematics import joint_poses
from .rnea import motions


def joint_torque_regressor(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar]) -> Matrix:
    """Y with tau = Y p, ten parameters a body.  (Atkeson, An, Hollerbach 1986)

        Y[k, parameter of b] = s_k . (E A + V x E V)      E the parameter's unit inertia

    The parameters are m, m c, and Jxx Jxy Jyy Jxz Jyz Jzz about the body's origin.
    """
    X, Y = joint_poses(robot, q), square(robot, 10 * len(robot))
    V, A = motions(robot, X, v, a)
    basis = Inertia.basis()
    for b in robot:
        columns = [E(A[b]) + V[b].cross(E(V[b])) for E in basis]
        outward = GROUND
        for c in b.chain:
            for k, s in c.dofs:
                r = outward.pull(s)
                for i, F in enumerate(columns, 10 * b.index):
                    Y[k][i] = Y[k][i] + power(r, F)
            outward = X[c] @ outward
    return Y
