"""Dual numbers and arrays: golden values, derivatives, NumPy's ways, and errors that say where."""

from __future__ import annotations

import operator

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import dualpin as dp
from dualpin import Dual
from dualpin import dual as functions
from dualpin.scalars import ZERO
from tests.golden import REFERENCE, close, dual

GOLDEN = {
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "exp": np.exp, "atan": np.arctan, "sinh": np.sinh,
    "pow3": lambda x: x**3, "pow_m2": lambda x: x**-2, "sqrt": np.sqrt, "log": np.log, "pow_2.5": lambda x: x**2.5,
    "cbrt": np.cbrt, "asin": np.arcsin, "acos": np.arccos,
}  # fmt: skip


@pytest.mark.parametrize("case", REFERENCE["dual_scalar"], ids=lambda c: c["x"]["real"])
def test_golden_functions(case):
    x = dual(case["x"])
    for name, want in case["f"].items():
        close(GOLDEN[name](x), dual(want), 1e-14)
        close(GOLDEN[name](Dual(np.full(3, x.real), np.full(3, x.dual)))[1], dual(want), 1e-14)


ANALYTIC = {
    name: (ufunc, low, high)
    for name, ufunc, low, high in [
        ("sin", np.sin, -5, 5), ("cos", np.cos, -5, 5), ("tan", np.tan, -1.4, 1.4), ("exp", np.exp, -5, 5),
        ("log", np.log, 0.05, 9), ("sqrt", np.sqrt, 0.05, 9), ("sinh", np.sinh, -3, 3), ("cosh", np.cosh, -3, 3),
        ("tanh", np.tanh, -3, 3), ("asin", np.arcsin, -0.98, 0.98), ("acos", np.arccos, -0.98, 0.98),
        ("atan", np.arctan, -5, 5), ("asinh", np.arcsinh, -5, 5), ("atanh", np.arctanh, -0.98, 0.98),
        ("acosh", np.arccosh, 1.02, 9), ("expm1", np.expm1, -3, 3), ("log1p", np.log1p, -0.9, 9),
    ]
}  # fmt: skip


@pytest.mark.parametrize("name", ANALYTIC)
@settings(max_examples=40, deadline=None)
@given(st.floats(0, 1), st.floats(-3, 3))
def test_functions_against_derivatives_of_50_digits(name, where, b):
    ufunc, low, high = ANALYTIC[name]
    a = low + where * (high - low)
    f = {"expm1": mpmath.expm1, "log1p": mpmath.log1p}.get(name) or getattr(mpmath, name)
    with mpmath.workdps(50):
        value, slope = f(mpmath.mpf(a)), mpmath.diff(f, mpmath.mpf(a))
        want = Dual(float(value), float(slope * b))
    # the derivative of asin, acosh, ... near the end of its interval amplifies a's own rounding
    close(ufunc(Dual(a, b)), want, 1e-13)
    close(ufunc(Dual(np.array([a]), np.array([b])))[0], want, 1e-13)


@settings(max_examples=100, deadline=None)
@given(st.floats(-2, 2), st.floats(-2, 2))
def test_programs_against_the_complex_step(a, b):
    def f(x):
        return np.sin(x) * np.exp(x / 3) - x**3 / (1 + x * x) + np.sqrt(2 + np.cos(x))

    h = 1e-30
    want = f(complex(a, h * b))
    close(f(Dual(a, b)), Dual(want.real, want.imag / h), 1e-14)


@settings(max_examples=60, deadline=None)
@given(st.tuples(*[st.floats(-3, 3)] * 4).filter(lambda t: t[0] ** 2 + t[1] ** 2 > 0.01))
def test_atan2_is_the_angle(t):
    s, c, ds, dc = t
    angle = np.arctan2(Dual(s, ds), Dual(c, dc))
    size = np.sqrt(Dual(s, ds) ** 2 + Dual(c, dc) ** 2)
    close(np.sin(angle) * size, Dual(s, ds), 1e-12)
    close(np.cos(angle) * size, Dual(c, dc), 1e-12)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.1, 5), st.floats(-3, 3), st.floats(-3, 3), st.floats(-2, 2))
