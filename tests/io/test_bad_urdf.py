"""Odd, broken and hostile files: each gets its error, its warning, or is read rightly."""

from __future__ import annotations

import re
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.io import joints, xml

from .bad_urdfs import CASES, GOOD, Case

by_name = pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)


def written(folder: Path, data: bytes | str) -> Path:
    path = folder / "robot.urdf"
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return path


@by_name
def test_every_bad_file_gets_its_verdict(case: Case, tmp_path):
    path = written(tmp_path, case.data)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        if case.verdict == "error":
            with pytest.raises(dp.UrdfError) as refused:
                dp.load(path)
            message = str(refused.value)
            assert message.startswith(f"robot.urdf:{case.line}: " if case.line else "robot.urdf:"), message
            assert [w for w in case.words if w not in message] == [], message
            assert len(message) < 600
            return
        robot = dp.load(path)
    said = [str(w.message) for w in caught if issubclass(w.category, dp.DualpinWarning)]
    assert [w for w in caught if not issubclass(w.category, dp.DualpinWarning)] == []
    if case.verdict == "accept":
        assert said == []
    else:
        (text,) = said
        assert [w for w in case.words if w not in text] == [], text
        assert "; ".join(robot.notes) in text
    assert robot.joint_names == ["shoulder", "wrist"]
    assert np.allclose(dp.fk(robot, np.zeros(robot.nq), engine="numpy")[0, :3, 3], [0, 0, 0.5])


def test_the_first_of_several_elements_is_used(tmp_path):
    twice = GOOD.replace('<mass value="1.0"/>', '<mass value="1.0"/><mass value="7"/>')
    twice = twice.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><axis xyz="1 0 0"/>')
    robot = dp.load(written(tmp_path, twice))
    plain = dp.load(written(tmp_path, GOOD))
    q, v, a = plain.sample(seed=0)
    assert (dp.rnea(robot, q, v, a, engine="numpy") == dp.rnea(plain, q, v, a, engine="numpy")).all()
    assert len(robot.notes) == 2


def test_a_link_and_a_joint_may_share_a_name(tmp_path):
    robot = dp.load(written(tmp_path, GOOD.replace('"hand"', '"shoulder"')))
    q = np.array([0.0, 0.1])
    link = dp.fk(robot, q, "shoulder", engine="numpy")
    assert np.allclose(link, dp.fk(robot, q, engine="numpy")[1])  # the link of that name, carried by the wrist
    assert robot.joint("shoulder").kind == "revolute"


def test_huge_axes_are_directions_too(tmp_path):
    for text in ("0 1e200 0", "0 1e-5 0"):
        robot = dp.load(written(tmp_path, GOOD.replace('<axis xyz="0 1 0"/>', f'<axis xyz="{text}"/>')))
        J = dp.jacobian(robot, [0, 0], "hand", engine="numpy")
        assert np.allclose(J[:3, 0], [0, 1, 0])


@pytest.mark.parametrize("inner", ["SYSTEM 'file:///etc/hostname'", "'<link name=\"injected\"/>'"])
def test_entities_inject_nothing(inner, tmp_path):
    text = f"<!DOCTYPE robot [<!ENTITY x {inner}>]><robot name='r'><link name='l'/>&x;</robot>"
    with pytest.raises(dp.UrdfError, match="DOCTYPE"):
        dp.load(written(tmp_path, text))


def test_laughter_is_refused_at_once(tmp_path):
    for case in CASES:
        if "laughs" in case.name:
            start = time.process_time()
            with pytest.raises(dp.UrdfError):
                dp.load(written(tmp_path, case.data))
            assert time.process_time() - start < 2  # 2 GB of text if it were expanded


def test_files_beyond_the_cap_are_not_read(tmp_path, monkeypatch):
    path = written(tmp_path, GOOD + " " * 3_000_000)
    assert dp.load(path).nq == 2
    monkeypatch.setattr(xml, "MAX_BYTES", 1 << 20)
    with pytest.raises(dp.UrdfError, match=r"robot.urdf: 2 MiB; files up to 1 MiB are read"):
        dp.load(path)


def test_robots_beyond_the_cap_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(joints, "MAX_JOINTS", 1)
    with pytest.raises(dp.UrdfError, match="more than 1 joints"):
        dp.load(written(tmp_path, GOOD))


def chain(n: int, kind: str = "continuous") -> str:
    links = "".join(f'<link name="l{i}"/>' for i in range(n + 1))
    joints = "".join(
        f'<joint name="j{i}" type="{kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="0.001 0 0"/><axis xyz="0 0 1"/></joint>'
        for i in range(n)
    )
    return f'<robot name="chain">{links}{joints}</robot>'


