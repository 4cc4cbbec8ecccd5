"""The fast call among threads and over time: who owns what, and for how long."""

from __future__ import annotations

import copy
import gc
import pickle
import subprocess
import sys
import threading
import weakref

import numpy as np
import pytest

import dualpin as dp
from dualpin.engine.jit import fast_call as entry

pytestmark = pytest.mark.skipif(not entry.supported(), reason="needs CPython 3.11 or later on 64 bits")


@pytest.fixture(scope="module")
def robot():
    return dp.load("ur5")


@pytest.fixture(scope="module")
def state(robot):
    return robot.sample(seed=1)


@pytest.fixture(scope="module")
def expected(robot, state):
    tau = dp.rnea(robot, *state, engine="numpy")
    got = robot.kernel("rnea")(*state)
    assert np.abs(got - tau).max() < 1e-13 * np.abs(tau).max()
    return got


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_one_wrong_quaternion_among_many_is_found(threads):
    robot = dp.load("ur5", floating=True)
    q, v, a = robot.sample(5000, seed=0)
    dp.set_num_threads(threads)
    try:
        expected, out = dp.rnea(robot, q, v, a), np.empty((5000, 12))
        assert np.array_equal(dp.rnea(robot, q, v, a, out=out), expected)
        q[4321, 3:7] *= 1.001
        for given in (None, out):
            with pytest.raises(dp.ArgumentError, match=r"unit quaternion.* at sample \(4321,\)"):
                dp.rnea(robot, q, v, a, out=given)
    finally:
        dp.set_num_threads(None)


def test_threads_of_small_stacks_are_safe():
    code = """
import threading, numpy as np, dualpin as dp
r = dp.load("panda"); q, v, a = r.sample(100, seed=0); f = r.kernel("rnea_derivatives")
f(q, v, a); out = np.empty_like(f(q, v, a))
threading.stack_size(32768)
t = threading.Thread(target=f, args=(q, v, a, out)); t.start(); t.join()
assert np.array_equal(out, f(q, v, a))
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


def test_large_results_take_their_scratch_from_the_heap():
    robot = dp.load("tiago_dual")
    q, _, _ = robot.sample(2, seed=0)
    one = robot.kernel("crba")
    assert np.array_equal(one(q[0]), dp.crba(robot, q)[0])


def test_an_unknown_kernel_or_type_is_refused(robot):
    with pytest.raises(dp.ArgumentError, match="did you mean 'rnea'"):
        robot.kernel("rneaa")
    with pytest.raises(dp.ArgumentError, match="float64 or float32"):
        robot.kernel("rnea", dtype=complex)
    with pytest.raises(dp.FrameNotFoundError, match="tool0"):
        robot.kernel("frame_pose", frame="tool1")


def test_references_do_not_leak(robot, state, small_heap):
    f, out = robot.kernel("rnea"), np.empty(6)
    many, result = robot.sample(3, seed=0), np.empty((3, 6))
    things = [*state, out, *many, result, np.dtype(float), f, None, np.empty]
    for call in (
        lambda: f(*state), lambda: f(*state, out=out), lambda: f(*state, out), lambda: f(*state, out=None),
        lambda: f(*many, out=result), lambda: f(state[0].tolist(), *state[1:]), lambda: f(*many),
    ):  # fmt: skip
        call()
        gc.collect()
        before, blocks = [sys.getrefcount(x) for x in things], sys.getallocatedblocks()
        quick = "tolist" not in call.__code__.co_names
        for _ in range(20_000 if quick else 1_000):
            call()
        gc.collect()
        after = [sys.getrefcount(x) for x in things]
        # a leak would be 20 000; other threads change the counts of None and of the dtype
        assert all(abs(b - a) <= 50 for a, b in zip(before, after, strict=True))
        assert sys.getallocatedblocks() - blocks < 500


def test_errors_do_not_leak_either(robot, state, small_heap):
    f = robot.kernel("rnea")
    bad = np.zeros(5)

    def wrong():
        with pytest.raises(dp.ShapeError):
            f(state[0], state[1], bad)

    wrong()
    before = [sys.getrefcount(x) for x in (*state, bad)]
    for _ in range(300):
        wrong()
    gc.collect()
    assert all(abs(sys.getrefcount(x) - b) <= 2 for x, b in zip((*state, bad), before, strict=True))


def test_the_callable_outlives_the_robot_and_the_robot_is_freed():
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=1)
    f = robot.kernel("rnea")
    tau = f(q, v, a)
    gone = weakref.ref(robot)
    del robot
    gc.collect()
    assert gone() is None
    assert np.array_equal(f(q, v, a), tau)
    assert np.array_equal(f(q.tolist(), v, a), tau)
    assert np.array_equal(f(q[None], v, a)[0], tau)


def test_robots_with_machine_code_can_be_copied_and_pickled():
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=0)
    tau = dp.rnea(robot, q, v, a)
    for other in (copy.copy(robot), copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))):
        assert np.array_equal(dp.rnea(other, q, v, a), tau)


def test_two_threads_at_once(robot):
    q, v, a = robot.sample(2, seed=4)
    f = robot.kernel("rnea")
    expected = f(q, v, a)
    wrong = []

    def work(i):
        out = np.empty(6)
        for _ in range(20_000):
            f(q[i], v[i], a[i], out=out)
            if not np.array_equal(out, expected[i]):
                wrong.append(i)

    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
    finally:
        sys.setswitchinterval(before)
    assert wrong == []


def test_the_public_function_takes_the_same_way(robot, state, expected):
    assert np.array_equal(dp.rnea(robot, *state), expected)
    out = np.empty(6)
    assert dp.rnea(robot, *state, out=out) is out
    assert np.array_equal(out, expected)
    with pytest.raises(dp.ShapeError, match="q of shape"):
        dp.rnea(robot, np.zeros(5), *state[1:])
