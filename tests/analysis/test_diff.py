"""Two robots that are the same are recognised, however they are written; what differs is found, with its numbers."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
from lxml import etree
from typer import testing

import dualpin as dp
from dualpin.cli.main import program
from dualpin.io.write import roll_pitch_yaw

ARM = "ur5"


def run(*words: str):
    return testing.CliRunner().invoke(program(), ["diff", *words])


def tree(name: str = ARM) -> etree._Element:
    """A robot's URDF without what is no mechanics."""
    from dualpin.crosscheck.subjects.asking import mechanics
    from dualpin.io.catalogue import find

    path = find(name)
    return etree.fromstring(mechanics(path.read_bytes(), path.name).encode())


def loads(root: etree._Element) -> dp.Robot:
    return dp.loads(etree.tostring(root, encoding="unicode"), source="changed")


def numbers(e, key: str) -> np.ndarray:
    return np.zeros(3) if e is None or e.get(key) is None else np.array([float(x) for x in e.get(key).split()])


def matrix(e) -> np.ndarray:
    """The pose of an <origin>, by the formula of roll, pitch and yaw."""
    (r, p, y), X = numbers(e, "rpy"), np.eye(4)
    Rx = np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    Ry = np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
    Rz = np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
    X[:3, :3], X[:3, 3] = Rz @ Ry @ Rx, numbers(e, "xyz")
    return X


def set_origin(parent, X: np.ndarray) -> None:
    e = parent.find("origin")
    e = etree.SubElement(parent, "origin") if e is None else e
    e.set("xyz", " ".join(map(repr, X[:3, 3].tolist())))
    e.set("rpy", " ".join(map(repr, roll_pitch_yaw(X[:3, :3]))))


def reframed(root: etree._Element, seed: int) -> etree._Element:
    """Every link described in another frame: turned at random, shifted along its joint's axis."""
    rng = np.random.default_rng(seed)
    frames = {link.get("name"): np.eye(4) for link in root.iter("link")}
    for j in root.iter("joint"):
        X = np.eye(4)
        Q, _ = np.linalg.qr(rng.standard_normal((3, 3)))
        X[:3, :3] = Q * np.sign(np.linalg.det(Q))
        along = (
            rng.standard_normal(3)
            if j.get("type") == "fixed"
            else rng.standard_normal() * numbers(j.find("axis"), "xyz")
        )
        X[:3, 3] = 0.1 * along
        frames[j.find("child").get("link")] = X
    for j in root.iter("joint"):
        P, C = frames[j.find("parent").get("link")], frames[j.find("child").get("link")]
        set_origin(j, np.linalg.inv(P) @ matrix(j.find("origin")) @ C)
        if j.find("axis") is not None:
            j.find("axis").set("xyz", " ".join(map(repr, (C[:3, :3].T @ numbers(j.find("axis"), "xyz")).tolist())))
    for link in root.iter("link"):
        if link.find("inertial") is not None:
            set_origin(
                link.find("inertial"), np.linalg.inv(frames[link.get("name")]) @ matrix(link.find("inertial/origin"))
            )
    return root


def test_a_robot_is_identical_to_itself():
    found = dp.diff(ARM, ARM)
    assert found.identical and found.same and not found.changes
    assert all(t.amount < 1e-15 for t in found.terms.values())


@pytest.mark.parametrize("name", ["ur5", "panda", "solo"])
def test_a_file_against_itself_in_other_frames_is_the_same_robot(name):
    name = {"solo": "solo12"}.get(name, name)
    found = dp.diff(name, loads(reframed(tree(name), seed=1)))
    assert found.verdict == "same robot, other frames", found
    assert {c.what for c in found.changes} == {"re-framed"}
    assert max(t.scaled for t in found.terms.values()) < 1e-12


def test_renamed_joints_and_links_in_another_order_are_matched_by_their_place():
    """Every name is another, and so is the order of siblings."""
    from random import Random

    root = tree("solo12")
    names = [e.get("name") for e in root.iter("joint")]
    new = {n: f"j{i:02d}" for i, n in enumerate(Random(3).sample(names, len(names)))}
    links = {e.get("name"): f"part{i}" for i, e in enumerate(root.iter("link"))}
    for e in root.iter("joint"):
        e.set("name", new[e.get("name")])
        for role in ("parent", "child"):
            e.find(role).set("link", links[e.find(role).get("link")])
    for e in root.iter("link"):
        e.set("name", links[e.get("name")])
    found = dp.diff("solo12", loads(root))
    assert found.verdict == "same robot, other names or order", found
    assert found.joints == {j: new[j] for j in dp.load("solo12").joint_names}
    assert found.terms["rnea"].scaled < 1e-12


