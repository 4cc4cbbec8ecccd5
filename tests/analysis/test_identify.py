"""What is identified is what was there, within the deviations that are stated; and it can exist."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.analysis.identification import from_figaroh, read_figaroh, to_figaroh
from dualpin.analysis.identification.bodies import moved, pseudo_inertias, violation
from dualpin.errors import ArgumentError, ShapeError
from dualpin.spatial import Inertia
from tests.random_robots import random_inertia, random_pose, tree

cp = pytest.importorskip("cvxpy")
NOISE = np.array([2.0, 3.0, 1.5, 0.3, 0.2, 0.1])  # N m, of a ur5


@pytest.fixture(scope="module")
def arm():
    return dp.load("ur5")


@pytest.fixture(scope="module")
def motion(arm):
    return arm.sample(400, seed=0)


def measured(robot, motion, rng, noise=NOISE):
    q, v, a = motion
    return dp.rnea(robot, q, v, a) + noise * rng.standard_normal(v.shape)


def coverage(arm, motion, runs, physical):
    """Of each base parameter: in how many runs the truth is within three deviations; and the squared distances."""
    rng, hits, distances = np.random.default_rng(7), [], []
    for _ in range(runs):
        found = dp.identify(arm, *motion, measured(arm, motion, rng), physical=physical)
        miss = found.values - found.base.values()
        hits.append(np.abs(miss) < 3 * found.deviation)
        distances.append(miss @ np.linalg.solve(found.covariance, miss))
    return np.mean(hits, axis=0), np.array(distances)


def test_the_truth_is_within_three_deviations(arm, motion):
    """20 runs of least squares: 99.7 % of 36 x 20 within three deviations, and chi-squared distances."""
    share, distances = coverage(arm, motion, 20, False)
    assert share.mean() > 0.99 and share.min() >= 0.9
    k = 36
    assert abs(distances.mean() - k) < 4 * np.sqrt(2 * k / 20)  # four deviations of the mean of chi-squared


@pytest.mark.campaign
def test_of_200_runs_with_possible_bodies_95_percent_hold_the_truth(arm, motion):
    share, _ = coverage(arm, motion, 200, True)
    assert share.min() >= 0.95, share


def test_it_is_what_scipys_least_squares_finds(arm, motion):
    """Weights given: the minimum that SciPy's solver finds with Pinocchio's whole regressor."""
    linalg = pytest.importorskip("scipy.linalg")
    q, v, a = motion
    tau = measured(arm, motion, np.random.default_rng(1))
    found = dp.identify(arm, q, v, a, tau, weights=1 / NOISE**2, physical=False)
    pin = pytest.importorskip("pinocchio")
    model = pin.buildModelFromUrdf(arm.source)
    data = model.createData()
    W = np.stack([pin.computeJointTorqueRegressor(model, data, *x) for x in zip(q, v, a, strict=True)])
    # singular values under 1e-10 are those of what no torque shows
    p = linalg.lstsq((W / NOISE[:, None]).reshape(-1, 60), (tau / NOISE).ravel(), cond=1e-10)[0]
    assert np.allclose(found.predict(q, v, a), W @ p, rtol=0, atol=1e-8)
    expected = np.linalg.inv(
        np.einsum("nij,nik,i->jk", W, W, NOISE**-2.0)[np.ix_(found.base.columns, found.base.columns)]
    )
    assert np.allclose(found.covariance, expected, rtol=1e-6)


def test_noise_is_estimated_joint_by_joint(arm, motion):
    found = dp.identify(arm, *motion, measured(arm, motion, np.random.default_rng(2)), physical=False)
    assert np.abs(found.noise / NOISE - 1).max() < 4 / np.sqrt(2 * 400)  # four deviations of a deviation's estimate


def test_bodies_can_exist_where_least_squares_has_none(arm):
    """Much noise, little data: least squares breaks the triangle inequality, the constrained estimate does not."""
    q, v, a = arm.sample(25, seed=3)
    tau = measured(arm, (q, v, a), np.random.default_rng(3), 5 * NOISE)
    free = dp.identify(arm, q, v, a, tau, physical=False)
    found = dp.identify(arm, q, v, a, tau)
    bodies = found.parameters[:60].reshape(-1, 10)
    assert violation(free.parameters[:60].reshape(-1, 10)).max() > 1e-3
    assert violation(bodies).max() < 1e-9
    for (
        body
    ) in found.robot:  # by definition: mass, and principal moments about the centre, no larger than the others' sum
        (m, (_, J)) = float(body.inertia.mass), body.inertia.central
        moments = np.linalg.eigvalsh([[float(x) for x in row] for row in J.rows])
        assert m > 0 and moments[0] > -1e-9 and moments[0] + moments[1] - moments[2] > -1e-8
    truth = free.base.values()
    whiten = np.linalg.cholesky(np.linalg.inv(free.covariance)).T
    assert np.linalg.norm(whiten @ (found.values - truth)) < np.linalg.norm(whiten @ (free.values - truth))
    assert np.nansum(found.residuals**2 / found.noise**2) >= 0.99 * np.nansum(free.residuals**2 / found.noise**2)


def test_exact_torques_give_exact_parameters_and_a_urdf_of_them(arm, motion, tmp_path):
    heavier = dp.loads(arm.to_urdf().replace('mass value="8.393', 'mass value="9.5'))
    assert heavier.mass - arm.mass > 1
    found = dp.identify(arm, *motion, dp.rnea(heavier, *motion))
    q, v, a = arm.sample(20, seed=5)
    tau = dp.rnea(heavier, q, v, a)
    assert np.abs(found.predict(q, v, a) - tau).max() < 1e-5 * np.abs(tau).max()
    again = dp.load(str(_written(found.robot, tmp_path / "found.urdf")))
    assert np.abs(dp.rnea(again, q, v, a) - tau).max() < 1e-5 * np.abs(tau).max()


def _written(robot, path):
    path.write_text(robot.to_urdf(), encoding="utf-8")
    return path


def test_friction_and_rotors_are_found(arm, motion):
    q, v, a = motion
    damping, dry, rotor = np.array([[5, 4, 3, 2, 1, 0.5], [8, 6, 4, 1, 1, 1], [2, 3, 1, 0.5, 0.4, 0.3]])
    tau = dp.rnea(arm, q, v, a) + damping * v + dry * np.sign(v) + rotor * a
    tau += 0.01 * np.random.default_rng(4).standard_normal(tau.shape)
    found = dp.identify(arm, q, v, a, tau, friction=True, rotors=True)
    p = dict(zip(found.base.parameters.names, found.parameters, strict=True))
    for k, name in enumerate(arm.joint_names):
        assert p[f"viscous[{name}]"] == pytest.approx(damping[k], rel=0.02)
        assert p[f"coulomb[{name}]"] == pytest.approx(dry[k], rel=0.02)
        if k >= 2:  # the first two are seen only together with a body's inertia
            assert p[f"rotor[{name}]"] == pytest.approx(rotor[k], rel=0.02)
    tuned = found.robot
    assert tuned.joint("elbow_joint").damping == pytest.approx(3, rel=0.02)
    other = arm.sample(10, seed=8)
    truth = dp.rnea(arm, *other) + damping * other[1] + dry * np.sign(other[1]) + rotor * other[2]
    assert np.abs(found.predict(*other) - truth).max() < 0.1


def test_what_was_not_measured_is_left_out(arm, motion):
    q, v, a = motion
    tau = measured(arm, motion, np.random.default_rng(5))
    tau[:200, 1] = np.nan
    found = dp.identify(arm, q, v, a, tau, physical=False)
    assert np.isnan(found.residuals[:200, 1]).all() and np.isfinite(found.values).all()
    assert (np.abs(found.values - found.base.values()) < 5 * found.deviation).all()
    tau[:, 0] = np.nan  # Jzz of the first link is seen in its own torque only
    less = dp.identify(arm, q, v, a, tau, physical=False)
    assert len(less.base) == 35 and np.isnan(less.noise[0]) and np.isfinite(less.noise[1:]).all()
    assert less.base.identifiable["Jzz[shoulder_pan_joint]"] == "unseen"


def test_payload(arm, motion):
    rng = np.random.default_rng(6)
    box = dp.mechanisms.body(2.5, [0.02, -0.01, 0.08], [[0.02, 0.003, 0], [0.003, 0.03, 0], [0, 0, 0.025]])
    tau = measured(arm.attach(box, on="tool0"), motion, rng)
    for physical in (False, True):
        found = dp.identify_payload(arm, *motion, tau, "tool0", physical=physical)
        truth = np.array([float(x) for x in box.parameters])
        assert (np.abs(found.parameters - truth) < 4 * found.deviation).all()
        assert (np.abs(found.com - [0.02, -0.01, 0.08]) < 4 * found.com_deviation).all()
    assert np.allclose(dp.rnea(found.robot, *motion), tau, atol=5 * NOISE.max())
    # measured without the payload too, so errors of the model cancel
    wrong = dp.rnea(arm, *motion) * 1.3 + 2.0
    loaded = wrong + dp.rnea(arm.attach(box, on="tool0"), *motion) - dp.rnea(arm, *motion)
    found = dp.identify_payload(arm, *motion, loaded, "tool0", unloaded=wrong, physical=False)
    assert np.abs(found.parameters - truth).max() < 1e-9 and found.mass == pytest.approx(2.5)
    with pytest.raises(ArgumentError, match="leaves open Jxx, Jxy, Jyy, Jxz, Jyz, Jzz"):
        dp.identify_payload(arm, motion[0], 0 * motion[1], 0 * motion[2], tau, "tool0")
    with pytest.raises(ArgumentError, match="ground"):
        dp.identify_payload(arm, *motion, tau, "world")


@pytest.mark.parametrize("seed", range(3))
def test_parameters_move_with_frames_and_possible_bodies_have_positive_pseudo_inertias(seed):
    rng = np.random.default_rng(seed)
    body, X = random_inertia(rng), random_pose(rng)
    ten = np.array([float(x) for x in body.parameters])
    assert np.allclose(moved(X) @ ten, [float(x) for x in body.moved(X).parameters], atol=1e-14)
    # by definition: the integral of (x, 1)(x, 1)^T over point masses
    mass, place = rng.uniform(0.1, 1, 5), rng.uniform(-1, 1, (5, 3))
    points = sum((Inertia.of(m, p, np.zeros((3, 3))) for m, p in zip(mass.tolist(), place.tolist(), strict=True)),
                 Inertia.of(0.0, [0.0] * 3, np.zeros((3, 3))))  # fmt: skip
    P = np.einsum("i,ijk->jk", [float(x) for x in points.parameters], pseudo_inertias())
    h = np.column_stack([place, np.ones(5)])
    assert np.allclose(P, np.einsum("n,ni,nj->ij", mass, h, h), atol=1e-14)


def test_figaroh_files_go_round(arm, motion, tmp_path):
    found = dp.identify(arm, *motion, measured(arm, motion, np.random.default_rng(9)), friction=True, rotors=True)
    to_figaroh(found, tmp_path / "all.yaml")
    parameters, p = read_figaroh(arm, tmp_path / "all.yaml")
    assert parameters.names == found.base.parameters.names and np.allclose(p, found.parameters, atol=1e-12)
    to_figaroh(found, tmp_path / "base.yaml", base=True)
    parameters, p = read_figaroh(arm, tmp_path / "base.yaml")
    assert np.allclose(found.base.values(p), found.values, atol=1e-10)
    to_figaroh(arm, tmp_path / "description.yaml")
    assert np.allclose(from_figaroh(arm, tmp_path / "description.yaml"), dp.inertial_parameters(arm), atol=1e-15)


FOREIGN = """
base parameters names: [Izz_a + 0.25*m_b, mx_b, my_b, Izz_b]
base parameters values: [1.5, 0.2, -0.1, 0.3]
condition number: 12.0
"""


def test_a_file_written_elsewhere_is_read(tmp_path):
    """Two links in a plane: written by hand in the layout of figaroh's results."""
    pytest.importorskip("yaml")
    flat = dp.from_dh([(0, 0, 0, 0), (0, 0, 0.5, 0)], joints="RR", convention="modified")
    names = dict(zip("ab", flat.joint_names, strict=True))
    text = FOREIGN
    for short, long in names.items():
        text = (
            text.replace(f"_{short} ", f"_{long} ")
            .replace(f"_{short},", f"_{long},")
            .replace(f"_{short}]", f"_{long}]")
        )
    (tmp_path / "plane.yaml").write_text(text)
    p = from_figaroh(flat, tmp_path / "plane.yaml")
    assert np.allclose(dp.base_parameters(flat).values(p), [1.5, 0.2, -0.1, 0.3])
    for bad, match in [
        ("- 1\n", "mapping"),
        ("a: [", "no YAML"),
        ("m_elbow: 2", "m_joint"),
        ("m_joint_1: x", "finite"),
    ]:
        (tmp_path / "bad.yaml").write_text(bad)
        with pytest.raises(ArgumentError, match=match):
            from_figaroh(flat, tmp_path / "bad.yaml")


