"""Many threads and processes that begin together: nothing crashes, nothing hangs, every bit is the same."""

from __future__ import annotations

import copy
import json
import os
import pickle
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp

STRESS = Path(__file__).with_name("stress.py")
forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def python(*arguments, place, timeout=300, **environment):
    """A process of its own, with a cache of its own; what it prints."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", *arguments],
        env=os.environ | {"DUALPIN_CACHE_DIR": str(place)} | environment,
        capture_output=True, text=True, timeout=timeout, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


def stress(*arguments, place, timeout=300):
    result = json.loads(python(str(STRESS), *map(str, arguments), place=place, timeout=timeout))
    assert result["errors"] == []
    assert result["numpy"] == []
    assert result["answers"]
    assert {job: found for job, found in result["answers"].items() if len(found) != 1} == {}
    return {job: next(iter(found)) for job, found in result["answers"].items()}


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """A cache that is empty for the first test that uses it."""
    return tmp_path_factory.mktemp("cache")


def test_threads_that_make_the_first_call_together(shared):
    cold = stress("first", 8, "ur5", place=shared)
    assert stress("first", 8, "ur5", place=shared) == cold


@pytest.mark.campaign
@pytest.mark.parametrize("cache", ["cold", "warm"])
def test_threads_that_make_the_first_call_together_twenty_times(tmp_path, cache):
    robots = ("ur5", "panda", "solo8+", "ur5+")
    answers = [
        stress("first", 8, *robots, place=tmp_path / (str(k) if cache == "cold" else ""), timeout=600)
        for k in range(20)
    ]
    assert all(a == answers[0] for a in answers)


@pytest.mark.parametrize(
    ("way", "threads"),
    [
        ("imports", 16),
        *(
            pytest.param(way, n, marks=pytest.mark.campaign)
            for way in ("terms", "tools", "judge", "validate", "jax")
            for n in (2, 16)
        ),
    ],
)
def test_threads_that_use_the_package_first_together(tmp_path, way, threads):
    if way in ("validate", "jax"):
        pytest.importorskip({"validate": "pinocchio"}.get(way, way))
    found = json.loads(python(str(STRESS.with_name("ways_in.py")), way, str(threads), place=tmp_path))
    assert found == {"ended": threads, "distinct": 1, "errors": []}


@forks
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_that_begin_while_a_thread_compiles(shared, method):
    stress("processes", method, 2, 2, 0, "ur5", place=shared)


@forks
@pytest.mark.campaign
def test_threads_in_processes_for_a_minute(tmp_path):
    ways = [
        stress("processes", method, 4, 8, seconds, "ur5", "panda", "solo8+", place=tmp_path, timeout=900)
        for method, seconds in (("fork", 60), ("spawn", 60), ("forkserver", 10))
    ]
    assert ways[0] == ways[1] == ways[2]


FORK = """
import gc, os, sys, threading, time, warnings
import numpy as np, dualpin as dp
from dualpin import locking
from dualpin.call import find

locking.FORK_WAIT = float(sys.argv[1])
known = dp.load("ur5")
q, v, a = known.sample(50, seed=0)
expected = dp.rnea(known, q, v, a)
large = dp.load("talos", floating=True)
state = large.sample(3, seed=0)
threading.Thread(target=dp.coriolis, args=(large, *state[:2]), kwargs={"engine": "compiled"}, daemon=True).start()
while not locking.LOCK.depth:
    time.sleep(1e-3)
time.sleep(0.3)  # it is at work
child = os.fork()
if child:
    end, done = time.monotonic() + 60, 0
    while not done and time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        time.sleep(0.01)
    if not done:
        os.kill(child, 9)
    print("child", "hung" if not done else status)
    os._exit(0)
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    assert np.array_equal(dp.rnea(known, q, v, a), expected)  # compiled before
    for _ in range(2):
        fresh = dp.load("ur5").with_gravity((0, 0, -1.6))
        M, h, one = dp.crba(fresh, q), dp.bias(fresh, q, v), dp.rnea(fresh, q[0], v[0], a[0])
