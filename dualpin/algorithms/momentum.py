"""Sums over bodies: centre of mass, momentum, energies."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import ArgumentError
from ..model.robot import Robot
from ..scalars import ZERO, Exact, Scalar
from ..spatial.pose import Pose
from ..spatial.rotation import IDENTITY
from ..spatial.vector import ZERO_MOTOR, Momentum, Vector3, power
from .crba import composites
from .kinematics import body_twists, forward_kinematics, joint_poses


def _weight(robot: Robot, mass: Scalar) -> Scalar:
    """The moving mass; raises if it is zero."""
    if type(mass) is Exact and mass.n == 0:
        raise ArgumentError(f"{robot.name}: no moving body has mass, so there is no centre of mass")
    return mass


def center_of_mass(robot: Robot, q: Sequence[Scalar]) -> Vector3:
    """c = sum (m p + R h) / sum m"""
    total = composites(robot, joint_poses(robot, q))[None]
    return total.moment * (1 / _weight(robot, total.mass))


def centroidal_momentum_matrix(robot: Robot, q: Sequence[Scalar]) -> list[Momentum]:
    """Columns h_k = I_c s_k, moved to the centre of mass, world axes.  (Orin & Goswami 2008)

    Momentum p + eps l = sum h_k v_k.
    """
    I = composites(robot, joint_poses(robot, q))
    world = forward_kinematics(robot, q)
    A = [ZERO_MOTOR] * robot.nv
    if not A:
        return A
    at_com = Pose(IDENTITY, I[None].moment * (1 / _weight(robot, I[None].mass)))
    for b in robot:
        for k, s in b.dofs:
            A[k] = A[k] + at_com.pull(world[b] @ I[b](s))
    return A


def com_jacobian(robot: Robot, q: Sequence[Scalar]) -> list[Vector3]:
    """Columns of dc/dt = J v: the linear part of the centroidal momentum matrix by the total mass."""
    mass = sum((b.inertia.mass for b in robot), ZERO)
    return [h.real * (1 / _weight(robot, mass)) for h in centroidal_momentum_matrix(robot, q)]


def kinetic_energy(robot: Robot, q: Sequence[Scalar], v: Sequence[Scalar]) -> Scalar:
    """T = sum (V . I V + rotor v^2) / 2"""
    X = joint_poses(robot, q)
    V = body_twists(robot, X, v)
    twice: Scalar = ZERO
    for b in robot:
        twice = twice + power(V[b], b.inertia(V[b]))
        for k, _, rotor in b.driven:
            twice = twice + rotor * v[k] * v[k]
    return twice / 2


def potential_energy(robot: Robot, q: Sequence[Scalar]) -> Scalar:
    """U = -sum g . (first moment), zero when all mass is at the world's origin."""
    return -robot.gravity.dot(composites(robot, joint_poses(robot, q))[None].moment)
