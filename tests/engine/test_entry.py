"""The shortest way into a kernel: the right result or the right error, whatever is passed."""

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


def test_it_is_a_builtin_that_says_what_it_is(robot):
    f = robot.kernel("rnea")
    assert type(f).__name__ == "builtin_function_or_method"
    assert f.__name__ == "rnea"
    assert "q, v, a" in f.__doc__
    assert robot.kernel("rnea") is f


def test_with_and_without_out(robot, state, expected):
    f = robot.kernel("rnea")
    out = np.empty(6)
    assert f(*state, out=out) is out
    assert np.array_equal(out, expected)
    out[:] = 0
    assert f(*state, out) is out
    assert np.array_equal(out, expected)
    assert np.array_equal(f(*state, out=None), expected)
    fresh = f(*state)
    assert fresh.flags.owndata and fresh.flags.writeable and fresh is not f(*state)


@pytest.mark.parametrize(
    "convert",
    [
        list,
        tuple,
        lambda x: x[::-1].copy()[::-1],
        lambda x: np.repeat(x, 2)[::2],
        lambda x: x.astype(">f8"),
        lambda x: np.frombuffer(b"\0" + x.tobytes(), dtype=np.uint8)[1:].view(float),
        lambda x: memoryview(x),
        lambda x: np.ma.masked_array(x),
        lambda x: x.astype(np.longdouble),
        lambda x: np.array(x, copy=True, order="F"),
    ],
)
def test_whatever_holds_the_same_numbers_gives_the_same_result(robot, state, expected, convert):
    f = robot.kernel("rnea")
    for k in range(3):
        args = [convert(x) if i == k else x for i, x in enumerate(state)]
        assert np.array_equal(f(*args), expected)
    out = np.empty(6)
    f(*map(convert, state), out=out)
    assert np.array_equal(out, expected)


def test_read_only_inputs_are_welcome(robot, state, expected):
    q = state[0].copy()
    q.flags.writeable = False
    assert np.array_equal(robot.kernel("rnea")(q, *state[1:]), expected)


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (lambda q, v, a: (q[:5], v, a), r"q of shape \(\.\.\., 6\) expected .* got \(5,\)"),
        (lambda q, v, a: (q, np.zeros(7), a), r"v of shape"),
        (lambda q, v, a: (q, v, 3.0), r"a of shape"),
        (lambda q, v, a: (q, v, np.zeros((6, 2))), r"a of shape"),
        (lambda q, v, a: (q, v), "3 arrays"),
        (lambda q, v, a: (q, v, a, None, None), "3 arrays"),
        (lambda q, v, a: (), "3 arrays"),
        (lambda q, v, a: (q + 1j, v, a), "complex"),
        (lambda q, v, a: (q, v, a.astype(object)), "object"),
        (lambda q, v, a: (["one"] * 6, v, a), "real numbers"),
        (lambda q, v, a: (None, v, a), "real numbers"),
    ],
)
def test_wrong_arguments_are_explained(robot, state, args, message):
    with pytest.raises(dp.DualpinError, match=message):
        robot.kernel("rnea")(*args(*state))


@pytest.mark.parametrize(
    ("out", "message"),
    [
        (np.empty(5), "shape"), (np.empty((6, 1)), "shape"), (np.empty(6, np.float32), "float32"), ([0.0] * 6, "list"),
        (np.empty(6, complex), "complex"),
    ],
)  # fmt: skip
def test_wrong_results_are_explained(robot, state, out, message):
    with pytest.raises(dp.DualpinError, match=message):
        robot.kernel("rnea")(*state, out=out)


def test_a_read_only_result_is_refused(robot, state):
    out = np.zeros(6)
    out.flags.writeable = False
    with pytest.raises(dp.ArgumentError, match="read-only"):
        robot.kernel("rnea")(*state, out=out)
    assert not out.any()


def test_a_strided_result_is_filled(robot, state, expected):
    block = np.zeros((6, 2))
    robot.kernel("rnea")(*state, out=block[:, 1])
    assert np.array_equal(block[:, 1], expected)
    assert not block[:, 0].any()


def test_an_unknown_keyword_is_refused(robot, state):
    with pytest.raises(TypeError, match="result"):
        robot.kernel("rnea")(*state, result=np.empty(6))
    with pytest.raises(TypeError):
        robot.kernel("rnea")(*state[:2], a=state[2])


@pytest.mark.parametrize("which", [0, 1, 2])
def test_the_result_may_lie_over_an_input(robot, state, expected, which):
    args = [x.copy() for x in state]
    assert robot.kernel("rnea")(*args, out=args[which]) is args[which]
    assert np.array_equal(args[which], expected)
    shared = np.zeros(8)
    shared[1:7] = state[0]
    robot.kernel("rnea")(shared[1:7], *state[1:], out=shared[:6])
    assert np.array_equal(shared[:6], expected)


def test_nan_goes_in_and_comes_out(robot, state):
    q = state[0].copy()
    q[2] = np.nan
    assert np.isnan(robot.kernel("rnea")(q, *state[1:])).any()


def test_an_attribute_that_raises_is_not_swallowed_into_a_wrong_read(robot, state):
    class Odd:
        @property
        def dtype(self):
            raise RuntimeError("no")

    with pytest.raises(dp.DualpinError):
        robot.kernel("rnea")(Odd(), *state[1:])


