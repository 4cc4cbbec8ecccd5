"""Tapia Herrera et al. (2012): kinematics and dynamics of a 2C arm by dual numbers."""

# ruff: noqa: E501  (rows of a table, one a line)
# fmt: off

from __future__ import annotations

import numpy as np

import dualpin as dp
from dualpin import Dual

from .common import ASSUMING, CANNOT, CONVENTION, DRAWN, FAILS, MEASURED, OUTSIDE, PART, Page, Row

H = 1e-30  # of complex steps
EPS = np.array([[0.0, 1.0], [0.0, 0.0]])
L1, L2, T1, T2, D1, D2 = 100.5, 70.0, 0.5, 1.0, 20.0, 15.0
ARM = dp.mechanisms.TwoC(L1, L2)
Q = np.array([T1, D1, T2, D2])


def matrix(x: Dual) -> np.ndarray:
    """The 2 x 2 model of eq 7."""
    return np.array([[x.real, x.dual], [0.0, x.real]])


def number(M: np.ndarray) -> Dual:
    return Dual(M[0, 0], M[0, 1])


def numbers() -> list[Row]:
    a, b = Dual(2.3, -1.7), Dual(0.8, 0.6)
    u, v = 0.7, -1.3
    root = Dual(np.sqrt(2.3), np.sqrt(2.3 - 1.7j * H).imag / H)
    return [
        Row("eqs 1-5", "the oblique frame: x = a u + b v, y = a v; tangents a i, b i + a j", "(x, y) = (a b; 0 a) (u, v)", matrix(a) @ [u, v], np.array([2.3 * u - 1.7 * v, 2.3 * v])),
        Row("eq 2", "position vector", "r = (a u + b v) i + a v j", np.array([2.3 * u - 1.7 * v, 2.3 * v]), matrix(a) @ [u, v], note="the vector before it reads r = x i + y, without j"),
        Row("eqs 6-7", "(a b; 0 a) = a 1 + b eps, a number a + eps b", "a 1 + b (0 1; 0 0)", 2.3 * np.eye(2) - 1.7 * EPS, matrix(a), note="the matrix above eq 6 reads (a b; a a)"),
        Row("sec. 2, a", "eps is nilpotent", "eps^2 = 0", EPS @ EPS, matrix(Dual(0.0, 1.0) * Dual(0.0, 1.0))),
        Row("sec. 2, b", "eps turns j by ninety degrees", "eps (1, 0) = i", np.array([1.0, 0.0]), EPS @ [1.0, 0.0], CANNOT, np.zeros(2), note="(0 1; 0 0)(1, 0) = 0; eps takes j = (0, 1) to i and i to 0: of rank one, no rotation"),
        Row("sec. 2, 3D", "eps = E13 extends eq 7 to three dimensions", "E13 as eps", None, "E13^2 = 0, so that a 1 + b E13 multiplies as dual numbers do; it takes k to i and i, j to 0, and carries no geometry of lines", PART),
        Row("eq 8", "the dual number", "a + eps b", matrix(a), 2.3 * np.eye(2) - 1.7 * EPS),
        Row("eq 9", "sum", "(a + b) + eps (a0 + b0)", Dual(2.3 + 0.8, -1.7 + 0.6), number(matrix(a) + matrix(b)), right=a + b),
        Row("eq 10", "product", "a b + eps (a b0 + a0 b)", Dual(2.3 * 0.8, 2.3 * 0.6 - 1.7 * 0.8), number(matrix(a) @ matrix(b)), right=a * b),
        Row("eq 11", "quotient", "a / b + eps (a0 b - a b0) / b^2", Dual(2.3 / 0.8, (-1.7 * 0.8 - 2.3 * 0.6) / 0.64), a / b, right=number(matrix(a) @ np.linalg.inv(matrix(b)))),
        Row("eq 11, middle", "the factor that makes the denominator real", "b + eps b0", b * b, b * b.dual_conjugate, CANNOT, Dual(0.64, 0.0), note="(b + eps b0)^2 keeps an eps part; b - eps b0 does it, and the result printed is right"),
        Row("eq 12", "power, n = 3", "a^n + eps n a0 a^(n-1)", Dual(2.3**3, 3 * -1.7 * 2.3**2), a**3, right=number(matrix(a) @ matrix(a) @ matrix(a))),
        Row("eq 13", "square root, eps part", "a0 / (a sqrt a)", Dual(np.sqrt(2.3), -1.7 / (2.3 * np.sqrt(2.3))), np.sqrt(a), CANNOT, root, note="its square is not a; Table 1 has a0 / (2 sqrt a), which is right"),
        Row("eq 14", "a function of a dual number has two real parts", "F = f(x, x0) + eps g(x, x0)", Dual(np.sin(2.3), -1.7 * np.cos(2.3)), np.sin(a)),
        Row("eq 15", "analytic: df/dx0 = 0, df/dx = dg/dx0, for sin", "0; cos x", np.array([0.0, np.cos(2.3)]), np.array([_by_parts(0, 1), _by_parts(1, 1)]), right=np.array([0.0, _by_parts(0, 0)]), note="tested on any function in examples/dual_numbers.py"),
        Row("eq 16", "Taylor's series ends after one term", "f(x) + eps x0 f'(x)", Dual(np.exp(2.3), -1.7 * np.exp(2.3)), np.exp(a)),
        Row("eq 17", "the dual angle of two lines: angle and distance", "theta + eps S", Dual(0.4, 3.0), dp.algebra.dual_angle(dp.algebra.line([0, 0, 0], [1, 0, 0]), dp.algebra.line([0, 0, 3.0], [np.cos(0.4), np.sin(0.4), 0]))),
        Row("Table 1", "sum, product, power, root, quotient, function", "as eqs 9-12, 16; root a0 / (2 sqrt a)", Dual(np.sqrt(2.3), -1.7 / (2 * np.sqrt(2.3))), np.sqrt(a), right=root),
        *vectors(),
    ]


