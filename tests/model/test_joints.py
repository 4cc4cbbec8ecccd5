"""What joint models declare; the ball joint; and the recipe "a joint" of CONTRIBUTING.md, followed."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.oracles.pinocchio import Pinocchio
from dualpin.io.urdf import loads
from dualpin.model import Builder, Floating, JointModel, Planar, cylindrical, helical, prismatic, revolute, spherical
from dualpin.model.joints import Written
from dualpin.spatial import AXES, Pose, Quaternion, Vector3, displaced
from dualpin.spatial.vector import ZERO_VECTOR, motor
from tests.random_robots import random_inertia, random_pose, robot, tree

MODELS = [revolute(), prismatic(), helical(pitch=0.1), cylindrical(), Planar(), Floating(), spherical()]
BALLS = ("ball", "spherical", "floating_spherical")
models = pytest.mark.parametrize("model", MODELS, ids=lambda m: m.kind)
balls = pytest.mark.parametrize("name", BALLS)


def scaled(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.abs(np.asarray(x) - y).max(initial=0.0) / max(1.0, np.abs(y).max(initial=0.0)))


# --- what a model declares is true of it ---------------------------------------------------------


@models
def test_counts_and_names_fit(model):
    assert model.nq == len(model.neutral) == len(model.coordinates)
    assert model.nv == len(model.screws) == len(model.velocity_names) == len(set(model.velocity_names))
    assert all(i + 4 <= model.nq and model.coordinates[i : i + 4] == ("quaternion",) * 4 for i in model.quaternions)
    assert model.additive or model.layout


@models
def test_coordinates_add_where_the_model_says_so(model, seed):
    q, v = alone(model).sample(seed=seed)[:2]
    there = [float(x) for x in model.integrate(q.tolist(), v.tolist())]
    assert model.additive == (model.nq == model.nv and bool(np.allclose(there, q + v, atol=1e-9)))


@models
def test_the_bracket_is_how_much_two_motions_fail_to_commute(model, seed):
    """exp(u) exp(v) exp(-u) exp(-v) = exp([u, v] + third order)."""
    rng, h = np.random.default_rng(seed), 1e-4
    u, v = rng.uniform(-1, 1, (2, model.nv))
    q = list(model.neutral)
    for step in (u, v, -u, -v):
        q = [float(x) for x in model.integrate(q, (h * step).tolist())]
    moved = np.array([float(x) for x in model.difference(list(model.neutral), q)])
    bracket = np.array([float(x) for x in model.bracket(u.tolist(), v.tolist())])
    assert np.abs(moved / h**2 - bracket).max() < 10 * h  # terms of third order in u and v of size 1


def alone(model: JointModel) -> dp.Robot:
    b = Builder("one")
    b.joint("j", model)
    return b.robot()


# --- the ball joint ------------------------------------------------------------------------------


@balls
def test_compiled_terms_are_those_of_the_source(name, seed):
    r = robot(name)
    q, v, a = r.sample(7, seed=seed)
    for term, inputs in (
        ("rnea", (q, v, a)), ("joint_wrenches", (q, v, a)), ("crba", (q,)), ("coriolis", (q, v)),
        ("aba", (q, v, a)), ("fk", (q,)),
        ("integrate", (q, 0.1 * v)), ("difference", (q, q[::-1])), ("rnea_derivatives", (q, v, a)),
    ):  # fmt: skip
        if term == "difference" and name == "floating_spherical":
            continue  # no difference where its planar joint has turned whole turns and moved
        f = getattr(dp, term)
        assert scaled(np.array(f(r, *inputs)), np.array(f(r, *inputs, engine="numpy"))) < 1e-10, term


@balls
def test_frames_steps_and_differences_are_pinocchios(name, seed):
    pin = pytest.importorskip("pinocchio")
    kinds = {"ball": ("spherical",), "spherical": ("spherical", "revolute", "spherical")}.get(name)
    r = tree(kinds or ("floating", "spherical", "prismatic", "spherical"), seed, depth_first=True)
    q, v, a = r.sample(seed=seed)
    to = Pinocchio.of_robot(r).free
    m, d = to.model, to.model.createData()
    six = [3, 4, 5, 0, 1, 2]
    pin.forwardKinematics(m, d, to.q(q), to.v(v), to.v(a))
    pin.computeJointJacobiansTimeVariation(m, d, to.q(q), to.v(v))
    pin.updateFramePlacements(m, d)
    f = m.getFrameId("tool")
    assert scaled(dp.fk(r, q, "tool", engine="numpy"), d.oMf[f].homogeneous) < 1e-13
    for ours, theirs in (
        ("world", pin.WORLD), ("local", pin.LOCAL), ("local_world_aligned", pin.LOCAL_WORLD_ALIGNED)
    ):  # fmt: skip
        J, dJ = pin.getFrameJacobian(m, d, f, theirs), pin.getFrameJacobianTimeVariation(m, d, f, theirs)
        acceleration = pin.getFrameAcceleration(m, d, f, theirs).vector
        assert scaled(dp.jacobian(r, q, "tool", ours, engine="numpy"), J[six] @ to.G) < 1e-13
        assert scaled(dp.jacobian_dot(r, q, v, "tool", ours, engine="numpy"), dJ[six] @ to.G) < 1e-12
        assert scaled(dp.frame_acceleration(r, q, v, a, "tool", ours, engine="numpy"), acceleration[six]) < 1e-12
    step = 0.3 * v
    there = dp.integrate(r, q, step, engine="numpy")
    poses = dp.fk(r, there, engine="numpy")
    pin.forwardKinematics(m, d, pin.integrate(m, to.q(q), to.v(step)))
    assert scaled(poses, np.array([X.homogeneous for X in d.oMi][1:])) < 1e-13
    assert scaled(to.v(dp.difference(r, q, there, engine="numpy")), pin.difference(m, to.q(q), to.q(there))) < 1e-12


def test_a_ball_is_three_revolute_joints_at_one_point():
    """At q = 1 the three screws of a ball and of joints about x, y, z at zero are the same, so are M and g."""
    rng = np.random.default_rng(3)
    at, body = random_pose(rng), random_inertia(rng)
    ball, three = Builder("ball"), Builder("three")
    ball.joint("j", spherical(), placement=at, inertia=body)
    for i, axis in enumerate(AXES):
        three.joint(f"j{i}", revolute(axis), f"j{i - 1}" if i else None, Pose() if i else at, body if i == 2 else None)
    a, b = ball.robot(), three.robot()
    for term in ("crba", "gravity"):
        x, y = (getattr(dp, term)(r, r.neutral, engine="numpy") for r in (a, b))
        assert scaled(x, y) < 1e-14


def test_a_quaternion_must_be_a_unit_one():
    r = robot("spherical")
    q, v, a = r.sample(5, seed=0)
    at = r.joints[3].quaternions[0]
    q[3, at] *= 1.01
    for f in (lambda: dp.rnea(r, q, v, a), lambda: r.kernel("rnea")(q, v, a), lambda: dp.fk(r, q, engine="numpy")):
        with pytest.raises(dp.ArgumentError, match=rf"q\[{at.start}:{at.stop}\] of joint 'joint3' .* at sample \(3,\)"):
            f()
    with pytest.raises(dp.ArgumentError, match="unit quaternion"):
        dp.rnea(r, np.zeros(r.nq), v[0], a[0])


def test_samples_are_uniform_rotations():
    """Of uniform rotations every entry of R averages 0, its square 1/3; 4 sigma of 4000 samples."""
    R = dp.fk(alone(spherical()), alone(spherical()).sample(4000, seed=1)[0], engine="numpy")[:, 0, :3, :3]
    assert np.abs(R.mean(axis=0)).max() < 4 * (1 / 3 / 4000) ** 0.5
    assert np.abs((R**2).mean(axis=0) - 1 / 3).max() < 4 * (4 / 45 / 4000) ** 0.5


def test_a_free_top_keeps_its_energy_and_momentum():
    """Euler's top, tumbling about its middle axis: no torque, so T and R L stay (method of order 4, dt 1 ms)."""
    b = Builder("top", gravity=(0, 0, 0))
    body = dp.mechanisms.body(1.0, [0, 0, 0], np.diag([1.0, 2.0, 3.0]))
    b.joint("ball", spherical(), inertia=body)
    r = b.robot()
    run = dp.simulate(r, r.neutral, [0.01, 2.0, 0.01], method="rkmk4", dt=1e-3, t_end=9.0)
    assert run.energy_drift < 1e-10 and run.momentum_drift < 1e-10
    assert np.ptp(run.v[:, 1]) > 3.9  # it has turned over
    assert np.abs(np.linalg.norm(run.q, axis=-1) - 1).max() < 1e-13