def test_powers_of_dual_exponent(a, b, n, dn):
    x, y = Dual(a, b), Dual(n, dn)
    close(x**y, np.exp(y * np.log(x)), 1e-12)
    close(a**y, np.exp(y * np.log(a)), 1e-12)


def test_integer_powers_at_zero():
    x = Dual(0.0, 2.0)
    assert x**0 == 1
    assert x**1 == x
    assert x**2 == 0
    assert Dual(0.0, 2.0) ** 1.5 == 0
    assert (Dual(ZERO, 2.0) ** 2).real is ZERO
    with pytest.raises(dp.DualDivisionError):
        x**-1


def test_parts_broadcast_and_lists_become_arrays():
    x = Dual([[1, 2, 3], [4, 5, 6]], [1, 1, 1])
    assert x.dual.shape == (2, 3)
    assert x.real.dtype == float
    assert Dual(np.ones(3), 0.5).dual.tolist() == [0.5] * 3
    assert Dual(2.0, np.ones(3)).real.tolist() == [2.0] * 3
    assert Dual([1.0, 2.0]).dual.tolist() == [0.0, 0.0]
    with pytest.raises(dp.ArgumentError, match="one shape"):
        Dual(np.ones(3), np.ones(2))
    with pytest.raises(dp.ArgumentError, match="numbers expected"):
        Dual(["a"], 0.0)


def test_known_zeros_stay_known():
    x = Dual(np.ones(3), ZERO)
    assert x.dual is ZERO
    assert (x * x).dual is ZERO
    assert (x + 1.0).dual is ZERO
    assert x.shape == (3,)
    assert x[1] == 1.0


def test_indexing_iteration_and_shape():
    x = Dual(np.arange(12.0).reshape(3, 4), -1.0)
    assert x.shape == (3, 4)
    assert (x.ndim, x.size, len(x)) == (2, 12, 3)
    assert x[None].shape == (1, 3, 4)
    assert x[..., None].shape == (3, 4, 1)
    assert x[1, 2] == Dual(6.0, -1.0)
    assert x[:, [0, 2]].shape == (3, 2)
    assert x[x.real > 5].shape == (6,)
    assert [r.shape for r in x] == [(4,)] * 3
    assert x.T.shape == (4, 3)
    assert x.reshape(2, 6).shape == x.reshape((2, 6)).shape == (2, 6)
    x[0, 0] = Dual(9.0, 8.0)
    assert x[0, 0] == Dual(9.0, 8.0)
    with pytest.raises(TypeError):
        len(Dual(1.0, 2.0))
    with pytest.raises(TypeError, match="not one array"):
        np.asarray(x)


def test_arithmetic_with_arrays_in_both_orders():
    a, x = np.array([1.0, 2.0, 4.0]), Dual([1.0, 2.0, 3.0], [0.5, 0.0, -1.0])
    for op in (operator.add, operator.sub, operator.mul, operator.truediv):
        left, right = op(a, x), op(x, a)
        assert isinstance(left, Dual)
        assert isinstance(right, Dual)
        for i in range(3):
            assert left[i] == op(float(a[i]), x[i])
            assert right[i] == op(x[i], float(a[i]))
    assert isinstance(np.float64(2.0) * x, Dual)
    assert np.all(np.multiply(a, x) == a * x)
    assert np.all(np.power(x, 2) == x * x)
    assert np.all(np.abs(-x) == x)
    assert (a[:, None] * x).shape == (3, 3)


def test_matrix_products():
    rng = np.random.default_rng(0)
    A, B = Dual(*rng.standard_normal((2, 5, 3, 4))), Dual(*rng.standard_normal((2, 4, 2)))
    C = A @ B
    assert C.shape == (5, 3, 2)
    close(C.dual, A.real @ B.dual + A.dual @ B.real)
    close(np.matmul(A, B), C)
    close(A.real @ B, Dual(A.real, 0.0) @ B)
    close(A @ B.real, A @ Dual(B.real, 0.0))
    close(np.einsum("bij,jk->bik", A, B), C)
    close(np.linalg.inv(Dual(2 * np.eye(3), 0.0)).real, np.eye(3) / 2)


