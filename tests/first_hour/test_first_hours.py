"""The first hours of four users, as they would go: what they type, what they read, what they look at."""

import json
from pathlib import Path

import numpy as np
import pytest

from .hour import LOOKS, Terminal, chromium, opened

pytest.importorskip("pinocchio")
pytest.importorskip("jinja2")
URDF = Path(__file__).parents[2] / "urdf"
ARM = """<robot name="my_arm">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="{mass}"/>
    <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="{izz}"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0 0 0.15"/><mass value="2"/>
    <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.005"/></inertial></link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="50" velocity="2"/></joint>
  <joint name="elbow" type="revolute"><parent link="{parent}"/><child link="fore"/><origin xyz="0 0 0.4"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="30" velocity="2"/></joint>
  <joint name="flange" type="fixed"><parent link="fore"/><child link="tip"/><origin xyz="0 0 0.3"/></joint>
</robot>
"""
GOOD = {"mass": "3", "izz": "0.01", "parent": "upper"}


def arm(folder, **changed):
    (folder / "my_arm.urdf").write_text(ARM.format(**GOOD | changed))


@pytest.fixture(scope="module")
def engineer(tmp_path_factory):
    """An engineer with an arm of his own, which is not right at once."""
    terminal = Terminal(tmp_path_factory.mktemp("engineer"))
    arm(terminal.folder, parent="uper")
    refused = terminal.type("dualpin validate my_arm.urdf --samples 3 --out refused", code=2)
    assert "my_arm.urdf:" in refused and "uper" in refused and "upper" in refused  # file, line, what, the nearest
    arm(terminal.folder, izz="-0.01")
    odd = terminal.type("dualpin validate my_arm.urdf --samples 3 --out odd")
    assert "1 remark about the model" in odd and "remark: " in odd and "inertia" in odd
    arm(terminal.folder)
    assert "remark" not in terminal.type("dualpin validate my_arm.urdf --samples 3 --out good")
    assert "-114.592 to 114.592 deg" in terminal.type("dualpin info my_arm.urdf --degrees")
    note = terminal.type("dualpin fk my_arm.urdf --q 90,0")
    assert "90 of shoulder is read as rad; if degrees are meant, add --degrees" in note
    assert "note" not in terminal.type("dualpin fk my_arm.urdf --q 90,0 --degrees")
    told = terminal.type("dualpin integrate my_arm.urdf", code=2)
    assert "2 joints cannot follow 6 numbers" in told and "--task position" in told
    done = terminal.type(
        "dualpin integrate my_arm.urdf --task position --dt 0.1,0.2,0.5 --gain 0 --turns 1 --out study"
    )
    assert "rk4" in done and "on a circle of radius 0.05 m" in done
    return terminal


@pytest.fixture(scope="module")
def student(tmp_path_factory):
    """A student with a UR5: tables for a homework, and why his own numbers are off."""
    terminal = Terminal(tmp_path_factory.mktemp("student"))
    table = terminal.type("dualpin dh panda --tip panda_link8 --convention modified --degrees --out dh")
    assert "from panda_link0 to panda_link8" in table and "residual" in table
    assert table.count("note:") == len({x for x in table.splitlines() if x.startswith("note:")})  # each once
    assert "0.384" in table and "0.3839999" not in table
    exact = json.loads((terminal.folder / "dh" / "dh.json").read_text())
    assert [r["joint"] for r in exact["rows"]] == [f"panda_joint{k}" for k in range(1, 8)]
    latex = terminal.type("dualpin dh panda --tip panda_hand --format latex")
    assert r"$q_{7} - \pi/4$" in latex and "+ -" not in latex
    assert "per deg" in terminal.type("dualpin screws ur5 --tip tool0 --degrees --out screws")
    return terminal


@pytest.fixture(scope="module")
def maintainer(tmp_path_factory):
    """A maintainer whose pipeline guards a model: both readers agree on a link that became ten times as heavy."""
    terminal = Terminal(tmp_path_factory.mktemp("maintainer"))
    arm(terminal.folder)
    terminal.type("dualpin validate my_arm.urdf --samples 3 --out baseline")
    terminal.type("dualpin validate my_arm.urdf --samples 3 --out report")
    same = "dualpin report --compare baseline/report.json report/report.json"
    assert "nothing got worse" in terminal.type(same)
    arm(terminal.folder, mass="30", izz="-0.01")
    assert "passed" in terminal.type("dualpin validate my_arm.urdf --samples 3 --out report")
    told = terminal.type(f"{same} --out changed", code=1)
    assert "link upper: mass" in told and "remark" in told
    return terminal


@pytest.fixture(scope="module")
def researcher(tmp_path_factory):
    """A researcher with a panda: which integrator, how fast, and is it reproducible."""
    terminal = Terminal(tmp_path_factory.mktemp("researcher"))
    start = "0,-0.5,0,-1.9,0,1.7,0.8,0.02,0.02"
    told = terminal.type(f"dualpin integrate panda --frame panda_link8 --start {start} --turns 1 --dt 0.1,0.2,0.5 "
                         "--gain 0,8 --methods euler,rk4 --plot errors.svg --out study")  # fmt: skip
    assert "UNSTABLE" in told and "K dt = 8 exceeds" not in told and "the limit of euler" in told
    assert told.count("note: unstable") == 1  # one note a kind
    assert "<svg" in (terminal.folder / "errors.svg").read_text()
    shown = terminal.type("dualpin report study/integrate.json")
    assert shown.count("euler") == 6 and shown.count("rk4") == 6  # the whole table
    assert "nothing got worse" in terminal.type("dualpin report --compare study/integrate.json study/integrate.json")
    terminal.type("dualpin bench panda --terms rnea,crba --batch 1,64 --out speed")
    found = json.loads((terminal.folder / "speed" / "bench.json").read_text())["header"]
    assert {"processor", "date", "numpy", "pin"} <= found.keys() and found["command"].startswith("dualpin bench panda")
    np.savetxt(terminal.folder / "q.csv", np.linspace(0, 1, 5)[:, None] * np.ones(9) * 0.02, delimiter=",")
    if pytest.importorskip("viser"):
        terminal.type("dualpin view panda --play q.csv --dt 0.25 --port 0 --record motion.html")
        assert (terminal.folder / "motion.html").stat().st_size > 1e5
    return terminal


PAGES = ("engineer:refused", "engineer:odd", "engineer:study", "student:dh", "maintainer:changed", "researcher:study",
         "researcher:speed")  # fmt: skip


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    driver = chromium(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


@pytest.mark.parametrize("user", ["engineer", "student", "maintainer", "researcher"])
def test_the_hour(user, request):
    """What is typed and read; the assertions stand where they are typed, in the user's fixture."""
    assert request.getfixturevalue(user).said.count("$ dualpin") >= 3


@pytest.mark.parametrize("page", PAGES)
def test_what_is_looked_at(page, request, browser):
    """Every page that was left behind, on a screen and on a phone, by day and by night."""
    user, folder = page.split(":")
    path = request.getfixturevalue(user).folder / folder / "report.html"
    for width, scheme in LOOKS:
        opened(browser, path, width, scheme)
    words = browser.find_element("tag name", "body").text
    expected = {"refused": "Refused", "odd": "1 remark about the model", "changed": "link upper: mass",
                "dh": "panda_joint7", "speed": "Geometric means"}.get(folder, "Fitted orders")  # fmt: skip
    assert expected in words