def test_merged_fixed_links_are_the_same_body():
    """What dualpin writes of a robot whose links were merged into their joints' bodies."""
    robot = dp.load("panda")
    b = dp.Builder("merged")
    b.base("panda_link0")
    for j in robot:
        link = next(k.name for k in robot.links if k.joint is j)
        on = j.parent and next(k.name for k in robot.links if k.joint is j.parent)
        b.joint(j.name, j.model, on or "panda_link0", j.placement, j.inertia, link=link, limits=j.limits)
    found = dp.diff(robot, b.robot())
    assert found.verdict == "same robot, other frames", found
    assert {c.item for c in found.changes if c.what == "only in a"} >= {"panda_hand", "panda_link8"}


def test_another_place_of_the_base_is_found_and_does_not_hide_the_rest():
    root = tree()
    pan = next(j for j in root.iter("joint") if j.get("name") == "shoulder_pan_joint")
    X = np.eye(4)
    X[:3, 3] = 0.3, 0.2, 0.1
    for j in root.iter("joint"):  # everything on the base link, renamed so that no link name shows where it is
        if j.find("parent").get("link") in ("base_link",):
            set_origin(j, X @ matrix(j.find("origin")))
    for e in root.iter():
        for key in ("name", "link"):
            if e.tag != "joint" and e.get(key):
                e.set(key, f"other_{e.get(key)}")
    assert pan is not None
    found = dp.diff(ARM, loads(root))
    moved = next(c for c in found.changes if c.about == "base")
    assert abs(moved.amount - np.linalg.norm([0.3, 0.2, 0.1])) < 1e-6 and not moved.counts
    assert found.same and found.terms["rnea"].scaled < 1e-9


def test_a_tree_that_stands_on_another_link_is_recognised():
    """The same five bodies on a chain, described from either end."""
    one = chain(["a", "b", "c", "d"])
    other = chain(["d", "c", "b", "a"], back=True)
    found = dp.diff(dp.loads(one), dp.loads(other))
    base = next(c for c in found.changes if c.about == "base")
    assert base.what == "other link" and "'d'" in base.says
    assert found.terms["fk"].amount < 1e-12 and "rnea" not in found.terms
    assert not [c for c in found.changes if c.about == "joint" and c.counts]
    assert not [c for c in found.changes if c.about == "body" and c.counts]


def chain(links: list[str], back: bool = False) -> str:
    """Links 0.5 m apart along x, turning about y; seen from either end."""
    bodies = "".join(
        f'<link name="{n}"><inertial><origin xyz="0.1 0 {0.1 * "abcd".index(n)}"/><mass value="{1 + "abcd".index(n)}"/>'
        '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial></link>' for n in links
    )  # fmt: skip
    joints = ""
    for p, c in pairwise(links):
        name = f"j_{min(p, c)}{max(p, c)}"
        # the axis passes through the frame of the later letter; seen from there, the child's frame has to lie on it
        joints += f'<joint name="{name}" type="continuous"><parent link="{p}"/><child link="{c}"/><axis xyz="0 1 0"/>'
        joints += f'<origin xyz="{-0.5 if back else 0.5} 0 0"/></joint>'
    if back:  # frames of children lie on the axes in both, so those of b..d are shifted by one
        bodies = "".join(
            f'<link name="{n}"><inertial><origin xyz="{0.1 if n == "d" else -0.4} 0 {0.1 * "abcd".index(n)}"/>'
            f'<mass value="{1 + "abcd".index(n)}"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/>'
            "</inertial></link>" for n in links
        )  # fmt: skip
        joints = joints.replace('<origin xyz="-0.5 0 0"/>', '<origin xyz="0 0 0"/>', 1)
    return f'<robot name="chain">{bodies}{joints}</robot>'


def test_a_zero_that_was_moved_and_an_axis_turned_round_are_named():
    root = tree()
    for j in root.iter("joint"):
        if j.get("name") == "elbow_joint":  # q' = q - 0.3
            a, X = 0.3 * numbers(j.find("axis"), "xyz"), np.eye(4)
            from dualpin.spatial import exp, to_matrix

            X = to_matrix(exp(np.concatenate([a, np.zeros(3)])))
            set_origin(j, matrix(j.find("origin")) @ X)
        if j.get("name") == "wrist_1_joint":
            j.find("axis").set("xyz", " ".join(map(repr, (-numbers(j.find("axis"), "xyz")).tolist())))
            low, high = j.find("limit").get("lower"), j.find("limit").get("upper")
            j.find("limit").set("lower", f"-{high}".replace("--", ""))
            j.find("limit").set("upper", f"-{low}".replace("--", ""))
    found = dp.diff(ARM, loads(root))
    kinds = {(c.item, c.what) for c in found.changes if c.about == "joint"}
    assert kinds == {("elbow_joint", "other zero"), ("wrist_1_joint", "turned round")}
    assert abs(next(c for c in found.changes if c.what == "other zero").amount - 0.3) < 1e-9
    # in the coordinates of the first both are the same
    assert max(t.scaled for t in found.terms.values()) < 1e-9


