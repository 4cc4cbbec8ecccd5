"""Kernels in single precision, of every kind of joint: as near to double precision as 24 bits allow."""

from __future__ import annotations

import numpy as np
import pytest
from random_robots import tree

from dualpin.call import evaluate
from dualpin.terms import TERMS
from tests.odd_robots import every_joint

KINDS = ["revolute", "prismatic", "cylindrical", "helical", "planar", "floating", "spherical"]
SOME = ("fk", "rnea", "aba", "crba", "coriolis", "integrate")
SOLVED = ("aba", "minv")  # with the inertia matrix: its condition is a factor
EPS = 2.0**-24
ROUNDINGS = 200
"""Roundings of a value, one after another: some 20 for each of up to five joints outwards, and as many inwards; the
sum of their errors, without cancellation, which the size of the result allows for.  Measured: at most 21 below, 68 of
all terms (potential energy)."""


def given(robot, term, n):
    """Inputs of single precision that both compute from, so that only the arithmetic differs."""
    q, v, a = robot.sample(n, seed=4)
    rng = np.random.default_rng(4)
    found = {"q": q, "q0": q, "q1": q[::-1], "v": v, "a": a, "tau": a}
    for x in term.arguments:
        found.setdefault(x.name, rng.normal(size=(n, *x.shape(robot))))
    return {x.name: found[x.name].astype(np.float32) for x in term.arguments}


def roundings(robot, name, n=64):
    """The error in units of rounding, of the largest entry of all samples."""
    term = TERMS[name]
    frame = {"frame": robot.frames[-1]} if any(x.name == "frame" for x in term.options) else {}
    inputs = given(robot, term, n)
    single = evaluate(robot, name, inputs, dtype=np.float32, engine="compiled", **frame)
    double = evaluate(robot, name, inputs, **frame)
    assert single.dtype == np.float32 and single.shape == double.shape
    size = np.abs(double).reshape(n, -1).max(1)
    error = np.abs(single - double).reshape(n, -1).max(1) / np.maximum(1.0, size)
    if name.startswith(SOLVED):
        error = error / np.linalg.cond(evaluate(robot, "crba", {"q": inputs["q"]}))
    return float(error.max()) / EPS


@pytest.mark.parametrize("name", SOME)
def test_all_joints_in_one_robot(name):
    assert roundings(every_joint(), name) < ROUNDINGS


@pytest.mark.campaign
@pytest.mark.parametrize("name", TERMS)
@pytest.mark.parametrize("kind", KINDS)
def test_each_joint_and_term(kind, name):
    found = roundings(tree(["revolute", kind, "prismatic"] if kind != "floating" else [kind, "revolute"], seed=3), name)
    print(f"{kind} {name}: {found:.1f} roundings")
    assert found < ROUNDINGS


def test_a_robot_alone_has_the_bits_of_a_batch_in_single_precision():
    robot = every_joint()
    inputs = given(robot, TERMS["rnea"], 9)
    many = evaluate(robot, "rnea", inputs, dtype=np.float32)
    one = evaluate(robot, "rnea", {k: x[3] for k, x in inputs.items()}, dtype=np.float32)
    assert np.array_equal(one, many[3])