def _by_parts(part: int, variable: int) -> float:
    """d f / d (x, x0)[variable] of sin's part f or g, by a complex step through the dual function."""
    x = [2.3 + 0j, -1.7 + 0j]
    x[variable] += 1j * H
    y = np.sin(Dual(np.array(x[0]), np.array(x[1])))
    return float((np.asarray(y.real), np.asarray(y.dual))[part].imag / H)


def vectors() -> list[Row]:
    r, w = np.array([0.3, -1.0, 2.0]), np.array([1.0, 0.5, -0.2])
    line = dp.algebra.line(r, w)
    t = Dual(0.7, 1.5)
    c, s = np.cos(t), np.sin(t)
    al = dp.algebra
    one, o = Dual(1.0, 0.0), Dual(0.0, 0.0)

    def rows(*entries: Dual) -> Dual:
        return np.stack([np.stack(entries[i : i + 3]) for i in (0, 3, 6)])

    A, B = al.line([0, 0, 0.0], [1, 0, 0]), al.line([0, 0, 3.0], [0.6, 0.8, 0])
    angle = al.dual_angle(A, B)
    X = Dual(np.arange(9.0).reshape(3, 3) + 4 * np.eye(3), np.ones((3, 3)))
    Y = Dual(np.eye(3) * 2, np.arange(9.0).reshape(3, 3))
    inv = np.linalg.inv(X.real)
    return [
        Row("sec. 2.2", "a dual vector is bound to its line: the moment r x V is the same for every point r", "V + eps r x V", Dual(w, np.cross(r + 2.5 * w, w)), line.vector * Dual(np.linalg.norm(w), 0.0)),
        Row("sec. 2.2, 1-3", "velocity, linear momentum, force as dual vectors", "omega + eps v; p + eps r x p; F + eps r x F", Dual(w, np.cross(r, w)), dp.spatial.transform_lines(dp.spatial.exp([0, 0, 0, *r]), Dual(w, np.zeros(3)))),
        Row("sec. 2.2, 4", "angular momentum L + eps r x L", "L + eps r x L", None, "an angular momentum is a free vector: the motor of a momentum is p + eps H, as their own sec. 5.1 has it", FAILS),
        Row("Rx, Ry, Rz", "dual rotations about and along the axes", "cos, -sin; sin, cos of the dual angle", rows(one, o, o, o, c, -s, o, s, c), al.screw_matrix([1, 0, 0, 0, 0, 0], t)),
        Row("Rx, Ry, Rz", "about y", "cos, sin; -sin, cos", rows(c, o, s, o, one, o, -s, o, c), al.screw_matrix([0, 1, 0, 0, 0, 0], t)),
        Row("Rx, Ry, Rz", "about z", "cos, -sin; sin, cos", rows(c, -s, o, s, c, o, o, o, one), al.screw_matrix([0, 0, 1, 0, 0, 0], t)),
        Row("sec. 2.3", "A.B = a b cos, A x B = a b sin S of the dual angle", "cos theta; sin theta", np.stack([np.cos(angle), np.sin(angle)]), np.stack([A.dot(B), (A.cross(B)).dot(al.common_perpendicular(A, B)[0])])),
        Row("sec. 2.3", "product of dual matrices", "A B + eps (A B0 + A0 B)", Dual(X.real @ Y.real, X.real @ Y.dual + X.dual @ Y.real), X @ Y),
        Row("sec. 2.3", "inverse of a dual matrix", "A^-1 - eps A^-1 A0 A^-1", Dual(inv, -inv @ X.dual @ inv), al.inv(X)),
    ]