def test_inverse_kinematics_through_a_ball():
    r = tree(("spherical", "revolute", "revolute", "spherical"), 5, branching=0.0)
    q, _, _ = r.sample(4, seed=1)
    found = dp.ik(r, dp.fk(r, q, "tool"), "tool")
    assert found.success.all()
    assert scaled(dp.fk(r, found.q, "tool"), dp.fk(r, q, "tool")) < 1e-8


def test_descriptions_speak_of_it():
    r = robot("floating_spherical")
    text = r.summary()
    assert "spherical: q = qw qx qy qz" in text and "floating: q = x y z" in text and "planar: q = x y angle" in text
    from dualpin.crosscheck.where import velocity_names

    assert velocity_names(r)[6:9] == ["joint1 wx", "joint1 wy", "joint1 wz"]


def test_urdf_has_no_ball():
    with pytest.raises(dp.ArgumentError, match="to_urdf: joint 'j' is spherical, and URDF has no such joint"):
        alone(spherical()).to_urdf()
    for kind in ("spherical", "ball"):
        with pytest.raises(dp.UrdfError, match=kind):
            loads(
                f'<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="{kind}">'
                '<parent link="a"/><child link="b"/></joint></robot>'
            )
    b = Builder("follower")
    b.joint("a", revolute())
    b.joint("j", spherical(), "a", mimic=dp.model.robot.Mimic("a"))
    with pytest.raises(dp.ArgumentError, match="spherical joint cannot follow"):
        b.robot()


