"""C code that compiles and computes the same; formulas that are the textbook's."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

import dualpin as dp
from dualpin.call import evaluate as call
from dualpin.model import Builder, revolute
from dualpin.spatial import UX, UY, UZ, ZERO_VECTOR, Inertia, Matrix3, Pose, Vector3
from dualpin.terms import TERMS

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


def built(code, folder, kind=ctypes.c_double):
    path = code.write(folder)
    library = folder / f"{code.name}.so"
    flags = ["-std=c99", "-O1", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    subprocess.run([COMPILER, *flags, str(path), "-o", str(library), "-lm"], check=True)
    function = getattr(ctypes.CDLL(str(library)), code.name)
    function.restype = None

    def run(*arrays, shape):
        result = np.empty(shape, kind)
        function(*(x.ctypes.data_as(ctypes.c_void_p) for x in (*arrays, result)))
        return result

    return run


@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
@pytest.mark.parametrize(
    ("name", "term", "options"),
    [
        ("ur5", "rnea", {}), ("panda", "crba", {}), ("ur5", "fk", {}), ("panda", "aba", {}), ("ur5", "integrate", {}),
        ("ur5", "jacobian", {"frame": "tool0", "reference": "local"}), ("ur5+floating", "integrate", {}),
        ("ur5+floating", "rnea", {}), ("ur5", "kinetic_energy", {}),
    ],
)  # fmt: skip
def test_the_c_code_compiles_without_warnings_and_computes_the_same(name, term, options, tmp_path):
    robot = dp.load(name.removesuffix("+floating"), floating=name.endswith("+floating"))
    q, v, a = robot.sample(seed=0)
    given = {"q": q, "v": v, "a": a, "tau": a}
    inputs = {key: given[key] for key in TERMS[term].inputs}
    run = built(dp.export_c(robot, term, **options), tmp_path)
    expected = robot.kernel(term, **options)(*inputs.values())
    got = run(*inputs.values(), shape=expected.shape)
    assert np.abs(got - expected).max() <= 1e-12 * max(1.0, np.abs(expected).max())


@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
def test_single_precision(tmp_path):
    robot = dp.load("ur5")
    q, v, a = (x.astype(np.float32) for x in robot.sample(seed=0))
    code = dp.export_c(robot, "rnea", dtype=np.float32, name="tau")
    assert "double" not in code.source
    got = built(code, tmp_path, np.float32)(q, v, a, shape=(6,))
    expected = dp.rnea(robot, q, v, a)
    assert np.abs(got - expected).max() < 2e-6 * np.abs(expected).max()


def test_inputs_and_results_may_share_memory():
    # all results are written after all inputs are read
    lines = dp.export_c(dp.load("ur5"), "integrate").source.splitlines()
    writes = [i for i, line in enumerate(lines) if line.strip().startswith("result[")]
    reads = [i for i, line in enumerate(lines) if "q[" in line and not line.strip().startswith(("void", "result"))]
    assert max(reads) < min(writes)


def test_names_that_are_none_are_refused():
    robot = dp.load("ur5")
    with pytest.raises(dp.ArgumentError, match="C identifier"):
        dp.export_c(robot, "rnea", name="2 fast")
    with pytest.raises(dp.ArgumentError, match="did you mean 'rnea'"):
        dp.export_c(robot, "rneaa")
    with pytest.raises(dp.ArgumentError, match="Robot"):
        dp.export_c("ur5", "rnea")


def double_pendulum():
    """Two point masses m on massless rods of length l, swinging about y; at q = 0 they lie along x."""
    b = Builder("double")
    for i, parent in enumerate((None, "link0")):
        m, length = (2.0, 1.5) if i == 0 else (3.0, 0.5)
        at = Vector3(length, 0.0, 0.0)
        J = Matrix3(ZERO_VECTOR, UY * (m * length**2), UZ * (m * length**2))
        place = Pose() if parent is None else Pose(position=Vector3(1.5, 0.0, 0.0))
        b.joint(f"joint{i}", revolute(-UY), parent, place, Inertia(m, at * m, J), link=f"link{i}")
    return b.robot()


def test_a_double_pendulum_is_the_textbooks():
    sympy = pytest.importorskip("sympy")
    robot = double_pendulum()
    q0, q1, v0, v1 = sympy.symbols("q0 q1 v0 v1", real=True)
    m1, l1, m2, l2 = sympy.Integer(2), sympy.Rational(3, 2), sympy.Integer(3), sympy.Rational(1, 2)
    g = sympy.Rational("9.81")
    cross = m2 * l2**2 + m2 * l1 * l2 * sympy.cos(q1)
    M = sympy.Matrix([[(m1 + m2) * l1**2 + 2 * cross - m2 * l2**2, cross], [cross, m2 * l2**2]])
    h = m2 * l1 * l2 * sympy.sin(q1)
    C = sympy.Matrix([[-h * v1, -h * (v0 + v1)], [h * v0, 0]])
    second = m2 * g * l2 * sympy.cos(q0 + q1)
    gravity = sympy.Matrix([(m1 + m2) * g * l1 * sympy.cos(q0) + second, second])
    for term, expected in (("crba", M), ("coriolis", C), ("gravity", gravity)):
        assert sympy.simplify(dp.symbolic(robot, term) - expected) == sympy.zeros(*expected.shape)


def test_formulas_take_the_symbols_they_are_given():
    sympy = pytest.importorskip("sympy")
    alpha, beta = sympy.symbols("alpha beta")
    robot = double_pendulum()
    M = dp.symbolic(robot, "crba", q=(alpha, beta))
    assert M.free_symbols == {beta}
    assert dp.symbolic(robot, "potential_energy").free_symbols
    assert dp.symbolic(robot, "fk", simplify=False).shape == (2, 4, 4)
    with pytest.raises(dp.ArgumentError, match="2 symbols for q"):
        dp.symbolic(robot, "crba", q=(alpha,))


def test_formulas_evaluate_to_the_compiled_numbers():
    sympy = pytest.importorskip("sympy")
    robot = double_pendulum()
    q, v, a = robot.sample(seed=0)
    tau = dp.symbolic(robot, "rnea", simplify=False)
    values = {
        sympy.Symbol(f"{key}{i}", real=True): float(x)
        for key, xs in zip("qva", (q, v, a), strict=True)
        for i, x in enumerate(xs)
    }
    got = np.array(tau.subs(values).evalf(20).tolist(), dtype=float).ravel()
    assert np.abs(got - dp.rnea(robot, q, v, a)).max() < 1e-12
    assert np.abs(got - call(robot, "rnea", {"q": q, "v": v, "a": a}, engine="numpy")).max() < 1e-12


def test_motion_of_one_axis():
    pytest.importorskip("sympy")
    b = Builder("one")
    b.joint("hinge", revolute(UX))
    b.frame("tip", "hinge", Pose(position=Vector3(0.0, 1.0, 0.0)))
    T = dp.symbolic(b.robot(), "frame_pose", frame="tip")
    assert [str(x) for x in T[:3, 3]] == ["0", "cos(q0)", "sin(q0)"]