def dh(t: float, d: float, a: float, alpha: float) -> np.ndarray:
    """The homogeneous matrix written out: an independent derivation."""
    c, s, ca, sa = np.cos(t), np.sin(t), np.cos(alpha), np.sin(alpha)
    return np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1.0]])


def pose(t1: float, t2: float = T2) -> np.ndarray:
    return dh(t1, D1, L1, np.pi / 2) @ dh(t2, D2, L2, 0.0)


def arm() -> list[Row]:
    c1, s1, c2, s2 = np.cos(T1), np.sin(T1), np.cos(T2), np.sin(T2)
    ours = ARM.chain.pose(ARM.dual_coordinates(Q))
    T = pose(T1)
    p = T[:3, 3]
    D = np.cross(p, T[:3, :3].T).T
    printed = np.array([
        [L1 * s1 * s2 - D1 * s1 * c2 - D2 * c1 * s2, L2 * s1 + L1 * s1 * c2 - D2 * c1 * c2 + D1 * s1 * s2, c1 * (D1 + L2 * s2)],
        [L1 * c1 * s2 + D1 * c1 * c2 - D2 * s1 * s2, L2 * c1 - L1 * c1 * c2 - D1 * c1 * s2 - D2 * s1 * c2, s1 * (D1 + L2 * s2)],
        [D2 * c2, -D2 * s2, -L2 * c2 - L1],
    ])  # fmt: skip
    real = np.array([[c1 * c2, -c1 * s2, s1], [s1 * c2, -s1 * s2, -c1], [s2, c2, 0]])
    th, al = Dual(T1, D1), Dual(np.pi / 2, L1)
    c, s, ca, sa = np.cos(th), np.sin(th), np.cos(al), np.sin(al)
    step = np.stack(
        [np.stack([c, -ca * s, sa * s]), np.stack([s, ca * c, -sa * c]), np.stack([Dual(0.0, 0.0), sa, ca])]
    )
    others = tuple(np.transpose([(i, j) for i in range(3) for j in range(3) if (i, j) not in {(1, 0), (1, 1)}]))
    found = ARM.inverse_kinematics(T)
    second = pose(2.5)
    chain = ARM.chain.matrices(ARM.dual_coordinates(Q))
    n, o, a = T[:3, :3].T
    columns = np.stack(
        [
            np.array([-p[2] * x[1] + p[1] * x[2], p[2] * x[0] - p[0] * x[2], -p[1] * x[0] + p[0] * x[1]])
            for x in (n, o, a)
        ],
        axis=1,
    )
    return [
        Row("sec. 3", "frame i + 1 on the distal end of link i; i_{i+1} perpendicular to k_i and k_{i+1}", "three bullets, and Fig 5", dp.fk(ARM.robot, Q, "link1_end"), dh(T1, D1, L1, np.pi / 2), CONVENTION, note="the text numbers the distal frame i + 1, eq 18 numbers it i; the third bullet should name j_{i+1}"),
        Row("eq 18", "one step, Rz(theta) Rx(alpha) in dual angles", "rows (c, -ca s, sa s), (s, ca c, -sa c), (0, sa, ca)", step, chain[0], CONVENTION, note="of frame i in i - 1, with frame i at the distal end of link i"),
        Row("eq 19", "open chain: the product of all steps", "0M_n = product of M_i", chain[0] @ chain[1], ours),
        Row("after eq 19", "0M_n = T + eps D with D = [p] T", "T + eps D", columns, ours.dual, right=D),
        Row("Table 2", "rows of the arm: alpha = 90, 0 degrees; l1, l2 in symbols", "l1, l2", Dual(real, D), ours, ASSUMING, note="l1 = 100.5, l2 = 70, which the printed matrix implies (in mm); exchanged, six entries fail"),
        Row("sec. 6", "0M2, primary part", "nine entries of c1, s1, c2, s2", real, ours.real),
        Row("sec. 6", "0M2, eps part, entry (2,1)", "100.5 c1 s2 + d1 c1 c2 - d2 s1 s2", printed[1, 0], ours.dual[1, 0], CANNOT, D[1, 0], note="off by 201 c1 s2: the first sign is minus"),
        Row("sec. 6", "0M2, eps part, entry (2,2)", "70 c1 - 100.5 c1 c2 - d1 c1 s2 - d2 s1 c2", printed[1, 1], ours.dual[1, 1], CANNOT, D[1, 1], note="off by 140 c1: the first sign is minus"),
        Row("sec. 6", "0M2, eps part, the other seven entries", "as printed", printed[others], ours.dual[others], right=D[others]),
        Row("sec. 6, inverse", "theta2, at theta2 = 1", "atan(+-sqrt(1 - o_z^2) / o_z^2)", np.arctan(np.sqrt(1 - T[2, 1] ** 2) / T[2, 1] ** 2), found[2], CANNOT, np.arctan2(T[2, 0], T[2, 1]), note="1.2368: the denominator is o_z, not its square"),
        Row("sec. 6, inverse", "theta1, at theta1 = 2.5", "atan(n_y / n_x)", np.arctan(second[1, 0] / second[0, 0]), ARM.inverse_kinematics(second)[0], CANNOT, 2.5, note="the quotient loses the quadrant; atan2(a_x, -a_y) keeps it, also where c2 = 0"),
        Row("sec. 6, inverse", "d1, d2 from the eps part", "", None, found[[1, 3]], MEASURED, right=np.array([D1, D2])),
    ]


