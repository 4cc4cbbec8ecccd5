"""Base parameters: as many as tables and theory say, regrouped as they say, and they give the torques."""

from __future__ import annotations

import json

import numpy as np
import pytest

import dualpin as dp
from dualpin.errors import ArgumentError, ShapeError
from dualpin.model import Builder, Floating, Planar, cylindrical, helical, prismatic, revolute, spherical
from dualpin.spatial import Pose, Rotation, Vector3
from tests.random_robots import random_inertia, random_pose, tree

UP = -np.pi / 2
PUMA = [(0, 0, 0, -UP), (0, 0, 0.4318, 0), (0, 0.15005, 0.0203, UP), (0, 0.4318, 0, -UP), (0, 0, 0, UP), (0, 0, 0, 0)]
D3, RL4 = 0.45, 0.37
# Staubli RX-90 in Khalil's convention (theta, r, d, alpha), its lengths left general
RX90 = [(0, 0, 0, 0), (0, 0, 0, -UP), (0, 0, D3, 0), (0, RL4, 0, UP), (0, 0, 0, -UP), (0, 0, 0, UP)]
PARTS = ("m", "hx", "hy", "hz", "Jxx", "Jxy", "Jyy", "Jxz", "Jyz", "Jzz")
SEEN = 1e-10
"""Of a row relative to its length: what is left beyond the base is the rounding of a solve with condition 1e2."""


def arm(rows, convention="standard", gravity=(0, 0, -9.81)):
    return dp.from_dh(rows, joints="R" * len(rows), convention=convention, gravity=gravity)


def left_over(base, **combination):
    """How much of a linear combination such as m_3=1, Jxx_2=-1 the base does not contain."""
    names = [f"{part}_{b.index + 1}" for b in base.robot for part in PARTS]
    names += [f"Ia_{b.index + 1}" for model, b, _ in base.parameters.of_joints if model == "rotor"]
    row = np.zeros(len(base.parameters))
    for name, factor in combination.items():
        row[names.index(name)] = factor
    inside = np.linalg.lstsq(base.grouping.T, row, rcond=None)[0]
    return np.abs(base.grouping.T @ inside - row).max() / np.abs(row).max()


@pytest.mark.parametrize(("name", "number"), [("ur10", 36), ("ur5", 36), ("panda", 43 + 2 * 4)])
def test_known_counts_of_arms(name, number):
    """36 of six-axis arms and 43 of seven-axis ones (Mayeda, Yoshida, Osuka 1990); 4 of a slide each."""
    assert len(dp.base_parameters(dp.load(name))) == number


def test_puma_560_has_36_and_40_with_rotors():
    assert len(dp.base_parameters(arm(PUMA))) == 36
    assert len(dp.base_parameters(arm(PUMA), rotors=True)) == 40


def test_a_plane_arm_has_the_parameters_of_the_textbook():
    """Two links: ZZ1 + m2 l^2, ZZ2, MX2, MY2 across gravity; with MX1 + m2 l and MY1 along it."""
    flat = dp.base_parameters(arm([(0, 0, 0, 0), (0, 0, 0.5, 0)], "modified"))
    assert len(flat) == 4
    assert flat.names == ["Jzz[joint_1] + 0.25 m[joint_2]", "hx[joint_2]", "hy[joint_2]", "Jzz[joint_2]"]
    upright = dp.base_parameters(arm([(0, 0, 0, 0), (0, 0, 0.5, 0)], "modified", gravity=(0, -9.81, 0)))
    assert upright.names[:2] == ["hx[joint_1] + 0.5 m[joint_2]", "hy[joint_1]"] and len(upright) == 6


