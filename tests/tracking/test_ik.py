"""Inverse kinematics finds configurations, within limits, and says when it did not."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp

from .arms import pa10


@pytest.mark.parametrize(
    ("name", "frame"), [("ur5", "tool0"), ("panda", "panda_hand"), ("talos", "gripper_left_base_link")]
)
def test_poses_that_exist_are_found(name, frame):
    robot = dp.load(name)
    q, _, _ = robot.sample(200, seed=3)
    target = dp.fk(robot, q, frame)
    found = dp.ik(robot, target, frame)
    assert found.success_rate >= 0.99
    reached = dp.fk(robot, found.q[found.success], frame)
    # tolerance 1e-9 on the error in rad and m
    assert np.abs(reached - target[found.success]).max() < 2e-9
    assert (found.q >= robot.lower - 1e-15).all() and (found.q <= robot.upper + 1e-15).all()


def test_compiled_and_interpreted_searches_agree():
    robot = pa10()
    q, _, _ = robot.sample(3, seed=0)
    target = dp.fk(robot, q, -1)
    runs = [dp.ik(robot, target, q0=q + 0.1, restarts=0, engine=e) for e in ("auto", "numpy")]
    assert runs[0].success.all() and (runs[0].iterations == runs[1].iterations).all()
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-8


def test_convergence_is_fast_near_the_solution():
    robot = pa10()
    q, _, _ = robot.sample(100, seed=5)
    found = dp.ik(robot, dp.fk(robot, q, -1), q0=q + 1e-2, restarts=0)
    assert found.success_rate > 0.95  # a few of the samples are singular
    assert np.median(found.iterations) <= 6


def test_dual_quaternions_and_matrices_are_the_same_target():
    robot = dp.load("ur5")
    q, _, _ = robot.sample(4, seed=1)
    a = dp.ik(robot, dp.fk(robot, q, "tool0"), "tool0")
    b = dp.ik(robot, dp.fk(robot, q, "tool0", as_="dual_quaternion"), "tool0")
    assert np.abs(a.q - b.q).max() < 1e-6


def test_what_is_out_of_reach_is_reported_not_hidden():
    robot = dp.load("ur5")
    far = np.eye(4)
    far[0, 3] = 3.0
    found = dp.ik(robot, far, "tool0", restarts=2)
    assert not found.success and found.starts == 3
    assert np.linalg.norm(found.error) > 1.0
    assert np.isfinite(found.q).all()


def test_without_limits_more_is_found_and_with_limits_none_is_passed():
    robot = dp.load("panda")
    q, _, _ = robot.sample(50, seed=2)
    beyond = q.copy()
    beyond[:, 3] = 0.5  # the elbow cannot bend that way
    target = dp.fk(robot, beyond, "panda_hand")
    free = dp.ik(robot, target, "panda_hand", limits=False)
    assert free.success_rate > 0.95
    kept = dp.ik(robot, target, "panda_hand", restarts=3)
    assert (kept.q >= robot.lower - 1e-15).all() and (kept.q <= robot.upper + 1e-15).all()


def test_a_floating_base_takes_the_frame_anywhere():
    robot = dp.load("ur5", floating=True)
    target = dp.spatial.to_matrix(dp.spatial.exp([0.4, -1.0, 0.7, 5.0, -3.0, 2.0]))
    found = dp.ik(robot, target, "tool0")
    assert found.success
    assert np.abs(dp.fk(robot, found.q, "tool0") - target).max() < 2e-9


def test_shapes_broadcast():
    robot = dp.load("ur5")
    q, _, _ = robot.sample(3, seed=1)
    target = dp.fk(robot, q, "tool0")
    found = dp.ik(robot, target, "tool0", q0=np.zeros((2, 1, 6)) + 0.5)
    assert found.q.shape == (2, 3, 6) and found.error.shape == (2, 3, 6) and found.iterations.shape == (2, 3)


BAD = [
    ({"target": np.eye(3)}, dp.ShapeError, r"\(..., 4, 4\) or \(..., 8\)"),
    ({"target": 2 * np.eye(4)}, dp.ArgumentError, "a rotation and a last row"),
    ({"target": np.ones(8)}, dp.ArgumentError, "unit dual quaternions"),
    ({"target": np.eye(4) * np.nan}, dp.DualpinError, "rotation|finite"),
    ({"q0": np.zeros(5)}, dp.ShapeError, "nq = 6"),
    ({"q0": np.full(6, np.inf)}, dp.ArgumentError, "not finite"),
    ({"restarts": -1}, dp.ArgumentError, "restarts = -1"),
    ({"max_iterations": 0}, dp.ArgumentError, "max_iterations = 0"),
    ({"tolerance": 0.0}, dp.ArgumentError, "tolerance = 0.0"),
    ({"frame": "tool1"}, dp.FrameNotFoundError, "did you mean 'tool0'"),
    ({"target": np.zeros((2, 4, 4)) + np.eye(4), "q0": np.zeros((3, 6))}, dp.ShapeError, "do not broadcast"),
]


@pytest.mark.parametrize(("change", "error", "message"), BAD)
def test_bad_input_is_named(change, error, message):
    arguments = {"target": np.eye(4), "frame": "tool0", **change}
    with pytest.raises(error, match=message):
        dp.ik(dp.load("ur5"), arguments.pop("target"), **arguments)
