"""What the reader makes of a good file: limits, axes, order, rooted and floating, text and path."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest

import dualpin as dp
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
    assert r.mass == pytest.approx(2.0) and r.frame_names[-1] == "extra"


def test_remarks_are_announced_where_the_robot_was_loaded():
    with pytest.warns(dp.DualpinWarning, match="two: joint 'shoulder'") as caught:
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
