"""Compiled and NumPy execution agree, for every term, batch, machine width and precision."""

from __future__ import annotations

import dataclasses
import math

import mpmath
import numpy as np
import pytest

import dualpin as dp
from dualpin.call import evaluate as call
from dualpin.call import find
from dualpin.engine import tuning
from dualpin.engine.codegen import module as ir
from dualpin.engine.codegen.number import DOUBLE, SINGLE
from dualpin.engine.graph.schedule import schedule
from dualpin.engine.graph.trace import LIBRARY, Graph, Trace, UntraceableError
from dualpin.engine.jit import kernel as kernels
from dualpin.engine.jit.compiler import object_code
from dualpin.engine.jit.host import CompilerError, this_host
from dualpin.io import catalogue
from dualpin.terms import TERMS

AGREEMENT = 1e-13  # scaled: both round every operation once, folding and fused operations regroup some
SOLVING = {"aba", "aba_f_ext", "minv", "aba_derivatives"}  # these amplify rounding by the condition of M


LONG = (
    "rnea_hessian", "rnea_hvp", "rnea_jvp", "rnea_second_derivatives", "rnea_vjp_f_ext", "rnea_derivatives_f_ext",
    "aba_derivatives_f_ext",
)  # fmt: skip
"""Minutes of compiling: in the campaign; tests/test_second_derivatives.py has them on a small robot."""
EVERY_TERM = [
    pytest.param(term, marks=[pytest.mark.campaign] if {term, term.removesuffix("_f_ext")} & {*LONG} else [])
    for term in sorted(TERMS)
]


def options(robot, term):
    chosen = {}
    if term in ("frame_pose", "frame_quaternion", "jacobian", "jacobian_dot", "frame_velocity", "frame_acceleration"):
        chosen["frame"] = max(robot.frames, key=lambda f: len(list(f.joint.chain)) if f.joint else 0)
    if term in ("jacobian", "jacobian_dot", "frame_velocity", "frame_acceleration"):
        chosen["reference"] = "local_world_aligned"
    if term == "frame_acceleration":
        chosen["classical"] = True
    return chosen


def states(robot, n, seed=0):
    q, v, a = robot.sample(n, seed=seed)
    rng = np.random.default_rng(seed)
    f_ext = rng.uniform(-10, 10, (*q.shape[:-1], len(robot), 6))
    q1 = dp.integrate(robot, q, 0.3 * v / (1 + np.abs(v)), engine="numpy")
    tau = dp.rnea(robot, q, v, a, engine="numpy")
    direction = {"w": 0.1 * tau, "dq": v, "dv": 2 * v, "da": a}
    return {"q": q, "v": v, "a": a, "tau": tau, "f_ext": f_ext, "q0": q, "q1": q1, **direction}


def disagreement(robot, term, n, engine="compiled"):
    """(scaled difference between the engines, what it may be)"""
    given = states(robot, n)
    inputs = {key: given[key] for key in TERMS[term].inputs}
    chosen = options(robot, term)
    got = call(robot, term, inputs, engine=engine, **chosen)
    expected = call(robot, term, inputs, engine="numpy", **chosen)
    assert got.shape == expected.shape
    bound = AGREEMENT
    if term in SOLVING:
        M = dp.crba(robot, given["q"], engine="numpy")
        scale = np.sqrt(np.diagonal(M, axis1=-2, axis2=-1))
        bound *= np.linalg.cond(M / scale[..., :, None] / scale[..., None, :]).max() ** (
            1 + (term == "aba_derivatives")
        )
    finite = np.isfinite(expected)
    assert np.array_equal(np.isfinite(got), finite)
    return float(np.abs(got - expected)[finite].max(initial=0)) / max(
        1.0, np.abs(expected[finite]).max(initial=0)
    ), bound


