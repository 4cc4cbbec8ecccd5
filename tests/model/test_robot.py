"""The robot and its builder: names, frames, lifting, and adding to what exists."""

from __future__ import annotations

import copy
import dataclasses
import gc
import pickle

import mpmath
import numpy as np
import pytest
import sympy

import dualpin as dp
from dualpin.model import Builder, Floating, Limits, Mimic, Planar, cylindrical, helical, prismatic, revolute
from dualpin.model.frames import key
from dualpin.model.memory import MEMORY
from dualpin.scalars import ONE, ZERO
from dualpin.spatial import Pose, Vector3
from dualpin.tracking import reach
from tests.random_robots import SPECS, random_inertia, random_pose, robot

names = pytest.mark.parametrize("name", SPECS)


def same_dynamics(a: dp.Robot, b: dp.Robot) -> bool:
    q, v, u = a.sample(seed=0)
    return all(
        np.array_equal(getattr(dp, f)(a, *x, engine="numpy"), getattr(dp, f)(b, *x, engine="numpy"))
        for f, x in (("rnea", (q, v, u)), ("crba", (q,)), ("fk", (q,)), ("com", (q,)))
    )


# --- names and frames ----------------------------------------------------------------------------


@names
def test_every_name_leads_to_its_own(name):
    r = robot(name)
    for j in r:
        assert r.joint(j.name) is j
    for i, f in enumerate(r.frames):
        assert r.frame(i) is f and r.frame(f) is f
        assert r.frame(f.name).name == f.name
    assert r.frame(-1) is r.frames[-1] and r.frame_names[-1] == "tool"
    assert r.link_names[0] == "ground"
    assert [j.index for j in r] == list(range(len(r)))
    assert all(j.parent is None or j.parent.index < j.index for j in r)
    assert repr(r) and all(repr(j) for j in r)


def test_a_link_is_meant_where_it_shares_a_joints_name():
    b = Builder("r")
    b.joint("a", revolute(), link="b")
    b.joint("b", prismatic(), "b", Pose(position=Vector3(1.0, 0.0, 0.0)), link="c")
    r = b.robot()
    assert r.frame("b").role == "link" and r.frame("b").joint is r.joint("a")
    assert dp.fk(r, [0, 0], "b", engine="numpy")[0, 3] == 0 and dp.fk(r, [0, 0], "c", engine="numpy")[0, 3] == 1


def test_nobody_modifies_a_robot():
    r = robot("arm")
    for thing, field in ((r, "name"), (r.joints[0], "placement"), (r.frames[0], "name"), (r.links[0], "inertia")):
        with pytest.raises(AttributeError):
            setattr(thing, field, None)


@names
def test_copies_and_pickles_compute_the_same(name):
    r = robot(name)
    dp.gravity(r, r.neutral)  # compiled code is not copied
    assert same_dynamics(copy.copy(r), r)
    assert same_dynamics(copy.deepcopy(r), r)
    assert same_dynamics(pickle.loads(pickle.dumps(r)), r)


def test_gravity_can_be_changed():
    r = robot("arm")
    q, _, _ = r.sample(seed=0)
    moon = r.with_gravity((0, 0, -1.62))
    assert np.allclose(
        dp.gravity(moon, q, engine="numpy"), dp.gravity(r.with_gravity([0, 0, -9.72]), q, engine="numpy") / 6
    )
    assert (dp.gravity(r.with_gravity((0, 0, 0)), q, engine="numpy") == 0).all()
    assert same_dynamics(moon.with_gravity((0.3, -0.2, -9.81)), r)
    for wrong in ((0, 0), "down", None, (0, 0, np.nan), 9.81, (0, 0, -9.81, 0)):
        with pytest.raises(dp.ArgumentError, match="gravity: three finite numbers"):
            r.with_gravity(wrong)
        with pytest.raises(dp.ArgumentError, match="gravity: three finite numbers"):
            Builder("r", gravity=wrong)


# --- building ------------------------------------------------------------------------------------


@names
def test_a_builder_of_a_robot_builds_the_same_robot(name):
    r = robot(name)
    other = Builder.of(r).robot()
    assert same_dynamics(r, other)
    assert other.frame_names == r.frame_names and other.link_names == r.link_names
    assert [f.role for f in other.frames] == [f.role for f in r.frames]
    assert np.array_equal(other.lower, r.lower) and np.array_equal(other.velocity_limit, r.velocity_limit)
    assert [j.mimic for j in other] == [j.mimic for j in r]


