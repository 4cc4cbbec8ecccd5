"""Gouasmi et al.: dual quaternions and the PUMA 560."""

# ruff: noqa: E501  (rows of tables)

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import dualpin as dp
from dualpin import Dual
from dualpin.spatial import UX, UZ, ZERO_VECTOR, Pose, Quaternion, Rotation, Vector3, motor

from .common import Claim, Page, Row
from .counting import Counted, count

A2, A3, D2, D3, D4 = 0.4318, 0.0203, 0.1254, 0.0236, 0.4318
ALPHA = np.radians([-90.0, 0, 90, -90, 90, 0])
LENGTH, OFFSET = (0.0, A2, A3, 0, 0, 0), (0.0, D2, D3, D4, 0, 0)


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
    q = random_dual(0)
    p, d = q.real, q.dual
    n = p.dot(p)
    conj_dual = q.dual_conjugate
    # printed: 1/q - eps q_eps/q^2, read as q^-1 - eps (q^-1)^2 q_eps
    printed = lifted(p.inverse) - pure(p.inverse * p.inverse * d)
    unit = random_dual(1, unit=True)
    i = quaternion(0, 1, 0, 0)
    R, T = random_dual(2, unit=True).real, quaternion(0, 0.3, -1.2, 0.7)
    first = lifted(R) + pure(scaled(T * R, 0.5))
    second = lifted(R) + pure(scaled(R * T, 0.5))
    c = R.conjugate
    return [
        Row(
            "A8",
            "q^-1 = 1/q - eps q_eps / q^2 (times q, minus 1)",
            array(printed * q),
            ONE,
            array(q.inverse * q),
            "3.1",
        ),
        Row("A8", "inverse of a unit dual quaternion: its conjugate", None, array(unit.inverse), array(unit.conjugate)),
        Row(
            "A8",
            "conj(q) q is free of eps, dual part",
            array(conj_dual * q).dual,
            np.zeros(4),
            array(q.inverse * q).dual,
            "3.1",
        ),
        Row("A9", "q q* has the real part |q|^2", n, n, array(q * q.conjugate).real[0]),
        Row(
            "before A10",
            "|q|^2 as q squared, for q = i",
            array(i * i).real[0],
            1.0,
            array(i * i.conjugate).real[0],
            "3.2",
        ),
        Row(
            "A12",
            "inverse of R + eps T R / 2, printed without eps",
            array((lifted(c) - lifted(scaled(c * T, 0.5))) * first),
            ONE,
            array(first.inverse * first),
            "3.3",
        ),
        Row(
            "A13",
            "inverse of R + eps R T / 2, printed without eps",
            array((lifted(c) - lifted(scaled(T * c, 0.5))) * second),
            ONE,
            array(second.inverse * second),
            "3.3",
        ),
        Row(
            "A12",
            "inverse of R + eps T R / 2 with eps",
            array(lifted(c) - pure(scaled(c * T, 0.5))),
            array(first.inverse),
            array(first.conjugate),
        ),
    ]


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
    shift, back = np.eye(4), np.eye(4)
    shift[:3, 3], back[:3, 3] = u, -u
    with_R = [np.vstack([np.hstack([R, x[:3, 3:]]), [[0, 0, 0, 1]]]) for x in (shift, back)]
    return [
        Row(
            "example 1",
            "x 90 deg, then y 90 deg",
            Dual(np.array([0.5, 0.5, 0.5, -0.5]), np.zeros(4)),
            Dual(np.array([0.5, 0.5, 0.5, -0.5]), np.zeros(4)),
            array(qy * qx),
        ),
        Row(
            "example 1",
            "the other order",
            Dual(np.full(4, 0.5), np.zeros(4)),
            Dual(np.full(4, 0.5), np.zeros(4)),
            array(qx * qy),
        ),
        Row(
            "example 2",
            "dual quaternion",
            np.array([0.5, 0.5, 0.5, 0.5, -0.5, 0, 0, 0.5]),
            np.array([0.5, 0.5, 0.5, 0.5, -0.5, 0, 0, 0.5]),
            both,
        ),
        Row(
            "example 2",
            "angle and distance d = 2 / sqrt 3",
            Dual(2 * np.pi / 3, 2 / r3),
            Dual(2 * np.pi / 3, 2 / r3),
            Dual(s.angle, s.distance),
        ),
        Row(
            "example 2",
            "moment (-1, -1, 2) / (3 sqrt 3)",
            np.array([-1, -1, 2]) / (3 * r3),
            np.array([-1, -1, 2]) / (3 * r3),
            s.moment,
        ),
        Row("example 2", "foot (1/3, -1/3, 0)", u, u, s.point),
        Row("example 2", "pitch per turn 2 sqrt 3", 2 * r3, 2 * r3, 2 * np.pi * s.pitch),
        Row(
            "sec. VI",
            "product of three matrices, outer ones with the rotation block",
            with_R[0] @ about @ with_R[1],
            T,
            shift @ about @ back,
            "3.7",
        ),
    ]