@pytest.mark.parametrize("term", EVERY_TERM)
@pytest.mark.parametrize(("name", "floating"), [("ur5", False), ("panda", True), ("solo8", True)])
def test_engines_agree_on_every_term(name, floating, term):
    error, bound = disagreement(dp.load(name, floating=floating), term, 11)
    assert error <= bound


def test_engines_agree_where_joints_follow_others():
    robot = dp.load("panda", mimic=True)
    assert robot.coupled
    for term in ("rnea", "crba", "coriolis", "fk"):
        error, bound = disagreement(robot, term, 3)
        assert error <= bound, term


REFUSED = {"falcon", "ur3"}  # by Pinocchio, too
UNMOVING = {"bluevolta", "iris_simple", "quadrotor_base"}  # no joints but the floating base, which is not asked for


@pytest.mark.campaign
@pytest.mark.parametrize("name", sorted(set(catalogue()) - REFUSED - UNMOVING))
def test_engines_agree_on_every_robot(name):
    robot = dp.load(name)
    for term in ("rnea", "crba", "coriolis", "bias", "gravity", "fk", "centroidal_momentum_matrix", "jacobian"):
        error, bound = disagreement(robot, term, 5)
        assert error <= bound, term


@pytest.mark.parametrize("n", [0, 1, 2, 7, 8, 9, 64, 4097])
def test_any_batch_and_each_sample_on_its_own(n):
    robot = dp.load("ur5")
    q, v, a = robot.sample(n, seed=2)
    tau = dp.rnea(robot, q, v, a)
    assert tau.shape == (n, 6)
    for i in {0, n // 2, n - 1} if n else ():
        # a sample alone has the same bits as among others
        assert np.array_equal(dp.rnea(robot, q[i], v[i], a[i]), tau[i])
        assert np.array_equal(dp.rnea(robot, q[i : i + 1], v[i : i + 1], a[i : i + 1])[0], tau[i])


def test_axes_broadcast_like_numpys():
    robot = dp.load("ur5")
    q, v, a = robot.sample(6, seed=3)
    grid = dp.rnea(robot, q[:, None], v[None, :], a[0])
    assert grid.shape == (6, 6, 6)
    assert np.array_equal(grid[2, 5], dp.rnea(robot, q[2], v[5], a[0]))


def test_strided_rows_and_columns_are_read_where_they_are():
    robot = dp.load("ur5")
    q, v, a = robot.sample(40, seed=4)
    expected = dp.rnea(robot, q, v, a)
    wide = np.full((40, 20), np.nan)
    wide[:, 3:9] = q
    assert np.array_equal(dp.rnea(robot, wide[:, 3:9], v, a), expected)
    assert np.array_equal(dp.rnea(robot, q[::-2], v[::-2], a[::-2]), expected[::-2])
    assert np.array_equal(dp.rnea(robot, np.asfortranarray(q), v, a), expected)
    assert np.array_equal(dp.rnea(robot, q.astype(">f8"), v, a), expected)


def test_out_is_filled_even_over_its_own_inputs():
    robot = dp.load("ur5")
    q, v, a = robot.sample(100, seed=5)
    expected = dp.rnea(robot, q, v, a)
    assert dp.rnea(robot, q, v, a, out=a) is a
    assert np.array_equal(a, expected)
    block = np.zeros((100, 12))
    dp.rnea(robot, q, v, robot.sample(100, seed=5)[2], out=block[:, ::2])
    assert np.array_equal(block[:, ::2], expected)


@pytest.mark.parametrize(
    ("out", "message"),
    [
        (np.empty(5), "shape"), (np.empty(6, np.float32), "float32"), ([0.0] * 6, "list"), (np.empty((1, 6)), "shape"),
    ],
)  # fmt: skip
def test_an_unfit_out_is_refused(out, message):
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=0)
    with pytest.raises(dp.ArgumentError if "shape" not in message else dp.DualpinError, match=message):
        dp.rnea(robot, q, v, a, out=out)


