"""The page of a robot holds what the robot is, loads nothing, and survives odd robots."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest
from lxml import html as lxml_html

import dualpin as dp
from dualpin.errors import ArgumentError
from dualpin.model import Builder, Floating, Planar, cylindrical, prismatic, revolute, spherical
from dualpin.report import page, robot_page
from dualpin.report.skeleton import skeleton
from dualpin.report.voxels import workspace_section
from tests.program import run
from tests.random_robots import tree

pytest.importorskip("jinja2")


def parsed(text):
    return lxml_html.fromstring(text)


@pytest.fixture(scope="module")
def ur5():
    return dp.load("ur5")


@pytest.fixture(scope="module")
def sheet(ur5):
    return robot_page(ur5, "tool0", samples=2, reach=20_000)


def cells(text, section):
    rows = parsed(text).xpath(f"//section[h2='{section}']//table/tbody/tr")
    return [[c.text_content() for c in row.xpath("th|td")] for row in rows]


def test_it_has_every_part_and_loads_nothing(sheet):
    tree_ = parsed(sheet)
    parts = ["Robot", "Joints and limits", "Masses", "Denavit-Hartenberg and screws", "Findings", "Base parameters",
             "Torques under gravity", "Workspace", "Validation"]  # fmt: skip
    heads = tree_.xpath("//h2/text()")
    assert [p for p in parts if p not in heads] == []
    assert not tree_.xpath("//script[@src] | //img | //iframe | //link[@rel='stylesheet']")
    assert [x for x in tree_.xpath("//@href") if not x.startswith(("#", "data:"))] == []
    ids = tree_.xpath("//@id")
    assert len(ids) == len(set(ids))


def test_its_figures_are_the_robots(ur5, sheet):
    masses = {row[0]: float(row[1]) for row in cells(sheet, "Masses")}
    assert masses == {
        k.name: pytest.approx(float(k.inertia.mass), rel=1e-4) for k in ur5.links if not k.inertia.massless
    }
    base = cells(sheet, "Base parameters")
    assert len(base) == 36 and [row[0] for row in base] == dp.base_parameters(ur5).names
    torques = {row[0]: max(abs(float(x)) for x in row[1:3]) for row in cells(sheet, "Torques under gravity")}
    g = np.abs(dp.gravity(ur5, ur5.sample(20_000, seed=0)[0])).max(axis=0)
    assert list(torques.values()) == pytest.approx(g.tolist(), rel=1e-3, abs=1e-6)
    limits = {row[0]: row for row in cells(sheet, "Joints and limits")}
    assert "150" in limits["elbow_joint"] and "3.15" in limits["elbow_joint"]


def test_what_the_page_draws_is_where_forward_kinematics_is(ur5):
    """The script's own kinematics, read from its data: placement, then a turn and a slide about the axis."""
    q = ur5.sample(seed=0)[0]
    found = skeleton(ur5, q)
    world = []
    for j in found.data["joints"]:
        angle = j["offset"][0] + sum(turn * q[i] for i, turn, _ in j["terms"])
        x, y, z = j["axis"]
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        T = np.eye(4)
        T[:3, :3] = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        placed = np.vstack([np.reshape(j["placement"], (3, 4)), [0, 0, 0, 1]])
        world.append((world[j["parent"]] if j["parent"] >= 0 else np.eye(4)) @ placed @ T)
    assert np.allclose(world, dp.fk(ur5, q), atol=1e-12)
    assert len(found.lines) == len(found.data["lines"]) and max(abs(x.x1) for x in found.lines) <= 200


def test_the_slices_hold_the_map(ur5):
    reach = dp.reach_map(ur5, "tool0", n=30_000, cell=0.2, bands=2)
    capacity = reach.survey(lambda q: dp.payload_capacity(ur5, q, "tool0"), "min", n=2000)
    text = page(workspace_section(reach, {"capacity [kg]": capacity}))
    data = json.loads(parsed(text).xpath("//div[contains(@class, 'voxels')]/script")[0].text)
    assert data["shape"] == list(reach.shape) and data["cell"] == reach.cell
    steps = np.frombuffer(base64.b64decode(data["layers"][0]["bytes"]), np.uint8).reshape(reach.shape)
    assert np.array_equal(steps > 0, reach.counts > 0)
    low, high = data["layers"][0]["low"], data["layers"][0]["high"]
    shown = low + (steps - 1.0) / 254 * (high - low)
    inside = (steps > 0) & (reach.index >= low) & (reach.index <= high)
    assert np.abs(shown - reach.index)[inside].max() <= (high - low) / 254


def odd(model):
    b = Builder("<odd> & robot")
    b.joint("first", model, None)
    return b.robot()


ODD = {
    "nothing": Builder("nothing").robot(),
    "ball": odd(spherical()),
    "planar": odd(Planar()),
    "slide": odd(prismatic()),
    "cylinder": odd(cylindrical()),
    "free": odd(Floating()),
    "hinge": odd(revolute()),
    "tree": tree(("floating", "spherical", "revolute", "helical", "cylindrical", "planar"), 1, mimics=1, armature=True),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_robots_have_a_page(name):
    text = robot_page(ODD[name], samples=0, reach=1000)
    assert "<h1>" in text and "<odd>" not in text


def test_symbols_and_other_things_have_none(ur5):
    with pytest.raises(ArgumentError, match="robot of numbers"):
        robot_page("ur5")


def test_report_writes_the_page_of_what_is_no_result(tmp_path):
    done = run("report", "double_pendulum", "--samples", "0", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (written,) = tmp_path.glob("*.html")
    assert "data sheet" in written.read_text(encoding="utf-8")
    both = run("report", "double_pendulum", "x.json", cwd=tmp_path)
    assert both.returncode == 2 and "one robot, or result files" in both.stderr
    missing = run("report", "no_such_robot", cwd=tmp_path)
    assert missing.returncode == 2 and "Traceback" not in missing.stderr


def test_workspace_writes_maps_pictures_and_a_page(tmp_path):
    words = ("workspace", "ur5", "--frame", "tool0", "--samples", "50000", "--survey", "2000", "--out", "out", "--json")
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["samples"] == 50_000 and summary["volume"] > 2 and "capacity [kg], least" in summary["surveys"]
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert {"workspace.json", "reach.npz", "report.html"} <= names
    assert json.loads((tmp_path / "out" / "workspace.json").read_text())["summary"]["frame"] == "tool0"
    bad = run("workspace", "ur5", "--frame", "tool1", cwd=tmp_path)
    assert bad.returncode == 2 and "tool0" in bad.stderr
