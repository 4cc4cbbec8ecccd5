"""Gouasmi et al.: dual quaternions and the PUMA 560."""

# ruff: noqa: E501  (rows of a table, one a line)
# fmt: off

from __future__ import annotations

import numpy as np

import dualpin as dp
from dualpin import Dual
from dualpin.spatial import Pose, Quaternion, Rotation

from .common import ASSUMING, CANNOT, CONVENTION, DRAWN, FAILS, MEASURED, OUTSIDE, PART, Page, Row
from .counting import Counted, count
from .gouasmi_cost import (
    A2,
    A3,
    ALPHA,
    D2,
    D3,
    D4,
    LENGTH,
    OFFSET,
    WAYS,
    by_dual_matrices,
    by_homogeneous,
    by_quaternions,
    costs,
)


def quaternion(*x: float) -> Quaternion:
    return Quaternion(*map(float, x))


def array(q: Quaternion) -> Dual:
    parts = [c if isinstance(c, Dual) else Dual(float(c), 0.0) for c in q]
    return Dual(np.array([float(c.real) for c in parts]), np.array([float(c.dual) for c in parts]))


def random_dual(seed: int, unit: bool = False) -> Quaternion:
    rng = np.random.default_rng(seed)
    q = Quaternion(*(Dual(float(a), float(b)) for a, b in rng.standard_normal((4, 2))))
    return q.normalized if unit else q


def scaled(q: Quaternion, s: float) -> Quaternion:
    return Quaternion(*(c * s for c in q))


def pure(q: Quaternion) -> Quaternion:
    """eps q"""
    return Quaternion(*(Dual(0.0, c) for c in q))


def lifted(q: Quaternion) -> Quaternion:
    return Quaternion(*(Dual(c, 0.0) for c in q))


ONE = Dual(np.array([1.0, 0, 0, 0]), np.zeros(4))


