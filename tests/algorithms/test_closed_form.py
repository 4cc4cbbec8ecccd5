"""SymPy numbers through the same algorithms: the equations of textbooks."""

from __future__ import annotations

from typing import Any

import pytest
import sympy as sp

from dualpin.algorithms import aba, coriolis, crba, jacobian, kinematics, momentum, rnea
from dualpin.model import Builder, Robot, prismatic, revolute
from dualpin.scalars import ONE, ZERO
from dualpin.spatial import UY, UZ, Inertia, Matrix3, Pose, Vector3

m1, m2, l1, l2, r1, r2, I1, I2, g = sp.symbols("m1 m2 l1 l2 r1 r2 I1 I2 g", positive=True)
q1, q2, v1, v2, a1, a2 = sp.symbols("q1 q2 v1 v2 a1 a2", real=True)


def link(mass: Any, reach: Any, inertia: Any) -> Inertia:
    """A rod along x, its centre at `reach`, of rotational inertia `inertia` about z through it."""
    J = Matrix3(Vector3(ZERO, ZERO, ZERO), Vector3(ZERO, ZERO, ZERO), Vector3(ZERO, ZERO, inertia + mass * reach**2))
    return Inertia(mass, Vector3(mass * reach, ZERO, ZERO), J)


@pytest.fixture(scope="module")
def double_pendulum() -> Robot:
    """Two rods that turn about z; gravity along -y; angles from the x axis."""
    b = Builder("double_pendulum")
    b.gravity = Vector3(ZERO, -g, ZERO)
    b.joint("shoulder", revolute(UZ), inertia=link(m1, r1, I1))
    b.joint("elbow", revolute(UZ), "shoulder", Pose(position=Vector3(l1, ZERO, ZERO)), link(m2, r2, I2))
    b.frame("tip", "elbow", Pose(position=Vector3(l2, ZERO, ZERO)))
    return b.robot()


def same(x: Any, y: Any) -> bool:
    return sp.simplify(sp.expand_trig(sp.sympify(x) - sp.sympify(y))) == 0


def test_mass_matrix_of_the_double_pendulum(double_pendulum):
    M = crba.crba(double_pendulum, [q1, q2])
    alpha = I1 + I2 + m1 * r1**2 + m2 * (l1**2 + r2**2)
    beta, delta = m2 * l1 * r2, I2 + m2 * r2**2
    expected = [
        [alpha + 2 * beta * sp.cos(q2), delta + beta * sp.cos(q2)],
        [delta + beta * sp.cos(q2), delta],
    ]
    assert all(same(M[i][j], expected[i][j]) for i in range(2) for j in range(2))


def test_coriolis_matrix_of_the_double_pendulum(double_pendulum):
    C = coriolis.coriolis(double_pendulum, [q1, q2], [v1, v2])
    h = m2 * l1 * r2 * sp.sin(q2)
    expected = [[-h * v2, -h * (v1 + v2)], [h * v1, 0]]
    assert all(same(C[i][j], expected[i][j]) for i in range(2) for j in range(2))


def test_gravity_of_the_double_pendulum(double_pendulum):
    G = rnea.gravity(double_pendulum, [q1, q2])
    second = m2 * r2 * g * sp.cos(q1 + q2)
    assert same(G[0], (m1 * r1 + m2 * l1) * g * sp.cos(q1) + second)
    assert same(G[1], second)


def test_inverse_dynamics_of_the_double_pendulum_is_lagranges(double_pendulum):
    """d/dt dL/dv - dL/dq with L = T - U of the same source, against rnea."""
    r, t = double_pendulum, sp.Symbol("t")
    T = momentum.kinetic_energy(r, [q1, q2], [v1, v2])
    L = T - momentum.potential_energy(r, [q1, q2])
    tau = rnea.rnea(r, [q1, q2], [v1, v2], [a1, a2])
    for q, v, force in ((q1, v1, tau[0]), (q2, v2, tau[1])):
        p = sp.diff(L, v)
        rate = sum(sp.diff(p, x) * dx for x, dx in ((q1, v1), (q2, v2), (v1, a1), (v2, a2)))
        assert same(rate - sp.diff(L, q), force)
    assert t not in sp.sympify(tau[0]).free_symbols


def test_forward_dynamics_of_the_double_pendulum(double_pendulum):
    tau = rnea.rnea(double_pendulum, [q1, q2], [v1, v2], [a1, a2])
    a = aba.aba(double_pendulum, [q1, q2], [v1, v2], tau)
    values = {m1: 2, m2: 3, l1: 1, l2: 2, r1: sp.Rational(1, 2), r2: 1, I1: 1, I2: 2, g: 10}
    state = {q1: sp.pi / 3, q2: sp.pi / 4, v1: 1, v2: -2, a1: 3, a2: 5}
    found = [sp.simplify(sp.sympify(x).subs(values).subs(state)) for x in a]
    assert found == [3, 5]  # exactly: no rounding anywhere


def test_position_and_jacobian_of_the_double_pendulum(double_pendulum):
    r = double_pendulum
    T = kinematics.frame_pose(r, [q1, q2], r.frame("tip"))
    x, y, _ = T.position
    assert same(x, l1 * sp.cos(q1) + l2 * sp.cos(q1 + q2))
    assert same(y, l1 * sp.sin(q1) + l2 * sp.sin(q1 + q2))
    J = jacobian.jacobian(r, [q1, q2], r.frame("tip"), "local_world_aligned")
    for column, q in zip(J, (q1, q2), strict=True):
        assert same(column.x.dual, sp.diff(sp.sympify(x), q))
        assert same(column.y.dual, sp.diff(sp.sympify(y), q))
        assert same(column.z.real, 1)


def test_cart_and_pole():
    """The cart-pole of every textbook: a slider along x and a pendulum about y."""
    b = Builder("cart_pole", gravity=(0.0, 0.0, -9.81))
    b.gravity = Vector3(ZERO, ZERO, -g)
    zero = Matrix3(*(Vector3(ZERO, ZERO, ZERO) for _ in range(3)))
    b.joint("cart", prismatic(Vector3(ONE, ZERO, ZERO)), inertia=Inertia(m1, Vector3(ZERO, ZERO, ZERO), zero))
    pole = Matrix3(Vector3(m2 * l1**2, ZERO, ZERO), Vector3(ZERO, m2 * l1**2, ZERO), Vector3(ZERO, ZERO, ZERO))
    b.joint("pole", revolute(UY), "cart", inertia=Inertia(m2, Vector3(ZERO, ZERO, m2 * l1), pole))
    M = crba.crba(b.robot(), [q1, q2])
    tau = rnea.bias(b.robot(), [q1, q2], [v1, v2])
    assert same(M[0][0], m1 + m2) and same(M[0][1], m2 * l1 * sp.cos(q2)) and same(M[1][1], m2 * l1**2)
    assert same(tau[0], -m2 * l1 * sp.sin(q2) * v2**2)
    assert same(tau[1], -m2 * g * l1 * sp.sin(q2))


def test_a_symbolic_robot_can_be_shown(double_pendulum):
    assert "2 joints" in repr(double_pendulum)