compilers = find(fresh, dp.terms.TERMS["crba"], {}) is not None
print("compiled" if compilers else "numpy", len(said), *(str(w.message) for w in said))
assert np.abs(M - dp.crba(fresh, q, engine="numpy")).max() < 1e-12
assert np.abs(h - dp.bias(fresh, q, v, engine="numpy")).max() < 1e-11
del known, fresh
gc.collect()
print("freed")
"""


@forks
@pytest.mark.parametrize("wait", [20.0, 0.0])
def test_a_child_of_a_process_that_compiles(tmp_path, wait):
    """It has kernels of its own if the fork could wait, else it says so once and computes with NumPy."""
    lines = python("-c", FORK, str(wait), place=tmp_path).splitlines()
    assert sorted(lines)[0] == "child 0"
    assert "freed" in lines
    engine, count, *message = next(x for x in lines if x.startswith(("compiled", "numpy"))).split(maxsplit=2)
    assert (engine, count) == (("compiled", "0") if wait else ("numpy", "1"))
    assert wait or "another thread was compiling when this process was forked" in message[0]


LOADER = """
import multiprocessing as mp, queue, sys, threading
import numpy as np, dualpin as dp

def worker(robot, kernel, asked, answered):
    dp.set_num_threads(1)
    while (part := asked.get()) is not None:
        q, v, a = robot.sample(200, seed=part)
        answered.put((part, kernel(q, v, a).sum(), dp.crba(robot, q).sum()))

def main(method):
    context = mp.get_context(method)
    robot = dp.load("panda")
    kernel = robot.kernel("rnea")
    asked, answered, ready = context.Queue(), context.Queue(), queue.Queue()
    # the main thread computes and another takes what comes, as loaders of batches do
    threading.Thread(target=lambda: [ready.put(answered.get()) for _ in range(12)], daemon=True).start()
    dp.rnea(robot, *robot.sample(60_000, seed=0))  # threads of our own, which no child has
    crowd = [context.Process(target=worker, args=(robot, kernel, asked, answered), daemon=True) for _ in range(2)]
    for p in crowd:
        p.start()
    for part in range(12):
        asked.put(part)
    results = sorted(ready.get(timeout=60) for _ in range(12))
    for p in crowd:
        asked.put(None)
    for p in crowd:
        p.join()
    for part, tau, M in results:
        q, v, a = robot.sample(200, seed=part)
        assert tau == kernel(q, v, a).sum() and M == dp.crba(robot, q).sum()
    # a pool of processes, asked from several threads, as joblib does
    from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
    with ProcessPoolExecutor(2, mp_context=context) as pool, ThreadPoolExecutor(3) as callers:
        batches = [robot.sample(50, seed=k) for k in range(6)]
        futures = list(callers.map(lambda b: pool.submit(kernel, *b), batches))
        assert all(np.array_equal(f.result(60), kernel(*b)) for f, b in zip(futures, batches))
    print([p.exitcode for p in crowd])

if __name__ == "__main__":
    main(sys.argv[1])
