"""Derivatives of dynamics: against Pinocchio's, against differences in fifty digits, and their identities."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from random_robots import tree

import dualpin as dp
from dualpin.algorithms.derivatives import aba_derivatives, rnea_derivatives
from dualpin.algorithms.rnea import rnea
from dualpin.terms import TERMS

ROBOTS = [("ur5", False), ("panda", False), ("panda", True), ("talos", True), ("solo8", True)]


def scaled(x, ref):
    return float(np.abs(x - ref).max()) / max(1.0, float(np.abs(ref).max()))


def pinocchio(robot):
    pin = pytest.importorskip("pinocchio")
    from dualpin.crosscheck.oracles.pinocchio import Layout, build

    floating = robot.joints[0].kind == "floating"
    return pin, Layout(robot, build(robot.source, floating, mimic=False))


@pytest.mark.parametrize(("name", "floating"), ROBOTS)
def test_inverse_dynamics_like_pinocchio(name, floating):
    robot = dp.load(name, floating=floating)
    pin, layout = pinocchio(robot)
    q, v, a = robot.sample(5, seed=0)
    G, data = layout.G, layout.model.createData()
    ours = np.stack(dp.rnea_derivatives(robot, q, v, a), axis=1)
    for i in range(5):
        dq, dv, da = pin.computeRNEADerivatives(layout.model, data, layout.q(q)[i], layout.v(v)[i], layout.v(a)[i])
        for x, ref in zip(ours[i], (dq, dv, np.triu(da) + np.triu(da, 1).T), strict=True):
            assert scaled(x, G.T @ ref @ G) < 1e-12  # no linear solve


@pytest.mark.parametrize(("name", "floating"), ROBOTS)
def test_forward_dynamics_like_pinocchio(name, floating):
    robot = dp.load(name, floating=floating)
    pin, layout = pinocchio(robot)
    q, v, a = robot.sample(5, seed=0)
    tau = dp.rnea(robot, q, v, a)
    G, data = layout.G, layout.model.createData()
    ours = np.stack(dp.aba_derivatives(robot, q, v, tau), axis=1)
    M = dp.crba(robot, q)
    for i in range(5):
        dq, dv, dtau = pin.computeABADerivatives(layout.model, data, layout.q(q)[i], layout.v(v)[i], layout.v(tau)[i])[
            :3
        ]
        # two solutions with M, one inside the other
        bound = 1e-15 * np.linalg.cond(M[i])
        for x, ref in zip(ours[i], (dq, dv, np.triu(dtau) + np.triu(dtau, 1).T), strict=True):
            assert scaled(x, G.T @ ref @ G) < max(1e-12, bound)


KINDS = ["revolute", "prismatic", "cylindrical", "helical", "planar", "floating"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_joint_like_differences_in_fifty_digits(kind):
    """Central differences with steps of 1e-20, displaced by `integrate`: good to 1e-47 / 1e-20."""
    robot = tree([kind, "revolute", kind, "prismatic"], seed=3, armature=True)
    with mpmath.workdps(50):
        exact = robot.lift(mpmath.mpf)
        q, v, a = (list(map(mpmath.mpf, x.tolist())) for x in robot.sample(seed=1))
        h = mpmath.mpf(10) ** -20
        integrate = TERMS["integrate"].compute

        def moved(k, sign):
            step = [sign * h if j == k else mpmath.mpf(0) for j in range(robot.nv)]
            return [x for part in integrate(exact, q, step) for x in part]

        def shifted(x, k, sign):
            return [y + sign * h if j == k else y for j, y in enumerate(x)]

        q = moved(0, 0)  # unit quaternions to fifty digits, too
        dq, dv, da = rnea_derivatives(exact, q, v, a)
        for k in range(robot.nv):
            for matrix, f in (
                (dq, lambda s, k=k: rnea(exact, moved(k, s), v, a)),
                (dv, lambda s, k=k: rnea(exact, q, shifted(v, k, s), a)),
                (da, lambda s, k=k: rnea(exact, q, v, shifted(a, k, s))),
            ):
                for i, (up, down) in enumerate(zip(f(1), f(-1), strict=True)):
                    assert abs((up - down) / (2 * h) - matrix[i][k]) < mpmath.mpf(10) ** -25


def test_velocity_derivative_at_rest_vanishes_and_gravitys_hessian_is_symmetric():
    robot = dp.load("panda")
    q, _, _ = robot.sample(seed=2)
    zero = np.zeros(robot.nv)
    dq, dv, da = dp.rnea_derivatives(robot, q, zero, zero)
    assert np.abs(dv).max() == 0.0
    assert scaled(dq, dq.T) < 1e-14  # d g / dq = d^2 U / dq^2
    assert scaled(da, dp.crba(robot, q)) < 1e-15


def test_forward_and_inverse_derivatives_are_inverse_to_each_other():
    robot = dp.load("talos")
    q, v, a = robot.sample(3, seed=3)
    tau = dp.rnea(robot, q, v, a)
    dq, dv, M = dp.rnea_derivatives(robot, q, v, a)
    fq, fv, inverse = dp.aba_derivatives(robot, q, v, tau)
    bound = 1e-15 * np.linalg.cond(M).max()
    assert scaled(-M @ fq, dq) < bound
    assert scaled(-M @ fv, dv) < bound
    assert scaled(M @ inverse, np.eye(robot.nv)) < bound


@pytest.mark.parametrize("engine", ["compiled", "numpy"])
def test_batches_of_any_shape(engine):
    robot = dp.load("ur5")
    q, v, a = (x.reshape(2, 3, 6) for x in robot.sample(6, seed=4))
    for x in (*dp.rnea_derivatives(robot, q, v, a, engine=engine), *dp.aba_derivatives(robot, q, v, a, engine=engine)):
        assert x.shape == (2, 3, 6, 6)


def test_over_plain_floats():
    robot = dp.load("ur5")
    q, v, a = (x.tolist() for x in robot.sample(seed=5))
    dq, _, _ = aba_derivatives(robot, q, v, a)
    expected = dp.aba_derivatives(robot, q, v, a)[0]
    assert scaled(np.array(dq, dtype=float), expected) < 1e-12