@pytest.mark.parametrize("n", [2_000, pytest.param(20_000, marks=pytest.mark.campaign)])
def test_a_chain_of_thousands_of_joints_works(tmp_path, n):
    start = time.process_time()
    robot = dp.load(written(tmp_path, chain(n)))
    assert robot.nv == n
    assert f"{n} joints" in repr(robot)
    tip = dp.fk(robot, np.zeros(n), f"l{n}", engine="numpy")
    assert abs(tip[0, 3] - n / 1000) < 1e-9
    tau = dp.rnea(robot, np.zeros(n), np.zeros(n), np.zeros(n), engine="numpy")
    assert (tau == 0).all()
    assert time.process_time() - start < 60  # of the processor, some 10 for 20 000; no recursion, nothing quadratic


def test_long_rows_of_fixed_joints_and_of_siblings(tmp_path):
    robot = dp.load(written(tmp_path, chain(2000, "fixed")))
    assert robot.nv == 0 and len(robot.frames) == 4_002
    star = re.sub(r'parent link="l\d+"', 'parent link="l0"', chain(2000))
    robot = dp.load(written(tmp_path, star))
    assert robot.nv == 2000
    assert robot.joint_names == sorted(robot.joint_names)  # siblings by name


@pytest.mark.parametrize(
    ("tag", "match"),
    [
        ('<mimic joint="nobody"/>', r"'wrist' mimics 'nobody'.*joints: shoulder"),
        ('<mimic joint="wrist"/>', "circle"),
    ],
)
def test_mimics_that_cannot_be_followed_are_refused_only_where_asked_for(tag, match, tmp_path):
    limit = '<limit lower="0" upper="0.2" effort="10" velocity="2"/>'
    path = written(tmp_path, GOOD.replace(limit, limit + tag))
    assert dp.load(path).nv == 2
    with pytest.raises(dp.UrdfError, match=r"robot.urdf:24: .*" + match):
        dp.load(path, mimic=True)


def test_mimic_chains_follow_to_the_end(tmp_path):
    text = chain(3).replace('<axis xyz="0 0 1"/></joint>', '<axis xyz="0 0 1"/><m/></joint>')
    for tag in (
        "<none/>",
        '<mimic joint="j0" multiplier="2" offset="0.5"/>',
        '<mimic joint="j1" multiplier="-3" offset="1"/>',
    ):
        text = text.replace("<m/>", tag, 1)
    robot = dp.load(written(tmp_path, text), mimic=True)
    assert (robot.nq, robot.nv) == (1, 1)
    q = 0.3
    angle = q + (2 * q + 0.5) + (-3 * (2 * q + 0.5) + 1)
    T = dp.fk(robot, [q], "l3", engine="numpy")
    assert np.allclose(T[:2, 0], [np.cos(angle), np.sin(angle)])
    assert np.allclose(dp.jacobian(robot, [q], "l3", engine="numpy")[2], 1 + 2 - 6)


def test_mimic_tags_on_fixed_joints_are_ignored(tmp_path):
    text = chain(1).replace('type="continuous"', 'type="fixed"').replace("<axis", '<mimic joint="j0"/><axis')
    assert dp.load(written(tmp_path, text), mimic=True).nv == 0


# --- names and paths -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "match"),
    [
        ("no_such_robot_anywhere", "neither a file nor a robot|no file"),
        ("missing.urdf", "no such file"),
        ("missing.xacro", "no such file"),
        ("", "name is empty"),
        (".", "folder"),
        ("x" * 5000, "not a path|neither"),
        ("a\0b", "not a path|neither|null"),
        ("~no_such_user_at_all/robot.urdf", "not a path|no such file"),
        ("/dev/null", "not a regular file"),
    ],
)
def test_names_that_lead_nowhere(name, match):
    with pytest.raises(dp.UrdfError, match=match):
        dp.load(name)


def test_a_folder_is_not_a_robot(tmp_path):
    with pytest.raises(dp.UrdfError, match="folder"):
        dp.load(tmp_path)


@pytest.mark.parametrize("thing", [None, 3, b"panda", ["panda"], object()])
def test_what_is_no_name_is_refused(thing):
    with pytest.raises(dp.DualpinError, match="name or a path"):
        dp.load(thing)


def test_near_misses_are_offered():
    if not dp.io.catalogue():
        pytest.skip("example-robot-data is not installed")
    with pytest.raises(dp.UrdfError, match="did you mean 'panda'"):
        dp.load("pandaa")


def test_a_frame_that_is_not_there_offers_the_nearest(tmp_path):
    robot = dp.load(written(tmp_path, GOOD))
    with pytest.raises(dp.FrameNotFoundError, match="frame 'hnd' not in two; did you mean 'hand'"):
        dp.fk(robot, [0, 0], "hnd")
