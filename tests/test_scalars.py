"""Scalars of every kind through the same functions: floats, complex, arrays, mpmath, SymPy, exact constants."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
import sympy as sp

import dualpin as dp
from dualpin.dual import Dual, atan2, cos_sin, sin, sqrt, stumpff
from dualpin.scalars import ONE, ZERO, Exact, exact, library, register

MINUS = -ONE
EXACTS = (MINUS, ZERO, ONE)
OTHERS = (2.5, -3, np.array([1.5, -2.0]), mpmath.mpf("0.1"), sp.Symbol("x"), 1 + 2j, Dual(2.0, 3.0))


@pytest.mark.parametrize("n", EXACTS, ids=repr)
@pytest.mark.parametrize("x", OTHERS, ids=lambda x: type(x).__name__)
def test_exact_constants_compute_like_the_numbers_they_are(n, x):
    def same(a, b):
        a, b = ((y.real, y.dual) if type(y) is Dual else (y,) for y in (a, b))
        a, b = (tuple(y) + (0,) * (2 - len(y)) for y in (a, b))
        return all(np.all(p == q) for p, q in zip(a, b, strict=True))

    i = n.n
    assert same(n + x, i + x) and same(x + n, x + i)
    assert same(n - x, i - x) and same(x - n, x - i)
    assert same(n * x, i * x) and same(x * n, x * i)
    assert same(n / x, i / x)
    if i:
        assert same(x / n, x / i)


@pytest.mark.parametrize("a", EXACTS, ids=repr)
@pytest.mark.parametrize("b", EXACTS, ids=repr)
def test_exact_constants_are_closed_and_ordered(a, b):
    for result, expected in ((a + b, a.n + b.n), (a - b, a.n - b.n), (a * b, a.n * b.n), (-a, -a.n)):
        assert result == expected
        assert (type(result) is Exact) == (expected in (-1, 0, 1))
    assert (a < b) == (a.n < b.n) and (a > b) == (a.n > b.n) and (a == b) == (a.n == b.n)
    assert hash(a) == hash(a.n) and float(a) == a.n
    if b.n:
        assert a / b == a.n / b.n


def test_known_zeros_annihilate_and_cost_nothing():
    x = np.array([1.0, np.nan])
    assert ZERO * x is ZERO and 2.5 * ZERO is ZERO and ZERO / 3.0 is ZERO
    assert ZERO + x is x and x - ZERO is x and ONE * x is x and x * ONE is x
    for y in (1.0, np.ones(2), ONE, ZERO):  # a division by a known zero is not finite, as with arrays
        assert not np.isfinite(np.asarray(y / ZERO, dtype=float)).any()


def test_exact_recognises_minus_one_zero_and_one_only():
    assert exact(0.0) is ZERO and exact(-0.0) is ZERO and exact(1) is ONE and exact(-1.0) is MINUS
    for x in (0.5, 2, 1e-300, math.nan, math.inf, sp.Integer(1), mpmath.mpf(1)):
        assert exact(x) is x


# --- Stumpff's functions -------------------------------------------------------------------------

ARGUMENTS = [0.0, 1e-300, 1e-20, 1e-9, 1e-3, 0.5, 0.999999, 1.0, 1.000001, 3.0, math.pi**2, 30.0, 400.0]


@pytest.mark.parametrize("k", range(4))
@pytest.mark.parametrize("y", ARGUMENTS)
def test_stumpff_functions_are_their_series_for_every_scalar(k, y):
    with mpmath.workdps(60):
        m = mpmath.mpf(y)
        truth = mpmath.nsum(lambda i: (-m) ** int(i) / mpmath.factorial(2 * int(i) + k), [0, 120])
        assert abs(stumpff(k, m) - truth) < mpmath.mpf(10) ** -45
        # the closed forms are taken from y = 1 on, where they lose at most 1/c_k(1) = 6 roundings
        for value in (
            stumpff(k, y),
            stumpff(k, np.array([y, 0.1]))[0],
            stumpff(k, np.float64(y)),
            stumpff(k, complex(y)),
        ):
            assert abs(complex(value).real - float(truth)) < 2e-15 and complex(value).imag == 0
        if y == 0 or y > 1e-10:  # closed forms of symbols; evaluating them at smaller numbers is SymPy's subject
            assert abs(sp.N(stumpff(k, sp.Rational(y)), 30) - float(truth)) < 2e-15


@pytest.mark.parametrize("k", range(2))
@pytest.mark.parametrize("y", ARGUMENTS)
def test_stumpff_derivatives(k, y):
    """c_k' = (k c_{k+2} - c_{k+1}) / 2, and what a dual argument gives."""
    found = stumpff(k, Dual(y, 1.0)).dual
    with mpmath.workdps(60):
        m = mpmath.mpf(y)
        slope = mpmath.nsum(lambda i: -i * (-m) ** (int(i) - 1) / mpmath.factorial(2 * int(i) + k), [1, 120])
    assert abs(found - float(slope)) < 2e-15


@pytest.mark.parametrize("k", range(4))
def test_stumpff_at_a_known_zero(k):
    assert float(stumpff(k, ZERO)) == 1 / math.factorial(k)


# --- libraries -----------------------------------------------------------------------------------


def test_every_kind_of_number_knows_its_sine():
    x = 0.3
    expected = math.sin(x)
    for y in (x, np.float64(x), np.float32(x), np.array([x]), mpmath.mpf(x), sp.Float(x), complex(x)):
        assert abs(complex(np.ravel(sin(y))[0]).real - expected) < 1e-7
    assert sin(1) == math.sin(1) and sin(np.int64(1)) == math.sin(1)
    assert sin(ZERO) is ZERO and cos_sin(ZERO) == (ONE, ZERO)
    assert sin(sp.Symbol("x")) == sp.sin(sp.Symbol("x"))


def test_atan2_of_every_kind():
    for kind in (float, np.float64, mpmath.mpf, sp.Float, lambda x: np.array([x])):
        for y, x in ((1.0, 2.0), (1.0, -2.0), (-1.0, -2.0), (0.0, -1.0)):
            assert abs(float(np.ravel(atan2(kind(y), kind(x)))[0]) - math.atan2(y, x)) < 1e-15
    assert float(atan2(ZERO, ONE)) == 0.0 and float(atan2(ONE, 0.0)) == math.pi / 2
    assert np.allclose(atan2(ONE, np.array([1.0, 0.0])), [math.pi / 4, math.pi / 2])


def test_what_is_no_scalar_is_named():
    with pytest.raises(dp.DualpinError, match="no elementary functions are known for str"):
        sqrt("4")
    with pytest.raises(dp.DualpinError, match="register"):
        sin(object())


def test_new_kinds_can_be_registered():
    class Degrees(float):
        pass

    class Library:
        @staticmethod
        def sin(x):
            return math.sin(math.radians(x))

    register(Degrees, Library)
    assert sin(Degrees(90)) == 1.0
    assert library(1.0).sin is math.sin
