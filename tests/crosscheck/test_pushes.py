"""Wrenches in other axes or about another point than given are said to be so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.case import View
from dualpin.crosscheck.diagnosis.textbook import world_axes
from dualpin.crosscheck.diagnosis.textbook.pushes import torques, wrenches
from dualpin.crosscheck.diagnosis.textbook.steps import Steps
from dualpin.crosscheck.diagnosis.textbook.tree import Pose, tree_of
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


# --- taken by recursions over poses that are given ------------------------------------------------


def standing(ask) -> View:
    view = Case(ask_here({"rnea": lambda q, v, a: 0 * q}, ask, lambda what: None)).view(())
    assert view is not None
    return view


@pytest.mark.parametrize("fused", [False, True])
@pytest.mark.parametrize("reference", ["local", "world", "local_world_aligned"])
def test_torques_of_wrenches_by_the_poses_of_a_tree(fused, reference):
    ask = asking(PROBE, 3, 0, ("rnea", "rnea_f_ext"), floating=False)
    view = standing(ask)
    view.layout.how = replace(view.layout.how, reference=reference)
    tree = tree_of(view, fused)
    expected = torques(tree, view)
    for given in (tree.posed(tree._posed), tree.posed(twice(tree._posed))):
        found = torques(given, view)
        assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()
    pushed = world_axes.pushed(Steps(), given, *wrenches(Steps(), given, view))
    assert np.abs(pushed.reshape(found.shape) + expected).max() < 1e-12 * np.abs(expected).max()


def twice(made):
    """Of two runs."""

    def both(q):
        return [Pose(*(np.repeat(np.asarray(x), 2, 0) for x in (p.R, p.p, p.R0, p.p0))) for p in made(q)]

    return both


def test_a_moved_link_is_pushed_where_it_stands():
    """Both its frame and its joint move: the torque of its own joint stays, that of a joint before it does not."""
    ask = asking(PROBE, 3, 0, ("rnea", "rnea_f_ext"), floating=False)
    view = standing(ask)
    tree, last = tree_of(view), -1
    shift = np.array([0.3, -0.2, 0.5])

    def made(q):
        poses = tree._posed(q)
        return [*poses[:last], replace(poses[last], p0=poses[last].p0 + shift)]

    link = tree.links[last]
    change = (torques(tree.posed(made), view) - torques(tree, view))[0, :, view.frames.index(link.name)]
    assert np.abs(change[:, link.column]).max() < 1e-12
    assert np.abs(change).max() > 0.1
