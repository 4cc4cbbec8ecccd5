"""Methods are what they declare: consistent, of their order, stable up to their limit."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.integrators import METHODS, CrouchGrossman, Mechanical, PredictorCorrector, Reference, RungeKutta, solve

STEPPED = [m.name for m in METHODS.values() if not isinstance(m, (Mechanical, Reference))]
FIXED = [name for name in STEPPED if name != "rk45"]
SPAN = 2.0


def swing(t, y):
    """A nonlinear, time-dependent rate of two coordinates."""
    return np.stack([y[..., 1] * np.cos(t), -np.sin(y[..., 0])], axis=-1)


@pytest.fixture(scope="module")
def truth():
    return solve(swing, [1.0, 0.5], method="DOP853", dt=SPAN, t_end=SPAN, rtol=1e-13, atol=1e-14).y[-1]


def fitted_order(method, truth, steps, **options):
    errors = [
        np.abs(solve(swing, [1.0, 0.5], method=method, dt=SPAN / n, t_end=SPAN, **options).y[-1] - truth).max()
        for n in steps
    ]
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("name", FIXED)
def test_the_fitted_order_is_the_declared_one(name, truth):
    steps = (128, 256, 512) if METHODS[name].order < 3 else (64, 128, 256)
    assert fitted_order(name, truth, steps, startup="rk4") == pytest.approx(METHODS[name].order, abs=0.1)


def test_abm4_with_the_papers_start_up_is_of_order_three(truth):
    # the first step, Euler and trapezoid, has a local error O(dt^3)
    assert fitted_order("abm4", truth, (64, 128, 256), startup="paper") == pytest.approx(3, abs=0.1)
    assert METHODS["abm4"].startup_order == 3


def test_trapezoidal_needs_no_start_up(truth):
    assert fitted_order("trapezoidal", truth, (128, 256, 512), startup="paper") == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("name", STEPPED)
def test_the_declared_stability_limit_is_that_of_the_coefficients(name):
    # declared to ten digits; the bisection stops at 1e-12
    assert dp.integrators.stability_limit(name) == pytest.approx(METHODS[name].stability_limit, rel=1e-10)


@pytest.mark.parametrize(("name", "limit"), [("euler", 2.0), ("trapezoidal", 2.0), ("abm4", 1.285), ("rk4", 2.785)])
def test_stability_limits_agree_with_the_literature(name, limit):
    assert dp.integrators.stability_limit(name) == pytest.approx(limit, rel=0.01)


def test_adams_bashforth_alone_is_stable_up_to_three_tenths():
    ab4 = PredictorCorrector(
        "ab4", "Adams-Bashforth", 4, 0.3, "", predictors=METHODS["abm4"].predictors,
        correctors=tuple((0.0, *row) for row in METHODS["abm4"].predictors),
    )  # fmt: skip
    assert dp.integrators.stability_limit(ab4) == pytest.approx(0.3, rel=1e-6)


@pytest.mark.parametrize("name", STEPPED)
def test_weights_are_consistent(name):
    method = METHODS[name]
    rows = [method.b] if isinstance(method, (RungeKutta, CrouchGrossman)) else [*method.predictors, *method.correctors]
    for row in rows:
        assert sum(row) == pytest.approx(1.0, abs=1e-12)  # a constant rate is integrated exactly


def test_dense_output_ends_where_the_step_ends():
    rk45 = METHODS["rk45"]
    assert np.allclose(np.sum(rk45.dense, axis=1), rk45.b, rtol=0, atol=1e-14)
    assert sum(rk45.error) == pytest.approx(0.0, abs=1e-15)


def test_dense_output_is_as_good_as_the_steps(truth):
    fine = solve(swing, [1.0, 0.5], method="DOP853", dt=0.01, t_end=SPAN, rtol=1e-13, atol=1e-14)
    run = solve(swing, [1.0, 0.5], method="rk45", dt=0.01, t_end=SPAN, rtol=1e-8, atol=1e-10)
    assert run.cost.steps < 60  # far fewer than the 200 values asked for
    assert np.abs(run.y - fine.y).max() < 1e-6  # the interpolant is of order four, the tolerance 1e-8


def test_rk45_keeps_to_its_tolerance(truth):
    errors = [np.abs(solve(swing, [1.0, 0.5], method="rk45", dt=SPAN, t_end=SPAN, rtol=r, atol=r).y[-1] - truth).max()
              for r in (1e-5, 1e-7, 1e-9, 1e-11)]  # fmt: skip
    assert all(e < 30 * r for e, r in zip(errors, (1e-5, 1e-7, 1e-9, 1e-11), strict=True))
    assert errors == sorted(errors, reverse=True)


@pytest.mark.parametrize("name", ["DOP853", "Radau", "LSODA"])
def test_scipy_plugs_in(name, truth):
    run = solve(swing, [1.0, 0.5], method=name, dt=0.5, t_end=SPAN, rtol=1e-10, atol=1e-12)
    assert run.y.shape == (5, 2)
    assert np.abs(run.y[-1] - truth).max() < 1e-7


@pytest.mark.parametrize("name", STEPPED)
def test_a_batch_is_its_members(name):
    starts = np.random.default_rng(0).normal(size=(2, 3, 2))
    together = solve(swing, starts, method=name, dt=0.1, t_end=1.0, rtol=1e-12, atol=1e-13)
    assert together.y.shape == (2, 3, 11, 2)
    alone = solve(swing, starts[1, 2], method=name, dt=0.1, t_end=1.0, rtol=1e-12, atol=1e-13)
    # the adaptive method takes the batch's common step: equal to its tolerance only
    assert np.abs(together.y[1, 2] - alone.y).max() < (1e-9 if name == "rk45" else 1e-15)


@pytest.mark.parametrize(
    ("name", "evaluations"), [("euler", 1), ("trapezoidal", 2), ("abm4", 2), ("rk4", 4), ("heun", 2)]
)
def test_evaluations_are_counted(name, evaluations):
    calls = []

    def rate(t, y):
        calls.append(t)
        return -y

    run = solve(rate, [1.0], method=name, dt=0.1, t_end=1.0)
    assert run.cost.evaluations == len(calls) == 10 * evaluations


BAD = [
    ({"dt": 0.0}, "dt = 0.0 s, a positive step"),
    ({"dt": -0.1}, "dt = -0.1 s, a positive step"),
    ({"dt": float("nan")}, "dt = nan"),
    ({"t_end": -1.0}, "t_end = -1.0 s, a duration"),
    ({"dt": 0.3}, "the nearest are 0.9 and 1.2"),
    ({"dt": "0.1"}, "dt = '0.1'"),
    ({"method": "rk5"}, "did you mean 'rk4"),
    ({"method": "DOP835"}, "did you mean 'DOP853'"),
    ({"method": "variational"}, "dualpin.simulate takes it"),
    ({"startup": "papr"}, "did you mean 'paper'"),
    ({"y0": [np.nan]}, "finite entries"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
def test_bad_input_is_named(change, message):
    arguments = {"y0": [1.0], "method": "rk4", "dt": 0.1, "t_end": 1.0, **change}
    with pytest.raises(dp.DualpinError) as caught:
        solve(lambda t, y: -y, arguments.pop("y0"), **arguments)
    assert message in str(caught.value)


def test_a_rate_of_the_wrong_shape_is_named():
    with pytest.raises(dp.ShapeError, match=r"f\(t, y\) of shape"):
        solve(lambda t, y: np.zeros((3, 1)), [[1.0]], dt=0.1, t_end=1.0)


def test_no_steps_gives_the_start():
    assert solve(lambda t, y: -y, [1.0, 2.0], dt=0.1, t_end=0.0).y.tolist() == [[1.0, 2.0]]
