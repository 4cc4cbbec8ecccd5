"""Kinds of mistakes in reading joints and placing links are named in codes of another kind; and guesses are not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import RULES, Case, diagnose
from dualpin.crosscheck.diagnosis.case import evaluate
from dualpin.crosscheck.diagnosis.diagnose import contradicted
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.reading import describe
from dualpin.crosscheck.diagnosis.stories import Explanation
from dualpin.crosscheck.diagnosis.textbook.lumps import listed
from dualpin.crosscheck.subjects import QUESTIONS, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.kinematic import Kinematic
from tests.crosscheck.recursive import about
from tests.crosscheck.test_blind import PROBE
from tests.crosscheck.unseen_codes import rewritten

FEW = ("fk", "jacobian", "com", "gravity", "crba")


def case_of(code: Any, terms: tuple[str, ...] = FEW) -> Case:
    ask = asking(PROBE, 4, 0, terms)
    return Case(ask_here(code(ask.text), ask, lambda what: None))


def told(code: Any, terms: tuple[str, ...] = FEW) -> list[str]:
    """What is said to be wrong, where all terms are explained."""
    case = case_of(code, terms)
    found = diagnose(case)
    explained = {t for f in found.findings if f.key != "partly" for t in f.terms}
    assert explained == {t for t in terms if not case.score(t).right}
    return [f"{f.key}: {f.says}" for f in found.findings if f.key != "follows"]


def made(**methods: Any) -> Any:
    return type("Wrong", (Kinematic,), methods)


def _kind(*kinds: str) -> Any:
    """Joints of these types get no axis, and so do not move."""
    return lambda s, e, R: Kinematic.axis(s, e, R) * (e.get("type") not in kinds)


def _of_axis(f: Any) -> Any:
    return lambda s, e, R: f(Kinematic.axis(s, e, R))


READ: dict[str, tuple[Any, str]] = {
    "continuous_still": (made(axis=_kind("continuous")), "joint_still: continuous joints do not move"),
    "prismatic_still": (made(axis=_kind("prismatic")), "joint_still: prismatic joints do not move"),
    "turning_still": (made(axis=_kind("continuous", "revolute")), "joint_still: joints that turn"),
    "largest": (
        made(axis=_of_axis(lambda a: np.sign(a) * (np.abs(a) == np.abs(a).max()))),
        "axis_rounded: of <axis> only the largest component counts",
    ),
    "always_x": (made(axis=_of_axis(lambda a: np.array([1.0, 0, 0]))), "axis_always_x: "),
    "raw": (rewritten("quat", ("axis / np.linalg.norm(axis)", "axis")), "the axis of a joint is not normalised"),
    "raw_in_columns": (
        rewritten("quat", ("turn(Q[k], self.bodies[k].axis)", "turn(Q[k], self.bodies[k].axis) * (1 + (k == 3))")),
        "axis_length: <axis> is not divided by its length, in velocities and forces",
    ),
    "axis_of_next": (
        rewritten("quat", ('j.find("axis")', 'joints[(joints.index(j) + 1) % len(joints)].find("axis")')),
        "joint_exchanged: joints have <axis> of the next one in the file",
    ),
    "other_order_on_fixed": (
        rewritten("quat", ("R=R @ Rj, p=p + R @ pj", "R=Rj @ R, p=pj + Rj @ p")),
        "fixed_order: a joint on a fixed link has the two poses multiplied in the other order",
    ),
    "rotation_vector": (
        rewritten("quat", ("Rj, pj = from_rpy(numbers(o, \"rpy\", \"0 0 0\"))",
                           "a = numbers(o, \"rpy\", \"0 0 0\")\n            n = np.linalg.norm(a) or 1.0\n"
                           "            Rj, pj = about(a / n, n)")),
        "rpy_order: rpy of joints is multiplied in another order, or taken for other angles: as a rotation vector",
    ),
    "unweighted": (
        rewritten("quat", ("(B.mass * B.com + m * c) / total if total", "(B.com + c) / 2 if B.mass")),
        "the centre of what is there and a fixed link is the mean of the two",
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", ["continuous_still", "raw_in_columns"])
def test_readings_of_joints_are_named(kind):
    code, words = READ[kind]
    (said,) = told(code)
    assert words in said


@pytest.mark.campaign
@pytest.mark.parametrize("kind", READ)
def test_all_readings_of_joints_are_named(kind):
    code, words = READ[kind]
    (said,) = told(code)
    assert words in said


HUNG = {
    "the one before in the list, depth first": (
        "spatial", "[b.parent for b in self.bodies]", "[i - 1 for i, b in enumerate(self.bodies)]"
    ),
    "the root": (
        "matlab", "self.parent.append(p)", "self.parent.append(p if p not in self.parent or p < 1 else 1)"
    ),
    "the one before in the list, breadth first": (
        "simulator", "self.parent.append(body)", "self.parent.append(len(self.parent) - 1)"
    ),
}  # fmt: skip


@pytest.mark.parametrize("where", HUNG)
def test_a_branch_on_another_link_is_named_once_for_all_terms(where):
    name, old, new = HUNG[where]
    assert told(rewritten(name, (old, new))) == [f"branch: a branch hangs on another link: {where}"]


AXES = {
    "the axis of a joint, kept in world axes for all its uses, is transformed by the parent's rotation": (
        "z = R @ b.axis\n", "z = Rp @ b.axis\n"
    ),
    "the rotation of a link is that with the joint's turn before its rpy": (
        "R = R @ turn(b.axis / length, angle * length)",
        "R = Rp @ turn(b.axis / length, angle * length) @ place[:3, :3]",
    ),
}  # fmt: skip


@pytest.mark.campaign
@pytest.mark.parametrize("words", AXES)
def test_that_poses_and_jacobians_disagree_about_an_axis_is_named_once(words):
    terms = (*FEW, "jacobian_dot", "com_jacobian", "coriolis")
    (said,) = (x for x in told(rewritten("worldframe", AXES[words]), terms) if "follows" not in x)
    assert words in said


def test_a_tree_in_another_order_is_the_same_robot():
    ask = asking(PROBE, 2, 0, ("fk",))
    d, case = describe(ask.text, ask.robot), case_of(Kinematic, ("fk",))
    other = d.with_tree(listed(d))
    assert [p.joint for p in other.parts] != [p.joint for p in d.parts]
    for term in FEW:
        inputs = {k: ask.states[k][None] for k in QUESTIONS[term].inputs}
        a, b = (
            evaluate(case.robot_of(x), QUESTIONS[term], inputs, ask.frames, "local_world_aligned") for x in (d, other)
        )
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-13)  # rounding of sums in another order


def test_a_circle_of_links_is_no_tree():
    ask = asking(PROBE, 1, 0, ("fk",))
    d = describe(ask.text, ask.robot)
    with pytest.raises(ValueError, match="circle of links: a, "):
        d.with_tree([replace(p, parent="e") if p.link == "a" else p for p in d.parts])


def test_a_reading_that_other_terms_speak_against_is_no_cause():
    """About a vertical axis nothing falls: there a joint that stands still looks like one that turns about it."""
    case = case_of(READ["continuous_still"][0], ("fk", "jacobian", "crba", "potential_energy"))
    every = [h for rule in RULES for h in rule.propose(case) if h.place == "edit"]
    upright, still = (
        next(h for h in every if h.key == key and (not items or h.items == items))
        for key, items in (("axis_in_parent", ("waist",)), ("joint_still", ()))
    )
    assert case.score("potential_energy", (upright,)).right and case.score("fk", (still,)).right
    left = {t: Explanation(t, case.score(t)) for t in ("fk", "jacobian", "crba")}
    assert contradicted(case, upright, left) == ["fk", "jacobian", "crba"]
    assert contradicted(case, still, left) == []


def test_each_joint_type_has_its_stories():
    case = case_of(Kinematic, ("fk",))
    found: dict[str, list[Hypothesis]] = {}
    for h in (h for rule in RULES for h in rule.propose(case)):
        found.setdefault(h.key, []).append(h)
    words = " ".join(h.says for key in ("joint_still", "joint_type", "joint_unread") for h in found[key])
    for kind in ("continuous joints", "revolute joints", "prismatic joints"):
        assert f"{kind} do not move" in words and f"positions of {kind} are not used" in words
    assert "continuous joints slide" in words and "prismatic joints turn about z, <axis> ignored" in words


def _place(change: Any) -> Any:
    """The pose of a joint's moving side on the body before it."""
    return lambda s, q: [change(j, x) for j, x in zip(s.joints, q, strict=True)]


