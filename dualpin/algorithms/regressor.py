"""Inverse dynamics as a linear function of the inertial parameters."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import Exact, Scalar
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE
from ..spatial.vector import power
from .crba import Matrix, square
from .kinematics import joint_poses
from .rnea import motions


def rotors(robot: Robot) -> list[tuple[Joint, int]]:
    """(joint, which of its velocities) of each armature entry, in the joints' order; none if all are exact zeros."""
    found = [(b, n) for b in robot for n in range(b.model.nv)]
    return found if any(type(x) is not Exact or x.n for b in robot for x in b.armature) else []


def inertial_parameters(robot: Robot) -> list[Scalar]:
    """The p with tau = Y p: ten for each body, then the armature entries if there are any."""
    return [x for b in robot for x in b.inertia.parameters] + [b.armature[n] for b, n in rotors(robot)]


def joint_torque_regressor(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar]) -> Matrix:
    """Y with tau = Y p, ten parameters a body.  (Atkeson, An, Hollerbach 1986)

        Y[k, parameter of b] = s_k . (E A + V x E V)      E the parameter's unit inertia

    The parameters are m, m c, and Jxx Jxy Jyy Jxz Jyz Jzz about the body's origin.  If any joint has
    armature, one column for each entry of each joint's follows:

        Y[k, rotor] = multiplier^2 a_k                    multiplier 1 except for mimic joints
    """
    X, Y = joint_poses(robot, q), square(robot, len(inertial_parameters(robot)))
    V, A = motions(robot, X, v, a)
    basis = Inertia.basis()
    for b in robot:
        columns = [E(A[b]) + V[b].cross(E(V[b])) for E in basis]
        outward = IDENTITY_POSE
        for c in b.chain:
            for k, s in c.dofs:
                r = outward.pull(s)
                for i, F in enumerate(columns, 10 * b.index):
                    Y[k][i] = Y[k][i] + power(r, F)
            outward = X[c] @ outward
    for i, (b, n) in enumerate(rotors(robot), 10 * len(robot)):
        k, multiplier = b.v.start + n, b.coupling[0]
        Y[k][i] = a[k] * multiplier * multiplier
    return Y
