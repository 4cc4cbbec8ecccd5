"""What cannot be right is refused, with what was expected and the nearest valid choice."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.errors import ArgumentError, DualpinError, FrameNotFoundError, ShapeError

ROW = (0.0, 0.1, 0.2, 0.3)
BODY = {"mass": 1.0, "com": (0, 0, 0), "inertia": np.eye(3)}


def test_unknown_links_come_with_the_nearest_name() -> None:
    robot = dp.load("ur5")
    with pytest.raises(FrameNotFoundError, match="did you mean 'tool0'"):
        dp.to_dh(robot, tip="tol0")
    with pytest.raises(FrameNotFoundError, match="did you mean 'base_link'"):
        dp.to_screws(robot, tip="tool0", base="base_lnk")
    with pytest.raises(FrameNotFoundError, match="tips: "):
        dp.to_dh(robot, convention="khalil-kleinfinger").fk(np.zeros(6), "tolo0")
    with pytest.raises(FrameNotFoundError, match="tips: "):
        dp.to_screws(robot)["tolo0"]


def test_a_branched_robot_lists_its_leaves() -> None:
    with pytest.raises(
        ArgumentError, match=r"branches and ends in 4 links; choose one with tip=. leaves: link_[0-9.]+_tip, "
    ):
        dp.to_dh(dp.load("allegro_left"))


def test_a_floating_joint_says_why_it_has_no_axes() -> None:
    robot = dp.load("ur5", floating=True)
    for form in (dp.to_dh, dp.to_screws):
        with pytest.raises(ArgumentError, match="'root_joint' is floating: its 6 freedoms have no axes fixed"):
            form(robot, base="universe", tip="tool0")


def test_conventions_frames_and_formats_offer_the_known_ones() -> None:
    robot = dp.load("ur5")
    for convention in ("craig", "Standard", None):
        with pytest.raises(ArgumentError, match="modified"):
            dp.to_dh(robot, tip="tool0", convention=convention)
    with pytest.raises(ArgumentError, match="space, body"):
        dp.to_screws(robot, "tool0", "spatial")
    with pytest.raises(ArgumentError, match="did you mean 'markdown'"):
        dp.to_dh(robot, tip="tool0").export("markdwn")
    with pytest.raises(ArgumentError, match="1 to 17"):
        dp.to_dh(robot, tip="tool0").table(digits=0)
    with pytest.raises(ArgumentError, match="base and tip are not taken"):
        dp.to_dh(robot, tip="tool0", convention="khalil-kleinfinger")


def test_a_name_in_place_of_a_robot_is_told_how_to_load_it() -> None:
    for call in (dp.to_dh, dp.to_screws):
        with pytest.raises(ArgumentError, match=r"dualpin.load\('ur5'\)"):
            call("ur5")


@pytest.mark.parametrize("snap", [-1e-3, 0.5, float("nan"), "1e-3", (1e-3, 2.0)])
def test_snap_is_a_small_number(snap: object) -> None:
    with pytest.raises(ArgumentError, match="snap"):
        dp.to_dh(dp.load("ur5"), tip="tool0", snap=snap)


def test_q_is_of_the_whole_robot() -> None:
    robot = dp.load("panda")
    dh = dp.to_dh(robot, tip="panda_hand")
    with pytest.raises(ShapeError, match=r"\(\.\.\., 9\) expected, the coordinates of all of panda; got \(7,\)"):
        dh.fk(np.zeros(7))
    with pytest.raises(ShapeError, match="got"):
        dp.to_screws(robot, "panda_hand").jacobian(0.0)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([(1, 2, 3)], r"shape \(n, 4\) expected, theta, d, a, alpha each; got \(1, 3\)"),
        ([1, 2, 3, 4], r"got \(4,\)"),
        ([[ROW]], r"got \(1, 1, 4\)"),
        ([ROW, (1, 2, 3)], "not an array"),
        ([("a", 0, 0, 0)], "real numbers expected"),
        ([(1j, 0, 0, 0)], "real numbers expected"),
        ([ROW, (0, float("nan"), 0, 0)], "d of row 2 is nan"),
        ([(0, 0, 0, float("inf"))], "alpha of row 1 is inf"),
    ],
)
def test_rows_are_four_finite_numbers(rows: list, message: str) -> None:
    with pytest.raises(DualpinError, match=message):
        dp.from_dh(rows)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ("RR", "1 rows but 2 joints"),
        ("X", "joint 1 is 'X'; one of R .revolute., P"),
        ("H", "needs its pitch"),
        ([("H", float("nan"))], "needs its pitch"),
        ([("R", 0.1)], "only a helical joint has a pitch"),
        ([3], "joint 1 is 3"),
    ],
)
def test_joints_are_letters_one_a_row(joints: object, message: str) -> None:
    with pytest.raises(ArgumentError, match=message):
        dp.from_dh([ROW], joints)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"convention": "modifed"}, "did you mean 'modified'"),
        ({"base": np.eye(3)}, r"base of shape \(4, 4\) expected"),
        ({"tool": 2 * np.eye(4)}, "tool: a rotation"),
        ({"tool": np.full((4, 4), np.nan)}, "finite"),
        ({"inertias": []}, "1 rows but 0 inertias"),
        ({"inertias": [3]}, "dict"),
        ({"inertias": [{"com": (0, 0, 0)}]}, "has no mass"),
        ({"inertias": [{**BODY, "masses": 2}]}, "did you mean 'mass'"),
        ({"inertias": [{**BODY, "mass": -1}]}, "mass is -1 kg"),
        ({"inertias": [{**BODY, "com": (0, 0)}]}, r"com of shape \(3,\) expected"),
        ({"inertias": [{**BODY, "inertia": [[1, 2, 0], [0, 1, 0], [0, 0, 1]]}]}, "not symmetric"),
        ({"inertias": [{**BODY, "inertia": np.full((3, 3), np.inf)}]}, "finite"),
        ({"limits": [(1, -1)]}, "lower, upper"),
        ({"limits": []}, "1 rows but 0 limits"),
    ],
)
def test_the_other_arguments_of_from_dh_are_checked(given: dict, message: str) -> None:
    with pytest.raises(DualpinError, match=message):
        dp.from_dh([ROW], "R", **given)


@pytest.mark.parametrize(
    ("screws", "more", "message"),
    [
        (np.zeros((1, 5)), {}, r"shape \(n, 6\) expected"),
        (np.zeros((1, 6)), {}, "screw 1 has"),
        (np.array([[0, 0, 2, 0, 0, 0.0]]), {}, "screw 1 has .w. = 2"),
        (np.array([[0, 0, np.nan, 0, 0, 0.0]]), {}, "not finite"),
        (np.array([[0, 0, 1, 0, 0, 0.0]]), {"frame": "tool"}, "space, body"),
        (np.array([[0, 0, 1, 0, 0, 0.0]]), {"Mlist": [np.eye(4)]}, "go together"),
        (np.array([[0, 0, 1, 0, 0, 0.0]]), {"Mlist": [np.eye(4)], "Glist": np.eye(6)}, "Glist of shape"),
        (
            np.array([[0, 0, 1, 0, 0, 0.0]]),
            {"Mlist": [np.eye(4)], "Glist": [np.diag([1, 2, 3, 4, 4, 5.0])]},
            "not a spatial inertia",
        ),
    ],
)
def test_screws_are_unit_and_inertias_spatial(screws: np.ndarray, more: dict, message: str) -> None:
    with pytest.raises(DualpinError, match=message):
        dp.from_screws(np.eye(4), screws, **more)


def test_a_helical_joint_is_refused_where_no_format_has_it() -> None:
    arm = dp.from_dh([ROW], [("H", 0.1)])
    with pytest.raises(ArgumentError, match="helical, and URDF has no such joint"):
        arm.to_urdf()
    with pytest.raises(ArgumentError, match="Robotics Toolbox has not"):
        dp.to_dh(arm).export("python")


@pytest.mark.parametrize(
    ("rows", "joints"), [(None, "R"), (5, "R"), ("abc", "R"), ([(0, 0, 1, 0)], 5), ([(0, 0, 1, 0)], [["H"]])]
)
def test_rows_and_joints_of_other_types(rows, joints):
    with pytest.raises(DualpinError, match=r"from_dh: (rows|joint)"):
        dp.from_dh(rows, joints=joints)


def test_a_helical_joint_may_be_a_list():
    rows = [(0.1, 0.2, 0.3, 0.4)]
    one, other = (dp.from_dh(rows, joints=[j]) for j in (("H", 0.05), ["H", 0.05]))
    assert np.array_equal(dp.fk(one, [0.7]), dp.fk(other, [0.7]))


@pytest.mark.parametrize("path", ["no_such_folder/table.csv", None])
def test_files_that_cannot_be_written_are_named(tmp_path, path):
    robot = dp.from_dh([(0, 0, 1, 0), (0, 0, 1, 0.5)], joints="RR")
    for form in (dp.to_dh(robot), dp.to_screws(robot, tip="tool")):
        with pytest.raises(ArgumentError, match="cannot be written"):
            form.to_csv(path if path is None else tmp_path / path)
