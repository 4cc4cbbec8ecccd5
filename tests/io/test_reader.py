"""What the reader makes of a good file: limits, axes, order, rooted and floating, text and path."""

from __future__ import annotations

import io
import re
import warnings

import numpy as np
import pytest

import dualpin as dp
from dualpin.io import xml
from dualpin.io.urdf import loads
from dualpin.scalars import ONE, Exact
from tests.random_robots import random_urdf

from .bad_urdfs import GOOD


def joint(kind: str, inside: str = "") -> str:
    return (
        '<robot name="r"><link name="a"/><link name="b"/>'
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/>{inside}</joint></robot>'
    )


LIMIT = '<limit lower="-0.5" upper="0.75" effort="3" velocity="2"/>'


def test_limits_and_dynamics_are_read():
    j = loads(joint("revolute", LIMIT + '<dynamics damping="0.1" friction="0.2"/>')).joint("j")
    assert (j.limits.lower, j.limits.upper) == ((-0.5,), (0.75,))
    assert (j.limits.velocity, j.limits.effort, j.limits.damping, j.limits.friction) == (2.0, 3.0, 0.1, 0.2)
    assert (j.damping, j.friction) == (0.1, 0.2)


def test_continuous_joints_have_no_position_limits():
    r = loads(joint("continuous", LIMIT))
    assert r.lower.tolist() == [-np.inf] and r.upper.tolist() == [np.inf] and r.velocity_limit.tolist() == [2.0]
    assert r.joint("j").kind == "continuous" and (r.nq, r.nv) == (1, 1)
    assert np.isinf(loads(joint("continuous")).velocity_limit).all()
    assert np.isinf(loads(joint("continuous", '<limit effort="1"/>')).velocity_limit).all()


@pytest.mark.parametrize(
    ("kind", "nq", "nv"), [("floating", 7, 6), ("planar", 3, 3), ("fixed", 0, 0), ("continuous", 1, 1)]
)
def test_layouts(kind, nq, nv):
    r = loads(joint(kind))
    assert (r.nq, r.nv) == (nq, nv)
    if nq == 7:
        assert r.neutral.tolist() == [0, 0, 0, 1, 0, 0, 0]


def test_without_an_axis_it_is_x():
    J = dp.jacobian(loads(joint("continuous")), [0.0], "b", engine="numpy")
    assert J[:, 0].tolist() == [1, 0, 0, 0, 0, 0]


def test_axes_along_coordinates_are_exact_constants():
    for text in ("0 0 1", "0 0 0.9999999999999", "0 0 1.0000000000001"):
        axis = loads(joint("continuous", f'<axis xyz="{text}"/>')).joint("j").model.axis
        assert all(type(c) is Exact for c in axis) and axis.z is ONE
    axis = loads(joint("continuous", '<axis xyz="3 4 0"/>')).joint("j").model.axis
    assert [float(c) for c in axis] == [0.6, 0.8, 0.0]


def test_siblings_come_by_name_as_bytes_and_depth_first():
    names = ["b", "B", "a10", "a9", "\u00e4", "_", "\U0001f916"]
    links = '<link name="root"/>' + "".join(f'<link name="l{i}"/><link name="m{i}"/>' for i in range(len(names)))
    joints = "".join(
        f'<joint name="{n}" type="continuous"><parent link="root"/><child link="l{i}"/></joint>'
        f'<joint name="{n}2" type="continuous"><parent link="l{i}"/><child link="m{i}"/></joint>'
        for i, n in enumerate(names)
    )
    r = loads(f'<robot name="r">{joints}{links}</robot>')
    order = sorted(names, key=str.encode)
    assert r.joint_names == [x for n in order for x in (n, n + "2")]


def test_the_order_of_the_file_does_not_matter():
    text = random_urdf(3, 12)
    parts = re.findall(r"^  (<.*>)$", text, re.M)
    rng = np.random.default_rng(0)
    a = loads(text)
    q, v, u = a.sample(seed=0)
    for _ in range(3):
        shuffled = '<robot name="random3">' + "".join(parts[i] for i in rng.permutation(len(parts))) + "</robot>"
        b = loads(shuffled)
        assert b.frame_names == a.frame_names
        assert np.array_equal(dp.rnea(a, q, v, u, engine="numpy"), dp.rnea(b, q, v, u, engine="numpy"))


def test_a_fixed_base_and_a_floating_one():
    still, flying = loads(GOOD), loads(GOOD, floating=True)
    assert flying.joint_names == ["root_joint", *still.joint_names]
    assert (flying.nq, flying.nv) == (still.nq + 7, still.nv + 6)
    assert flying.mass == still.mass + 2.0  # the root link moves too
    q, v, a = still.sample(seed=0)
    rest = np.r_[flying.neutral[:7], q]
    tau = dp.rnea(flying, rest, np.r_[np.zeros(6), v], np.r_[np.zeros(6), a], engine="numpy")
    assert np.allclose(tau[6:], dp.rnea(still, q, v, a, engine="numpy"), atol=1e-14)


