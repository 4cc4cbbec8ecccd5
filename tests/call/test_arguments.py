"""Each rule for arguments stands once: whichever way a call comes in, the same mistake gets the same answer."""

from __future__ import annotations

import re
import threading

import numpy as np
import pytest

import dualpin as dp
from dualpin.arguments import count, flag
from dualpin.call import evaluate, find
from dualpin.interpret import interpret
from dualpin.terms import TERMS, Term, configuration, row, velocity

N = 5
KERNEL = {"rnea": {}, "jacobian": {"frame": "tool0", "reference": "local"}}


@pytest.fixture(scope="module")
def robot():
    return dp.load("ur5", floating=True)


@pytest.fixture(scope="module")
def state(robot):
    return robot.sample(seed=1)


def as_lists(arrays):
    return [x.tolist() if type(x) is np.ndarray and x.dtype.kind in "fiu" else x for x in arrays]


def ways_in(robot):
    """Name -> a call of inverse dynamics with any q, v, a and out; each warm, so that its quick part is in use."""
    kernel, fresh = robot.kernel("rnea"), dp.load("ur5", floating=True)
    q, v, a = robot.sample(N, seed=2)
    for f in (kernel, lambda *x: dp.rnea(robot, *x)):
        f(q[0], v[0], a[0])
        f(q, v, a)
    return {
        "function": lambda *x, out=None: dp.rnea(robot, *x, out=out),
        "function, first call": lambda *x, out=None: dp.rnea(fresh, *x, out=out),
        "function, numpy": lambda *x, out=None: dp.rnea(robot, *x, out=out, engine="numpy"),
        "function, compiled": lambda *x, out=None: dp.rnea(robot, *x, out=out, engine="compiled"),
        "function, lists": lambda *x, out=None: dp.rnea(robot, *as_lists(x), out=out),
        "kernel": kernel,
        "kernel, out in its place": lambda *x, out=None: kernel(*x, out),
        "kernel, lists": lambda *x, out=None: kernel(*as_lists(x), out=out),
        "by name": lambda *x, out=None: evaluate(robot, "rnea", dict(zip("qva", x, strict=True)), out=out),
    }


def wrong_inputs(q, v, a):
    """Name -> arrays with one mistake, made of a single state or a batch."""
    short, long = (lambda x: x[..., :-1].copy()), (lambda x: np.concatenate([x, x[..., :1]], axis=-1))
    bent = q.copy()
    bent[..., 3:7] *= 1.01
    return {
        "q short": (short(q), v, a), "v short": (q, short(v), a), "a long": (q, v, long(a)),
        "q is one number": (0.5, v, a), "v is an axis too deep": (q, v[..., None], a), "a is empty": (q, v, a[..., :0]),
        "q complex": (q + 0j, v, a), "v of objects": (q, v.astype(object), a), "a of text": (q, v, a.astype(str)),
        "q missing": (None, v, a), "v is text": (q, "zero", a), "a is a dict": (q, v, {"a": 0}),
        "v is ragged": (q, [[0.0] * 12, [0.0] * 3], a), "not a unit quaternion": (bent, v, a),
        "v is masked": (q, np.ma.masked_less(v, np.median(v)), a),
        "three batches": (np.stack([q] * 3), np.stack([v] * 2), a), "q and v swapped": (v, q, a),
    }  # fmt: skip


def wrong_results(shape):
    locked = np.zeros(shape)
    locked.flags.writeable = False
    return {
        "out short": np.zeros((*shape[:-1], shape[-1] - 1)), "out deep": np.zeros((*shape, 1)), "out flat": np.zeros(7),
        "out float32": np.zeros(shape, np.float32), "out complex": np.zeros(shape, complex),
        "out is a list": np.zeros(shape).tolist(), "out is a number": 1.0, "out is read-only": locked,
    }  # fmt: skip


def answer(f, *arrays, **named):
    """What is raised: its type, and the message without the name of the robot."""
    with pytest.raises(dp.DualpinError) as raised:
        f(*arrays, **named)
    return type(raised.value), str(raised.value)


