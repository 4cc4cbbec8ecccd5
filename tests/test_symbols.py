"""Symbols of every kind pass through the same formulas: functions of time, arrays, columns."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import dualpin as dp
from dualpin.algorithms import crba, rnea
from dualpin.model import Builder, revolute
from dualpin.spatial import UY, Inertia, Pose, Vector3, diagonal

sympy = pytest.importorskip("sympy")
mechanics = pytest.importorskip("sympy.physics.mechanics")


def pendulum():
    b, rod = Builder("pendulum"), Inertia(2.0, Vector3(0.5, 0.0, 0.0), diagonal(0.7))
    b.joint("a", revolute(UY), inertia=rod)
    b.joint("b", revolute(UY), "a", placement=Pose(position=Vector3(1.1, 0.0, 0.0)), inertia=rod)
    return b.robot()


def test_functions_of_time_are_symbols():
    q, (x, y) = mechanics.dynamicsymbols("q0 q1"), sympy.symbols("x y")
    M, plain = (crba.crba(pendulum(), z) for z in (q, [x, y]))
    assert sympy.simplify(M[0][0].subs({q[0]: x, q[1]: y}) - plain[0][0]) == 0
    tau = rnea.rnea(pendulum(), q, [z.diff() for z in q], [z.diff(mechanics.dynamicsymbols._t, 2) for z in q])
    assert tau[0].has(sympy.Derivative)
    assert dp.Dual(q[0], q[1]) * 2 == dp.Dual(2 * q[0], 2 * q[1])


@pytest.mark.parametrize("form", [list, tuple, np.array, sympy.Matrix], ids=["list", "tuple", "array", "Matrix"])
def test_symbols_come_in_any_vessel(form):
    q, names = mechanics.dynamicsymbols("q0 q1"), sympy.symbols("q0 q1", real=True)
    M = dp.symbolic(pendulum(), "crba", q=form(q))
    assert sympy.simplify(M.subs(dict(zip(q, names, strict=True))) - dp.symbolic(pendulum(), "crba")).is_zero_matrix


def test_arrays_of_symbols_have_angles_too():
    a, b, c = sympy.symbols("a b c", positive=True)
    angle = np.arctan2(dp.Dual([a, b], [1, 2]), dp.Dual([b, c], [3, 4]))
    assert angle.real.tolist() == [sympy.atan2(a, b), sympy.atan2(b, c)]
    assert sympy.simplify(angle.dual[0] - (b - 3 * a) / (a**2 + b**2)) == 0
    mixed = np.arctan2(dp.Dual([a, b], [0, 0]), dp.Dual([1.0, 2.0], [0.0, 0.0]))
    assert mixed.real[1] == sympy.atan2(b, 2.0)


def test_numbers_that_came_from_decimals_are_decimals():
    g = dp.symbolic(pendulum(), "gravity")
    assert "26.487" in str(g) and "/" not in str(g)
    assert "26487" in str(dp.symbolic(pendulum(), "gravity", decimals=False))
    arm = dp.from_dh([(0, 0, 0.5, 0), (0, 0, 0.4, 0)], inertias=[
        {"mass": 2.0, "com": (-0.25, 0, 0)}, {"mass": 1.0, "com": (-0.2, 0, 0)}])  # fmt: skip
    assert str(dp.symbolic(arm, "crba")[0, 0]) == "0.2*cos(q1) + 0.415"


def planar(n=2):
    """The arm of Laus, Simoni and Martins, all in symbols."""
    a, l, m, I = (sympy.symbols(f"{x}1:{n + 1}", positive=True) for x in "almI")
    g = sympy.Symbol("g", positive=True)
    bodies = [{"mass": m[i], "com": (l[i] - a[i], 0, 0), "inertia": sympy.diag(0, 0, I[i])} for i in range(n)]
    return dp.from_dh([(0, 0, x, 0) for x in a], gravity=(0, -g, 0), inertias=bodies), (*a, *l, *m, *I, g)


def test_a_robot_of_symbols_has_the_equations_that_are_printed_in_symbols():
    arm, (a1, _, l1, l2, m1, m2, I1, I2, g) = planar()
    assert arm.numbers == "symbolic"
    q = mechanics.dynamicsymbols("theta1 theta2")
    v = [x.diff() for x in q]
    terms = dp.symbolic(arm, "link_terms", q=q, v=v)
    c1, c2, s2, c12 = sympy.cos(q[0]), sympy.cos(q[1]), sympy.sin(q[1]), sympy.cos(q[0] + q[1])
    M2 = [[m2 * (a1**2 + l2**2 + 2 * a1 * l2 * c2) + I2, m2 * l2 * (l2 + a1 * c2) + I2],
          [m2 * l2 * (l2 + a1 * c2) + I2, m2 * l2**2 + I2]]  # fmt: skip
    C2 = [[-m2 * a1 * l2 * s2 * v[1], -m2 * a1 * l2 * s2 * (v[0] + v[1])], [m2 * a1 * l2 * s2 * v[0], 0]]
    for i, want in ((0, [[m1 * l1**2 + I1, 0], [0, 0]]), (1, M2)):
        assert sympy.simplify(sympy.Matrix(terms[i, :, :2]) - sympy.Matrix(want)).is_zero_matrix
    assert sympy.simplify(sympy.Matrix(terms[1, :, 2:4]) - sympy.Matrix(C2)).is_zero_matrix
    weights = sympy.Matrix([m2 * g * (a1 * c1 + l2 * c12), m2 * g * l2 * c12])
    assert sympy.simplify(sympy.Matrix(terms[1, :, 4]) - weights).is_zero_matrix
    # substituting numbers later or at once gives the same
    values = dict(zip(planar()[1], (0.5, 0.4, 0.25, 0.18, 2.5, 1.5, 0.06, 0.03, 9.81), strict=True))
    number = dp.from_dh([(0, 0, 0.5, 0), (0, 0, 0.4, 0)], gravity=(0, -9.81, 0), inertias=[
        {"mass": 2.5, "com": (-0.25, 0, 0), "inertia": np.diag([0, 0, 0.06])},
        {"mass": 1.5, "com": (-0.22, 0, 0), "inertia": np.diag([0, 0, 0.03])},
    ])  # fmt: skip
    at = {q[0]: 0.3, q[1]: -0.7}
    got = np.array(dp.symbolic(arm, "crba", q=q).subs(values).subs(at).tolist(), dtype=float)
    assert np.abs(got - dp.crba(number, [0.3, -0.7])).max() < 1e-14


def test_whole_numbers_leave_no_floats_behind():
    l = sympy.Symbol("l")
    T = dp.symbolic(
        dp.from_dh([(0, 0, 0, 0), (0, 0, l, sympy.pi / 2)], convention="modified"), "frame_pose", frame="tool"
    )
    assert not T.atoms(sympy.Float)
    assert dp.mechanisms.TwoC(l, 2 * l).chain.position(dp.Dual([0, 0], [l, 0])).tolist() == [3 * l, 0, l]
    g = dp.from_dh([(0, 0, l, 0)], gravity=sympy.Matrix([0, -l, 0])).gravity
    assert (g.y, len(list(g))) == (-l, 3)


def test_only_gravity_is_a_decimal_where_the_rest_are_symbols():
    m, l = sympy.symbols("m l")
    rod = dp.from_dh([(0, 0, l, 0)], gravity=(0, -9.81, 0), inertias=[{"mass": m}])
    q0, v0 = sympy.symbols("q0 v0", real=True)
    assert dp.symbolic(rod, "gravity")[0] == sympy.Float("9.81") * l * m * sympy.cos(q0)
    assert dp.symbolic(rod, "kinetic_energy") == l**2 * m * v0**2 / 2


def test_dual_chains_of_symbols():
    l1, l2, t1, t2, d1, d2 = sympy.symbols("l1 l2 t1 t2 d1 d2")
    chain = dp.mechanisms.DualChain(dp.Dual([sympy.pi / 2, 0], [l1, l2]))
    M = chain.pose(dp.Dual([t1, t2], [d1, d2]))
    c1, s1, c2, s2 = sympy.cos(t1), sympy.sin(t1), sympy.cos(t2), sympy.sin(t2)
    real = [[c1 * c2, -c1 * s2, s1], [s1 * c2, -s1 * s2, -c1], [s2, c2, 0]]
    dual = [[l1 * s1 * s2 - d1 * s1 * c2 - d2 * c1 * s2, l2 * s1 + l1 * s1 * c2 - d2 * c1 * c2 + d1 * s1 * s2,
             c1 * (d1 + l2 * s2)],
            [-l1 * c1 * s2 + d1 * c1 * c2 - d2 * s1 * s2, -l2 * c1 - l1 * c1 * c2 - d1 * c1 * s2 - d2 * s1 * c2,
             s1 * (d1 + l2 * s2)],
            [d2 * c2, -d2 * s2, -l2 * c2 - l1]]  # fmt: skip
    for got, want in ((M.real, real), (M.dual, dual)):
        assert sympy.simplify(sympy.Matrix(got) - sympy.Matrix(want)).is_zero_matrix
    # forces of functions of time: a slider along the vertical
    m, g, t = sympy.symbols("m g t")
    body = dp.mechanisms.body(m, [0, 0, 0], [[0, 0, 0]] * 3)
    lift = dp.mechanisms.DualChain(dp.Dual([0], [0]), [body], gravity=(0, 0, -g))
    z = sympy.Function("z")(t)
    F = lift.forces(dp.Dual([0], [z]), dp.Dual([0], [z.diff(t)]), dp.Dual([0], [z.diff(t, 2)]))
    assert sympy.simplify(F.real[0] - m * (z.diff(t, 2) + g)) == 0
    whole = lift.joint_wrenches(dp.Dual([0], [z]), dp.Dual([0], [z.diff(t)]), dp.Dual([0], [z.diff(t, 2)]))
    assert sympy.simplify(whole.real[0, 2] - F.real[0]) == 0


def test_the_input_output_equation_in_symbols():
    alpha = [dp.Dual(*sympy.symbols(f"alpha{i} a{i}")) for i in range(1, 5)]
    A, B, _ = dp.mechanisms.RCCC(alpha).coefficients(sympy.Symbol("theta1"))
    s = sympy.sin
    assert A.real == s(alpha[0].real) * s(alpha[2].real) * s(sympy.Symbol("theta1"))
    assert {x.name for x in B.dual.free_symbols} == {"alpha1", "alpha3", "alpha4", "a1", "a3", "a4", "theta1"}
    with pytest.raises(dp.ArgumentError, match="symbols"):
        dp.mechanisms.RCCC(alpha).solve(0.3)


@pytest.mark.parametrize(("call", "match"), [
    (lambda x: dp.from_dh([(0, 0, x, "a")]), "rows"),
    (lambda x: dp.from_dh([(0, 0, x, 0)], inertias=[{"mass": x, "inertia": [[1, x, 0], [0, 1, 0], [0, 0, 1]]}]),
     "not symmetric"),
    (lambda x: dp.fk(dp.from_dh([(0, 0, x, 0)]), [0.0]), r"dualpin\.symbolic"),
    (lambda x: dp.mechanisms.body(x, [0, 0], np.eye(3)), r"com of shape \(3,\)"),
    (lambda x: dp.from_dh([(0, 0, 1, 0)], gravity=(0, x)), "gravity"),
    (lambda x: dp.from_dh([(0, 0, x * sympy.oo, sympy.nan)]), "finite real number"),
    (lambda x: dp.from_dh([(0, 0, 1, 0)], inertias=[{"mass": sympy.Integer(-1)}]), "mass is -1"),
    (lambda x: dp.from_dh([(0, 0, x, 0)]).to_urdf(), "to_urdf: .* symbols"),
    (lambda x: dp.to_dh(dp.from_dh([(0, 0, x, 0)])), "symbols"),
    (lambda x: dp.mechanisms.principal_screws(dp.mechanisms.body(x, [0, 0, 0], np.eye(3))), "numbers"),
    (lambda x: dp.mechanisms.TwoC(x, 1.0).inverse_kinematics(np.eye(4)), "symbols"),
])  # fmt: skip
def test_bad_input(call, match):
    with pytest.raises(dp.DualpinError, match=match):
        call(sympy.Symbol("x"))


def test_functions_of_numbers_say_where_symbols_go():
    with pytest.raises(dp.ArgumentError, match=r"dualpin\.symbolic"):
        dp.crba(pendulum(), list(sympy.symbols("x y")))


@pytest.mark.parametrize(("module", "extra", "line"), [
    ("sympy", "exact", "dp.symbolic(robot, 'gravity')"),
    ("scipy", "integrators", "dp.integrators.solve(lambda t, y: y, [1.0], method='DOP853', dt=1.0, t_end=1.0)"),
])  # fmt: skip
def test_what_is_missing_is_named_with_its_extra(module, extra, line):
    code = f"""
import sys
sys.modules[{module!r}] = None
import dualpin as dp
from dualpin.model import Builder, revolute
b = Builder("p"); b.joint("j", revolute()); robot = b.robot()
try:
    {line}
except dp.DualpinError as e:
    print(e)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert f"needs {module}, which is not installed: pip install 'dualpin[{extra}]'" in done.stdout
