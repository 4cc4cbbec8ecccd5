"""The screw of a motion from markers: exact data, the least squares definition, noise that is what is said."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin import spatial


def cloud(seed, k=5):
    return np.random.default_rng(seed).uniform([0.2, -0.5, 0.7], [0.8, 0.1, 1.3], (k, 3))


@pytest.mark.parametrize("k", [3, 4, 12])
def test_exact_markers_give_the_motion(k):
    rng = np.random.default_rng(k)
    twist = rng.uniform(-1, 1, (20, 6))
    before = np.stack([cloud(i, k) for i in range(20)])
    found = dp.algebra.screw_from_markers(before, spatial.transform_points(spatial.exp(twist), before))
    assert np.abs(spatial.log(found.dual_quaternion) - twist).max() < 1e-12
    assert found.noise.max() < 1e-13  # thin triangles amplify rounding
    assert found.residuals.shape == (20, k)
    want = spatial.screw_parameters(spatial.exp(twist))
    for name in ("angle", "distance", "axis", "point"):
        assert np.abs(getattr(found.screw, name) - getattr(want, name)).max() < 1e-11


def test_equilateral_and_square_markers_have_repeated_eigenvalues_and_are_no_exception():
    angles = np.arange(3) * 2 * np.pi / 3
    triangle = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1)
    x = spatial.exp([0.2, 0.9, -0.3, 0.1, 0.2, 0.3])
    assert (
        np.abs(dp.algebra.screw_from_markers(triangle, spatial.transform_points(x, triangle)).dual_quaternion - x).max()
        < 1e-14
    )


def test_noisy_markers_give_the_least_squares_motion():
    """Kabsch's rotation by singular values, and the translation from centre to centre."""
    rng = np.random.default_rng(3)
    before = cloud(3, 6)
    after = spatial.transform_points(spatial.exp([0.4, -0.2, 0.7, 0.3, 0.1, -0.2]), before)
    after = after + 0.01 * rng.standard_normal(after.shape)
    a, b = before - before.mean(0), after - after.mean(0)
    U, _, Vh = np.linalg.svd(b.T @ a)
    R = U @ np.diag([1, 1, np.linalg.det(U @ Vh)]) @ Vh
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, after.mean(0) - R @ before.mean(0)
    found = dp.algebra.screw_from_markers(before, after)
    assert np.abs(spatial.to_matrix(found.dual_quaternion) - T).max() < 1e-13
    assert 0.003 < found.noise < 0.03


def test_the_deviations_are_those_of_repeated_measurements():
    rng = np.random.default_rng(4)
    before, sigma = cloud(4, 8), 1e-3
    exact = spatial.transform_points(spatial.exp([0.1, 0.3, 0.8, 0.3, 0.1, -0.2]), before)
    found = dp.algebra.screw_from_markers(np.broadcast_to(before, (4000, 8, 3)),
                                          exact + sigma * rng.standard_normal((4000, 8, 3)))  # fmt: skip
    assert np.sqrt((found.noise**2).mean()) == pytest.approx(sigma, rel=0.02)
    for name in ("angle", "distance", "axis", "point"):
        measured = getattr(found.screw, name).std(axis=0)
        told = np.sqrt((found.deviations[name] ** 2).mean(axis=0))
        assert told == pytest.approx(measured, rel=0.06), name  # 1 / sqrt(2 * 4000) is 1 %


@pytest.mark.parametrize(("before", "after", "match"), [
    (np.zeros((2, 3)), np.zeros((2, 3)), "k >= 3"),
    (np.zeros((3, 3)), np.zeros((4, 3)), "one shape"),
    (np.outer(np.arange(4.0), [1, 2, 3]), np.outer(np.arange(4.0), [1, 2, 3]), "on one line"),
    (np.full((4, 3), np.nan), np.zeros((4, 3)), "finite"),
])  # fmt: skip
def test_markers_that_fix_no_motion_are_refused(before, after, match):
    with pytest.raises(dp.DualpinError, match=match):
        dp.algebra.screw_from_markers(before, after)