def puma(q: np.ndarray) -> dp.Robot:
    rows = np.column_stack([np.zeros(6), OFFSET, LENGTH, ALPHA])
    return dp.from_dh(rows, joints="RRRRRR", convention="standard")


def kinematics() -> list[Row]:
    q = np.array([0.3, -0.6, 0.9, 0.4, -0.5, 0.2])
    c1, s1, c2, s2 = np.cos(q[0]), np.sin(q[0]), np.cos(q[1]), np.sin(q[1])
    c23, s23 = np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
    frames = dh_chain(q)
    T02, T03, T04 = frames[1], frames[2], frames[3]

    def ours(k: int) -> np.ndarray:
        """By products of dual quaternions alone."""
        return dp.spatial.to_matrix(_eight(by_quaternions(list(map(float, q[:k])))))

    p03 = np.array(
        [c1 * (A2 * c2 + A3 * c23) - (D2 + D3) * s1, s1 * (A2 * c2 + A3 * c23) + (D2 + D3) * c1, -A2 * s2 - A3 * s23]
    )
    R03 = np.array([[c1 * c23, -s1, c1 * s23], [s1 * c23, c1, s1 * s23], [-s23, 0, c23]])
    home = dh_chain(np.zeros(6))
    robot = puma(q)
    return [
        Row("eqs 15, 17", "T03, rotation", R03, T03[:3, :3], ours(3)[:3, :3]),
        Row("eq 17", "T03, origin", p03, T03[:3, 3], ours(3)[:3, 3]),
        Row(
            "eq 16",
            "T02, origin",
            np.array([A2 * c1 * c2 - D2 * s1, A2 * s1 * c2 + D2 * c1, -A2 * s2]),
            T02[:3, 3],
            ours(2)[:3, 3],
        ),
        Row(
            "sec. VIII",
            "wrist centre at home: (a2 + a3, d2 + d3, 0)",
            np.array([A2 + A3, D2 + D3, 0.0]),
            home[3][:3, 3],
            dp.spatial.to_matrix(_eight(by_quaternions([0.0] * 4)))[:3, 3],
            "3.12",
        ),
        Row("sec. VIII", "wrist centre, p + d4 (c1 s23, s1 s23, c23)", None, T04[:3, 3], ours(4)[:3, 3]),
        Row("Table 1", "tip by dual quaternions", None, frames[5], ours(6)),
        Row("Table 1", "tip of the robot from DH rows", None, frames[5], dp.fk(robot, q, robot.frame_names[-1])),
    ]


def dh_chain(q: np.ndarray) -> list[np.ndarray]:
    """4 x 4 products written out, with NumPy alone."""
    T, found = np.eye(4), []
    for t, d, a, alpha in zip(q, OFFSET, LENGTH, ALPHA, strict=True):
        c, s, ca, sa = np.cos(t), np.sin(t), np.cos(alpha), np.sin(alpha)
        T = T @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1.0]])
        found.append(T)
    return found


# --- the same chain three ways, over any scalar ------------------------------------------------------


def _links(kind: Any) -> list[Any]:
    """The constant link transforms X(alpha + eps a)."""
    found = []
    for a, alpha in zip(LENGTH, ALPHA, strict=True):
        angle = Dual(float(alpha), float(a))
        if kind is Quaternion:
            found.append(Quaternion.about(displacement_axis(UX), angle))
        elif kind is Rotation:
            found.append(Rotation.about(UX, angle))
        else:
            found.append(Pose.about(UX, angle))
    return found


def displacement_axis(axis: Vector3) -> Vector3:
    return motor(axis, ZERO_VECTOR)


