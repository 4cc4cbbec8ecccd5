"""Forward dynamics keeps its invariants: energy, momentum, the group, and the order of the method."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.model import Builder, revolute
from dualpin.spatial import UY, Inertia, Pose, Vector3, diagonal

from .arms import double_pendulum

START = np.array([0.3, 0.2]), np.array([0.0, 0.0])


def end(method, dt, t_end=1.0, **options):
    run = dp.simulate(double_pendulum(), *START, method=method, dt=dt, t_end=t_end, **options)
    return np.concatenate([run.q[-1], run.v[-1]])


@pytest.fixture(scope="module")
def truth():
    return end("DOP853", 1.0, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(
    ("method", "order"),
    [("euler", 1), ("semi_implicit_euler", 1), ("variational", 2), ("heun", 2), ("rk4", 4), ("midpoint", 2)],
)
def test_the_order_is_the_declared_one(method, order, truth):
    steps = np.array([800, 1600, 3200] if order == 1 else [100, 200, 400])
    errors = [np.abs(end(method, 1.0 / n) - truth).max() for n in steps]
    assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(order, abs=0.1)


def test_rk45_keeps_to_its_tolerance(truth):
    assert np.abs(end("rk45", 0.25, rtol=1e-10, atol=1e-12) - truth).max() < 1e-8


def test_compiled_steps_equal_the_interpreted_ones():
    for method in ("rk4", "variational", "semi_implicit_euler"):
        a, b = (end(method, 0.01, 0.1, engine=e) for e in ("auto", "numpy"))
        assert np.abs(a - b).max() < 1e-13


def test_symplectic_energy_does_not_drift_and_euler_does():
    long = {"dt": 0.01, "t_end": 200.0, "every": 100}
    symplectic = dp.simulate(double_pendulum(), *START, method="variational", **long)
    half = len(symplectic.t) // 2
    swing = np.ptp(symplectic.energy[:half]), np.ptp(symplectic.energy[half:])
    assert swing[1] < 1.5 * swing[0]
    assert symplectic.energy_drift < 2e-2
    assert dp.simulate(double_pendulum(), *START, method="euler", **{**long, "t_end": 20.0}).energy_drift > 1.0


@pytest.mark.campaign
def test_symplectic_energy_is_bounded_over_a_million_steps_while_rk4_grows():
    start = np.array([0.4, 0.3]), np.array([0.0, 0.0])
    long = {"dt": 0.02, "t_end": 20_000.0, "every": 1000}
    drift = {}
    for method in ("variational", "rk4"):
        run = dp.simulate(double_pendulum(), *start, method=method, **long)
        error = np.abs(run.energy - run.energy[0])
        tenth = len(error) // 10
        drift[method] = error[:tenth].max(), error[-tenth:].max()
    first, last = drift["variational"]
    assert last < 2 * first  # bounded: the last tenth swings no wider than the first
    first, last = drift["rk4"]
    assert last > 5 * first  # a drift proportional to time would be ten times


def test_the_variational_method_is_reversible():
    """Symmetric: there and back with the velocity turned round ends where it began, to the solver's rounding."""
    there = dp.simulate(double_pendulum(), *START, method="variational", dt=0.01, t_end=2.0)
    back = dp.simulate(double_pendulum(), there.q[-1], -there.v[-1], method="variational", dt=0.01, t_end=2.0)
    assert np.abs(back.q[-1] - START[0]).max() < 1e-11
    rk4 = dp.simulate(double_pendulum(), *START, method="rk4", dt=0.01, t_end=2.0)
    back = dp.simulate(double_pendulum(), rk4.q[-1], -rk4.v[-1], method="rk4", dt=0.01, t_end=2.0)
    assert np.abs(back.q[-1] - START[0]).max() > 1e-8


@pytest.mark.parametrize("method", ["rk4", "rkmk4", "crouch_grossman4", "rk45"])
def test_a_floating_robot_in_free_space_keeps_its_momentum(method):
    robot = dp.load("talos", floating=True).with_gravity([0.0, 0.0, 0.0])
    q, v, _ = robot.sample(seed=4)
    run = dp.simulate(robot, q, 0.2 * v, method=method, dt=1e-3, t_end=0.02, rtol=1e-9, atol=1e-10)
    size = np.abs(run.momentum[0]).max()
    assert run.momentum_drift < 1e-6 * size
    assert run.energy_drift < 1e-6 * run.energy[0]
    assert np.abs(np.linalg.norm(run.q[:, 3:7], axis=-1) - 1).max() < 4e-16


def test_internal_torques_do_not_change_momentum():
    robot = dp.load("ur5", floating=True).with_gravity([0.0, 0.0, 0.0])
    q, v, _ = robot.sample(seed=1)

    def controller(t, q, v):
        tau = np.zeros(robot.nv)
        tau[6:] = np.sin(5 * t) - 0.5 * v[..., 6:]
        return tau

    run = dp.simulate(robot, q, 0.1 * v, controller, dt=2e-3, t_end=0.2)
    assert run.momentum_drift < 1e-7 * (1 + np.abs(run.momentum[0]).max())


