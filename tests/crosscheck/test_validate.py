"""The cross-check passes what is right, catches what is wrong, and says which term."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from random_robots import random_urdf

import dualpin as dp
from dualpin.algorithms import coriolis as coriolis_module
from dualpin.crosscheck import CHECKS, tolerance
from dualpin.crosscheck.run import scaled_error
from dualpin.crosscheck.subjects.algebra import Change
from dualpin.crosscheck.where import locate
from dualpin.model.robot import Joint, Robot
from dualpin.spatial import Inertia, Pose, Vector3, diagonal
from dualpin.terms import TERMS

pytest.importorskip("pinocchio")


def changed(robot: Robot, name: str, **changes: object) -> Robot:
    """The robot with one joint replaced; its descendants see the new one."""
    new: dict[Joint | None, Joint | None] = {None: None}
    for j in robot:
        new[j] = replace(j, parent=new[j.parent], **(changes if j.name == name else {}))
    frames = tuple(replace(f, joint=new[f.joint]) for f in robot.frames)
    links = tuple(replace(k, joint=new[k.joint]) for k in robot.links)
    return replace(robot, joints=tuple(new[j] for j in robot), frames=frames, links=links)


def failed(robot: Robot, against: str | None = None) -> set[str]:
    terms = dp.validate(robot, samples=5, engine="numpy", against=against).terms
    return {name for name, t in terms.items() if not t.passed}


@pytest.mark.parametrize(("name", "options"), [
    ("panda", {}), ("panda", {"mimic": True}), ("ur5", {"floating": True}), ("anymal_c", {"floating": True}),
    ("double_pendulum_continuous", {}), ("romeo", {"mimic": True}), ("bluevolta", {}),
    ("quadrotor_base", {"floating": True}),
])  # fmt: skip
def test_every_term_agrees_with_pinocchio(name, options):
    report = dp.validate(name, samples=7, seed=3, engine="numpy", **options)
    assert report.passed, {k: (t.max_scaled_error, t.tolerance) for k, t in report.terms.items() if not t.passed}
    assert set(report.terms) == set(CHECKS)


def test_terms_without_a_linear_solve_stay_under_the_ceiling():
    report = dp.validate("talos", samples=5, floating=True, engine="numpy")
    for name, t in report.terms.items():
        if not CHECKS[name].solves:
            assert t.max_scaled_error <= tolerance.CEILING
            assert t.tolerance <= tolerance.CEILING


def test_a_heavier_link_is_caught_in_dynamics_and_not_in_kinematics():
    robot = dp.load("panda")
    body = robot.joint("panda_joint4").inertia
    heavier = Inertia(body.mass * (1 + 1e-9), body.moment, body.rotational)
    found = failed(changed(robot, "panda_joint4", inertia=heavier), against="panda")
    assert {"crba", "rnea", "kinetic_energy"} <= found
    assert not found & {"fk", "jacobian", "jacobian_dot", "frame_velocity", "joint_torque_regressor"}


def test_a_tilted_axis_is_caught_from_kinematics_on():
    robot = dp.load("ur5")
    joint = robot.joint("elbow_joint")
    tilt = Vector3(1e-9, 1.0, 0.0)
    found = failed(changed(robot, "elbow_joint", model=dp.model.revolute(tilt)), against="ur5")
    assert joint.kind == "revolute"
    assert {"fk", "jacobian", "rnea"} <= found


def test_a_shifted_placement_is_caught_and_does_not_disturb_what_lies_before_it():
    robot = dp.load("ur5")
    joint = robot.joint("wrist_3_joint")
    shift = Pose(position=Vector3(1e-9, 0.0, 0.0))
    found = failed(changed(robot, "wrist_3_joint", placement=joint.placement @ shift), against="ur5")
    assert {"fk", "frame_pose"} <= found


def test_a_wrong_factor_in_coriolis_is_caught_where_the_connection_is_used(monkeypatch):
    right = coriolis_module.Connection.of

    def wrong(body, V):
        found = right(body, V)
        return type(found)(found.p, found.B * (1 + 1e-9))

    monkeypatch.setattr(coriolis_module.Connection, "of", staticmethod(wrong))
    # only the derivatives use the same connection
    assert failed(dp.load("panda")) == {"coriolis", "rnea_derivatives", "aba_derivatives"}


def test_wrong_gravity_is_caught_in_what_gravity_moves():
    found = failed(dp.load("panda").with_gravity((0, 0, -9.80665)), against="panda")
    assert {"rnea", "gravity", "bias", "potential_energy"} <= found
    assert not found & {"crba", "coriolis", "fk"}


def test_fifty_digits_say_who_is_nearer():
    t = dp.validate("icub", samples=3, floating=True, terms=["minv"], engine="numpy", arbitrate=True).terms["minv"]
    exact = t.worst["against_50_digits"]
    assert exact["dualpin"] < exact["oracle"] < 1e-6


def test_a_robot_built_in_code_is_validated_through_the_urdf_it_writes():
    b = dp.Builder("two")
    inertia = Pose(position=Vector3(0.1, 0.0, 0.2)) @ Inertia(2.0, Vector3(0.0, 0.0, 0.0), diagonal(0.3))
    b.joint("a", dp.model.revolute(), inertia=inertia)
    b.joint("b", dp.model.prismatic(Vector3(0.6, 0.0, 0.8)), "a", Pose(position=Vector3(0.3, 0.0, 0.0)), inertia)
    assert dp.validate(b.robot(), samples=5, engine="numpy").passed


@pytest.mark.parametrize(("arguments", "message"), [
    ({"terms": ["rnae"]}, "did you mean 'rnea'"), ({"samples": 0}, "from 1"), ({"samples": 2.5}, "whole number"),
])  # fmt: skip
def test_wrong_arguments_are_named(arguments, message):
    with pytest.raises(dp.ArgumentError, match=message):
        dp.validate("ur5", **arguments)


def test_the_samples_cover_joints_whose_limits_leave_no_room():
    from dualpin.crosscheck.sampling import states

    robot = dp.load("so100")
    q = states(robot, 50, 0)["q"]
    assert (np.ptp(q, axis=0) > 0).all()


def test_a_report_survives_json(tmp_path):
    import json

    report = dp.validate("ur5", samples=3, terms=["rnea", "aba"], engine="numpy")
    paths = report.write(tmp_path, ("json", "md", "html"))
    data = json.loads(paths[0].read_text())
    assert data["passed"] is True
    assert {"name", "floating", "nv", "samples", "seed", "passed", "terms"} <= set(data["robots"][0])
    assert {"max_scaled_error", "tolerance", "passed"} <= set(data["robots"][0]["terms"]["rnea"])
    assert data["refused"] == []
    assert data["versions"]["pinocchio"]
    again = type(report).from_dict(data)
    assert again.to_json() == report.to_json()
    assert "| rnea |" in paths[1].read_text()
    assert "<table" in paths[2].read_text()


@pytest.mark.parametrize("case", range(6))
@pytest.mark.parametrize("floating", [False, True], ids=["fixed", "floating"])
def test_random_trees_agree_through_the_same_file(tmp_path, seed, case, floating):
    path = tmp_path / "random.urdf"
    path.write_text(random_urdf(seed + case, joints=7))
    report = dp.validate(str(path), samples=5, seed=case, floating=floating, engine="numpy")
    assert report.passed, {k: (t.max_scaled_error, t.tolerance) for k, t in report.terms.items() if not t.passed}


@pytest.mark.parametrize(("name", "floating"), [("double_pendulum", False), ("ur5", True), ("bluevolta", False)])
def test_every_entry_of_every_term_has_a_name(name, floating):
    robot = dp.load(name, floating=floating)
    for term, check in CHECKS.items():
        options = check.variants(robot, 0)[0]
        shape = (robot.nv,) if term == "difference" else TERMS[term].shape(robot, **options)
        names = [locate(robot, term, entry, options) for entry in range(int(np.prod(shape, dtype=int)))]
        assert len(set(names)) == len(names)


def test_one_term_and_one_format_need_no_list(tmp_path):
    report = dp.validate("double_pendulum", samples=2, terms="crba", engine="numpy")
    assert list(report.terms) == ["crba"]
    assert [p.name for p in report.write(tmp_path, formats="json")] == ["report.json"]


PLANAR = """<robot name="planar"><link name="a"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="planar"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>"""


def test_planar_joints_pass_where_pinocchio_loses_digits(tmp_path):
    (tmp_path / "planar.urdf").write_text(PLANAR)
    robot = dp.load(tmp_path / "planar.urdf")
    for seed in range(10):
        assert dp.validate(robot, samples=50, seed=seed, terms=["difference"], engine="numpy").passed


@pytest.mark.parametrize("turn", [1e-6, 1e-3, 0.03, 0.3, 3.0])
def test_differences_of_planar_joints_keep_all_digits(tmp_path, turn):
    (tmp_path / "planar.urdf").write_text(PLANAR)
    q0, q1 = np.array([0.3, -0.2, 0.7]), np.array([0.5, 0.4, 0.7 + turn])
    with mpmath.workdps(40):
        t = mpmath.mpf(q1[2]) - mpmath.mpf(q0[2])
        c, s = mpmath.cos(q0[2]), mpmath.sin(q0[2])
        dx, dy = (mpmath.mpf(q1[i]) - mpmath.mpf(q0[i]) for i in (0, 1))
        x, y, a = c * dx + s * dy, c * dy - s * dx, t / 2 * mpmath.cot(t / 2)
        expected = [float(a * x + t / 2 * y), float(a * y - t / 2 * x), float(t)]
    ours = dp.difference(dp.load(tmp_path / "planar.urdf"), q0, q1)
    assert np.abs(ours - expected).max() < 1e-15


def test_a_potential_energy_that_cancels_is_not_called_wrong():
    report = dp.validate("falcon_bravo7_no_ee", samples=500, floating=True, terms=["potential_energy"], engine="numpy")
    assert report.passed
    assert report.terms["potential_energy"].tolerance <= tolerance.CEILING


def test_errors_are_of_the_largest_entry_and_infinite_where_there_is_no_number():
    reference = np.array([[0.0, -4.0, 1.0], [0.5, 0.0, 0.0], [1.0, np.nan, 2.0], [np.inf, 1.0, 1.0]])
    x = reference + np.array([[0.0, 0.5, 1.0], [0.0, 0.25, 0.0], [9.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    error, where = scaled_error(x.copy(), reference)
    assert np.array_equal(error, [0.25, 0.25, np.inf, np.inf])
    assert where[:2].tolist() == [2, 1]
    error, where = scaled_error(np.empty((2, 0)), np.empty((2, 0)))
    assert error.tolist() == where.tolist() == [0, 0]


def test_what_is_singular_is_found_by_norms_as_by_eigenvalues():
    """Matrices whose scaled condition numbers lie around the bound, in units from 1e-8 to 1e8."""
    rng = np.random.default_rng(9)
    exponents = np.concatenate([rng.uniform(0, 20, 150), [0.0, 16.0, 300.0]])
    M = []
    for e in exponents:
        Q, _ = np.linalg.qr(rng.normal(size=(6, 6)))
        units = np.diag(10.0 ** rng.uniform(-8, 8, 6))
        M.append(units @ (Q @ np.diag([*np.ones(5), 10.0**-e]) @ Q.T) @ units)
    M = np.array([*M, np.zeros((6, 6)), np.full((6, 6), np.nan)])
    d = np.sqrt(np.diagonal(M, axis1=1, axis2=2))
    with np.errstate(all="ignore"):
        expected = ~(tolerance.condition(M / d[:, :, None] / d[:, None, :]) < tolerance.SINGULAR)
    hopeless = tolerance.MassMatrices(M).hopeless
    # near the bound rounding decides, to which eigenvalues of nearly singular matrices are known
    near = np.abs(np.append(exponents, [20, 20]) - np.log10(tolerance.SINGULAR)) < 0.5
    assert np.array_equal(hopeless[~near], expected[~near])
    assert 10 < hopeless.sum() < 140


def test_layouts_that_only_permute_pick_instead_of_multiplying():
    rng = np.random.default_rng(3)
    permutation = np.eye(5)[[3, 0, 4, 1, 2]]
    tall = rng.normal(size=(5, 3))
    for G in (permutation, np.eye(5), tall, -np.eye(5), 2 * np.eye(5), np.eye(5)[[0, 0, 2, 3, 4]]):
        to, x = Change(G), rng.normal(size=(4, 5, 5))
        assert np.allclose(to.columns(x), x @ G, rtol=0, atol=1e-14)
        assert np.allclose(to.rows(x), G.T @ x, rtol=0, atol=1e-14)
    assert [len(Change(G).runs) for G in (permutation, np.eye(5), tall, -np.eye(5))] == [4, 1, 0, 0]