def test_functions_of_arrays():
    x = Dual([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])
    assert np.sum(x) == Dual(6.0, 15.0)
    assert np.mean(x) == Dual(2.0, 5.0)
    assert np.stack([x, x]).shape == (2, 3)
    assert np.concatenate([x, [1.0]]).dual.tolist() == [4.0, 5.0, 6.0, 0.0]
    assert np.where([True, False, True], x, 0.0).dual.tolist() == [4.0, 0.0, 6.0]
    close(np.dot(x, x), (x * x).sum())
    close(np.cross(x, Dual([0.0, 0, 1], [1.0, 0, 0])).dual, np.cross(x.real, [1, 0, 0]) + np.cross(x.dual, [0, 0, 1]))
    assert np.shape(x) == (3,)
    with pytest.raises(TypeError):
        np.sort(x)


def test_comparison_of_parts_and_the_order_of_the_ring():
    assert Dual(1.0, 2.0) == Dual(1.0, 2.0)
    assert Dual(1.0, 2.0) != Dual(1.0, 3.0)
    assert Dual(1.0, 0.0) == 1.0
    assert Dual(1.0, 2.0) < Dual(1.0, 3.0) < Dual(1.1, -9.0)
    assert Dual(1.0, 2.0) > 1.0
    assert Dual(1.0, 2.0) >= Dual(1.0, 2.0) <= Dual(1.0, 2.0)
    x = Dual([1.0, 2.0], [0.0, 1.0])
    assert (x == Dual([1.0, 2.0], [0.0, 0.0])).tolist() == [True, False]
    assert (np.array([1.0, 2.0]) < x).tolist() == [False, True]
    assert (x > np.array([1.0, 2.0])).tolist() == [False, True]
    assert hash(Dual(1.0, 0.0)) == hash(1.0)
    with pytest.raises(dp.ArgumentError, match="neither true nor false"):
        bool(x)


def test_polar_and_exponential_forms():
    x = Dual(2.0, 3.0)
    rho, t = x.polar
    assert Dual.from_polar(rho, t) == x
    y = Dual(-0.5, 1.5)
    assert (x * y).polar[1] == pytest.approx(t + y.polar[1])  # products add t
    assert (x**3).polar[1] == pytest.approx(3 * t)  # powers multiply it
    close(2.0 * np.exp(Dual(0.0, t)), x)
    assert f"{x:polar}" == "2.0 (1 + 1.5 eps)"
    assert f"{x:exponential.2f}" == "2.00 exp(1.50 eps)"
    assert f"{x:.1f}" == f"{x:gaussian.1f}" == "2.0 + 3.0 eps"
    with pytest.raises(dp.DualDivisionError):
        _ = Dual(0.0, 1.0).polar


def test_complex_parts():
    z = Dual(1 + 2j, 3 - 1j)
    assert z.conj() == Dual(1 - 2j, 3 + 1j)
    assert z.dual_conjugate == Dual(1 + 2j, -3 + 1j)
    w = np.exp(z) / z + z**2
    h = 1e-6
    f = lambda x: np.exp(x) / x + x * x  # noqa: E731
    assert w.dual == pytest.approx((f(z.real + h * z.dual) - f(z.real - h * z.dual)) / (2 * h), rel=1e-8)
    close(np.sqrt(Dual(-4 + 0j, 1.0)), Dual(2j, 1 / 4j))
    assert abs(Dual(3 + 4j, 1.0)) == Dual(5.0, 0.6)


