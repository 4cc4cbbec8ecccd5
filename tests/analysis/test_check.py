"""Each rule finds its fault and says what it does; files without it are left alone."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from typer import testing

import dualpin as dp
from dualpin.analysis.check import RULES, check, diff, fixed
from dualpin.analysis.check.exports import junit, sarif
from dualpin.analysis.check.tensors import nearest_physical, second_moments
from dualpin.cli.main import program

INERTIAL = """<inertial><origin xyz="0.1 0 0"/><mass value="2"/>
 <inertia ixx="0.0061" ixy="0" ixz="0" iyy="0.0122" iyz="0" izz="0.0153"/></inertial>"""
KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
JOINT = """<joint name="joint" type="revolute">
 <origin xyz="0 0 0.3" rpy="0 0 0"/><parent link="base"/><child link="arm"/>
 <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="2"/></joint>"""
LINKS = f"""<link name="base"/>
<link name="arm">{INERTIAL}</link>"""

MESH = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
WELD = '<joint name="weld" type="fixed"><parent link="arm"/><child link="Arm"/></joint>'


def robot(links: str = LINKS, joints: str = JOINT) -> str:
    return f'<robot name="r">\n{links}\n{joints}\n</robot>'


@pytest.fixture
def found(tmp_path):
    """The findings about a text, by rule."""

    def look(text: str, **options) -> dict:
        file = tmp_path / "r.urdf"
        file.write_text(text)
        return {f.rule: f for f in check(file, **options)}

    return look


def test_a_file_without_fault_has_no_finding(found):
    assert found(robot()) == {}


# what is changed in the file, the rule that finds it, and whether it is certain how to correct it
FAULTS = {
    "triangle-inequality": (robot().replace('izz="0.0153"', 'izz="0.0193"'), False),
    "not-positive-definite": (robot().replace('ixy="0"', 'ixy="0.02"'), False),
    "inertia-without-mass": (robot().replace('mass value="2"', 'mass value="0"'), False),
    "zero-inertia": (
        robot().replace("0.0061", "0").replace("0.0122", "0").replace("0.0153", "0"),
        False,
    ),
    "placeholder-inertia": (
        robot().replace("0.0061", "1.0").replace("0.0122", "1.0").replace("0.0153", "1.0"),
        False,
    ),
    "denser-than-matter": (
        robot().replace("0.0061", "0.0000061").replace("0.0122", "0.0000122").replace("0.0153", "0.0000153"),
        False,
    ),
    "wider-than-robots": (
        robot().replace("0.0061", "6100").replace("0.0122", "12200").replace("0.0153", "15300"),
        False,
    ),
    "no-mass": (robot(LINKS.replace(INERTIAL, "")), False),
    "massless-joint": (
        robot(
            LINKS + '<link name="tip"/>',
            JOINT + JOINT.replace('"joint"', '"last"').replace('"arm"', '"tip"').replace('"base"', '"arm"'),
        ),
        False,
    ),
    "near-right-angle": (robot().replace('rpy="0 0 0"', 'rpy="1.5708 0 -3.1416"'), True),
    "limits-crossed": (robot().replace('lower="-1"', 'lower="2"'), False),
    "limits-empty": (robot().replace('lower="-1"', 'lower="1"'), False),
    "limits-huge": (robot().replace('upper="1"', 'upper="1e16"'), False),
    "degrees": (robot().replace('lower="-1" upper="1"', 'lower="-90" upper="90"'), False),
    "no-effort": (robot().replace('effort="10"', 'effort="0"'), False),
    "negative-limit": (robot().replace('effort="10"', 'effort="-10"'), False),
    "negative-friction": (robot().replace("</joint>", '<dynamics damping="-1"/></joint>'), False),
    "damping-above-effort": (robot().replace("</joint>", '<dynamics damping="50"/></joint>'), False),
    "mimic-undefined": (robot().replace("</joint>", '<mimic joint="nobody"/></joint>'), False),
    "mimic-fixed": (robot().replace("</joint>", '<mimic joint="joint"/></joint>'), False),
    "millimetres": (robot().replace('xyz="0 0 0.3"', 'xyz="0 0 300"'), False),
    "degrees-in-rpy": (robot().replace('rpy="0 0 0"', 'rpy="90 0 0"'), True),
    "name-characters": (robot().replace('"arm"', '"arm one"'), False),
    "name-case": (robot(LINKS + '<link name="Arm"/>', JOINT + WELD), False),
    "name-shared": (robot().replace('name="joint"', 'name="arm"'), False),
    "name-reserved": (robot().replace('name="joint"', 'name="root_joint"'), False),
    "several-elements": (robot().replace("</link>", INERTIAL + "</link>"), False),
    "missing-products": (robot().replace('ixy="0" ', ""), False),
    "missing-limit": (robot().replace('<limit lower="-1" upper="1" effort="10" velocity="2"/>', ""), False),
    "missing-bound": (robot().replace('lower="-1" ', ""), False),
    "missing-effort": (robot().replace('effort="10" ', ""), False),
    "axis-length": (robot().replace('axis xyz="0 1 0"', 'axis xyz="0 2 0"'), True),
    "unknown-attribute": (robot().replace('rpy="0 0 0"', 'rpy="0 0 0" scale="2"'), False),
    "wrong-case": (robot(LINKS + "<Link name='x'/>"), False),
    "left-xacro": (
        robot().replace('name="r">', 'name="r" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:property name="a"/>'),
        False,
    ),
    "blanks-in-type": (robot().replace('type="revolute"', 'type=" revolute"'), False),
    "unnamed": (robot().replace('<robot name="r">', "<robot>"), False),
    "missing-mesh": (robot(LINKS.replace("<inertial>", MESH.format("no.stl") + "<inertial>")), False),
    "package-not-found": (robot(LINKS.replace("<inertial>", MESH.format("package://no/x.stl") + "<inertial>")), False),
}  # fmt: skip


@pytest.mark.parametrize("rule", FAULTS)
def test_a_fault_is_found_with_its_place_its_reason_and_what_to_change(found, rule):
    text, certain = FAULTS[rule]
    f = found(text).get(rule)
    assert f is not None, found(text)
    assert f.severity == RULES[rule].severity and f.why and f.fix and f.says
    assert f.certain == certain
    if rule not in ("left-xacro", "no-mass", "unnamed", "wrong-case", "package-not-found"):
        assert f.line and f.item, "of a link or a joint: its line"
    assert any(c.isdigit() for c in f.why) or rule in (
        "left-xacro", "unnamed", "unknown-attribute", "wrong-case", "blanks-in-type", "name-characters", "name-case",
        "name-shared", "name-reserved", "missing-limit", "several-elements", "negative-limit",
    ), f.why  # fmt: skip


SHAPED = """<link name="arm">
<visual><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.05 0.05"/></geometry></visual>{}</link>"""
J = 2 / 12 * np.array([0.05**2 * 2, 0.4**2 + 0.05**2, 0.4**2 + 0.05**2])


