"""6x6 changes of frame against the poses that carry motors."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.spatial import Vector3, adjoint, coadjoint, motor
from tests.random_robots import random_pose


def test_adjoints_carry_twists_and_wrenches_as_poses_do(seed):
    rng = np.random.default_rng(seed)
    poses = [random_pose(rng) for _ in range(5)]
    T, x = np.array([X.array for X in poses]), rng.uniform(-1, 1, (5, 6))
    for X, twist, wrench, six in zip(poses, adjoint(T), coadjoint(T), x, strict=True):
        a, b = Vector3(*six[:3].tolist()), Vector3(*six[3:].tolist())
        moved, pushed = X @ motor(a, b), X @ motor(b, a)  # a twist w + eps v, a wrench f + eps n
        assert np.abs(twist @ six - [*moved.real, *moved.dual]).max() < 1e-15 * 8
        assert np.abs(wrench @ six - [*pushed.dual, *pushed.real]).max() < 1e-15 * 8
    assert np.abs(np.swapaxes(coadjoint(T), -1, -2) @ adjoint(T) - np.eye(6)).max() < 1e-15 * 8
    assert np.abs(adjoint(T[0] @ T[1]) - adjoint(T[0]) @ adjoint(T[1])).max() < 1e-15 * 8


def test_what_is_no_rigid_motion_is_refused():
    for wrong in (2 * np.eye(4), np.diag([1.0, 1, -1, 1]), np.eye(3)):
        with pytest.raises(dp.DualpinError):
            adjoint(wrong)
