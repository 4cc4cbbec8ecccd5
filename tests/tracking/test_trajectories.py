"""A trajectory's twist is the rate of change of its pose."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.tracking import Callback

T0 = dp.spatial.to_matrix(dp.spatial.exp([0.3, -0.4, 0.9, 0.5, 0.1, 0.7]))
GOAL = dp.spatial.exp([-0.5, 0.2, 1.1, 0.1, 0.6, 0.2])
PATHS = {
    "circle xy": dp.Circle(0.2, 3.0, "xy"),
    "circle yz": dp.Circle(0.2, 3.0, "yz"),
    "circle zx": dp.Circle(0.2, 3.0, "zx"),
    "line": dp.Line([0.1, -0.2, 0.3], 2.0),
    "screw": dp.Screw(GOAL, 2.0),
    "waypoints": dp.Waypoints([GOAL, dp.spatial.to_matrix(GOAL) @ T0, T0], [0.5, 1.25, 2.0]),
}


@pytest.mark.parametrize("name", PATHS)
def test_the_twist_is_the_derivative_of_the_pose(name):
    motion, h = PATHS[name].at(T0), 1e-6
    t = np.array([0.1, 0.4, 0.9, 1.6])
    pose, twist = motion(t)
    (ahead, _), (behind, _) = motion(t + h), motion(t - h)
    velocity = (ahead[:, :3, 3] - behind[:, :3, 3]) / (2 * h)
    turning = (ahead[:, :3, :3] - behind[:, :3, :3]) / (2 * h) @ np.swapaxes(pose[:, :3, :3], 1, 2)
    w = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=-1)
    # central differences: rounding 1e-16 / 1e-6, truncation below that
    assert np.abs(velocity - twist[:, 3:]).max() < 1e-8
    assert np.abs(w - twist[:, :3]).max() < 1e-8


@pytest.mark.parametrize("name", PATHS)
def test_it_begins_at_the_start_whatever_the_batch(name):
    starts = np.stack([T0, np.eye(4), T0 @ T0]).reshape(3, 1, 4, 4)
    pose, twist = PATHS[name].at(starts)(np.array([0.0, 0.3]))
    assert pose.shape == (2, 3, 1, 4, 4) and twist.shape == (2, 3, 1, 6)
    assert np.abs(pose[0] - starts).max() < 1e-14
    alone, rate = PATHS[name].at(T0)(0.3)
    assert np.abs(pose[1, 0, 0] - alone).max() < 1e-14
    assert np.abs(twist[1, 0, 0] - rate).max() < 1e-14


@pytest.mark.parametrize("name", ["line", "screw", "waypoints"])
def test_it_rests_once_there(name):
    pose, twist = PATHS[name].at(T0)(5.0)
    there = {"line": T0[:3, 3] + [0.1, -0.2, 0.3], "screw": dp.spatial.to_matrix(GOAL)[:3, 3], "waypoints": T0[:3, 3]}
    assert np.abs(pose[:3, 3] - there[name]).max() < 1e-14
    assert not twist.any()


def test_a_circle_closes():
    motion = PATHS["circle xy"].at(T0)
    assert np.abs(motion(3.0)[0] - T0).max() < 1e-15


def test_a_screw_moves_with_a_constant_body_twist():
    pose, twist = dp.Screw(GOAL, 2.0).at(T0)(np.linspace(0, 2, 7))
    body = np.einsum("tji,tj->ti", pose[:, :3, :3], twist[:, :3])
    assert np.ptp(body, axis=0).max() < 1e-14


BAD = [
    (lambda: dp.Circle(-0.1, 1.0), "Circle: radius = -0.1"),
    (lambda: dp.Circle(0.1, 0.0), "Circle: period = 0.0"),
    (lambda: dp.Circle(0.1, 1.0, plane="xz"), "did you mean 'zx'|xy, yz, zx"),
    (lambda: dp.Circle(float("nan"), 1.0), "Circle: radius = nan"),
    (lambda: dp.Line([1.0, 2.0], 1.0), r"Line: displacement of shape \(3,\)"),
    (lambda: dp.Line([1.0, 2.0, 3.0], -1.0), "Line: duration = -1.0"),
    (lambda: dp.Screw(np.ones(7), 1.0), r"\(4, 4\) or a dual quaternion \(8,\)"),
    (lambda: dp.Screw(2 * np.eye(4), 1.0), "a rotation and a last row"),
    (lambda: dp.Waypoints([GOAL], [1.0, 2.0]), "one time for each pose"),
    (lambda: dp.Waypoints([GOAL, GOAL], [2.0, 1.0]), "increasing"),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_trajectories_are_named(make, message):
    with pytest.raises(dp.DualpinError, match=message):
        make()


BAD_RESULTS = [
    (np.eye(4), r"a tuple \(pose \(4, 4\), twist \(6,\)\) expected"),
    ((np.eye(3), np.zeros(6)), r"pose of shape \(4, 4\) expected, got \(3, 3\)"),
    ((np.eye(4), np.zeros(3)), r"twist of shape \(6,\) expected, got \(3,\)"),
    ((np.eye(4) * np.nan, np.zeros(6)), "pose has entries that are not finite"),
    ((np.diag([1.0, 1.0, 2.0, 1.0]), np.zeros(6)), "not a rotation"),
    ((np.eye(4), np.zeros(6) + 1j), "real numbers expected"),
]


@pytest.mark.parametrize(("result", "message"), BAD_RESULTS)
def test_a_function_that_returns_something_else_is_named(result, message):
    with pytest.raises(dp.DualpinError, match=message):
        Callback(lambda t: result).at(T0)(np.array([0.5]))
