"""Workspaces against geometry that is known, Pinocchio, and definitions."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.analysis.workspace import nearest_singularity, reach, static_load
from dualpin.errors import ArgumentError, FrameNotFoundError, ShapeError
from dualpin.model import Builder, prismatic, revolute
from dualpin.spatial import Pose, Vector3

H = np.pi / 2
UPPER, FORE, TOOL = 0.5, 0.35, 0.2
# three joints to the centre of the wrist, three about it, all without limits
ARM = [(0, 0, 0, -H), (0, 0, UPPER, 0), (0, 0, 0, H), (0, FORE, 0, -H), (0, 0, 0, H), (0, TOOL, 0, 0)]


@pytest.fixture(scope="module")
def arm():
    return dp.from_dh(ARM, joints="RRRRRR")


@pytest.fixture(scope="module")
def ur5():
    return dp.load("ur5")


def directions(bands, rng):
    """A random direction in each bin of the map: bands of equal height, sectors from -pi on."""
    z = (np.arange(bands)[:, None] + rng.random((bands, 2 * bands))) * 2 / bands - 1
    phi = (np.arange(2 * bands) + rng.random((bands, 2 * bands))) * np.pi / bands - np.pi
    r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1).reshape(-1, 3)


def test_the_index_is_that_of_inverse_kinematics_in_closed_form(arm):
    """A wrist without limits turns anywhere: a pose is reached where the wrist's centre is within the arm's shell.

    Independent of samples of joints and of forward kinematics: points of each cell, directions of each bin.
    """
    found = dp.reach_map(arm, n=3_000_000, cell=0.14, bands=4)
    rng = np.random.default_rng(0)
    points = np.stack(np.meshgrid(*map(found.centres, range(3)), indexing="ij"), axis=-1)[..., None, :]
    reached = np.zeros(found.seen.shape, bool)
    near, far = abs(UPPER - FORE), UPPER + FORE
    for _ in range(150):
        wrist = points + found.cell * rng.uniform(-0.5, 0.5, (32, 3)) - TOOL * directions(4, rng)
        reached |= np.abs(np.sqrt(np.einsum("...i,...i", wrist, wrist)) - (near + far) / 2) < (far - near) / 2
    truth, index = reached.mean(axis=-1), found.index
    some = (truth > 0) | (index > 0)
    assert np.corrcoef(truth[some], index[some])[0, 1] > 0.99
    assert np.abs(truth - index)[some].mean() < 0.03 and found.coverage > 0.99


@pytest.mark.campaign
def test_the_index_of_panda_is_that_of_brute_force_with_pinocchio():
    """Pinocchio's poses of its own random configurations, sorted into cells and directions by other code."""
    pin = pytest.importorskip("pinocchio")
    robot = dp.load("panda")
    found = dp.reach_map(robot, "panda_hand", n=3_000_000, cell=0.2, bands=5)
    model = pin.buildModelFromUrdf(robot.source)
    data, frame = model.createData(), model.getFrameId("panda_hand", pin.BODY)
    rng, n = np.random.default_rng(5), 3_000_000
    place, aim = np.empty((n, 3)), np.empty((n, 3))
    for i in range(n):
        q = rng.uniform(model.lowerPositionLimit, model.upperPositionLimit)
        pin.forwardKinematics(model, data, q)
        T = pin.updateFramePlacement(model, data, frame)
        place[i], aim[i] = T.translation, T.rotation[:, 2]
    edges = [np.append(found.centres(k) - found.cell / 2, found.centres(k)[-1] + found.cell / 2) for k in range(3)]
    heading = np.degrees(np.arctan2(aim[:, 1], aim[:, 0]))
    spread = [*place.T, aim[:, 2], heading]
    hits, _ = np.histogramdd(np.array(spread).T, [*edges, np.linspace(-1, 1, 6), np.linspace(-180, 180, 11)])
    truth = (hits > 0).mean(axis=(3, 4))
    some = (truth > 0) | (found.index > 0)
    assert np.corrcoef(truth[some], found.index[some])[0, 1] > 0.99


def test_a_planar_arm_sweeps_its_disc():
    flat = dp.from_dh([(0, 0, 0.6, 0), (0, 0, 0.4, 0)], joints="RR")
    found = dp.reach_map(flat, n=400_000, cell=0.02, bands=1)
    area = (found.counts > 0).any(axis=2).sum() * found.cell**2
    assert area == pytest.approx(np.pi * (1.0 - 0.2**2), rel=0.08)  # cells cut by the border count whole
    assert found.at([0.1, 0.0, 0.0]) == 0 and found.at([[0.5, 0.5, 0.0]]) > 0 and found.at([9.0, 0, 0]) == 0