def test_masses_that_no_torque_shows_are_the_same_dynamics():
    """A mass moved along the first, vertical axis: a fixed base feels nothing of it."""
    root = tree()
    link = next(k for k in root.iter("link") if k.get("name") == "shoulder_link")
    origin, mass = link.find("inertial/origin"), link.find("inertial/mass")
    xyz = numbers(origin, "xyz") + np.array([0, 0, 0.05])
    origin.set("xyz", " ".join(map(repr, xyz.tolist())))
    mass.set("value", repr(float(mass.get("value")) + 1.0))
    found = dp.diff(ARM, loads(root))
    assert found.verdict == "same dynamics, other parameters", found
    assert found.same and {c.what for c in found.changes if c.counts} == {"mass", "centre of mass"}


def test_a_changed_mass_is_found_with_the_torque_it_changes_and_the_base_parameters():
    root = tree()
    link = next(k for k in root.iter("link") if k.get("name") == "forearm_link")
    mass = link.find("inertial/mass")
    mass.set("value", repr(float(mass.get("value")) + 0.5))
    other = loads(root)
    found = dp.diff(ARM, other, samples=16, seed=4)
    assert found.verdict == "different" and not found.same
    assert [(c.item, c.what) for c in found.changes if c.counts] == [("elbow_joint", "mass")]
    t = found.terms["gravity"]
    q = np.array(t.state["q"])
    change = np.abs(dp.gravity(dp.load(ARM), q, engine="numpy") - dp.gravity(other, q, engine="numpy")).max()
    assert abs(change - t.amount) < 1e-12 and t.unit == "N m"
    assert found.base_parameters and all(abs(x - y) > 0 for x, y in found.base_parameters.values())


def test_limits_and_kinds_of_joints_are_compared():
    root = tree()
    for j in root.iter("joint"):
        if j.get("name") == "elbow_joint":
            j.find("limit").set("upper", "1.0")
            j.find("dynamics").set("damping", "0.5")
        if j.get("name") == "wrist_3_joint":
            j.set("type", "fixed")
    found = dp.diff(ARM, loads(root))
    assert {(c.what, c.item) for c in found.changes if c.about == "limit"} == {
        ("upper", "elbow_joint"),
        ("damping", "elbow_joint"),
    }
    gone = next(c for c in found.changes if c.item == "wrist_3_joint")
    assert "fixed in b" in gone.says and found.joints["wrist_3_joint"] is None
    assert found.reason == "the joints are not the same" and not found.terms


def test_robots_of_other_formats_are_compared(tmp_path):
    pytest.importorskip("mujoco")
    file = tmp_path / "ur5.xml"
    dp.load(ARM).to_mjcf(file)
    found = dp.diff(ARM, file)
    assert {c.what for c in found.changes if c.counts} <= {"velocity"}, found
    assert max(t.scaled for t in found.terms.values()) < 1e-12


def test_the_command_prints_json_and_a_page_and_exits_as_it_says(tmp_path):
    file = tmp_path / "changed.urdf"
    file.write_text(etree.tostring(reframed(tree(), 2), encoding="unicode"))
    page = tmp_path / "diff.html"

    same = run(ARM, str(file), "--json", "--html", str(page))
    assert same.exit_code == 0, same.output
    assert json.loads(same.stdout)["verdict"] == "same robot, other frames"
    text = page.read_text()
    assert "elbow_joint" in text and "http" not in text.replace("http://www.w3.org/2000/svg", "")
    other = run(ARM, "ur10")
    assert other.exit_code == 1 and "different" in other.stdout
    assert isinstance(run(ARM, str(tmp_path / "none.urdf")).exception, dp.UrdfError)
    assert run(ARM, str(file), "--strict").exit_code == 1


def test_names_of_strangers_are_shown_and_not_run(tmp_path):
    root = tree()
    for e in root.iter("joint"):
        if e.get("name") == "elbow_joint":
            e.set("name", "<script>alert(1)</script>")
    html = dp.diff(ARM, loads(root)).to_html()
    assert "<script>alert" not in html and "&lt;script&gt;alert" in html


def test_what_makes_no_sense_is_an_error():
    with pytest.raises(dp.ArgumentError, match="samples"):
        dp.diff(ARM, ARM, samples=0)