def by_quaternions(q: list[Any]) -> Quaternion:
    """Product of Z(theta + eps d) X(alpha + eps a) as dual quaternions."""
    total = None
    for t, d, X in zip(q, OFFSET, _QUATERNIONS, strict=False):
        step = Quaternion.about(displacement_axis(UZ), Dual(t, d)) * X
        total = step if total is None else total * step
    return total


def by_dual_matrices(q: list[Any]) -> Rotation:
    """The same as dual 3 x 3 matrices."""
    total = None
    for t, d, X in zip(q, OFFSET, _ROTATIONS, strict=False):
        step = Rotation.about(UZ, Dual(t, d)) @ X
        total = step if total is None else total @ step
    return total


def by_homogeneous(q: list[Any]) -> Pose:
    """The same as homogeneous matrices [R p; 0 1]."""
    total = None
    for t, d, X in zip(q, OFFSET, _POSES, strict=False):
        step = Pose.about(UZ, Dual(t, d)) @ X
        total = step if total is None else total @ step
    return total


_QUATERNIONS, _ROTATIONS, _POSES = (_links(kind) for kind in (Quaternion, Rotation, Pose))
WAYS: dict[str, Callable[[list[Any]], Any]] = {
    "dual quaternions (8 numbers)": by_quaternions,
    "dual 3 x 3 matrices (18 numbers)": by_dual_matrices,
    "homogeneous DH matrices (12 numbers)": by_homogeneous,
}


def _eight(q: Quaternion) -> np.ndarray:
    d = array(q)
    x = np.concatenate((d.real, d.dual))
    return x if x[0] >= 0 else -x


def costs() -> str:
    """Operations counted by running; times of batches of 10,000 and of one call, as ratios."""
    rng = np.random.default_rng(0)
    one, many = list(map(float, rng.standard_normal(6))), list(rng.standard_normal((6, 10_000)))
    lines = [
        "## Cost of the forward kinematics of the PUMA 560",
        "",
        "Counted by running the product of Z(theta + eps d) X(alpha + eps a) on a scalar that counts; products with known "
        "zeros and ones are free, constants of the links are prepared. Time relative to homogeneous matrices, best of 7, "
        "plain Python (one call) and NumPy columns (10,000 calls).",
        "",
        "| representation | products | sums | sines, cosines | time, one call | time, 10,000 calls |",
        "|---|---|---|---|---|---|",
    ]
    base = [_seconds(lambda x=x: by_homogeneous(x)) for x in (one, many)]
    for name, f in WAYS.items():
        n = count(f, [Counted() for _ in range(6)])
        ratios = [_seconds(lambda x=x, f=f: f(x)) / b for x, b in zip((one, many), base, strict=True)]
        lines.append(f"| {name} | {n[0]} | {n[1]} | {n[2]} | {ratios[0]:.2f} | {ratios[1]:.2f} |")
    return "\n".join(lines)


def _seconds(f: Callable[[], Any]) -> float:
    best = np.inf
    for _ in range(7):
        start = time.perf_counter()
        f()
        best = min(best, time.perf_counter() - start)
    return best


CLAIMS = [
    Claim(
        "sec. II",
        "dual quaternions are free of singularities of any kind",
        "as a representation yes; the map to (angle, axis, distance, moment) is singular at angle 0, and q, -q are one "
        "motion",
        "holds in part",
        "3.18",
    ),
    Claim(
        "sec. IX", "the fastest method", "no time is printed; see the measured cost below", "not reproducible", "3.20"
    ),
    Claim(
        "sec. VIII",
        "link lengths",
        "no numbers are printed; those of a common data set are used here",
        "not reproducible",
        "3.21",
    ),
    Claim("sec. V", "pitch", "per turn, 2 pi n.t / theta: 2 pi times the pitch per radian used here", "holds", "3.17"),
]


def page() -> Page:
    return Page(
        "gouasmi",
        "Dual quaternions and the PUMA 560 (Gouasmi et al.)",
        f"Lengths of the arm (not in the paper): a2 = {A2}, a3 = {A3}, d2 = {D2}, d3 = {D3}, d4 = {D4} m.",
        [*algebra(), *examples(), *kinematics()],
        CLAIMS,
        [costs()],
    )
