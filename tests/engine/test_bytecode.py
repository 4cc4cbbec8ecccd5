"""A program run as bytecode and the same one compiled give the same bits."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.engine import tuning
from dualpin.engine.graph.trace import LIBRARY, Graph, Trace, select
from dualpin.engine.jit import kernel as kernels
from dualpin.engine.jit.host import this_host
from dualpin.terms import TERMS

from .test_kernels import EVERY_TERM, narrower, options, states


def built(monkeypatch, robot, term, dtype, host, lanes, bytecode):
    """A kernel made now, as bytecode or as code."""
    monkeypatch.setattr(tuning, "BYTECODE_FROM", 0 if bytecode else 10**9)
    chosen, kind = options(robot, term), np.dtype(dtype)
    about, code = kernels.compiled(robot, TERMS[term], chosen, kind, host, lanes)
    return kernels.Kernel(about, code, TERMS[term].shape(robot, **chosen), kind)


def bits(x):
    return x.view(f"u{x.itemsize}")


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("term", EVERY_TERM)
@pytest.mark.parametrize(("name", "floating"), [("ur5", False), ("solo8", True)])
def test_bytecode_has_the_bits_of_code(monkeypatch, name, floating, term, dtype):
    robot, host = dp.load(name, floating=floating), this_host()
    given = states(robot, 13, seed=4)
    inputs = [given[key].reshape(13, -1).astype(dtype) for key in TERMS[term].inputs]
    for lanes in {1, host.lanes(np.dtype(dtype).itemsize)}:
        bytecode, code = (built(monkeypatch, robot, term, dtype, host, lanes, bytecode) for bytecode in (True, False))
        assert np.array_equal(bits(bytecode.rows(inputs)), bits(code.rows(inputs)))


@pytest.mark.parametrize(("width", "fma"), [(32, True), (32, False), (16, False), (8, False)])
def test_bytecode_has_the_bits_of_code_on_smaller_machines(monkeypatch, width, fma):
    robot, host = dp.load("panda"), narrower(width, fma)
    given = states(robot, 9, seed=5)
    for term in ("aba", "difference"):
        inputs = [given[key] for key in TERMS[term].inputs]
        bytecode, code = (
            built(monkeypatch, robot, term, float, host, host.lanes(8), bytecode) for bytecode in (True, False)
        )
        assert np.array_equal(bits(bytecode.rows(inputs)), bits(code.rows(inputs)))


def test_what_bytecode_can_say(monkeypatch):
    """Each operation, also as a result, on numbers that show the signs of zeros, infinities and what is no number."""
    monkeypatch.setattr(tuning, "BYTECODE_FROM", 0)
    graph = Graph()
    x, y, z = graph.inputs(0, 3)
    outputs = [
        x + y, x - y, x * y, 1.0 / y, -x, -(x * y), x * y + z, x * y - z, z - x * y, LIBRARY.sqrt(x),
        select(x, y, z, x), select(x, 0.0, -x, 0.0), x, 2.0, LIBRARY.sin(x * y),
        x * y + z * x, -(x + y) * z, 3.0 * x + 0.5,
    ]  # fmt: skip
    values = [0.0, -0.0, 1.5, -2.25, np.inf, np.nan, 1e-310]
    rows = np.array(np.meshgrid(values, values, values)).reshape(3, -1).T
    with np.errstate(all="ignore"):
        x, y, z = rows.T
        expected = np.stack([
            x + y, x - y, x * y, 1.0 / y, 0 - x, 0 - x * y, x * y + z, x * y - z, z - x * y, np.sqrt(x),
            np.where(x < y, z, x), np.where(x < 0, -x, 0.0), x, np.full_like(x, 2.0), np.sin(x * y), x * y + z * x,
            -(x + y) * z, 3.0 * x + 0.5,
        ], axis=1)  # fmt: skip
    host = this_host()
    monkeypatch.setattr(kernels, "trace", lambda *_: Trace(graph, [3], outputs))
    for lanes in (1, host.lanes(8)):
        about, code = kernels.compiled(dp.load("ur5"), TERMS["gravity"], {}, np.dtype(float), host, lanes)
        got = kernels.Kernel(about, code, (len(outputs),), np.dtype(float)).rows([rows])
        assert np.allclose(got, expected, rtol=1e-15, atol=1e-320, equal_nan=True)
        exact = [k for k in range(len(outputs)) if k not in (2, 6, 7, 8, 10, 12, 14, 15, 16)]
        assert np.array_equal(np.signbit(got[:, exact]) & ~np.isnan(got[:, exact]),
                              np.signbit(expected[:, exact]) & ~np.isnan(expected[:, exact]))  # fmt: skip


def test_constant_results_are_not_overwritten_by_long_rows(monkeypatch):
    """Rows are loaded by whole vectors, also beyond the slots of the inputs."""
    monkeypatch.setattr(tuning, "BYTECODE_FROM", 0)
    graph = Graph()
    (x,) = graph.inputs(0, 1)
    monkeypatch.setattr(kernels, "trace", lambda *_: Trace(graph, [1], [LIBRARY.sqrt(x), 2.5]))
    for lanes in (1, this_host().lanes(8)):
        about, code = kernels.compiled(dp.load("ur5"), TERMS["gravity"], {}, np.dtype(float), this_host(), lanes)
        got = kernels.Kernel(about, code, (2,), np.dtype(float)).rows([np.full((3, 1), 4.0)])
        assert got.tolist() == [[2.0, 2.5]] * 3


@pytest.mark.campaign
def test_the_longest_terms_need_no_numpy():
    robot = dp.load("tiago", floating=True)
    q, v, a = robot.sample(9, seed=6)
    tau = dp.rnea(robot, q, v, a)
    got = dp.aba_derivatives(robot, q, v, tau, engine="compiled")
    expected = dp.aba_derivatives(robot, q, v, tau, engine="numpy")
    for ours, reference in zip(got, expected, strict=True):
        assert np.abs(ours - reference).max() <= 1e-9 * np.abs(reference).max()  # two solutions with M: cond(M)^2 eps
