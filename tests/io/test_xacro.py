"""Xacro files expand as xacro says, find their packages, and fail with what to do."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.cli.app import in_front
from dualpin.io import expand

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
MACROS = f"""<robot {XACRO}>
<xacro:macro name="box" params="name mass size">
  <link name="${{name}}">
    <inertial>
      <mass value="${{mass}}"/>
      <xacro:property name="J" value="${{mass * size**2 / 6}}"/>
      <inertia ixx="${{J}}" ixy="0" ixz="0" iyy="${{J}}" iyz="0" izz="${{J}}"/>
    </inertial>
    <visual><geometry><mesh filename="package://arm_description/meshes/box.stl"/></geometry></visual>
  </link>
</xacro:macro>
</robot>"""
ARM = f"""<robot name="arm" {XACRO}>
<xacro:arg name="mass" default="2"/>
<xacro:include filename="$(find arm_description)/urdf/macros.xacro"/>
<xacro:property name="joints" value="${{[1, 2]}}"/>
<xacro:box name="link0" mass="1" size="0.1"/>
<xacro:macro name="grow" params="n">
  <xacro:box name="link${{n}}" mass="$(arg mass)" size="0.2"/>
  <joint name="joint${{n}}" type="continuous"><origin xyz="0 0 ${{0.1 * n}}" rpy="${{pi/2}} 0 0"/>
    <parent link="link${{n - 1}}"/><child link="link${{n}}"/><axis xyz="0 0 1"/></joint>
</xacro:macro>
<xacro:grow n="1"/><xacro:grow n="2"/>
</robot>"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package as ROS has it, with a file that includes another of it."""
    folder = tmp_path / "ws" / "arm_description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "meshes").mkdir()
    (folder / "package.xml").write_text("<package format='3'><name>arm_description</name></package>")
    (folder / "urdf" / "macros.xacro").write_text(MACROS)
    (folder / "urdf" / "arm.urdf.xacro").write_text(ARM)
    return folder


def test_a_file_within_its_package_expands_without_being_told_anything(package):
    robot = dp.load(package / "urdf" / "arm.urdf.xacro")
    assert robot.name == "arm" and robot.joint_names == ["joint1", "joint2"] and robot.mass == 4.0
    X = dp.fk(robot, np.zeros(2), frame="link2", engine="numpy")
    # two turns of 90 degrees about x, the second 0.2 m along the z of the first, which points along -y
    np.testing.assert_allclose(X, [[1, 0, 0, 0], [0, -1, 0, -0.2], [0, 0, -1, 0.1], [0, 0, 0, 1]], atol=1e-15)


def test_arguments_reach_the_file(package):
    robot = dp.load(package / "urdf" / "arm.urdf.xacro", xacro_args={"mass": 5.5})
    assert robot.mass == 11.0
    with pytest.raises(dp.ArgumentError, match="'mass' is"):
        dp.load(package / "urdf" / "arm.urdf.xacro", xacro_args={"mass": object()})


def test_packages_are_found_by_name_by_the_environment_or_not_at_all(package, tmp_path, monkeypatch):
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    file = tmp_path / "elsewhere" / "arm.xacro"
    file.parent.mkdir()
    file.write_text(ARM)
    with pytest.raises(dp.UrdfError, match=r"arm_description.*--package name=folder"):
        dp.load(file)
    assert dp.load(file, packages={"arm_description": package}).nv == 2
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(package.parent))
    assert dp.load(file).nv == 2
    with pytest.raises(dp.ArgumentError, match="is no folder"):
        dp.load(file, packages={"arm_description": tmp_path / "nowhere"})


def test_it_is_validated_like_any_other_robot(package):
    assert dp.validate(str(package / "urdf" / "arm.urdf.xacro"), samples=5, engine="numpy").passed


def test_meshes_of_packages_are_known_by_their_place(package):
    source = dp.load(package / "urdf" / "arm.urdf.xacro").source
    assert f"file://{package}/meshes/box.stl" in Path(source).read_text()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f'<robot name="r" {XACRO}><link name="${{nothing}}"/></robot>', "nothing"),
        (f'<robot name="r" {XACRO}><link name="$(arg who)"/></robot>', "xacro_args"),
        (f'<robot name="r" {XACRO}><xacro:leg/></robot>', "leg"),
        (f'<robot name="r" {XACRO}><xacro:include filename="no.xacro"/></robot>', "no.xacro"),
        (f'<robot name="r" {XACRO}><link name="a">', "r.xacro"),
        ("", "r.xacro"),
        (f'<robot name="r" {XACRO}><xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/></robot>', "ecursion"),
        (f'<robot name="r" {XACRO}><link name="${{__import__(\'os\').getcwd()}}"/></robot>', "r.xacro"),
    ],
)
def test_what_is_wrong_is_one_clear_error(tmp_path, text, says):
    file = tmp_path / "r.xacro"
    file.write_text(text)
    with pytest.raises(dp.UrdfError) as e:
        dp.load(file)
    assert says in str(e.value) and "\n" not in str(e.value) and "Traceback" not in str(e.value)


def test_an_expansion_that_does_not_end_is_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr(expand, "SECONDS", 1.0)
    file = tmp_path / "r.xacro"
    file.write_text(f'<robot name="r" {XACRO}><link name="${{10**10**10}}"/></robot>')
    with pytest.raises(dp.UrdfError, match="did not end within 1 s"):
        dp.load(file)


def test_a_urdf_is_never_run_through_xacro(tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text(f'<robot name="r" {XACRO}><link name="${{1 + 1}}"/></robot>')
    with pytest.raises(dp.UrdfError, match="run xacro"):
        dp.load(file)


def test_two_threads_expand_different_arguments_at_once(package):
    found: dict[int, float] = {}

    def load(mass: int) -> None:
        found[mass] = dp.load(package / "urdf" / "arm.urdf.xacro", xacro_args={"mass": mass}).mass

    threads = [threading.Thread(target=load, args=(m,)) for m in (1, 2, 3)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert found == {1: 2.0, 2: 4.0, 3: 6.0}


def test_the_command_line_says_arguments_and_packages_anywhere(package, tmp_path):
    file = tmp_path / "arm.xacro"
    file.write_text(ARM)
    words = ["info", str(file), "--xacro-arg", "mass:=7", "--json", f"--package=arm_description={package}"]
    environment = {k: v for k, v in os.environ.items() if k != "ROS_PACKAGE_PATH"}
    done = subprocess.run(
        [sys.executable, "-m", "dualpin", *words], capture_output=True, text=True, env=environment, check=False
    )
    assert '"moving_mass": 14.0' in done.stdout, done.stderr
    wrong = subprocess.run(
        [sys.executable, "-m", "dualpin", "info", str(file), "--xacro-arg", "mass=7"], capture_output=True, text=True,
        env=environment, check=False,
    )  # fmt: skip
    assert wrong.returncode == 2 and "name:=value" in wrong.stderr


def test_options_move_before_the_command_and_nothing_else_does():
    assert in_front(["fk", "a", "--xacro-arg", "k:=v", "--q", "1"]) == ["--xacro-arg", "k:=v", "fk", "a", "--q", "1"]
    assert in_front(["fk", "--", "--package", "x"]) == ["fk", "--", "--package", "x"]
    assert in_front(["fk", "--package"]) == ["--package", "fk"]