def test_rx90_is_regrouped_as_the_table_of_khalil_and_dombre():
    """Their 40 parameters (Modeling, Identification and Control of Robots, 2002, chapter 9) lie in ours and fill it.

    With rotors: 15 are regrouped, 25 stand for themselves.
    """
    base = dp.base_parameters(arm(RX90, "modified"), rotors=True)
    far, wrist = dict.fromkeys(("m_3", "m_4", "m_5", "m_6"), 1.0), dict.fromkeys(("m_4", "m_5", "m_6"), 1.0)

    def times(x, masses):
        return dict.fromkeys(masses, x)

    forearm = {"Jyy_4": 1, "hz_4": 2 * RL4, **times(RL4**2, wrist)}
    table = [
        {"Jzz_1": 1, "Ia_1": 1, "Jyy_2": 1, "Jyy_3": 1, **times(D3**2, far)},
        {"Jxx_2": 1, "Jyy_2": -1, **times(-(D3**2), far)},
        {"Jxz_2": 1, "hz_3": -D3},
        {"Jzz_2": 1, "Ia_2": 1, **times(D3**2, far)},
        {"hx_2": 1, **times(D3, far)},
        {"Jxx_3": 1, "Jyy_3": -1, **forearm},
        {"Jzz_3": 1, **forearm},
        {"hy_3": 1, "hz_4": 1, **times(RL4, wrist)},
        {"Jxx_4": 1, "Jyy_4": -1, "Jyy_5": 1},
        {"Jzz_4": 1, "Jyy_5": 1},
        {"hy_4": 1, "hz_5": -1},
        {"Jxx_5": 1, "Jyy_5": -1, "Jyy_6": 1},
        {"Jzz_5": 1, "Jyy_6": 1},
        {"hy_5": 1, "hz_6": 1},
        {"Jxx_6": 1, "Jyy_6": -1},
    ]
    alone = [
        "Jxy_2",
        "Jyz_2",
        "hy_2",
        "Jxy_3",
        "Jxz_3",
        "Jyz_3",
        "hx_3",
        "Ia_3",
        "Jxy_4",
        "Jxz_4",
        "Jyz_4",
        "hx_4",
        "Ia_4",
    ]
    alone += ["Jxy_5", "Jxz_5", "Jyz_5", "hx_5", "Ia_5", "Jxy_6", "Jxz_6", "Jyz_6", "Jzz_6", "hx_6", "hy_6", "Ia_6"]
    table += [{name: 1.0} for name in alone]
    assert len(base) == 40 == len(table)
    assert [row for row in table if left_over(base, **row) > SEEN] == []


def on_a_free_base(model, seed=0):
    rng = np.random.default_rng(seed)
    b = Builder("rig")
    b.joint("root_joint", Floating(), None, inertia=random_inertia(rng))
    b.joint("joint", model, "root_joint", random_pose(rng), random_inertia(rng))
    return b.robot()


AXIS = Vector3(*(np.array([1.0, 2.0, 3.0]) / 14**0.5).tolist())
THEORY = {
    # An inertia counts as the parent's if the joint's motion neither turns nor shifts it in the parent's
    # axes, and gives it no momentum: 10 less the dimension of those.
    "revolute": (revolute(AXIS), 7),  # m, h along the axis, Jxx + Jyy
    "prismatic": (prismatic(AXIS), 4),  # the six of J
    "helical": (helical(AXIS, 0.2), 9),  # Jxx + Jyy
    "cylindrical": (cylindrical(AXIS), 9),  # Jxx + Jyy
    "planar": (Planar(), 9),  # Jxx + Jyy
    "spherical": (spherical(), 9),  # m
}


@pytest.mark.parametrize("kind", THEORY)
def test_each_joint_adds_to_a_free_body_what_theory_says(kind):
    model, number = THEORY[kind]
    base = dp.base_parameters(on_a_free_base(model))
    assert len(base) == 10 + number
    assert base.margin.kept > 1e-3 and base.margin.dropped < 1e-12


@pytest.mark.parametrize(("name", "floating"), [("ur5", False), ("panda", False), ("talos", True)])
def test_pinocchio_has_as_many(name, floating):
    """The rank of Pinocchio's own regressor, by singular values, in its own random states."""
    pin = pytest.importorskip("pinocchio")
    robot = dp.load(name, floating=floating)
    model = pin.buildModelFromUrdf(robot.source, *([pin.JointModelFreeFlyer()] if floating else []))
    data, rows, rng = model.createData(), [], np.random.default_rng(1)
    lower = np.full(model.nq, -3.0)
    for _ in range(4 + 40 * model.njoints // model.nv):
        q = pin.randomConfiguration(model, lower, -lower)
        v, a = rng.standard_normal((2, model.nv))
        rows.append(pin.computeJointTorqueRegressor(model, data, q, 3 * v, 9 * a))
    W = np.vstack(rows)
    size = np.linalg.norm(W, axis=0)
    W = W[:, size > 1e-9 * size.max()] / size[size > 1e-9 * size.max()]
    assert len(dp.base_parameters(robot)) == np.linalg.matrix_rank(W, tol=1e-9)


def test_followers_are_counted_by_pinocchios_regressor_too():
    """tau of coupled joints is G^T tau of free ones, with q = G x + offset."""
    pin = pytest.importorskip("pinocchio")
    robot, free = dp.load("panda", mimic=True), dp.load("panda")
    model = pin.buildModelFromUrdf(robot.source)
    G = np.vstack([np.eye(8), np.eye(8)[7]])
    q, v, a = np.random.default_rng(0).uniform(-2, 2, (3, 60, 8)) @ G.T
    data = model.createData()
    W = np.vstack([G.T @ pin.computeJointTorqueRegressor(model, data, *x) for x in zip(q, v, a, strict=True)])
    size = np.linalg.norm(W, axis=0)
    W = W[:, size > 1e-9 * size.max()] / size[size > 1e-9 * size.max()]
    found = len(dp.base_parameters(robot))
    assert found == np.linalg.matrix_rank(W, tol=1e-9) < len(dp.base_parameters(free))


KINDS = ("floating", "spherical", "revolute", "prismatic", "helical", "cylindrical", "planar", "revolute")


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "options", [{}, {"friction": True}, {"rotors": True, "friction": ("offset", "viscous")}], ids=str
)
def test_they_give_the_torques_of_any_tree(seed, options):
    robot = tree(KINDS[seed % 2 :], seed, armature=bool(seed % 2), mimics=seed % 3)
    base = dp.base_parameters(robot, **options)
    q, v, a = robot.sample(20, seed=seed)
    rng = np.random.default_rng(seed)
    p = rng.standard_normal(len(base.parameters))
    whole = base.parameters.regressor(q, v, a, "numpy") @ p
    assert np.abs(base.regressor(q, v, a, "numpy") @ base.values(p) - whole).max() < 1e-11 * np.abs(whole).max()
    if not options:
        tau = dp.rnea(robot, q, v, a, engine="numpy")
        said = base.regressor(q, v, a, "numpy") @ base.values(dp.inertial_parameters(robot))
        assert np.abs(said - tau).max() < 1e-11 * np.abs(tau).max()


