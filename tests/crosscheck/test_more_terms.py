"""External wrenches, regressors and derivatives as terms of a subject."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.subjects import asking, exchange
from dualpin.crosscheck.subjects.convention import parameter_names

SMALL = "finger_edu"
TERMS = ["rnea_f_ext", "aba_f_ext", "joint_torque_regressor", "rnea_derivatives", "aba_derivatives"]


class Pushed:
    """An arm under a wrench on a link, by dualpin's own recursion with wrenches on joints."""

    def __init__(self, name: str = "ur5", turned: bool = False, sign: float = 1.0) -> None:
        self.robot, self.turned, self.sign = dp.load(name), turned, sign

    def _on_joints(self, q, f_ext, frame):
        f = self.robot.frame(frame)
        joint = dp.fk(self.robot, q)[f.joint.index]
        place = dp.fk(self.robot, q, frame=frame)
        R = joint[:3, :3].T @ (place[:3, :3] if self.turned else np.eye(3))
        arm = joint[:3, :3].T @ (place[:3, 3] - joint[:3, 3])
        n, force = R @ f_ext[:3], R @ f_ext[3:]
        out = np.zeros((len(self.robot), 6))
        out[f.joint.index] = [*(n + np.cross(arm, force)), *force]
        return self.sign * out

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        return dp.rnea(self.robot, q, v, a, f_ext=self._on_joints(q, f_ext, frame))

    def aba_f_ext(self, q, v, tau, f_ext, frame):
        return dp.aba(self.robot, q, v, tau, f_ext=self._on_joints(q, f_ext, frame))


def test_wrenches_on_links_are_those_of_the_recursion():
    terms = dp.judge("panda", Pushed("panda"), 2).terms
    assert [terms[t].status for t in TERMS[:2]] == ["agrees", "agrees"]
    assert max(terms[t].max_scaled_error for t in TERMS[:2]) < 1e-12


@pytest.mark.parametrize(
    ("subject", "key", "verdict"),
    [
        (Pushed(SMALL, turned=True), "reference_local", "agrees under another convention"),
        (Pushed(SMALL, sign=-1.0), "f_ext_sign", "differs because"),
        (Pushed(SMALL, sign=0.0), "f_ext_ignored", "differs because"),
    ],
)
def test_what_is_done_otherwise_with_a_wrench_is_named(subject, key, verdict):
    terms = TERMS[:2] if key == "f_ext_sign" else TERMS[:1]
    report = dp.judge(SMALL, subject, 3, terms=terms)
    assert [f.key for f in report.findings] == [key] and report.findings[0].terms == terms
    assert all(t.verdict.startswith(verdict) for t in report.terms.values())


def test_a_regressor_of_all_links_is_read_by_its_names():
    """Columns of links on fixed joints, and of the base, in an order of their own."""
    robot = dp.load("panda")
    words = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")
    links = [f for f in robot.frames if f.role == "link"][::-1]
    units = np.eye(10)[[0, 1, 2, 3, 4, 5, 7, 6, 8, 9]]

    def torque_of(link, unit):
        """The robot whose only mass is this link's."""
        bodies = np.zeros((len(robot), 10))
        if link.joint is not None:
            bodies[link.joint.index] = _moved(unit, link)
        return bodies.ravel()

    def regressor(q, v, a):
        Y = dp.joint_torque_regressor(robot, q, v, a)
        return np.stack([Y @ torque_of(f, u) for f in links for u in units], axis=1)

    writes = {"parameters": [f"{f.name}.{w}" for f in links for w in words]}
    report = dp.judge(robot, {"joint_torque_regressor": regressor, "writes": writes}, 4)
    assert report.terms["joint_torque_regressor"].status == "agrees"
    plain = {"joint_torque_regressor": lambda q, v, a: dp.joint_torque_regressor(robot, q, v, a)}
    assert dp.judge(robot, plain, 4).terms["joint_torque_regressor"].status == "agrees"
    assert len(parameter_names(robot)) == len(dp.inertial_parameters(robot))


def _moved(unit, frame):
    """Ten parameters about a link's origin, about its joint's: by points of mass, not by tensors' formulas."""
    X = np.array([[float(x) for x in row] for row in frame.placement.rows])
    m, h = unit[0], unit[1:4]
    xx, xy, yy, xz, yz, zz = unit[4:]
    J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    second = np.zeros((4, 4))  # of mass: sum m [p; 1] [p; 1]^T, turned and shifted at once
    second[:3, :3], second[:3, 3], second[3, :3], second[3, 3] = np.trace(J) / 2 * np.eye(3) - J, h, h, m
    second = X @ second @ X.T
    J = np.trace(second[:3, :3]) * np.eye(3) - second[:3, :3]
    return [second[3, 3], *second[:3, 3], J[0, 0], J[0, 1], J[1, 1], J[0, 2], J[1, 2], J[2, 2]]


def test_an_unknown_parameter_is_said():
    robot = dp.load("ur5")
    writes = {"parameters": ["shoulder_link.mass"]}
    report = dp.judge(robot, {"joint_torque_regressor": lambda q, v, a: np.zeros((6, 1)), "writes": writes}, 4)
    assert "'shoulder_link.mass' is of no link" in report.terms["joint_torque_regressor"].reason


