"""Verdicts blame the right one: a wrong dualpin fails, a wrong oracle passes, two robots are not taken for one."""

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck import compare
from dualpin.crosscheck.oracles.pinocchio import Pinocchio
from dualpin.mechanisms import body
from tests.odd_robots import every_joint

pytest.importorskip("pinocchio")

LINK = """<link name="{name}"><inertial><origin xyz="{com}"/><mass value="{mass}"/>
<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def link(name, mass="1", com="0.1 0 0", i="0.01"):
    return LINK.format(name=name, mass=mass, com=com, i=i)


def joint(name, parent, child, axis="0 1 0", xyz="0 0 0", kind="continuous", limit=""):
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{xyz}"/><parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="{axis}"/>{limit}</joint>'
    )


def written(tmp_path, *parts):
    path = tmp_path / "robot.urdf"
    path.write_text(f'<?xml version="1.0"?>\n<robot name="r"><link name="base"/>{"".join(parts)}</robot>')
    return str(path)


def verdicts(report):
    return {name: t.verdict for name, t in report.terms.items() if t.status != "agrees"}


def validated(robot, **options):
    return dp.validate(robot, **{"samples": 10, "engine": "numpy", **options})


def test_a_heavy_wheel_differs_and_dualpin_is_nearer(tmp_path):
    """m r^2 / I is 1.8e5: Pinocchio's sums about the world's origin lose six digits of the wheel's own inertia."""
    path = written(
        tmp_path, link("hub", i="0.004"), link("wheel", "10000", "0 0 0", "0.5"),
        joint("steer", "base", "hub", "0 0 1", "2.86 0.77 0.3"), joint("spin", "hub", "wheel"),
    )  # fmt: skip
    report = validated(path, samples=50)
    assert report.passed
    assert set(verdicts(report).values()) <= {"differs, dualpin nearer"}
    for t in report.terms.values():
        if t.status == "differs":
            exact = t.worst["against_50_digits"]
            assert exact["dualpin"] < 1e-15 < t.tolerance < exact["oracle"]


@pytest.mark.parametrize("term", ["rnea", "crba", "fk", "aba"])
def test_a_wrong_engine_fails_and_the_oracle_is_nearer(monkeypatch, term):
    right = compare.evaluate

    def wrong(robot, which, *arguments, **options):
        found = right(robot, which, *arguments, **options)
        return found * (1 + 1e-9) if which == term else found

    monkeypatch.setattr(compare, "evaluate", wrong)
    report = validated("ur5", terms=[term])
    assert verdicts(report) == {term: "differs, oracle nearer"}
    assert not report.passed


def test_a_wrong_oracle_passes_and_dualpin_is_nearer(monkeypatch):
    right = Pinocchio.compute
    monkeypatch.setattr(
        Pinocchio, "compute", lambda self, term, *a: [x * (1 + 1e-9 * (term == "rnea")) for x in right(self, term, *a)]
    )
    report = validated("ur5", terms=["rnea", "crba"])
    assert verdicts(report) == {"rnea": "differs, dualpin nearer"}
    assert report.passed


def test_both_wrong_are_both_far(monkeypatch):
    right = Pinocchio.compute
    monkeypatch.setattr(Pinocchio, "compute", lambda self, *a: [x * (1 + 2e-9) for x in right(self, *a)])
    ours = compare.evaluate
    monkeypatch.setattr(compare, "evaluate", lambda *a, **k: ours(*a, **k) * (1 + 1e-9))
    report = validated("ur5", terms=["rnea"])
    assert verdicts(report) == {"rnea": "differs, both far"}
    assert not report.passed


def test_a_few_wrong_samples_are_not_hidden_by_worse_ones_of_the_oracle(monkeypatch):
    """The worst sample is the oracle's fault, another one dualpin's."""
    theirs, ours = Pinocchio.compute, compare.evaluate

    def oracle(self, term, states, *a):
        found = theirs(self, term, states, *a)
        found[0][3] *= 1 + 1e-6
        return found

    def dualpin(*a, **k):
        found = ours(*a, **k)
        found[5] = found[5] * (1 + 1e-9)
        return found

    monkeypatch.setattr(Pinocchio, "compute", oracle)
    monkeypatch.setattr(compare, "evaluate", dualpin)
    assert not validated("ur5", terms=["gravity"]).passed


@pytest.mark.parametrize(("old", "new", "complaint"), [
    ('<mass value="1"/>', '<mass value="0.9 "/>', "mass [0.9 ] is not a float"),
    ('ixx="0.01"', 'ixx="0.01 "', "ixx is not a valid double"),
])  # fmt: skip
def test_what_urdfdom_drops_is_named_and_not_compared(tmp_path, old, new, complaint):
    path = written(tmp_path, link("arm").replace(old, new), joint("j", "base", "arm"))
    report = validated(path)
    assert report.passed
    assert report.robots[0].status == "not compared"
    assert verdicts(report)["rnea"] == "not compared"
    assert "did not read link arm" in report.terms["rnea"].reason
    assert complaint in report.terms["rnea"].reason
    assert {report.terms[t].status for t in ("fk", "jacobian", "frame_acceleration")} == {"agrees"}


