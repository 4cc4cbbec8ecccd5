"""C by derivatives of columns, body Jacobians, and bases in world axes: right without a slip, and slips in one run."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import Case
from dualpin.crosscheck.diagnosis.rules import kinematics
from dualpin.crosscheck.diagnosis.textbook import answers, body_jacobians
from dualpin.crosscheck.diagnosis.textbook.assembly import of_symbols
from dualpin.crosscheck.diagnosis.textbook.slipped import View
from dualpin.crosscheck.diagnosis.textbook.steps import Slip, Steps
from dualpin.crosscheck.subjects import QUESTIONS, asking
from tests.crosscheck.test_blind import PROBE
from tests.crosscheck.test_kinematic_slips import apart, silent
from tests.random_robots import random_urdf

SYMBOLS = tuple(answers.OF_SYMBOLS)
MADE = {
    **{how: (partial(kinematics.jacobians, how=how), ("coriolis",)) for how in SYMBOLS},
    answers.GRADIENTS: (partial(kinematics.jacobians, how=answers.GRADIENTS), ("jacobian_dot", "coriolis")),
    answers.BY_PARENTS: (partial(kinematics.jacobians, how=answers.BY_PARENTS), ("jacobian_dot",)),
    answers.SPUN: (partial(kinematics.jacobians, how=answers.SPUN_BY_PARENTS), ("bias",)),
    answers.ABOUT: (partial(kinematics.jacobians, how=answers.ABOUT), ("centroidal_momentum_matrix",)),
    answers.DIFFERENTIATED: (partial(kinematics.jacobians, how=answers.DIFFERENTIATED), ("gravity",)),
    "body": (body_jacobians.run, body_jacobians.TERMS),
    "body, by the world's": (partial(body_jacobians.run, by_world=True), body_jacobians.TERMS),
}


@pytest.fixture(scope="module")
def probe() -> View:
    return Case(silent(asking(PROBE, 2, 0, tuple(QUESTIONS)))).view(())


@pytest.mark.parametrize("how", MADE)
def test_right_without_a_slip_and_many_slips_in_one_run_are_each_as_alone(probe, how):
    run, terms = MADE[how]
    for term in terms:
        steps = Steps()
        right = run(probe, term, steps)[0]
        assert apart(right, probe.compute(term, "local_world_aligned")) < 1e-12, term
        slips = list(steps.found)
        together = run(probe, term, Steps.together([(s,) for s in slips]))
        assert len(together) == len(slips)
        wrong = [apart(x, right) > 1e-9 for x in together]
        assert sum(wrong) > len(slips) / 3  # not every slip shows in every term
        for slip, x in list(zip(slips, together, strict=True))[::41]:
            assert apart(x, run(probe, term, Steps(slip))[0]) < 1e-12, slip.says


@pytest.mark.parametrize("fused", [False, True])
def test_of_a_base_whose_velocity_is_in_world_axes(tmp_path, fused):
    """What the subject makes in its own columns comes back in dualpin's."""
    path = tmp_path / "tree.urdf"
    path.write_text(random_urdf(4, 8, mimic=True))
    ask = asking(str(path), 2, 4, tuple(QUESTIONS), floating=True)
    view = Case(silent(ask, angular="world", linear="world")).view(())
    for term in ("jacobian_dot", "coriolis", "bias"):
        for how in (answers.LINKS, answers.JACOBIANS):
            x = kinematics.jacobians(view, term, Steps(), how=how, fused=fused)[0]
            assert apart(x, view.compute(term, "local_world_aligned")) < 1e-10, (term, how)


def test_index_slips_of_symbols_are_those_of_the_sum_written_out(probe):
    """dM_ij/dq_i in the place of dM_ij/dq_k, and C_ij = c_ijk v_k of the last k alone."""
    rng = np.random.default_rng(0)
    n = 4
    dM, v = rng.normal(size=(n, n, n)), rng.normal(size=n)
    slipped, last = np.zeros((n, n)), np.zeros((n, n))
    for i, j, k in np.ndindex(n, n, n):
        rest = dM[i, k, j] - dM[j, k, i]
        slipped[i, j] += 0.5 * (dM[i, j, i] + rest) * v[k]
        last[i, j] = 0.5 * (dM[i, j, k] + rest) * v[k]
    for slip, expected in (
        (Slip("dM_ij/dq_k in Christoffel's sum", "dM_ij/dq_i", "step_other"), slipped),
        (Slip("k in Christoffel's sum", "", "step_last_alone"), last),
    ):
        assert slip in _found(dM, v)
        assert apart(of_symbols(Steps(slip), dM[None, None], v[None])[0, 0], expected) < 1e-12


def _found(dM: np.ndarray, v: np.ndarray) -> dict[Slip, None]:
    steps = Steps()
    of_symbols(steps, dM[None, None], v[None])
    return steps.found


def test_groups_of_groups_of_steps():
    steps = Steps()
    for site in ("the arm: of joints: to a frame", "the arm: of joints: to a centre", "the arm: of the base"):
        steps.pick(site, np.ones((1, 1)), other=np.zeros((1, 1)))
    sites = {s.site for s in steps.found}
    assert sites == {
        "the arm", "the arm: of joints", "the arm: of joints: to a frame", "the arm: of joints: to a centre",
        "the arm: of the base",
    }  # fmt: skip
    slip = next(s for s in steps.found if s.site == "the arm: of joints")
    made = Steps(slip)
    x = [made.pick(site, 1.0, other=0.0) for site in ("the arm: of joints: to a frame", "the arm: of the base")]
    assert x == [0.0, 1.0]
    assert "the arm, of joints, is other" in slip.says


def test_a_slip_of_velocities_shows_by_the_links_whose_velocities_turn_axes(probe):
    """w x z is the same for a link and its parent, until z qd is wrong."""
    slip = Slip("the axis z in z qd: of turning joints", "", "step_unturned")
    made = [
        kinematics.poses(probe, "jacobian_dot", Steps(*slips), how=how)[0]
        for how in (answers.LINKS, answers.BY_PARENTS) for slips in ((), (slip,))
    ]  # fmt: skip
    right, wrong, same, other = made
    assert apart(right, same) < 1e-13
    assert min(apart(wrong, right), apart(other, right), apart(wrong, other)) > 1e-3


def test_bodies_that_stand_in_the_frame_before_a_joint_s_own_motion(probe):
    """Their centres are where these would be if their own joints stood at zero."""
    slip = Slip("the frame in which a body stands", "that of its joint, before it moves", "step_other")
    com = kinematics.jacobians(probe, "com", Steps(slip))[0]
    joints, moments, total = {j.name: j for j in probe.robot}, 0.0 * com, 0.0
    on = probe.description.carriers()
    for part in (p for p in probe.description.parts if p.body is not None and on[p.link] != probe.description.root):
        q = probe.states["q"].copy()
        if part.joint in joints:
            q[:, joints[part.joint].q] = 0.0
        tree = answers.Made(probe).tree(q)
        k = tree.number[part.link]
        moments += part.body.mass * (tree.R[k][0] @ part.body.com + tree.p[k][0])
        total += part.body.mass
    assert apart(com, moments / total) < 1e-12
    assert apart(com, probe.compute("com")) > 1e-3