def test_derivatives_carry_the_cause_of_the_term_they_are_of():
    arm = dp.load(SMALL)
    light = arm.with_gravity((0, 0, -9.8))
    subject = {
        "rnea": lambda q, v, a: dp.rnea(light, q, v, a),
        "rnea_derivatives": lambda q, v, a: dp.rnea_derivatives(light, q, v, a),
        "aba_derivatives": lambda q, v, tau: np.swapaxes(dp.aba_derivatives(arm, q, v, tau), -1, -2),
    }
    report = dp.judge(arm, subject, 4)
    named = {f.key: f.terms for f in report.findings}
    assert named == {"gravity": ["rnea", "rnea_derivatives"], "derivatives_transposed": ["aba_derivatives"]}


def test_derivatives_by_a_base_in_world_axes_are_not_compared():
    robot = dp.load("solo12", floating=True)
    subject = {
        "rnea_derivatives": lambda q, v, a: np.zeros((3, robot.nv, robot.nv)), "writes": {"angular": "world"}
    }  # fmt: skip
    term = dp.judge(robot, subject, 4).terms["rnea_derivatives"]
    assert term.status == "not compared" and "in its own axes" in term.reason


def test_a_folder_holds_all_terms(tmp_path):
    """dualpin's own answers through CSV files, columns in any order."""
    given = asking("ur5", 4, 0, tuple(TERMS))
    exchange.write(given, tmp_path)
    headers = exchange.asked(tmp_path)["answers"]
    assert headers["rnea_derivatives"].startswith("sample,by,row,") and "f_ext.nx" in _header(tmp_path)
    robot, s = given.robot, given.states
    subject = Pushed()
    subject.joint_torque_regressor = lambda *x: dp.joint_torque_regressor(robot, *x)
    subject.rnea_derivatives = lambda *x: dp.rnea_derivatives(robot, *x)
    subject.aba_derivatives = lambda *x: dp.aba_derivatives(robot, *x)
    for term in TERMS:
        columns = headers[term].split(",")
        names = columns[max(columns.index(k) for k in ("sample", "frame", "by", "row") if k in columns) + 1 :]
        lines = [",".join(reversed(columns))]
        for k in range(given.samples):
            state = [s["q"][k], s["v"][k], s["tau" if term.startswith("aba") else "a"][k]]
            for keys, row in _rows(getattr(subject, term), term, state, s["f_ext"][k], given, names):
                lines.append(",".join(reversed([str(k), *keys, *map(repr, map(float, row))])))
        (tmp_path / "answers" / f"{term}.csv").write_text("\n".join(lines) + "\n")
    report = dp.judge("ur5", tmp_path)
    assert {t: report.terms[t].status for t in TERMS} == dict.fromkeys(TERMS, "agrees")


def _header(folder):
    return (folder / "states.csv").read_text().splitlines()[0].split(",")


def _rows(f, term, state, f_ext, given, names):
    v = given.robot.joint_names
    if term.endswith("f_ext"):
        return [((frame,), f(*state, f_ext, frame)) for frame in given.frames]
    if term == "joint_torque_regressor":
        return [((n,), row) for n, row in zip(v, f(*state), strict=True)]
    by = ("q", "v", "tau" if term.startswith("aba") else "a")
    return [((b, n), row) for b, M in zip(by, f(*state), strict=True) for n, row in zip(v, M, strict=True)]


def test_damping_is_known_under_a_wrench_and_in_derivatives_where_some_frames_are_not_answered():
    pushed = Pushed("double_pendulum")
    D = np.array([0.05, 0.05])  # of the file

    def rnea_f_ext(q, v, a, f_ext, frame):
        if frame == given.frames[0]:
            raise KeyError(frame)
        return pushed.rnea_f_ext(q, v, a, f_ext, frame) + D * v

    def derivatives(q, v, a):
        by_q, by_v, M = dp.rnea_derivatives(pushed.robot, q, v, a)
        return by_q, by_v + np.diag(D), M

    given = asking("double_pendulum", 4, 0, ("rnea_f_ext",))
    report = dp.judge("double_pendulum", {"rnea_f_ext": rnea_f_ext, "rnea_derivatives": derivatives}, 4)
    assert [(f.key, f.terms) for f in report.findings] == [("damping", ["rnea_f_ext", "rnea_derivatives"])]
    assert "not answered for" in report.terms["rnea_f_ext"].note


def test_terms_under_a_wrench_follow_from_a_wrong_jacobian():
    """Also from one whose own cause nobody knows."""
    robot = dp.load("double_pendulum")

    def jacobian(q, frame):
        J = dp.jacobian(robot, q, frame=frame)
        J[1] += np.sin(3 * q[0])
        return J

    def torques(q, f_ext, frame):
        return jacobian(q, frame).T @ f_ext

    subject = {
        "jacobian": jacobian,
        "rnea_f_ext": lambda q, v, a, f, frame: dp.rnea(robot, q, v, a) - torques(q, f, frame),
        "aba_f_ext": lambda q, v, tau, f, frame: dp.aba(robot, q, v, tau + torques(q, f, frame)),
    }
    findings = dp.judge("double_pendulum", subject, 4).findings
    assert {t for f in findings if f.key == "follows" for t in f.terms} == {"rnea_f_ext", "aba_f_ext"}
    assert {f.key for f in findings if "jacobian" in f.terms} <= {"partly"}
