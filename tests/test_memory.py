"""Memory of large results: lent, returned, bounded, and never in the way."""

from __future__ import annotations

import copy
import gc
import os
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

import dualpin as dp
from dualpin import memory

N = 8192  # of ur5's poses: 6 MB


@pytest.fixture(scope="module")
def robot():
    return dp.load("ur5")


@pytest.fixture
def q(robot, small_heap):
    memory.clear()
    return robot.sample(N, seed=0)[0]


def lent():
    return memory.stats()["lent_blocks"]


def test_memory_comes_back_when_the_last_view_dies(robot, q):
    before = lent()
    poses = dp.fk(robot, q)
    view, lines = poses[:, 2], list(poses[5])
    assert lent() == before + 1
    del poses
    assert lent() == before + 1 and np.isfinite(view).all()
    del view
    assert lent() == before + 1 and np.isfinite(lines[0]).all()
    del lines
    assert lent() == before and memory.stats()["idle_bytes"] >= N * 6 * 16 * 8


def test_the_same_memory_serves_the_next_result(robot, q):
    address = dp.fk(robot, q).ctypes.data
    served = memory.stats()["served"]
    assert dp.fk(robot, q).ctypes.data == address
    assert memory.stats()["served"] == served + 1


def test_two_results_that_live_do_not_share_memory(robot, q):
    a, b = dp.fk(robot, q), dp.fk(robot, -q)
    assert not np.may_share_memory(a, b)
    assert np.array_equal(a, dp.fk(robot, q)) and np.array_equal(b, dp.fk(robot, -q))


@pytest.mark.parametrize("term", ["fk", "jacobian", "rnea"])
def test_results_begin_on_a_line_and_are_ordinary_arrays(robot, term):
    q, v, a = robot.sample(50_000, seed=0)
    x = {"fk": lambda: dp.fk(robot, q), "jacobian": lambda: dp.jacobian(robot, q, "tool0"),
         "rnea": lambda: dp.rnea(robot, q, v, a)}[term]()  # fmt: skip
    assert x.ctypes.data % 64 == 0 and x.flags.c_contiguous and x.flags.writeable and x.flags.aligned
    assert type(x) is np.ndarray and x.dtype is np.dtype(float) and len(x) == 50_000
    assert np.array_equal(pickle.loads(pickle.dumps(x)), x) and np.array_equal(copy.deepcopy(x), x)
    assert copy.deepcopy(x).flags.owndata
    assert np.array_equal(np.resize(x, (2, *x.shape))[1], x)
    with pytest.raises(ValueError, match="does not own its data"):
        x.resize((1,))
    assert np.shares_memory(np.from_dlpack(x), x)


def test_the_pool_is_bounded_and_a_loop_does_not_grow(robot, q):
    before = memory.limit()
    try:
        memory.limit(64 << 20)
        kept = []
        for k in range(200):
            kept.append(dp.fk(robot, q[: 4096 + 16 * k]))
            if len(kept) > 20:
                kept.clear()
            assert memory.stats()["idle_bytes"] <= 64 << 20
        kept.clear()
        mapped = memory.stats()["mapped"]
        for _ in range(1000):
            memory.empty((1 << 19,), np.dtype(float))
        assert memory.stats()["mapped"] <= mapped + 1
        assert memory.limit(0) == 0 and memory.stats()["idle_bytes"] == 0
        before_it = lent()
        x = dp.fk(robot, q)
        assert lent() == before_it and len(x) == N  # NumPy's
    finally:
        memory.limit(before)


def test_blocks_leave_no_garbage_that_only_the_collector_frees():
    before = memory.limit()
    gc.collect()
    gc.disable()
    try:
        memory.limit(9 << 20)  # of the two sizes one can be idle: each result is mapped
        mapped = memory.stats()["mapped"]
        for k in range(40):
            memory.empty(((3, 7)[k % 2] << 20,), np.dtype("u1"))
        assert memory.stats()["mapped"] >= mapped + 39
        assert gc.collect() < 40
    finally:
        gc.enable()
        memory.limit(before)


@pytest.mark.campaign
def test_a_hundred_thousand_results_do_not_grow():
    code = """
import resource, numpy as np, dualpin as dp
r = dp.load("ur5"); q = r.sample(4096, seed=0)[0]
for k in range(100_000):
    dp.fk(r, q[: 2800 + k % 1200])
    if k == 5000:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2000, "kB more"
"""
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], check=True, timeout=600)


def test_arrays_outlive_the_pool(robot, q):
    x = dp.fk(robot, q)
    expected = x.copy()
    before = memory.limit()
    try:
        memory.limit(0)
        memory.clear()
        assert np.array_equal(x, expected)
        x[:] = 1.0
        del x
        assert memory.stats()["idle_blocks"] == 0
    finally:
        memory.limit(before)


def test_arrays_that_live_to_the_end_of_the_process_do_no_harm():
    code = "import dualpin as dp; r = dp.load('ur5'); x = dp.fk(r, r.sample(8192, seed=0)[0]); y = x[1:]; r.x = None"
    code = code.replace("r.x = None", "import builtins; builtins.kept = x")
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


def test_threads_get_memory_of_their_own(robot, q):
    expected = {sign: dp.fk(robot, sign * q) for sign in (1.0, -1.0, 0.5, 0.25)}
    wrong = []

    def work(sign):
        for _ in range(30):
            x = dp.fk(robot, sign * q)
            if not np.array_equal(x, expected[sign]):
                wrong.append(sign)

    threads = [threading.Thread(target=work, args=(sign,)) for sign in expected for _ in range(2)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert wrong == []
    gc.collect()
    assert lent() <= 4


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_child_has_a_pool_of_its_own(robot, q):
    x = dp.fk(robot, q)
    expected = x.copy()
    dp.fk(robot, -q)  # idle
    child = os.fork()
    if not child:
        same = np.array_equal(x, expected) and memory.stats()["idle_blocks"] == 0
        x[:] = 0.0
        del x
        same = same and memory.stats()["idle_blocks"] == 0 and np.array_equal(dp.fk(robot, q), expected)
        os._exit(0 if same else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert np.array_equal(x, expected)


@pytest.mark.parametrize(
    ("text", "expected"), [("0", "0 0"), ("1000000000", "1000000000 1"), ("much", "ArgumentError")]
)
def test_the_environment_sets_the_limit(text, expected):
    code = """
import dualpin as dp
r = dp.load("ur5")
try:
    x = dp.fk(r, r.sample(8192, seed=0)[0])
    print(dp.memory.limit(), dp.memory.stats()["lent_blocks"])
except dp.ArgumentError as e:
    print("ArgumentError" if "DUALPIN_MEMORY_LIMIT='much'" in str(e) else e)
"""
    env = {**os.environ, "DUALPIN_MEMORY_LIMIT": text}
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, env=env)
    assert done.stdout.strip() == expected, done.stderr


@pytest.mark.parametrize("wrong", [-1, 1.5, "1 GB", True])
def test_a_limit_is_a_number_of_bytes(wrong):
    with pytest.raises(dp.ArgumentError, match=r"memory\.limit: bytes"):
        memory.limit(wrong)


def test_a_result_too_large_for_memory_is_numpys_error(robot):
    with pytest.raises(MemoryError):
        memory.empty((1 << 52,), np.dtype(float))
