"""Laus, Simoni, Martins: progressive dynamics, one link at a time."""

# ruff: noqa: E501  (rows of a table, one a line)
# fmt: off

from __future__ import annotations

from typing import Any

import numpy as np

import dualpin as dp
from dualpin.model import Builder, Robot, revolute
from dualpin.spatial import Pose, Vector3

from .common import CANNOT, CONVENTION, DRAWN, FAILS, MEASURED, OUTSIDE, PART, Page, Row

G = 9.81
A, L, M, I = (0.5, 0.4), (0.25, 0.18, 0.12), (2.5, 1.5, 0.8), (0.06, 0.03, 0.01)
Q, V = np.array([0.4, -0.9, 0.6]), np.array([1.1, -0.7, 0.5])


def link(i: int) -> dp.spatial.Inertia:
    return dp.mechanisms.body(M[i], [L[i], 0, 0], np.diag([0, 0, I[i]]))


def planar_arm(n: int) -> Robot:
    """n revolute joints about z, links along x, gravity along -y."""
    b, on, X = Builder(f"{n}R arm", gravity=(0.0, -G, 0.0)), None, Pose()
    for i in range(n):
        b.joint(f"joint{i + 1}", revolute(), on=on, placement=X, inertia=link(i))
        on, X = f"joint{i + 1}", Pose(position=Vector3(A[i] if i < len(A) else 0.0, 0.0, 0.0))
    b.frame("tip", on=on, placement=X)
    return b.robot()


def definitions(k: int) -> dict[str, Any]:
    """M, C, g of link k by its definition: J^T m J, Christoffel symbols by differences of 1e-30 i, dU/dq."""
    a = (*A, 0.0)
    n = k + 1

    def jacobian(q: np.ndarray) -> np.ndarray:
        """of the centre of mass (x, y) and the angle, 3 x n"""
        phi = np.cumsum(q)
        arms = [a[i] if i < k else L[k] for i in range(n)]
        J = np.ones((3, n), dtype=q.dtype)
        for j in range(n):
            J[0, j] = -sum(arms[i] * np.sin(phi[i]) for i in range(j, n))
            J[1, j] = sum(arms[i] * np.cos(phi[i]) for i in range(j, n))
        return J

    def mass(q: np.ndarray) -> np.ndarray:
        J = jacobian(q)
        return J.T @ np.diag([M[k], M[k], I[k]]) @ J

    q, v, h = Q[:n], V[:n], 1e-30
    dM = np.stack([mass(q + 1j * h * e).imag / h for e in np.eye(n)], axis=-1)  # [r, c, k]
    C = 0.5 * (dM @ v + np.einsum("rkc,k->rc", dM, v) - np.einsum("ckr,k->rc", dM, v))
    return {"M": mass(q), "C": C, "g": M[k] * G * jacobian(q)[1], "J": jacobian(q)}


def screws() -> list[Row]:
    rng = np.random.default_rng(0)
    X = rng.standard_normal((3, 3))
    J, m, c = X @ X.T + 4 * np.eye(3), 2.5, rng.standard_normal(3)
    s = dp.mechanisms.principal_screws(dp.mechanisms.body(m, c, J))
    a, b, d = np.sqrt(np.linalg.eigvalsh(J) / m)
    six = np.array(
        [
            [a, 0, 0, 1, 0, 0],
            [-a, 0, 0, 1, 0, 0],
            [0, b, 0, 0, 1, 0],
            [0, -b, 0, 0, 1, 0],
            [0, 0, d, 0, 0, 1],
            [0, 0, -d, 0, 0, 1],
        ]
    )
    W = np.block([[J, np.zeros((3, 3))], [np.zeros((3, 3)), m * np.eye(3)]])
    T = np.kron(np.eye(2), s.axes)
    return [
        Row("sec. 2.1", "no author ever approached the inertia matrix by screws", "", None, "the same 6 x 6 congruence is Featherstone's spatial algebra, which the paper cites", FAILS),
        Row("eqs 2-7", "the six principal screws of inertia, pitches plus and minus the radii of gyration", "[+-a, 0, 0; 1, 0, 0] ...", six, s.principal, note="dualpin: mechanisms.principal_screws(body).principal"),
        Row("eq 8", "S^T S", "2 diag(a^2, b^2, c^2, 1, 1, 1)", 2 * np.diag([a * a, b * b, d * d, 1, 1, 1]), s.principal.T @ s.principal),
        Row("eq 9", "generalised mass matrix about the centre of mass", "diag(J, m 1)", W, s.matrix),
        Row("eq 10", "the same from the screws", "(m / 2) T S^T S T^T", m / 2 * T @ s.principal.T @ s.principal @ T.T, s.matrix, right=W),
        Row("eq 11", "T, the principal axes twice", "diag(R, R)", np.kron(np.eye(2), s.axes), T),
    ]