def velocities() -> list[Row]:
    v = np.array([0.4, 3.0, -0.9, -2.0])
    w1, v1, w2, v2 = v
    V = ARM.chain.velocities(ARM.dual_coordinates(Q), ARM.dual_coordinates(v))
    got = [Dual(np.array([float(x.real) for x in X]), np.array([float(x.dual) for x in X])) for X in V]
    c2, s2 = np.cos(T2), np.sin(T2)
    whole = Dual(
        [w1 * s2, w1 * c2, w2], [v1 * s2 + D2 * w1 * c2, v1 * c2 - D2 * w1 * s2 + L2 * w2, v2 - w1 * (L1 + L2 * c2)]
    )
    first = Dual([0.0, w1, 0.0], [0.0, v1, -L1 * w1])
    base = ARM.chain.velocity(ARM.dual_coordinates(Q), ARM.dual_coordinates(v))
    twist = dp.frame_velocity(ARM.robot, Q, v, "tip", reference="local_world_aligned")
    R = pose(T1)[:3, :3]
    J = ARM.chain.generalized_jacobian(ARM.dual_coordinates(Q))
    stacked = Dual(np.array([0, 0, w1, 0, 0, w2]), np.array([0, 0, v1, 0, 0, v2]))
    F = Dual(np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.2, -0.4]))
    T, p = pose(T1), pose(T1)[:3, 3]
    return [
        Row("eq 20", "a velocity in other axes", "Q V = T V", Dual(R @ whole.real, R @ whole.dual), Dual(base.real, base.dual)),
        Row("eq 21", "velocities relative to each other add", "V_ki = V_ji + V_kj", ARM.chain.matrices(ARM.dual_coordinates(Q))[1].T @ got[0] + ARM.chain.matrices(ARM.dual_coordinates(Q))[1].T @ Dual(np.array([0, 0, w2]), np.array([0, 0, v2])), got[1], right=whole),
        Row("eq 22", "velocity of the end in base axes", "T sum of nM_{i-1} V_i", np.concatenate((base.real, base.dual)), twist, note="dualpin: DualChain.velocity"),
        Row("eq 23", "the generalised dual Jacobian, blocks nM_0 ... nM_{n-1}", "[nM_0 ... nM_{n-1}]", J @ stacked, got[1], right=whole, note="dualpin: DualChain.generalized_jacobian; the fractions in the stacked vector are a reading of its dividing lines"),
        Row("sec. 6", "velocity of link 1 in its own frame", "(0, sin a1 (w1 + eps v1), cos a1 (w1 + eps v1)), dual a1", first, got[0]),
        Row("sec. 6", "velocity of link 2 in its own frame", "(0, sin a2 (w2 + eps v2), cos a2 (w2 + eps v2)), dual a2", Dual([0.0, 0.0, w2], [0.0, L2 * w2, v2]), got[1], CANNOT, whole, note="that is its velocity relative to link 1; what link 1 does is left out"),
        Row("eq 24", "force and moment as one dual vector", "F + eps tau", Dual(R @ F.real, R @ F.dual + np.cross(p, R @ F.real)), dp.spatial.transform_lines(T, F)),
        Row("eq 25", "its effect at another point", "T F + eps T tau", Dual(R @ F.real, R @ F.dual), ARM.chain.pose(ARM.dual_coordinates(Q)) @ F, CANNOT, Dual(R @ F.real, R @ F.dual + np.cross(p, R @ F.real)), note="turning keeps the reference point; eq 28 uses the dual matrix, which is right"),
    ]