def narrower(width, fma=True):
    """This machine, pretending to be a smaller one."""
    host = this_host()
    if width > host.width:
        pytest.skip("wider than this machine")
    off = {64: (), 32: ("avx512",), 16: ("avx512", "avx"), 8: ("avx512", "avx")}[width]
    features = [
        f if not any(f.startswith(f"+{x}") for x in off) and (fma or f != "+fma") else "-" + f[1:]
        for f in host.features.split(",")
    ]
    return dataclasses.replace(host, width=width, features=",".join(features), fma=fma and host.fma and width > 16)


@pytest.mark.parametrize("term", ["rnea", "aba", "fk", "coriolis", "rnea_derivatives"])
def test_every_vector_width_gives_the_same_bits(term):
    robot = dp.load("panda")
    given = states(robot, 13)
    inputs = [given[key] for key in TERMS[term].inputs]
    results = [
        kernels.build(robot, TERMS[term], {}, np.float64, host=dataclasses.replace(this_host(), width=w)).rows(inputs)
        for w in (64, 32, 16, 8)
        if w <= this_host().width
    ]
    results.append(kernels.build(robot, TERMS[term], {}, single=True).rows(inputs))
    assert all(np.array_equal(r.view("u8"), results[0].view("u8")) for r in results)  # signs of zeros, too