def twists() -> list[Row]:
    """Equations of one link, on link 2 of the arm with two joints."""
    two = planar_arm(2)
    q, v = Q[:2], V[:2]
    d = definitions(1)
    com = dp.fk(two, q, "com:joint2")
    R, p = com[:3, :3].T, com[:3, 3]  # R of the paper maps base components to the link's
    T = np.block([[R, np.zeros((3, 3))], [-R @ _skew(p), R]])
    J0 = dp.jacobian(two, q, "joint2", reference="world")
    JC = dp.mechanisms.link_jacobian(two, q, "joint2")
    W = np.diag([0.0, 0.0, I[1], M[1], M[1], M[1]])
    S = np.concatenate((JC @ v, []))
    terms = dp.link_terms(two, q, v)
    energy = 0.5 * S @ W @ S
    z, p1 = np.array([0, 0, 1.0]), np.array([A[0] * np.cos(q[0]), A[0] * np.sin(q[0]), 0])
    by_23 = np.array([np.concatenate((z, np.cross(x, z))) for x in (np.zeros(3), p1)]).T
    by_28 = np.array([np.concatenate((R @ z, R @ np.cross(z, p - x))) for x in (np.zeros(3), p1)]).T
    by_30 = np.array([np.concatenate((z, np.cross(z, p - x))) for x in (np.zeros(3), p1)]).T
    a = np.array([0.3, -1.2])
    tau = dp.rnea(two, q, v, a)
    mass, C, g = dp.crba(two, q), dp.coriolis(two, q, v), dp.gravity(two, q)
    h = 1e-30
    dM = np.stack(
        [_mass(1, q + 1j * h * e).imag / h + _padded(_mass(0, (q + 1j * h * e)[:1]).imag / h) for e in np.eye(2)],
        axis=-1,
    )
    christoffel = 0.5 * (dM @ v + np.einsum("rkc,k->rc", dM, v) - np.einsum("ckr,k->rc", dM, v))
    Mdot = dM @ v
    return [
        Row("eq 1", "kinetic energy of a link", "S^T M S / 2", energy, 0.5 * v @ terms[1].M @ v, note="dualpin: link_terms, kinetic_energy"),
        Row("eq 12", "twist of the centre of mass in the link's axes", "[omega; v]", JC @ v, dp.frame_velocity(two, q, v, "com:joint2", reference="local")),
        Row("eq 13", "from the twist in the base", "T_0^C S_0", T @ (J0 @ v), JC @ v),
        Row("eqs 14, 22", "screw transformation T_0^C", "[R, 0; -R [p], R]", T, np.linalg.inv(dp.spatial.adjoint(com)), CONVENTION, note="R maps base components to the link's: the transpose of what the line below eq 14 says"),
        Row("eq 15", "kinetic energy by the base twist", "S_0^T (T^T M T) S_0 / 2", 0.5 * (J0 @ v) @ T.T @ W @ T @ (J0 @ v), 0.5 * v @ terms[1].M @ v),
        Row("eq 16", "base twist from the Jacobian", "J_0 q'", by_23 @ v, dp.frame_velocity(two, q, v, "joint2", reference="world")),
        Row("eqs 17-18", "joint-space inertia of one link", "J^T M J", by_23.T @ T.T @ W @ T @ by_23, terms[1].M, note="each M_i is i x i and takes the first i velocities, or is padded"),
        Row("eqs 19-20", "their sum is the inertia matrix", "M = sum of M_i", sum(t.M for t in terms), mass, right=_mass(1, q) + _padded(_mass(0, q[:1]))),
        Row("eq 21", "M_i by the Jacobian of the centre of mass", "J^C^T M J^C", JC.T @ W @ JC, terms[1].M, right=d["M"]),
        Row("eqs 22-27", "first route: transformed Jacobian", "T_0^C J_0", T @ by_23, dp.mechanisms.link_jacobian(two, q, "joint2", "transformed"), right=JC, note="dualpin: mechanisms.link_jacobian(robot, q, link, route)"),
        Row("eq 28", "second route: built directly", "[R z; R (z x (p_C - p))]", by_28, dp.mechanisms.link_jacobian(two, q, "joint2", "direct")),
        Row("eqs 29-31", "third route: rotated Jacobian", "diag(R, R) J-bar", np.kron(np.eye(2), R) @ by_30, dp.mechanisms.link_jacobian(two, q, "joint2", "rotated"), right=JC),
        Row("eq 32", "equations of motion", "M q'' + C q' + g = tau", mass @ a + C @ v + g, tau),
        Row("eq 33", "C q' from M", "M' q' - d(q'^T M q')/dq / 2", Mdot @ v - 0.5 * np.einsum("ijk,i,j->k", dM, v, v), C @ v),
        Row("eq 34", "gravity from the potential energy", "dU/dq", np.array([_potential(q + 1j * h * e).imag / h for e in np.eye(2)]), g),
        Row("eq 35", "Christoffel symbols of the first kind", "c_ij", christoffel, C, note="identical to Pinocchio's computeCoriolisMatrix for these arms"),
        Row("eq 36", "gravity of a link", "-m J-bar^T [0; g_0]", -M[1] * by_30[3:].T @ [0, -G, 0], terms[1].g),
        Row("sec. 2.4", "sums of matrices of different sizes, null rows and columns appended, also for tree-like chains", "trailing zeros", None, "right for serial numbering; for a tree dualpin scatters each term by joint", PART),
        Row("footnote 2", "several bodies on a link, rotors with a transmission gain", "", None, "Rotor(inertia, ratio, body), Robot.with_rotors, <transmission> in URDF; bodies on one link simply add", MEASURED),
    ]


