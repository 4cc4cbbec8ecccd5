"""Factors of M, composites about the world's origin, Kane's equations, wrenches in bias forces: right but for slips."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.rules import kinematics
from dualpin.crosscheck.diagnosis.textbook import about_world, answers, plucker, spatial
from dualpin.crosscheck.diagnosis.textbook.arrays import inverse
from dualpin.crosscheck.diagnosis.textbook.articulated import Articulated
from dualpin.crosscheck.diagnosis.textbook.assembly import Dynamics
from dualpin.crosscheck.diagnosis.textbook.factors import Factors
from dualpin.crosscheck.diagnosis.textbook.kane import Kane
from dualpin.crosscheck.diagnosis.textbook.steps import Steps
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here

PROBE = "urdf/probe/probe.urdf"
about = partial(Dynamics, spatial.forces, about_world.mass)
RUNS = [
    (Factors(), "minv"), (Factors(from_base=True), "minv"), (Factors(), "aba"), (about(), "crba"),
    (about(fused=True), "crba"), (Kane(), "bias"), (Kane(fused=True), "rnea"),
    *((Articulated(fused, of, inside=True), "aba_f_ext") for of in (plucker.links, plucker.world) for fused in (0, 1)),
    (partial(kinematics.jacobians, bare=True), "crba"), (partial(kinematics.jacobians, bare=True), "gravity"),
    *((partial(kinematics.jacobians, how=how), "coriolis") for how in (answers.TURNED_LAST, answers.TURNED_SECOND)),
]  # fmt: skip


class Code:
    """M^-1 by L^T D L, from the tips; the pivot may be another one, or the diagonal not reduced."""

    name = "factors"

    def __init__(self, robot: dp.Robot, mistake: str = "") -> None:
        self.robot, self.mistake = robot, mistake
        self.writes = dict.fromkeys("qv", tuple(j.name for j in robot))

    def minv(self, q):
        H, n = dp.crba(self.robot, q).copy(), self.robot.nv
        for k in reversed(range(n)):
            for i in reversed(range(k)):
                f = H[k, i] / (H[i, i] if self.mistake == "pivot" else H[k, k])
                H[i, : i + (self.mistake != "diagonal")] -= f * H[k, : i + (self.mistake != "diagonal")]
                H[k, i] = f
        X = np.linalg.inv(np.tril(H, -1) + np.eye(n))
        return X @ np.diag(1 / np.diag(H)) @ X.T


def case_of(mistake: str = "", samples: int = 3) -> Case:
    ask = asking(PROBE, samples, 0, ("minv",))
    return Case(ask_here(Code(ask.robot, mistake), ask, lambda what: None))


@pytest.mark.parametrize(("run", "term"), RUNS, ids=lambda x: x if isinstance(x, str) else "")
def test_without_a_slip_they_are_those_of_dualpin(run, term):
    view = case_of().view(())
    expected = view.compute(term)
    got = run(view, term, Steps())[0]
    assert np.abs(got - expected).max() < 1e-9 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize(
    ("mistake", "says"),
    [("pivot", "the pivot of a factor is that of the row"), ("diagonal", "the reduced matrix, on the diagonal")],
)
def test_slips_of_factors_are_named(mistake, says):
    (found,) = diagnose(case_of(mistake, 8)).findings
    assert says in found.says


def test_right_factors_have_no_finding():
    assert not diagnose(case_of(samples=8)).findings


def test_what_only_later_links_allow_is_noted():
    def algorithm(steps: Steps) -> float:
        return sum(steps.pick("the arm", 1.0, **others) for others in ({}, {"zero": 0.0}, {"twice": 2.0}))

    steps = Steps()
    assert algorithm(steps) == 3.0
    assert [(slip.what, algorithm(Steps(slip))) for slip in steps.found] == [("zero", 2.0), ("twice", 4.0)]


def test_a_singular_matrix_ends_its_own_run_alone():
    A = np.stack([np.eye(3), np.zeros((3, 3)), 2 * np.eye(3)])[:, None]
    found = inverse(A)
    assert np.isnan(found[1]).all() and (found[2] == np.eye(3) / 2).all()