def test_falling_is_falling():
    """A floating robot at rest without torques falls with g, whatever its posture: at t = 1 s by 4.905 m."""
    robot = dp.load("ur5", floating=True)
    q, v, _ = robot.sample(seed=2)
    run = dp.simulate(robot, q, 0 * v, dt=0.05, t_end=1.0)
    assert np.abs(run.v[-1, 6:]).max() < 1e-9
    assert run.q[-1, 2] - run.q[0, 2] == pytest.approx(-4.905, abs=1e-9)


def three_r_with_payload():
    """Two driven joints and a payload hanging on a third that nobody drives."""
    rod = Inertia(2.0, Vector3(0.25, 0.0, 0.0), diagonal(0.2))
    b = Builder("3R")
    on, at = None, Pose()
    for name in ("shoulder", "elbow", "payload"):
        b.joint(name, revolute(UY), on=on, placement=at, inertia=rod)
        on, at = name, Pose(position=Vector3(0.5, 0.0, 0.0))
    return b.robot()


def test_passive_joints_swing():
    robot, home = three_r_with_payload(), np.array([0.0, 0.3, 0.8])

    def hold(t, q, v):
        return dp.gravity(robot, q) + 400.0 * (home - q) - 60.0 * v

    run = dp.simulate(robot, home, np.zeros(3), hold, passive=["payload"], dt=2e-3, t_end=2.0)
    assert np.abs(run.q[:, :2] - home[:2]).max() < 0.1  # held approximately
    assert np.ptp(run.q[:, 2]) > 0.5  # swings about the vertical
    driven = dp.simulate(robot, home, np.zeros(3), hold, dt=2e-3, t_end=0.5)
    assert np.ptp(driven.q[:, 2]) < 1e-9


def test_a_held_controller_is_called_once_a_step():
    calls = []

    def controller(t, q, v):
        calls.append(t)
        return np.zeros(2)

    dp.simulate(double_pendulum(), *START, controller, dt=0.1, t_end=1.0, hold=True)
    assert np.allclose(calls, np.arange(10) * 0.1)
    calls.clear()
    dp.simulate(double_pendulum(), *START, controller, dt=0.1, t_end=1.0)
    assert len(calls) == 40


@pytest.mark.parametrize("method", ["rk4", "variational", "semi_implicit_euler", "abm4"])
def test_a_batch_is_its_members(method):
    q, v = np.random.default_rng(0).normal(size=(2, 2, 3, 2))
    together = dp.simulate(double_pendulum(), q, v, method=method, dt=0.01, t_end=0.2)
    assert together.q.shape == (2, 3, 21, 2) and together.energy.shape == (2, 3, 21)
    alone = dp.simulate(double_pendulum(), q[1, 2], v[1, 2], method=method, dt=0.01, t_end=0.2)
    # the implicit method sweeps until the whole batch stands still
    assert np.abs(together.q[1, 2] - alone.q).max() < 1e-13


def test_every_keeps_the_same_values():
    full = dp.simulate(double_pendulum(), *START, dt=0.01, t_end=1.0)
    some = dp.simulate(double_pendulum(), *START, dt=0.01, t_end=1.0, every=25)
    assert np.array_equal(full.q[::25], some.q) and np.array_equal(full.t[::25], some.t)


BAD = [
    ({"dt": 0.0}, dp.ArgumentError, "dt = 0.0 s"),
    ({"t_end": -1.0}, dp.ArgumentError, "t_end = -1.0 s"),
    ({"q": [np.nan, 0.0]}, dp.ArgumentError, "q has entries that are not finite"),
    ({"q": [0.0]}, dp.ShapeError, "nq = 2"),
    ({"v": [0.0]}, dp.ShapeError, "nv = 2"),
    ({"tau": [0.0]}, dp.ShapeError, "tau of shape"),
    ({"tau": lambda t, q, v: [0.0]}, dp.ShapeError, "controller"),
    ({"method": "verlet"}, dp.ArgumentError, "method 'verlet' is not known"),
    ({"passive": ["lowr"]}, dp.FrameNotFoundError, "did you mean 'lower'"),
    ({"every": 7}, dp.ArgumentError, "every = 7"),
    ({"v": np.zeros((2, 2)), "q": np.zeros((3, 2))}, dp.ShapeError, "do not broadcast"),
    ({"method": "rk45", "hold": True, "tau": lambda t, q, v: [0.0, 0.0]}, dp.ArgumentError, "hold needs equal steps"),
]


@pytest.mark.parametrize(("change", "error", "message"), BAD)
def test_bad_input_is_named(change, error, message):
    arguments = {"q": [0.0, 0.0], "v": [0.0, 0.0], "dt": 0.1, "t_end": 1.0, **change}
    with pytest.raises(error, match=message):
        dp.simulate(double_pendulum(), arguments.pop("q"), arguments.pop("v"), **arguments)


def test_the_variational_method_refuses_a_floating_base():
    robot = dp.load("ur5", floating=True)
    with pytest.raises(dp.ArgumentError, match="did you mean 'rkmk4'"):
        dp.simulate(robot, robot.neutral, np.zeros(robot.nv), method="variational", dt=0.01, t_end=0.1)