def test_a_quaternion_that_is_not_unit_is_refused():
    robot = dp.load("ur5", floating=True)
    q, v, a = robot.sample(seed=0)
    f = robot.kernel("rnea")
    f(q, v, a)
    q[3:7] *= 1.001
    with pytest.raises(dp.ArgumentError, match="unit quaternion"):
        f(q, v, a)
    with pytest.raises(dp.ArgumentError, match="unit quaternion"):
        dp.rnea(robot, q, v, a)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("crba", {}), ("fk", {}), ("kinetic_energy", {}), ("com", {}), ("joint_torque_regressor", {}),
        ("frame_pose", {"frame": "tool0"}), ("jacobian", {"frame": "tool0", "reference": "local"}), ("aba", {}),
        ("rnea_f_ext", {}), ("difference", {}),
    ],
)  # fmt: skip
def test_every_kind_of_result(robot, name, options):
    q, v, a = robot.sample(5, seed=3)
    f_ext = np.random.default_rng(0).uniform(-1, 1, (5, 6, 6))
    given = {"q": q, "v": v, "a": a, "tau": a, "f_ext": f_ext, "q0": q, "q1": 0.5 * q}
    from dualpin.terms import TERMS

    inputs = [given[key] for key in TERMS[name].inputs]
    f = robot.kernel(name, **options)
    batch = f(*inputs)
    for i in range(5):
        one = f(*(x[i] for x in inputs))
        assert one.shape == batch.shape[1:]
        assert np.array_equal(one, batch[i])


@pytest.mark.parametrize("n", [1, 2, 7, 8, 65, 4097])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_batches_have_the_bits_of_single_calls(robot, n, dtype):
    arrays = [x.astype(dtype) for x in robot.sample(n, seed=5)]
    f, out = robot.kernel("rnea", dtype=dtype), np.empty((n, 6), dtype)
    f(*arrays)  # compiles
    assert f(*arrays, out=out) is out
    fresh = f(*arrays)
    assert fresh.dtype == dtype and fresh.shape == (n, 6)
    assert np.array_equal(fresh, out)
    for i in (0, n // 2, n - 1):
        assert np.array_equal(f(*(x[i] for x in arrays)), out[i])
    assert np.array_equal(f(*(x.reshape(1, n, 6) for x in arrays))[0], out)
    assert np.array_equal(f(arrays[0][0], *arrays[1:])[0], out[0])  # broadcast


def test_a_batch_may_be_empty(robot, state):
    f, none = robot.kernel("rnea"), np.empty((0, 6))
    f(*(x[None] for x in state))
    assert f(none, none, none).shape == (0, 6)
    assert f(none, none, none, out=np.empty((0, 6))).shape == (0, 6)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda q, v, a, out: (q[:3], v, a, out), "broadcast"),
        (lambda q, v, a, out: (q, v[:, :5].copy(), a, out), "v of shape"),
        (lambda q, v, a, out: (q, v, a, np.empty((5, 6))), r"out of shape \(4, 6\) expected"),
        (lambda q, v, a, out: (q, v, a, np.empty((4, 7))), r"out of shape \(4, 6\) expected"),
        (lambda q, v, a, out: (q, v, a, np.empty(24)), r"out of shape \(4, 6\) expected"),
        (lambda q, v, a, out: (q[0], v[0], a[0], out), r"out of shape \(6,\) expected"),
        (lambda q, v, a, out: (q, v, a, out.astype(np.float32)), "float32"),
        (lambda q, v, a, out: (q.astype(complex), v, a, out), "complex"),
        (lambda q, v, a, out: (q[..., None], v, a, out), "q of shape"),
    ],
)  # fmt: skip
def test_wrong_batches_are_explained(robot, change, message):
    f, arrays = robot.kernel("rnea"), robot.sample(4, seed=1)
    f(*arrays)
    with pytest.raises(dp.DualpinError, match=message):
        f(*change(*arrays, np.empty((4, 6))))


def test_the_result_of_a_batch_may_lie_over_its_inputs(robot):
    f, (q, v, a) = robot.kernel("rnea"), robot.sample(100, seed=2)
    expected = f(q, v, a)
    memory = np.zeros((103, 6))
    for shift in (0, 1, 3):
        memory[:100] = a
        out = memory[shift : shift + 100]
        assert f(q, v, memory[:100], out=out) is out
        assert np.array_equal(out, expected)
    strided = np.zeros((100, 12))
    f(q, v, a, out=strided[:, 3:9])
    assert np.array_equal(strided[:, 3:9], expected)
    assert not strided[:, :3].any() and not strided[:, 9:].any()


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


def test_references_do_not_leak(robot, state):
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
        for _ in range(100_000 if quick else 1_000):
            call()
        gc.collect()
        after = [sys.getrefcount(x) for x in things]
        # a leak would be 100 000; None and the dtype are counted by everybody who runs meanwhile
        assert all(abs(b - a) <= 50 for a, b in zip(before, after, strict=True))
        assert sys.getallocatedblocks() - blocks < 500


def test_errors_do_not_leak_either(robot, state):
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
