"""Numbers whose squares leave the doubles: results that are doubles come out all the same."""

from __future__ import annotations

from decimal import Decimal

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import dualpin as dp
from tests.golden import close

al = dp.algebra
SIZES = [1e-200, 1e-160, 1e160, 1e200]


@settings(max_examples=100, deadline=None)
@given(st.integers(-300, 300), st.integers(0, 2**32 - 1))
def test_the_norm_is_that_of_fifty_digits(exponent, seed):
    rng = np.random.default_rng(seed)
    a, b = 10.0**exponent * rng.standard_normal(4), rng.standard_normal(4)
    with mpmath.workdps(50):
        exact, along = [mpmath.mpf(float(x)) for x in a], [mpmath.mpf(float(x)) for x in b]
        size = mpmath.sqrt(sum(x * x for x in exact))
        slope = sum(x * y for x, y in zip(exact, along, strict=True)) / size
    n = al.norm(dp.Dual(a, b))
    assert float(n.real) == pytest.approx(float(size), rel=1e-15)
    assert float(n.dual) == pytest.approx(float(slope), rel=1e-13, abs=1e-15)


def test_norms_along_axes_and_of_nothing():
    a = np.array([[3.0, 0.0], [4.0, 0.0]]) * 1e200
    assert al.norm(a, axis=0).real == pytest.approx([5e200, 0.0], rel=1e-15)
    assert al.norm(a, axis=(0, 1), keepdims=True).shape == (1, 1)
    assert al.norm(np.zeros(0)).real == 0.0
    assert al.norm(np.array([3e-320, 4e-320])).real == pytest.approx(5e-320)


@pytest.mark.parametrize("size", SIZES)
def test_angles_lengths_and_moduli_scale(size):
    x, y = dp.Dual(3.0 * size, 0.3 * size), dp.Dual(4.0 * size, -0.2 * size)
    r, angle = np.hypot(x, y), np.arctan2(y, x)
    assert r.real == pytest.approx(5 * size) and r.dual == pytest.approx((0.9 - 0.8) / 5 * size)
    assert angle.dual == pytest.approx((-0.2 * 3 - 0.3 * 4) / 25)
    z = abs(dp.Dual(complex(3 * size, 4 * size), complex(1.0, 2.0)))
    assert z.real == pytest.approx(5 * size) and z.dual == pytest.approx((3 + 8) / 5)
    many = abs(dp.Dual(np.array([complex(3 * size, 4 * size)]), np.array([1 + 2j])))
    assert many.dual[0] == pytest.approx(11 / 5)


@pytest.mark.parametrize("size", SIZES)
def test_motors_scale(size):
    m = al.Motor(np.array([0.0, 0.0, 2.0]) * size, np.array([0.0, -2.0, 3.0]) * size)
    assert m.point == pytest.approx([1.0, 0.0, 0.0]) and m.pitch == pytest.approx(1.5)
    assert m.magnitude.real == pytest.approx(2 * size) and m.magnitude.dual == pytest.approx(3 * size)
    assert m.direction == pytest.approx([0.0, 0.0, 1.0]) and str(m.kind) == "screw"
    assert m.axis.dual == pytest.approx([0.0, -1.0, 0.0])
    assert al.line([0.0, 1.0, 0.0], np.array([3.0, 4.0, 0.0]) * size).real == pytest.approx([0.6, 0.8, 0.0])
    s = al.screw_sum(np.array([0, 0, 1, 0, 0, 0]) * size, np.array([0, 1, 0, 0, 0, 1]) * size)
    assert s.magnitude.real == pytest.approx(np.sqrt(2) * size) and s.alpha1.dual == pytest.approx(-0.5)


@pytest.mark.parametrize("size", SIZES)
def test_factorisations_scale(size):
    A = dp.Dual([[1.0, 3.0], [2.0, 1.0], [6.0, 8.0]], [[1.0, 5.0], [0.0, 1.0], [4.0, 2.0]])
    (U, S, Vh), (u, s, vh) = al.svd(A), al.svd(A * size)
    close(u, U)
    close(vh, Vh)
    close(s / size, S)
    (Q, R), (q, r) = al.qr(A), al.qr(A * size)
    close(q, Q)
    close(r / size, R)
    B = dp.Dual([[2.0, 1.0], [1.0, 3.0]], [[1.0, -1.0], [2.0, 4.0]])
    (w, V), (x, v) = al.eig(B), al.eig(B * size)
    close(v, V)
    close(x / size, w)
    close(al.pinv(A * size) * size, al.pinv(A))


def test_numbers_print_as_numbers():
    assert repr(dp.Dual(Decimal("0.1"), Decimal(2)) * 2) == "Dual(0.2, 4)"
    assert repr(dp.Dual(np.float32(0.1), np.float64(0.25))) == "Dual(0.1, 0.25)"
    assert repr(dp.Dual(np.int64(3), 1.0)) == "Dual(3, 1.0)"
