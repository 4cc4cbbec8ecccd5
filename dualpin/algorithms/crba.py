"""The joint-space inertia matrix by the composite-rigid-body algorithm."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import ZERO, Scalar
from ..spatial.inertia import ZERO_INERTIA, Inertia
from ..spatial.pose import Pose
from ..spatial.vector import power
from .kinematics import joint_poses

Matrix = list[list[Scalar]]


def square(robot: Robot, columns: int | None = None) -> Matrix:
    """An nv x nv (or nv x columns) matrix of exact zeros."""
    return [[ZERO] * (robot.nv if columns is None else columns) for _ in range(robot.nv)]


def composites(robot: Robot, X: dict[Joint, Pose]) -> dict[Joint | None, Inertia]:
    """Inertia of each subtree in its root's frame; under the key None that of all bodies, in the world frame."""
    I: dict[Joint | None, Inertia] = {b: b.inertia for b in robot} | {None: ZERO_INERTIA}
    for b in reversed(robot):
        I[b.parent] = I[b.parent] + X[b] @ I[b]
    return I


def crba(robot: Robot, q: Sequence[Scalar]) -> Matrix:
    """Joint-space inertia M, both triangles.  (Walker & Orin 1982; Featherstone 2008, 6.2)

    I_c = I + sum X I_c children
    M_jk = s_j . I_c s_k      for j on the way from k to the ground
    """
    X = joint_poses(robot, q)
    I, M = composites(robot, X), square(robot)
    for b in robot:
        for k, s, rotor in b.driven:
            F = I[b](s)
            for c in b.chain:
                for j, r in c.dofs:
                    if c is b and j > k:
                        continue  # the other triangle is a copy, so that M is exactly symmetric
                    M_jk = power(r, F)
                    M[j][k] = M[j][k] + M_jk
                    if c is not b or j != k:
                        M[k][j] = M[k][j] + M_jk
                F = X[c] @ F
            M[k][k] = M[k][k] + rotor
    return M
