"""Products of exponentials, by their definition and against the robot they came from."""

from __future__ import annotations

import re
import types

import numpy as np
import pytest
from scipy.linalg import expm

import dualpin as dp
from dualpin.spatial import exp, to_matrix

TOLERANCE = 1e-12


def hat(S: np.ndarray) -> np.ndarray:
    w, v = S[:3], S[3:]
    return np.array([[0, -w[2], w[1], v[0]], [w[2], 0, -w[0], v[1]], [-w[1], w[0], 0, v[2]], [0, 0, 0, 0]])


@pytest.fixture(scope="module")
def mixed() -> dp.Robot:
    rows = np.random.default_rng(3).uniform(-1, 1, (5, 4))
    body = {"mass": 1.5, "com": (0.1, -0.2, 0.05), "inertia": np.diag([0.3, 0.4, 0.5])}
    return dp.from_dh(rows, ["R", "P", "C", ("H", 0.3), "R"], inertias=[body] * 5, tool=dp.Dual(0.3, 0.1))


@pytest.mark.parametrize("frame", ["space", "body"])
def test_fk_is_the_product_of_matrix_exponentials(mixed: dp.Robot, frame: str) -> None:
    poe = dp.to_screws(mixed, frame=frame)
    assert poe.screws.shape == (6, 6)
    for q in np.random.default_rng(0).uniform(-2, 2, (5, mixed.nq)):
        E = [expm(hat(S) * q[i]) for S, i in zip(poe.screws, poe.columns, strict=True)]
        T = np.linalg.multi_dot([*E, poe.home] if frame == "space" else [poe.home, *E])
        assert np.abs(poe.fk(q) - T).max() <= TOLERANCE  # expm itself is good to some 1e-14
        assert np.abs(dp.fk(mixed, q, "tool") - T).max() <= TOLERANCE


@pytest.mark.parametrize(("frame", "reference"), [("space", "world"), ("body", "local")])
def test_the_jacobian_is_the_robots(frame: str, reference: str) -> None:
    robot = dp.load("panda")
    q = robot.sample(4, seed=0)[0]
    poe = dp.to_screws(robot, "panda_hand", frame)
    assert poe.jacobian(q).shape == (4, 6, 9)
    assert np.abs(poe.jacobian(q) - dp.jacobian(robot, q, "panda_hand", reference)).max() <= TOLERANCE


def test_followers_share_a_coordinate_of_the_whole_robot() -> None:
    robot = dp.load("panda", mimic=True)
    q = robot.sample(4, seed=0)[0]
    tip = "panda_rightfinger"
    poe = dp.to_screws(robot, tip)
    assert poe.columns[-1] == robot.joint("panda_finger_joint1").q.start
    assert np.abs(poe.fk(q) - dp.fk(robot, q, tip)).max() <= TOLERANCE
    assert np.abs(poe.jacobian(q) - dp.jacobian(robot, q, tip)).max() <= TOLERANCE


def test_a_tree_has_one_space_screw_for_each_freedom() -> None:
    robot = dp.load("allegro_left")
    tree = dp.to_screws(robot)
    assert list(tree) == list(tree.home) and len(tree) == 4
    assert tree.joint_names == tuple(robot.joint_names)
    q = robot.sample(3, seed=1)[0]
    for tip in tree:
        assert np.abs(tree.fk(q, tip) - dp.fk(robot, q, tip)).max() <= TOLERANCE
        assert np.abs(tree.jacobian(q, tip) - dp.jacobian(robot, q, tip)).max() <= TOLERANCE
        columns = [tree.joint_names.index(name) for name in tree[tip].joint_names]
        assert np.array_equal(tree.screws[columns].T, tree[tip].Slist)
    inner = robot.links[2].name
    assert np.abs(tree[inner].fk(q) - dp.fk(robot, q, inner)).max() <= TOLERANCE


