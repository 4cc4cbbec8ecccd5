"""Robots put together: bodies, tools and other robots attached, and motors with gears."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
import sympy

import dualpin as dp
from dualpin.crosscheck.oracles.pinocchio_model import assembled
from dualpin.io.urdf import loads
from dualpin.model import Builder, Mimic, Rotor, cylindrical, prismatic, revolute, spherical
from dualpin.spatial import Pose
from tests.random_robots import SPECS, random_inertia, random_pose, robot, tree

TIGHT = 1e-12
TERMS = (("rnea", 3), ("crba", 1), ("coriolis", 2), ("gravity", 1), ("kinetic_energy", 2), ("potential_energy", 1),
         ("centroidal_momentum_matrix", 1), ("joint_wrenches", 3), ("fk", 1))  # fmt: skip


def scaled(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.abs(np.asarray(x) - y).max(initial=0.0) / max(1.0, np.abs(y).max(initial=0.0)))


def renamed(r: dp.Robot, prefix: str) -> dp.Robot:
    b = Builder(r.name, gravity=[float(x) for x in r.gravity])
    b.include(r, prefix=prefix)
    return b.robot()


# --- attach --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SPECS)
def test_a_robot_included_in_nothing_is_itself(name, seed):
    r = robot(name)
    same = renamed(r, "x/")
    q, v, a = r.sample(seed=seed)
    assert same.joint_names == ["x/" + n for n in r.joint_names]
    assert same.frame_names == ["universe", *("x/" + n for n in r.frame_names[1:])]
    for term, n in TERMS:
        x, y = (getattr(dp, term)(z, *(q, v, a)[:n], engine="numpy") for z in (r, same))
        assert np.array_equal(x, y), term


@pytest.mark.parametrize("engine", ["numpy", "auto"])
@pytest.mark.parametrize("how", ["rigid", "passive", "on a ball"])
def test_old_links_keep_their_terms_to_the_bit(how, engine, seed):
    """All but the one that carries rigidly what stood on the other's ground: its term is the sum."""
    rng, arm, other = np.random.default_rng(seed), tree(("revolute", "prismatic", "revolute"), 3), robot("branched")
    options = {"passive": {"passive": True}, "on a ball": {"joint": spherical()}}.get(how, {})
    both = arm.attach(other, "link1", random_pose(rng), prefix="b_", **options)
    assert both.joint_names[: len(arm)] == arm.joint_names and both.nv > arm.nv + other.nv - 1
    assert both.mass == pytest.approx(
        arm.mass + other.mass + sum(float(k.inertia.mass) for k in other.links if k.joint is None)
    )
    q, v, _ = both.sample(seed=seed)
    old = dp.link_terms(arm, q[: arm.nq], v[: arm.nv], engine=engine)
    new = dp.link_terms(both, q, v, engine=engine)
    for i, term in enumerate(old):
        if how == "rigid" and i == arm.joint("joint1").index:
            continue
        for part in ("M", "C", "g"):
            padded = np.zeros_like(getattr(new[i], part))
            padded[tuple(slice(arm.nv) for _ in padded.shape)] = getattr(term, part)
            assert np.array_equal(getattr(new[i], part), padded), (i, part)
    assert scaled(sum(t.M for t in new), dp.crba(both, q, engine=engine)) < TIGHT


def test_what_is_attached_is_the_chain_described_at_once(seed):
    """An arm and a hand on it, against one robot described joint by joint."""
    rng = np.random.default_rng(seed)
    places, bodies = [random_pose(rng) for _ in range(6)], [random_inertia(rng) for _ in range(6)]
    whole, arm, hand = Builder("whole"), Builder("arm"), Builder("hand")
    arm.joint("a", revolute(), None, places[0], bodies[0])
    arm.joint("b", cylindrical(), "a", places[1], bodies[1])
    arm.frame("flange", "b", places[2])
    hand.base("palm", bodies[2])
    hand.joint("c", prismatic(), "palm", places[3], bodies[3], armature=[0.3])
    hand.joint("d", prismatic(), "palm", places[4], bodies[4], mimic=Mimic("c", -1.5, 0.1))
    made = arm.robot().attach(hand.robot(), "flange", places[5], prefix="h_")
    whole.joint("a", revolute(), None, places[0], bodies[0])
    whole.joint("b", cylindrical(), "a", places[1], bodies[1])
    whole.fixed("palm", "b", places[2] @ places[5], bodies[2])
    whole.joint("c", prismatic(), "palm", places[3], bodies[3], armature=[0.3])
    whole.joint("d", prismatic(), "palm", places[4], bodies[4], mimic=Mimic("c", -1.5, 0.1))
    expected = whole.robot()
    assert made.joint_names == ["a", "b", "h_c", "h_d"] and made.frame_names[-1] == "h_d"
    q, v, a = expected.sample(seed=seed)
    for term, n in TERMS:
        x, y = (getattr(dp, term)(z, *(q, v, a)[:n], engine="numpy") for z in (made, expected))
        assert scaled(x, y) < TIGHT, term
    assert scaled(dp.fk(made, q, "h_palm"), dp.fk(expected, q, "palm")) < TIGHT