def test_text_bytes_and_paths_give_the_same_robot(tmp_path):
    path = tmp_path / "a file with blanks \u00e4.urdf"
    path.write_text(GOOD)
    for r in (loads(GOOD), loads(GOOD.encode()), dp.load(path), dp.load(str(path))):
        assert r.name == "two" and r.nq == 2
    assert dp.load(path).source == str(path)
    assert loads(GOOD).source is None


@pytest.mark.parametrize("encoding", ["", ' encoding="UTF-16"', " encoding='ISO-8859-1'", ' encoding = "klingon"'])
def test_text_has_been_decoded_already(encoding):
    for rest in ("", ' standalone="yes"'):
        text = f'<?xml version="1.0"{encoding}{rest}?>' + '<robot name="r"><link name="m\u00e3o \u624b"/></robot>'
        assert loads(text).link_names == ["m\u00e3o \u624b"]


@pytest.mark.parametrize("thing", [None, 3, ["<robot/>"], "<robot name='\ud800'/>"])
def test_what_is_no_text_is_refused(thing):
    with pytest.raises(dp.DualpinError, match="text"):
        loads(thing)


def test_what_does_not_move_is_not_read():
    """Visuals, collisions, transmissions, materials and simulators may hold anything at all."""
    junk = (
        '<material name="m"><color rgba="x"/></material><gazebo><link name="hand"/></gazebo><transmission/>'
        "<link name='extra'><visual><geometry><cylinder/></geometry></visual><collision><origin xyz='?'/></collision>"
        "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'><x/></inertia>"
        "</inertial></link><joint name='glue' type='fixed'><parent link='hand'/><child link='extra'/>"
        "<calibration rising='x'/><axis xyz='?'/><safety_controller k_velocity='x'/></joint>"
        "<!-- <link name='base'/> --><?pi <link/> ?>"
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        r = loads(GOOD.replace("</robot>", junk + "</robot>"))
    assert r.mass == pytest.approx(2.5) and r.frame_names[-1] == "extra"


def test_remarks_are_announced_where_the_robot_was_loaded():
    with pytest.warns(dp.DualpinWarning, match="two: .*normalised: joint 'shoulder'") as caught:
        loads(GOOD.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>'))
    assert caught[0].filename == __file__


def test_summary_tells_what_was_assumed():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", dp.DualpinWarning)
        r = loads(GOOD.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>'))
    text = r.summary()
    assert all(word in text for word in ("shoulder", "wrist", "revolute", "normalised"))


@pytest.mark.parametrize("seed_", range(12))
def test_random_urdfs_keep_their_identities(seed_):
    """ABA after RNEA, and M from them, on trees that came through a file."""
    r = loads(
        random_urdf(100 + seed_, 8, kinds=("revolute", "continuous", "prismatic", "planar", "floating")), floating=True
    )
    q, v, a = r.sample(seed=seed_)
    M = dp.crba(r, q, engine="numpy")
    if np.linalg.matrix_rank(M) < r.nv or np.linalg.cond(M) > 1e8:
        return  # a joint that moves no mass
    back = dp.aba(r, q, v, dp.rnea(r, q, v, a, engine="numpy"), engine="numpy")
    assert np.abs(back - a).max() < 1e-14 * np.linalg.cond(M) * np.abs(a).max() + 1e-12


# --- other sources, and files of users -------------------------------------------------------------


def notes(text: str, **options: bool) -> tuple[str, ...]:
    return loads(text, **options).notes


def test_text_bytes_and_open_files_give_the_same_robot(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(GOOD.replace(' name="two"', ""), encoding="utf-8")
    with path.open("rb") as binary, path.open(encoding="utf-8") as text:
        robots = [dp.load(path), dp.load(binary), dp.load(text), dp.load(io.StringIO(GOOD)), dp.loads(GOOD.encode())]
    assert [r.name for r in robots] == ["arm", "arm", "arm", "two", "two"]
    assert {tuple(r.frame_names) for r in robots} == {tuple(robots[0].frame_names)}
    assert [r.source for r in robots] == [str(path), None, None, None, None]


def test_files_that_cannot_be_read_say_so(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(GOOD, encoding="utf-8")
    with path.open() as closed:
        pass
    with pytest.raises(dp.UrdfError, match=r"arm.urdf: cannot be read \(.*closed"):
        dp.load(closed)
    for given in (3, None, [1]):
        with pytest.raises(dp.UrdfError, match=r"<file>: read\(\) gave"):
            dp.load(type("Odd", (), {"read": lambda self, n, given=given: given})())


def test_a_file_object_is_read_up_to_the_cap_only(monkeypatch):
    monkeypatch.setattr(xml, "MAX_BYTES", 1000)
    endless = type("Endless", (), {"read": lambda self, n: b" " * n})()
    with pytest.raises(dp.UrdfError, match="files up to"):
        dp.load(endless)


def test_a_quaternion_of_urdf_1_1_turns_as_its_angles_do():
    where = '<origin xyz="0 0 0.5" rpy="0 0 0"/>'
    turned = loads(GOOD.replace('"two"', '"two" version="1.1"').replace(
        where, '<origin xyz="0 0 0.5" quat_xyzw="0.1 -0.7 0.5 0.5"/>'))  # fmt: skip
    x, y, z, w = 0.1, -0.7, 0.5, 0.5  # of length 1
    R = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]  # fmt: skip
    assert np.abs(dp.fk(turned, [0, 0], "arm", engine="numpy")[:3, :3] - R).max() < 1e-15


def test_what_is_missing_is_read_as_pinocchio_reads_it():
    inertia = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>'
    for less in ("", "<inertia/>", '<inertia ixx="1" iyy="1" izz="1"/>'):
        arm = next(k for k in loads(GOOD.replace(inertia, less)).links if k.name == "arm").inertia
        assert [float(x) for x in arm.parameters] == [1.0] + [0.0] * 9


def test_a_joint_without_limits_has_none():
    for kind in ("revolute", "prismatic"):
        r = loads(joint(kind))
        assert r.joint("j").kind == kind and (r.lower[0], r.upper[0]) == (-np.inf, np.inf)
        r = loads(joint(kind, '<limit lower="-1" upper="1"/>'))
        assert (r.lower[0], r.upper[0], r.velocity_limit[0], r.joint("j").limits.effort) == (-1, 1, np.inf, np.inf)


def test_a_fixed_root_joint_stands_beside_the_floating_base():
    text = GOOD.replace("</robot>", '<link name="tool"/><joint name="root_joint" type="fixed"><parent link="hand"/>'
                        '<child link="tool"/></joint></robot>')  # fmt: skip
    assert loads(text).frame("root_joint").role == "fixed_joint"
    flying = loads(text, floating=True)
    assert flying.frame("root_joint").role == "joint" and flying.joint("root_joint").kind == "floating"
    assert [f.role for f in flying.frames if f.name == "root_joint"] == ["joint", "fixed_joint"]
    moving = GOOD.replace('"shoulder"', '"root_joint"')
    assert loads(moving).joint_names == ["root_joint", "wrist"]
    with pytest.raises(dp.UrdfError, match="<text>:17: joint 'root_joint': the name is reserved for the floating base"):
        loads(moving, floating=True)


def test_nameless_links_get_the_name_of_the_file():
    r = loads("<robot><link/></robot>", source="cup.urdf")
    assert (r.name, r.link_names) == ("cup", ["cup"]) and len(r.notes) == 2
    assert loads('<robot name="r"><link name="text"/></robot>').link_names == ["text"]


# --- notes -----------------------------------------------------------------------------------------


def test_one_note_a_kind_lists_all_it_concerns():
    text = random_urdf(3, 21).replace("<axis ", "<dynamics damping='0.1'/><axis ")
    (said,) = [n for n in notes(text) if "damping" in n]
    assert said.count("damping 0.1") == text.count("<dynamics") > 10
    assert len(notes(text)) <= 12


def test_a_long_list_is_cut_and_counted():
    links = "".join(f'<link name="l{i}"/>' for i in range(101))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/></joint>' for i in range(100)
    )
    (said,) = [n for n in notes(f'<robot name="r">{links}{joints}</robot>') if "without <limit>" in n]
    assert "'j39', ... (100 in all)" in said and "'j40'" not in said


NO_INERTIA = "<inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/>"


@pytest.mark.parametrize(
    ("inertial", "said"),
    [
        ("", "without mass"),
        (f"<inertial><mass value='0'/>{NO_INERTIA}</inertial>", "without mass"),
        (f"<inertial><mass value='2'/>{NO_INERTIA}</inertial>", "moves no mass"),  # a point on the axis
    ],
)
def test_a_robot_that_cannot_be_accelerated_is_told(inertial, said):
    text = joint("continuous").replace('<link name="b"/>', f'<link name="b">{inertial}</link>')
    assert [n for n in notes(text) if said in n], notes(text)
    off_axis = text.replace("<mass", "<origin xyz='0 1 0'/><mass").replace("value='0'", "value='1'")
    assert not inertial or not [n for n in notes(off_axis) if said in n]


def test_a_leader_moves_the_mass_of_its_followers():
    body = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"
    text = (
        f'<robot name="r"><link name="a"/><link name="b"/><link name="c">{body}</link>'
        '<joint name="lead" type="continuous"><parent link="a"/><child link="b"/></joint>'
        '<joint name="follow" type="continuous"><parent link="a"/><child link="c"/><mimic joint="lead"/></joint>'
        "</robot>"
    )
    assert sorted(n.split(":")[0].split(",")[0] for n in notes(text)) == [
        "<mimic> is not followed",
        "the joint moves no mass",
    ]
    assert notes(text, mimic=True) == ()
