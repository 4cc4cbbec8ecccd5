"""Laus, Simoni, Martins: progressive dynamics, one link at a time."""

from __future__ import annotations

from typing import Any

import numpy as np

import dualpin as dp
from dualpin.model import Builder, Robot, revolute
from dualpin.spatial import Pose, Vector3

from .common import Claim, Page, Row

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


def arms() -> list[Row]:
    two, c1 = planar_arm(2), np.cos(Q[0])
    t = dp.link_terms(two, Q[:2], V[:2])
    rows = []
    d1, d2 = definitions(0), definitions(1)
    c2, s2, c12 = np.cos(Q[1]), np.sin(Q[1]), np.cos(Q[0] + Q[1])
    (a1, _), (l1, l2, _), (m1, m2, _), (I1, I2, _) = A, L, M, I
    M2 = [
        [m2 * (a1**2 + l2**2 + 2 * a1 * l2 * c2) + I2, m2 * l2 * (l2 + a1 * c2) + I2],
        [m2 * l2 * (l2 + a1 * c2) + I2, m2 * l2**2 + I2],
    ]
    C2 = m2 * a1 * l2 * s2 * np.array([[-V[1], -(V[0] + V[1])], [V[0], 0]])
    rows += [
        Row("eq 50", "2R: M1", np.array([[m1 * l1**2 + I1]]), d1["M"], t[0].M[:1, :1]),
        Row("eq 51", "2R: g1", np.array([m1 * G * l1 * c1]), d1["g"], t[0].g[:1]),
        Row("eq 52", "2R: M2", np.array(M2), d2["M"], t[1].M),
        Row("eq 52", "2R: C2", C2, d2["C"], t[1].C),
        Row("eq 52", "2R: g2", m2 * G * np.array([a1 * c1 + l2 * c12, l2 * c12]), d2["g"], t[1].g),
        Row(
            "eq 49",
            "columns of the Jacobian of link 1",
            "6 x 2",
            "6 x 1",
            f"6 x {np.count_nonzero(np.diag(t[0].M))}",
            "1.5",
        ),
    ]
    return rows


def payload() -> list[Row]:
    (a1, a2), (_, _, l3), m3, I3 = A, L, M[2], I[2]
    q1, q2, q3 = Q
    v1, v2, v3 = V
    c3, c12, c23, c123 = np.cos([q3, q1 + q2, q2 + q3, q1 + q2 + q3])
    s2, s3, s12, s23, s123 = np.sin([q2, q3, q1 + q2, q2 + q3, q1 + q2 + q3])
    d = definitions(2)
    three = planar_arm(2).attach(link(2), passive=True)
    t = dp.link_terms(three, Q, V)[2]
    m11 = m3 * (l3 + a2 * c3 + a1 * c23) ** 2 + m3 * m3 * (a2 * s3 + a1 * s23) ** 2 + I3
    c312 = -m3 * ((a2 * s2 + l3 * s23) * (v1 + v2) + l3 * (a2 * s3 + a1 * s23) * v3)
    J = np.array([-a1 * s12 - a2 * s12 - l3 * s123, a1 * c12 + a2 * c12 + l3 * c123])
    J_ours = dp.jacobian(
        three.attach(link(2), on="payload", placement=Pose(position=Vector3(l3, 0.0, 0.0)), name="com"),
        Q,
        "com",
        reference="local_world_aligned",
    )
    rows = [
        Row("eq 58", "payload: m11 with m3 twice in the second term", m11, d["M"][0, 0], t.M[0, 0], "1.1"),
        Row(
            "eq 58",
            "payload: other masses",
            d["M"][[0, 0, 1, 1, 2], [1, 2, 1, 2, 2]],
            _masses(),
            t.M[[0, 0, 1, 1, 2], [1, 2, 1, 2, 2]],
        ),
        Row("eq 59", "payload: c12 without a1", c312, d["C"][0, 1], t.C[0, 1], "1.2"),
        Row("eq 59", "payload: C3, other entries", _coriolis()[_OTHERS], d["C"][_OTHERS], t.C[_OTHERS]),
        Row("eq 60", "first column of the Jacobian of the payload", J, d["J"][:2, 0], J_ours[3:5, 0], "1.3"),
        Row("eq 61", "payload: g1 with a1 c12", m3 * G * (a1 * c12 + a2 * c12 + l3 * c123), d["g"][0], t.g[0], "1.4"),
        Row("eq 61", "payload: g2, g3", m3 * G * np.array([a2 * c12 + l3 * c123, l3 * c123]), d["g"][1:], t.g[1:]),
    ]
    two = dp.link_terms(planar_arm(2), Q[:2], V[:2])
    both = dp.link_terms(three, Q, V)
    for i, name in enumerate(("link 1", "link 2")):
        rows.append(
            Row(
                "sec. 3",
                f"M, C of {name} after the payload is attached",
                None,
                np.stack([two[i].M, two[i].C]),
                np.stack([both[i].M[:2, :2], both[i].C[:2, :2]]),
            )
        )
    acc = dp.aba(three, Q, V, [1.0, -0.5, 0.0])
    rows.append(
        Row("sec. 3", "torque on the passive joint in forward dynamics", 0.0, 0.0, dp.rnea(three, Q, V, acc)[2])
    )
    rows.append(Row("eqs 17-20", "sum of padded terms is M", None, dp.crba(three, Q), sum(x.M for x in both)))
    return rows


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


def screws() -> list[Row]:
    rng = np.random.default_rng(0)
    X = rng.standard_normal((3, 3))
    J, m, c = X @ X.T + 4 * np.eye(3), 2.5, rng.standard_normal(3)
    s = dp.mechanisms.principal_screws(dp.mechanisms.body(m, c, J))
    return [
        Row(
            "eqs 2-11",
            "(m/2) S^T S of the six principal screws, in link axes",
            np.block([[J, np.zeros((3, 3))], [np.zeros((3, 3)), m * np.eye(3)]]),
            np.block([[J, np.zeros((3, 3))], [np.zeros((3, 3)), m * np.eye(3)]]),
            s.matrix,
        ),
        Row(
            "eqs 2-11",
            "S^T S = 2 diag(a^2, b^2, c^2, 1, 1, 1)",
            2 * np.diag([*(s.radii**2), 1, 1, 1]),
            2 * np.diag([*(s.radii**2), 1, 1, 1]),
            s.principal.T @ s.principal,
        ),
    ]


CLAIMS = [
    Claim(
        "sec. 2",
        "padding with trailing zeros serves tree-like chains",
        "right for serial numbering; for trees dualpin scatters each term by joint",
        "holds in part",
        "1.10",
    ),
    Claim(
        "sec. 1",
        "nobody approached the problem by screws",
        "the 6 x 6 congruence is Featherstone's spatial algebra, which they cite",
        "does not hold",
        "1.12",
    ),
    Claim(
        "eqs 17-20",
        "M_i multiplies the same velocities",
        "M_i is i x i: the first i velocities, or padding",
        "holds in part",
        "1.8",
    ),
]


def page() -> Page:
    return Page(
        "laus",
        "Progressive dynamics (Laus, Simoni, Martins)",
        "The planar 2R arm, and the same arm with a payload on a passive joint, link by link. The corrected values are "
        "from definitions: J^T m J, Christoffel symbols by complex steps, dU/dq.",
        [*arms(), *payload(), *screws()],
        CLAIMS,
    )