PLACED: dict[str, tuple[Any, str]] = {
    "slide_turns_too": (
        made(steps=_place(lambda j, x: (j.R @ about(j.axis, x), j.p + j.R @ j.axis * x * j.slides))),
        "the rotation of a sliding link is that of its origin turned by q",
    ),
    "turn_slides_too": (
        made(steps=_place(lambda j, x: (j.R @ about(j.axis, x * (not j.slides)), j.p + j.R @ j.axis * x))),
        "the position of a turning link is that of its origin moved along",
    ),
    "before_rpy": (
        made(steps=_place(lambda j, x: (j.R, j.p + j.axis * x) if j.slides else (about(j.axis, x) @ j.R, j.p))), ""
    ),
    "cross_entry": (
        made(turn=lambda s, a, x: _rodrigues(_skew(a), x)), "with the other sign of entry 23"
    ),
}  # fmt: skip


def _skew(a: Any) -> Any:
    return np.array([[0, -a[2], a[1]], [a[2], 0, a[0]], [-a[1], a[0], 0]])


def _rodrigues(K: Any, x: float) -> Any:
    return np.eye(3) + np.sin(x) * K + (1 - np.cos(x)) * K @ K


@pytest.mark.campaign
@pytest.mark.parametrize("kind", PLACED)
def test_steps_of_placing_are_named(kind):
    code, words = PLACED[kind]
    (said,) = told(code, ("fk",))
    assert words in said