def test_a_payload_adds_its_weight_and_leaves_the_robot_alone():
    r, rng = robot("arm"), np.random.default_rng(0)
    q, v, a = r.sample(seed=0)
    before, load = dp.rnea(r, q, v, a, engine="numpy"), random_inertia(rng)
    b = Builder.of(r)
    b.fixed("grip", on="tool", placement=random_pose(rng), inertia=load, link="payload")
    b.joint("finger", prismatic(), on="payload", inertia=load)
    more = b.robot()
    assert more.mass == pytest.approx(r.mass + 2 * load.mass) and more.nv == r.nv + 1
    assert np.array_equal(dp.rnea(r, q, v, a, engine="numpy"), before)
    assert not np.allclose(dp.rnea(more, [*q, 0], [*v, 0], [*a, 0], engine="numpy")[: r.nv], before)


@pytest.mark.parametrize(
    ("build", "match"),
    [
        (lambda b: b.joint("a", revolute()), "'a' of r is defined twice"),
        (lambda b: b.fixed("a"), "'a' of r is defined twice"),
        (lambda b: b.frame("a"), "'a' of r is defined twice"),
        (lambda b: b.joint("x", revolute(), link="la"), "link 'la' of r is defined twice"),
        (lambda b: b.base("la"), "link 'la' of r is defined twice"),
        (lambda b: b.joint("universe", revolute()), "defined twice"),
        (lambda b: b.joint("x", revolute(), on="lb"), "'lb' is not in r yet; did you mean 'la'"),
        (lambda b: b.frame("x", on="nowhere"), "not in r yet"),
        (lambda b: b.joint("x", revolute), "a joint model .* expected"),
        (lambda b: b.joint("x", revolute(), placement=np.eye(4)), "a Pose expected .* got ndarray"),
        (lambda b: b.fixed("x", inertia=3.0), "an Inertia expected, got float"),
        (lambda b: b.frame("x", placement=None), "a Pose expected"),
        (lambda b: Builder.of("panda"), "Builder.of: a Robot expected, got str"),
        (lambda b: b.joint("x", revolute(), armature=(1.0, 2.0)), "2 rotor inertias; 1 expected"),
        (lambda b: b.joint("x", cylindrical(), limits=Limits((0.0,), (1.0,))), "1 lower limits; 2 expected"),
        (lambda b: b.joint("x", revolute(Vector3(0.0, 0.0, 2.0))), "unit axis expected.*length 2"),
        (lambda b: b.joint("x", prismatic(Vector3(ONE, ONE, ZERO))), "unit axis"),
        (lambda b: b.joint("x", helical(Vector3(0.0, 0.0, 0.0), 0.1)), "unit axis"),
        (lambda b: b.joint("x", revolute(Vector3(float("nan"), 0.0, 1.0))), "unit axis"),
        (lambda b: b.joint("x", revolute(), mimic=Mimic("nobody")), "'x' mimics 'nobody', which does not move"),
        (lambda b: b.joint("x", revolute(), mimic=Mimic("x")), "circle"),
        (lambda b: b.joint("x", Floating(), mimic=Mimic("a")), "a floating joint cannot follow another"),
        (lambda b: b.joint("x", cylindrical(), mimic=Mimic("a")), "a cylindrical joint cannot follow another"),
        (
            lambda b: (b.joint("p", Planar()), b.joint("x", revolute(), mimic=Mimic("p"))),
            "planar kind has no single angle",
        ),
    ],
    ids=range(24),
)  # fmt: skip
def test_what_cannot_be_built_is_refused(build, match):
    b = Builder("r")
    b.joint("a", revolute(), link="la")
    with pytest.raises(dp.DualpinError, match=match):
        (build(b), b.robot())


def test_two_joints_that_follow_each_other_are_a_circle():
    b = Builder("r")
    b.joint("a", revolute(), mimic=Mimic("b"))
    b.joint("b", revolute(), mimic=Mimic("a"))
    with pytest.raises(dp.ArgumentError, match="circle of joints that follow each other"):
        b.robot()


