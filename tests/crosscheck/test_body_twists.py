"""Products of exponentials: a slip predicts what an independent code answers that makes the same mistake."""

from __future__ import annotations

from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import Case
from dualpin.crosscheck.diagnosis.textbook import body_twists, exponentials, spatial
from dualpin.crosscheck.diagnosis.textbook.assembly import Dynamics, by_columns
from dualpin.crosscheck.diagnosis.textbook.body_twists import Frames
from dualpin.crosscheck.diagnosis.textbook.steps import Slip, Steps
from dualpin.crosscheck.subjects import QUESTIONS, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.unseen_codes import rewritten

PROBE = str(Path(__file__).parents[2] / "urdf/probe/probe.urdf")
TERMS = ("fk", "jacobian", "jacobian_dot", "rnea", "rnea_f_ext", "kinetic_energy", "centroidal_momentum_matrix")
OF = partial(body_twists.bodies, frames=Frames.IN_BASE)
FORCES = partial(spatial.forces, of=OF)
RECURSION = Dynamics(FORCES, by_columns(FORCES), fused=True, pushed=partial(spatial.pushed, of=OF))
SPACE = partial(exponentials.run, fused=True)
BODIES = partial(exponentials.run, fused=True, frames=Frames.IN_BASE)
SLIPS = {
    "Ad with R [p]": (
        ("X[3:, :3] = skew(p) @ R", "X[3:, :3] = R @ skew(p)"),
        ("the block [p x] R of Ad", "R [p x], in the other order", "step_other"),
        {"rnea": RECURSION, "jacobian": SPACE, "jacobian_dot": SPACE, "centroidal_momentum_matrix": BODIES},
    ),
    "a factor in exp": (
        ("(th - np.sin(th)) * W @ W\n    return trans(exp3", "(1 - np.sin(th)) * W @ W\n    return trans(exp3"),
        ("the factor of [w]^2 in G of an exponential", "1 - sin q", "step_other"),
        {"fk": SPACE, "rnea": RECURSION, "rnea_f_ext": RECURSION, "centroidal_momentum_matrix": BODIES},
    ),
    "a row of ad": (
        ("X[3:, 3:] = skew(V[:3])", "X[3:, 3:] = -skew(V[:3])"),
        ("the matrix of v x", "that with the other sign of w x in the lower right", "step_other"),
        {"rnea": RECURSION, "jacobian_dot": SPACE},
    ),
    "A by M, not its inverse": (
        ("self.A.append(adjoint(trans_inv(M)) @ S)", "self.A.append(adjoint(M) @ S)"),
        ("the screw of a joint, in the frame of its body", "by Ad(M), with M not inverted", "step_other_turn"),
        {"rnea": RECURSION},
    ),
    "the inverse pose of the parent's frame": (
        ("Mi = trans_inv(self.M[i]) @ Mp", "Mi = trans_inv(Mp) @ self.M[i]"),
        ("the pose of the parent's frame in that of the body, at home,", "the inverse, M_p^-1 M", "step_other"),
        {"rnea": RECURSION},
    ),
    "a screw of the space frame in S qdd": (
        ("A * v[i] + A * a[i]", "A * v[i] + self.S[i] * a[i]"),
        ("the axis of a joint, in S qdd,", "the screw S of the space frame", "step_other"),
        {"rnea": RECURSION},
    ),
    "a wrench on a body that stands at home": (
        ("T = self.exponentials(q)[body] @ self.M[body]", "T = self.M[body]"),
        ("the pose, the product of exponentials times the pose at home: of bodies", "the pose at home alone",
         "step_other"),
        {"rnea_f_ext": RECURSION},
    ),
    "a twist by the inverse": (
        ("Vb = adjoint(trans_inv(T[i])) @ self.space_jacobian(q, i) @ v",
         "Vb = adjoint(T[i]) @ self.space_jacobian(q, i) @ v"),
        ("the space Jacobian, brought to a body,", "by Ad(T), not of the inverse", "step_other_turn"),
        {"kinetic_energy": BODIES},
    ),
}  # fmt: skip


@cache
def ask():
    return asking(PROBE, 2, 0, TERMS)


def answered(*changes: tuple[str, str]) -> Case:
    return Case(ask_here(rewritten("exponentials", *changes)(ask().text), ask(), lambda what: None))


def predicted(case: Case, term: str, run, steps: Steps) -> np.ndarray:
    view = case.view(())
    return view.layout.answer(QUESTIONS[term].form, run(view, term, steps)[0], view.states, None)


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_predicts_the_answers_of_a_code_that_makes_it(name):
    change, slip, runs = SLIPS[name]
    case, right = answered(change), answered()
    for term, run in runs.items():
        x = case.observed[term]
        assert np.abs(x - right.observed[term]).max() > 1e-3, "it shows"
        assert np.abs(predicted(case, term, run, Steps(Slip(*slip))) - x).max() < 1e-10 * max(1, np.abs(x).max()), term


@pytest.mark.parametrize(("run", "term"), [(RECURSION, "rnea"), (SPACE, "jacobian_dot"), (BODIES, "kinetic_energy")])
def test_slips_in_one_run_are_those_of_each_alone(run, term):
    view, steps = answered().view(()), Steps()
    run(view, term, steps)
    slips = list(steps.found)[::7]
    for slip, x in zip(slips, run(view, term, Steps.together([(s,) for s in slips])), strict=True):
        alone = run(view, term, Steps(slip))[0]
        assert np.allclose(x, alone, rtol=1e-10, atol=1e-10 * max(1, np.abs(alone).max())), slip
