"""Wrenches in other axes or about another point than given are said to be so."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.test_diagnosis import PROBE


class Pushed:
    def __init__(self, ask, taken):
        self.robot, self.taken = ask.robot, taken

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        H = dp.fk(self.robot, q, frame)
        n, f = self.taken(H, f_ext[:3], f_ext[3:])
        J = dp.jacobian(self.robot, q, frame, reference="local_world_aligned")
        return dp.rnea(self.robot, q, v, a) - J.T @ np.r_[n, f]


@pytest.mark.parametrize(
    ("taken", "words"),
    [
        (lambda H, n, f: (H[:3, :3].T @ n, H[:3, :3].T @ f), "turned the wrong way, about the frame's origin"),
        (lambda H, n, f: (H[:3, :3] @ n - np.cross(H[:3, 3], H[:3, :3] @ f), H[:3, :3] @ f),
         "the frame's axes, about the world's origin"),
    ],
)  # fmt: skip
def test_a_wrench_that_is_taken_otherwise(taken, words):
    ask = asking(PROBE, 4, 0, ("rnea", "rnea_f_ext"))
    (finding,) = diagnose(Case(ask_here(Pushed(ask, taken), ask, lambda what: None))).findings
    assert finding.key == "f_ext_written" and words in finding.says
