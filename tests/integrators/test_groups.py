"""On the group: a floating body turns and moves along screws, at the declared order, and stays on the group."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import dualpin as dp
from dualpin.integrators import METHODS, ConfigurationSpace, solve
from dualpin.model import Builder, Floating, Planar
from dualpin.spatial import Inertia, Vector3, diagonal

ON_GROUPS = ["euler", "midpoint", "heun", "rk4", "rkmk4", "crouch_grossman3", "crouch_grossman4"]


def body(kind):
    b = Builder("body", gravity=(0.0, 0.0, 0.0))
    b.joint("base", kind, inertia=Inertia(2.0, Vector3(0.1, -0.05, 0.02), diagonal(0.4)))
    return b.robot()


BODIES = {"floating": body(Floating()), "planar": body(Planar())}


@cache
def truth_of(kind):
    """By steps so small that their own error is below 1e-12."""
    return end(kind, "rkmk4", 1024)


def screws(nv):
    """A twist that changes its axis all the time, so that nothing commutes."""
    phase = np.arange(nv)

    def rate(t, y):
        return np.broadcast_to(np.cos(1.3 * t + phase) + 0.3 * np.sin(0.7 * phase * t), (*y.shape[:-1], nv))

    return rate


def end(kind, method, n, span=2.0, **options):
    robot = BODIES[kind]
    return solve(
        screws(robot.nv),
        robot.neutral,
        method=method,
        dt=span / n,
        t_end=span,
        space=ConfigurationSpace(robot),
        **options,
    ).y[-1]


@pytest.mark.parametrize("kind", BODIES)
@pytest.mark.parametrize("name", ON_GROUPS)
def test_the_order_holds_on_the_group(kind, name):
    truth = truth_of(kind)
    steps = (32, 64, 128) if METHODS[name].order > 2 else (128, 256, 512)
    errors = [np.abs(end(kind, name, n) - truth).max() for n in steps]
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(METHODS[name].order, abs=0.1)


@pytest.mark.parametrize("kind", BODIES)
def test_rk45_and_scipy_agree_on_the_group(kind):
    truth = truth_of(kind)
    assert np.abs(end(kind, "rk45", 4, rtol=1e-10, atol=1e-12) - truth).max() < 1e-8
    # scipy integrates dexp^-1 truncated after the fourth bracket over intervals of 1/16 s: (1/16)^7 remains
    assert np.abs(end(kind, "DOP853", 32, rtol=1e-12, atol=1e-13) - truth).max() < 1e-8


@pytest.mark.parametrize("name", ON_GROUPS)
def test_quaternions_stay_of_unit_norm(name):
    robot = BODIES["floating"]
    run = solve(screws(6), robot.neutral, method=name, dt=0.05, t_end=25.0, space=ConfigurationSpace(robot))
    # normalised in every step: five hundred steps leave the rounding of one
    assert np.abs(np.linalg.norm(run.y[:, 3:], axis=-1) - 1).max() < 4e-16


def test_a_constant_twist_is_integrated_exactly():
    robot = BODIES["floating"]
    twist = np.array([0.3, -0.8, 0.5, 0.2, 0.1, -0.4])
    space = ConfigurationSpace(robot)
    for name in ON_GROUPS:
        run = solve(lambda t, y: np.broadcast_to(twist, (*y.shape[:-1], 6)), robot.neutral, method=name, dt=0.5,
                    t_end=2.0, space=space)  # fmt: skip
        assert np.abs(run.y[-1] - dp.integrate(robot, robot.neutral, 2.0 * twist)).max() < 1e-14


def test_forward_and_back_returns():
    """RK4 is not symmetric, so it returns to the order of its error only: O(dt^5) a pair of steps, dt^4 in all."""
    robot, space = BODIES["floating"], ConfigurationSpace(BODIES["floating"])
    gaps = []
    for n in (32, 64):
        there = end("floating", "rk4", n)
        back = solve(lambda t, y: -screws(6)(2.0 - t, y), there, method="rk4", dt=2.0 / n, t_end=2.0, space=space).y[-1]
        gaps.append(np.abs(back - robot.neutral).max())
    assert gaps[1] < gaps[0] / 15


def test_multistep_methods_refuse_groups():
    robot = BODIES["floating"]
    with pytest.raises(dp.ArgumentError, match="did you mean 'rkmk4'"):
        solve(screws(6), robot.neutral, method="abm4", dt=0.1, t_end=1.0, space=ConfigurationSpace(robot))


@pytest.mark.parametrize("kind", BODIES)
def test_the_bracket_is_antisymmetric_and_obeys_jacobi(kind):
    space = ConfigurationSpace(BODIES[kind])
    from dualpin.integrators import Column

    rng = np.random.default_rng(0)
    a, b, c = (Column(rng.normal(size=BODIES[kind].nv).tolist()) for _ in range(3))
    ab, ba = space.bracket(a, b), space.bracket(b, a)
    assert np.allclose(np.array(ab) + np.array(ba), 0, atol=1e-15)
    cycle = sum(np.array(space.bracket(x, space.bracket(y, z))) for x, y, z in ((a, b, c), (b, c, a), (c, a, b)))
    assert np.allclose(cycle, 0, atol=1e-14)