@pytest.mark.parametrize("frame", ["space", "body"])
def test_the_arrays_of_modern_robotics_rebuild_the_robot(mixed: dp.Robot, frame: str) -> None:
    poe = dp.to_screws(mixed, frame=frame)
    assert np.allclose(np.linalg.multi_dot(list(poe.Mlist)), poe.M, rtol=0, atol=1e-14)
    for G in poe.Glist:
        assert np.array_equal(G[3:, :3], np.zeros((3, 3)))
    twin = dp.from_screws(poe.home, poe.screws, frame, poe.Mlist, poe.Glist)
    q, v, a = np.random.default_rng(1).uniform(-1, 1, (3, 6, mixed.nv))
    assert np.abs(dp.fk(twin, q, "tool") - dp.fk(mixed, q, "tool")).max() <= TOLERANCE
    for term in (dp.rnea, dp.aba):
        assert np.allclose(term(twin, q, v, a), term(mixed, q, v, a), rtol=1e-11, atol=1e-11)
    assert [j.kind for j in twin] == ["revolute", "prismatic", "revolute", "prismatic", "helical", "revolute"]


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_columns_are_taken_for_one_version_more(name: str) -> None:
    """Six joints, whose array is square, included."""
    poe = dp.to_screws(dp.load(name), "panda_hand" if name == "panda" else "tool0")
    arm = dp.from_screws(poe.home, poe.screws)
    with pytest.warns(DeprecationWarning, match="rows"):
        same = dp.from_screws(poe.home, poe.Slist)
    q = np.random.default_rng(0).uniform(-2, 2, (5, arm.nq))
    assert np.array_equal(dp.fk(arm, q, "tool"), dp.fk(same, q, "tool"))
    assert np.abs(dp.fk(arm, q, "tool") - poe.fk(np.pad(q, ((0, 0), (0, poe.chain.robot.nq - arm.nq))))).max() < 1e-14
    with pytest.raises(dp.ShapeError, match=r"\(n, 6\)"):
        dp.from_screws(poe.home, np.ones((5, 4)))


def test_a_planar_joint_is_two_slides_and_a_turn() -> None:
    from dualpin.model import Builder
    from dualpin.model.joints import Planar, revolute
    from dualpin.spatial import Pose, Vector3

    b = Builder("cart")
    b.base("floor")
    b.joint("cart", Planar(), "floor", Pose(position=Vector3(0.1, 0.2, 0.3)), link="body")
    b.joint("arm", revolute(), "body", Pose(position=Vector3(0.5, 0.0, 0.1)), link="tip")
    robot = b.robot()
    q = np.random.default_rng(0).uniform(-1, 1, (4, 4))
    T = dp.fk(robot, q, "tip")
    poe = dp.to_screws(robot)
    assert poe.joint_names == ("cart", "cart", "cart", "arm")
    assert np.abs(poe.fk(q) - T).max() <= TOLERANCE
    for convention in ("standard", "modified"):
        dh = dp.to_dh(robot, convention=convention)
        assert [r.letter for r in dh.rows] == ["P", "P", "R", "R"]
        assert np.abs(dh.fk(q) - T).max() <= TOLERANCE
    back = dp.to_dh(robot, base="tip", tip="floor")
    assert np.abs(back.fk(q) - np.linalg.inv(T)).max() <= TOLERANCE
    with pytest.raises(dp.ArgumentError, match="planar joint 'cart' are not the rates"):
        poe.jacobian(q)


def test_a_chain_that_runs_upwards_has_screws_but_no_inertias() -> None:
    poe = dp.to_screws(dp.load("ur5"), "base_link", base="tool0")
    assert poe.residual <= TOLERANCE
    with pytest.raises(dp.ArgumentError, match="from child to parent"):
        poe.Glist
    assert "Blist" in poe.export("python") and "Glist" not in poe.export("python") + poe.export("matlab")