def test_composed_robots_are_pinocchios(seed):
    pin = pytest.importorskip("pinocchio")
    arm = tree(("revolute",) * 3, seed, branching=0.0, armature=True)
    tool = tree(("spherical", "prismatic"), seed + 1, branching=0.0)
    r = arm.attach(tool, "tool", random_pose(np.random.default_rng(seed)), prefix="t_").attach(
        random_inertia(np.random.default_rng(1)), "t_tool", passive=True
    )
    from dualpin.crosscheck.oracles.pinocchio import Layout

    m = assembled(r)
    to, d = Layout(r, m), m.createData()
    q, v, a = r.sample(seed=seed)
    assert scaled(dp.rnea(r, q, v, a), pin.rnea(m, d, to.q(q), to.v(v), to.v(a)) @ to.G) < TIGHT
    upper = np.triu(pin.crba(m, d, to.q(q)))
    assert scaled(dp.crba(r, q), to.G.T @ (upper + np.triu(upper, 1).T) @ to.G) < TIGHT


def test_several_bodies_on_one_link():
    rng, arm = np.random.default_rng(2), dp.load("ur5")
    bodies = [random_inertia(rng) for _ in range(3)]
    held = arm
    for body in bodies:
        held = held.attach(body, on="tool0")
    assert held.link_names[-3:] == ["payload", "payload_2", "payload_3"]
    once = arm.attach(bodies[0] + bodies[1] + bodies[2], on="tool0")
    q, v, a = arm.sample(seed=0)
    assert scaled(dp.rnea(held, q, v, a), dp.rnea(once, q, v, a)) < TIGHT
    assert "com:payload_2" not in held.frame_names and dp.fk(held, q, "com:payload_2").shape == (4, 4)
    on_com = arm.attach(bodies[0], on="com:forearm_link")
    assert scaled(dp.fk(on_com, q, "payload"), dp.fk(arm, q, "com:forearm_link")) < TIGHT
    assert scaled(dp.fk(arm.attach(bodies[0], on=arm.frame("tool0")), q, "payload"), dp.fk(arm, q, "tool0")) < TIGHT


def test_a_passive_joint_stays_passive():
    arm = dp.load("ur5").attach(random_inertia(np.random.default_rng(0)), passive=True)
    again = pickle.loads(pickle.dumps(arm))
    for r in (arm, again, copy.copy(arm), arm.with_gravity((0, 0, 0)), Builder.of(arm).robot()):
        assert [j.name for j in r if j.passive] == ["payload"]
    pushed = dp.simulate(arm, arm.neutral, np.zeros(7), np.r_[np.zeros(6), 5.0], dt=1e-3, t_end=0.05)
    swung = dp.simulate(arm, arm.neutral, np.zeros(7), dt=1e-3, t_end=0.05)
    assert np.array_equal(pushed.q, swung.q)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda r: r.attach("panda"), "an Inertia or a Robot expected, got str"),
        (lambda r: r.attach(r), "both have the names .*'shoulder_pan_joint'.*prefix"),
        (lambda r: r.attach(r, "tol0", prefix="x"), "did you mean 'tool0'"),
        (lambda r: r.attach(random_inertia(np.random.default_rng(0)), joint="R"), "a joint model"),
        (lambda r: r.attach(random_inertia(np.random.default_rng(0)), placement=np.eye(4)), "a Pose expected"),
        (lambda r: r.attach(random_inertia(np.random.default_rng(0)), name="elbow_joint"), "defined twice"),
    ],
)  # fmt: skip
def test_bad_attachments_are_explained(make, words):
    with pytest.raises(dp.DualpinError, match=words):
        make(dp.load("ur5"))


# --- rotors --------------------------------------------------------------------------------------