def dynamics() -> list[Row]:
    """The recursion of dual momenta against the Lagrangian (dp.rnea is checked against Pinocchio)."""
    rng = np.random.default_rng(0)
    given = []
    for m in (1.3, 0.9):
        X = rng.standard_normal((3, 3))
        given.append((m, 0.05 * rng.standard_normal(3), 0.002 * (X @ X.T + np.eye(3))))
    bodies = [dp.mechanisms.body(*g) for g in given]
    heavy = dp.mechanisms.TwoC(0.1005, 0.07, bodies=bodies)
    q, v, a = rng.standard_normal((3, 4))
    M, C, g = dp.crba(heavy.robot, q), dp.coriolis(heavy.robot, q, v), dp.gravity(heavy.robot, q)
    state = [heavy.dual_coordinates(x) for x in (q, v, a)]
    F, W = heavy.chain.forces(*state), heavy.chain.joint_wrenches(*state)
    own = np.stack([F.dual, F.real], -1).ravel()
    # momenta of link 2 about its frame's origin, from mass, centre, inertia
    m, c, J = given[1]
    w = dp.frame_velocity(heavy.robot, q, v, "tip", reference="local")
    S = m * np.cross(c, np.eye(3)).T  # m [c]
    about = J + m * (c @ c * np.eye(3) - np.outer(c, c))
    P, L = m * w[3:] - S @ w[:3], S @ w[3:] + about @ w[:3]
    from dualpin.spatial import Vector3, motor

    twist = motor(Vector3(*w[:3]), Vector3(*w[3:]))
    h = bodies[1](twist)
    momentum = Dual(np.array([float(x) for x in h.real]), np.array([float(x) for x in h.dual]))
    f = twist.cross(h)
    cross = Dual(np.array([float(x) for x in f.real]), np.array([float(x) for x in f.dual]))
    Hi, Hj, Hk = momentum
    Vi, Vj, Vk = Dual(w[:3], w[3:])
    six = np.stack([-Vk * Hj + Vj * Hk, -Vi * Hk + Vk * Hi, -Vj * Hi + Vi * Hj])
    M2 = heavy.chain.matrices(state[0])[1]
    inward = M2 @ (M2.T @ np.stack([Dual(*x) for x in zip(W.real[1], W.dual[1], strict=True)]))
    rows = [
        Row("eq 26", "linear and angular momentum of a body, S = m [c], J about the frame's origin", "P = m V - S w; H = S V + J w", Dual(P, L), momentum, note="dualpin: an Inertia called with a twist"),
        Row("eq 27", "inertial force: the derivative of the dual momentum; V x H in components", "dH/dt + V x H, six lines", six, cross),
        Row("sec. 5.1", "an acceleration is a pseudo vector, no dual vector", "", None, "the derivative of a velocity motor is a motor (spatial acceleration); the momentum route is a choice", FAILS),
        Row("eq 28", "equilibrium: M F_i - F_{i-1} = f, all six components of each joint", "BM_A F_A - F_B = f_A", Dual(W.real[..., 2], W.dual[..., 2]), F, right=Dual((M @ a + C @ v + g)[1::2], (M @ a + C @ v + g)[0::2]), note="dualpin: DualChain.joint_wrenches, z components = DualChain.forces"),
        Row("sec. 6.1", "the recursion: 1F = 1M2 2f, 0F = 0M1 (1F + 1f), and its split into real parts", "[2M1]^-1 f ...", inward, np.stack([Dual(*x) for x in zip(W.real[1], W.dual[1], strict=True)]), CONVENTION, note="its left sides are in frame i - 1"),
        Row("sec. 6.1", "torque and force of both joints against M a + C v + g", "", None, own, MEASURED, right=M @ a + C @ v + g),
        Row("secs. 5, 6", "gravity", "", None, "not in the equations; here the base accelerates upwards, which is the same", MEASURED),
        Row("conclusions", "a 6 x n vector of forces describes the manipulator", "6 x n", None, "DualChain.joint_wrenches: force + eps moment of every joint, three components each; dp.joint_wrenches for any robot", MEASURED),
        Row("conclusions", "a zero dual part of theta makes a joint revolute, a zero primary part prismatic", "zero", None, "the part must be constant, not zero: offsets and fixed angles may have any value", PART),
        Row("sec. 5", "homogeneous matrices need to be told whether a joint turns or slides, dual ones do not", "", None, "a dual angle holds both, so no case is needed; a homogeneous matrix with theta and d as variables holds both too", PART),
        Row("conclusions", "one program solves a great variety of topologies", "nine", None, "mechanisms.TwoC and DualChain: one recursion for all nine, each checked in the row of Fig 10", MEASURED),
    ]
    worst = 0.0
    for name in dp.mechanisms.TOPOLOGIES:
        t = heavy.topology(name, q)
        i = t.free
        held = t.spread(v[i])
        tau = M[np.ix_(i, i)] @ a[i] + (dp.coriolis(heavy.robot, q, held) @ held + g)[i]
        worst = max(
            worst,
            float(np.abs(t.rnea(q[i], v[i], a[i]) - tau).max()),
            float(np.abs(t.aba(q[i], v[i], tau) - a[i]).max()),
        )
    rows.append(
        Row("Fig 10", "nine topologies: inverse and forward dynamics of each, worst difference", "", None, f"{worst:.1e}" if worst < 1e-11 else "OPEN", MEASURED, note="dualpin: TwoC.topology('RP') ...")
    )
    return rows