def _skew(p: np.ndarray) -> np.ndarray:
    return np.cross(p, np.eye(3)).T


def _mass(k: int, q: np.ndarray) -> np.ndarray:
    """J^T m J of link k, also of complex q."""
    a, n, phi = (*A, 0.0), k + 1, np.cumsum(q)
    arms = [a[i] if i < k else L[k] for i in range(n)]
    J = np.ones((3, n), dtype=q.dtype)
    for j in range(n):
        J[0, j] = -sum(arms[i] * np.sin(phi[i]) for i in range(j, n))
        J[1, j] = sum(arms[i] * np.cos(phi[i]) for i in range(j, n))
    return J.T @ np.diag([M[k], M[k], I[k]]) @ J


def _padded(x: np.ndarray, n: int = 2) -> np.ndarray:
    return np.pad(x, (0, n - len(x)))


def _potential(q: np.ndarray) -> Any:
    y = A[0] * np.sin(q[0])
    return G * (M[0] * L[0] * np.sin(q[0]) + M[1] * (y + L[1] * np.sin(q[0] + q[1])))


def arms() -> list[Row]:
    two = planar_arm(2)
    q1, q2 = Q[:2]
    c1, s1, c2, s2, c12, s12 = np.cos(q1), np.sin(q1), np.cos(q2), np.sin(q2), np.cos(q1 + q2), np.sin(q1 + q2)
    (a1, a2), (l1, l2, _), (m1, m2, _), (I1, I2, _) = A, L, M, I
    t = dp.link_terms(two, Q[:2], V[:2])
    d1, d2 = definitions(0), definitions(1)
    M2 = np.array(
        [
            [m2 * (a1**2 + l2**2 + 2 * a1 * l2 * c2) + I2, m2 * l2 * (l2 + a1 * c2) + I2],
            [m2 * l2 * (l2 + a1 * c2) + I2, m2 * l2**2 + I2],
        ]
    )
    C2 = m2 * a1 * l2 * s2 * np.array([[-V[1], -(V[0] + V[1])], [V[0], 0]])
    rows = [(0, 0, a1, 0), (0, 0, a2, 0)]
    table = dp.from_dh(rows, joints="RR", gravity=(0, -G, 0))
    A1 = np.array([[c1, -s1, 0, a1 * c1], [s1, c1, 0, a1 * s1], [0, 0, 1, 0], [0, 0, 0, 1]])
    A12 = np.array([[c12, -s12, 0, a1 * c1 + a2 * c12], [s12, c12, 0, a1 * s1 + a2 * s12], [0, 0, 1, 0], [0, 0, 0, 1]])
    coms = np.array([[l1 * c1, l1 * s1, 0], [a1 * c1 + l2 * c12, a1 * s1 + l2 * s12, 0]])
    T1 = np.array(
        [
            [c1, s1, 0, 0, 0, 0],
            [-s1, c1, 0, 0, 0, 0],
            [0, 0, 1, 0, 0, 0],
            [0, 0, 0, c1, s1, 0],
            [0, 0, l1, -s1, c1, 0],
            [l1 * s1, -l1 * c1, 0, 0, 0, 1],
        ]
    )
    T2 = np.array(
        [
            [c12, s12, 0, 0, 0, 0],
            [-s12, c12, 0, 0, 0, 0],
            [0, 0, 1, 0, 0, 0],
            [0, 0, a1 * s2, c12, s12, 0],
            [0, 0, l2 + a1 * c2, -s12, c12, 0],
            [a1 * s1 + l2 * s12, -a1 * c1 - l2 * c12, 0, 0, 0, 1],
        ]
    )
    J2 = np.array([[0, 0], [0, 0], [1, 1], [0, a1 * s1], [0, -a1 * c1], [0, 0]])
    JC1, JC2 = (
        np.array([0, 0, 1, 0, l1, 0]),
        np.array([[0, 0], [0, 0], [1, 1], [a1 * s2, 0], [l2 + a1 * c2, l2], [0, 0]]),
    )
    Jb1 = np.array([0, 0, 1, -l1 * s1, l1 * c1, 0])
    Jb2 = np.array([[0, 0], [0, 0], [1, 1], [-a1 * s1 - l2 * s12, -l2 * s12], [a1 * c1 + l2 * c12, l2 * c12], [0, 0]])

    def inverse(link_: str) -> np.ndarray:
        return np.linalg.inv(dp.spatial.adjoint(dp.fk(two, Q[:2], f"com:{link_}")))

    def bar(link_: str) -> np.ndarray:
        return dp.jacobian(two, Q[:2], f"com:{link_}", reference="local_world_aligned")

    return [
        Row("Table 1", "Denavit-Hartenberg rows: a_i, zeros, theta_i", "a1, a2, a3", A12, dp.fk(table, Q[:2], "tool"), CONVENTION, note="standard rows; the rows numbered 0, 1, 2 belong to joints 1, 2, 3"),
        Row("eq 37", "mass matrices about the centres of mass", "diag(Ix, Iy, Iz, m, m, m)", np.diag([0, 0, I1, m1, m1, m1]), dp.mechanisms.principal_screws(dp.mechanisms.body(m1, [0, 0, 0], np.diag([0, 0, I1]))).matrix),
        Row("eqs 38-39", "homogeneous matrices; the last columns read as a_i | c_i", "a1 c1, a1 s1; a1 c1 + a2 c12, ...", np.stack([A1, A12]), np.stack([dp.fk(table, Q[:2], "frame_1"), dp.fk(table, Q[:2], "frame_2")]), CONVENTION, note="read as products: a machine's reading made two columns of one"),
        Row("eq 40", "centres of mass", "(l1 c1, l1 s1, 0); (a1 c1 + l2 c12, ...)", coms, np.stack([dp.fk(two, Q[:2], f"com:joint{i}")[:3, 3] for i in (1, 2)])),
        Row("eqs 41-42", "screw transformations T_0^C1, T_0^C2", "6 x 6 each", np.stack([T1, T2]), np.stack([inverse("joint1"), inverse("joint2")])),
        Row("eqs 43-44", "axes z and origins p of the joints", "(0, 0, 1); (a1 c1, a1 s1, 0)", np.array([[0, 0, 1.0], [a1 * c1, a1 * s1, 0]]), np.stack([dp.fk(two, Q[:2], "joint2")[:3, 2], dp.fk(two, Q[:2], "joint2")[:3, 3]])),
        Row("eq 45", "Jacobians about the base's origin", "6 x 1 and 6 x 2", J2, dp.jacobian(two, Q[:2], "joint2", reference="world")),
        Row("eq 46", "Jacobians of the centres of mass", "6 x 1 and 6 x 2", np.column_stack([JC1, JC2]), np.column_stack([dp.mechanisms.link_jacobian(two, Q[:2], "joint1")[:, 0], dp.mechanisms.link_jacobian(two, Q[:2], "joint2")]), note="in symbols by examples/symbols.py"),
        Row("eq 47", "M1", "m1 l1^2 + Iz1", m1 * l1**2 + I1, t[0].M[0, 0], right=d1["M"][0, 0], note="in symbols by examples/symbols.py, as are eqs 48-52"),
        Row("eq 47", "M2", "m2 (a1^2 + l2^2 + 2 a1 l2 c2) + Iz2, ...", M2, t[1].M, right=d2["M"]),
        Row("eq 48", "C1", "0", np.zeros((2, 2)), t[0].C),
        Row("eq 48", "C2", "-m2 a1 l2 s2 theta2', ...", C2, t[1].C, right=d2["C"]),
        Row("eq 49", "columns of J-bar of link 1", "6 x 2, a zero second column", "6 x 2", f"6 x {np.count_nonzero(bar('joint1').any(axis=0))}", CANNOT, "6 x 1", note="the text says 6 x i, and eq 51 prints one entry"),
        Row("eq 49", "J-bar of link 1, first column", "(0, 0, 1, -l1 s1, l1 c1, 0)", Jb1, bar("joint1")[:, 0]),
        Row("eq 50", "J-bar of link 2", "(-a1 s1 - l2 s12, ...)", Jb2, bar("joint2")),
        Row("eq 51", "g1", "m1 g l1 c1", m1 * G * l1 * c1, t[0].g[0], right=d1["g"][0]),
        Row("eq 52", "g2", "m2 g (a1 c1 + l2 c12), m2 g l2 c12", m2 * G * np.array([a1 * c1 + l2 * c12, l2 * c12]), t[1].g, right=d2["g"]),
    ]