def test_mpmath_and_sympy_parts():
    x, y = sympy.symbols("x y")
    for f in (functions.sin, functions.sqrt, functions.atan, functions.log):
        value = f(Dual(x, y))
        assert sympy.simplify(value.dual - sympy.diff(value.real, x) * y) == 0
    assert np.sin(Dual(x, y)).dual == y * sympy.cos(x)
    assert (Dual(x, y) ** 3).dual == 3 * x**2 * y
    with mpmath.workdps(40):
        value = np.exp(Dual(mpmath.mpf(1), mpmath.mpf(2)))
        assert abs(value.dual - 2 * mpmath.e) < mpmath.mpf(10) ** -38


POLES = {
    "1 / eps": lambda: 1 / Dual(0.0, 1.0),
    "eps / eps": lambda: Dual(0.0, 1.0) / Dual(0.0, 2.0),
    "x / 0": lambda: Dual(1.0, 1.0) / 0,
    "sqrt(0)": lambda: np.sqrt(Dual(0.0, 1.0)),
    "log(0)": lambda: np.log(Dual(0.0, 1.0)),
    "asin(1)": lambda: np.arcsin(Dual(1.0, 1.0)),
    "asin(-1)": lambda: np.arcsin(Dual(-1.0, 1.0)),
    "acos(1)": lambda: np.arccos(Dual(1.0, 1.0)),
    "atan(i)": lambda: np.arctan(Dual(1j, 1.0)),
    "atanh(1)": lambda: np.arctanh(Dual(1.0, 1.0)),
    "cbrt(0)": lambda: np.cbrt(Dual(0.0, 1.0)),
    "0^(1/2)": lambda: Dual(0.0, 1.0) ** 0.5,
    "0^(-2)": lambda: Dual(0.0, 1.0) ** -2,
    "atan2(eps, eps)": lambda: np.arctan2(Dual(0.0, 1.0), Dual(0.0, 1.0)),
    "abs(eps)": lambda: abs(Dual(0.0, 1.0)),
    "sqrt(0) in mpmath": lambda: np.sqrt(Dual(mpmath.mpf(0), 1)),
    "sqrt(0) in SymPy": lambda: np.sqrt(Dual(sympy.Integer(0), 1)),
    "1 / eps in SymPy": lambda: 1 / Dual(sympy.Integer(0), sympy.Symbol("x")),
}


@pytest.mark.parametrize("name", POLES)
def test_what_has_no_dual_value_is_refused(name):
    with pytest.raises(dp.DualDivisionError) as e:
        POLES[name]()
    assert isinstance(e.value, ZeroDivisionError)


@pytest.mark.parametrize(
    ("f", "fine", "pole"),
    [
        (np.sqrt, 0.5, 0.0), (np.log, 0.5, 0.0), (np.reciprocal, 0.5, 0.0), (np.cbrt, 0.5, 0.0),
        (lambda x: x**0.5, 0.5, 0.0), (lambda x: x**-1, 0.5, 0.0), (np.arcsin, 0.5, -1.0), (np.arccos, 0.5, 1.0),
        (lambda x: 1 / x, 0.5, 0.0), (abs, 0.5, 0.0), (lambda x: np.arctan2(x, x), 0.5, 0.0),
    ],
)  # fmt: skip
def test_the_index_in_an_array_is_said(f, fine, pole):
    x = Dual([[fine, fine], [fine, pole]], 1.0)
    with pytest.raises(dp.DualDivisionError, match=r"index \(1, 1\)"):
        f(x)


def test_real_domains_are_said():
    for f in (np.sqrt, np.log, np.arcsin):
        with pytest.raises(dp.ArgumentError, match="complex parts"):
            f(Dual(-2.0, 1.0))
    with pytest.raises(dp.ArgumentError, match="complex parts"):
        Dual(-2.0, 1.0) ** 0.5


def test_symbols_pass_where_numbers_are_checked():
    x, y = sympy.symbols("x y")
    assert (1 / Dual(x, y)).dual == -y / x**2
    assert np.sqrt(Dual(x, y)).real == sympy.sqrt(x)


def test_nothing_is_written_into_foreign_arrays():
    with pytest.raises(TypeError):
        np.add(np.ones(2), Dual([1.0, 2.0]), out=np.zeros(2))