def test_it_is_the_same_with_the_same_seed_and_grows_where_the_pilot_did_not_reach(arm, monkeypatch):
    a, b = (dp.reach_map(arm, n=100_000, cell=0.1, bands=2, seed=3) for _ in range(2))
    assert np.array_equal(a.seen, b.seen) and a.samples == 100_000 == a.counts.sum()
    monkeypatch.setattr(reach, "PILOT", 3)
    grown = dp.reach_map(arm, n=100_000, cell=0.1, bands=2, seed=3)
    assert grown.counts.sum() == 100_000
    assert grown.volume == pytest.approx(a.volume, rel=0.1)


def test_rolls_tell_whole_orientations_apart(arm):
    fixed = Builder("no roll")  # a frame that turns about x only: its z-axis sweeps a circle, its x-axis stays
    fixed.joint("a", revolute(Vector3(1.0, 0.0, 0.0)), None)
    still = fixed.robot()
    by_z = dp.reach_map(still, n=5000, cell=0.1, bands=2)
    assert by_z.seen.any(axis=(0, 1, 2)).sum() in (4, 6, 8)
    by_x = dp.reach_map(still, n=5000, cell=0.1, bands=2, axis="x", rolls=6)
    assert by_x.seen.any(axis=(0, 1, 2)).sum() in (6, 12)  # one direction (or two bins at its border), six turns
    whole = dp.reach_map(arm, n=200_000, cell=0.5, bands=1, rolls=4)
    assert whole.seen.shape[-1] == 8 and whole.index.max() == 1.0


def test_surveys_find_the_extreme_of_each_cell(arm):
    found = dp.reach_map(arm, n=50_000, cell=0.3, bands=1)
    height = found.survey(lambda q: dp.fk(arm, q, -1)[:, 2, 3], "max", n=20_000)
    top = found.centres(2) + found.cell / 2
    assert np.nanmax(height - top) <= 1e-12 and np.nanmin(height - (top - found.cell)) >= -1e-12
    with pytest.raises(ShapeError, match="shape"):
        found.survey(lambda q: q, n=10)


def test_maps_are_saved_and_drawn(arm, tmp_path):
    found = dp.reach_map(arm, n=20_000, cell=0.2, bands=2)
    found.save(tmp_path / "reach.npz")
    with np.load(tmp_path / "reach.npz") as data:
        assert np.array_equal(np.unpackbits(data["seen"], axis=-1, count=int(data["bins"])).astype(bool), found.seen)
    pytest.importorskip("matplotlib")
    found.plot(tmp_path / "reach.png", twice=2 * found.index)
    assert (tmp_path / "reach.png").stat().st_size > 5000


def test_what_cannot_be_mapped_is_answered(arm, ur5):
    with pytest.raises(ArgumentError, match="floats"):
        dp.reach_map(dp.load("ur5", floating=True), "tool0")
    with pytest.raises(ArgumentError, match="ground"):
        dp.reach_map(ur5, "world")
    with pytest.raises(FrameNotFoundError, match="tool0"):
        dp.reach_map(ur5, "tool1")
    with pytest.raises(ArgumentError, match="cell="):
        dp.reach_map(ur5, "tool0", cell=0.001)
    for f in (dp.reach_map, dp.manipulability, dp.singularity, dp.payload_capacity):
        with pytest.raises(ArgumentError, match="Robot"):
            f(None, *([] if f is dp.reach_map else [np.zeros(6), "tool0"]))
    with pytest.raises(ArgumentError, match="memory"):
        dp.reach_map(ur5, "tool0", memory=-1)

    def interrupt(done, n):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        dp.reach_map(arm, progress=interrupt)


# --- manipulability ------------------------------------------------------------------------------


