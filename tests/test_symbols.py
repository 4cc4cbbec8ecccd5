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


def test_decimals_are_decimals_when_asked_for():
    g = dp.symbolic(pendulum(), "gravity", decimals=True)
    assert "26.487" in str(g) and "/" not in str(g)
    assert "26487" in str(dp.symbolic(pendulum(), "gravity"))


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
