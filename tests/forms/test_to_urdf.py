"""A robot written as URDF is read back as the same robot, here and by Pinocchio."""

from __future__ import annotations

import warnings
from math import inf
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.io.urdf import loads
from dualpin.io.write import roll_pitch_yaw
from dualpin.model import Builder, revolute
from dualpin.model.robot import Limits
from dualpin.spatial import Pose, Vector3

# roll, pitch, yaw and back: three rotations, each within an eps of it
POSE = 2e-15


def matrix(X: Pose) -> np.ndarray:
    return np.array([[float(x) for x in row] for row in X.rows])


def reread(robot: dp.Robot, **how: bool) -> dp.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", dp.DualpinWarning)
        return loads(robot.to_urdf(), **how)


def assert_same(a: dp.Robot, b: dp.Robot) -> None:
    assert a.joint_names == b.joint_names
    assert a.frame_names == b.frame_names
    assert a.link_names == b.link_names
    assert [(j.kind, j.mimic) for j in a] == [(j.kind, j.mimic) for j in b]
    assert np.array_equal(a.lower, b.lower)
    assert np.array_equal(a.upper, b.upper)
    for x, y in zip(a.frames, b.frames, strict=True):
        assert (x.role, x.parent) == (y.role, y.parent)
        assert np.abs(matrix(x.placement) - matrix(y.placement)).max() <= POSE
    p, r = dp.inertial_parameters(a), dp.inertial_parameters(b)
    assert np.abs(p - r).max(initial=0.0) <= 1e-14 * max(1.0, np.abs(p).max(initial=0.0))


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("panda", {}), ("panda", {"mimic": True}), ("ur5", {}), ("talos", {"floating": True}), ("pr2", {}),
        ("iris", {}), ("kinova", {}), ("double_pendulum_continuous", {}),
    ],
)  # fmt: skip
def test_what_is_written_is_read_back_the_same(name: str, how: dict) -> None:
    robot = dp.load(name, **how)
    assert_same(robot, reread(robot, **how))


@pytest.mark.campaign
def test_every_robot_is_written_and_read_back_the_same() -> None:
    for path in dp.io.catalogue().values():
        for how in ({}, {"mimic": True}, {"floating": True}):
            try:
                robot = dp.load(path, **how)
            except dp.UrdfError:
                continue
            assert_same(robot, reread(robot, **how))