def test_friction_of_the_description_is_its_nominal_value():
    robot = dp.load("panda")
    base = dp.base_parameters(robot, friction="viscous")
    q, v, a = robot.sample(5, seed=0)
    damped = dp.rnea(robot, q, v, a) + v * [b.damping for b in robot]
    assert np.allclose(base.regressor(q, v, a) @ base.values(), damped, rtol=0, atol=1e-11)


def test_a_motion_shows_less_than_any_motion():
    robot = dp.load("ur5")
    q, v, a = robot.sample(100, seed=0)
    assert len(dp.base_parameters(robot, (q, v, a))) == 36
    still = dp.base_parameters(robot, (q, 0 * v, 0 * a))  # gravity alone
    model = [("unseen", "Jzz[wrist_3_joint]"), ("regrouped", "m[elbow_joint]"), ("alone", "hx[wrist_3_joint]")]
    assert len(still) < 36 and all(still.identifiable[name] == what for what, name in model)
    one = np.zeros((50, 6)), np.zeros((50, 6)), np.zeros((50, 6))
    assert len(dp.base_parameters(robot, one)) <= 6


def test_long_motions_are_taken_block_by_block(monkeypatch):
    from dualpin.analysis.identification import base as module

    robot = dp.load("ur5")
    motion = robot.sample(500, seed=0)
    whole = dp.base_parameters(robot, motion)
    monkeypatch.setattr(module, "BLOCK", 40_000)
    parts = dp.base_parameters(robot, motion)
    assert parts.columns.tolist() == whole.columns.tolist()
    assert np.allclose(parts.grouping, whole.grouping, atol=1e-10)


def test_rounded_right_angles_are_said_to_be_doubtful():
    b = Builder("rounded")
    b.joint("a", revolute(), None)
    b.joint("b", revolute(), "a", Pose(Rotation.about(Vector3(1.0, 0.0, 0.0), 3.7e-6), Vector3(0.3, 0.0, 0.0)))
    base = dp.base_parameters(b.robot())
    assert base.margin.doubtful and base.margin.kept < 1e-4
    assert len(dp.base_parameters(b.robot(), tolerance=1e-4)) == 4 < len(base)


def test_what_is_odd_is_answered():
    robot = dp.load("ur5")
    still = Builder("still").robot()
    assert len(dp.base_parameters(still)) == 0 and dp.base_parameters(still).names == []
    for bad, match in [
        ({"friction": "stribeck"}, "viscous"), ({"friction": 3}, "True or False"), ({"rotors": "yes"}, "True or False"),
        ({"motion": (np.full((3, 6), np.nan),) * 3}, "finite"),
        ({"tolerance": -1}, "tolerance"), ({"motion": np.zeros(3)}, "three arrays"),
    ]:  # fmt: skip
        with pytest.raises(ArgumentError, match=match):
            dp.base_parameters(robot, **bad)
    with pytest.raises(ArgumentError, match="a Robot expected"):
        dp.base_parameters("ur5")
    with pytest.raises(ShapeError, match="60"):
        dp.base_parameters(robot).values(np.zeros(59))
    with pytest.raises(ShapeError):
        dp.base_parameters(robot, (np.zeros((3, 5)), np.zeros((3, 6)), np.zeros((3, 6))))
    assert json.dumps(dp.base_parameters(robot).identifiable)