def test_a_geared_rotor_is_felt_by_the_square_of_its_ratio(seed):
    rng = np.random.default_rng(seed)
    body, place = random_inertia(rng), random_pose(rng)
    b, plain = Builder("geared"), Builder("plain")
    for x, rotor in ((b, Rotor(2e-4, 50.0, body)), (plain, None)):
        x.joint("a", revolute(), None, place, random_inertia(np.random.default_rng(1)))
        x.joint("b", revolute(), "a", place, random_inertia(np.random.default_rng(2)), armature=[0.1], rotor=rotor)
    r, bare = b.robot(), plain.robot()
    assert r.joint("b").armature == (pytest.approx(0.1 + 2e-4 * 2500),) and r.link_names == ["a", "b_rotor", "b"]
    carried = bare.attach(body, "a", place)
    q, v, a = r.sample(seed=seed)
    more = np.diag([0.0, 2e-4 * 2500])
    assert scaled(dp.crba(r, q), dp.crba(carried, q) + more) < TIGHT
    assert scaled(dp.rnea(r, q, v, a), dp.rnea(carried, q, v, a) + more @ a) < TIGHT
    assert scaled(dp.gravity(r, q), dp.gravity(carried, q)) < TIGHT
    assert r.mass == pytest.approx(bare.mass + float(body.mass))
    assert scaled(sum(t.M for t in dp.link_terms(r, q, v)), dp.crba(r, q)) < TIGHT
    assert scaled(dp.joint_torque_regressor(r, q, v, a) @ dp.inertial_parameters(r), dp.rnea(r, q, v, a)) < TIGHT
    later = bare.with_rotors({"b": Rotor((0.1 + 0.5) / 2500, 50.0, body)})
    assert scaled(dp.rnea(later, q, v, a), dp.rnea(r, q, v, a)) < TIGHT
    assert later.with_rotors({"b": 0.0}).joint("b").armature == (0.0,)


TRANSMISSION = '<transmission name="t"><type>SimpleTransmission</type>{}</transmission>'


@pytest.mark.parametrize(
    ("text", "ratio"),
    [
        ('<joint name="j"/><actuator name="m"><mechanicalReduction>100</mechanicalReduction></actuator>', 100.0),
        ('<joint name="j"/><actuator name="m"/><mechanicalReduction> -79.2 </mechanicalReduction>', -79.2),
        ('<joint name="j"><mechanicalReduction>2</mechanicalReduction></joint><actuator name="m"/>', 2.0),
        ('<joint name="j"/><actuator name="m"/>', None),
        ('<joint name="j"/><joint name="k"/><mechanicalReduction>3</mechanicalReduction>', None),
        ('<joint name="other"/><mechanicalReduction>3</mechanicalReduction>', None),
        ('<joint name="j"/><mechanicalReduction>0</mechanicalReduction>', "note"),
        ('<joint name="j"/><mechanicalReduction>${ratio}</mechanicalReduction>', "note"),
        ('<joint name="j"/><mechanicalReduction/>', "note"),
    ],
)
def test_a_urdfs_transmission_gives_the_ratio_and_changes_no_term(text, ratio):
    body = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    r = loads(
        f'<robot name="r"><link name="a"/><link name="b">{body}</link><joint name="j" type="continuous">'
        f'<parent link="a"/><child link="b"/></joint>{TRANSMISSION.format(text)}</robot>'
    )
    j = r.joint("j")
    assert float(j.armature[0]) == 0 and float(dp.crba(r, [0.0], engine="numpy")[0, 0]) == 1.0
    assert any("mechanicalReduction" in n for n in r.notes) == (ratio == "note")
    if isinstance(ratio, float):
        assert j.rotor == Rotor(ratio=ratio)
        assert loads(r.to_urdf()).joint("j").rotor == j.rotor
        geared = r.with_rotors({"j": 1e-3})
        assert float(dp.crba(geared, [0.0], engine="numpy")[0, 0]) == pytest.approx(1 + 1e-3 * ratio**2)
    else:
        assert j.rotor is None


@pytest.mark.parametrize(
    ("rotors", "words"),
    [
        ({"elbw": 1.0}, "did you mean 'elbow_joint'"),
        ({"elbow_joint": -1.0}, "inertia of its rotor is -1.0"),
        ({"elbow_joint": "1"}, "inertia of its rotor is 1"),
        ({"elbow_joint": Rotor(1.0, 0.0)}, "ratio of its rotor is 0.0"),
        ({"elbow_joint": Rotor(1.0, np.nan)}, "ratio of its rotor is nan"),
        ([1.0], "a mapping of joint names"),
    ],
)
def test_bad_rotors_are_explained(rotors, words):
    with pytest.raises(dp.DualpinError, match=words):
        dp.load("ur5").with_rotors(rotors)
    b = Builder("ball")
    b.joint("j", spherical())
    with pytest.raises(dp.ArgumentError, match="joint of one coordinate, not to a spherical"):
        b.robot().with_rotors({"j": 1.0})


def test_rotors_of_symbols():
    """The ratio and the inertia of a motor stay letters in M."""
    I, n = sympy.symbols("I_m n", positive=True)
    b = Builder("pendulum")
    b.joint("j", revolute(), inertia=random_inertia(np.random.default_rng(0)), rotor=Rotor(I, n))
    b.joint("k", revolute(), "j", Pose(), random_inertia(np.random.default_rng(1)))
    M = dp.algorithms.crba.crba(b.robot(), sympy.symbols("q1 q2"))
    assert sympy.expand(M[0][0]).coeff(I) == n**2 and sympy.expand(M[1][1]).coeff(I) == 0