def others() -> list[Row]:
    return [
        Row("sec. 1", "dual numbers: Clifford, 1893", "1893", None, "1873 (Clifford, Preliminary sketch of biquaternions)", FAILS),
        Row("sec. 1.1", "SCARA and dual Euler angles, cited", "", None, "no equations are printed; a SCARA is dp.from_dh(rows, 'RRPR'), dual Euler angles are products of dual rotations (dp.algebra.screw_matrix)", MEASURED),
        Row("Figs 1-8", "sketches: oblique plane, dual angle, dual vector, rotations, DH parameters, velocities, chain, screwdriver", "", None, "", OUTSIDE, note="sketches of definitions, without data"),
        Row("Fig 9", "frames of the 2C arm", "", None, "figures/two_c_arm.svg", DRAWN),
        Row("Fig 10", "topologies, and where the tip of each can be", "", None, "figures/two_c_workspace.svg", DRAWN),
    ]


def page() -> Page:
    return Page(
        "tapia_herrera",
        "Dual numbers and the 2C arm",
        "R. Tapia Herrera, S. M. Alcantara, J. A. Meda-Campana, A. S. Velazquez: Kinematic and dynamic modelling of serial "
        "robotic manipulators using dual number algebra. In: Serial and Parallel Robot Manipulators, InTech 2012.",
        "Dual numbers, the arm with two cylindrical joints and its nine topologies, and the recursion of dual momenta. Lengths "
        "in mm where the paper has them so. Docs: [The five papers: 2C arm](../../docs/papers/tapia_herrera.md).",
        [*numbers(), *arm(), *velocities(), *dynamics(), *others()],
        {
            "two_c_arm.svg": "The arm with two cylindrical joints (l1 = 100.5, l2 = 70 mm, theta1 = 30 deg, d1 = 60, theta2 = 40 deg, d2 = 50): its frames, computed (Fig 9).",
            "two_c_workspace.svg": "Where the tip of six of the nine topologies can be, the held coordinates as in the picture above (Fig 10).",
        },
        "the sketches Figs 1-8, which carry no data.",
    )
