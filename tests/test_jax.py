"""JAX: gradients of gradients against finite differences, jit, vmap, precision, clear refusals."""

from __future__ import annotations

import itertools
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from random_robots import tree

import dualpin as dp

jax = pytest.importorskip("jax", reason="jax is not installed: pip install 'dualpin[jax]'")

import jax.numpy as jnp  # noqa: E402
from jax.test_util import check_grads  # noqa: E402

import dualpin.jax as dj  # noqa: E402

try:
    from jax import enable_x64
except ImportError:
    from jax.experimental import enable_x64

ROBOTS = {
    "fixed": lambda: tree(["revolute", "prismatic", "helical"], seed=1, armature=True),
    "planar": lambda: tree(["planar", "revolute"], seed=2),
    "floating": lambda: tree(["floating", "revolute"], seed=4),
}
TERMS = {
    "rnea": "qva", "aba": "qva", "bias": "qv", "gravity": "q", "crba": "q", "fk": "q", "com": "q",
    "minv": "q", "coriolis": "qv", "com_jacobian": "q", "kinetic_energy": "qv", "potential_energy": "q",
    "integrate": "qv",
}  # fmt: skip
SOME = {("rnea", "fixed"), ("aba", "fixed"), ("bias", "planar"), ("potential_energy", "floating"), ("com", "fixed")}
DIFFERENCES = 1e-4
"""Relative: steps of 6e-6 leave rounding / step, 4e-11, times the condition of M (1e5 of these robots)."""


@pytest.fixture(autouse=True)
def double():
    with enable_x64(True):
        yield


def case(robot, name, *shape, forces=False, seed=0):
    """The term as a function of arrays that may leave the group, and where to take its derivatives."""
    n = int(np.prod(shape, dtype=int))
    states = dict(zip("qva", (x.reshape(*shape, -1) for x in robot.sample(n, seed=seed)), strict=True))
    given = [states[k] for k in TERMS[name]]
    if forces:
        given.append(np.random.default_rng(seed).normal(size=(*shape, len(robot), 6)))
    units = [at for j in robot for at in j.quaternions]

    def f(q, *rest):
        q = jnp.asarray(q)
        for at in units:  # disturbed quaternions are normalised
            q = q.at[..., at].divide(jnp.linalg.norm(q[..., at], axis=-1, keepdims=True))
        return getattr(dj, name)(robot, q, *rest)

    return jax.jit(f), [jnp.asarray(x) for x in given]


# JAX compiles every case anew, seconds each: PyTorch's tests go through the same rules for all joints
CASES = [
    pytest.param(name, kind, marks=[] if (name, kind) in SOME else [pytest.mark.campaign])
    for name in TERMS for kind in ROBOTS
]  # fmt: skip


@pytest.mark.parametrize(("name", "kind"), CASES)
def test_gradients_and_gradients_of_gradients(name, kind):
    f, given = case(ROBOTS[kind](), name, 2)
    check_grads(f, given, order=2, modes=["rev"], rtol=DIFFERENCES)


@pytest.mark.campaign
@pytest.mark.parametrize("name", TERMS)
@pytest.mark.parametrize("kind", ROBOTS)
def test_derivatives_of_derivatives_in_both_modes(kind, name):
    f, given = case(ROBOTS[kind](), name, 1)
    check_grads(f, given, order=2, modes=["fwd", "rev"], rtol=DIFFERENCES)


@pytest.mark.campaign
@pytest.mark.parametrize("name", ["rnea", "aba"])
def test_gradients_with_wrenches_on_the_bodies(name):
    f, given = case(ROBOTS["floating"](), name, 1, forces=True)
    check_grads(f, given, order=2, modes=["rev"], rtol=DIFFERENCES)
    check_grads(f, given, order=1, modes=["fwd"], rtol=DIFFERENCES)


@pytest.mark.campaign
@pytest.mark.parametrize("reference", ["world", "local", "local_world_aligned"])
def test_a_jacobian_in_both_modes(reference):
    robot = ROBOTS["fixed"]()
    q = jnp.asarray(robot.sample(seed=0)[0])
    f = jax.jit(lambda q: dj.jacobian(robot, q, robot.frame_names[-1], reference))
    check_grads(f, [q], order=2, modes=["rev"], rtol=DIFFERENCES)
    check_grads(f, [q], order=1, modes=["fwd"], rtol=DIFFERENCES)


def test_forward_mode_is_analytic_too():
    robot = ROBOTS["fixed"]()
    q, v, a = robot.sample(2, seed=8)
    _, along = jax.jvp(lambda *x: dj.rnea(robot, *x), (q, v, a), (v, a, q))
    assert np.array_equal(along, dp.rnea_jvp(robot, q, v, a, v, a, q))


