"""Regressors of textbooks: right without a slip, in the columns of any subject; and their slips are named."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.rules import kinematics
from dualpin.crosscheck.diagnosis.textbook import answers, regressors, world_axes
from dualpin.crosscheck.diagnosis.textbook.assembly import Dynamics, by_columns
from dualpin.crosscheck.diagnosis.textbook.slipped import Slipped, made_with
from dualpin.crosscheck.diagnosis.textbook.steps import Slip, Steps
from dualpin.crosscheck.subjects import Convention, asking
from dualpin.crosscheck.subjects.convention import PARAMETERS
from dualpin.crosscheck.subjects.layout import Layout
from dualpin.crosscheck.subjects.running import ask_here

PROBE, TERM = "urdf/probe/probe.urdf", "joint_torque_regressor"
recursion = partial(Dynamics, world_axes.forces, by_columns(world_axes.forces))
RUNS = {
    "by motions": recursion(regressor=regressors.Regressor(motions=True)),
    "by motions of merged bodies": recursion(regressor=regressors.Regressor(motions=True), fused=True),
    "with steps of its own": recursion(regressor=regressors.Regressor(units=True)),
    "by Jacobians": kinematics.jacobians,
    "by Jacobians of merged bodies": partial(kinematics.jacobians, fused=True),
    "by Jacobians, in the links' axes": partial(kinematics.jacobians, how=answers.IN_LINKS),
}

RUNS["of motions and of units"] = RUNS["by motions"].beside(RUNS["with steps of its own"])
RUNS["by Jacobians and motions"] = made_with(kinematics.jacobians, RUNS["by motions"])
RUNS["by Jacobians and units"] = made_with(kinematics.jacobians, RUNS["with steps of its own"])


class Code:
    """A regressor with ten columns for each of the links that are named, or for dualpin's bodies."""

    name = "regressor"

    def __init__(self, robot: dp.Robot, links: tuple[str, ...] = (), mistake: str = "") -> None:
        names = tuple(j.name for j in robot)
        self.robot, self.mistake = robot, mistake
        self.writes = {"q": names, "v": names, "parameters": tuple(f"{k}.{p}" for k in links for p in PARAMETERS)}

    def joint_torque_regressor(self, q, v, a):
        Y = dp.joint_torque_regressor(self.robot, q, v, a)
        if self.mistake == "no gravity":
            Y = Y - dp.joint_torque_regressor(self.robot, q, 0 * v, 0 * a)
        elif self.mistake == "another order":  # xx, yy, zz, xy, xz, yz, and called xx, xy, yy, xz, yz, zz
            each = [0, 1, 2, 3, 4, 6, 9, 5, 7, 8]
            Y = np.concatenate([Y[:, k : k + 10][:, each] for k in range(0, Y.shape[1], 10)], axis=1)
        elif self.mistake == "half products":
            Y = Y * np.tile(np.where(np.isin(PARAMETERS, ("Ixy", "Ixz", "Iyz")), 0.5, 1.0), Y.shape[1] // 10)
        return Y @ Layout(self.robot, Convention(**self.writes)).bodies


def case_of(samples: int = 3, **how: object) -> Case:
    ask = asking(PROBE, samples, 0, (TERM,))
    return Case(ask_here(Code(ask.robot, **how), ask, lambda what: None))


@pytest.mark.parametrize("links", [(), ("b", "b_lid", "e"), ("flange",)])
@pytest.mark.parametrize("run", RUNS)
def test_without_a_slip_they_are_those_of_dualpin(run, links):
    case = case_of(links=links)
    right = Hypothesis("step_sign", run, (TERM,), "formula", Slipped(RUNS[run], (), batched=True))
    x = case.predict(TERM, (right,))
    assert x is not None and case.score(TERM).right
    assert np.abs(x - case.observed[TERM]).max() < 1e-11 * np.abs(x).max()


TURNS = Slip("the angular acceleration of a turning link", "w x z qd", "step_left_out")
UNITS = Slip("the torques of a unit parameter", "Jw^T n", "step_left_out")


@pytest.mark.parametrize(
    ("both", "one", "other"),
    [
        ("by Jacobians and motions", ("by Jacobians", None), ("by motions", TURNS)),
        ("by Jacobians and units", ("by Jacobians", None), ("with steps of its own", UNITS)),
        ("of motions and of units", ("by motions", TURNS), ("with steps of its own", UNITS)),
    ],
)
def test_slips_of_both_are_made_where_each_was(both, one, other):
    view, (first, slip), (second, another) = case_of().view(()), one, other
    if slip is None:
        steps = Steps()
        RUNS[first](view, TERM, steps)
        slip = next(s for s in steps.found if s.site.startswith("the lever arm of a column"))
    right = RUNS[both](view, TERM, Steps())
    for run, mine in ((first, slip), (second, another)):
        x = RUNS[both](view, TERM, Steps(mine))
        assert np.abs(x - right).max() > 1e-3
        assert np.abs(x - RUNS[run](view, TERM, Steps(mine))).max() < 1e-11 * np.abs(x).max()
    x = RUNS[both](view, TERM, Steps(slip, another))
    assert all(np.abs(x - RUNS[both](view, TERM, Steps(s))).max() > 1e-3 for s in (slip, another))


@pytest.mark.parametrize(
    ("mistake", "says"),
    [
        ("no gravity", "gravity is another"),
        ("another order", "another: in the order xx yy zz xy xz yz"),
        ("half products", "half of it"),
    ],
)
def test_slips_are_named(mistake, says):
    found = diagnose(case_of(6, links=("b", "e", "f"), mistake=mistake)).findings
    assert [f.terms for f in found] == [[TERM]] and says in found[0].says, found


def test_rotors_are_columns_of_their_own(tmp_path):
    robot = tmp_path / "rotors.urdf"
    robot.write_text(
        '<robot name="r"><link name="base"/><link name="arm"><inertial><origin xyz="0.1 0 0.2"/><mass value="2"/>'
        '<inertia ixx="0.1" iyy="0.2" izz="0.15" ixy="0.01" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>'
        "</robot>"
    )
    ask = asking(str(robot), 3, 0, (TERM,))
    case = Case(ask_here(Code(ask.robot), ask, lambda what: None))
    right = Hypothesis("step_sign", "x", (TERM,), "formula", Slipped(RUNS["by motions"], (), batched=True))
    assert np.abs(case.predict(TERM, (right,)) - case.observed[TERM]).max() < 1e-11