def shaped(xyz: str, J: np.ndarray, mass: float = 2.0, rpy: str = "0 0 0") -> str:
    inertia = f'<inertia ixx="{J[0]:.9g}" ixy="0" ixz="0" iyy="{J[1]:.9g}" iyz="0" izz="{J[2]:.9g}"/>'
    inertial = f'<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/>{inertia}</inertial>'
    return robot('<link name="base"/>' + SHAPED.format(inertial))


def test_a_solid_box_has_no_finding_and_its_faults_have(found):
    pytest.importorskip("trimesh")
    assert found(shaped("0.2 0 0", J)) == {}
    about_origin = J + 2.0 * 0.2**2 * np.array([0, 1, 1])
    assert set(found(shaped("0.2 0 0", about_origin))) == {"tensor-about-wrong-point"}
    assert set(found(shaped("0.2 0 0", J[[1, 0, 2]]))) == {"tensor-turned"}
    assert set(found(shaped("0.2 0 0", J[[1, 0, 2]], rpy="0 0 1.5707963267948966"))) == set()
    assert set(found(shaped("-0.2 0 0", J))) == {"com-outside"}
    assert "inertia-beyond-shape" in found(shaped("0.2 0 0", 40 * J))
    assert "too-dense" in found(shaped("0.2 0 0", 1000 * J, mass=2000))
    assert "too-light" in found(shaped("0.2 0 0", 0.001 * J, mass=0.002))


def test_the_numbers_are_those_of_the_terms(found):
    """What the finding says of the torque is the difference of two robots' torques."""
    text, _ = FAULTS["triangle-inequality"]
    f = found(text)["triangle-inequality"]
    one, J = dp.loads(text), np.diag([0.0061, 0.0122, 0.0193])
    repaired = nearest_physical(J)
    other = text
    for key, (i, k) in {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2)}.items():
        other = other.replace(f'{key}="{J[i, k]:g}"', f'{key}="{float(repaired[i, k])!r}"')
    q, v, a = one.sample(8, seed=0)
    change = np.abs(dp.rnea(one, q, v, a, engine="numpy") - dp.rnea(dp.loads(other), q, v, a, engine="numpy")).max()
    assert f.effect.term == "rnea" and abs(f.effect.amount - change) < 1e-12