# --- the recipe ----------------------------------------------------------------------------------


class Translation(JointModel):
    """Slides along three axes.  q = (x, y, z)."""

    kind, nq, neutral = "translation", 3, (0.0, 0.0, 0.0)
    coordinates, velocity_names = ("length",) * 3, ("x", "y", "z")
    screws = tuple(motor(ZERO_VECTOR, a) for a in AXES)

    def motion(self, q: Sequence) -> Pose:
        return Pose(position=Vector3(*q))

    def quaternion(self, q: Sequence) -> Quaternion:
        return displaced(Quaternion(1.0, 0.0, 0.0, 0.0), Vector3(*q))

    def written(self) -> tuple[Written, ...]:
        return tuple(Written("prismatic", a, i, ("", "_y", "_z")[i]) for i, a in enumerate(AXES))


def gantry(seed: int, whole: bool) -> dp.Robot:
    """A carriage that carries an arm: one translation, or three prismatic joints and massless links."""
    rng, b = np.random.default_rng(seed), Builder("gantry")
    at, carriage, arm = random_pose(rng), random_inertia(rng), random_inertia(rng)
    if whole:
        b.joint("rail", Translation(), placement=at, inertia=carriage, link="carriage")
    else:
        for i, axis in enumerate(AXES):
            b.joint(f"rail{i}", prismatic(axis), f"rail{i - 1}" if i else None, Pose() if i else at,
                    carriage if i == 2 else None, link="carriage" if i == 2 else None)  # fmt: skip
    b.joint("arm", revolute(), "carriage", random_pose(rng), arm)
    return b.robot()


def test_a_new_joint_needs_its_model_and_nothing_else(seed):
    """Terms, compiled or not, samples, groups, drawing, and URDF: none knows its name."""
    r, same = gantry(seed, whole=True), gantry(seed, whole=False)
    q, v, a = r.sample(6, seed=seed)
    for f, x in ((dp.rnea, (q, v, a)), (dp.crba, (q,)), (dp.coriolis, (q, v)), (dp.aba, (q, v, a))):
        assert scaled(f(r, *x), f(same, *x)) < 1e-12
        assert scaled(f(r, *x, engine="numpy"), f(same, *x, engine="numpy")) < 1e-12
    assert scaled(dp.fk(r, q, "arm", as_="dual_quaternion"), dp.fk(same, q, "arm", as_="dual_quaternion")) < 1e-14
    assert scaled(dp.difference(r, q, dp.integrate(r, q, v)), v) < 1e-14
    assert dp.simulate(r, q[0], v[0], dt=1e-3, t_end=0.05).energy_drift < 1e-8
    pytest.importorskip("viser")
    from dualpin.view import axes

    assert [x.pitch for x in axes(r)] == [np.inf] * 3 + [0.0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", dp.errors.DualpinWarning)
        again = loads(r.to_urdf())
    assert again.joint_names == ["rail", "rail_y", "rail_z", "arm"]
    assert scaled(dp.rnea(again, q, v, a, engine="numpy"), dp.rnea(r, q, v, a, engine="numpy")) < 1e-12