def test_a_leader_may_come_later_than_its_followers():
    b = Builder("r")
    b.joint("a", revolute(), mimic=Mimic("c", 2.0, 0.1))
    b.joint("b", prismatic(), "a", mimic=Mimic("a", -1.0))
    b.joint("c", revolute(), "b")
    r = b.robot()
    assert (r.nq, r.nv) == (1, 1) and r.coupled
    T = dp.fk(r, [0.3], engine="numpy")
    assert np.allclose(np.arctan2(T[0, 1, 0], T[0, 0, 0]), 0.7) and np.allclose(T[1, 2, 3], -0.7)


def test_a_circular_slide_is_a_pair_of_joints_in_one():
    """A cylindrical joint is a revolute and a prismatic one on the same axis; a helical one couples them."""
    b = Builder("pair")
    b.joint("c", cylindrical(), inertia=random_inertia(np.random.default_rng(0)))
    one = b.robot()
    b = Builder("twin")
    b.joint("r", revolute())
    b.joint("p", prismatic(), "r", inertia=random_inertia(np.random.default_rng(0)))
    two = b.robot()
    q, v, a = one.sample(5, seed=0)
    for f, x in (("rnea", (q, v, a)), ("crba", (q,)), ("coriolis", (q, v)), ("aba", (q, v, a))):
        assert np.allclose(getattr(dp, f)(one, *x, engine="numpy"), getattr(dp, f)(two, *x, engine="numpy"), atol=1e-13)
    b = Builder("screw")
    b.joint("h", helical(pitch=0.2), inertia=random_inertia(np.random.default_rng(0)))
    G = np.array([[1.0], [0.2]])
    q1, v1, a1 = q[:, :1], v[:, :1], a[:, :1]
    tau = dp.rnea(one, q1 @ G.T, v1 @ G.T, a1 @ G.T, engine="numpy") @ G
    assert np.allclose(dp.rnea(b.robot(), q1, v1, a1, engine="numpy"), tau, atol=1e-13)


# --- other numbers -------------------------------------------------------------------------------


@names
def test_lifting_to_floats_changes_nothing_visible(name):
    r = robot(name)
    q, v, a = r.sample(seed=0)
    lifted = r.lift(float)
    x, y = (dp.rnea(s, q, v, a, engine="numpy") for s in (r, lifted))
    assert np.abs(x - y).max() <= 1e-13 * np.abs(x).max()  # rotations are orthonormalised again
    assert lifted.frame_names == r.frame_names and repr(lifted)


def test_a_lifted_robot_can_be_built_upon():
    with mpmath.workdps(40):
        r = robot("mimic").lift(mpmath.mpf)
        b = Builder.of(r)
        for part in b._parts.values():
            part.mimic = None
        free = b.robot()
        for j in free:  # joints that were followers have unit axes again, in the new numbers
            axis = j.model.axis
            length = axis.dot(axis)
            assert abs(mpmath.mpf(getattr(length, "n", length)) - 1) < mpmath.mpf(10) ** -38
        assert free.nv > r.nv
        assert repr(r)


def test_robots_of_more_digits_run_through_the_array_functions():
    r = robot("floating")
    exact = r.lift(mpmath.mpf)
    assert (r.numbers, exact.numbers) == ("double", "other")
    q, v, a = r.sample(3, seed=0)
    for x in ((q, v, a), (q[0], v[0], a[0])):
        tau = dp.rnea(exact, *x)
        assert tau.dtype == np.float64
        assert np.allclose(tau, dp.rnea(r, *x, engine="numpy"), rtol=1e-12, atol=1e-12)
    assert "kg" in exact.summary() and exact.mass == pytest.approx(r.mass)


def test_symbolic_robots_say_that_they_are():
    m = sympy.Symbol("m")
    b = Builder("letters")
    b.joint("j", revolute(), inertia=random_inertia(np.random.default_rng(0)), armature=(m,))
    r = b.robot()
    assert r.numbers == "symbolic"
    assert "letters" in repr(r) and "symbolic" in r.summary()
    for use in (
        lambda: dp.rnea(r, [0], [0], [0]),
        lambda: dp.crba(r, [0], engine="numpy"),
        lambda: dp.inertial_parameters(r),
        lambda: r.mass,
    ):
        with pytest.raises(dp.ArgumentError, match=r"letters.*symbols|constants of letters are symbols"):
            use()


