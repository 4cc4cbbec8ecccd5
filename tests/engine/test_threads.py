"""Batches on several threads: the same bits, faster."""

from __future__ import annotations

import os
import pickle
import threading

import numpy as np
import pytest

import dualpin as dp
from dualpin.engine.jit import threads


@pytest.fixture(autouse=True)
def as_before():
    yield
    dp.set_num_threads(None)


@pytest.mark.parametrize("count", [2, 3, 5])
def test_the_bits_do_not_depend_on_the_number_of_threads(count):
    robot = dp.load("panda")
    q, v, a = robot.sample(20_001, seed=0)
    dp.set_num_threads(1)
    alone = dp.aba(robot, q, v, a)
    dp.set_num_threads(count)
    assert np.array_equal(dp.aba(robot, q, v, a), alone)


def test_every_sample_is_computed_once():
    done = np.zeros(1003, int)
    dp.set_num_threads(4)

    def work(start, stop):
        done[start:stop] += 1

    threads.spread(work, 1003, 1.0, 8)
    assert (done == 1).all()


def test_small_work_stays_on_one_thread():
    seen = set()
    dp.set_num_threads(4)
    threads.spread(lambda *_: seen.add(threading.get_ident()), 64, 1e-9, 8)
    assert seen == {threading.get_ident()}


@pytest.mark.parametrize("case", ["another dtype object", "Fortran order", "norms nearly 1"])
def test_batches_that_the_entry_leaves_to_python_are_shared_too(case):
    robot = dp.load("solo8", floating=True)
    q, v, a = robot.sample(20_000, seed=0)
    dp.set_num_threads(2)
    expected = dp.rnea(robot, q, v, a)
    out, tolerance = np.empty_like(expected), 0.0
    if case == "another dtype object":
        q, v, a = pickle.loads(pickle.dumps((q, v, a)))
    elif case == "Fortran order":
        out = np.asfortranarray(out)
    else:
        q[:, 3:7] *= 1 + 7e-7
        tolerance = 1e-5 * np.abs(expected).max()
    assert dp.rnea(robot, q, v, a, out=out) is out
    assert np.abs(out - expected).max() <= tolerance


def test_parts_within_parts_do_not_wait_for_themselves():
    done = []
    dp.set_num_threads(2)

    def work(start, stop):
        threads.spread(lambda *_: done.append(1), 1000, 1.0, 8)

    threads.spread(work, 100, 1.0, 8)
    assert len(done) == 13


def test_many_callers_with_different_numbers_of_threads():
    errors = []

    def work(parts):
        try:
            for _ in range(200):
                threads.spread(lambda *_: None, 8 * parts, 1.0, 8)
        except Exception as e:
            errors.append(e)

    dp.set_num_threads(8)
    callers = [threading.Thread(target=work, args=(k,)) for k in range(2, 8)]
    for t in callers:
        t.start()
    for t in callers:
        t.join()
    assert errors == []


def test_an_absurd_number_of_threads_is_kept_as_it_is():
    dp.set_num_threads(2**64 + 1)
    assert dp.get_num_threads() == 2**64 + 1
    assert threads.count.value == 2


def test_what_a_worker_raises_is_raised():
    dp.set_num_threads(2)

    def work(start, stop):
        if start:
            raise RuntimeError("second half")

    with pytest.raises(RuntimeError, match="second half"):
        threads.spread(work, 1000, 1.0, 8)


def test_the_environment_chooses(monkeypatch):
    monkeypatch.setenv("DUALPIN_NUM_THREADS", "3")
    assert dp.get_num_threads() == 3
    monkeypatch.setenv("DUALPIN_NUM_THREADS", "many")
    with pytest.raises(dp.ArgumentError, match="many"):
        dp.get_num_threads()
    monkeypatch.delenv("DUALPIN_NUM_THREADS")
    assert dp.get_num_threads() == threads.available()


@pytest.mark.parametrize("n", [0, -1, 1.5, "2", True])
def test_a_number_of_threads_that_is_none_is_refused(n):
    with pytest.raises(dp.ArgumentError, match="set_num_threads"):
        dp.set_num_threads(n)


def test_python_threads_share_a_kernel():
    robot = dp.load("ur5")
    q, v, a = robot.sample(3000, seed=1)
    expected = dp.rnea(robot, q, v, a)
    wrong = []

    def work(k):
        part = slice(k * 500, k * 500 + 900)
        for _ in range(50):
            if not np.array_equal(dp.rnea(robot, q[part], v[part], a[part]), expected[part]):
                wrong.append(k)

    running = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for t in running:
        t.start()
    for t in running:
        t.join()
    assert wrong == []


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_process_makes_its_own_threads():
    robot = dp.load("ur5")
    q, v, a = robot.sample(50_000, seed=1)
    dp.set_num_threads(2)
    expected = dp.rnea(robot, q, v, a)  # starts the worker thread, which a forked child does not have
    child = os.fork()
    if child == 0:
        os._exit(0 if np.array_equal(dp.rnea(robot, q, v, a), expected) else 1)
    assert os.waitpid(child, 0)[1] == 0
