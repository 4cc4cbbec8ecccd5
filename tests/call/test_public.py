"""Public functions answered by machine code: whatever differs from the calls before is seen."""

from __future__ import annotations

import copy
import gc
import inspect
import pickle
import subprocess
import sys
import threading
import types
import typing

import numpy as np
import pytest

import dualpin as dp
from dualpin import functions
from dualpin.call import evaluate
from dualpin.engine.jit import fast_call
from dualpin.engine.jit import public as machine

QUICK = [getattr(functions, name) for name in functions.__all__]
QUICK = [f for f in QUICK if isinstance(f, types.BuiltinFunctionType)]
needs_code = pytest.mark.skipif(not fast_call.supported(), reason="needs CPython 3.11 or later on 64 bits")


@pytest.fixture(scope="module")
def robot():
    return dp.load("ur5")


@pytest.fixture(scope="module")
def state(robot):
    return robot.sample(seed=1)


def known(robot):
    """How many forms of calls with this robot machine code knows."""
    return sum(form.robot == id(robot) for bucket in machine._buckets for form in bucket)


@needs_code
def test_most_functions_are_built_in_and_look_like_python():
    assert len(QUICK) > 20
    for f in QUICK:
        signature = inspect.signature(f)
        assert next(iter(signature.parameters)) == "robot" and "out" in signature.parameters
        assert signature.parameters["engine"].default == "auto"
        assert len(f.__doc__.strip()) > 40 and "--" not in f.__doc__.splitlines()[:2]
        assert f.__module__.startswith("dualpin.functions.") and f.__qualname__ == f.__name__
        assert pickle.loads(pickle.dumps(f)) is f and copy.deepcopy(f) is f


def test_every_order_of_arguments_gives_the_same(robot, state):
    q, v, a = state
    expected = dp.rnea(robot, q, v, a, engine="numpy")
    out, f_ext = np.empty(6), np.zeros((6, 6))
    for _ in range(3):  # first the Python route, then machine code
        for found in (
            dp.rnea(robot, q, v, a), dp.rnea(robot, q, v, a=a), dp.rnea(robot, q, a=a, v=v),
            dp.rnea(robot, v=v, a=a, q=q), dp.rnea(robot=robot, q=q, v=v, a=a),
            dp.rnea(robot, q, v, a, None), dp.rnea(robot, q, v, a, f_ext=None),
            dp.rnea(robot, q, v, a, out=None), dp.rnea(robot, q, v, a, out=out), dp.rnea(robot, q, v, out=out, a=a),
            dp.rnea(robot, q, v, a, engine="auto"), dp.rnea(robot, q, v, a, f_ext),
            dp.rnea(robot, q, v, a, f_ext=f_ext),
            dp.rnea(robot, q, v, a, f_ext, out=out), dp.rnea(robot, q.tolist(), v, tuple(a)),
        ):  # fmt: skip
            assert np.abs(found - expected).max() < 1e-12
        assert dp.rnea(robot, q, v, a, out=out) is out
        assert dp.rnea(robot, q, v, out=out, a=a) is out


def test_the_same_array_twice_is_no_form_of_its_own(robot, state):
    q, v, a = state
    dp.rnea(robot, q, v, v), dp.rnea(robot, q, v, v)
    assert not np.array_equal(dp.rnea(robot, q, v, a), dp.rnea(robot, q, v, v))
    assert np.array_equal(dp.rnea(robot, q, v, a), evaluate(robot, "rnea", {"q": q, "v": v, "a": a}))


def test_options_that_change_are_seen(state):
    robot, q = dp.load("ur5"), state[0]  # a separate robot: its many forms fill a bucket and are deleted with it
    frames = [*robot.frame_names, *range(len(robot.frames)), *robot.frames]
    for _ in range(2):
        for frame in frames:
            expected = evaluate(robot, "frame_pose", {"q": q}, frame=frame)
            assert np.array_equal(dp.fk(robot, q, frame), expected)
            assert np.array_equal(dp.fk(robot, q, frame=frame), expected)
            for reference in ("world", "local", "local_world_aligned"):
                J = dp.jacobian(robot, q, frame, reference)
                assert np.array_equal(J, evaluate(robot, "jacobian", {"q": q}, frame=frame, reference=reference))
        assert dp.fk(robot, q).shape == (6, 4, 4)
        assert dp.fk(robot, q, as_="dual_quaternion").shape == (6, 8)
        assert dp.fk(robot, q, "tool0", as_="dual_quaternion").shape == (8,)


@needs_code
def test_names_made_anew_each_time_do_not_pile_up(state):
    robot = dp.load("ur5")
    for i in range(300):
        dp.fk(robot, state[0], "".join(["tool", "0"]))
        dp.fk(robot, state[0], f"{robot.joint_names[i % 6]}")
    assert known(robot) <= 8