@pytest.mark.campaign
def test_the_hessian_is_the_analytic_one_in_every_order_of_modes():
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=2)
    expected = dp.rnea_hessian(robot, q, v, a, a)[0]
    for outer, inner in itertools.product((jax.jacfwd, jax.jacrev), repeat=2):
        hessian = jax.jit(outer(inner(lambda q: dj.rnea(robot, q, v, a) @ a)))(q)
        assert np.allclose(hessian, expected, rtol=1e-12, atol=1e-11)


def test_steps_on_the_group():
    robot = ROBOTS["floating"]()
    q, v, _ = robot.sample(3, seed=9)
    found = jax.jit(jax.vmap(lambda q, v: dj.integrate(robot, q, v)))(q, 0.1 * v)
    assert np.allclose(found, dp.integrate(robot, q, 0.1 * v), rtol=0, atol=1e-14)


def test_a_frame():
    robot = dp.load("ur5")
    q = jnp.asarray(robot.sample(seed=0)[0])
    tip = robot.frame_names[-1]
    assert np.array_equal(dj.fk(robot, q, tip), dp.fk(robot, np.asarray(q), tip))
    check_grads(lambda q: dj.fk(robot, q, tip), [q], order=1, modes=["rev"])


def test_compiled_and_mapped():
    robot = dp.load("ur5")
    q, v, a = robot.sample(12, seed=1)
    expected = dp.rnea(robot, q, v, a)
    f = lambda *x: dj.rnea(robot, *x)  # noqa: E731
    for g in (f, jax.jit(f), jax.vmap(f), jax.jit(jax.vmap(f))):
        assert np.array_equal(g(q, v, a), expected)
    assert np.array_equal(jax.vmap(f, (0, None, 0))(q, v[0], a), dp.rnea(robot, q, v[0], a))
    nested = jax.vmap(jax.vmap(f))(*(x.reshape(3, 4, 6) for x in (q, v, a)))
    assert np.array_equal(nested, expected.reshape(3, 4, 6))
    mixed = jax.vmap(jax.vmap(f, (0, None, None)), (None, 0, None))(q[:3], v[:2], a[0])
    assert np.array_equal(mixed, dp.rnea(robot, q[None, :3], v[:2, None], a[0]))
    gradient = jax.jit(jax.vmap(jax.grad(lambda q, v, a, w: f(q, v, a) @ w)))(q, v, a, a)
    assert np.allclose(gradient, dp.rnea_vjp(robot, q, v, a, a)[0], rtol=1e-13, atol=1e-12)


def test_a_batch_of_vmap_is_one_call_of_machine_code():
    robot = dp.load("ur5")
    states = robot.sample(12, seed=1)
    program = jax.jit(jax.vmap(lambda *x: dj.rnea(robot, *x))).lower(*states).as_text()
    assert re.findall(r"custom_call @(\w+?)_[0-9a-f]{32}\(.*?-> (.*)", program) == [
        ("dualpin_rnea", "tensor<12x6xf64>")
    ]
    again = jax.jit(lambda *x: dj.rnea(dp.load("ur5"), *x)).lower(*states).as_text()
    name = r"dualpin_rnea_\w+"
    assert re.findall(name, program) == re.findall(name, again)  # equal robots share it


@pytest.fixture
def called_back(monkeypatch):
    """As where there is no compiler: a robot that no program has seen yet is called back."""
    monkeypatch.setattr(dj, "_target", lambda *_: None)


def test_called_back_it_is_the_same(called_back):
    robot, same = ROBOTS["floating"](), ROBOTS["floating"]()
    states = robot.sample(12, seed=1)
    f = lambda *x: dj.rnea(robot, *x)  # noqa: E731
    assert "callback" in jax.jit(f).lower(*states).as_text()
    for g in (jax.jit(f), jax.jit(jax.vmap(f)), jax.vmap(f, (0, 0, 0))):
        assert np.array_equal(g(*states), dp.rnea(same, *states))
    by_v = jax.jit(jax.grad(lambda *x: f(*x).sum(), 1))(*states)
    assert np.array_equal(by_v, dp.rnea_vjp(same, *states, np.ones_like(states[1]))[1])


def test_what_machine_code_leaves_to_python():
    robot, (q, v, a) = ROBOTS["floating"](), ROBOTS["floating"]().sample(70_000, seed=6)
    f = jax.jit(lambda *x: dj.rnea(robot, *x))
    expected = dp.rnea(robot, q, v, a)
    assert np.array_equal(f(q[:0], v[:0], a[:0]), expected[:0])
    before = dp.get_num_threads()
    try:
        for threads in (1, 2):  # many samples are shared among threads, which are Python's
            dp.set_num_threads(threads)
            assert np.array_equal(f(q, v, a), expected)
    finally:
        dp.set_num_threads(before)
    q[1, 3:7] *= 1.1
    for n in (2, len(q)):
        with pytest.raises(Exception, match=r"rnea: q.3:7. of joint .* unit quaternion .* 1.1 at sample .1,."):
            jax.block_until_ready(f(q[:n], v[:n], a[:n]))
    assert np.array_equal(f(q[2:], v[2:], a[2:]), expected[2:])