def test_the_nearest_tensor_is_a_bodys_and_no_other_is_nearer():
    rng = np.random.default_rng(0)
    for _ in range(20):
        A = rng.standard_normal((3, 3))
        J = A + A.T
        S = second_moments(nearest_physical(J))
        assert np.linalg.eigvalsh(S).min() > -1e-12
        least = np.linalg.norm(S - second_moments(J))
        for _ in range(200):
            B = rng.standard_normal((3, 3))
            assert np.linalg.norm(B @ B.T - second_moments(J)) >= least - 1e-12


def test_rounding_in_the_file_is_no_fault(found):
    """A plate, printed with three digits: 0.00123 + 0.00234 = 0.00357, written as 0.00358."""
    text = robot().replace("0.0061", "0.00123").replace("0.0122", "0.00234").replace("0.0153", "0.00358")
    assert found(text) == {}


def test_a_tensor_of_few_digits_has_no_excuse(found):
    """1, 1, 3 is no rounding of what a body has."""
    text = robot().replace("0.0061", "1").replace("0.0122", "1").replace("0.0153", "3")
    assert "triangle-inequality" in found(text)


def test_signs_of_products_are_named_as_the_cause(found):
    """A rod along (1, 1, 1): with its products' signs exchanged no body has the tensor."""
    rod = 0.01 * (np.eye(3) - np.ones((3, 3)) / 3) + 1e-4 * np.eye(3)
    values = rod * np.where(np.eye(3, dtype=bool), 1, -1)
    given = " ".join(f'{k}="{values[i]:.6g}"' for k, i in zip(KEYS, zip(*np.triu_indices(3), strict=True), strict=True))
    old = 'ixx="0.0061" ixy="0" ixz="0" iyy="0.0122" iyz="0" izz="0.0153"'
    (f,) = found(robot().replace(old, given)).values()
    assert "change their signs" in f.fix


def limb(name: str, y: float, com: str, ixy: float) -> str:
    return f"""<link name="{name}_leg"><inertial><origin xyz="{com}"/><mass value="2"/>
      <inertia ixx="0.02" ixy="{ixy}" ixz="0" iyy="0.03" iyz="0" izz="0.025"/></inertial></link>
      <joint name="{name}_hip" type="continuous"><origin xyz="0 {y} 0"/><parent link="base"/><child link="{name}_leg"/>
      <axis xyz="1 0 0"/></joint>"""


def test_a_limb_that_does_not_mirror_is_found_and_one_that_does_is_not(found):
    base, left = '<link name="base"/>', limb("left", 0.1, "0 0.05 -0.2", 0.002)
    good = robot(base, left + limb("right", -0.1, "0 -0.05 -0.2", -0.002))
    assert found(good) == {}
    sign = robot(base, left + limb("right", -0.1, "0 0.05 -0.2", -0.002))
    f = found(sign)["not-mirrored"]
    assert f.item == "link 'right_leg'" and "100 mm" in f.says and f.effect.amount > 0
    left = limb("left", 0.1, "0 0.05 -0.2", 0.008)
    product = robot(base, left + limb("right", -0.1, "0 -0.05 -0.2", 0.008))
    assert "tensor" in found(product)["not-mirrored"].says


# --- corrections -----------------------------------------------------------------------------------


def test_certain_corrections_change_their_attributes_and_nothing_else(tmp_path):
    text = robot().replace('rpy="0 0 0"', "rpy='1.5708  0 0'").replace('axis xyz="0 1 0"', 'axis\n   xyz = "0 2 0"')
    text = text.replace("<link", "<!-- <joint rpy='1.5708 0 0'> --><link", 1)
    file = tmp_path / "r.urdf"
    file.write_text(text)
    found = check(file)
    new = fixed(found)
    changed = [(a, b) for a, b in zip(text.splitlines(), new.splitlines(), strict=True) if a != b]
    assert len(changed) == 2
    assert 'rpy="1.5707963267948966 0 0"' in new and 'xyz = "0.0 1.0 0.0"' in new
    (tmp_path / "new.urdf").write_text(new)
    assert check(tmp_path / "new.urdf").passed
    assert diff(found, "r.urdf", new).count("\n+") == 3  # two lines and the header
    axes = [dp.loads(t).joints[0].model.axis for t in (text, new)]
    assert [float(x) for x in axes[0]] == [float(x) for x in axes[1]]


