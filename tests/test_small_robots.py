"""Robots with nothing to move, with one joint, or without mass: every public function knows what to say."""

from __future__ import annotations

import inspect
import warnings

import numpy as np
import pytest

import dualpin as dp
from dualpin import functions
from dualpin.io.urdf import loads
from dualpin.model import Builder, prismatic, revolute
from dualpin.spatial import Pose, Vector3
from tests.test_shapes import FUNCTIONS, tail

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
STILL = (
    f'<robot name="still"><link name="base">{INERTIAL}</link><link name="part">{INERTIAL}</link>'
    '<joint name="weld" type="fixed"><parent link="base"/><child link="part"/><origin xyz="1 2 3"/></joint></robot>'
)
FRAMED = ("jacobian", "jacobian_dot", "frame_velocity", "frame_acceleration")


@pytest.fixture
def still():
    return loads(STILL)


def test_the_tables_name_every_public_function():
    public = {
        name for name, f in inspect.getmembers(functions, inspect.isfunction)
        if f.__module__ == functions.__name__ and not name.startswith("_")
    }  # fmt: skip
    several = {name for name in public if "derivatives" in name or name in ("rnea_vjp", "rnea_hvp", "rnea_hessian")}
    assert public - set(FUNCTIONS) <= {"link_terms", "inertial_parameters", "rnea_jvp"} | several


@pytest.mark.parametrize("shape", [(), (4,), (2, 0)], ids=str)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_robot_of_fixed_joints_gives_empty_results(still, name, shape):
    options = {"frame": "part"} if name in FRAMED else {}
    arrays = [np.zeros((*shape, 0)) for _ in FUNCTIONS[name]]
    if name == "com":
        if 0 not in shape:
            with pytest.raises(dp.ArgumentError, match="no moving body has mass"):
                dp.com(still, *arrays, engine="numpy")
        return
    for engine in ("numpy", "auto"):
        result = getattr(dp, name)(still, *arrays, engine=engine, **options)
        assert result.shape == (*shape, *tail(name, still))
        assert (result == 0).all()


def test_a_robot_of_fixed_joints_knows_its_frames(still):
    assert (still.nq, still.nv, len(still), still.mass) == (0, 0, 0, 0.0)
    assert still.frame_names == ["universe", "base", "weld", "part"]
    assert dp.fk(still, [], "part", engine="numpy")[:3, 3].tolist() == [1, 2, 3]
    assert dp.fk(still, [], "part", as_="dual_quaternion", engine="numpy").tolist() == [1, 0, 0, 0, 0, 0.5, 1, 1.5]
    assert dp.fk(still, np.zeros((5, 0)), "part", engine="numpy").shape == (5, 4, 4)
    assert dp.fk(still, [], as_="dual_quaternion", engine="numpy").shape == (0, 8)
    assert dp.inertial_parameters(still).shape == (0,)
    assert len(dp.link_terms(still, [], [], engine="numpy")) == 0
    assert still.neutral.shape == still.lower.shape == still.upper.shape == still.velocity_limit.shape == (0,)
    assert [x.shape for x in still.sample(3, seed=0)] == [(3, 0)] * 3
    assert [x.shape for x in still.sample(seed=0)] == [(0,)] * 3
    assert dp.rnea(still, [], [], [], np.zeros((0, 6)), engine="numpy").shape == (0,)
    assert "still" in repr(still) and "0 joints" in repr(still)
    assert "still" in still.summary()
    with pytest.raises(dp.FrameNotFoundError, match="is fixed"):
        still.joint("weld")


def test_a_robot_of_one_link():
    one = loads(f'<robot name="one"><link name="base">{INERTIAL}</link></robot>')
    assert one.frame_names == ["universe", "base"]
    assert np.array_equal(dp.fk(one, [], "base", engine="numpy"), np.eye(4))
    flying = loads(f'<robot name="one"><link name="base">{INERTIAL}</link></robot>', floating=True)
    assert (flying.nq, flying.nv) == (7, 6)
    assert np.allclose(dp.crba(flying, flying.neutral, engine="numpy"), np.eye(6))
    assert np.allclose(dp.aba(flying, flying.neutral, np.zeros(6), np.zeros(6), engine="numpy"), [0, 0, 0, 0, 0, -9.81])


def test_a_robot_of_fixed_joints_can_float(still):
    flying = loads(STILL, floating=True)
    assert flying.joint_names == ["root_joint"] and flying.mass == 2.0
    assert np.allclose(dp.com(flying, flying.neutral, engine="numpy"), [0.5, 1, 1.5])
    assert dp.minv(flying, flying.neutral, engine="numpy").shape == (6, 6)


def test_a_robot_without_mass_moves_but_has_no_centre():
    b = Builder("ghost")
    b.joint("hinge", revolute())
    b.joint("slide", prismatic(), "hinge", Pose(position=Vector3(1.0, 0.0, 0.0)))
    r = b.robot()
    x = np.ones(2)
    assert dp.fk(r, x, "slide", engine="numpy").shape == (4, 4)
    assert (dp.rnea(r, x, x, x, engine="numpy") == 0).all() and (dp.crba(r, x, engine="numpy") == 0).all()
    assert not np.isfinite(dp.aba(r, x, x, x, engine="numpy")).any()
    for function in (dp.com, dp.com_jacobian, dp.centroidal_momentum_matrix):
        with pytest.raises(dp.ArgumentError, match="ghost: no moving body has mass"):
            function(r, x, engine="numpy")


def test_one_joint_robots_match_the_pen_and_paper_answer():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        r = loads(
            '<robot name="p"><link name="b"/><link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>'
            '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>'
            '<joint name="hinge" type="continuous"><parent link="b"/><child link="rod"/>'
            '<axis xyz="0 1 0"/></joint></robot>'
        )
    q, v, a = 0.7, -1.1, 2.3
    inertia = 0.1 + 2 * 0.25
    assert np.allclose(dp.crba(r, [q], engine="numpy"), [[inertia]])
    assert np.allclose(dp.gravity(r, [q], engine="numpy"), [2 * 9.81 * 0.5 * np.sin(q)])
    assert np.allclose(dp.rnea(r, [q], [v], [a], engine="numpy"), [inertia * a + 9.81 * np.sin(q)])
    assert np.allclose(dp.coriolis(r, [q], [v], engine="numpy"), [[0]])


@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_a_joint_that_moves_no_mass_has_no_finite_acceleration(engine):
    b = dp.Builder("weightless")
    b.joint("a", dp.model.revolute())
    robot = b.robot()
    assert not np.isfinite(dp.aba(robot, [0.0], [0.0], [1.0], engine=engine)).any()
    assert not np.isfinite(dp.aba(robot, np.zeros((5, 1)), [0.0], [1.0], engine=engine)).any()
    assert dp.rnea(robot, [0.0], [0.0], [1.0], engine=engine).tolist() == [0.0]
