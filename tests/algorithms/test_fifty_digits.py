"""The same sources over mpmath: identities to 45 digits, and what double precision loses.

The model is lifted (`Robot.lift`): rotations orthonormal and axes unit to 60 digits.  1e-45 leaves
fifteen digits of 60 for conditioning and for sums of some thousand terms.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

import dualpin as dp
from dualpin.model import Robot
from dualpin.scalars import Exact
from dualpin.terms import TERMS, flat
from tests.random_robots import robot

DIGITS, CLOSE = 60, 1e-45
NAMES = ("massless", "screws", "mixed", "floating_mimic")


@pytest.fixture(autouse=True)
def digits():
    with mpmath.workdps(DIGITS):
        yield


def exactly(x: Any) -> Any:
    """Any scalar as an mpmath number."""
    return mpmath.mpf(x.n if type(x) is Exact else x)


def evaluate(r: Robot, name: str, *inputs: Any, **options: Any) -> np.ndarray:
    """One term over mpmath, an array of objects."""
    values = [exactly(x) for x in flat(TERMS[name].compute(r, *(list(x) for x in inputs), **options))]
    return np.array(values, dtype=object).reshape(TERMS[name].shape(r, **options))


def lifted_state(r: Robot, seed: int) -> tuple[Robot, list[np.ndarray]]:
    """The robot and a state in 60 digits, quaternions of unit norm in all of them."""
    q, v, a = (np.array([mpmath.mpf(x) for x in y], dtype=object) for y in r.sample(seed=seed))
    for j in r:
        if j.kind == "floating":
            part = slice(j.q.start + 3, j.q.stop)
            q[part] = q[part] / mpmath.sqrt(sum(x * x for x in q[part]))
    return r.lift(mpmath.mpf), [q, v, a]


def worst(x: np.ndarray) -> float:
    return float(max(map(abs, np.ravel(x)), default=0))


@pytest.fixture(params=NAMES)
def case(request: pytest.FixtureRequest, seed: int) -> tuple:
    r, (q, v, a) = lifted_state(robot(request.param), seed)
    return r, q, v, a


def test_forward_dynamics_undoes_inverse_dynamics(case):
    r, q, v, a = case
    assert worst(evaluate(r, "aba", q, v, evaluate(r, "rnea", q, v, a)) - a) < CLOSE


def test_minv_is_the_inverse_of_the_mass_matrix(case):
    r, q, _, _ = case
    M = evaluate(r, "crba", q)
    assert worst(evaluate(r, "minv", q) @ M - np.eye(r.nv, dtype=int)) < CLOSE


def test_inverse_dynamics_is_its_terms(case):
    r, q, v, a = case
    tau = evaluate(r, "rnea", q, v, a)
    C, g = evaluate(r, "coriolis", q, v), evaluate(r, "gravity", q)
    assert worst(evaluate(r, "crba", q) @ a + C @ v + g - tau) < CLOSE
    Y = evaluate(r, "joint_torque_regressor", q, v, a)
    parameters = np.array([exactly(x) for b in r for x in b.inertia.parameters], dtype=object)
    assert worst(Y @ parameters - tau) < CLOSE


def test_kinetic_energy_is_that_of_the_mass_matrix(case):
    r, q, v, _ = case
    assert abs(evaluate(r, "kinetic_energy", q, v)[()] - v @ evaluate(r, "crba", q) @ v / 2) < CLOSE


@pytest.mark.parametrize("term", ["crba", "potential_energy", "com", "frame_pose"])
def test_rates_of_change_by_central_differences(case, term):
    r, q, v, _ = case
    options = {"frame": r.frame("tool")} if term == "frame_pose" else {}
    h = mpmath.mpf(10) ** -20
    with mpmath.workdps(90):  # rounding 1e-90 / h, the formula's own error h^2 f''' / 6 ~ 1e-38
        ahead, behind = (evaluate(r, "integrate", q, s * h * v) for s in (1, -1))
        rate = (evaluate(r, term, ahead, **options) - evaluate(r, term, behind, **options)) / (2 * h)
    expected = {
        "crba": lambda: (lambda C: C + C.T)(evaluate(r, "coriolis", q, v)),
        "potential_energy": lambda: evaluate(r, "gravity", q) @ v,
        "com": lambda: evaluate(r, "com_jacobian", q) @ v,
        "frame_pose": lambda: _rate_of_pose(r, q, v, options["frame"]),
    }[term]()
    assert worst(rate - expected) < 1e-34  # four digits for the size of the third derivative


def _rate_of_pose(r: Robot, q: np.ndarray, v: np.ndarray, frame: Any) -> np.ndarray:
    """dT/dt = T [V_local]"""
    x, y, z, *u = evaluate(r, "frame_velocity", q, v, frame=frame, reference="local")
    hat = np.array([[0, -z, y, u[0]], [z, 0, -x, u[1]], [-y, x, 0, u[2]], [0, 0, 0, 0]], dtype=object)
    return evaluate(r, "frame_pose", q, frame=frame) @ hat


def test_integrate_and_difference_undo_each_other(case):
    r, q, v, _ = case
    step = v / 4  # turns by less than pi
    assert worst(evaluate(r, "difference", q, evaluate(r, "integrate", q, step)) - step) < CLOSE


@pytest.mark.parametrize("name", ["panda", "talos"])
def test_double_precision_is_near_the_truth(name, seed):
    """What one evaluation in double precision loses against 60 digits of the same source.

    A torque is a sum of some hundred products; each loses 1e-16 of the largest intermediate force,
    so 1e-13 relative is the bound; aba loses cond(M) times as much.
    """
    if not dp.io.catalogue():
        pytest.skip("example-robot-data is not installed")
    r = dp.load(name)
    q, v, a = r.sample(seed=seed)
    exact = r.lift(mpmath.mpf)
    Q, V, A = (np.array([mpmath.mpf(x) for x in y], dtype=object) for y in (q, v, a))
    errors = {}
    for term, inputs, lifted in (
        ("rnea", (q, v, a), (Q, V, A)),
        ("crba", (q,), (Q,)),
        ("coriolis", (q, v), (Q, V)),
        ("aba", (q, v, a), (Q, V, A)),
    ):
        truth = evaluate(exact, term, *lifted)
        found = getattr(dp, term)(r, *inputs, engine="numpy")
        errors[term] = worst(found - truth) / max(1.0, worst(truth))
    condition = float(np.linalg.cond(dp.crba(r, q, engine="numpy")))
    assert max(errors[t] for t in ("rnea", "crba", "coriolis")) < 1e-13, errors
    assert errors["aba"] < 1e-15 * max(100.0, condition), (errors, condition)
