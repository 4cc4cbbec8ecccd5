"""Exciting motions show more than chance does, and stay within limits all the time."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.analysis.identification.fourier import Fourier, extremes
from dualpin.errors import ArgumentError, ShapeError

pytest.importorskip("scipy")
LIMITS = {"velocity": 2.0, "acceleration": [4.0, 5.0, 6.0, 7.0, 8.0, 9.0]}


@pytest.fixture(scope="module")
def found():
    return dp.excite(dp.load("ur5"), LIMITS, iterations=2, starts=10, seed=1)


@pytest.mark.parametrize("seed", range(20))
def test_extremes_are_those_of_a_dense_search(seed):
    rng = np.random.default_rng(seed)
    n = rng.integers(1, 9)
    cosine, sine = rng.standard_normal((2, n)) * rng.integers(0, 2, (2, n))
    x = np.linspace(0, 2 * np.pi, 20_001)
    values = 0.5 + sum(
        c * np.cos(k * x) + s * np.sin(k * x) for k, (c, s) in enumerate(zip(cosine, sine, strict=True), 1)
    )
    low, high = extremes(0.5, cosine, sine)
    # between samples a cosine of frequency n rises by at most n^2 h^2 / 8 of its size
    slack = n**2 * (x[1] ** 2) / 8 * np.abs([cosine, sine]).sum() + 1e-12
    assert values.min() - slack <= low <= values.min() + 1e-12
    assert values.max() - 1e-12 <= high <= values.max() + slack


@pytest.mark.parametrize("seed", range(5))
def test_the_quick_bound_holds_and_is_near(seed):
    rng = np.random.default_rng(seed)
    motion = Fourier(3.0, rng.standard_normal(4), *rng.standard_normal((2, 4, 6)))
    for order in range(3):
        (low, high), (below, above) = motion.range(order), motion.bound(order)
        assert (below <= low + 1e-12).all() and (above >= high - 1e-12).all()
        assert (above - below <= 1.05 * (high - low)).all()


def test_limits_hold_over_the_whole_period(found):
    t = np.linspace(0, found.period, 50_001)
    q, v, a = found.motion.at(t)
    b = found.bounds
    assert (q >= b.lower).all() and (q <= b.upper).all()
    assert (np.abs(v) <= 2.0).all() and (np.abs(a) <= LIMITS["acceleration"]).all()
    assert all((x >= 0).all() for x in found.margins().values())


def test_velocities_are_derivatives_and_it_starts_at_rest(found):
    h = 1e-5
    t = np.linspace(1, 9, 50)
    (q0, v0, _), (q1, v1, _), (_, v, a) = (found.motion.at(x) for x in (t - h, t + h, t))
    assert np.abs((q1 - q0) / (2 * h) - v).max() < 1e-7
    assert np.abs((v1 - v0) / (2 * h) - a).max() < 1e-7
    for x in found.motion.at(np.array([0.0, found.period]))[1:]:
        assert np.abs(x).max() < 1e-12


def test_its_condition_number_is_that_of_pinocchios_regressor_and_better_than_chance(found):
    pin = pytest.importorskip("pinocchio")
    model = pin.buildModelFromUrdf(found.robot.source)
    data = model.createData()
    _, q, v, a = found.sample(rate=10.0)
    W = np.vstack([pin.computeJointTorqueRegressor(model, data, *x) for x in zip(q, v, a, strict=True)])
    assert np.linalg.cond(W[:, found.base.columns]) == pytest.approx(found.condition, rel=1e-6)
    assert found.condition < 0.95 * found.first


def test_it_can_be_written_and_drawn(found, tmp_path):
    lines = found.to_csv(tmp_path / "motion.csv", rate=20.0).splitlines()
    assert lines[0].split(",")[:2] == ["t", "q shoulder_pan_joint"] and len(lines) == 201
    assert len(lines[1].split(",")) == 1 + 3 * 6
    pytest.importorskip("matplotlib")
    found.plot(tmp_path / "motion.svg")
    assert (tmp_path / "motion.svg").stat().st_size > 1000


def test_progress_is_told_and_ctrl_c_stops():
    told = []
    dp.excite(dp.load("ur5"), iterations=0, starts=100, progress=lambda n, c: told.append((n, c)))
    assert [n for n, _ in told] == [50, 100] and told[1][1] <= told[0][1]

    def interrupt(done, condition):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        dp.excite(dp.load("ur5"), progress=interrupt)


def test_what_cannot_be_is_answered():
    robot = dp.load("ur5")
    for limits, match in [
        ({"speed": 1}, "velocity"), ({"lower": 1.0, "upper": 0.5}, "no room"), (3, "a mapping"),
        ({"velocity": 0}, "no room"),
    ]:  # fmt: skip
        with pytest.raises(ArgumentError, match=match):
            dp.excite(robot, limits)
    with pytest.raises(ShapeError, match="velocity"):
        dp.excite(robot, {"velocity": [1, 2]})
    with pytest.raises(ArgumentError, match="root_joint"):
        dp.excite(dp.load("solo12", floating=True))
    with pytest.raises(ArgumentError, match="shows all 36"):
        dp.excite(robot, samples=4, iterations=0)  # 24 torques cannot determine 36 parameters
    with pytest.raises(ArgumentError, match="share"):
        dp.excite(robot, share=2)
