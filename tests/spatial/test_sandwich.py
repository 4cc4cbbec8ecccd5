"""Points, lines and planes by dual quaternions, against homogeneous matrices; quaternions and matrices of arrays."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin import spatial


def motions(rng, *batch):
    return spatial.exp(rng.uniform(-2, 2, (*batch, 6)))


@pytest.mark.parametrize("batch", [(), (4,), (2, 3)])
@pytest.mark.parametrize("matrices", [False, True])
def test_points_lines_and_planes_are_carried_as_by_matrices(batch, matrices):
    rng = np.random.default_rng(0)
    x = motions(rng, *batch)
    T = spatial.to_matrix(x)
    given = T if matrices else x
    R, t = T[..., None, :3, :3], T[..., None, :3, 3]
    p, u = rng.standard_normal((2, *batch, 5, 3))
    moved = np.einsum("...ij,...j->...i", R, p) + t
    assert np.abs(spatial.transform_points(given, p) - moved).max() < 1e-14
    lines = np.concatenate((u, np.cross(p, u)), axis=-1)
    Ru = np.einsum("...ij,...j->...i", R, u)
    want = np.concatenate((Ru, np.cross(moved, Ru)), axis=-1)
    assert np.abs(spatial.transform_lines(given, lines) - want).max() < 4e-14
    both = spatial.transform_lines(given, dp.Dual(u, np.cross(p, u)))
    assert np.abs(np.concatenate((both.real, both.dual), axis=-1) - want).max() < 4e-14
    # a plane through p with normal u: the moved plane holds the moved point
    planes = np.concatenate((u, (u * p).sum(-1, keepdims=True)), axis=-1)
    got = spatial.transform_planes(given, planes)
    assert np.abs(got[..., :3] - Ru).max() < 1e-14
    assert np.abs((got[..., :3] * moved).sum(-1) - got[..., 3]).max() < 4e-14
    # twists are dual vectors too
    assert np.abs(np.einsum("...ij,...kj->...ki", spatial.adjoint(T), lines) - want).max() < 4e-14


def test_one_motion_for_many_and_many_motions_for_one():
    rng = np.random.default_rng(1)
    x, p = motions(rng, 6), rng.standard_normal((7, 3))
    many = spatial.transform_points(x, p)
    assert many.shape == (6, 7, 3)
    assert np.abs(many[2] - spatial.transform_points(x[2], p)).max() < 1e-15
    assert spatial.transform_points(x[0], p[0]).shape == (3,)
    assert spatial.transform_lines(x, np.ones(6)).shape == (6, 6)
    a, b = x[:2]
    assert np.abs(spatial.transform_points(spatial.compose(a, b), p)
                  - spatial.transform_points(a, spatial.transform_points(b, p))).max() < 1e-14  # fmt: skip
    line = dp.algebra.line([1.0, 0, 0], [0, 0, 1.0])
    assert spatial.transform_lines(a, line).shape == (3,)


def test_the_wrong_conjugate_does_not_carry():
    """With q* alone, a point 1 + eps p stays what it is turned: the translation is lost."""
    q = spatial.arrays._motion("x", spatial.exp([0.3, -0.2, 0.5, 1.0, 2.0, 3.0]))
    point = spatial.Quaternion(dp.Dual(1.0, 0.0), dp.Dual(0.0, 0.4), dp.Dual(0.0, 0.1), dp.Dual(0.0, -0.7))
    wrong = [float(c.dual) for c in (q * point * q.conjugate).v]
    right = spatial.transform_points(spatial.exp([0.3, -0.2, 0.5, 1.0, 2.0, 3.0]), [0.4, 0.1, -0.7])
    assert np.abs(right - wrong).max() > 1


@pytest.mark.parametrize("batch", [(), (1,), (3, 1, 2), (0,)])
def test_quaternions_and_matrices_of_arrays(batch):
    rng = np.random.default_rng(2)
    q = rng.standard_normal((*batch, 4))
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    R = spatial.quaternion_to_matrix(q)
    assert R.shape == (*batch, 3, 3)
    assert np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max(initial=0.0) < 1e-15 * 4
    back = spatial.matrix_to_quaternion(R)
    assert back.shape == q.shape
    assert np.abs(back - q * np.where(q[..., :1] < 0, -1, 1)).max(initial=0.0) < 1e-15 * 8


def test_half_turns_have_quaternions_too():
    for axis in np.eye(3):
        R = 2 * np.outer(axis, axis) - np.eye(3)
        assert np.abs(spatial.matrix_to_quaternion(R) - [0, *axis]).max() < 1e-15


@pytest.mark.parametrize(("call", "match"), [
    (lambda: spatial.transform_points(np.ones(8), np.zeros((2, 3))), "unit dual quaternion"),
    (lambda: spatial.transform_points(np.eye(4), np.zeros((2, 2))), r"points of shape \(..., 3\)"),
    (lambda: spatial.transform_lines(np.eye(4), np.zeros((2, 3))), r"lines of shape \(..., 6\)"),
    (lambda: spatial.transform_points(np.tile(np.eye(4), (3, 1, 1)), np.zeros((2, 5, 3))), "broadcast"),
    (lambda: spatial.quaternion_to_matrix([1.0, 1.0, 0, 0]), "unit"),
    (lambda: spatial.matrix_to_quaternion(2 * np.eye(3)), "matrix_to_quaternion"),
])  # fmt: skip
def test_bad_input(call, match):
    with pytest.raises(dp.DualpinError, match=match):
        call()
