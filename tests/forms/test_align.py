"""One step of the conversion: dual spherical coordinates of a line."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dualpin.dual import Dual
from dualpin.forms.align import Rules, step
from dualpin.spatial import UZ, Pose, Vector3, motor
from dualpin.spatial.vector import ZERO_VECTOR

angle = st.floats(-3.1, 3.1)
length = st.floats(-3, 3)


def line(azimuth: float, polar: float, x: float, y: float, z: float) -> Vector3:
    u = Vector3(np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar))
    return motor(u, Vector3(x, y, z).cross(u))


def carried(steps: list) -> Vector3:
    X = Pose()
    for theta, alpha in steps:
        X = X @ Pose.dh(theta, alpha)
    return X @ motor(UZ, ZERO_VECTOR)


def distance(a: Vector3, b: Vector3) -> float:
    parts = (*(a - b).real, *(a - b).dual)
    return max(abs(float(x)) for x in parts)


@given(angle, st.floats(0.03, 3.1), length, length, length)
def test_azimuth_and_polar_angle_carry_the_z_axis_to_any_line(
    azimuth: float, polar: float, x: float, y: float, z: float
) -> None:
    target = line(azimuth, polar, x, y, z)
    steps = step(target, Rules())
    assert len(steps) == 1
    # metres, a few eps, and 1 / 0.03 from the division by the sine
    assert distance(carried(steps), target) <= 1e-12
    theta, _ = steps[0]
    assert abs(theta.real) <= pi / 2 + 1e-8  # the nearer of the two directions of x


@given(angle, st.floats(-13, -2), st.sampled_from([0.0, pi]), length, length, length)
def test_nearly_parallel_lines_take_two_steps_with_short_lengths(
    azimuth: float, exponent: float, pole: float, x: float, y: float, z: float
) -> None:
    target = line(azimuth, pole + 10.0**exponent, x, y, z)
    steps = step(target, Rules())
    assert len(steps) == 2
    assert distance(carried(steps), target) <= 1e-12
    assert all(theta.dual == 0 and abs(alpha.dual) <= 5 for theta, alpha in steps)


@pytest.mark.parametrize("pole", [0.0, pi])
def test_parallel_lines_have_no_offset_and_exact_twist(pole: float) -> None:
    ((theta, alpha),) = step(line(0.0, pole, 0.3, -0.4, 0.7), Rules())
    assert (theta.dual, alpha.real) == (0.0, pole)
    assert alpha.dual == pytest.approx(0.5, abs=1e-15)
    ((theta, alpha),) = step(line(0.0, pole, 0.0, 0.0, 0.7), Rules())
    assert (theta.real, theta.dual, alpha.dual) == (0, 0, 0)


def test_rounding_noise_is_removed_and_nothing_else() -> None:
    rules = Rules()
    clean = rules.cleaned(Dual(pi / 2 + 4e-16, 9e-16))
    assert (clean.real, clean.dual) == (pi / 2, 0.0)
    kept = rules.cleaned(Dual(pi / 2 + 5e-15, 2e-15))
    assert (kept.real, kept.dual) == (pi / 2 + 5e-15, 2e-15)
