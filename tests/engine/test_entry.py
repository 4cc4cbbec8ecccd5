"""The shortest way into a kernel: the right result or the right error, whatever is passed."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.call.fast import Batched
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
        lambda x: x.view(type("Mine", (np.ndarray,), {})),
        lambda x: np.broadcast_arrays(x, np.zeros(6))[0],
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


def test_arrays_that_are_laid_out_in_another_way_are_left_to_python(robot, state, expected, monkeypatch):
    assert entry._arrays_as_known()
    monkeypatch.setattr(entry, "_NUMPY", 3)
    assert not entry._arrays_as_known()
    monkeypatch.setattr(entry, "addresses", entry.Once(entry.addresses.make))
    other = dp.load("ur5")
    f = other.kernel("rnea")
    assert type(f).__name__ == "Evaluator"
    assert np.array_equal(f(*state), expected) and np.array_equal(dp.rnea(other, *state), expected)


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


def test_a_batch_of_one_takes_the_kernel_of_one_sample(monkeypatch, state, expected):
    def unwanted(*_, **__):
        raise AssertionError("by way of Python")

    monkeypatch.setattr(Batched, "__call__", unwanted)
    f, out = dp.load("ur5").kernel("rnea"), np.empty((1, 6))  # no batch was computed: there is only this kernel
    one = [x[None] for x in state]
    fresh = f(*one)
    assert fresh.shape == (1, 6) and np.array_equal(fresh[0], expected)
    assert f(*one, out=out) is out and np.array_equal(out, fresh)
    with pytest.raises(AssertionError, match="Python"):
        f(*one, out=one[0])  # they overlap


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
