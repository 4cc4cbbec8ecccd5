"""engine="tiered": NumPy answers at once, the kernel when a thread has compiled it."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import dualpin as dp
from dualpin.call import kernels
from dualpin.engine.jit import kernel as jit
from dualpin.engine.jit.host import CompilerError


@pytest.fixture
def robot(monkeypatch, tmp_path):
    monkeypatch.setenv("DUALPIN_CACHE_DIR", str(tmp_path))
    return dp.load("ur5")


def until_compiled(robot, single):
    """The answers on the way, until one has the kernel's bits."""
    q, v, a = robot.sample(None if single else 50, seed=0)
    end, found = time.monotonic() + 60, []
    compiled = dp.rnea(dp.load("ur5"), q, v, a, engine="compiled")
    while not found or not np.array_equal(found[-1], compiled):
        assert time.monotonic() < end
        found.append(dp.rnea(robot, q, v, a, engine="tiered"))
    return found, dp.rnea(robot, q, v, a, engine="numpy"), compiled


@pytest.mark.parametrize("single", [True, False])
def test_numpy_answers_until_the_kernel_is_there(robot, monkeypatch, single):
    gate = threading.Event()
    build = kernels.Kernels._built
    monkeypatch.setattr(kernels.Kernels, "_built", lambda *x: (gate.wait(20), build(*x))[1])
    q, v, a = robot.sample(None if single else 50, seed=0)
    for _ in range(3):
        assert np.array_equal(dp.rnea(robot, q, v, a, engine="tiered"), dp.rnea(robot, q, v, a, engine="numpy"))
    gate.set()
    found, interpreted, compiled = until_compiled(robot, single)
    assert all(np.array_equal(x, interpreted) or np.array_equal(x, compiled) for x in found)
    out = np.empty_like(compiled)
    for _ in range(3):
        assert dp.rnea(robot, q, v, a, engine="tiered", out=out) is out
        assert np.array_equal(out, compiled)


def test_it_is_compiled_once_whoever_asks(robot, monkeypatch):
    made = []
    original = jit.compiled
    monkeypatch.setattr(jit, "compiled", lambda *x: made.append(1) or original(*x))
    q = robot.sample(20, seed=0)[0]
    threads = [threading.Thread(target=lambda: dp.gravity(robot, q, engine="tiered")) for _ in range(8)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    expected = dp.gravity(robot, q)
    assert len(made) == 1 and np.array_equal(dp.gravity(robot, q, engine="tiered"), expected)


def test_auto_never_answers_one_way_and_then_another(robot):
    q, v, a = robot.sample(seed=0)
    dp.rnea(robot, q, v, a, engine="tiered")
    first = dp.rnea(robot, q, v, a)
    assert np.array_equal(first, dp.rnea(robot, q, v, a, engine="compiled"))


def test_mistakes_and_machines_without_a_compiler(robot, monkeypatch):
    q, v, a = robot.sample(seed=0)
    with pytest.raises(dp.ShapeError, match="rnea: q of shape"):
        dp.rnea(robot, q[:3], v, a, engine="tiered")

    def none(*_):
        raise CompilerError("none here")

    monkeypatch.setattr(jit, "compiled", none)
    for _ in range(20):
        tau = dp.rnea(robot, q, v, a, engine="tiered")
        time.sleep(0.01)
    assert np.array_equal(tau, dp.rnea(robot, q, v, a, engine="numpy"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_child_compiles_on_its_own(robot):
    q, v, a = robot.sample(seed=0)
    dp.rnea(robot, q, v, a, engine="tiered")
    child = os.fork()
    if not child:
        end = time.monotonic() + 30
        f = dp.rnea(robot, q, v, a, engine="compiled")
        while not np.array_equal(dp.rnea(robot, q, v, a, engine="tiered"), f) and time.monotonic() < end:
            time.sleep(0.01)
        os._exit(0 if time.monotonic() < end else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_a_process_may_end_while_it_compiles(tmp_path):
    code = "import dualpin as dp; r = dp.load('ur5'); dp.aba_derivatives(r, *r.sample(seed=0), engine='tiered')"
    env = {**os.environ, "DUALPIN_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, env=env, timeout=60
    )
    assert (done.returncode, done.stderr) == (0, "")