def payload() -> list[Row]:
    (a1, a2), (_, _, l3), m3, I3 = A, L, M[2], I[2]
    a3 = 0.3
    q1, q2, q3 = Q
    v1, v2, v3 = V
    c1, s1 = np.cos(q1), np.sin(q1)
    c3, c12, c23, c123 = np.cos([q3, q1 + q2, q2 + q3, q1 + q2 + q3])
    s2, s3, s12, s23, s123 = np.sin([q2, q3, q1 + q2, q2 + q3, q1 + q2 + q3])
    d = definitions(2)
    two = planar_arm(2)
    three = two.attach(link(2), passive=True)
    terms = dp.link_terms(three, Q, V)
    old = dp.link_terms(two, Q[:2], V[:2])
    t = terms[2]
    m11 = m3 * (l3 + a2 * c3 + a1 * c23) ** 2 + m3 * m3 * (a2 * s3 + a1 * s23) ** 2 + I3
    c312 = -m3 * ((a2 * s2 + l3 * s23) * (v1 + v2) + l3 * (a2 * s3 + a1 * s23) * v3)
    first = np.array([-a1 * s12 - a2 * s12 - l3 * s123, a1 * c12 + a2 * c12 + l3 * c123])
    bar = dp.jacobian(three, Q, "com:payload", reference="local_world_aligned")
    com = dp.fk(three, Q, "com:payload")
    table = dp.from_dh([(0, 0, x, 0) for x in (a1, a2, a3)], gravity=(0, -G, 0))
    A3 = np.array([[c3, -s3, 0, a3 * c3], [s3, c3, 0, a3 * s3], [0, 0, 1, 0], [0, 0, 0, 1]])
    A123 = np.array(
        [
            [c123, -s123, 0, a1 * c1 + a2 * c12 + a3 * c123],
            [s123, c123, 0, a1 * s1 + a2 * s12 + a3 * s123],
            [0, 0, 1, 0],
            [0, 0, 0, 1],
        ]
    )
    pc = np.array([a1 * c1 + a2 * c12 + l3 * c123, a1 * s1 + a2 * s12 + l3 * s123, 0])
    T3 = np.array(
        [
            [c123, s123, 0, 0, 0, 0],
            [-s123, c123, 0, 0, 0, 0],
            [0, 0, 1, 0, 0, 0],
            [0, 0, a2 * s3 + a1 * s23, c123, s123, 0],
            [0, 0, l3 + a2 * c3 + a1 * c23, -s123, c123, 0],
            [pc[1], -pc[0], 0, 0, 0, 1],
        ]
    )
    JC3 = np.array(
        [
            [0, 0, 0],
            [0, 0, 0],
            [1, 1, 1],
            [a2 * s3 + a1 * s23, a2 * s3, 0],
            [l3 + a2 * c3 + a1 * c23, l3 + a2 * c3, l3],
            [0, 0, 0],
        ]
    )
    acc = dp.aba(three, Q, V, [0.4, -0.2, 0.0])
    small = slice(2, 5)
    lambda3 = dp.mechanisms.link_jacobian(three, Q, "payload")[small]
    return [
        Row("eq 53", "A_3^2", "c3, -s3, a3 c3, ...", A3, np.linalg.inv(dp.fk(table, Q, "frame_2")) @ dp.fk(table, Q, "frame_3")),
        Row("eq 54", "A_3^0", "a1 c1 + a2 c12 + a3 c123, ...", A123, dp.fk(table, Q, "frame_3")),
        Row("eq 55", "centre of mass of the payload", "a1 c1 + a2 c12 + l3 c123, ...", pc, com[:3, 3]),
        Row("eq 56", "screw transformation T_0^C3", "6 x 6", T3, np.linalg.inv(dp.spatial.adjoint(com))),
        Row("eq 57", "Jacobian of the payload's centre of mass", "6 x 3", JC3, dp.mechanisms.link_jacobian(three, Q, "payload")),
        Row("eq 58", "m311: m3 twice in the second term", "... + m3 (a2 s3 + a1 s23)^2 m3 + Iz3", m11, t.M[0, 0], CANNOT, d["M"][0, 0], note="kg^2 m^2 added to kg m^2; without the second m3 it holds"),
        Row("eq 58", "the other entries of M3", "m312, m313, m322, m323, m333", _masses(), t.M[[0, 0, 1, 1, 2], [1, 2, 1, 2, 2]], right=d["M"][[0, 0, 1, 1, 2], [1, 2, 1, 2, 2]]),
        Row("eq 59", "c312: a1 missing", "-m3 ((a2 s2 + l3 s23) (theta1' + theta2') + ...)", c312, t.C[0, 1], CANNOT, d["C"][0, 1], note="c311 in the line above has the factor a1"),
        Row("eq 59", "the other entries of C3", "as printed", _coriolis()[_OTHERS], t.C[_OTHERS], right=d["C"][_OTHERS]),
        Row("eq 60", "J-bar of the payload, first column", "-a1 s12 - a2 s12 - l3 s123, a1 c12 + ...", first, bar[3:5, 0], CANNOT, d["J"][:2, 0], note="a1 goes with s1 and c1, as in eq 55"),
        Row("eq 60", "the other columns", "as printed", np.array([[-a2 * s12 - l3 * s123, -l3 * s123], [a2 * c12 + l3 * c123, l3 * c123]]), bar[3:5, 1:], right=d["J"][:2, 1:]),
        Row("eq 61", "g3, first entry", "m3 g (a1 c12 + a2 c12 + l3 c123)", m3 * G * (a1 * c12 + a2 * c12 + l3 * c123), t.g[0], CANNOT, d["g"][0], note="the same a1 c12 as in eq 60"),
        Row("eq 61", "the other entries", "m3 g (a2 c12 + l3 c123), m3 g l3 c123", m3 * G * np.array([a2 * c12 + l3 * c123, l3 * c123]), t.g[1:], right=d["g"][1:]),
        Row("eqs 62-64", "M, C, g: sums over the links, padded", "M1 + M2 + M3, ...", np.column_stack([sum(x.M for x in terms), sum(x.C for x in terms), sum(x.g for x in terms)]), np.column_stack([dp.crba(three, Q), dp.coriolis(three, Q, V), dp.gravity(three, Q)])),
        Row("sec. 3.2", "the model of two axes is completed, only the third link is added", "unchanged", np.stack([np.column_stack([x.M, x.C, x.g]) for x in old]), np.stack([np.column_stack([x.M[:2, :2], x.C[:2, :2], x.g[:2]]) for x in terms[:2]]), digits=0.0, note="to the bit; dualpin: Robot.attach(body, passive=True)"),
        Row("sec. 3.2", "torque on the passive joint", "0", 0.0, dp.rnea(three, Q, V, acc)[2], note="with the accelerations of dp.aba"),
        Row("sec. 1", "with Newton and Euler the model must be completely recalculated for a new link", "", None, _newton_euler(two, three), FAILS),
        Row("sec. 1", "the standard approach (D-H) requires to remodel the whole manipulator", "", None, "the sums do not ask how the links are described: dp.from_dh(...).attach(...) keeps the old terms to the bit", FAILS),
        Row("sec. 4", "the Jacobians are simpler than the literature's; closed chains, anti-swing control to come", "", None, "", OUTSIDE, note="wording, and announcements"),
        Row("sec. 1", "model pieces independently, then combine them", "", None, "Robot.attach(other_robot, on=, placement=); terms of the old links stay to the bit (tests/model/test_composed.py)", MEASURED),
        Row("sec. 4", "in a planar system of screws, lambda = 3, Jacobians of 3 x i are enough", "3 x i", lambda3.T @ np.diag([I3, m3, m3]) @ lambda3, t.M, note="rows omega_z, v_x, v_y of link_jacobian"),
        Row("sec. 4", "prismatic joints, motors and transmissions are straight forward", "", None, "any joint, in dual numbers without a case; rotors as above", MEASURED),
        Row("Fig 1", "the arm without and with the payload; with swing", "", None, "figures/swing.svg", DRAWN),
    ]


