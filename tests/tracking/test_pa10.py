"""The PA-10 study: every run of the reference, the stability limits, the shape of the published claims."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp

from .arms import PA10_START, pa10

REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "reference.json").read_text())["pa10_tracking"]


def circle(task):
    t = REFERENCE["tasks"][task]
    return dp.Circle(t["radius"], t["period"], plane=t["plane"], start=np.radians(t["q0_deg"]))


def name_of(run):
    return f"{run['task']}-{run['method']}-dt{run['dt']}-K{run['K']}"


@pytest.mark.parametrize("engine", ["auto", "numpy"])
@pytest.mark.parametrize("run", REFERENCE["runs"], ids=name_of)
def test_reference_run_is_reproduced(run, engine):
    found = dp.track(
        pa10(), circle(run["task"]), method=run["method"], dt=run["dt"], t_end=run["t_end"], gain=run["K"],
        startup=run["startup"], feedback="stage", engine=engine,
    )  # fmt: skip
    assert np.abs(found.q[-1] - np.array(run["q_end"], dtype=float)).max() < 1e-9
    assert found.position_error.max() == pytest.approx(run["pos_peak"], rel=0.01)
    assert found.orientation_error.max() == pytest.approx(run["ori_peak"], rel=0.01)
    rms = np.sqrt(np.mean(found.position_error**2)), np.sqrt(np.mean(found.orientation_error**2))
    assert rms == pytest.approx((run["pos_rms"], run["ori_rms"]), rel=0.05)  # over the instants with or without t = 0


# task, gain, feedback, dt -> peak position / orientation error of euler, trapezoidal, abm4, rk4, to two digits
TABLE = [
    ("A", 0, "stage", 0.01, "4.2e-3/5.6e-3 9.1e-7/8.7e-7 3.0e-9/4.1e-10 1.1e-12/3.5e-12"),
    ("A", 0, "stage", 0.1, "4.2e-2/5.9e-2 8.6e-5/9.2e-5 3.3e-6/9.0e-7 1.1e-8/3.5e-8"),
    ("A", 0, "stage", 1.0, "7.3e-1/2.3 3.9e-2/6.0e-2 5.7e-3/1.1e-2 1.4e-4/3.8e-4"),
    ("A", 1, "stage", 0.01, "3.6e-4/2.3e-4 1.8e-6/1.2e-6 1.2e-8/5.5e-9 7.6e-12/6.5e-12"),
    ("A", 1, "stage", 0.1, "3.6e-3/2.5e-3 1.9e-4/1.2e-4 1.2e-5/5.5e-6 8.0e-8/7.0e-8"),
    ("A", 1, "stage", 1.0, "5.5e-2/6.2e-2 2.8e-2/1.5e-2 3.0e-2/5.8e-2 1.3e-3/1.4e-3"),
    ("A", 1, "held", 1.0, "5.5e-2/6.2e-2 4.7e-3/4.9e-3 3.8e-3/7.8e-3 7.2e-5/1.3e-4"),
    ("B", 0, "stage", 0.01, "8.1e-4/2.0e-4 6.3e-7/3.7e-8 2.0e-9/6.2e-12 1.5e-13/1.3e-13"),
    ("B", 0, "stage", 0.1, "8.1e-3/2.0e-3 6.3e-5/3.8e-6 2.0e-6/7.3e-8 1.5e-9/1.3e-9"),
    ("B", 0, "stage", 1.0, "8.1e-2/2.3e-2 8.3e-3/2.0e-3 2.4e-3/7.6e-4 2.4e-5/1.4e-5"),
    ("B", 10, "stage", 0.1, "2.0e-4/3.4e-5 2.0e-4/3.3e-5 1.0e-4/1.9e-6 6.7e-6/1.1e-6"),
]


@pytest.mark.parametrize("row", TABLE, ids=lambda r: f"{r[0]}-K{r[1]}-{r[2]}-dt{r[3]}")
def test_peak_errors_of_the_independent_simulation(row):
    task, gain, feedback, dt, printed = row
    for method, pair in zip(("euler", "trapezoidal", "abm4", "rk4"), printed.split(), strict=True):
        found = dp.track(pa10(), circle(task), method=method, dt=dt, t_end=60.0 if task == "A" else 20.0, gain=gain,
                         feedback=feedback)  # fmt: skip
        for error, value in zip(
            (found.position_error, found.orientation_error), map(float, pair.split("/")), strict=True
        ):
            # two printed digits; below 1e-11 both are sums of rounding errors
            assert error.max() == pytest.approx(value, rel=0.06, abs=2e-12), method


def test_abm4_settles_below_rk4_when_feedback_enters_every_stage():
    late = {m: dp.track(pa10(), circle("B"), method=m, dt=0.1, t_end=20.0, gain=10.0).position_error[150:].max()
            for m in ("abm4", "rk4")}  # fmt: skip
    assert late["abm4"] == pytest.approx(3.8e-8, rel=0.1)
    assert late["rk4"] == pytest.approx(6.7e-6, rel=0.1)


@pytest.mark.parametrize("method", ["euler", "trapezoidal", "abm4", "rk4"])
def test_feedback_of_ten_at_one_second_is_unstable_for_all(method):
    run = dp.track(pa10(), circle("B"), method=method, dt=1.0, t_end=20.0, gain=10.0)
    assert not run.position_error.max() < 0.1  # it leaves the workspace, or overflows


def test_euler_is_never_the_only_unstable_one():
    """No K dt makes Euler unstable while AM4 stays stable: its limit is the larger one."""
    limit = dp.integrators.stability_limit
    assert limit("abm4") < limit("euler")


@pytest.mark.parametrize(("method", "order"), [("euler", 1), ("trapezoidal", 2), ("rk4", 4)])
@pytest.mark.parametrize("gain", [0.0, 1.0])
def test_the_order_of_tracking_is_that_of_the_method(method, order, gain):
    assert _tracked_order(method, gain, "paper") == pytest.approx(order, abs=0.1)


def test_the_order_of_abm4_depends_on_its_start_up():
    """Measured by the configuration reached.

    The closed loop forgets its start along the task but not in the null space, so the start-up's
    error stays there.
    """
    assert _tracked_order("abm4", 0.0, "paper") == pytest.approx(3, abs=0.1)
    assert _tracked_order("abm4", 0.0, "rk4") == pytest.approx(4, abs=0.1)


def _tracked_order(method, gain, startup):
    path = circle("B")
    truth = dp.track(pa10(), path, method="rk4", dt=1 / 400, t_end=5.0, gain=gain).q[-1]
    steps = np.array([100, 200, 400]) if method != "rk4" else np.array([50, 100, 200])
    errors = []
    for n in steps:
        run = dp.track(pa10(), path, method=method, dt=5.0 / n, t_end=5.0, gain=gain, startup=startup)
        errors.append(np.abs(run.q[-1] - truth).max())
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize(("method", "limit"), [("euler", 2.0), ("trapezoidal", 2.0), ("abm4", 1.285), ("rk4", 2.785)])
def test_measured_stability_limit(method, limit):
    """Bracketed within one percent on the robot itself: a small error dies out below, grows above."""
    rest = dp.Circle(0.0, 10.0, start=PA10_START)
    off = PA10_START + 1e-7 * np.cos(np.arange(7))
    late = []
    for z in (0.99 * limit, 1.01 * limit):
        run = dp.track(pa10(), rest, q0=off, method=method, dt=0.1, t_end=60.0, gain=10 * z)
        e = run.position_error + run.orientation_error
        late.append(e[-1] / e[300])
    assert late[0] < 0.9 < 1.1 < late[1]


@pytest.mark.parametrize("method", ["euler", "trapezoidal", "abm4", "rk4"])
def test_pseudo_inverses_a_step_are_those_of_the_paper(method):
    run = dp.track(pa10(), circle("B"), method=method, dt=0.1, t_end=1.0)
    assert run.cost.evaluations == 10 * {"euler": 1, "trapezoidal": 2, "abm4": 2, "rk4": 4}[method]


def test_the_enlarged_circle_is_refused_before_it_runs():
    path = dp.Circle(0.2, 10.0, plane="yz", start=PA10_START)
    with pytest.raises(dp.ArgumentError, match=r"leaves the workspace.*0\.9508 m.*reach only 0\.93 m"):
        dp.track(pa10(), path, dt=0.1)
    with pytest.warns(dp.DualpinWarning, match="leaves the workspace"):
        run = dp.track(pa10(), path, dt=0.1, unreachable="warn", gain=1.0)
    assert run.position_error.max() > 1e-2
    assert any("leaves the workspace" in text for text in run.warnings)