def test_velocity_is_yoshikawas_measure(ur5):
    """sqrt(det(J J^T)) of Pinocchio's Jacobian; two links in a plane: l1 l2 |sin q2|."""
    pin = pytest.importorskip("pinocchio")
    model = pin.buildModelFromUrdf(ur5.source)
    data, q = model.createData(), ur5.sample(20, seed=0)[0]
    found = dp.manipulability(ur5, q, "tool0", length=0.3)
    for x, w, k in zip(q, found.index, found.condition, strict=True):
        J = pin.computeFrameJacobian(model, data, x, model.getFrameId("tool0"), pin.LOCAL_WORLD_ALIGNED)
        J[:3] /= 0.3
        assert w == pytest.approx(np.sqrt(np.linalg.det(J @ J.T)), rel=1e-9)
        assert k == pytest.approx(np.linalg.cond(J), rel=1e-9)
    flat = dp.from_dh([(0, 0, 0.6, 0), (0, 0, 0.4, 0)], joints="RR")
    plane = dp.manipulability(flat, [0.3, 0.7], -1, task="position")
    assert plane.axes[:2].prod() == pytest.approx(0.24 * np.sin(0.7)) and plane.index == 0


def test_ellipsoids_hold_what_unit_joint_motions_do(ur5):
    """By definition: images of random unit vectors lie in the ellipsoid, and reach its axes."""
    q = ur5.sample(seed=1)[0]
    rng = np.random.default_rng(0)
    unit = rng.standard_normal((20_000, 6))
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    L = 0.25
    J = dp.jacobian(ur5, q, "tool0", "local_world_aligned")
    for kind, images in [
        ("velocity", unit @ J.T), ("dynamic", unit @ np.linalg.inv(dp.crba(ur5, q)).T @ J.T),
        ("force", None),
    ]:  # fmt: skip
        found = dp.manipulability(ur5, q, "tool0", kind, "position", length=L)
        U, axes = found.directions, found.axes
        if images is None:  # forces whose joint torques have length one
            f = rng.standard_normal((20_000, 3))
            images = np.pad(f / np.linalg.norm(f @ J[3:], axis=1, keepdims=True), ((0, 0), (3, 0)))
        inside = np.linalg.norm(images[:, 3:] @ U / axes, axis=1)
        assert inside.max() <= 1 + 1e-9
        assert inside.max() > 0.97


def test_effort_limits_scale_forces(ur5):
    q = ur5.sample(seed=2)[0]
    found = dp.manipulability(ur5, q, "tool0", "force", "position", effort=True)
    limit = np.array([j.limits.effort for j in ur5])
    J = dp.jacobian(ur5, q, "tool0", "local_world_aligned")[3:]
    assert np.linalg.norm((J.T @ found.directions[:, 0] * found.axes[0]) / limit) == pytest.approx(1)
    with pytest.raises(ArgumentError, match="effort"):
        dp.manipulability(dp.from_dh(ARM, joints="RRRRRR"), np.ones(6), -1, "force", effort=True)


def test_a_length_makes_units_disappear():
    """The same robot in millimetres has the same condition number; a slide counts as a turn of its length."""
    metres, thousand = (dp.from_dh([(t, d * s, a * s, x) for t, d, a, x in ARM], joints="RRRRRR") for s in (1, 1000))
    q = metres.sample(5, seed=0)[0]
    a, b = (dp.manipulability(r, q, -1) for r in (metres, thousand))
    assert b.length == pytest.approx(1000 * a.length) and np.allclose(a.condition, b.condition, rtol=1e-9)
    slide = Builder("slide")
    slide.joint("turn", revolute(), None)
    slide.joint("move", prismatic(), "turn", Pose(position=Vector3(0.5, 0.0, 0.0)))
    found = dp.manipulability(slide.robot(), [0.0, 0.0], -1, task="position", length=0.5)
    assert found.axes[:2].tolist() == pytest.approx([0.5, 0.5])


# --- singularities -------------------------------------------------------------------------------


def test_at_a_singularity_the_lost_screw_is_reciprocal_to_all_joints(ur5):
    """ur5 with a straight wrist: by Ball's product with the joint screws of the product of exponentials."""
    q = np.array([0.3, -1.0, 1.2, 0.4, 0.0, 0.7])  # joints four and six are parallel
    found = dp.singularity(ur5, q, "tool0")
    assert found.distance < 1e-12 and found.rank == 6
    J = dp.jacobian(ur5, q, "tool0")  # twists about the world's origin
    for k in range(6):
        assert abs(float(dp.algebra.reciprocal(dp.algebra.Motor(J[:3, k], J[3:, k]), found.lost))) < 1e-12
    assert np.abs(J @ found.joints).max() < 1e-12 and np.linalg.norm(found.joints) == pytest.approx(1)


