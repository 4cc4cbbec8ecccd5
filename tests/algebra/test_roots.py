"""Roots of dual polynomials and systems."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import dualpin as dp
from tests.golden import REFERENCE, close, numbers

al = dp.algebra


@pytest.mark.parametrize("case", REFERENCE["polynomials"], ids=lambda c: c["name"])
def test_golden_roots(case):
    x = al.polyroots(dp.Dual(numbers(case["coeff_real_ascending"]), numbers(case["coeff_dual_ascending"])))
    want = [dp.Dual(complex(*numbers(r["real"])), complex(*numbers(r["dual"]))) for r in case["roots"]]
    want = np.stack(sorted(want, key=lambda r: (r.real.real, r.real.imag)))
    close(x.astype(complex), want)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(-6, 6), min_size=1, max_size=5, unique=True), st.integers(0, 2**32 - 1))
def test_roots_of_products_of_dual_factors(real, seed):
    rng = np.random.default_rng(seed)
    want = dp.Dual(np.sort(np.array(real, float)), rng.standard_normal(len(real)))
    c = dp.Dual([1.0], [0.0])
    for r in want:  # times (x - r)
        shifted = np.concatenate([dp.Dual([0.0], [0.0]), c])
        c = shifted - np.concatenate([c, dp.Dual([0.0], [0.0])]) * r
    got = al.polyroots(c * dp.Dual(2.0, -3.0))
    close(got, want, 1e-9)  # Wilkinson: the condition of roots spaced by one grows like the binomials
    assert np.abs(al.polyval(got, c).real).max() < 1e-6


def test_roots_of_a_batch():
    rng = np.random.default_rng(0)
    c = dp.Dual(*rng.standard_normal((2, 4, 3, 5)))
    x = al.polyroots(c)
    value = al.polyval(x, c[..., None, :])
    assert max(np.abs(value.real).max(), np.abs(value.dual).max()) < 1e-10


def test_repeated_roots_are_refused_with_the_reason():
    with pytest.raises(al.AssumptionError, match="no finite dual part"):
        al.polyroots(dp.Dual([1.0, -2.0, 1.0], [1.0, 0.0, 0.0]))
    with pytest.raises(al.AssumptionError, match="every dual part"):
        al.polyroots(dp.Dual([1.0, -2.0, 1.0], [0.0, 0.0, 0.0]))
    with pytest.raises(al.SingularError, match="infinity"):
        al.polyroots(dp.Dual([1.0, -2.0, 0.0], [0.0, 0.0, 1.0]))
    with pytest.raises(dp.ArgumentError, match="degree"):
        al.polyroots([1.0, 0.0])


def test_newton_is_exact_in_its_derivatives():
    f = lambda x: np.exp(x) * np.sin(x) - dp.Dual(0.7, 0.2) * x**3 + np.arctan(x) / (1 + x * x) - dp.Dual(1.0, 3.0)  # noqa: E731
    r = al.newton(f, dp.Dual(0.8, 0.0))
    assert r.converged
    assert r.residual < 1e-14
    assert r.iterations <= 8
    value = f(r.x)
    assert abs(value.real) < 1e-14
    assert abs(value.dual) < 1e-13


def test_newton_for_systems_square_and_not():
    def f(x):
        y, z = x
        return [y * y + z * z - dp.Dual(4.0, 1.0), y - np.cos(z) * dp.Dual(1.0, 0.5)]

    r = al.newton(f, [dp.Dual(1.0, 0.0), dp.Dual(1.5, 0.0)])
    assert r.residual < 1e-13
    over = al.newton(lambda x: [*f(x), 2 * f(x)[0]], [1.0, 1.5])
    close(over.x, r.x, 1e-12)


def test_newton_keeps_the_dual_part_of_real_unknowns():
    # 2 + 0.7 eps and the real number 3: a generalised inverse would not keep the 3 real
    f = lambda x: [x[0] * x[1] - dp.Dual(6.0, 2.1), x[0] * x[0] + x[1] - dp.Dual(7.0, 2.8)]  # noqa: E731
    r = al.newton(f, [dp.Dual(1.5, 0.0), dp.Dual(3.5, 0.0)], real_only=[1])
    close(r.x, dp.Dual([2.0, 3.0], [0.7, 0.0]), 1e-13)
    assert float(r.x.dual[1]) == 0.0


def test_newton_says_why_it_stopped():
    with pytest.raises(al.SingularError):
        al.newton(lambda x: x * x - 1, dp.Dual(0.0, 1.0))
    with pytest.raises(al.AssumptionError, match="not converged"):
        al.newton(lambda x: x * x + 1, dp.Dual(0.3, 1.0), max_iterations=20)


def test_newton_takes_a_given_derivative():
    r = al.newton(lambda x: np.sin(x), dp.Dual(3.0, 0.1), jacobian=np.cos)
    close(r.x, dp.Dual(np.pi, 0.0), 1e-14)