def test_mistakes_after_calls_that_were_right(robot, state):
    q, v, a = state
    dp.rnea(robot, q, v, a), dp.rnea(robot, q, v, a)
    for wrong, error, message in (
        ((robot, q, v), TypeError, r"rnea\(\) missing 1 required positional argument: 'a'"),
        ((robot, q, v, a, None, None), TypeError, "rnea.. takes from 4 to 5 positional arguments"),
        (("ur5", q, v, a), dp.ArgumentError, "a Robot expected, got str"),
        ((robot, q[:5], v, a), dp.ShapeError, r"q of shape \(\.\.\., 6\) expected"),
        ((robot, q, v, np.zeros((2, 7))), dp.ShapeError, "rnea: a of shape"),
        ((), TypeError, "missing 4 required"),
    ):
        with pytest.raises(error, match=message):
            dp.rnea(*wrong)
    with pytest.raises(TypeError, match="unexpected keyword argument 'tau'"):
        dp.rnea(robot, q, v, a, tau=1)
    with pytest.raises(dp.ArgumentError, match="engine"):
        dp.rnea(robot, q, v, a, engine="autos")


@needs_code
def test_a_robot_that_is_gone_is_forgotten_and_its_successors_are_themselves(state, small_heap):
    q, base = state[0], dp.load("ur5")
    expected = {}
    for k in range(30):  # addresses are reused
        gravity = (0.0, 0.0, -float(k % 3 + 1))
        robot = base.with_gravity(gravity)
        tau = dp.gravity(robot, q)
        assert np.array_equal(tau, dp.gravity(robot, q))
        assert known(robot) == 1
        assert np.array_equal(expected.setdefault(gravity, tau), tau)
        address = id(robot)
        del robot
        gc.collect()
        assert not any(form.robot == address for bucket in machine._buckets for form in bucket)
    assert len({x.tobytes() for x in expected.values()}) == 3


@needs_code
def test_references_do_not_leak(robot, state, small_heap):
    out, f = np.empty((4, 4)), dp.fk
    things = [robot, *state, out, "tool0", f, f.__self__]
    for call in (
        lambda: dp.rnea(robot, *state), lambda: dp.fk(robot, state[0], "tool0", out=out),
        lambda: dp.fk(robot, state[0], frame="tool0"), lambda: dp.rnea(robot, state[0].tolist(), *state[1:]),
        lambda: dp.rnea(robot, *state, engine="numpy"),
    ):  # fmt: skip
        call(), call()
        gc.collect()
        before = [sys.getrefcount(x) for x in things]
        for _ in range(500):
            call()
        gc.collect()
        after = [sys.getrefcount(x) for x in things]
        assert all(abs(b - a) <= 5 for a, b in zip(before, after, strict=True))


def test_threads_share_the_forms(state):
    robots = [dp.load("ur5").with_gravity((0.0, 0.0, -float(k + 1))) for k in range(4)]
    q = state[0]
    expected = [dp.gravity(r, q, engine="compiled") for r in robots]
    wrong = []

    def work():
        for _ in range(500):
            for r, tau in zip(robots, expected, strict=True):
                if not np.array_equal(dp.gravity(r, q), tau):
                    wrong.append(r)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert wrong == []


@pytest.mark.parametrize("patch", ["fast_call.supported = lambda *_: False", "host.binding = nothing"])
def test_without_machine_code_they_are_python_and_the_same(patch):
    code = f"""
import warnings, numpy as np
warnings.simplefilter("ignore")
from dualpin.engine.jit import compiler, fast_call, host
def nothing():
    raise host.CompilerError("none")
{patch}
compiler.binding = host.binding
import dualpin as dp
r = dp.load("ur5")
q, v, a = r.sample(seed=0)
for _ in range(3):
    tau = dp.rnea(r, q, v, a)
assert abs(tau - dp.rnea(r, q, v, a, engine="numpy")).max() < 1e-12 and dp.fk(r, q, frame="tool0").shape == (4, 4)
import inspect
assert list(inspect.signature(dp.rnea).parameters) == ["robot", "q", "v", "a", "f_ext", "out", "dtype", "engine"]
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_type_checkers_and_readers_see_the_source():
    """The source says what it takes and returns; `typing.get_type_hints` needs a function of Python's."""
    body = inspect.getsource(sys.modules["dualpin.functions.dynamics"])
    assert "def rnea(\n    robot: Robot,\n    q: ArrayLike," in body
    assert typing.get_type_hints(functions.inertial_parameters)["return"] is np.ndarray