@pytest.mark.parametrize("name", ["panda", "talos_left_arm", "hyq_no_sensors"])
def test_pinocchio_reads_the_written_file_as_the_same_robot(name: str, tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    robot = dp.load(name)
    robot.to_urdf(tmp_path / "again.urdf")
    report = dp.validate(str(tmp_path / "again.urdf"), samples=10, seed=2, terms=["fk", "rnea", "crba"], engine="numpy")
    assert report.passed, report
    assert_same(robot, dp.load(tmp_path / "again.urdf"))


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_a_robot_from_rows_has_pinocchios_dynamics(convention: str, seed: int, tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    rng = np.random.default_rng(seed)
    inertias = []
    for _ in range(5):
        A = rng.uniform(-1, 1, (3, 3))
        J = A @ A.T + np.eye(3)
        inertias.append({"mass": rng.uniform(0.5, 3), "com": rng.uniform(-1, 1, 3), "inertia": J})
    rows = rng.uniform(-1.5, 1.5, (5, 4))
    limits = [(-2.0, 2.0)] * 5
    arm = dp.from_dh(rows, "RPRPR", convention, inertias=inertias, limits=limits, tool=dp.Dual(0.1, 0.2))
    path = tmp_path / "arm.urdf"
    arm.to_urdf(path)
    assert_same(arm, dp.load(path))
    # the source uncompiled: that kernels compute the same is tested elsewhere
    report = dp.validate(str(path), samples=30, seed=1, engine="numpy")
    assert report.passed, report


def test_a_cylindrical_joint_is_split_and_keeps_its_coordinates(seed: int) -> None:
    body = {"mass": 1.0, "com": (0.1, 0, 0), "inertia": np.eye(3)}
    arm = dp.from_dh([(0.1, 0.2, 0.3, 0.4), (0.5, 0.6, 0.7, 0.8)], "CC", inertias=[body, body])
    with pytest.warns(dp.DualpinWarning, match="'joint_1' is split into 'joint_1' .angle. and 'joint_1_slide'"):
        text = arm.to_urdf()
    twin = loads(text)
    assert twin.joint_names == ["joint_1", "joint_1_slide", "joint_2", "joint_2_slide"]
    q, v, a = np.random.default_rng(seed).uniform(-1, 1, (3, 8, 4))
    assert np.abs(dp.rnea(twin, q, v, a) - dp.rnea(arm, q, v, a)).max() <= 1e-13
    assert np.abs(dp.fk(twin, q, "tool") - dp.fk(arm, q, "tool")).max() <= 1e-14


def test_what_urdf_cannot_hold_is_announced() -> None:
    arm = dp.from_dh([(0, 0, 0, 0)], "P", gravity=(0, 0, -1.62))
    with pytest.warns(dp.DualpinWarning) as caught:
        arm.to_urdf()
    message = str(caught[0].message)
    assert "gravity (0.0, 0.0, -1.62) is not in the file" in message
    assert "'joint_1' has no limits, URDF demands them: -1 ... 1 m" in message
    with pytest.warns(dp.DualpinWarning, match="read it with floating=True"):
        dp.load("ur5", floating=True).to_urdf()


def test_joints_that_readers_would_reorder_are_announced() -> None:
    b = Builder("y")
    b.base("root")
    b.joint("z", revolute(), "root")
    b.joint("a", revolute(), "root")
    with pytest.warns(dp.DualpinWarning, match="q will be a, z"):
        b.robot().to_urdf()


def test_a_robot_without_a_base_link_and_with_plain_frames_is_written() -> None:
    b = Builder("pendulum")
    b.joint("hinge", revolute(), placement=Pose(position=Vector3(0.1, 0.2, 0.3)))
    b.frame("tip", on="hinge", placement=Pose(position=Vector3(1.0, 0.0, 0.0)))
    robot = b.robot()
    twin = reread(robot)
    q = [[0.4]]
    assert np.abs(dp.fk(twin, q, "tip") - dp.fk(robot, q, "tip")).max() <= 1e-15


def test_the_file_is_written_or_the_reason_is_told(tmp_path: Path) -> None:
    arm = dp.from_dh([(0, 0, 0.5, 0)], "R")
    text = arm.to_urdf(tmp_path / "arm.urdf")
    assert (tmp_path / "arm.urdf").read_text(encoding="utf-8") == text
    with pytest.raises(dp.UrdfError, match="cannot be written"):
        arm.to_urdf(tmp_path / "no" / "arm.urdf")
    with pytest.raises(dp.ArgumentError, match="control characters"):
        dp.from_dh([(0, 0, 0.5, 0)], "R", name="a\x1bb").to_urdf()


def test_line_breaks_in_names_come_back(tmp_path: Path) -> None:
    name = "a\nb\r\tc <&>\"'"
    arm = dp.from_dh([(0, 0, 0.5, 0)], "R", name=name)
    text = arm.to_urdf(tmp_path / "a.urdf")
    assert dp.loads(text).name == dp.load(tmp_path / "a.urdf").name == name


def test_roll_pitch_yaw_is_exact_also_at_90_degrees_of_pitch(seed: int) -> None:
    rng = np.random.default_rng(seed)

    def rpy(r: float, p: float, y: float) -> np.ndarray:
        (cr, cp, cy), (sr, sp, sy) = np.cos([r, p, y]), np.sin([r, p, y])
        Rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
        Ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
        return np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ Ry @ Rx

    for near in (1.0, 1e-3, 1e-8, 1e-12, 1e-16, 0.0):
        for sign in (-1, 1):
            R = rpy(rng.uniform(-3, 3), sign * (np.pi / 2 - near), rng.uniform(-3, 3))
            assert np.abs(rpy(*roll_pitch_yaw(R)) - R).max() <= 1e-15


def test_point_masses_are_written_with_zeros(seed: int) -> None:
    """What is left of Steiner's terms is rounding, and a reader would find it indefinite."""
    rng = np.random.default_rng(seed)
    masses, centres = 10.0 ** rng.uniform(-3, 4, 6), rng.uniform(-2, 2, (6, 3))
    points = [{"mass": float(m), "com": c} for m, c in zip(masses, centres, strict=True)]
    arm = dp.from_dh(rng.uniform(-1, 1, (6, 4)), inertias=points)
    text = arm.to_urdf()
    assert text.count('ixx="0.0" ixy="0.0" ixz="0.0" iyy="0.0" iyz="0.0" izz="0.0"') == 6
    assert not [n for n in dp.loads(text).notes if "eigenvalues" in n or "triangle" in n]


@pytest.mark.parametrize(
    ("limits", "written", "said"),
    [
        (Limits((-inf,), (inf,)), 'type="continuous"', None),
        (Limits((-1.0,), (inf,)), 'lower="-1.0" upper="1000000000.0"', None),
        (Limits((-inf,), (2.0,), 3.0, 4.0), 'lower="-1000000000.0" upper="2.0" effort="4.0" velocity="3.0"', None),
        (Limits((-1e30,), (1e30,)), 'lower="-1e+30" upper="1e+30"', None),
        (Limits((-1.0,), (1.0,), -2.0, 3.0), 'velocity="2.0"', "velocity limit -2 of joint 'j' is negative"),
        (Limits((-1.0,), (1.0,), 2.0, -3.0), 'effort="3.0"', "effort limit -3 of joint 'j' is negative"),
        (Limits((1.0,), (-1.0,)), 'lower="1.0" upper="-1.0"', None),
    ],
)
def test_pinocchio_reads_what_is_written_of_odd_limits(
    limits: Limits, written: str, said: str | None, tmp_path
) -> None:
    pin = pytest.importorskip("pinocchio")
    b = Builder("r")
    b.base("ground")
    b.joint("j", revolute(), "ground", limits=limits)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        text = b.robot().to_urdf(tmp_path / "r.urdf")
    assert written in text
    assert (said is None and caught == []) or said in str(caught[0].message)
    assert list(pin.buildModelFromUrdf(str(tmp_path / "r.urdf")).names) == ["universe", "j"]