def algebra() -> list[Row]:
    q, r = random_dual(0), random_dual(5)
    p, d = q.real, q.dual
    unit, other = random_dual(1, unit=True), random_dual(6, unit=True)
    i = quaternion(0, 1, 0, 0)
    R, T = random_dual(2, unit=True).real, quaternion(0, 0.3, -1.2, 0.7)
    first, second = lifted(R) + pure(scaled(T * R, 0.5)), lifted(R) + pure(scaled(R * T, 0.5))
    c = R.conjugate
    printed = lifted(p.inverse) - pure(
        p.inverse * p.inverse * d
    )  # 1/q - eps q_eps / q^2, read as q^-1 - eps (q^-1)^2 q_eps
    v, t = np.array([0.4, -0.1, 2.0]), np.array([0.3, -1.2, 0.7])
    rotation = random_dual(2, unit=True).real
    x, y = eight(unit), eight(other)
    points = np.array([[0.4, 0.1, -0.7], [1.0, 2.0, 3.0]])
    n, theta, slide = np.array([2.0, -1.0, 2.0]) / 3, 0.9, 0.4
    sp = dp.spatial
    shift = sp.exp([0, 0, 0, *t])
    vector = array(rotation * quaternion(0, *v) * rotation.conjugate).real[1:]
    moved = sp.quaternion_to_matrix(array(rotation).real) @ v
    a, b = p, r.real
    product = np.concatenate(
        ([a.w * b.w - a.v.dot(b.v)], np.array([*b.v]) * a.w + np.array([*a.v]) * b.w + np.cross([*a.v], [*b.v]))
    )
    half = Dual(theta / 2, slide / 2)
    return [
        Row("A1", "product of quaternions", "(s1 s2 - m1.m2, s1 m2 + s2 m1 + m1 x m2)", product, array(a * b).real),
        Row("A1", "quaternion multiplication is anti-commutative (sec. III)", "", None, "not commutative: q1 q2 and q2 q1 differ, and are not each other's negative", FAILS),
        Row("A2", "conjugate; inverse q* / |q|^2; |q|^2 = q q*", "(s, -m)", array(a.inverse).real, array(a.conjugate).real / a.dot(a), note="dualpin: Quaternion.conjugate, .inverse"),
        Row("A3", "rotation of a vector", "q v q*", vector, moved, note="dualpin: spatial.quaternion_to_matrix, transform_points"),
        Row("A4", "two rotations: p (q v q*) p* = (p q) v (p q)*", "C = p q", array((R * rotation) * quaternion(0, *v) * (R * rotation).conjugate).real[1:], sp.quaternion_to_matrix(array(R).real) @ moved),
        Row("A5", "turn by theta about n", "cos(theta/2) + sin(theta/2) n", np.concatenate(([np.cos(theta / 2)], np.sin(theta / 2) * n)), sp.matrix_to_quaternion(sp.to_matrix(sp.exp([*(theta * n), 0, 0, 0]))[:3, :3]), note="the conversions of sec. 10.b for arrays: matrix_to_quaternion, quaternion_to_matrix"),
        Row("A6", "a dual quaternion as eight numbers; i, j, k are missing in its eps part", "q + eps q_eps", x, np.concatenate((array(unit).real, array(unit).dual)), CONVENTION, note="read with the units; w x y z | w x y z"),
        Row("A7", "product", "q1 q2 + eps (q1 q2_eps + q1_eps q2)", np.concatenate((array(p * r.real).real, array(p * r.dual + d * r.real).real)), np.concatenate((array(q * r).real, array(q * r).dual)), note="dualpin: spatial.compose"),
        Row("A8", "dual conjugate", "q - eps q_eps", Dual(array(p).real, -array(d).real), array(q.dual_conjugate)),
        Row("A8", "inverse", "1 / q - eps q_eps / q^2", array(printed * q), array(q.inverse * q), CANNOT, ONE, note="that is for numbers that commute; q^-1 - eps q^-1 q_eps q^-1, and q* for unit q. Shown: inverse times q"),
        Row("A8", "the dual conjugate times q is free of eps", "qbar q / (qbar q)", array(q.dual_conjugate * q).dual, array(q.inverse * q).dual, CANNOT, np.zeros(4), note="its eps part is q q_eps - q_eps q"),
        Row("A8", "no inverse of a pure dual quaternion", "q = 0", None, "DualDivisionError says so", MEASURED),
        Row("A9", "both conjugations", "(s, -x, -y, -z, -s_eps, x_eps, y_eps, z_eps)", Dual(np.array([1, -1, -1, -1]) * array(p).real, np.array([-1, 1, 1, 1]) * array(d).real), array(q.dual_conjugate.conjugate)),
        Row("before A10", "unit magnitude", "|q| = (q + eps q_eps)^2 = 1", array(i * i).real[0], array(i * i.conjugate).real[0], CANNOT, 1.0, note="i^2 = -1, and i is a unit quaternion; q q* = 1"),
        Row("A10", "the two conditions", "s^2 + x^2 + y^2 + z^2 = 1; s s_eps + ... = 0", np.array([1.0, 0.0]), np.array([x[:4] @ x[:4], x[:4] @ x[4:]]), note="dualpin refuses what breaks them by 1e-6"),
        Row("after A10", "translation of a point", "(1 + eps T/2) (1 + eps v) (1 + eps T/2)", v + t, sp.transform_points(shift, v), note="dualpin: spatial.transform_points"),
        Row("A11", "two motions of a point", "p (q x qbar*) pbar* = (p q) x (p q)bar*", sp.transform_points(y, sp.transform_points(x, points)), sp.transform_points(sp.compose(y, x), points), note="the text below cites it as eq (22)"),
        Row("A12", "rotation, then translation", "R + eps T R / 2", first_eight(first), sp.compose(sp.exp([0, 0, 0, 0.3, -1.2, 0.7]), np.concatenate((array(R).real, np.zeros(4)))), digits=1e-12),
        Row("A12", "its inverse", "R* - R* T / 2", array((lifted(c) - lifted(scaled(c * T, 0.5))) * first), array(first.inverse * first), CANNOT, ONE, note="eps is missing before the second term. Shown: inverse times the motion"),
        Row("A13", "translation, then rotation", "R + eps R T / 2", first_eight(second), sp.compose(np.concatenate((array(R).real, np.zeros(4))), sp.exp([0, 0, 0, 0.3, -1.2, 0.7])), note="a second q_R after the bracket is one too many"),
        Row("A13", "its inverse", "R* - T R* / 2", array((lifted(c) - lifted(scaled(T * c, 0.5))) * second), array(second.inverse * second), CANNOT, ONE, note="eps is missing before the second term. Shown: inverse times the motion"),
        Row("A14", "several motions of a point", "q_n ... q_1 (1 + eps v) conj", sp.transform_points(sp.compose(y, sp.compose(x, shift)), v), sp.transform_points(y, sp.transform_points(x, sp.transform_points(shift, v)))),
        Row("A15", "dual angle and line: cos and sin of half of it", "cos - eps d/2 sin; sin + eps d/2 cos", np.stack([Dual(np.cos(theta / 2), -slide / 2 * np.sin(theta / 2)), Dual(np.sin(theta / 2), slide / 2 * np.cos(theta / 2))]), np.stack([np.cos(half), np.sin(half)])),
    ]