def test_a_dropped_link_among_others_of_its_body_is_the_one_named(tmp_path):
    path = written(
        tmp_path, link("arm"), link("tool", "2 "), joint("j", "base", "arm"),
        joint("k", "arm", "tool", xyz="0.1 0.2 0.3", kind="fixed"),
    )  # fmt: skip
    reason = validated(path).terms["rnea"].reason
    assert "link tool" in reason
    assert "arm" not in reason


def test_a_robot_without_mass_is_not_compared_in_what_needs_mass(tmp_path):
    report = validated(written(tmp_path, '<link name="a"/>', joint("j", "base", "a")))
    assert report.robots[0].status == "not compared"
    assert report.terms["rnea"].reason == "no moving body has mass"
    assert report.terms["rnea"].max_scaled_error == 0.0
    assert report.terms["fk"].status == "agrees"


def test_a_joint_that_moves_no_mass_has_no_forward_dynamics_to_compare(tmp_path):
    path = written(tmp_path, link("arm"), '<link name="tip"/>', joint("j", "base", "arm"), joint("k", "arm", "tip"))
    report = validated(path)
    assert verdicts(report) == dict.fromkeys(("aba", "minv", "aba_derivatives"), "not compared")
    assert "singular" in report.terms["aba"].reason


@pytest.mark.parametrize("limit", [
    '<limit lower="-1" upper="1" effort="1"/>',
    '<limit lower="-1" upper="1" effort="-1" velocity="1"/>',
])  # fmt: skip
def test_a_file_that_only_pinocchio_refuses_is_compared_with_what_dualpin_makes_of_it(tmp_path, limit):
    path = written(tmp_path, link("arm"), joint("j", "base", "arm", kind="revolute", limit=limit))
    report = validated(path, samples=3)
    assert verdicts(report) == {}
    said = "the URDF that dualpin writes"
    assert any("Pinocchio refuses" in x and said in x for x in report.robots[0].notes)


def test_huge_limits_are_no_limits(tmp_path):
    limit = '<limit lower="-1e308" upper="1e308" effort="1" velocity="1e300"/>'
    path = written(
        tmp_path, link("x"), link("arm"), joint("jx", "base", "x", "1 0 0", kind="prismatic", limit=limit),
        joint("j", "x", "arm", kind="revolute", limit=limit),
    )  # fmt: skip
    report = validated(path, samples=20)
    assert verdicts(report) == {}
    assert max(abs(x) for t in report.terms.values() for x in t.worst["q"]) <= np.pi
    assert any("counts as no limit" in note for note in report.robots[0].notes)


def test_far_places_enter_the_tolerance(tmp_path):
    """A Jacobian seen in a frame is what is left of v + r x w, and I of m r^2 + I: 80 m away, digits are lost."""
    far, near = (
        validated(written(tmp_path, link("arm"), joint("j", "base", "arm", xyz=place)), samples=20)
        for place in ("80 0 0", "0 0 0")
    )
    assert far.passed
    assert near.passed
    for term in ("crba", "minv", "centroidal_momentum_matrix"):
        assert far.terms[term].tolerance > 4 * near.terms[term].tolerance
        assert far.terms[term].tolerance <= 1e-12 or term == "minv"
    assert "r beside 1" in far.terms["jacobian"].tolerance_reason


# --- robots that are not what their file holds ---------------------------------------------------

PAYLOAD = body(2.0, [0.01, 0.02, 0.1], [[0.01, 0, 0], [0, 0.02, 0], [0, 0, 0.03]])
CHANGES = {
    "payload": lambda arm: arm.attach(PAYLOAD),
    "gravity": lambda arm: arm.with_gravity((0.3, -0.2, 1.6)),
    "hanging payload": lambda arm: arm.attach(PAYLOAD, passive=True),
}


@pytest.mark.parametrize("change", CHANGES)
def test_changed_robots_agree_with_the_same_robot_of_the_oracle(change):
    report = validated(CHANGES[change](dp.load("ur5")), samples=5)
    assert verdicts(report) == {}
    assert any("same joints, bodies" in note for note in report.robots[0].notes)


@pytest.mark.parametrize(("change", "says"), [
    ("payload", "link payload is not in ur5_robot.urdf"),
    ("gravity", "gravity is 0.3 -0.2 1.6, in ur5_robot.urdf 0 0 -9.81"),
    ("hanging payload", "joint payload is not in ur5_robot.urdf"),
])  # fmt: skip
def test_against_its_file_a_changed_robot_says_what_differs(change, says):
    report = validated(CHANGES[change](dp.load("ur5")), samples=5, against="ur5")
    assert not report.passed
    assert report.robots[0].status == "differs"
    assert says in report.robots[0].remark
    assert says in report.to_markdown()


def test_an_unchanged_robot_passes_against_its_file():
    arm = dp.load("ur5")
    assert verdicts(validated(arm, samples=3, against=arm.source)) == {}


def test_every_joint_built_in_code_has_a_counterpart():
    report = validated(every_joint(), samples=5)
    assert verdicts(report) == {}
    assert np.isfinite(report.robots[0].worst_error)