def _newton_euler(two: Robot, three: Robot) -> str:
    """The recursion for three links less that for two: what the third link adds, and nothing else."""
    a = np.array([0.3, -1.2, 0.8])
    t = dp.link_terms(three, Q, V)[2]
    more = dp.rnea(three, Q, V, a) - _padded(dp.rnea(two, Q[:2], V[:2], a[:2]), 3)
    off = float(np.abs(more - (t.M @ a + t.C @ V + t.g)).max())
    return f"the recursion adds the new link's M a + C v + g to what it gave before, to {off:.0e}"


_OTHERS = (np.array([0, 0, 1, 1, 1, 2, 2, 2]), np.array([0, 2, 0, 1, 2, 0, 1, 2]))


def _masses() -> np.ndarray:
    (a1, a2), l3, m3, I3 = A, L[2], M[2], I[2]
    c2, c3, c23 = np.cos([Q[1], Q[2], Q[1] + Q[2]])
    return np.array(
        [
            m3 * (a2**2 + l3**2 + a1 * a2 * c2 + 2 * a2 * l3 * c3 + a1 * l3 * c23) + I3,
            m3 * l3 * (l3 + a2 * c3 + a1 * c23) + I3,
            m3 * (a2**2 + l3**2 + 2 * a2 * l3 * c3) + I3,
            m3 * l3 * (l3 + a2 * c3) + I3,
            m3 * l3**2 + I3,
        ]
    )


