"""Roots of dual polynomials and systems."""

from __future__ import annotations

import warnings
from fractions import Fraction

import mpmath
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


def _expanded(roots):
    """Coefficients of a product of (x - r), in the numbers that the roots are."""
    c = [1]
    for r in roots:
        c = [a - r * b for a, b in zip([0, *c], [*c, 0], strict=True)]
    return c


def test_wilkinsons_polynomial_keeps_its_digits():
    c = _expanded(range(1, 21))
    assert max(map(abs, c)) > 2**63  # doubles and NumPy's integers would round some of them
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        x = al.polyroots(c)
    np.testing.assert_array_equal(x.real, np.arange(1.0, 21.0))
    # coefficients that are rounded to doubles have other roots; these are found with fifty digits
    with pytest.warns(dp.DualpinWarning, match="leaves the root 14.0005 about 2 digits"):
        rounded = al.polyroots([float(k) for k in c])
    with mpmath.workdps(80):
        want = mpmath.polyroots([mpmath.mpf(float(k)) for k in c[::-1]], maxsteps=500, extraprec=300)
    np.testing.assert_allclose(rounded.real, [float(r) for r in want], rtol=1e-15)
    assert np.abs(rounded.real - np.arange(1, 21)).max() > 1e-4


@settings(max_examples=20, deadline=None)
@given(st.lists(st.floats(0.1, 3.0), min_size=2, max_size=5, unique=True), st.integers(2, 3))
def test_a_multiple_root_is_refused_and_a_near_one_is_not(roots, times):
    roots = [round(r, 1) for r in roots]
    alone = [r for r in dict.fromkeys(roots) if r != roots[0]]
    with pytest.raises(al.AssumptionError, match="repeated"):
        al.polyroots(np.polynomial.polynomial.polyfromroots([roots[0]] * times + alone))
    near = sorted([roots[0], roots[0] + 2.0**-16, *alone])
    c = _expanded([Fraction(r) for r in near])
    scale = max(k.denominator for k in c)
    x = al.polyroots([int(k * scale) for k in c])
    np.testing.assert_allclose(x.real, near, rtol=1e-14)


def test_the_kind_of_a_result_depends_on_its_roots_alone():
    """Real where all are real and complex where one is not, with any version of NumPy."""
    assert al.polyroots([6.0, -5.0, 1.0]).real.dtype == float
    assert al.polyroots([1.0, 0.0, 1.0]).real.dtype == complex
    assert al.polyroots([[1.0, 0.0, 1.0], [6.0, -5.0, 1.0]]).dual.dtype == complex
    w, V = al.eig([[2.0, 1.0], [1.0, 3.0]])
    assert {x.dtype for x in (w.real, w.dual, V.real, V.dual)} == {np.dtype(float)}
    assert al.eigvals([[0.0, -1.0], [1.0, 0.0]]).real.dtype == complex
    assert al.eigvals(np.eye(1, dtype=complex)).real.dtype == complex