@pytest.mark.parametrize("batch", [None, N], ids=["single", "batch"])
def test_every_way_in_answers_every_bad_argument_alike(robot, batch):
    ways, arrays = ways_in(robot), robot.sample(batch, seed=1)
    out = np.full(arrays[1].shape, 7.0)
    cases = [(name, wrong, None) for name, wrong in wrong_inputs(*arrays).items()]
    cases += [(name, arrays, wrong) for name, wrong in wrong_results(out.shape).items()]
    for name, given, result in cases:
        for also in (None, out) if result is None else (result,):
            found = {way: answer(f, *given, out=also) for way, f in ways.items()}
            assert len(set(found.values())) == 1, (name, found)
    assert (out == 7.0).all()  # nothing was written


def test_messages_name_what_where_and_what_was_expected(robot, state):
    q, v, a = state
    wanted = {
        "q short": r"rnea: q of shape \(\.\.\., 13\) expected for ur5\w* \(nq = 13\), got \(12,\)",
        "a long": r"rnea: a of shape \(\.\.\., 12\) expected for ur5\w* \(nv = 12\), got \(13,\)",
        "q complex": "rnea: q: real numbers expected, got complex128",
        "three batches": r"rnea: the leading axes of q \(3, 13\), v \(2, 12\), a \(12,\) do not broadcast together",
        "not a unit quaternion": r"rnea: q\[3:7\] of joint 'root_joint' must be a unit quaternion .* its norm is 1.01",
    }
    for name, pattern in wanted.items():
        _, message = answer(robot.kernel("rnea"), *wrong_inputs(q, v, a)[name])
        assert re.match(pattern, message), message


@pytest.mark.parametrize("f", ["kernel", "by function"])
def test_the_number_of_arrays_is_checked(robot, state, f):
    call = robot.kernel("rnea")
    with pytest.raises(dp.ArgumentError, match=r"rnea: 3 arrays \(q, v, a\) expected, got 2"):
        call(*state[:2])
    with pytest.raises(TypeError, match="given in order, and `out` by its name; tau is not known"):
        call(*state, tau=0)


# --- options -------------------------------------------------------------------------------------


def ways_to_a_jacobian(robot, q):
    return {
        "function": lambda frame, **options: dp.jacobian(robot, q, frame, **options),
        "numpy": lambda frame, **options: dp.jacobian(robot, q, frame, **options, engine="numpy"),
        "kernel": lambda frame, **options: robot.kernel("jacobian", frame=frame, **options),
        "by name": lambda frame, **options: evaluate(robot, "jacobian", {"q": q}, frame=frame, **options),
    }


@pytest.mark.parametrize(
    "frame", [1.0, True, np.float64(1), np.bool_(True), 99, -99, None, b"tool0", ["tool0"], "tool"]
)
def test_what_names_no_frame_is_refused_whatever_was_called_before(robot, state, frame):
    ways = ways_to_a_jacobian(robot, state[0])
    for f in ways.values():
        for known in (1, 0, "tool0", np.int64(1), robot.frames[1]):
            f(known)
    found = {answer(f, frame) for f in ways.values()}
    if frame is not None:
        found.add(answer(lambda x: dp.fk(robot, state[0], x), frame))
    assert len(found) == 1, found


@pytest.mark.parametrize("reference", ["wrld", 1.0, None, b"world", ["world"], True])
def test_unknown_references_are_refused_alike(robot, state, reference):
    ways = ways_to_a_jacobian(robot, state[0])
    found = {answer(f, "tool0", reference=reference) for f in ways.values()}
    assert len(found) == 1, found


@pytest.mark.parametrize("classical", ["yes", None, 2, np.ones(3), 0.5])
def test_a_flag_is_true_or_false(robot, state, classical):
    dp.frame_acceleration(robot, *state, "tool0", classical=True)
    with pytest.raises(dp.ArgumentError, match="classical"):
        dp.frame_acceleration(robot, *state, "tool0", classical=classical)
    with pytest.raises(dp.ArgumentError, match="classical"):
        robot.kernel("frame_acceleration", frame="tool0", classical=classical)


