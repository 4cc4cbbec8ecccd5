"""Tapia Herrera et al.: modelling a 2C arm by dual numbers and dual momenta."""

from __future__ import annotations

import numpy as np

import dualpin as dp
from dualpin import Dual

from .common import Claim, Page, Row


def numbers() -> list[Row]:
    a, b = Dual(2.3, -1.7), Dual(0.8, 0.6)
    root = Dual(np.sqrt(2.3), -1.7 / (2.3 * np.sqrt(2.3)))
    eps_j = np.array([[0.0, 1.0], [0.0, 0.0]])
    h = 1e-30
    return [
        Row("eq 9-10", "product", Dual(2.3 * 0.8, 2.3 * 0.6 - 1.7 * 0.8), Dual(1.84, 0.02), a * b),
        Row("eq 11", "quotient", Dual(2.3 / 0.8, (-1.7 * 0.8 - 2.3 * 0.6) / 0.64), _quotient(a, b), a / b),
        Row(
            "eq 11, middle",
            "denominator made real by b + eps b0",
            b * b,
            Dual(0.64, 0.0),
            b * b.dual_conjugate,
            "0.2",
            note="b - eps b0 does; the result printed is right",
        ),
        Row(
            "eq 13",
            "sqrt: eps part a0 / (a sqrt a)",
            root,
            Dual(np.sqrt(2.3), np.sqrt(2.3 - 1.7j * h).imag / h),
            np.sqrt(a),
            "0.1",
        ),
        Row(
            "Table 1",
            "sqrt: eps part a0 / (2 sqrt a)",
            Dual(np.sqrt(2.3), -1.7 / (2 * np.sqrt(2.3))),
            Dual(np.sqrt(2.3), np.sqrt(2.3 - 1.7j * h).imag / h),
            np.sqrt(a),
        ),
        Row(
            "property b",
            "eps applied to the first basis vector",
            np.array([1.0, 0.0]),
            eps_j @ [1, 0],
            np.array([Dual(0.0, 1.0).real, (Dual(0.0, 1.0) ** 2).dual]),
            "0.5",
            note="eps is nilpotent of rank 1, not a rotation",
        ),
    ]


def _quotient(a: Dual, b: Dual) -> Dual:
    """From (2x2) matrices, the model of dual numbers of eq 6."""
    A, B = (np.array([[x.real, x.dual], [0.0, x.real]]) for x in (a, b))
    Q = A @ np.linalg.inv(B)
    return Dual(Q[0, 0], Q[0, 1])


def arm() -> list[Row]:
    l1, l2, d1, d2, t1, t2 = 100.5, 70.0, 20.0, 15.0, 0.5, 1.0
    c1, s1, c2, s2 = np.cos(t1), np.sin(t1), np.cos(t2), np.sin(t2)
    arm_ = dp.mechanisms.TwoC(l1, l2)
    q = np.array([t1, d1, t2, d2])
    ours = arm_.chain.pose(arm_.dual_coordinates(q))
    T = _dh(t1, d1, l1, np.pi / 2) @ _dh(t2, d2, l2, 0.0)
    p = T[:3, 3]
    D = np.array([[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]]) @ T[:3, :3]
    printed = np.array(
        [
            [
                l1 * s1 * s2 - d1 * s1 * c2 - d2 * c1 * s2,
                l2 * s1 + l1 * s1 * c2 - d2 * c1 * c2 + d1 * s1 * s2,
                c1 * (d1 + l2 * s2),
            ],
            [
                l1 * c1 * s2 + d1 * c1 * c2 - d2 * s1 * s2,
                l2 * c1 - l1 * c1 * c2 - d1 * c1 * s2 - d2 * s1 * c2,
                s1 * (d1 + l2 * s2),
            ],
            [d2 * c2, -d2 * s2, -l2 * c2 - l1],
        ]
    )
    rows = [Row("sec. 6", "M02, real part", T[:3, :3], T[:3, :3], ours.real)]
    for (i, j), number in {(1, 0): "0.11", (1, 1): "0.12"}.items():
        rows.append(Row("sec. 6", f"M02, eps part ({i + 1},{j + 1})", printed[i, j], D[i, j], ours.dual[i, j], number))
    others = [(i, j) for i in range(3) for j in range(3) if (i, j) not in {(1, 0), (1, 1)}]
    pick = tuple(np.transpose(others))
    rows.append(Row("sec. 6", "M02, eps part, other seven", printed[pick], D[pick], ours.dual[pick]))
    n_z, o_z = T[2, 0], T[2, 1]
    found = arm_.inverse_kinematics(T)
    rows += [
        Row(
            "inverse",
            "theta2 = atan(sqrt(1 - o_z^2) / o_z^2)",
            np.arctan(np.sqrt(1 - o_z**2) / o_z**2),
            np.arctan2(n_z, o_z),
            found[2],
            "0.14",
        ),
        Row(
            "inverse",
            "theta1 = atan(n_y / n_x), second quadrant",
            np.arctan(_pose(2.5)[1, 0] / _pose(2.5)[0, 0]),
            2.5,
            arm_.inverse_kinematics(_pose(2.5))[0],
            "0.15",
        ),
        Row("inverse", "d1, d2 from the eps part", None, np.array([d1, d2]), found[[1, 3]]),
    ]
    v = np.array([0.4, 3.0, -0.9, -2.0])
    V = arm_.chain.velocities(arm_.dual_coordinates(q), arm_.dual_coordinates(v))[-1]
    got = Dual(np.array([float(x.real) for x in V]), np.array([float(x.dual) for x in V]))
    w1, v1, w2, v2 = v
    right = Dual(
        [w1 * s2, w1 * c2, w2], [v1 * s2 + d2 * w1 * c2, v1 * c2 - d2 * w1 * s2 + l2 * w2, v2 - w1 * (l1 + l2 * c2)]
    )
    rows.append(
        Row(
            "sec. 6",
            "velocity of link 2: (0, sin a2 w2, cos a2 w2)",
            Dual([0.0, 0.0, w2], [0.0, l2 * w2, v2]),
            right,
            got,
            "0.16",
            note="the print is the velocity of 2 relative to 1",
        )
    )
    F = Dual(np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.2, -0.4]))
    rows.append(
        Row(
            "eq 25",
            "a force seen from another point: T F + eps T tau",
            Dual(T[:3, :3] @ F.real, T[:3, :3] @ F.dual),
            Dual(T[:3, :3] @ F.real, T[:3, :3] @ F.dual + np.cross(p, T[:3, :3] @ F.real)),
            ours @ F,
            "0.17",
            note="rotating keeps the reference point",
        )
    )
    return rows