def first_eight(q: Quaternion) -> np.ndarray:
    d = array(q)
    return np.concatenate((d.real, d.dual))


def eight(q: Quaternion) -> np.ndarray:
    """With w >= 0, as dualpin's arrays."""
    x = first_eight(q)
    return x if x[0] >= 0 else -x


def forms() -> list[Row]:
    n, theta, d, rho = np.array([2.0, -1.0, 2.0]) / 3, 0.9, 0.4, np.array([1.0, 0.5, -0.2])
    m = np.cross(rho, n)
    c, s = np.cos(theta / 2), np.sin(theta / 2)
    x = dp.spatial.exp([*(theta * n), *(d * n + theta * m)])
    T = dp.spatial.to_matrix(x)
    t = T[:3, 3]
    by_1 = np.concatenate(([c], s * n, [-t @ n / 2 * s], np.cross(t, n) / 2 * s + t / 2 * c))
    by_2 = np.concatenate(([c], s * n, [-d / 2 * s], m * s + d / 2 * n * c))
    found = dp.spatial.screw_parameters(x)
    R = T[:3, :3]
    return [
        Row("eq 1", "product type: from rotation and translation", "(cos, n sin) + eps (-T.n/2 sin, T x n/2 sin + T/2 cos)", by_1, dp.spatial.from_matrix(T)),
        Row("eq 2", "dual type: from dual angle and line", "(cos, n sin) + eps (-d/2 sin, m sin + d/2 n cos)", by_2, x, note="dualpin: spatial.exp([theta n, d n + theta m])"),
        Row("eqs 1-2", "both are the same motion", "", by_1, by_2),
        Row("sec. II", "theta, n, d, m describe every motion", "four parameters", np.concatenate(([theta, d], n, m)), np.concatenate(([found.angle, found.distance], found.axis, found.moment)), note="dualpin: spatial.screw_parameters"),
        Row("sec. II", "dual quaternions are free of singularities of any kind", "", None, "as motions yes; theta, n, d, m are not: at theta = 0 the line is not determined, at pi its sign is not; and q, -q are one motion", PART),
        Row("eq 3", "sec. IV: a product of motions is a motion", "[R t; 0 1]", T @ T, dp.spatial.to_matrix(dp.spatial.compose(x, x))),
        Row("eq 3", "sec. V (a second eq 3): a screw placed by conjugation", "(I u) (R, theta p n / 2 pi) (I -u)", np.concatenate((R, (d * n + (np.eye(3) - R) @ rho)[:, None]), axis=1), T[:3], CONVENTION, note="its pitch p is per turn, p = 2 pi d / theta"),
        Row("sec. V", "pitch", "p = 2 pi n.t / theta", 2 * np.pi * n @ t / theta, 2 * np.pi * found.pitch, CONVENTION, note="per turn; screw_parameters gives metres per radian"),
        Row("sec. V", "the axis point normal to the axis: (1 - R) u = t - (n.t) n", "n.u = 0", np.concatenate(((np.eye(3) - R) @ found.point, [0.0])), np.concatenate((t - (n @ t) * n, [n @ found.point])), note="two lines before read n.(t - theta p / 2 pi) = 0, without n"),
        Row("sec. I", "the helicoidal axis from points of a body", "several methods, cited", None, _markers(), MEASURED, note="dualpin: algebra.screw_from_markers, least squares in dual numbers, with deviations"),
    ]


def _markers() -> str:
    rng = np.random.default_rng(0)
    before = rng.uniform(-0.1, 0.1, (6, 3))
    x = dp.spatial.exp([0.2, -0.3, 0.6, 0.1, 0.0, 0.2])
    found = dp.algebra.screw_from_markers(
        before, dp.spatial.transform_points(x, before) + 1e-3 * rng.standard_normal((6, 3))
    )
    off = float(found.screw.angle - 0.7)
    return (
        f"six markers, noise of 1 mm: angle 0.7 {off:+.4f} rad, deviation told {float(found.deviations['angle']):.4f}"
    )