def test_wrong_data_is_answered(arm, motion):
    q, v, a = motion
    tau = dp.rnea(arm, q, v, a)
    for args, match in [
        ((q[:3], v[:3], a[:3], tau[:3]), "only 18 torques"), ((q[0], v[0], a[0], tau[0]), r"\(n, 6\)"),
        ((q, v, a, tau[:5]), "as many"), ((q * np.nan, v, a, tau), "not finite"), ((q, v, a, tau * np.inf), "infinite"),
    ]:  # fmt: skip
        with pytest.raises((ArgumentError, ShapeError), match=match):
            dp.identify(arm, *args)
    with pytest.raises(ArgumentError, match="only 0 torques"):
        dp.identify(arm, q, v, a, tau, weights=np.zeros(6))
    with pytest.raises(ShapeError, match="weights"):
        dp.identify(arm, q, v, a, tau, weights=[1, 2])
    with pytest.raises(ArgumentError, match="1 / variance"):
        dp.identify(arm, q, v, a, tau, weights=-np.ones(6))


def test_a_tree_with_a_free_base_and_armature(arm):
    robot = tree(("floating", "revolute", "revolute", "prismatic"), 3, armature=True)
    motion = robot.sample(200, seed=0)
    found = dp.identify(robot, *motion, dp.rnea(robot, *motion))
    other = robot.sample(5, seed=1)
    tau = dp.rnea(robot, *other)
    assert np.abs(dp.rnea(found.robot, *other) - tau).max() < 1e-5 * np.abs(tau).max()


def test_residuals_are_drawn(arm, motion, tmp_path):
    pytest.importorskip("matplotlib")
    found = dp.identify(arm, *motion, measured(arm, motion, np.random.default_rng(2)), physical=False)
    fig = found.plot(tmp_path / "residuals.png")
    assert len(fig.axes) == 12 and (tmp_path / "residuals.png").stat().st_size > 1000
    assert found.table()[0].keys() == {"parameter", "value", "deviation", "described"}


def test_what_torques_do_not_show_stays_as_described(arm, motion):
    """With the description's own torques the description comes back whole, not only its base parameters."""
    found = dp.identify(arm, *motion, dp.rnea(arm, *motion))
    truth = dp.inertial_parameters(arm)
    assert violation(truth.reshape(-1, 10)).max() == 0  # the body is physical, so nothing has to be changed
    assert np.abs(found.parameters - truth).max() < 1e-4
    noisy = dp.identify(arm, *motion, measured(arm, motion, np.random.default_rng(11)))
    assert noisy.robot.mass == pytest.approx(arm.mass, rel=0.05)