def test_the_command_writes_a_copy_and_leaves_the_file(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(robot().replace('rpy="0 0 0"', 'rpy="1.5708 0 0"'))
    before = file.read_text()
    done = run(file, "--fix", "--out", tmp_path / "out")
    assert done.exit_code == 1 and file.read_text() == before
    assert "+ " in done.stdout and "1.5707963267948966" in (tmp_path / "out" / "arm.fixed.urdf").read_text()
    assert run(tmp_path / "out" / "arm.fixed.urdf").exit_code == 0


# --- the command -----------------------------------------------------------------------------------


def run(*words: object):
    return testing.CliRunner().invoke(program(), ["check", *map(str, words)])


def test_exit_codes_json_junit_and_sarif(tmp_path):
    good, bad, broken = (tmp_path / f"{n}.urdf" for n in ("good", "bad", "broken"))
    good.write_text(robot())
    bad.write_text(FAULTS["triangle-inequality"][0])
    broken.write_text("<robot name='r'><link name='a'")
    assert run(good).exit_code == 0
    done = run(good, bad, "--json", "--out", tmp_path / "out")
    assert done.exit_code == 1
    data = json.loads(done.stdout)
    assert [f["passed"] for f in data["files"]] == [True, False]
    f = data["files"][1]["findings"][0]
    assert f["rule"] == "triangle-inequality" and f["line"] and f["effect"]["unit"] == "N m"
    suites = ElementTree.parse(tmp_path / "out" / "check.junit.xml").getroot()
    assert [s.get("failures") for s in suites] == ["0", "1"]
    log = json.loads((tmp_path / "out" / "check.sarif").read_text())
    result = log["runs"][0]["results"][0]
    assert result["ruleId"] == "triangle-inequality" and result["level"] == "error"
    assert result["locations"][0]["physicalLocation"]["region"]["startLine"] == f["line"]
    both = run(good, broken, "--json")
    assert both.exit_code == 2 and json.loads(both.stdout)["refused"][0]["name"] == str(broken)
    assert run(tmp_path / "none.urdf").exit_code == 2


def test_the_page_lists_every_rule_as_it_is():
    page = (Path(__file__).parents[2] / "docs" / "check.md").read_text(encoding="utf-8")
    for r in RULES.values():
        assert f"| `{r.id}` | {r.severity} | {r.says} |" in page


def test_few_findings_in_a_hundred_were_judged_wrong():
    """Findings in files that others wrote, drawn at random with every rule among them, and judged by hand."""
    lines = (Path(__file__).parents[2] / "validation" / "check" / "judged.tsv").read_text(encoding="utf-8").splitlines()
    rows = [dict(zip(lines[0].split("\t"), x.split("\t"), strict=True)) for x in lines[1:]]
    assert len(rows) >= 100 and {r["rule"] for r in rows} <= set(RULES)
    assert {r["verdict"] for r in rows} <= {"right", "wrong"}
    assert sum(r["verdict"] == "wrong" for r in rows) <= 2


def test_what_is_no_robot_is_an_error():
    with pytest.raises(dp.ArgumentError, match="a name, a path or a Robot expected, got int"):
        check(3)


def test_rules_are_listed_chosen_and_left_out(found, tmp_path):
    listed = run("--rules")
    assert listed.exit_code == 0 and all(rule in listed.stdout for rule in RULES)
    text = FAULTS["triangle-inequality"][0]
    assert set(found(text, without=["triangle-inequality"])) == set()
    assert set(found(text, only=["limits-crossed"])) == set()
    with pytest.raises(dp.ArgumentError, match="did you mean 'triangle-inequality'"):
        found(text, only=["triangle-inequalty"])
    file = tmp_path / "note.urdf"
    file.write_text(FAULTS["near-right-angle"][0])
    assert run(file).exit_code == 1 and run(file, "--level", "warning").exit_code == 0


def test_names_of_strangers_stay_text(tmp_path):
    file = tmp_path / "r.urdf"
    file.write_text(FAULTS["triangle-inequality"][0].replace('"arm"', '"&lt;b&gt;\x7f[red]"'))
    found = check(file)
    ElementTree.fromstring(junit([found]).split("\n", 1)[1])
    json.loads(sarif([found]))
    assert run(file).exit_code == 1


def test_robots_in_memory_and_of_mjcf_are_checked_too():
    b = dp.Builder("r")
    from dualpin.model import revolute
    from dualpin.spatial.inertia import Inertia

    b.joint("j", revolute(), inertia=Inertia.of(1.0, (0, 0, 0), np.diag([1.0, 1.0, 3.0])))
    assert [f.rule for f in dp.check(b.robot())] == ["triangle-inequality"]
    pytest.importorskip("mujoco")
    inner = '<body><joint/><geom size="1"/></body>'
    mjcf = f'<mujoco><worldbody><body><joint/><geom size="1"/>{inner}</body></worldbody></mujoco>'
    assert dp.check(dp.loads(mjcf)).links == 3


def test_real_robots_are_looked_at_with_their_meshes():
    """Three wrists of the UR5 have their centre of mass at the joint, outside of their meshes."""
    found = check("ur5", only=["com-outside"])
    assert [f.item for f in found] == [f"link 'wrist_{k}_link'" for k in (1, 2, 3)]
