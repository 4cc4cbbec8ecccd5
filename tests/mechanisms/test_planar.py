"""Progressive dynamics: the planar arms, and a payload on a passive joint."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.model import Builder, revolute
from dualpin.spatial import Pose, Vector3
from tests.golden import REFERENCE, array, close


def link(m, l, I):
    """A link along x with its centre of mass at l; what turns in the plane is I about z."""
    return dp.mechanisms.body(m, [l, 0, 0], np.diag([0.0, 0.0, I]))


def arm(case, n=None):
    """Revolute joints about z, links a_i along x, gravity along -y."""
    a, l, m, I = (array(case[k]) for k in ("a", "l", "m", "Iz"))
    n = len(m) if n is None else n
    b = Builder("planar arm", gravity=(0.0, -float(case["g"]), 0.0))
    on, X = None, Pose()
    for i in range(n):
        b.joint(f"joint{i + 1}", revolute(), on=on, placement=X, inertia=link(m[i], l[i], I[i]))
        on = f"joint{i + 1}"
        X = Pose(position=Vector3(float(a[i]) if i < len(a) else 0.0, 0.0, 0.0))
    b.frame("tip", on=on, placement=X)
    return b.robot()


@pytest.mark.parametrize("case", REFERENCE["planar"], ids=lambda c: c["name"])
def test_golden_terms_of_each_link(case):
    robot = arm(case)
    q, v, acc = (array(case[k]) for k in ("q", "dq", "ddq"))
    close(dp.crba(robot, q), array(case["M"]))
    close(dp.coriolis(robot, q, v), array(case["C"]))
    close(dp.gravity(robot, q), array(case["gvec"]))
    close(dp.rnea(robot, q, v, acc), array(case["tau"]))
    for i, (term, want) in enumerate(zip(dp.link_terms(robot, q, v), case["per_link"], strict=True)):
        k = i + 1
        close(term.M[:k, :k], array(want["M"]))
        close(term.C[:k, :k], array(want["C"]))
        close(term.g[:k], array(want["g"]))
        assert not term.M[k:].any()
        assert not term.C[:, k:].any()
        assert not term.g[k:].any()


def test_a_payload_on_a_passive_joint_adds_its_term_and_changes_no_other():
    case = next(c for c in REFERENCE["planar"] if len(c["m"]) == 3)
    q, v = (array(case[k]) for k in ("q", "dq"))
    two = arm(case, 2)
    l, m, I = (array(case[k])[2] for k in ("l", "m", "Iz"))
    three = two.attach(link(m, l, I), passive=True)
    assert three.nv == 3
    assert three.joints[-1].limits.effort == 0.0
    before, after = dp.link_terms(two, q[:2], v[:2]), dp.link_terms(three, q, v)
    for old, new in zip(before, after, strict=False):
        close(new.M[:2, :2], old.M, 1e-15)
        close(new.C[:2, :2], old.C, 1e-15)
        close(new.g[:2], old.g, 1e-15)
    want = case["per_link"][2]
    close(after[2].M, array(want["M"]))
    close(after[2].C, array(want["C"]))
    close(after[2].g, array(want["g"]))
    # no motor on the payload's joint: its acceleration follows from the others
    acc = dp.aba(three, q, v, [1.0, -0.5, 0.0])
    assert abs(dp.rnea(three, q, v, acc)[2]) < 1e-12


def test_a_payload_held_rigidly_joins_the_last_link():
    case = next(c for c in REFERENCE["planar"] if len(c["m"]) == 3)
    two = arm(case, 2)
    held = two.attach(link(1.2, 0.1, 0.01))
    assert held.nv == 2
    assert held.mass == pytest.approx(two.mass + 1.2)
    q = np.array([0.3, -0.4])
    other = two.attach(link(1.2, 0.1, 0.01), passive=True)
    close(dp.crba(held, q), dp.crba(other, [*q, 0.0])[:2, :2], 1e-15)


def test_terms_of_a_tree_are_scattered_by_joint():
    robot = dp.load("talos")
    q, v, _ = robot.sample(seed=0)
    terms = dp.link_terms(robot, q, v)
    close(sum(t.M for t in terms), dp.crba(robot, q))
    close(sum(t.C for t in terms), dp.coriolis(robot, q, v))
    close(sum(t.g for t in terms), dp.gravity(robot, q))