@pytest.mark.parametrize(("width", "fma"), [(64, True), (32, True), (32, False), (16, False), (8, False)])
def test_smaller_machines_compute_the_same(width, fma):
    robot = dp.load("panda")
    given = states(robot, 13)
    for term in ("rnea", "coriolis"):
        inputs = [given[key] for key in TERMS[term].inputs]
        got = kernels.build(robot, TERMS[term], {}, host=narrower(width, fma)).rows(inputs)
        expected = call(robot, term, dict(zip(TERMS[term].inputs, inputs, strict=True)), engine="numpy").reshape(13, -1)
        assert np.abs(got - expected).max() <= AGREEMENT * np.abs(expected).max()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize(
    "term", ["kinetic_energy", "com", "rnea", "crba", "coriolis", "fk", "rnea_derivatives"]
)  # rows of 1, 3, 9, 81, 81, 144, 243
def test_results_fill_their_rows_and_nothing_else(dtype, term):
    robot = dp.load("panda")
    kernel = kernels.build(robot, TERMS[term], {}, dtype)
    single = kernels.build(robot, TERMS[term], {}, dtype, single=True)
    given = states(robot, 37)
    inputs = [given[key].astype(dtype) for key in TERMS[term].inputs]
    expected = single.rows(inputs)
    item, guard = np.dtype(dtype).itemsize, 1 << 10
    for n in (1, 2, 7, 8, 9, 16, 17, 31, 37):
        for shift in (0, item, 3 * item, 13 * item, 1, item // 2):  # bytes, also between numbers
            memory = np.full(2 * guard + n * kernel.width * item + 64, 0xA5, np.uint8)
            start = guard - memory.ctypes.data % 64 + shift
            stop = start + n * kernel.width * item
            out = memory[start:stop].view(dtype).reshape(n, kernel.width)
            kernel.rows([x[:n] for x in inputs], out)
            assert np.array_equal(out, expected[:n])
            assert (memory[:start] == 0xA5).all() and (memory[stop:] == 0xA5).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize(("term", "width"), [("crba", 81), ("fk", 144)])  # rows that end within a line, and with one
def test_large_results_past_the_caches_are_the_same(term, width, dtype):
    robot = dp.load("panda")
    n = tuning.STREAM_FROM // (width * np.dtype(dtype).itemsize) + 5
    q = robot.sample(n, seed=0)[0].astype(dtype)
    kernel = kernels.build(robot, TERMS[term], {}, dtype)
    item = np.dtype(dtype).itemsize
    for shift in (
        0,
        item,
        2 * item,
        1,
    ):  # bytes; at 1 numbers are not aligned, so that they are not stored past the caches
        memory = np.empty((n * width + 3) * item, np.uint8)
        out = memory[shift : shift + n * width * item].view(dtype).reshape(n, width)
        kernel.rows([q], out)
        for first in range(0, n, 1000):  # few enough to stay in the caches
            assert np.array_equal(out[first : first + 1000], kernel.rows([q[first : first + 1000]]))


@pytest.mark.parametrize(
    ("name", "term"), [("panda", "fk"), ("talos", "jacobian")]
)  # more vectors than angles, and fewer
def test_angles_made_while_results_leave_may_be_anything(name, term):
    robot = dp.load(name)
    options = {"frame": robot.frame(robot.link_names[-1]), "reference": "local"} if term == "jacobian" else {}
    q = robot.sample(70, seed=0)[0]
    q[20, 3], q[33], q[34, -4], q[35, 0], q[69, 2] = 1e12, np.nan, np.inf, -1e9, 3e8
    batch, single = (kernels.build(robot, TERMS[term], options, single=x).rows([q]) for x in (False, True))
    assert np.array_equal(batch, single, equal_nan=True)
    assert np.isnan(batch[33]).any() and not np.isnan(batch[20]).any()


def test_single_precision():
    robot = dp.load("panda")
    q, v, a = (x.astype(np.float32) for x in robot.sample(33, seed=6))
    f = robot.kernel("rnea", dtype=np.float32)
    tau = f(q, v, a)
    expected = dp.rnea(robot, q, v, a)
    assert tau.dtype == np.float32
    assert np.abs(tau - expected).max() <= 2e-6 * np.abs(expected).max()  # some ten eps of 1.2e-7
    assert np.array_equal(f(q[4], v[4], a[4]), tau[4])


# --- sine and cosine ------------------------------------------------------------------------------


def trigonometry(dtype=np.float64, host=None, lanes=None):
    host, number = host or this_host(), DOUBLE if dtype is np.float64 else SINGLE
    lanes = lanes or host.lanes(number.size)
    graph = Graph()
    (x,) = graph.inputs(0, 1)
    together = host.lanes(number.size) if lanes == 1 else 1
    plan = schedule(Trace(graph, [1], [LIBRARY.sin(x), LIBRARY.cos(x)]), together=together, direct=lanes == 1)
    code = object_code(*ir.modules(plan, number, host, lanes), host)
    about = {
        "sizes": [1],
        "operations": 1,
        "lanes": lanes,
        "scratch": ir.scratch_bytes(plan, number, host, lanes),
        "objects": [len(code)],
    }
    return kernels.Kernel(about, code, (2,), np.dtype(dtype))


def angles(scale, n=400):
    rng = np.random.default_rng(7)
    near = np.round(rng.uniform(-scale, scale, n) / (np.pi / 2)) * (np.pi / 2)  # where a reduction may fail
    return np.concatenate([rng.uniform(-scale, scale, n), near])


@pytest.mark.parametrize("scale", [1e-8, 1.0, 10.0, 1e3, 1e6, 1e8])
@pytest.mark.parametrize(("kind", "ulps"), [("vector", 1.5), ("single", 1.5), ("no fma", 2.1)])
def test_sine_and_cosine_are_within_an_ulp_or_two(scale, kind, ulps):
    function = {
        "vector": trigonometry, "single": lambda: trigonometry(lanes=1),
        "no fma": lambda: trigonometry(host=narrower(16, False)),
    }[kind]()  # fmt: skip
    x = angles(scale)
    got = function.rows([x[:, None]])
    with mpmath.workprec(200):
        for i, value in enumerate(x):
            for y, exact in zip(
                got[i], (mpmath.sin(mpmath.mpf(float(value))), mpmath.cos(mpmath.mpf(float(value)))), strict=True
            ):
                assert abs(mpmath.mpf(float(y)) - exact) <= ulps * np.spacing(abs(float(exact)))


@pytest.mark.parametrize("lanes", [None, 1])
def test_far_angles_are_the_kernel_importss_and_do_not_touch_their_neighbours(lanes):
    x = np.array([1e9, 0.5, -3e15, 1e300, math.inf, -math.inf, math.nan, 0.0, 1e-310, 2.0])
    got = trigonometry(lanes=lanes).rows([x[:, None]])
    for y, value in zip(got, x, strict=True):
        if not math.isfinite(value):
            assert np.isnan(y).all()
        elif abs(value) > 1e8:
            assert y.tolist() == [math.sin(value), math.cos(value)]
        else:
            assert np.abs(y - [math.sin(value), math.cos(value)]).max() <= 2.3e-16


def test_sine_and_cosine_in_single_precision():
    for scale in (1.0, 1e3, 1e6):
        x = angles(scale).astype(np.float32)
        got = trigonometry(np.float32).rows([x[:, None]])
        wide = x.astype(float)
        assert np.abs(got - np.stack([np.sin(wide), np.cos(wide)], 1)).max() <= 1.2e-7


def test_nan_and_inf_come_out_as_numpy_has_them():
    robot = dp.load("panda")
    q, v, a = robot.sample(9, seed=1)
    q[2, 3], v[4, 1], a[6, 0] = np.nan, np.inf, np.nan
    got, expected = dp.rnea(robot, q, v, a), dp.rnea(robot, q, v, a, engine="numpy")
    clean = [0, 1, 3, 5, 7, 8]
    assert np.isfinite(got[clean]).all()
    assert np.isnan(got[2]).any() and np.isnan(got[6]).any() and not np.isfinite(got[4]).all()
    assert np.allclose(got[clean], expected[clean], rtol=0, atol=1e-12)


# --- which engine ---------------------------------------------------------------------------------


def test_an_unknown_engine_is_refused():
    with pytest.raises(dp.ArgumentError, match="did you mean 'compiled'"):
        dp.gravity(dp.load("ur5"), np.zeros(6), engine="compild")


def test_robots_over_other_numbers_stay_with_numpy():
    robot = dp.load("ur5").lift(mpmath.mpf)
    with pytest.raises(UntraceableError):
        dp.gravity(robot, np.zeros((2, 6)), engine="compiled")
    assert find(robot, TERMS["gravity"], {}) is None


def test_a_term_that_is_too_long_stays_with_numpy(monkeypatch):
    monkeypatch.setattr(tuning, "LARGEST_GRAPH", 100)
    robot = dp.load("ur5").with_gravity((0.1, 0, -9.81))  # no other test uses it
    with pytest.raises(UntraceableError, match="100 operations"):
        dp.coriolis(robot, np.zeros((2, 6)), np.ones((2, 6)), engine="compiled")
    assert dp.coriolis(robot, np.zeros((2, 6)), np.ones((2, 6))).shape == (2, 6, 6)


def test_without_a_compiler_numpy_computes_and_it_is_said_once(monkeypatch):
    from dualpin.call import kernels as engine

    def missing(*_, **__):
        raise CompilerError("llvmlite: ModuleNotFoundError: no module")

    monkeypatch.setattr(kernels, "build", missing)
    engine._announce.cache_clear()
    robot = dp.load("ur5")
    q, v, a = robot.sample(3, seed=0)
    with pytest.warns(dp.DualpinWarning, match="no compiler on this machine") as said:  # noqa: PT031
        first = dp.rnea(robot, q, v, a)
        dp.crba(robot, q)
        dp.rnea(robot, q[0], v[0], a[0])
    assert len(said) == 1
    assert np.array_equal(first, dp.rnea(robot, q, v, a, engine="numpy"))
    with pytest.raises(CompilerError):
        dp.rnea(robot, q, v, a, engine="compiled")
    engine._announce.cache_clear()