def examples() -> list[Row]:
    half = np.pi / 4
    qx, qy = (quaternion(np.cos(half), *(np.sin(half) * e)) for e in (np.array([1.0, 0, 0]), np.array([0.0, 1, 0])))
    X = dp.spatial.exp([np.pi / 2, 0, 0, 1, 0, 0])
    Y = dp.spatial.exp([0, np.pi / 2, 0, 0, 1, 0])
    both = dp.spatial.compose(X, Y)  # along y first, then along x
    s = dp.spatial.screw_parameters(both)
    T = dp.spatial.to_matrix(both)
    r3 = np.sqrt(3.0)
    R = T[:3, :3]
    u = np.array([1 / 3, -1 / 3, 0.0])
    about = np.eye(4)
    about[:3, :3], about[:3, 3] = R, s.distance * s.axis
    with_R = [np.vstack([np.hstack([R, x[:, None]]), [[0, 0, 0, 1]]]) for x in (u, -u)]
    shift = [np.vstack([np.hstack([np.eye(3), x[:, None]]), [[0, 0, 0, 1]]]) for x in (u, -u)]
    R21 = np.array([[0, 1, 0], [0, 0, -1], [-1, 0, 0]])
    t = T[:3, 3]
    first = dp.spatial.screw_parameters(dp.spatial.to_matrix(np.concatenate((array(qy * qx).real, np.zeros(4)))))
    return [
        Row("example 1", "x 90 degrees, then y 90 degrees", "(1/2, 1/2, 1/2, -1/2)", np.array([0.5, 0.5, 0.5, -0.5]), array(qy * qx).real),
        Row("example 1", "angle and axis", "120 degrees, (1, 1, -1) / sqrt 3", np.array([2 * np.pi / 3, 1 / r3, 1 / r3, -1 / r3]), np.array([first.angle, *first.axis])),
        Row("example 1", "by matrices R2 R1", "(0 1 0; 0 0 -1; -1 0 0)", R21, dp.spatial.quaternion_to_matrix(array(qy * qx).real)),
        Row("example 1", "the other order", "(1/2, 1/2, 1/2, 1/2)", np.full(4, 0.5), array(qx * qy).real),
        Row("sec. IV", "rotation then translation, translation then rotation", "t; R t", np.stack([t, R @ t]), np.stack([_block(np.eye(3), t) @ [0, 0, 0, 1], _block(R, np.zeros(3)) @ [*t, 1]])[:, :3]),
        Row("eq 4", "T2 T1 of the screws about y and x", "(0 0 1 1; 1 0 0 0; 0 1 0 1)", np.array([[0, 0, 1, 1], [1, 0, 0, 0], [0, 1, 0, 1]]), T[:3]),
        Row("sec. VI", "pitch", "2 sqrt 3", 2 * r3, 2 * np.pi * s.pitch, CONVENTION, note="per turn"),
        Row("sec. VI", "T1 along the axis, T2 across", "(2/3, 2/3, 2/3), (1/3, -2/3, 1/3)", np.array([[2 / 3] * 3, [1 / 3, -2 / 3, 1 / 3]]), np.array([s.distance * s.axis, t - s.distance * s.axis])),
        Row("eq 5", "points of the axis in the three planes", "u_x - u_z = 1/3, ...: (0, -2/3, -1/3), (2/3, 0, 1/3), (1/3, -1/3, 0)", np.zeros(3), np.array([np.linalg.norm(np.cross(p, s.axis) - s.moment) for p in ([0, -2 / 3, -1 / 3], [2 / 3, 0, 1 / 3], [1 / 3, -1 / 3, 0])])),
        Row("sec. VI", "product of three matrices, outer ones with the rotation block", "(R u) (R d n) (R -u) = eq 4", with_R[0] @ about @ with_R[1], shift[0] @ about @ shift[1], CANNOT, T, note="R^3 = 1 would be its rotation; with (1 u) outside it holds. Perhaps a reading of the layout"),
        Row("sec. VII", "dual quaternions of both screws, about y and about x", "(sqrt2/2, 0, sqrt2/2, 0) + eps/2 (-sqrt2/2, 0, sqrt2/2, 0), ...", np.array([[1, 0, 1, 0, -0.5, 0, 0.5, 0], [1, 1, 0, 0, -0.5, 0.5, 0, 0]]) / np.sqrt(2), np.stack([Y, X]), note="the second is named q_z, t_z; it is about x"),
        Row("eq 6", "their product", "(1/2, 1/2, 1/2, 1/2) + eps/2 (-1, 0, 0, 1)", np.array([0.5, 0.5, 0.5, 0.5, -0.5, 0, 0, 0.5]), both),
        Row("sec. VII", "distance along the axis", "2 / sqrt 3", 2 / r3, s.distance),
        Row("sec. VII", "moment of the axis", "(-1, -1, 2) / (3 sqrt 3)", np.array([-1, -1, 2]) / (3 * r3), s.moment),
        Row("sec. VII", "point of the axis", "(1/3, -1/3, 0)", u, s.point, note="with u_z = 0, which happens to be the nearest to the origin"),
        Row("sec. 10.a", "Matlab: quatmultiply(q2, q1), R2 R1 and R1 R2", "0.5000 0.5000 0.5000 -0.5000; ...", np.array([0.5, 0.5, 0.5, -0.5]), array(qy * qx).real, digits=5e-5),
    ]


