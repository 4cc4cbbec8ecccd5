"""Layouts of fewer bytes: single precision, one triangle of M, dual quaternions."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

import dualpin as dp
from dualpin import functions
from dualpin.terms import TERMS

ARRAYS = {"q": 0, "v": 1, "a": 2, "tau": 2, "q0": 0, "q1": 0, "w": 1, "dq": 1, "dv": 1, "da": 1}
EVERY = [f for f in map(functions.__dict__.get, functions.__all__) if "dtype" in getattr(f, "__doc__", "")]


@pytest.fixture(scope="module")
def robot():
    return dp.load("ur5", floating=True)


def test_almost_every_function_takes_a_type():
    without = {f for f in functions.__all__ if getattr(functions, f) not in EVERY}
    assert without <= {"LinkTerm", "LinkTerms", "inertial_parameters"}


@pytest.mark.parametrize("f", EVERY, ids=lambda f: f.__name__)
@pytest.mark.parametrize("batch", [None, 5])
def test_every_function_computes_in_single_precision(robot, f, batch):
    state = robot.sample(batch, seed=3)
    if f is dp.difference:
        state = (state[0], state[1], state[2])
    names = [n for n, p in inspect.signature(f).parameters.items() if p.default is p.empty and n != "robot"]
    arrays = [state[ARRAYS[n]] if n in ARRAYS else "tool0" for n in names]
    wide = f(robot, *arrays)
    for dtype in (np.float32, "float32", np.dtype("f4")):
        for narrow in (f(robot, *arrays, dtype=dtype) for _ in range(2)):
            for a, b in zip(numbers_of(narrow), numbers_of(wide), strict=True):
                assert a.dtype == np.float32 and b.dtype == np.float64 and a.shape == b.shape
                assert np.abs(a - b).max() <= 2e-4 * max(1.0, np.abs(b).max())  # 1e3 roundings of 6e-8, and cond(M)


def numbers_of(found):
    if isinstance(found, np.ndarray):
        return [found]
    return [x for part in found for x in ([part] if isinstance(part, np.ndarray) else [part.M, part.C, part.g])]


@pytest.mark.parametrize("dtype", [None, "int", complex, "float16", ">f4", 3, "no", np.longdouble, object()])
def test_other_types_are_refused(robot, dtype):
    q = robot.neutral
    with pytest.raises(dp.ArgumentError, match="fk: dtype float64 or float32 expected, got "):
        dp.fk(robot, q, dtype=dtype)


def test_out_is_of_the_type(robot):
    q = robot.neutral
    out = np.empty((len(robot), 4, 4), np.float32)
    for _ in range(2):
        assert dp.fk(robot, q, out=out, dtype="float32") is out
        with pytest.raises(dp.ArgumentError, match="out of float64 expected, got float32"):
            dp.fk(robot, q, out=out)


@pytest.mark.parametrize("engine", ["auto", "compiled", "numpy"])
@pytest.mark.parametrize("batch", [None, 1, 7, (2, 3), 500])
def test_a_triangle_has_the_entries_of_the_matrix(robot, engine, batch):
    q = robot.sample(int(np.prod(batch or 1)), seed=0)[0]
    q = q[0] if batch is None else q.reshape(*np.atleast_1d(batch), -1)
    M, rows, columns = dp.crba(robot, q, engine=engine), *np.tril_indices(robot.nv)
    packed = dp.crba(robot, q, triangle=True, engine=engine)
    assert packed.shape == (*q.shape[:-1], robot.nv * (robot.nv + 1) // 2)
    assert np.array_equal(packed, M[..., rows, columns])
    full = np.empty_like(M)
    full[..., rows, columns] = full[..., columns, rows] = packed
    assert np.array_equal(full, M)


def test_a_triangle_is_asked_for_by_a_flag(robot):
    assert dp.crba(robot, robot.neutral, triangle=np.True_).ndim == 1
    with pytest.raises(dp.ArgumentError, match="crba: triangle: True or False expected, got 'lower'"):
        dp.crba(robot, robot.neutral, triangle="lower")


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_dual_quaternions_of_all_joints_are_compiled(robot, dtype):
    q = robot.sample(100, seed=0)[0]
    x = dp.fk(robot, q, as_="dual_quaternion", engine="compiled", dtype=dtype)
    assert x.shape == (100, len(robot), 8) and x.dtype == dtype
    assert np.abs(x - dp.fk(robot, q, as_="dual_quaternion", engine="numpy")).max() < 200 * np.finfo(dtype).eps
    assert TERMS["fk_quaternion"].shape(robot) == (len(robot), 8)
