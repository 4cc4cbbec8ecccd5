"""What a simulation says of robots without inertia, and what damping and friction take."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.mechanisms import body
from dualpin.model import Builder, prismatic, revolute
from dualpin.model.robot import Limits, Mimic
from dualpin.spatial import UX, UY, Inertia, Pose, Vector3, diagonal

from .arms import double_pendulum

ROD = Inertia(1.0, Vector3(0.5, 0.0, 0.0), diagonal(1.0 / 3.0))


def arm(*inertias, armature=(), gravity=(0.0, 0.0, -9.81)):
    """Turns about y, a metre apart."""
    b = Builder("arm", gravity)
    for i, inertia in enumerate(inertias):
        at = Pose(position=Vector3(float(i > 0), 0.0, 0.0))
        b.joint(f"j{i}", revolute(UY), f"j{i - 1}" if i else None, placement=at, inertia=inertia, armature=armature)
    return b.robot()


@pytest.mark.parametrize("method", ["rk4", "rk45", "variational", "semi_implicit_euler", "DOP853"])
def test_a_joint_that_moves_no_mass_is_named(method):
    with pytest.raises(dp.ArgumentError, match="mass matrix is singular: joint 'j1' moves no mass"):
        dp.simulate(arm(ROD, None), [0.1, 0.2], [0.0, 0.0], method=method, dt=0.01, t_end=0.1)


def test_a_robot_without_mass_is_an_error_and_an_armature_is_inertia():
    with pytest.raises(dp.ArgumentError, match="arm has no mass"):
        dp.simulate(arm(None, None), [0.1, 0.2], [0.0, 0.0], t_end=0.1)
    run = dp.simulate(arm(None, armature=(0.5,)), [0.0], [0.0], [1.0], dt=0.1, t_end=1.0)
    assert run.q[-1, 0] == pytest.approx(1.0, rel=1e-12)  # t^2 / 2 of 2 rad/s^2


def test_joints_that_cancel_each_other_are_named():
    """Two turns about one axis, no mass between: their difference moves nothing."""
    b = Builder("twice")
    b.joint("a", revolute(UY))
    b.joint("b", revolute(UY), "a", inertia=ROD)
    with pytest.raises(dp.ArgumentError, match="joint 'a' and those beyond it can move together"):
        dp.simulate(b.robot(), [0.1, 0.2], [0.0, 0.0], t_end=0.1)


def test_the_member_of_a_batch_is_named():
    """A turn about x with a point mass on its axis only where the arm is straight."""
    b = Builder("point")
    b.joint("a", revolute(UY), inertia=ROD)
    b.joint("b", revolute(UX), "a", placement=Pose(position=Vector3(1.0, 0.0, 0.0)))
    b.joint("c", revolute(UY), "b", inertia=body(1.0, [0.5, 0, 0], np.zeros((3, 3))))
    q = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    with pytest.raises(dp.ArgumentError, match="member 1 of the batch"):
        dp.simulate(b.robot(), q, np.zeros((2, 3)), t_end=0.1)


def test_small_robots_are_no_singular_ones():
    """The inertia is judged beside the joint's own, not against 1."""
    tiny = Inertia(1e-9, Vector3(0.5e-15, 0.0, 0.0), diagonal(1e-18))
    assert np.isfinite(dp.simulate(arm(tiny, tiny), [0.1, 0.2], [0.0, 0.0], dt=1e-4, t_end=1e-3).q).all()


def test_a_motion_that_leaves_the_numbers_says_so():
    with pytest.warns(dp.DualpinWarning, match="not finite from t"):
        run = dp.simulate(double_pendulum(), [0.3, 0.2], [1e4, -1e4], method="euler", dt=1.0, t_end=200.0)
    assert run.energy_drift == np.inf
    assert run.notes[0].startswith("not finite")


def slide(damping=0.0, friction=0.0, mass=2.0):
    b = Builder("slide", (0.0, 0.0, 0.0))
    block = Inertia(mass, Vector3(0.0, 0.0, 0.0), diagonal(1.0))
    b.joint("x", prismatic(UX), inertia=block, limits=Limits(damping=damping, friction=friction))
    return b.robot()


