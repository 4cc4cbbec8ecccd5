"""Derivatives and regressors that a code makes of its own answers follow from those, and from nothing else."""

from __future__ import annotations

import re

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case
from dualpin.crosscheck.diagnosis.catalogue import Catalogue
from dualpin.crosscheck.diagnosis.rules.derived import _parameters, by_derivatives, by_parameters
from dualpin.crosscheck.subjects import Convention, asking
from dualpin.crosscheck.subjects.convention import PARAMETERS
from dualpin.crosscheck.subjects.layout import Layout
from dualpin.crosscheck.subjects.running import ask_here

PROBE = "urdf/probe/probe.urdf"


class WithoutBias:
    """Forward dynamics without the bias, and its derivatives by central differences of that."""

    name = "without bias"

    def __init__(self, robot: dp.Robot) -> None:
        self.robot = robot

    def aba(self, q, v, tau):
        return np.linalg.solve(dp.crba(self.robot, q), tau)

    def aba_derivatives(self, q, v, tau):
        inverse, n, h = np.linalg.inv(dp.crba(self.robot, q)), len(v), 1e-3
        weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
        by_q = [
            sum(w * (self.aba(q + k * h * e, v, tau) - self.aba(q - k * h * e, v, tau)) for k, w in weights.items()) / h
            for e in np.eye(n)
        ]
        return np.stack([np.transpose(by_q), np.zeros((n, n)), inverse])


def test_derivatives_follow_from_the_function_that_is_differentiated():
    ask = asking(PROBE, 6, 0, ("aba", "aba_derivatives"))
    case = Case(ask_here(WithoutBias(ask.robot), ask, lambda what: None))
    (story,) = [(h,) for h in Catalogue(case).all if h.key == "bias_ignored" and "aba" in h.terms]
    assert case.score("aba", story).right
    told = {
        h.variant: case.score("aba_derivatives", (h,)).right for h in by_derivatives(case, "aba_derivatives", [story])
    }
    assert told == {str(story[0]): True, "": False}


class Pushed:
    """Torques that are off, and a regressor that is off with them or not."""

    name = "pushed"

    def __init__(self, robot: dp.Robot, both: bool) -> None:
        self.robot, self.both = robot, both
        self.parameters = np.array([float(x) for j in robot for x in j.inertia.parameters])

    def rnea(self, q, v, a):
        return dp.rnea(self.robot, q, v, a) + np.sin(q)

    def joint_torque_regressor(self, q, v, a):
        p = self.parameters
        return dp.joint_torque_regressor(self.robot, q, v, a) + self.both * np.outer(np.sin(q), p) / (p @ p)


@pytest.mark.parametrize("both", [True, False])
def test_a_regressor_follows_from_torques_where_its_product_is_what_they_are(both):
    ask = asking(PROBE, 4, 0, ("rnea", "joint_torque_regressor"))
    case = Case(ask_here(Pushed(ask.robot, both), ask, lambda what: None))
    (h,) = by_parameters(case, ())
    assert case.score("joint_torque_regressor", (h,)).right == both


def test_parameters_are_those_with_which_the_regressor_gives_the_torques():
    ask = asking(PROBE, 4, 0, ("rnea", "joint_torque_regressor"))
    case = Case(ask_here(Pushed(ask.robot, False), ask, lambda what: None))
    Y, tau = case.predict("joint_torque_regressor"), case.predict("rnea")
    np.testing.assert_allclose(Y @ _parameters(case, case.view(())), tau, atol=1e-12)


class OfLinks:
    """A regressor of all links, those on fixed joints too, of a robot that is read without rpy of joints."""

    name = "of links"

    def __init__(self, text: str, robot: dp.Robot) -> None:
        self.robot = dp.loads(re.sub(r'(<origin[^>]*) rpy="[^"]*"', r"\1", text))
        links = [f.name for f in robot.frames if f.role == "link"]
        joints = tuple(j.name for j in robot)
        self.writes = {"q": joints, "v": joints, "parameters": tuple(f"{k}.{p}" for k in links for p in PARAMETERS)}

    def joint_torque_regressor(self, q, v, a):
        Y = dp.joint_torque_regressor(self.robot, q, v, a)
        return Y @ Layout(self.robot, Convention(**self.writes)).bodies


def test_regressors_of_links_are_predicted_for_the_robot_that_is_read():
    ask = asking(PROBE, 4, 0, ("joint_torque_regressor",))
    case = Case(ask_here(OfLinks(ask.text, ask.robot), ask, lambda what: None))
    assert not case.score("joint_torque_regressor").right
    (h,) = [h for h in Catalogue(case).all if (h.says, h.items, h.values) == ("rpy of joints is ignored", (), "")]
    assert case.score("joint_torque_regressor", (h,)).right