"""


@forks
@pytest.mark.parametrize("method", ["fork", "spawn", pytest.param("forkserver", marks=pytest.mark.campaign)])
def test_loaders_and_pools_take_robots_and_kernels(tmp_path, method):
    program = tmp_path / "loader.py"
    program.write_text(LOADER)
    assert python(str(program), method, place=tmp_path).strip() == "[0, 0]"


# --- pickles --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def robot():
    return dp.load("ur5")


@pytest.mark.parametrize(
    ("term", "options"),
    [("rnea", {}), ("crba", {}), ("jacobian", {"frame": "tool0", "reference": "local"}), ("frame_pose", {"frame": 3})],
)
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_kernels_pickle(robot, term, options, dtype):
    f = robot.kernel(term, dtype=dtype, **options)
    state = robot.sample(4, seed=0)
    x = [y.astype(dtype) for y in state[: len(dp.terms.TERMS[term].inputs)]]
    expected = f(*x)
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        g = pickle.loads(pickle.dumps(f, protocol))
        assert type(g) is type(f) and g.__name__ == f.__name__
        assert g(*x).dtype == dtype
        assert np.array_equal(g(*x), expected)
        assert np.array_equal(g(*(y[0] for y in x)), expected[0])
    both, again = pickle.loads(pickle.dumps((f, f)))
    assert both is again
    assert all(np.array_equal(g(*x), expected) for g in (copy.deepcopy(f), copy.copy(f)))


def test_kernels_pickle_without_a_compiler(robot, monkeypatch):
    from dualpin.engine.jit import fast_call

    monkeypatch.setattr(fast_call, "supported", lambda *_: False)
    f = robot.with_gravity((0, 0, -1)).kernel("gravity")
    g = pickle.loads(pickle.dumps(f))
    q = robot.sample(3, seed=0)[0]
    assert not isinstance(g, type(len))
    assert np.array_equal(f(q), g(q))


def test_a_kernel_is_pickled_without_its_code(robot):
    bare = len(pickle.dumps(robot))
    kernel = robot.kernel("coriolis")
    kernel(*robot.sample(3, seed=0)[:2])
    assert len(pickle.dumps(robot)) == bare
    assert len(pickle.dumps(kernel)) < bare + 500


def test_capsules_of_others_are_refused_as_ever(robot):
    import datetime

    robot.kernel("rnea")
    with pytest.raises(TypeError, match="cannot pickle 'PyCapsule' object"):
        pickle.dumps(datetime.datetime_CAPI)
    assert pickle.loads(pickle.dumps(len)) is len


def test_a_kernel_that_is_pickled_and_dropped_leaves_nothing_behind(robot):
    f = robot.kernel("gravity")
    text = pickle.dumps(f)
    before = sys.getrefcount(f)
    for _ in range(3):
        assert pickle.dumps(f) == text
        pickle.loads(text)
    assert sys.getrefcount(f) == before


# --- the lock -------------------------------------------------------------------------------------


def test_what_is_made_once_is_made_once():
    from concurrent.futures import ThreadPoolExecutor

    from dualpin.locking import Once

    made = []

    @Once
    def slow():
        time.sleep(0.02)
        made.append(object())
        return made[-1]

    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(lambda _: slow(), range(8)))
    assert len(made) == 1 and all(r is made[0] for r in results)


def test_what_fails_is_tried_again():
    from dualpin.locking import LOCK, Once

    attempts = []

    @Once
    def fails_first():
        attempts.append(1)
        if len(attempts) == 1:
            raise ValueError("not yet")
        return 7

    with pytest.raises(ValueError, match="not yet"):
        fails_first()
    assert LOCK.depth == 0
    assert fails_first() == 7 == fails_first()
    assert len(attempts) == 2


HELD = """
import os, sys, threading, time
import dualpin as dp
from dualpin.model import robot as module

robot, begun = dp.load("ur5"), threading.Event()
constants = module.constants

def slow(robot):
    begun.set()
    time.sleep(3)
    return constants(robot)

module.constants = slow
thread = threading.Thread(target=lambda: robot.numbers)
thread.start()
begun.wait()
child = os.fork()
if not child:
    module.constants = constants
    print(dp.load("ur5").numbers, flush=True)
    os._exit(0)
end, done = time.monotonic() + 20, 0
while not done and time.monotonic() < end:
    done, status = os.waitpid(child, os.WNOHANG)
    time.sleep(0.01)
if not done:
    os.kill(child, 9)
assert done and not status
"""


@forks
def test_a_property_that_another_thread_computes_at_a_fork(tmp_path):
    assert python("-c", HELD, place=tmp_path).strip() == "double"
