"""What was converted is the same robot to the library of its format, or what was lost is said."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer import testing

import dualpin as dp
from dualpin.cli.main import program
from dualpin.model import Builder, revolute
from dualpin.spatial import Pose, Vector3
from dualpin.spatial.inertia import Inertia

pytest.importorskip("mujoco")


def run(*words: object):
    return testing.CliRunner().invoke(program(), ["convert", *map(str, words)])


@pytest.mark.parametrize("suffix", ["xml", "urdf"])
def test_both_formats_are_judged_by_their_library_term_by_term(tmp_path, suffix):
    done = dp.convert("panda", tmp_path / f"panda.{suffix}", samples=4)
    assert done.passed and done.library.startswith({"xml": "mujoco", "urdf": "pinocchio"}[suffix])
    assert {"fk", "jacobian", "crba", "gravity", "rnea", "aba"} <= set(done.terms)
    assert all(error < 1e-12 for term, error in done.terms.items() if term not in ("aba", "minv"))


def test_what_urdf_cannot_hold_is_found_by_the_judge(tmp_path):
    """An armature is not in a URDF: inertia matrices differ, poses do not."""
    b = Builder("geared")
    b.joint("j", revolute(), inertia=Inertia.of(1.0, (0.1, 0, 0), np.diag([0.1, 0.1, 0.1])), armature=(0.5,))
    done = dp.convert(b.robot(), tmp_path / "geared.urdf", samples=4)
    assert not done.passed
    assert "crba" in done.differs and "fk" not in done.differs and "gravity" not in done.differs
    assert any("armature" in note for note in done.notes)
    assert dp.convert(b.robot(), tmp_path / "geared.xml", samples=4).passed


def test_mjcf_becomes_urdf_and_back(tmp_path):
    text = """<mujoco model="leg"><worldbody><body name="hip" pos="0 0 1"><joint name="h" axis="0 1 0"/>
      <geom type="capsule" size=".05 .2"/><body name="knee" pos=".1 0 -.4"><joint name="k" axis="0 1 0" pos="0 0 .1"/>
      <geom type="box" size=".1 .05 .2"/></body></body></worldbody></mujoco>"""
    file = tmp_path / "leg.xml"
    file.write_text(text)
    assert dp.convert(file, tmp_path / "leg.urdf", samples=4).passed
    again = dp.convert(tmp_path / "leg.urdf", tmp_path / "again.xml", samples=4)
    assert again.passed
    assert dp.diff(file, tmp_path / "again.xml").same


def test_a_robot_on_a_floating_base(tmp_path):
    done = dp.convert("double_pendulum", tmp_path / "flying.urdf", samples=3, floating=True)
    assert done.passed, done


def test_the_command_prints_the_largest_difference_of_every_term(tmp_path):
    done = run("ur5", tmp_path / "ur5.xml", "--json", "-n", 3)
    assert done.exit_code == 0
    data = json.loads(done.stdout)
    assert data["passed"] and max(data["terms"].values()) < 1e-12
    assert (tmp_path / "ur5.xml").read_text().startswith("<mujoco")
    plain = run("ur5", tmp_path / "again.xml", "-n", 2)
    assert plain.exit_code == 0 and "crba" in plain.stdout and "agrees with mujoco" in plain.stdout


def test_what_cannot_be_done_says_why(tmp_path):
    with pytest.raises(dp.ArgumentError, match=r"ends in \.urdf, \.xml"):
        dp.convert("ur5", tmp_path / "ur5.sdf")
    with pytest.raises(dp.UrdfError, match="no such file"):
        dp.convert(tmp_path / "none.urdf", tmp_path / "a.xml")
    with pytest.raises(dp.ArgumentError, match="principal moments"):
        dp.convert("anymal_c", tmp_path / "anymal.xml")
    with pytest.raises(dp.UrdfError, match="cannot be written"):
        dp.convert("ur5", tmp_path / "nowhere" / "a.urdf")
    b = Builder("still")
    b.base("ground")
    b.frame("there", placement=Pose(position=Vector3(1.0, 0.0, 0.0)))
    done = dp.convert(b.robot(), tmp_path / "still.urdf")
    assert not done.passed and "no joint moves" in done.reason
