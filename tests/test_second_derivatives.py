"""Second derivatives of inverse dynamics: against differences of the first in fifty digits, and by complex step."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from random_robots import tree

import dualpin as dp
from dualpin.algorithms.derivatives import rnea_derivatives
from dualpin.algorithms.second_derivatives import rnea_second_derivatives
from dualpin.call import evaluate
from dualpin.fuzz import complex_step
from dualpin.scalars import Exact
from dualpin.terms import TERMS

KINDS = ["revolute", "prismatic", "cylindrical", "helical", "planar", "floating", "spherical"]
TIGHT = 1e-12  # no linear solve


def scaled(x, ref):
    return float(np.abs(x - ref).max(initial=0)) / max(1.0, float(np.abs(ref).max(initial=0)))


def pushes(robot, *shape, seed=0):
    return np.random.default_rng(seed).uniform(-10, 10, (*shape, len(robot), 6))


@pytest.mark.parametrize("kind", KINDS)
def test_every_joint_like_differences_in_fifty_digits(kind):
    """Central differences of the first derivatives with steps of 1e-20, displaced by `integrate`."""
    robot = tree([kind, "revolute"] if kind == "floating" else ["revolute", kind, "prismatic"], seed=3, armature=True)
    n, number = robot.nv, np.vectorize(lambda x: mpmath.mpf(x.n) if isinstance(x, Exact) else x, otypes=[object])
    with mpmath.workdps(50):
        exact = robot.lift(mpmath.mpf)
        q, v, a = (list(map(mpmath.mpf, x.tolist())) for x in robot.sample(seed=1))
        h = mpmath.mpf(10) ** -20

        def moved(k, sign):
            step = [sign * h if j == k else mpmath.mpf(0) for j in range(n)]
            return [x for part in TERMS["integrate"].compute(exact, q, step) for x in part]

        def slope(up, down):
            return [number(np.array(x) - np.array(y)) / (2 * h) for x, y in zip(up, down, strict=True)]

        q = moved(0, 0)  # unit quaternions to fifty digits, too
        qq, qv, vv, aq = (number(np.array(T)) for T in rnea_second_derivatives(exact, q, v, a))
        for k in range(n):
            by_q = slope(*(rnea_derivatives(exact, moved(k, s), v, a) for s in (1, -1)))
            faster = ([x + s * h if j == k else x for j, x in enumerate(v)] for s in (1, -1))
            by_v = slope(*(rnea_derivatives(exact, q, x, a) for x in faster))
            pairs = ((by_q[0], qq[:, :, k]), (by_q[1], qv[:, k]), (by_q[2], aq[:, :, k]), (by_v[0], qv[:, :, k]),
                     (by_v[1], vv[:, :, k]))  # fmt: skip
            for difference, found in pairs:
                assert np.abs(difference - found).max() < mpmath.mpf(10) ** -25


@pytest.mark.parametrize("forces", [False, True], ids=["", "f_ext"])
@pytest.mark.parametrize(("name", "floating"), [("panda", False), ("solo8", True)])
def test_like_the_complex_step_of_the_first_derivatives(name, floating, forces):
    robot = dp.load(name, floating=floating)
    q, v, a = robot.sample(seed=0)
    f_ext = [pushes(robot)] if forces else []
    extra = [(f.ravel(), 0 * f.ravel()) for f in f_ext]
    term, zero = "rnea_derivatives" + "_f_ext" * forces, np.zeros(robot.nv)
    qq, qv, vv, aq = dp.rnea_second_derivatives(robot, q, v, a, *f_ext, engine="numpy")
    for direction in (v, np.arange(float(robot.nv))):
        dq, dv, da = complex_step.along(robot, term, q, direction, (v, zero), (a, zero), *extra)
        assert scaled(qq @ direction, dq) < TIGHT
        assert scaled(np.einsum("ijk,j->ik", qv, direction), dv) < TIGHT
        assert scaled(aq @ direction, da) < TIGHT
        dq, dv, da = complex_step.along(robot, term, q, zero, (v, direction), (a, zero), *extra)
        assert scaled(qv @ direction, dq) < TIGHT and scaled(vv @ direction, dv) < TIGHT and not da.any()


@pytest.mark.parametrize("mimic", [False, True], ids=["", "mimic"])
@pytest.mark.parametrize("forces", [False, True], ids=["", "f_ext"])
def test_products_are_those_of_the_tensors(forces, mimic):
    robot = dp.load("panda", mimic=True) if mimic else tree(["floating", "revolute", "planar"], seed=5, armature=True)
    q, v, a = robot.sample(4, seed=1)
    n, rng = robot.nv, np.random.default_rng(2)
    w, *direction = rng.normal(size=(4, 4, n))
    f_ext = (pushes(robot, 4),) if forces else ()
    first = dp.rnea_derivatives(robot, q, v, a, *f_ext, engine="numpy")
    tensors = dp.rnea_second_derivatives(robot, q, v, a, *f_ext, engine="numpy")
    qq, qv, vv, aq = hessians = dp.rnea_hessian(robot, q, v, a, w, *f_ext, engine="numpy")
    for T, H in zip(tensors, hessians, strict=True):
        assert scaled(np.einsum("bi,bijk->bjk", w, T), H) < TIGHT
    for D, g in zip(first, dp.rnea_vjp(robot, q, v, a, w, *f_ext, engine="numpy"), strict=True):
        assert scaled(g, np.einsum("bi,bij->bj", w, D)) < TIGHT
    along = sum(np.einsum("bij,bj->bi", D, x) for D, x in zip(first, direction, strict=True))
    assert scaled(dp.rnea_jvp(robot, q, v, a, *direction, *f_ext, engine="numpy"), along) < TIGHT
    dq, dv, da = (x[:, None] for x in direction)
    turned = np.swapaxes(qv, 1, 2)
    expected = (dq @ qq + dv @ turned + da @ aq, dq @ qv + dv @ vv, dq @ np.swapaxes(aq, 1, 2))
    for got, right in zip(dp.rnea_hvp(robot, q, v, a, w, *direction, *f_ext, engine="numpy"), expected, strict=True):
        assert scaled(got, right[:, 0]) < TIGHT


def test_coupled_coordinates_have_the_derivatives_of_the_coordinate_they_share():
    robot = dp.load("panda", mimic=True)
    assert robot.coupled
    q, v, a = robot.sample(seed=2)
    qq = dp.rnea_second_derivatives(robot, q, v, a, engine="numpy")[0]
    h = 1e-5
    for k in range(robot.nv):
        step = h * np.eye(robot.nv)[k]
        up, down = (dp.rnea_derivatives(robot, q + s * step, v, a, engine="numpy")[0] for s in (1, -1))
        assert scaled(qq[:, :, k], (up - down) / (2 * h)) < 1e-8  # h^2


def test_christoffels_symbols():
    """d2 tau_i / dv_j dv_k = dM_ij / dq_k + dM_ik / dq_j - dM_jk / dq_i where coordinates add."""
    robot = dp.load("panda")
    q, v, a = robot.sample(seed=3)
    _, _, vv, aq = dp.rnea_second_derivatives(robot, q, v, a, engine="numpy")
    expected = aq + np.einsum("ijk->ikj", aq) - np.einsum("ijk->kij", aq)
    assert scaled(vv, expected) < TIGHT
    assert scaled(aq, np.swapaxes(aq, 0, 1)) < TIGHT and scaled(vv, np.swapaxes(vv, 1, 2)) < TIGHT


def test_additive_coordinates_commute_and_rotations_leave_their_bracket():
    """qq[i, j, k] - qq[i, k, j] = d tau_i / dq . [s_k, s_j], zero where coordinates add."""
    robot = tree(["floating", "revolute"], seed=4)
    q, v, a = robot.sample(seed=4)
    qq = dp.rnea_second_derivatives(robot, q, v, a, engine="numpy")[0]
    dq = dp.rnea_derivatives(robot, q, v, a, engine="numpy")[0]
    unit, base = np.eye(6), robot.joints[0].model
    for j in range(robot.nv):
        for k in range(robot.nv):
            bracket = np.zeros(robot.nv)
            if max(j, k) < 6:
                bracket[:6] = [float(x) for x in base.bracket(unit[k].tolist(), unit[j].tolist())]
            assert scaled(qq[:, j, k] - qq[:, k, j], dq @ bracket) < TIGHT


def test_the_hessian_in_exponential_coordinates_is_the_mean():
    robot = tree(["floating", "revolute"], seed=6)
    q, v, a = robot.sample(seed=6)
    qq = dp.rnea_second_derivatives(robot, q, v, a, engine="numpy")[0]
    x, h = np.random.default_rng(0).normal(size=robot.nv), 1e-4

    def tau(t):
        return dp.rnea(robot, dp.integrate(robot, q, t * x), v, a, engine="numpy")

    expected = (tau(h) - 2 * tau(0) + tau(-h)) / h**2
    assert scaled(np.einsum("ijk,j,k->i", qq, x, x), expected) < 1e-5  # h^2, and rounding / h^2


@pytest.mark.campaign
@pytest.mark.parametrize("name", ["ur5", "panda", "talos"])
def test_like_pinocchios(name, tmp_path):
    """Its wheel does not bind them: its headers are compiled in the environment of the peer, for minutes."""
    from dualpin.peers.process import AbsentError, Process, write_robot

    robot = dp.load(name)
    q, v, a = robot.sample(64, seed=8)
    write_robot(robot, tmp_path, {"q": q, "v": 3 * v, "a": a})
    try:
        peer = Process("pinocchio_native", tmp_path)
    except AbsentError as e:
        pytest.skip(str(e))
    try:
        theirs = peer.check("rnea_second_derivatives", True)
    finally:
        peer.close()
    ours = np.stack(dp.rnea_second_derivatives(robot, q, 3 * v, a, engine="numpy"), axis=1)
    for T, ref in zip(np.moveaxis(ours, 1, 0), np.moveaxis(theirs, 1, 0), strict=True):
        assert scaled(T, ref) < TIGHT


NEW = ("rnea_jvp", "rnea_vjp", "rnea_hvp", "rnea_hessian", "rnea_second_derivatives", "rnea_derivatives")


@pytest.mark.parametrize("forces", [False, True], ids=["", "f_ext"])
@pytest.mark.parametrize("term", NEW)
def test_compiled_and_uncompiled_agree(term, forces):
    robot = tree(["floating", "revolute"], seed=5)
    q, v, a = robot.sample(11, seed=5)
    given = {"q": q, "v": v, "a": a, "w": a, "dq": v, "dv": a, "da": v, "f_ext": pushes(robot, 11)}
    name = term + "_f_ext" * forces
    inputs = {key: given[key] for key in TERMS[name].inputs}
    got, expected = (evaluate(robot, name, inputs, engine=engine) for engine in ("compiled", "numpy"))
    assert scaled(got, expected) < 1e-13
    one = evaluate(robot, name, {key: x[3] for key, x in inputs.items()}, engine="compiled")
    assert np.array_equal(one, got[3])  # the same bits, whatever the batch


@pytest.mark.parametrize("name", [*NEW, "aba_derivatives"])
def test_results_are_written_where_they_should(name):
    robot = tree(["floating", "revolute"], seed=5)
    q, v, a = robot.sample(3, seed=6)
    more = {"rnea_jvp": (v, a, v), "rnea_vjp": (a,), "rnea_hvp": (a, v, a, v), "rnea_hessian": (a,)}.get(name, ())
    f, forces = getattr(dp, name), pushes(robot, 3)
    expected = f(robot, q, v, a, *more, forces)
    whole = isinstance(expected, np.ndarray)
    out = np.empty_like(expected) if whole else np.empty((3, len(expected), *expected[0].shape[1:]))
    got = f(robot, q, v, a, *more, forces, out=out)
    assert got is out if whole else all(np.shares_memory(x, out) for x in got)
    parts = [(got, expected)] if whole else zip(got, expected, strict=True)
    assert all(np.array_equal(x, y) for x, y in parts)
    with pytest.raises(dp.ShapeError, match=r"out of shape"):
        f(robot, q, v, a, *more, out=np.empty((3, 1)))


def test_wrenches_on_bodies_enter_first_derivatives_and_accelerations_too():
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=7)
    f_ext, h = pushes(robot), 1e-6
    dq, dv, _ = dp.rnea_derivatives(robot, q, v, a, f_ext)
    up, down = (dp.rnea(robot, q + s * v, v, a, f_ext) for s in (h, -h))
    assert scaled(dq @ v, (up - down) / (2 * h)) < 1e-7
    tau = dp.rnea(robot, q, v, a, f_ext)
    by_q, by_v, by_tau = dp.aba_derivatives(robot, q, v, tau, f_ext)
    assert scaled(by_q, -by_tau @ dq) < 1e-9 and scaled(by_v, -by_tau @ dv) < 1e-9  # a solution with M
    assert scaled(dp.rnea_derivatives(robot, q, v, a, 0 * f_ext)[0], dp.rnea_derivatives(robot, q, v, a)[0]) < TIGHT