@pytest.mark.parametrize("f", [operator.add, operator.sub, operator.mul, operator.truediv, operator.matmul])
@pytest.mark.parametrize("swap", [False, True])
def test_shapes_that_do_not_fit_are_said(f, swap):
    a, b = Dual(np.ones(3), np.ones(3)), Dual(np.ones(2), np.ones(2))
    with pytest.raises(dp.ShapeError, match=r"\(\d,\) and \(\d,\)"):
        f(b, a) if swap else f(a, b)
    with pytest.raises(dp.ShapeError):
        f(np.ones(2), a) if swap else f(a, np.ones(2))


def test_a_dual_exponent_needs_a_positive_base():
    for base in (Dual(-0.5, 3.0), Dual(0.0, 1.0), -2.0, Dual([1.0, -1.0], 1.0)):
        with pytest.raises(dp.ArgumentError, match="positive base"):
            base ** Dual(2.0, 1.0)
    assert Dual(-0.5, 3.0) ** Dual(2.0, 0.0) == Dual(0.25, -3.0)


def test_arrays_of_objects_hold_dual_numbers():
    c, s = np.cos(Dual(0.3, 0.7)), np.sin(Dual(0.3, 0.7))
    R = np.array([[c, -s], [s, c]], dtype=object)
    assert R.shape == (2, 2)
    unit = R @ R.T
    assert abs(unit[0, 0].real - 1) < 1e-15
    assert abs(unit[0, 0].dual) < 1e-15
    whole = np.asarray(Dual([1.0, 2.0], [3.0, 4.0]), dtype=object)
    assert whole[1] == Dual(2.0, 4.0)
    with pytest.raises(dp.ArgumentError, match="dtype=object"):
        np.asarray(Dual([1.0, 2.0], [3.0, 4.0]))
    with pytest.raises(TypeError):
        np.asarray(Dual(1.0, 2.0))
    with pytest.raises(dp.DualpinError, match="dual array"):
        dp.fk(dp.from_dh([(0, 0, 1, 0)], joints="R"), Dual([0.0], [1.0]))


def test_closeness_compares_both_parts():
    x = Dual([1.0, 2.0], [3.0, 4.0])
    assert np.allclose(x, x + 1e-12)
    assert not np.allclose(x, x + Dual(0.0, 1.0))
    assert np.isclose(x, Dual([1.0, 2.0], [3.0, 5.0])).tolist() == [True, False]
    assert np.round(Dual(1.26, 2.34), 1) == Dual(1.3, 2.3)
    assert np.fabs(Dual(-1.0, 2.0)) == Dual(1.0, -2.0)


@pytest.mark.parametrize("f", [np.sqrt, np.log, np.arcsin])
def test_real_domains_are_said_of_arrays_too(f):
    with pytest.raises(dp.ArgumentError, match=r"at index \(1,\): no real value"):
        f(Dual([0.5, -2.0], 1.0))
    assert np.isnan(f(Dual([np.nan, 0.5], 1.0)).real[0])


def test_unequal_entries():
    x = Dual([1.0, 2.0], [3.0, 4.0])
    assert (x != Dual([1.0, 2.0], [3.0, 5.0])).tolist() == [False, True]
    assert Dual(1.0, 2.0) != Dual(1.0, 3.0)
    assert Dual(1.0, 2.0) == Dual(1.0, 2.0)


def test_powers_of_every_kind_of_exponent():
    x = Dual([0.0, 2.0, -3.0], [1.0, 5.0, 7.0])
    for n in ([0, 2, 3], np.array([0, 2, 3])):
        assert (x**n).real.tolist() == [1, 4, -27]
        assert (x**n).dual.tolist() == [0, 20, 189]
    assert Dual(np.int64(2), np.int64(3)) ** -1 == Dual(0.5, -0.75)


@pytest.mark.parametrize("parts", [("1", 2.0), (None, 1.0), (1.0, "x"), (1.0, None)])
def test_parts_are_numbers(parts):
    with pytest.raises(dp.ArgumentError, match="number"):
        Dual(*parts)
