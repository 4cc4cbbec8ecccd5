"""What keeps a subject from reading a file is found by repairing the file."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

import pytest
from lxml import etree

import dualpin as dp
from dualpin.crosscheck.diagnosis.constructs import CONSTRUCTS
from dualpin.crosscheck.diagnosis.repair import ATTEMPTS, repaired
from dualpin.crosscheck.subjects import Answers, Asking, Command, Convention, asking
from dualpin.io.urdf import loads

PICKY = Path(__file__).parent / "picky_subjects.py"
BODY = '<inertial><origin xyz="0 0 0.1"/><mass value="1"/><inertia {}/></inertial>'
GOOD = 'ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"'
ODD = f"""<robot name="odd">
  <!-- of everything -->
  <joint name="late" type="revolute"><parent link="a"/><child link="arm-2"/><axis xyz="0 0 -1"/>
    <limit lower="0" upper="0" effort="0" velocity="1"/><dynamics damping="1"/></joint>
  <link name="base">{BODY.format(GOOD)}</link>
  <link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="0.1" izz="0.1" ixy="0.01"/></inertial></link>
  <link name="arm-2"><inertial><origin rpy="1 0 0"/><mass value="0"/><inertia {GOOD}/></inertial></link>
  <link name="slide">{BODY.format(GOOD)}</link><link name="held">{BODY.format(GOOD)}</link><link name="bare"/>
  <link name="plane">{BODY.format(GOOD)}</link>
  <joint name="a" type="continuous"><parent link="base"/><child link="a"/>
    <limit lower="-1" upper="1" effort="1"/></joint>
  <joint name="slide" type="prismatic"><parent link="arm-2"/><child link="slide"/><origin xyz="0 0 1"/>
    <mimic joint="a"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="hold" type="fixed"><parent link="slide"/><child link="held"/><axis xyz="0 0 1"/></joint>
  <joint name="tip" type="fixed"><parent link="held"/><child link="bare"/></joint>
  <joint name="over" type="planar"><parent link="base"/><child link="plane"/></joint>
  <transmission name="t"/><gazebo/>
</robot>"""


@pytest.fixture
def slider(tmp_path) -> Path:
    """An arm of two joints: the first <inertial> has no origin, the second joint slides and follows."""
    path = tmp_path / "slider.urdf"
    path.write_text(f"""<robot name="slider"><link name="base"/>
      <link name="one"><inertial><mass value="1"/><inertia {GOOD}/></inertial></link>
      <link name="two">{BODY.format(GOOD).replace('"/><mass', '" rpy="0 0 0"/><mass')}</link>
      <link name="three">{BODY.format(GOOD)}</link>
      <joint name="turn" type="revolute"><origin xyz="0 0 0" rpy="0 0 0"/><parent link="base"/><child link="one"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="1"/></joint>
      <joint name="push" type="prismatic"><origin xyz="0 0 1" rpy="1 0 0"/><parent link="one"/><child link="two"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
      <joint name="echo" type="revolute"><origin xyz="0 0 1" rpy="1 0 0"/><parent link="two"/><child link="three"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="turn"/></joint>
    </robot>""")
    return path


@pytest.mark.parametrize(
    ("subject", "items", "words"),
    [
        ("NoSliding", ["push"], ("prismatic joints (push)", "KeyError: 'prismatic'")),
        ("NeedsInertialOrigin", ["one", "three"], ("<inertial> without <origin>", "AttributeError: 'NoneType'")),
        ("NoSlidingNorMimic", ["push", "echo"], ("prismatic joints (push), nor <mimic> (echo)", "KeyError")),
    ],
)
def test_a_refusal_names_the_construct_where_it_is_and_what_to_do(slider, subject, items, words):
    lines: list[str] = []
    report = dp.judge(slider, f"{PICKY}:{subject}", 4, progress=lines.append)
    (finding,) = report.refusals
    assert not report.findings and finding.key == "refusal" and finding.items == items and not finding.alternatives
    assert all(w in finding.says for w in words), finding.says
    assert finding.fix and finding.subject
    assert report.status == "not compared" and {t.status for t in report.terms.values()} == {"not compared"}
    assert any("prismatic joints (" in x for x in lines) and len(lines) <= 25


@pytest.mark.parametrize(
    ("subject", "remark"), [("NoFile", "no construct of the file explains it"), ("NeedsLibrary", "")]
)
def test_no_construct_is_blamed_for_what_is_no_matter_of_the_file(slider, subject, remark):
    report = dp.judge(slider, f"{PICKY}:{subject}", 4)
    assert not report.findings and report.robots[0].reason.startswith("refused")
    assert remark in "".join(report.robots[0].notes) and bool(report.robots[0].notes) == bool(remark)


def test_a_program_that_does_not_read_a_file_is_told_why(slider):
    command = Command(f"{shlex.quote(sys.executable)} {shlex.quote(str(PICKY))} FOLDER")
    report = dp.judge(slider, command, 4)
    (finding,) = report.refusals
    assert finding.items == ["turn"] and "<dynamics> (turn)" in finding.says and "not implemented" in finding.says


def test_without_a_diagnosis_no_file_is_repaired(slider):
    report = dp.judge(slider, f"{PICKY}:NoSliding", 4, diagnose=False)
    assert not report.findings and not report.robots[0].notes


def test_an_interpreter_that_is_none_is_an_error():
    with pytest.raises(dp.ArgumentError, match="python '/no/python' cannot be started"):
        dp.judge("ur5", f"{PICKY}:NoSliding", 4, python="/no/python")


@pytest.mark.parametrize("construct", CONSTRUCTS, ids=lambda c: c.says[:40])
def test_an_edit_says_what_it_changed_and_leaves_nothing_to_change(construct):
    root = etree.fromstring(ODD)
    before = etree.tostring(root)
    named = construct.edit(root)
    after = etree.tostring(root)
    assert named and after != before
    assert not construct.edit(root) and etree.tostring(root) == after
    robot = loads(after.decode())
    assert robot.nv and len(robot.frames) == len(loads(ODD).frames)


@pytest.mark.parametrize(
    "tags",
    [
        ("mimic",),
        ("dynamics", "mimic"),
        ("[@type='prismatic']", "dynamics", "mimic"),
        ("[@type='planar']", "[@rpy='1.0 0.0 0.0']"),
    ],
)
def test_of_many_constructs_those_that_are_needed_are_found_by_halving(tmp_path, tags):
    """A reader that stops at some of the 26 constructs of one file."""
    path = tmp_path / "odd.urdf"
    path.write_text(ODD)
    given = asking(path, 2, 0, ("crba",))
    tried = []

    def refusal(edited: Asking, seconds: float) -> str:
        tried.append(edited)
        root = etree.fromstring(edited.text)
        return "stopped" if any(root.findall(f".//{t}" if t[0] != "[" else f".//*{t}") for t in tags) else ""

    answers = Answers("reader", "", Convention.of(given.robot), given, {}, refused="stopped")
    finding = repaired(answers, given, refusal, lambda what: None).finding
    assert finding and len(tried) <= ATTEMPTS and "something else" not in finding.says
    where = {"mimic": "slide", "dynamics": "late", "[@type='prismatic']": "slide", "[@type='planar']": "over"}
    assert set(finding.items) == {where.get(t, "arm-2") for t in tags}
    assert finding.says.count(", nor ") == len(tags) - 1, finding.says
