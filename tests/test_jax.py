"""JAX: gradients of gradients against finite differences, jit, vmap, precision, clear refusals."""

from __future__ import annotations

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
    "kinetic_energy": "qv", "potential_energy": "q",
}  # fmt: skip
ONCE = ("com",)
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
        for at in units:  # whatever is disturbed comes back to unit quaternions
            q = q.at[..., at].divide(jnp.linalg.norm(q[..., at], axis=-1, keepdims=True))
        return getattr(dj, name)(robot, q, *rest)

    return f, [jnp.asarray(x) for x in given]


# JAX compiles every case anew, seconds each: PyTorch's tests go through the same rules for all joints
CASES = [
    pytest.param(name, kind, marks=[] if (name, kind) in SOME else [pytest.mark.campaign])
    for name in TERMS for kind in ROBOTS
]  # fmt: skip


@pytest.mark.parametrize(("name", "kind"), CASES)
def test_gradients_and_gradients_of_gradients(name, kind):
    f, given = case(ROBOTS[kind](), name, 2)
    check_grads(f, given, order=1 if name in ONCE else 2, modes=["rev"], rtol=DIFFERENCES)


@pytest.mark.campaign
@pytest.mark.parametrize("name", ["rnea", "aba"])
def test_gradients_with_wrenches_on_the_bodies(name):
    f, given = case(ROBOTS["floating"](), name, 1, forces=True)
    check_grads(f, given, order=2, modes=["rev"], rtol=DIFFERENCES)


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


def test_a_batch_of_vmap_is_one_call(monkeypatch):
    from dualpin.autodiff.operation import Operation

    robot, seen, compute = dp.load("ur5"), [], Operation.compute
    monkeypatch.setattr(Operation, "compute", lambda self, *x: seen.append(x[0].shape) or compute(self, *x))
    q, v, a = robot.sample(12, seed=1)
    jax.block_until_ready(jax.vmap(lambda *x: dj.rnea(robot, *x))(q, v, a))
    assert seen == [(12, 6)]


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