def test_threads_and_loops_of_xla():
    robot = dp.load("ur5")
    q, v, _ = (jnp.asarray(x) for x in robot.sample(8, seed=7))

    @jax.jit
    def end(q, v):
        def step(state, _):
            q, v = state
            v = v + 1e-3 * dj.aba(robot, q, v, 0 * v)
            return (q + 1e-3 * v, v), None

        return jax.lax.scan(step, (q, v), None, length=20)[0][0]

    def plain(q, v):
        for _ in range(20):
            v = v + 1e-3 * dp.aba(robot, q, v, 0 * v)
            q = q + 1e-3 * v
        return q

    def one(k):
        with enable_x64(True):  # a thread's own setting
            return np.asarray(end(q[k], v[k]))

    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(one, range(8)))
    expected = [plain(np.asarray(q[k]), np.asarray(v[k])) for k in range(8)]
    assert np.allclose(found, expected, rtol=0, atol=1e-12)  # XLA fuses multiplications and additions
    check_grads(lambda q, v: end(q, v), (q[0], v[0]), order=1, modes=["rev"], rtol=DIFFERENCES)


def test_the_hessian_is_the_analytic_one():
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=2)
    hessian = jax.jit(jax.jacrev(jax.grad(lambda q: dj.rnea(robot, q, v, a) @ a)))(q)
    assert np.allclose(hessian, dp.rnea_hessian(robot, q, v, a, a)[0], rtol=1e-12, atol=1e-11)


def test_single_precision_is_that_of_the_arrays():
    with enable_x64(False):
        robot = dp.load("ur5")
        q, v, a = robot.sample(3, seed=3)
        tau = dj.rnea(robot, *(jnp.asarray(x) for x in (q, v, a)))
        expected = dp.rnea(robot, q, v, a)
        assert tau.dtype == jnp.float32 and np.abs(tau - expected).max() < 1e-5 * np.abs(expected).max()


def test_what_does_not_fit_is_named():
    robot = dp.load("ur5")
    q, v, a = robot.sample(2, seed=5)
    with pytest.raises(dp.ShapeError, match=r"v of shape \(\.\.\., 6\) expected for ur5"):
        dj.rnea(robot, q, v[:, :5], a)
    with pytest.raises(dp.ArgumentError, match="a Robot expected"):
        dj.rnea("ur5", q, v, a)
    with pytest.raises(dp.ArgumentError, match="float32 or float64 expected, got complex"):
        dj.rnea(robot, q + 0j, v, a)
    third = jax.grad(lambda q: jax.grad(lambda q: jax.grad(lambda q: dj.rnea(robot, q, v[0], a[0])[1])(q)[2])(q)[2])
    with pytest.raises(dp.DualpinError, match="rnea_hvp has no derivative"):
        third(q[0])


def test_a_robot_goes_when_nobody_has_it():
    import gc
    import weakref

    robot = ROBOTS["fixed"]()
    q, v, a = robot.sample(seed=0)
    gone = weakref.ref(robot)
    jax.grad(lambda q: dj.rnea(gone(), q, v, a).sum())(q)
    del robot
    jax.clear_caches()
    gc.collect()
    assert gone() is None


@pytest.mark.skipif(shutil.which("cc") is None, reason="cc is not installed")
def test_call_frames_are_those_of_xlas_header(tmp_path):
    from dualpin.engine.codegen import xla

    fields = {
        "api": "api", "args_size": "args", "args": "args.args", "rets_size": "rets", "rets": "rets.rets",
        "extension": "extension_start",
    }  # fmt: skip
    asked = [("XLA_FFI_CallFrame", there, list(xla.FRAME).index(here)) for here, there in fields.items()]
    asked += [("XLA_FFI_Buffer", x, list(xla.BUFFER).index(x)) for x in ("data", "rank", "dims")]
    asked += [("XLA_FFI_Api", "XLA_FFI_Error_Create", list(xla.API_TABLE).index("error"))]
    asked += [("XLA_FFI_Metadata_Extension", "metadata", 3), ("XLA_FFI_Error_Create_Args", "message", 2)]
    tests = [f"8 * {k} == offsetof(struct {kind}, {field})" for kind, field, k in asked]
    tests += [
        "4 * 6 == offsetof(struct XLA_FFI_Metadata, api_version.major_version)",
        "4 * 8 == offsetof(struct XLA_FFI_Metadata, traits)", "8 == offsetof(struct XLA_FFI_Extension_Base, type)",
        f"{xla.METADATA} == XLA_FFI_Extension_Metadata", f"{xla.INVALID} == XLA_FFI_Error_Code_INVALID_ARGUMENT",
    ]  # fmt: skip
    lines = [f'_Static_assert({test}, "{test}");' for test in tests]
    (tmp_path / "layout.c").write_text('#include <stddef.h>\n#include "xla/ffi/api/c_api.h"\n' + "\n".join(lines))
    words = ["cc", "-std=c11", "-fsyntax-only", "-I", jax.ffi.include_dir(), "layout.c"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
