"""The first sample of a term is answered by bytecode, and by Python's route: the same bits, soon replaced."""

import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import dualpin as dp
from dualpin.call import evaluator, made_ahead
from dualpin.call.making import evaluator_of
from dualpin.engine import tuning
from dualpin.engine.jit import cache, kernel
from dualpin.terms import TERMS
from tests.odd_robots import every_joint

LONG = "rnea_derivatives"


@pytest.fixture
def cold(tmp_path, monkeypatch):
    monkeypatch.setenv("DUALPIN_CACHE_DIR", str(tmp_path))


def kernels(robot, term):
    return evaluator_of(robot, TERMS[term], {}).kernels


def slope(robot, x):
    return evaluator(robot, TERMS[LONG], "auto")(*x)


def until_real(found, f):
    """f(), until the fast call would be the one that answers."""
    end = time.monotonic() + 60
    while found.known(single=True) is None:
        assert time.monotonic() < end
        f()
        time.sleep(0.005)


def test_bits_are_the_same_first_later_and_in_batches(cold):
    robot = dp.load("ur5")
    q, v, a = robot.sample(3, seed=0)
    found = kernels(robot, LONG)
    first = dp.rnea_derivatives(robot, q[0], v[0], a[0])
    assert found._soon is not None and found.known(single=True) is None
    second = dp.rnea_derivatives(robot, q[0], v[0], a[0])
    until_real(found, lambda: dp.rnea_derivatives(robot, q[0], v[0], a[0]))
    third, many = dp.rnea_derivatives(robot, q[0], v[0], a[0]), dp.rnea_derivatives(robot, q, v, a)
    for x in zip(first, second, third, many, strict=True):
        assert all(np.array_equal(x[0], y) for y in (x[1], x[2], x[3][0]))


@pytest.mark.parametrize("n", [2, 100, tuning.SOON_SAMPLES])
def test_a_first_batch_is_answered_by_the_same_bytecode(cold, n):
    robot = dp.load("ur5").with_gravity((0, 0, -9 - n / 1000))  # no thread of another test compiles for it
    q, v, a = robot.sample(n, seed=0)
    found = kernels(robot, LONG)
    first = slope(robot, (q, v, a))
    assert found._soon is not None and found.known(single=False) is None
    end = time.monotonic() + 60
    while found.known(single=False) is None:
        assert time.monotonic() < end and np.array_equal(slope(robot, (q, v, a)), first)
        time.sleep(0.005)
    assert np.array_equal(slope(robot, (q, v, a)), first)


def test_batches_that_are_long_or_compiled_ahead_or_kept_wait_for_the_real_kernel(cold):
    robot = dp.load("ur5")
    slope(robot, robot.sample(tuning.SOON_SAMPLES + 1, seed=0))
    assert kernels(robot, LONG).known(single=False)
    again = dp.load("ur5")
    slope(again, robot.sample(3, seed=0))
    assert kernels(again, LONG).known(single=False) and kernels(again, LONG)._soon is None  # from the cache
    other = dp.load("panda")
    with made_ahead(other, [(LONG, {}), ("rnea", {})]):
        slope(other, other.sample(3, seed=0))
    assert kernels(other, LONG).known(single=False) and kernels(other, LONG)._soon is None


@pytest.mark.parametrize("term", ["coriolis", "aba", "frame_acceleration"])
def test_what_comes_soon_has_the_same_bits(cold, term, monkeypatch):
    monkeypatch.setattr(tuning, "SOON_FROM", 0)
    robot = every_joint()
    t = TERMS[term]
    options = t.settled(robot, {"frame": robot.frames[-1]} if any(x.name == "frame" for x in t.options) else {})
    rows = dict(zip(("q", "v", "a"), robot.sample(64, seed=1), strict=True))
    inputs = [rows.get(name, rows["v"]) for name in t.inputs]
    soon, real = (kernel.build(robot, t, options, single=True, soon=x) for x in (True, False))
    assert soon.soon and not real.soon
    assert np.array_equal(soon.rows(inputs), real.rows(inputs))


def test_what_is_kept_serves_the_next_process_and_gives_way(cold):
    robot = dp.load("ur5")
    x = robot.sample(seed=0)
    first = slope(robot, x)
    assert cache.info()["kernels"] == 1
    other = dp.load("ur5")  # as another process would find it
    assert np.array_equal(slope(other, x), first)
    assert kernels(other, LONG)._soon is not None and cache.info()["kernels"] == 1
    other.kernel(LONG)  # waits for the compiled kernel
    assert cache.info()["kernels"] == 2
    third = dp.load("ur5")
    assert np.array_equal(slope(third, x), first)
    assert kernels(third, LONG)._soon is None


def test_short_terms_and_other_engines_wait_for_the_real_one(cold):
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=0)
    dp.com(robot, q)
    assert kernels(robot, "com").known(single=True)
    dp.rnea_derivatives(robot, q, v, a, engine="compiled")
    assert kernels(robot, LONG).known(single=True)


def test_the_fast_call_is_compiled_when_a_kernel_waits_for_it(tmp_path):
    code = """
import time
import dualpin as dp
from dualpin.engine.jit import fast_call
robot = dp.load("ur5")
q, v, a = robot.sample(seed=0)
first = dp.rnea(robot, q, v, a)
assert not fast_call.addresses.made and not fast_call.at_hand()
end = time.monotonic() + 60
while not fast_call.addresses.made:
    assert (dp.rnea(robot, q, v, a) == first).all() and time.monotonic() < end
    time.sleep(0.001)
assert (dp.rnea(robot, q, v, a) == first).all()
from dualpin.call import evaluator, made_ahead
from dualpin.terms import TERMS
assert type(evaluator(robot, TERMS["rnea"], "auto")).__name__ == "builtin_function_or_method"
"""
    env = {**os.environ, "DUALPIN_CACHE_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], env=env, capture_output=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, b"")


def test_threads_that_come_first_together_get_the_same(cold):
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=0)
    expected, found, start = evaluator(robot, TERMS[LONG], "numpy")(q, v, a), [], threading.Barrier(4)

    def work():
        start.wait()
        found.extend(slope(robot, (q, v, a)) for _ in range(20))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert len({x.tobytes() for x in found}) == 1
    assert np.allclose(found[0], expected, rtol=1e-12, atol=1e-12)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_child_uses_what_its_parent_began_with(cold):
    robot = dp.load("ur5")
    x = robot.sample(seed=0)
    first = slope(robot, x)
    child = os.fork()
    if not child:
        same = all(np.array_equal(slope(robot, x), first) for _ in range(3))
        os._exit(0 if same else 1)
    assert os.waitpid(child, 0)[1] == 0