def test_screws_are_exported_in_full_and_as_code() -> None:
    import json

    poe = dp.to_screws(dp.load("ur5"), "tool0")
    data = json.loads(poe.export("json"))
    assert np.array_equal(data["home"], poe.home)
    assert np.array_equal([s["screw"] for s in data["screws"]], poe.Slist.T)
    scope: dict = {}
    exec(poe.export("python"), scope)
    for name in ("M", "Slist", "Blist", "Mlist", "Glist"):
        assert np.array_equal(scope[name], getattr(poe, name)), name
    lines = poe.export("csv").splitlines()
    assert lines[0] == "joint,wx,wy,wz,vx,vy,vz" and len(lines) == 11
    assert poe.export("matlab").count("Glist(:, :,") == 6
    in_degrees = json.loads(poe.export("json", degrees=True))
    assert np.allclose([s["screw"] for s in in_degrees["screws"]], poe.Slist.T * np.pi / 180)
    for format in ("table", "markdown", "latex", "yaml"):
        assert "wrist_3" in poe.export(format, digits=3).replace("\\", "")
    first = next(x for x in poe.export().splitlines() if x.split()[:1] == [poe.joint_names[1]]).split()[1:]
    assert np.allclose([float(x) for x in first], poe.screws[1], atol=1e-3)  # of the six, one a row
    assert [x.split(",")[1:] for x in lines[1:7]] == [[repr(float(v) + 0.0) for v in s] for s in poe.Slist.T]
    tree = dp.to_screws(dp.load("allegro_left"))
    assert set(json.loads(tree.export("json"))) == set(tree)
    assert isinstance(types.SimpleNamespace(t=tree.export()).t, str)
    with pytest.raises(dp.ArgumentError, match="choose a tip"):
        tree.export("python")


@pytest.mark.parametrize("frame", ["space", "body"])
@pytest.mark.parametrize("name", ["ur5", "panda", "ur10"])
def test_screws_of_six_decimals_are_those_of_revolute_joints(name: str, frame: str, seed: int) -> None:
    """Rounding leaves w . v at 1e-7: no pitch of a screw, but the input's own precision."""
    turn = exp(np.r_[0.3, -0.5, 0.7, 0.1, 0.2, -0.3])  # otherwise axes are those of the base, and zeros exact
    poe = dp.to_screws(dp.load(name), frame=frame, tip="panda_link8" if name == "panda" else "tool0")
    T = to_matrix(turn)
    R, p = T[:3, :3], T[:3, 3]
    skew = np.array([[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]])
    adjoint = np.block([[R, np.zeros((3, 3))], [skew @ R, R]])
    S, home = (poe.screws @ adjoint.T, T @ poe.home) if frame == "space" else (poe.screws, poe.home)
    arm = dp.from_screws(home, S.round(6), frame)
    pitches = np.abs((S.round(6)[:, :3] * S.round(6)[:, 3:]).sum(1))
    assert {j.kind for j in arm} == {"revolute"}
    assert (pitches.max() > 1e-12) == any("pitches within the precision" in n for n in arm.notes)
    exact, q = dp.from_screws(home, S, frame), np.random.default_rng(seed).uniform(-3, 3, (50, arm.nq))
    # each rounded number moves the tip by half of its last digit, times lengths below 2 m
    assert np.abs(dp.fk(arm, q, "tool", engine="numpy") - dp.fk(exact, q, "tool", engine="numpy")).max() < 3e-5


def test_a_pitch_that_the_numbers_state_stays() -> None:
    """Of any number of decimals: it is larger than half of the last."""
    w = np.array([0.0, 0.6, 0.8])
    for pitch in (0.1, 1e-3, 1.5e-4, 2.5e-5, 3e-6, 1 / 3):
        moment = np.cross([0.2, 0.1, -0.3], w)
        for S in (np.r_[0, 0, 1, 0, 0, pitch], np.r_[w, moment + pitch * w]):
            (joint,) = dp.from_screws(np.eye(4), S[None])
            assert joint.kind == "helical" and not dp.from_screws(np.eye(4), S[None]).notes


@pytest.mark.parametrize("frame", ["space", "body"])
def test_what_people_see_is_a_row_for_each_joint(frame):
    """Also of six joints, where rows and columns cannot be told apart by their number."""
    found = dp.to_screws(dp.load("ur5"), tip="tool0", frame=frame)
    lines = found.export("table").splitlines()[4:10]
    shown = np.array([[float(x) for x in row.split()[1:]] for row in lines])
    assert [row.split()[0] for row in lines] == list(found.joint_names)
    assert np.abs(shown - found.screws).max() < 1e-6
    cells = re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]>", found._repr_html_())
    first = cells.index(found.joint_names[0])
    assert [float(x) for x in cells[first + 1 : first + 7]] == pytest.approx(found.screws[0], abs=1e-6)