@pytest.mark.campaign
def test_an_axis_that_is_kept_in_the_world_is_wrong_wherever_it_is_used():
    """Columns and the way of a slide by the axis of the link before."""
    code = rewritten("worldframe", ("z = R @ b.axis", "z = b.axis"))
    assert told(code, ("fk", "jacobian")) == [
        "step_unturned: forward kinematics: the axis of a joint, kept in world axes for all its uses, is not "
        "transformed into the axes in which it is used"
    ]


def _world(*changes: tuple[str, str]) -> Any:
    return rewritten("worldframe", *changes)


ARM = 'arm = point - (s.p[b.parent] if "jacobian_arm_of_parent" in self.mistakes else s.p[j])'
COLUMN = "k, z = b.columns[0], s.z[j]"
SLIDE = '                Jv[:, k] = z\n                if "jac'
RATE = "Jd[3:, k] = np.cross(zd, p - s.p[j])"
AT_FRAME = 'Jw, Jv = self.columns(s, i, p)\n        if "jacobian_in'
STARTS = "w, u, wd, ud = s.w[b.parent], s.u[b.parent], s.wd[b.parent], s.ud[b.parent]"
COM = "return sum(self.bodies[i].mass * s.c[i] for i in self.counted) / total"
OF_FRAMES: dict[str, tuple[Any, str, tuple[str, ...]]] = {
    "arm_of_centre": (_world((ARM, "arm = point - s.c[j]")), "the centre of mass of the joint's link", ("jacobian",)),
    "arm_of_first": (_world((ARM, "arm = point - s.p[1]")), "counted from the first joint", ("jacobian",)),
    "arm_of_list": (_world((ARM, "arm = point - s.p[j - 1]")), "the joint before in the list", ("jacobian",)),
    "arm_sum": (_world((ARM, "arm = point + s.p[j]")), "the sum of both positions", ("jacobian",)),
    "entry_by_entry": (_world(("else np.cross(z, arm)", "else z * arm")), "taken entry by entry", ("jacobian",)),
    "axis_of_list": (
        _world((COLUMN, "k, z = b.columns[0], s.z[j - 1]")),
        "the joint before in the list",
        ("jacobian",),
    ),
    "link_z": (_world((COLUMN, "k, z = b.columns[0], s.R[j][:, 2]")), "that of the link's z axis", ("jacobian",)),
    "end_matrix": (
        _world((COLUMN, "k, z = b.columns[0], s.R[i] @ b.axis")),
        "that of the link that carries the point",
        ("jacobian",),
    ),
    "slide_unturned": (
        _world((SLIDE, SLIDE.replace("= z", "= b.axis"))),
        "the axis of a column, of sliding joints",
        ("jacobian",),
    ),
    "numbers": (
        _world(("path = self.path[i]\n", "path = [k for k in range(i + 1) if self.bodies[k].columns]\n")),
        "those of all joints with a smaller number, breadth first",
        ("jacobian",),
    ),
    "rows_twice": (
        _world((AT_FRAME, AT_FRAME.replace("\n", "; A = R @ s.R[i].T; Jw, Jv = A @ Jw, A @ Jv\n"))),
        "frame_axes: rows of frames on fixed joints are turned by the fixed joint's rotation twice",
        ("jacobian",),
    ),
    "body_axes": (
        _world((AT_FRAME, AT_FRAME.replace("\n", "; Jw, Jv = s.R[i].T @ Jw, s.R[i].T @ Jv\n"))),
        "frame_axes: rows of frames on fixed joints are in the axes of the link that carries",
        ("jacobian",),
    ),
    "minus": (
        _world(
            (
                "return np.vstack([Jw, Jv])\n\n    def jacobian_dot",
                "return -np.vstack([Jw, Jv])\n\n    def jacobian_dot",
            )
        ),
        "six_sign: ",
        ("jacobian",),
    ),
    "rate_arm": (_world((RATE, "Jd[3:, k] = np.cross(zd, p)")), "the lever arm in the rate", ("jacobian_dot",)),
    "rate_end": (
        _world(("u = s.u[i] + np.cross(s.w[i], p - s.p[i])\n        Jd", "u = s.u[i]\n        Jd")),
        "w x r is left out of the velocity of a frame",
        ("jacobian_dot",),
    ),
    "rate_joint": (
        _world(("else u - s.u[j]))", "else u - s.u[b.parent]))")),
        "is that of its parent",
        ("jacobian_dot",),
    ),
    "motion_of_list": (
        _world((STARTS, "w, u, wd, ud = s.w[i - 1], s.u[i - 1], s.wd[i - 1], s.ud[i - 1]")),
        "the motion that a link starts from is that of the link before in the list",
        ("frame_velocity",),
    ),
    "com_loses_last": (
        _world((COM, COM.replace("in self.counted", "in list(self.counted)[:-1]"))),
        "leaves out the last",
        ("com",),
    ),
    "com_component": (
        _world((COM, COM.replace("s.c[i]", "(s.p[i] + s.R[i] @ (self.bodies[i].com * [1, -1, 1]))"))),
        "is that with y of the other sign",
        ("com",),
    ),
}


