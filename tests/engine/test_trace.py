"""Graphs mean what the source computes, and are no longer than they must be."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dualpin as dp
from dualpin.call import evaluate as call
from dualpin.engine.graph.schedule import schedule
from dualpin.engine.graph.trace import Graph, Sym, Trace, UntraceableError, evaluate, select, trace
from dualpin.terms import TERMS


@pytest.fixture
def xy():
    return Graph().inputs(0, 2)


def test_equal_operations_are_one_node(xy):
    x, y = xy
    assert (x * y).i == (y * x).i
    assert (x + y).i == (y + x).i
    assert ((x - y) + (y - x)) == 0.0  # the second is the first's negative


def test_known_numbers_fold(xy):
    x, _ = xy
    assert x * 0 == 0.0
    assert (x * 1).i == x.i
    assert (x + 0).i == x.i
    assert (2 * (3 * x)).i == (6 * x).i
    assert (x - x) == 0.0
    minus = -x
    assert (-minus).i == x.i


def test_signs_move_outwards(xy):
    x, y = xy
    assert ((-x) * (-y)).i == (x * y).i
    assert ((-x) - y).i == (-(x + y)).i
    assert (x + (-y)).i == (x - y).i
    assert (-(x - y)).i == (y - x).i


def test_one_reciprocal_serves_all_divisions(xy):
    x, y = xy
    program = Trace(x.graph, [2], [x / y, (x + 1.0) / y, 2.0 / y])
    assert program.graph.count(program.outputs)["inv"] == 1


def test_comparing_symbols_for_a_decision_is_refused(xy):
    x, y = xy
    with pytest.raises(UntraceableError, match="comparison"):
        bool(x < y)
    with pytest.raises(UntraceableError):
        x <= y  # noqa: B015


def test_foreign_operands_are_left_to_themselves(xy):
    x, _ = xy
    with pytest.raises(TypeError):
        x + "one"
    with pytest.raises(TypeError):
        x * np.ones(2)


@pytest.mark.parametrize(("name", "floating"), [("panda", False), ("ur5", True), ("talos", False)])
@pytest.mark.parametrize("term", ["rnea", "aba", "crba", "coriolis", "integrate", "rnea_derivatives"])
def test_a_graph_evaluates_to_what_the_source_computes(name, floating, term):
    robot = dp.load(name, floating=floating)
    q, v, a = robot.sample(seed=1)
    given = {"q": q, "v": v, "a": a, "tau": a}
    inputs = {key: given[key] for key in TERMS[term].inputs}
    program = trace(robot, TERMS[term], {})
    got = np.array(evaluate(program, [x.tolist() for x in inputs.values()]), dtype=float)
    expected = call(robot, term, inputs, engine="numpy").ravel()
    # both round each operation once; folding regroups a few: some hundred eps at most
    assert np.abs(got - expected).max() <= 1e-13 * max(1.0, np.abs(expected).max())


def test_transference_costs_nothing():
    # the classical recursion of Newton and Euler, written by hand, takes 443, 925 and 3825 operations
    for name, by_hand in (("ur5", 443), ("panda", 925), ("talos", 3825)):
        flops = trace(dp.load(name), TERMS["rnea"], {}).flops
        assert flops < 1.07 * by_hand, f"{name}: {flops}"


@pytest.mark.parametrize("chunk", [1, 7, 250, 10**6])
def test_no_chunk_reads_and_writes_the_same_slot(chunk):
    program = trace(dp.load("ur5", floating=True), TERMS["aba"], {})
    plan = schedule(program, chunk)
    for stage in plan.stages:
        for steps in stage.chunks:
            inside = {s.i for s in steps}
            written = {plan.slot[i] for i in inside if i in plan.slot}
            read = {plan.slot[a] for s in steps for a in s.args if a not in inside and a in plan.slot}
            assert not written & read
            assert len(steps) <= chunk


def test_every_value_is_computed_before_it_is_used():
    program = trace(dp.load("panda"), TERMS["integrate"], {})
    floating = trace(dp.load("ur5", floating=True), TERMS["integrate"], {})
    for plan in (schedule(program), schedule(floating)):
        known = {i for i, node in enumerate(plan.nodes) if node[0] in ("in", "const")}
        for stage in plan.stages:
            for step in (s for chunk in stage.chunks for s in chunk):
                assert set(step.args) <= known
                known.add(step.i)
            assert set(stage.angles) <= known
            known |= {i for i, node in enumerate(plan.nodes) if node[0] in ("sin", "cos") and node[1] in stage.angles}


def test_select_takes_the_branch_of_the_numbers(xy):
    x, y = xy
    chosen = select(x, y, x * 2.0, y * 3.0)
    program = Trace(x.graph, [2], [chosen])
    assert evaluate(program, [(1.0, 2.0)]) == [2.0]
    assert evaluate(program, [(2.0, 1.0)]) == [3.0]
    assert math.isnan(evaluate(program, [(math.nan, math.nan)])[0])
    assert isinstance(chosen, Sym)