@pytest.mark.parametrize(("method", "tolerance"), [("rk4", 1e-9), ("rk45", 1e-8), ("variational", 1e-4),
                                                   ("semi_implicit_euler", 1e-2)])  # fmt: skip
def test_damping_slows_as_the_exponential(method, tolerance):
    run = dp.simulate(slide(damping=3.0), [0.0], [1.0], method=method, dt=0.01, t_end=1.0, dissipation="file")
    np.testing.assert_allclose(run.v[:, 0], np.exp(-1.5 * run.t), atol=tolerance)
    np.testing.assert_allclose(run.energy + run.energy_loss, run.energy[0], atol=max(tolerance, 1e-4))
    assert run.notes == ("dissipation: damping of x, as the file says",)


def test_dry_friction_takes_its_force_and_stops_the_joint():
    run = dp.simulate(slide(friction=4.0), [0.0], [1.0], dt=1e-4, t_end=1.0, dissipation="file", every=100)
    early = run.t < 0.4
    np.testing.assert_allclose(run.v[early, 0], 1.0 - 2.0 * run.t[early], atol=1e-4)
    assert abs(run.v[-1, 0]) < 1e-6 and run.q[-1, 0] == pytest.approx(0.25, abs=1e-3)  # v^2 / 2a
    assert run.energy_loss[-1] == pytest.approx(1.0, rel=1e-3)  # all the kinetic energy there was


def test_losses_are_asked_for_and_reported():
    robot = slide(damping=3.0, friction=1.0)
    free = dp.simulate(robot, [0.0], [1.0], dt=0.1, t_end=1.0)
    assert free.v[-1, 0] == 1.0 and not free.energy_loss.any() and free.notes == ()
    with_both = dp.simulate(robot, [0.0], [1.0], dt=0.01, t_end=0.1, dissipation="file")
    assert len(with_both.notes) == 2
    nothing = dp.simulate(slide(), [0.0], [1.0], dt=0.1, t_end=1.0, dissipation="file")
    assert nothing.v[-1, 0] == 1.0 and "states neither" in nothing.notes[0]
    with pytest.raises(dp.ArgumentError, match="dissipation = 'yes'"):
        dp.simulate(robot, [0.0], [1.0], dissipation="yes")


def test_a_followers_damping_counts_by_the_square_of_its_multiplier():
    b = Builder("pair", (0.0, 0.0, 0.0))
    block = Inertia(1.0, Vector3(0.0, 0.0, 0.0), diagonal(1.0))
    b.joint("a", revolute(UY), inertia=block)
    b.joint("b", revolute(UY), mimic=Mimic("a", -3.0, 0.1), inertia=block, limits=Limits(damping=2.0))
    run = dp.simulate(b.robot(), [0.0], [1.0], dt=0.001, t_end=0.5, dissipation="file", every=100)
    np.testing.assert_allclose(run.v[:, 0], np.exp(-18.0 / 10.0 * run.t), rtol=1e-6)  # (1 + 9) a' = -9 * 2 v


def test_compiled_and_interpreted_losses_agree():
    robot = dp.load("panda")
    q, v, _ = robot.sample(3, seed=0)
    runs = [
        dp.simulate(robot, q, 0.1 * v, dt=1e-3, t_end=0.02, dissipation="file", engine=e) for e in ("auto", "numpy")
    ]
    assert np.abs(runs[0].v - runs[1].v).max() < 1e-9
    assert (runs[0].energy_loss[:, -1] > 0).all()


@pytest.mark.parametrize("method", ["rk45", "DOP853", "LSODA"])
def test_adaptive_methods_blame_what_is_to_blame(method):
    solve = dp.integrators.solve
    with pytest.raises(dp.ArgumentError, match="the rate is not finite at"):
        solve(lambda t, y: y * np.nan, [1.0], method=method, dt=0.1, t_end=1.0)
    with (
        np.errstate(all="ignore"),
        pytest.raises(dp.ArgumentError, match=r"at t = 1 s, with|step size|not finite at t = 1 s"),
    ):
        solve(lambda t, y: y * y, [1.0], method=method, dt=0.5, t_end=2.0)  # a pole at t = 1
