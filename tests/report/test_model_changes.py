"""What is to be said about a model is seen, and a model that changed is another model."""

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.fingerprint import differences, fingerprint
from dualpin.crosscheck.results import Report
from dualpin.report import compare, page

pytest.importorskip("pinocchio")
ARM = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="{mass}"/>
<inertia ixx="{ixx}" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.01"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 {z}"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="{upper}" effort="10" velocity="2"/></joint></robot>"""
GOOD = {"mass": 3.0, "ixx": 0.05, "z": 0.3, "upper": 1.0}


def judged(tmp_path, **changed):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.format(**GOOD | changed))
    return dp.validate(str(path), samples=2, terms=["fk", "rnea"], engine="numpy")


@pytest.mark.parametrize(("changed", "where"), [
    ({"mass": 30.0}, "link upper: mass"),
    ({"ixx": 0.06}, "link upper: inertia"),
    ({"z": 0.31}, "joint shoulder: placement"),
    ({"upper": 2.0}, "joint shoulder: upper"),
])  # fmt: skip
def test_a_changed_model_is_told_though_both_readers_agree(tmp_path, changed, where):
    old, new = judged(tmp_path), judged(tmp_path, **changed)
    assert old.passed and new.passed
    found = compare(old, Report.from_dict(new.to_dict()))
    assert not found.passed
    (change,) = [c for c in found.worse if c.what == "model"]
    assert change.where.endswith(where)
    assert compare(old, old).passed


def test_a_new_remark_is_told_and_counted(tmp_path):
    old, new = judged(tmp_path), judged(tmp_path, ixx=-0.05)
    found = compare(old, new)
    assert any(c.what == "remark" and "inertia" in c.new for c in found.worse)
    assert "1 remark about the model" in new.headline and "remark" not in old.headline
    assert "1 remark about the model" in new.to_markdown()
    html = page(new)
    assert "1 remark about the model" in html and 'class="verdict passed remarked"' in html


def test_rounding_is_no_change():
    robot = dp.load("panda")
    model = fingerprint(robot)
    assert list(differences(model, model)) == []
    nudged = {**model, "links": {k: {**v, "mass": v["mass"] * (1 + 1e-9)} for k, v in model["links"].items()}}
    assert list(differences(model, nudged)) == []
    gone = {**model, "joints": {k: v for k, v in model["joints"].items() if k != "panda_joint3"}}
    assert ("joint panda_joint3", "there", "absent") in list(differences(model, gone))
    assert list(differences({}, model)) == []  # results of before say nothing about the model


def test_written_and_read_again_is_the_same_model(tmp_path):
    robot = dp.load("ur5")
    again = dp.loads(robot.to_urdf())
    found = [d for d in differences(fingerprint(robot), fingerprint(again)) if d[1] != "there"]
    assert found == []
    assert np.isclose(fingerprint(robot)["links"]["shoulder_link"]["mass"], 3.7)
