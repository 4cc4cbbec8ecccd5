"""Random trees built in code, with armature and without, every term against Pinocchio's own model of them.

TIGHT: rounding of a few thousand operations on numbers near 1; solves are allowed cond(M) times that.
"""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.checks import CHECKS
from dualpin.crosscheck.oracles.pinocchio import QUESTIONS, Pinocchio
from dualpin.model import Robot
from tests.random_robots import tree

pin = pytest.importorskip("pinocchio")

TIGHT = 1e-12
KINDS = (
    "revolute", "prismatic", "continuous", "helical", "planar", "revolute", "floating", "prismatic", "spherical",
    "revolute", "spherical",
)  # fmt: skip
STATES = {
    "rnea": "qva", "bias": "qv", "gravity": "q", "crba": "q", "coriolis": "qv", "aba": "qvt", "minv": "q",
    "kinetic_energy": "qv", "potential_energy": "q", "com": "q", "com_jacobian": "q",
    "centroidal_momentum_matrix": "q", "rnea_derivatives": "qva", "aba_derivatives": "qvt",
    "joint_torque_regressor": "qva", "joint_wrenches": "qva",
}  # fmt: skip


def scaled(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.abs(x - y).max(initial=0.0) / max(1.0, np.abs(y).max(initial=0.0)))


def theirs(robot: Robot, term: str, state: dict[str, np.ndarray]) -> np.ndarray:
    if term == "kinetic_energy":  # Pinocchio 4.1 leaves the rotors of joints about oblique axes out of its own
        v = state["v"]
        return np.asarray(v @ theirs(robot, "crba", {"q": state["q"]}) @ v / 2)
    layout, question = Pinocchio.of_robot(robot).free, QUESTIONS[term]
    rows = layout.of({k: x[None] for k, x in state.items()}, coupled=robot.coupled)
    d = question.data(pin, layout.model)
    found = question.run(pin, layout.model, d, {k: x[0] for k, x in rows.items()})
    value = found if question.read is None else question.read(pin, layout.model, d)
    return layout.read(CHECKS[term].form, question.whole(np.asarray(value)[None], layout), {})[0]


@pytest.mark.parametrize("armature", [False, True], ids=["plain", "armature"])
@pytest.mark.parametrize("base", ["fixed", "floating", "spherical"])
@pytest.mark.parametrize("seed", [1, 2])
def test_every_term_of_a_random_tree(base, armature, seed):
    kinds = KINDS if base == "fixed" else (base, *KINDS)
    robot = tree(kinds, seed, armature=armature, depth_first=True)
    q, v, a = robot.sample(seed=seed)
    state = {"q": q, "v": v, "a": a, "t": dp.rnea(robot, q, v, a, engine="numpy")}
    solves = 1e-14 * max(100.0, float(np.linalg.cond(dp.crba(robot, q, engine="numpy"))))
    for term, inputs in STATES.items():
        ours = np.array(getattr(dp, term)(robot, *(state[k] for k in inputs), engine="numpy"))
        names = {"q": "q", "v": "v", "a": "a", "t": "tau"}
        expected = theirs(robot, term, {names[k]: state[k] for k in inputs})
        assert ours.shape == expected.shape, term
        assert scaled(ours, expected) < (solves if term.startswith(("aba", "minv")) else TIGHT), term


def test_rotors_of_followers_weigh_by_the_square_of_the_multiplier():
    """The coupled robot's terms are those of Pinocchio's free one, projected: tau = G^T tau_free."""
    robot = tree(("revolute", "prismatic", "revolute", "revolute", "revolute"), 3, mimics=2, armature=True)
    q, v, a = robot.sample(seed=3)
    assert max(abs(float(j.coupling[0])) for j in robot) > 1 and robot.nv < len(robot)
    for term, inputs in (("rnea", (q, v, a)), ("crba", (q,)), ("bias", (q, v)), ("kinetic_energy", (q, v))):
        expected = theirs(robot, term, dict(zip("qva", inputs, strict=False)))
        assert scaled(getattr(dp, term)(robot, *inputs, engine="numpy"), expected) < TIGHT, term
    M, tau = dp.crba(robot, q), dp.rnea(robot, q, v, a)
    assert scaled(dp.aba(robot, q, v, tau), a) < 1e-14 * np.linalg.cond(M)
    assert scaled(dp.minv(robot, q) @ M, np.eye(robot.nv)) < 1e-14 * np.linalg.cond(M)
    assert scaled(dp.rnea_derivatives(robot, q, v, a)[2], M) < TIGHT
    Y = dp.joint_torque_regressor(robot, q, v, a)
    assert Y.shape == (robot.nv, 10 * len(robot) + len(robot))
    assert scaled(Y @ dp.inertial_parameters(robot), tau) < TIGHT
    assert scaled(sum(t.M for t in dp.link_terms(robot, q, v)), M) < TIGHT