def test_numpy_scalars_name_frames_and_flags(robot, state):
    J = dp.jacobian(robot, state[0], "tool0")
    index = robot.frame_names.index("tool0")
    for same in (
        index,
        np.int32(index),
        np.uint8(index),
        np.str_("tool0"),
        robot.frame("tool0"),
        index - len(robot.frames),
    ):
        assert np.array_equal(dp.jacobian(robot, state[0], same), J)
    seen = dp.frame_acceleration(robot, *state, "tool0", "local", classical=True)
    assert np.array_equal(dp.frame_acceleration(robot, *state, "tool0", "local", classical=np.bool_(True)), seen)
    assert flag("x", np.float64(1)) is True and flag("x", 0) is False
    assert count("n", np.int64(3), 1) == 3
    for wrong in (True, 1.5, "3", -1, None, np.float64(2)):
        with pytest.raises(dp.ArgumentError, match=r"n = .*, a whole number from 0 on expected"):
            count("n", wrong)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda r: r.kernel("rneaa"), "term 'rneaa' is not known; did you mean 'rnea'"),
        (lambda r: r.kernel(None), "term None is not known"),
        (lambda r: r.kernel("rnea", frame="tool0"), "rnea: option 'frame' is not known; it takes none"),
        (lambda r: r.kernel("jacobian", frames="tool0"), "option 'frames' is not known; did you mean 'frame'"),
        (lambda r: r.kernel("jacobian"), "jacobian: frame= is needed"),
        (lambda r: r.kernel("rnea", dtype=complex), "float64 or float32 expected, got complex128"),
        (lambda r: dp.crba(r, r.neutral, engine="numby"), "engine 'numby' is not known; did you mean 'numpy'"),
        (lambda r: dp.crba(r, r.neutral, engine=None), "engine None is not known"),
        (lambda r: dp.crba("panda", r.neutral), r"crba: a Robot expected, got str; dualpin.load"),
        (lambda r: evaluate(None, "crba", {"q": 0}), "crba: a Robot expected, got NoneType"),
        (lambda r: dp.export_c(r, "rneaa"), "did you mean 'rnea'"),
    ],
)  # fmt: skip
def test_what_does_not_exist_is_named(robot, ask, message):
    with pytest.raises(dp.ArgumentError, match=message):
        ask(robot)


def test_options_have_the_defaults_of_the_functions(robot, state):
    assert np.array_equal(robot.kernel("jacobian", frame="tool0")(state[0]), dp.jacobian(robot, state[0], "tool0"))
    plain = robot.kernel("frame_acceleration", frame="tool0")
    assert np.array_equal(plain(*state), dp.frame_acceleration(robot, *state, "tool0"))
    assert robot.kernel("jacobian", frame="tool0") is robot.kernel("jacobian", frame="tool0", reference="world")


# --- terms ---------------------------------------------------------------------------------------


def test_inputs_say_their_shapes(robot):
    assert TERMS["aba_f_ext"].inputs == ("q", "v", "tau", "f_ext")
    assert TERMS["aba_f_ext"].sizes(robot) == [13, 12, 12, 6 * len(robot)]
    wide = Term("wide", (configuration("q"), velocity("past", times=3), row("poses", 24), row("h")), len, lambda r: ())
    assert wide.sizes(robot) == [13, 36, 24, 1]


def test_dual_quaternions_of_all_joints_are_those_of_their_matrices(robot):
    q, _, _ = robot.sample(7, seed=0)
    x = dp.fk(robot, q, as_="dual_quaternion")
    assert np.abs(x - dp.spatial.from_matrix(dp.fk(robot, q))).max() < 1e-14  # rounding of lengths of 1 m
    assert (x[..., 0] >= 0).all()
    out = np.empty_like(x)
    assert dp.fk(robot, q, as_="dual_quaternion", out=out) is out and np.array_equal(out, x)
    one = dp.fk(robot, q, robot.joint_names[-1], as_="dual_quaternion")
    assert np.abs(one - x[:, -1]).max() < 1e-14


@pytest.mark.parametrize("engine", ["auto", "compiled", "numpy"])
def test_engines_share_kernels_and_agree(robot, state, engine):
    expected = interpret(robot, TERMS["rnea"], {}, [x[None] for x in state])[0]
    assert np.abs(dp.rnea(robot, *state, engine=engine) - expected).max() < 1e-12 * np.abs(expected).max()
    assert find(robot, TERMS["rnea"], {}, single=True) is find(robot, TERMS["rnea"], {}, single=True)


def test_threads_that_ask_together_get_one_callable():
    robot = dp.load("ur5")
    start, found = threading.Barrier(8), []

    def ask():
        start.wait()
        found.append(robot.kernel("gravity"))

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert len(found) == 8 and len({id(f) for f in found}) == 1