def test_away_from_it_the_work_is_the_distance(ur5):
    q = ur5.sample(30, seed=3)[0]
    found = dp.singularity(ur5, q, "tool0", length=0.3)
    J = dp.jacobian(ur5, q, "tool0")
    twists = dp.algebra.Motor(np.moveaxis(J[:, :3], 1, 2), np.moveaxis(J[:, 3:], 1, 2))
    lost = dp.algebra.Motor(found.lost.real[:, None], found.lost.dual[:, None])
    power = dp.algebra.reciprocal(twists, lost)
    assert np.allclose(power, found.work, atol=1e-12)
    assert np.allclose(np.linalg.norm(found.work, axis=1), found.distance, atol=1e-12)
    # Eckart and Young: no smaller change makes it singular, and this one does
    A = dp.jacobian(ur5, q, "tool0", "local_world_aligned") / np.repeat([1, 0.3], 3)[:, None]
    assert np.allclose(found.distance, np.linalg.norm(A, -2, axis=(1, 2)), atol=1e-12)


def test_a_stretched_elbow_loses_the_force_along_the_arm():
    arm = dp.from_dh([(0, 0, 0, -H), (0, 0, 1, 0), (0, 0, 1, 0)], joints="RRR")
    q = np.array([0.4, 0.5, 0.0])
    found = dp.singularity(arm, q, -1, "position")
    tip = dp.fk(arm, q, -1)[:3, 3]
    assert found.distance < 1e-12 and abs(found.lost.pitch) < 1e-12
    assert np.linalg.norm(np.cross(found.lost.direction, tip)) < 1e-12  # the line from the shoulder to the tip
    assert np.linalg.norm(found.lost.point) < 1e-12


def test_planar_arms_lose_nothing_that_they_never_had():
    flat = dp.from_dh([(0, 0, 1, 0)] * 3, joints="RRR")
    assert dp.singularity(flat, [0.1, 0.2, 0.3], -1).rank == 3
    assert dp.singularity(flat, [0.1, 0.5, -0.7], -1).distance > 0.01
    assert dp.singularity(flat, [0.1, 0.0, 0.0], -1).distance < 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_the_nearest_singularity_is_singular_and_no_scan_finds_a_nearer_one(ur5, seed):
    q = ur5.sample(seed=seed)[0]
    there, distance = nearest_singularity(ur5, q, "tool0")
    assert dp.singularity(ur5, there, "tool0").distance < 1e-8
    assert np.linalg.norm(there - q) == pytest.approx(distance, abs=1e-9)
    # the elbow and the wrist of a ur5 are singular at multiples of pi, whatever the other angles are
    known = min(abs(np.remainder(q[k] + H, np.pi) - H) for k in (2, 4))
    assert distance <= known + 1e-6


# --- loads ---------------------------------------------------------------------------------------


def test_static_loads_are_those_of_a_robot_that_carries_it(ur5):
    q = ur5.sample(20, seed=4)[0]
    com = [0.03, -0.02, 0.1]
    box = dp.mechanisms.body(3.0, com, np.eye(3) * 0.01)
    limit = np.array([j.limits.effort for j in ur5])
    truth = dp.gravity(ur5.attach(box, on="tool0"), q) / limit
    assert np.allclose(static_load(ur5, q, "tool0", 3.0, com), truth, atol=1e-13)
    assert np.allclose(static_load(ur5, q, "tool0", box), truth, atol=1e-13)


def test_capacity_is_where_a_joint_is_at_its_limit(ur5):
    """By bisection with bodies attached."""
    q, com = ur5.sample(12, seed=5)[0], [0.0, 0.0, 0.15]
    found = dp.payload_capacity(ur5, q, "tool0", com)
    for x, m in zip(q, found, strict=True):
        low, high = 0.0, 2000.0
        for _ in range(60):
            middle = (low + high) / 2
            box = dp.mechanisms.body(middle, com, np.eye(3) * 1e-3)
            held = (
                np.abs(dp.gravity(ur5.attach(box, on="tool0"), x, engine="numpy")) <= [j.limits.effort for j in ur5]
            ).all()
            low, high = (middle, high) if held else (low, middle)
        assert min(m, 2000.0) == pytest.approx(low, rel=1e-6)
    assert (dp.payload_capacity(ur5, q, "tool0", effort=0.01) == 0).any()
    with pytest.raises(ArgumentError, match="effort="):
        dp.payload_capacity(dp.from_dh(ARM, joints="RRRRRR"), np.zeros(6), -1)