@pytest.mark.campaign
@pytest.mark.parametrize("kind", OF_FRAMES)
def test_columns_rates_and_motions_are_named(kind):
    code, words, terms = OF_FRAMES[kind]
    (said,) = told(code, terms)
    assert words in said


@pytest.mark.parametrize("kind", ["rows_twice"])
def test_columns_are_named(kind):
    test_columns_rates_and_motions_are_named(kind)


@pytest.mark.parametrize(
    ("multiplier", "offset", "words"),
    [
        (1.0, 0.1, "the multiplier of <mimic> is ignored"), (-0.5, 0.1, "the multiplier of <mimic> has the other sign"),
        (2.0, 0.1, "joints are divided by the multiplier"), (0.5, -0.1, "the offset of <mimic> has the other sign"),
        (0.5, 0.05, "the offset of <mimic> is multiplied too"),
    ],
)  # fmt: skip
def test_joints_that_follow_otherwise_are_named(multiplier, offset, words):
    text = Path(PROBE).read_text()
    mine = text.replace('multiplier="0.5" offset="0.1"', f'multiplier="{multiplier}" offset="{offset}"')
    robot = dp.loads(mine, mimic=True)
    report = dp.judge(dp.load(PROBE, mimic=True), {"fk": lambda q, frame: dp.fk(robot, q, frame=frame)}, 3)
    (finding,) = report.findings
    assert words in finding.says


def test_columns_that_the_subject_counts_by_a_factor():
    """v_s = k v, tau = k tau_s, and positions as they are."""
    from dualpin.crosscheck.subjects import Convention
    from dualpin.crosscheck.subjects.layout import Layout

    ask = asking(PROBE, 2, 0, ("crba",))
    how = Convention.of(ask.robot)
    there = Layout(ask.robot, how, turned=((how.v[1], 2.0),)).states(ask.states)
    k = np.ones(ask.robot.nv)
    k[1] = 2.0
    assert np.array_equal(there["q"], ask.states["q"]) and np.allclose(there["v"], k * ask.states["v"])
    assert np.allclose(k * there["tau"], ask.states["tau"])