def _coriolis() -> np.ndarray:
    (a1, a2), l3, m3 = A, L[2], M[2]
    s2, s3, s23 = np.sin([Q[1], Q[2], Q[1] + Q[2]])
    u, w, y = a1 * (a2 * s2 + l3 * s23), l3 * (a2 * s3 + a1 * s23), l3 * a2 * s3
    v1, v2, v3 = V
    return m3 * np.array(
        [
            [-u * v2 - w * v3, -u * (v1 + v2) - w * v3, -w * V.sum()],
            [u * v1 - y * v3, -y * v3, -y * V.sum()],
            [w * v1 + y * v2, y * (v1 + v2), 0],
        ]
    )


def page() -> Page:
    return Page(
        "laus",
        "Progressive dynamics",
        "L. P. Laus, R. Simoni, D. Martins: Progressive dynamic analysis of serial robots based on screw theory.",
        "The planar 2R arm, and the same arm with a payload on a passive joint, link by link. Independent values are "
        "definitions: J^T m J, Christoffel symbols by complex steps, dU/dq; a1 = 0.5, a2 = 0.4 m and the other numbers are ours, "
        "the paper has symbols only. Docs: [The five papers: progressive dynamics](../../docs/papers/laus.md).",
        [*screws(), *twists(), *arms(), *payload()],
        {
            "swing.svg": "The arm (thick) held at rest by its torques, and the payload on its passive joint that swings: eleven positions in 0.9 s, and the payload's angle over time (Fig 1 b, simulated).",
        },
        "an anti-swing controller, which the paper announces and does not give.",
    )