def test_what_is_computed_for_a_robot_is_kept_beside_it_and_goes_with_it():
    pytest.importorskip("llvmlite")  # kernels are part of it
    robot = dp.load("ur5")
    before = set(vars(robot))
    dp.rnea(robot, *robot.sample(seed=0))
    robot.kernel("fk")
    reach(robot, robot.frame("tool0"))
    lookups = {f.name for f in dataclasses.fields(robot)} | {"nq", "nv", "velocity_limit", "lower", "upper", "numbers"}
    assert set(vars(robot)) - before <= lookups | {"_frame_index", "_bounds", "frame_names", "joint_names", "neutral"}
    serial = robot.serial
    assert MEMORY[serial]
    del robot
    gc.collect()
    assert serial not in MEMORY


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda r: pickle.loads(pickle.dumps(r))])
def test_copies_are_robots_of_their_own(again):
    robot = dp.load("ur5")
    q, v, a = robot.sample(seed=0)
    tau = dp.rnea(robot, q, v, a)
    other = again(robot)
    assert other.serial != robot.serial
    assert np.array_equal(dp.rnea(other, q, v, a), tau)
    heavier = dataclasses.replace(robot, gravity=robot.gravity * 2)
    assert not np.array_equal(dp.gravity(heavier, q), dp.gravity(robot, q))


def test_frames_at_centres_of_mass():
    r = dp.load("panda")
    q, v, _ = r.sample(4, seed=1)
    total, moment = 0.0, 0.0
    for link in (k for k in r.links if not k.inertia.massless and k.joint is not None):
        at = dp.fk(r, q, f"com:{link.name}")
        T, c = dp.fk(r, q, link.name), np.array([float(x) for x in link.inertia.central[0]])
        assert np.abs(at[:, :3, :3] - T[:, :3, :3]).max() < 1e-14
        assert np.abs(at[:, :3, 3] - (T[:, :3, :3] @ c + T[:, :3, 3])).max() < 1e-14
        total, moment = total + float(link.inertia.mass), moment + float(link.inertia.mass) * at[:, :3, 3]
    assert np.abs(moment / total - dp.com(r, q)).max() < 1e-13
    name = "com:panda_link4"
    assert name not in r.frame_names and r.frame(name) is r.frame(name) is r.frame(r.frame(name))
    for reference in ("world", "local", "local_world_aligned"):
        J = dp.jacobian(r, q, name, reference)
        assert np.abs((J @ v[..., None])[..., 0] - dp.frame_velocity(r, q, v, name, reference)).max() < 1e-13
    again = pickle.loads(pickle.dumps(r))
    assert np.array_equal(dp.fk(again, q, again.frame(key(r, r.frame(name)))), dp.fk(r, q, name))
    lifted = r.lift(mpmath.mpf)
    assert np.abs(dp.fk(lifted, q[0], name) - dp.fk(r, q[0], name)).max() < 1e-15
    assert dp.ik(r, dp.fk(r, q, name), name).success.all()
    with pytest.raises(dp.FrameNotFoundError, match="no link 'panda_link44'; did you mean 'panda_link4'"):
        r.frame("com:panda_link44")
    with pytest.raises(dp.ArgumentError, match="'panda_link8' of panda has no mass"):
        r.frame("com:panda_link8")
    with pytest.raises(dp.FrameNotFoundError, match="of another robot"):
        dp.fk(dp.load("ur5"), np.zeros(6), r.frame(name))
    b = Builder("named")
    b.joint("j", revolute(), link="l", inertia=random_inertia(np.random.default_rng(0)))
    b.frame("com:l", "l")
    assert b.robot().frame("com:l").role == "frame"  # names of the description come first


def test_former_names_still_work():
    dh = dp.to_dh(dp.load("ur5"), tip="tool0")
    with pytest.warns(DeprecationWarning, match="Frame.kind is called .role now"):
        assert dp.load("ur5").frame("tool0").kind == "link"
    with pytest.warns(DeprecationWarning, match="DHRow.kind is called .letter now"):
        assert dh.rows[0].kind == "R"