def _dh(t: float, d: float, a: float, alpha: float) -> np.ndarray:
    """The homogeneous matrix written out: an independent derivation."""
    c, s, ca, sa = np.cos(t), np.sin(t), np.cos(alpha), np.sin(alpha)
    return np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1.0]])


def _pose(t1: float) -> np.ndarray:
    return _dh(t1, 20.0, 100.5, np.pi / 2) @ _dh(1.0, 15.0, 70.0, 0.0)


def dynamics() -> list[Row]:
    """The recursion of dual momenta against the Lagrangian (dp.rnea is checked against Pinocchio)."""
    rng = np.random.default_rng(0)
    bodies = []
    for m in (1.3, 0.9):
        X = rng.standard_normal((3, 3))
        bodies.append(dp.mechanisms.body(m, 0.05 * rng.standard_normal(3), 0.002 * (X @ X.T + np.eye(3))))
    arm_ = dp.mechanisms.TwoC(0.1005, 0.07, bodies=bodies)
    q, v, a = rng.standard_normal((3, 4))
    M, C, g = dp.crba(arm_.robot, q), dp.coriolis(arm_.robot, q, v), dp.gravity(arm_.robot, q)
    F = arm_.chain.forces(*map(arm_.dual_coordinates, (q, v, a)))
    rows = [
        Row(
            "sec. 5",
            "recursion of dual momenta, torque and force of each joint",
            None,
            M @ a + C @ v + g,
            np.stack([F.dual, F.real], -1).ravel(),
        )
    ]
    for name in dp.mechanisms.TOPOLOGIES:
        t = arm_.topology(name, q)
        f = t.free
        tau = t.rnea(q[f], v[f], a[f])
        sub = M[np.ix_(f, f)]
        held_v = t.spread(v[f])
        right = sub @ a[f] + (dp.coriolis(arm_.robot, q, held_v) @ held_v + g)[f]
        rows.append(Row("sec. 6", f"topology {name}: inverse dynamics", None, right, tau))
        rows.append(Row("sec. 6", f"topology {name}: forward dynamics", None, a[f], t.aba(q[f], v[f], tau), tol=1e-11))
    return rows


CLAIMS = [
    Claim(
        "sec. 2",
        "eps = E13 extends the oblique frame to three dimensions",
        "E13 squared is zero, so a 1 + b E13 models dual numbers; it kills two axes and has no geometric use",
        "holds in part",
        "0.6",
    ),
    Claim("sec. 6", "lengths l1, l2", "not given; the printed matrix implies l1 = 100.5 and l2 = 70", "holds", "0.13"),
    Claim(
        "sec. 5", "equilibrium without weight", "gravity added: the base accelerates upwards", "holds in part", "0.19"
    ),
    Claim(
        "conclusions",
        "a zero part of the dual angle makes the joint revolute or prismatic",
        "the part must be constant; offsets and fixed angles may be non-zero",
        "holds in part",
        "0.21",
    ),
    Claim(
        "sec. 5.1",
        "accelerations are no dual vectors",
        "the derivative of a velocity motor is a motor (spatial acceleration), and the recursion above uses it",
        "does not hold",
        "0.22",
    ),
]


def page() -> Page:
    return Page(
        "tapia_herrera",
        "The 2C arm by dual numbers (Tapia Herrera et al.)",
        "Dual numbers, the arm with two cylindrical joints, its nine topologies, and the recursion of dual momenta. "
        "Lengths in mm where the paper has them so.",
        [*numbers(), *arm(), *dynamics()],
        CLAIMS,
    )
