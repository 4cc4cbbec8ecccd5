"""Tracking side by side with the same loop written on Pinocchio; results are checked before they are timed.

pytest benchmarks/test_tracking.py --benchmark-enable
"""

from __future__ import annotations

import time

import numpy as np
import pytest

import dualpin as dp
from dualpin.tracking.study import pa10

pin = pytest.importorskip("pinocchio")

START = np.radians([0.0, 30.0, 0.0, 60.0, 0.0, 60.0, 0.0])
RADIUS, PERIOD, DT, STEPS, GAIN = 0.1, 10.0, 0.1, 100, 1.0
BATCH = 1000


def pinocchio_arm():
    """The PA-10 in Pinocchio."""
    model, parent, placement = pin.Model(), 0, pin.SE3.Identity()
    for i, (d, alpha) in enumerate(
        zip((0.317, 0, 0.45, 0, 0.48, 0, 0.07), np.radians([-90, 90, -90, 90, -90, 90, 0]), strict=True)
    ):
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint_{i}")
        placement = pin.SE3(pin.rpy.rpyToMatrix(alpha, 0, 0), np.array([0, 0, d]))
    frame = model.addFrame(pin.Frame("tip", parent, 0, placement, pin.FrameType.OP_FRAME))
    return model, model.createData(), frame


def pinocchio_loop(model, data, frame, q):
    """RK4 and feedback at every stage, as one would write it."""
    pin.framesForwardKinematics(model, data, q)
    R_d, w = data.oMf[frame].rotation.copy(), 2 * np.pi / PERIOD
    u, v = np.eye(3)[1], np.eye(3)[2]
    centre = data.oMf[frame].translation - RADIUS * u

    def rate(t, q):
        J = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        X = pin.updateFramePlacement(model, data, frame)
        c, s = np.cos(w * t), np.sin(w * t)
        error = np.concatenate([centre + RADIUS * (c * u + s * v) - X.translation, pin.log3(R_d @ X.rotation.T)])
        twist = np.concatenate([RADIUS * w * (c * v - s * u), np.zeros(3)])
        return np.linalg.pinv(J) @ (twist + GAIN * error)

    for k in range(STEPS):
        t = k * DT
        k1 = rate(t, q)
        k2 = rate(t + DT / 2, q + DT / 2 * k1)
        k3 = rate(t + DT / 2, q + DT / 2 * k2)
        k4 = rate(t + DT, q + DT * k3)
        q = q + DT / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return q


def dualpin_loop(start):
    path = dp.Circle(RADIUS, PERIOD, plane="yz", start=start)
    return dp.track(ARM, path, method="rk4", dt=DT, t_end=STEPS * DT, gain=GAIN)


ARM = pa10()
STARTS = START + 0.02 * np.random.default_rng(0).normal(size=(BATCH, 7))


def best_of(f, times=5):
    seconds = []
    for _ in range(times):
        begun = time.perf_counter()
        f()
        seconds.append(time.perf_counter() - begun)
    return min(seconds)


@pytest.fixture(scope="module")
def oracle():
    arm = pinocchio_arm()
    # the same numbers first: rounding over a hundred steps
    assert np.abs(dualpin_loop(START).q[-1] - pinocchio_loop(*arm, START)).max() < 1e-12
    assert np.abs(dualpin_loop(STARTS[:5]).q[4, -1] - pinocchio_loop(*arm, STARTS[4])).max() < 1e-12
    return arm


def test_one_trajectory(benchmark, oracle):
    benchmark.group = "track"
    reference = best_of(lambda: pinocchio_loop(*oracle, START))
    benchmark(dualpin_loop, START)
    ratio = reference / best_of(lambda: dualpin_loop(START))
    benchmark.extra_info.update(steps=STEPS, batch=1, times_faster_than_pinocchio=round(ratio, 2))
    if not benchmark.disabled:
        assert ratio > 1


def test_a_thousand_trajectories(benchmark, oracle):
    benchmark.group = "track"
    reference = best_of(lambda: pinocchio_loop(*oracle, START))
    benchmark(dualpin_loop, STARTS)
    seconds = best_of(lambda: dualpin_loop(STARTS)) / BATCH
    alone = best_of(lambda: dualpin_loop(START))
    benchmark.extra_info.update(
        steps=STEPS, batch=BATCH, times_faster_than_pinocchio=round(reference / seconds, 1),
        times_faster_than_alone=round(alone / seconds, 1),
    )  # fmt: skip
    if not benchmark.disabled:
        assert reference / seconds > 20