def _block(R: np.ndarray, t: np.ndarray) -> np.ndarray:
    return np.vstack([np.hstack([R, t[:, None]]), [[0, 0, 0, 1.0]]])


def puma() -> dp.Robot:
    rows = np.column_stack([np.zeros(6), OFFSET, LENGTH, ALPHA])
    return dp.from_dh(rows, joints="RRRRRR", convention="standard")


def kinematics() -> list[Row]:
    q = np.array([0.3, -0.6, 0.9, 0.4, -0.5, 0.2])
    c1, s1, c2, s2 = np.cos(q[0]), np.sin(q[0]), np.cos(q[1]), np.sin(q[1])
    c3, s3 = np.cos(q[2]), np.sin(q[2])
    c23, s23 = np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
    frames = dh_chain(q)
    robot = puma()
    ours = [dp.fk(robot, q, f"frame_{i}") for i in range(1, 7)]
    steps = [ours[0], np.linalg.inv(ours[0]) @ ours[1], np.linalg.inv(ours[1]) @ ours[2]]
    T01 = np.array([[c1, 0, -s1, 0], [s1, 0, c1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    T12 = np.array([[c2, -s2, 0, A2 * c2], [s2, c2, 0, A2 * s2], [0, 0, 1, D2], [0, 0, 0, 1]])
    T23 = np.array([[c3, 0, s3, A3 * c3], [s3, 0, -c3, A3 * s3], [0, 1, 0, D3], [0, 0, 0, 1]])
    p02 = np.array([A2 * c1 * c2 - D2 * s1, A2 * s1 * c2 + D2 * c1, -A2 * s2])
    T02 = np.array(
        [[c1 * c2, -c1 * s2, -s1, p02[0]], [s1 * c2, -s1 * s2, c1, p02[1]], [-s2, -c2, 0, p02[2]], [0, 0, 0, 1]]
    )
    p03 = np.array(
        [c1 * (A2 * c2 + A3 * c23) - (D2 + D3) * s1, s1 * (A2 * c2 + A3 * c23) + (D2 + D3) * c1, -A2 * s2 - A3 * s23]
    )
    R03 = np.array([[c1 * c23, -s1, c1 * s23], [s1 * c23, c1, s1 * s23], [-s23, 0, c23]])
    q1, q2 = dp.spatial.exp([0, 0, q[0], 0, 0, 0]), dp.spatial.exp([0, q[1], 0, 0, 0, 0])
    third = dp.spatial.exp([*(q[2] * np.array([0, 1.0, 0])), *(q[2] * np.cross([A2, D2, 0], [0, 1.0, 0]))])
    by_sandwich = dp.spatial.transform_points(dp.spatial.compose(q1, q2), [A2, D2, 0])
    end = [A2 + A3, D2 + D3, 0]
    v3 = dp.spatial.transform_points(third, end)
    chain = dp.spatial.compose(q1, dp.spatial.compose(q2, third))
    home = dh_chain(np.zeros(6))
    written = np.array(
        [
            [np.cos(0.7), -np.cos(0.4) * np.sin(0.7), np.sin(0.4) * np.sin(0.7), 0.2 * np.cos(0.7)],
            [np.sin(0.7), np.cos(0.4) * np.cos(0.7), -np.sin(0.4) * np.cos(0.7), 0.2 * np.sin(0.7)],
            [0, np.sin(0.4), np.cos(0.4), 0.5],
            [0, 0, 0, 1],
        ]
    )
    one = Pose.dh(Dual(0.7, 0.5), Dual(0.4, 0.2)).array
    urdf = dp.load("puma560")
    return [
        Row("eq 7", "centre O3 by two rotations of a point, q1 q2 v conj", "(a2 c1 c2 - d2 s1, a2 s1 c2 + d2 c1, -a2 s2)", p02, by_sandwich, note="dualpin: spatial.transform_points; c_i, s_i mean half angles in the paper's quaternions, whole ones in its matrices"),
        Row("sec. VIII", "third rotation: axis through (a2, d2, 0) along y", "(c3, 0, s3, 0) + eps (0, 0, 0, a2 s3)", np.array([np.cos(q[2] / 2), 0, np.sin(q[2] / 2), 0, 0, 0, 0, A2 * np.sin(q[2] / 2)]), third, CONVENTION, note="half angles"),
        Row("eq 8", "O4 after the third rotation", "(a2 + a3 c3, d2 + d3, -a3 s3)", np.array([A2 + A3 * c3, D2 + D3, -A3 * s3]), v3, note="one line before it s3 (-A) stands for s3 (a2 - A)"),
        Row("sec. VIII", "O4 after the second", "(a2 c2 + a3 c23, d2 + d3, -a2 s2 - a3 s23)", np.array([A2 * c2 + A3 * c23, D2 + D3, -A2 * s2 - A3 * s23]), dp.spatial.transform_points(q2, v3)),
        Row("sec. VIII", "O4 after all three", "c1 (a2 c2 + a3 c23) - s1 (d2 + d3), ...", p03, dp.spatial.transform_points(chain, end), right=frames[2][:3, 3]),
        Row("sec. VIII", "O4 is the centre of the wrist", "(a2 + a3, d2 + d3, 0)", np.array(end), dp.fk(robot, np.zeros(6), "frame_4")[:3, 3], CANNOT, home[3][:3, 3], note="that is the origin of frame 3; with Table 1 the wrist's centre is d4 further along z"),
        Row("eqs 9-11", "a step [R d; 0 1], its rotation and translation", "cos, -cos sin, ...; a cos, a sin, d", written[:3], one[:3]),
        Row("eq 12", "the step as one matrix", "4 x 4", written, one),
        Row("Table 1", "alpha, a, d of six rows; joint 5 has q4, joint 6 nothing", "alpha = -90, 0, 90, -90, 90, 0 degrees; a2, a3, d2, d3, d4", np.degrees(ALPHA), np.degrees([r.alpha for r in dp.to_dh(robot, tip="frame_6", convention="standard").rows]), CONVENTION, note="read as q5, q6, and d6 = 0"),
        Row("Table 1", "lengths", "a2, a3, d2, d3, d4 without numbers", np.array([A2, A3, D2, D3, D4]), _lengths(urdf), ASSUMING, note="those of Armstrong, Khatib & Burdick (1986); computed: read back from urdf/puma560/puma560.urdf; d2 and d3 are two offsets, only their sum shows"),
        Row("eq 13", "T_0^1", "(c1 0 -s1 0; s1 0 c1 0; 0 -1 0 0)", T01, steps[0]),
        Row("eq 14", "T_1^2", "(c2 -s2 0 a2 c2; ...; d2)", T12, steps[1]),
        Row("eq 15", "T_0^2", "twelve entries", T02, ours[1], right=frames[1]),
        Row("eq 16", "T_2^3", "(c3 0 s3 a3 c3; ...; d3)", T23, steps[2]),
        Row("eq 17", "T_0^3; entries -s1, c1 s23 merged in the reading", "twelve entries", np.vstack([np.hstack([R03, p03[:, None]]), [[0, 0, 0, 1]]]), ours[2], right=frames[2]),
        Row("sec. VIII", "the rest of the chain, to the tip", "", None, ours[5], MEASURED, frames[5]),
        Row("sec. VIII", "the URDF of the model stands where the rows do", "", None, dp.fk(urdf, q, urdf.frame_names[-1]), MEASURED, frames[5]),
        Row("secs. VIII, IX", "dual quaternions and matrices confirm one another", "the same results", dp.spatial.to_matrix(eight(by_quaternions(list(map(float, q))))), by_homogeneous(list(map(float, q))).array, right=stack4(by_dual_matrices(list(map(float, q))))),
        Row("abstract, IX", "the fastest method is, undoubtedly, dual quaternions", "no time", None, f"{_products('dual quaternions')} multiplications against {_products('homogeneous')} of homogeneous matrices for the six joints: by the count it is not; times below", FAILS),
        Row("sec. II", "dual quaternions have been around since 1882", "1882 (sec. I), 1873 (sec. 10.b.ii)", None, "1873", FAILS),
        Row("sec. III", "from a matrix, angle and axis are found by a long and sometimes complicated process only", "", None, "screw_parameters(T) gives them from a matrix as from a dual quaternion; it goes by the quaternion of the largest divisor (Shepperd)", PART),
        Row("sec. II", "classical quaternions represent rotations about axes through O only; dual ones about any axis", "", np.array([1.0, 0.0, 0.0]), dp.spatial.transform_points(dp.spatial.exp([0, 0, np.pi / 2, 0, -np.pi / 2, 0]), [1.0, 0, 0]), note="a quarter turn about the vertical line through (1, 0, 0), which stays"),
        Row("sec. IX", "Denavit-Hartenberg frames are awkward to choose", "", None, "", OUTSIDE, note="a judgement; dp.to_dh chooses them from any description"),
        Row("Fig 1", "helicoidal motion: axis, moment, angle, slide", "", None, "figures/screw_motion.svg", DRAWN, note="of example 2"),
        Row("Figs 2-4", "(2,1), (2,2): a body on a screw; 3: the PUMA's frames; 4: DH parameters", "", None, "figures/screw_motion.svg, figures/puma_frames.svg", DRAWN),
    ]


def _lengths(robot: dp.Robot) -> np.ndarray:
    """a2, a3, d2, d3, d4 as the file's joints stand (modified rows: a before the joint, d along its axis)."""
    second, third, fourth = ([float(x) for x in robot.joint(f"joint_{i}").placement.position] for i in (2, 3, 4))
    return np.array([third[0], fourth[0], second[1], third[2], -fourth[1]])


def stack4(R: Rotation) -> np.ndarray:
    return dp.algebra.homogeneous(
        np.stack([np.stack([x if isinstance(x, Dual) else Dual(float(x), 0.0) for x in row]) for row in R.rows])
    )


def _products(way: str) -> int:
    f = next(g for name, g in WAYS.items() if name.startswith(way))
    return count(f, [Counted() for _ in range(6)])[0]


def dh_chain(q: np.ndarray) -> list[np.ndarray]:
    """4 x 4 products written out, with NumPy alone."""
    T, found = np.eye(4), []
    for t, d, a, alpha in zip(q, OFFSET, LENGTH, ALPHA, strict=True):
        c, s, ca, sa = np.cos(t), np.sin(t), np.cos(alpha), np.sin(alpha)
        T = T @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1.0]])
        found.append(T)
    return found


def page() -> Page:
    return Page(
        "gouasmi",
        "Dual quaternions and the PUMA 560",
        "M. Gouasmi, B. Gouasmi, M. Ouali: The kinematics of a Puma robot using dual quaternions. Global Journal of Researches in "
        "Engineering H 20 (2020) 1.",
        f"Lengths of the arm, which the paper does not give: a2 = {A2}, a3 = {A3}, d2 = {D2}, d3 = {D3}, d4 = {D4} m (Armstrong, Khatib "
        "& Burdick 1986), as in urdf/puma560. Docs: [The five papers: dual quaternions](../../docs/papers/gouasmi.md).",
        [*forms(), *examples(), *kinematics(), *algebra()],
        {
            "screw_motion.svg": "The screw of example 2: a body at the start, on the way and at the end, the axis through (1/3, -1/3, 0), a turn of 120 degrees and a slide of 2 / sqrt 3 (Figs 1 and 2).",
            "puma_frames.svg": "The PUMA 560 at home with its seven Denavit-Hartenberg frames, z blue, and the axes of its six screws, dotted (Figs 3 and 4; Table 1).",
        },
        "the other article of the same journal issue (a surgical interface), which is no part of this paper; Matlab as a program.",
        [costs()],
    )
