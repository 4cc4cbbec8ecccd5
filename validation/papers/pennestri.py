"""Pennestri and Stefanelli (2007): linear algebra and numerical algorithms using dual numbers."""

# ruff: noqa: E501  (rows of a table, one a line)
# fmt: off

from __future__ import annotations

from typing import Any

import numpy as np

import dualpin as dp
from dualpin import Dual
from dualpin import dual as functions

from .common import CANNOT, CONVENTION, DRAWN, FAILS, MEASURED, OUTSIDE, PART, Page, Row, gold, golden, numbers
from .pennestri_linkage import linkage, operations, times

al = dp.algebra
GOLD = golden()
THREE = 5.1e-4  # half a unit of three decimals
CUT = 1.01e-3 / 8.85  # a unit of them, relative to R's largest number: the paper cuts 3.4785 and 0.94868


def three(real: Any, dual: Any) -> Dual:
    return Dual(np.array(real, dtype=float), np.array(dual, dtype=float))


def motors() -> list[Row]:
    M = al.Motor([1.0, -2.0, 2.0], [0.5, 1.0, 3.0])
    line, shift = al.line([1.0, 2, 3], [0, 0.6, 0.8]), np.array([0.3, -1.0, 2.0])
    a, u = M.magnitude, M.axis
    couple = al.Motor([0.0, 0, 0], [1.0, 2, 3])
    return [
        Row("eq 1", "a dual number", "a + eps a'", Dual(2.0, 3.0), 2.0 + 3.0 * dp.dual.EPS),
        Row("eq 2", "a line: direction and moment, W.V = 0", "W + eps OP x W", Dual(np.array([0, 0.6, 0.8]), np.cross([1.0, 2, 3], [0, 0.6, 0.8])), line.vector, note="dualpin: algebra.line(point, direction)"),
        Row("sec. 3", "a motor's moment about another origin", "V_P = V + PO x W", M.dual + np.cross(-shift, M.real), dp.spatial.transform_lines(dp.spatial.exp([0, 0, 0, *-shift]), M.vector).dual),
        Row("eqs 3-4", "a motor is a dual multiple of a unit line", "(a + eps a') (U + eps U')", M.vector, u.vector * a),
        Row("eq 5", "magnitude", "a = M^T M", 9.0, a.real, CANNOT, 3.0, note="M = a U gives a^2; perhaps a lost exponent"),
        Row("eq 5", "product of its parts", "a a' = M^T M'", M.real @ M.dual, a.real * a.dual),
        Row("eq 6", "pitch", "M^T M' / M^T M", 4.5 / 9, M.pitch, right=0.5),
        Row("Table 1", "screw, line, zero", "by M and M.M'", "screw, line, zero", ", ".join((M.kind.item(), line.kind.item(), al.Motor([0.0] * 3, [0.0] * 3).kind.item())), note="dualpin: algebra.classify"),
        Row("Table 1", "couple: M = 0, M.M' = 0, the same two conditions as zero", "zero", "zero", couple.kind.item(), CANNOT, "couple", note="its last column, a' not 0, tells them apart: M' is not 0"),
        Row("sec. 4", "polar and exponential form", "rho (1 + eps t) = rho e^(eps t)", Dual(2.0, 3.0), Dual.from_polar(2.0, 1.5), note="f'{x:polar}'"),
    ]


def calculus() -> list[Row]:
    x, h = Dual(0.75, -1.25), 1e-30
    sine = Dual(np.sin(0.75), np.sin(0.75 - 1.25j * h).imag / h)
    cosine = Dual(np.cos(0.75), np.cos(0.75 - 1.25j * h).imag / h)
    a, b = Dual(2.3, -1.7), Dual(0.8, 0.6)
    A, B = al.Motor([1.0, -2.0, 2.0], [0.5, 1.0, 3.0]), al.Motor([0.3, 0.1, -1.0], [1.0, 2.0, 0.2])
    inverse = np.stack([f(Dual(0.4, 1.5)) for f in (np.arcsin, np.arccos, np.arctan)])
    return [
        Row("eq 7", "the test of an analytic function, for sin", "df/dx' = 0, df/dx = dg/dx'", Dual(0.0, np.cos(0.75)), Dual((np.sin(Dual(0.75, -1.25)) - np.sin(Dual(0.75, 0.0))).real, (np.sin(Dual(0.75, -0.25)) - np.sin(x)).dual)),
        Row("eq 8", "f of a dual number, f = sin", "f(x) + x' f'(x)", Dual(sine.real + sine.dual, 0.0), np.sin(x), CANNOT, sine, note="without eps before x'; perhaps a lost symbol"),
        Row("eq 8", "follows from eq 7", "", None, "eq 7 also admits an extra eps h(x); eq 8 is the natural extension of a real function", PART),
        Row("Table 2", "sum, product, quotient", "(a + b) + eps ..., a b + eps ..., a / b + eps (a' b - a b') / b^2", np.stack([Dual(3.1, -1.1), Dual(1.84, 0.02), Dual(2.875, -4.28125)]), np.stack([a + b, a * b, a / b])),
        Row("Table 2", "vector scaling, dot product", "A.B + eps (A.B' + A'.B)", Dual(A.real @ B.real, A.real @ B.dual + A.dual @ B.real), A.dot(B)),
        Row("Table 2", "cross product, eps part", "A^T B' + A'^T B", A.real @ B.dual + A.dual @ B.real, A.cross(B).dual, CANNOT, np.cross(A.real, B.dual) + np.cross(A.dual, B.real), note="a scalar; its count, 18 products, is that of two cross products"),
        Row("Table 2", "dual sin", "sin + eps d cos", Dual(np.sin(0.75), -1.25 * np.cos(0.75)), np.sin(x), right=sine),
        Row("Table 2", "dual cos", "repeats the line of the sine", sine, np.cos(x), CANNOT, cosine, note="cos - eps d sin"),
        Row("Table 2", "dual tan, printed twice", "tan + eps d / cos^2", Dual(np.tan(0.75), -1.25 / np.cos(0.75) ** 2), np.tan(x)),
        Row("Table 2", "dual asin, acos, atan of 0.4 + 1.5 eps", "asin + eps d / sqrt(1 - a^2), ...", three([np.arcsin(0.4), np.arccos(0.4), np.arctan(0.4)], [1.5 / np.sqrt(0.84), -1.5 / np.sqrt(0.84), 1.5 / 1.16]), inverse),
        Row("Table 2", "numbers of operations", "three columns", None, "counted by running: see the table below", MEASURED),
    ]


def lines() -> list[Row]:
    l1, l2 = al.line([0, 0, 1.0], [1, 0, 0]), al.line([0, 0, 1.0], [1, 1, 0])  # they meet
    p1, p2 = al.line([0, 0, 0.0], [1, 0, 0]), al.line([0, 3.0, 0], [1, 0, 0])  # parallel, 3 apart
    z, x5 = al.line([0, 0, 0], [0, 0, 1]), al.line([0, 1, 5], [1, 0, 0])
    normal, _, _ = al.common_perpendicular(l1, l2)
    r1, a = np.array([1.0, 2, 3]), np.array([1.0, 1, 2])
    r2, b = np.array([-1.0, 0, 2]), np.array([0.0, 3, 1])
    by_definition = np.cross(a, np.cross(r2, b)) + np.cross(np.cross(r1, a), b)
    A, B = al.Motor(a, np.cross(r1, a)), al.Motor(b, np.cross(r2, b))
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    theta = al.dual_angle(al.line(r1, a), al.line(r2, b))
    star, _, _ = al.common_perpendicular(al.line(r1, a), al.line(r2, b))
    pair = GOLD["line_pairs"][0]
    u = [al.line(*(np.array(numbers(pair[k][n])) for n in ("point", "direction"))) for k in ("line1", "line2")]
    E3, g1, g2 = al.common_perpendicular(*u)
    E = [gold(pair[k]) for k in ("E1", "E2")]
    q = [np.cross(e.real, np.cross(p.point, e.real)) for e, p in zip(E, u, strict=True)]
    case = GOLD["motor_sum"][0]
    s = al.screw_sum(gold(case["A1"]), gold(case["A2"]))
    return [
        Row("eq 9", "dot product: a b cos of the dual angle", "a b (cos - eps s sin)", size * np.cos(theta), A.dot(B)),
        Row("eq 10", "cross product, by definition", "a x b + eps (a x (r2 x b) + (r1 x a) x b)", Dual(np.cross(a, b), by_definition), A.cross(B).vector),
        Row("eq 10, 2nd line", "its eps part", "(a.b) (r2 - r1) + r1 x (a x b)", np.dot(a, b) * (r2 - r1) + np.cross(r1, np.cross(a, b)), A.cross(B).dual, CANNOT, by_definition, note="holds where r2 - r1 is perpendicular to both lines, r1 and r2 being the feet of the common normal, which the text does not say"),
        Row("eq 11", "a b S* sin of the dual angle", "a b S* sin theta", star.vector * (size * np.sin(theta)), A.cross(B).vector),
        Row("Table 3", "skew, coaxial lines", "a b cos theta; a b", np.stack([size * np.cos(theta), Dual(A.real @ A.real, 0.0)]), np.stack([A.dot(B), A.dot(A)])),
        Row("Table 3", "lines that meet", "A x B = a b S*", normal.vector, l1.cross(l2).vector, CANNOT, normal.vector * np.sin(np.pi / 4), note="sin theta is missing, which eq 11 has"),
        Row("Table 3", "parallel lines", "A x B = eps a b s*", Dual(np.zeros(3), np.array([0, 1.0, 0])), p1.cross(p2).vector, CANNOT, Dual(np.zeros(3), np.array([0, 3.0, 0])), note="the distance s is missing, which eq 11 has"),
        Row("eqs 12-15", "dual angle: unit lines, common normal, cos, sin, atan2", "theta + eps h", gold(pair["dual_angle"]), al.dual_angle(*u), note="dualpin: algebra.dual_angle, parallel lines too"),
        Row("eqs 16-18", "distance h_i, unit lines, common perpendicular", "E1 x E2 / |E1 x E2|", gold(pair["E3"]), E3.vector),
        Row("eqs 19-20", "nearest points q_i to the origin", "u x (s x u) = s - (u.s) u", np.stack(q), np.stack([x.point for x in u])),
        Row("eqs 21-23", "angles to the normals, distances, feet p_i = q_i + h_i u_i", "P1, P2", np.array(numbers([pair["P1"], pair["P2"]])), np.stack([g1, g2]), note="dualpin: algebra.common_perpendicular"),
        Row("sec. 7.3, step 6", "a line through the origin", "h = 0", np.zeros(3), al.common_perpendicular(z, x5)[1], CANNOT, np.array([0.0, 0, 5]), note="z axis and a line through (0, 1, 5): the foot is (0, 0, 5); any normal through the origin serves as Q"),
        Row("eq 24", "sum of two line vectors; example: dual angle", "pi/2 - eps", Dual(np.pi / 2, -1.0), s.theta, note="dualpin: algebra.screw_sum"),
        Row("sec. 7.4, example", "common perpendicular E12", "(-1, 0, 0)", np.array([-1.0, 0, 0]), s.perpendicular.real),
        Row("sec. 7.4, example", "alpha1", "pi/4 - eps/2", Dual(np.pi / 4, -0.5), s.alpha1, right=gold(case["alpha1"])),
        Row("eq 25", "the rotation by T = E12 tan(alpha1 / 2); example: the sum", "(0, 1, 1 + eps)", three([0, 1, 1], [0, 0, 1]), s.sum.vector, right=gold(case["A1"]) + gold(case["A2"]), note="a motor of pitch 1/2, not a line"),
        Row("sec. 7.4", "the sums form a cylindroid", "", None, "algebra.cylindroid(a, b); figures/cylindroid.svg", MEASURED),
    ]


def matrices() -> list[Row]:
    qr = GOLD["qr"][0]
    Aq = gold(qr["A"])
    Q, R = al.qr(Aq)
    A1, A2 = (gold(c["A"]) for c in GOLD["pinv"])
    right1, right2 = (gold(c["pinv"]) for c in GOLD["pinv"])
    printed1 = three(
        [[-0.051, -0.069, 0.418], [0.028, 0.073, -0.170]], [[0.064, 0.082, -0.533], [-0.025, -0.038, 0.199]]
    )
    printed2 = three(
        [[-0.035, 0.021], [-0.038, 0.044], [0.287, -0.038]], [[-0.014, 0.000], [-0.035, -0.001], [-0.007, -0.011]]
    )
    given, other = (gold(c["A"]) for c in GOLD["svd"])
    U, S, Vh = al.svd(given)
    U2, S2, Vh2 = al.svd(other)
    order = [1, 0]
    U_p = three([[-0.690, 0.283], [0.721, 0.187], [0.064, 0.941]], [[-1.128, 0.288], [-1.148, -0.008], [0.791, -0.085]])
    V_p = three([[0.805, 0.593], [-0.593, 0.805]], [[-0.050, 0.068], [-0.068, -0.050]])
    X = Dual(Aq.real, Aq.dual)
    b = Dual(np.array([1.0, -2.0]), np.array([0.5, 3.0]))
    inv = np.linalg.inv(X.real)
    x = np.linalg.solve(X.real, b.real)
    dx = np.linalg.solve(X.real, b.dual - X.dual @ x)
    alpha, theta = Dual(0.5, 2.0), Dual(0.8, -1.0)
    c, s = np.cos(alpha), np.sin(alpha)
    one, zero = Dual(1.0, 0.0), Dual(0.0, 0.0)
    link = np.stack([np.stack([one, zero, zero]), np.stack([zero, c, -s]), np.stack([zero, s, c])])
    shifted = np.stack([np.stack([zero, zero, one]), np.stack([c, -s, zero]), np.stack([s, c, zero])])
    joint = al.screw_matrix([0, 0, 1, 0, 0, 0], theta)
    eig = GOLD["eig"][0]
    w, V = al.eig(gold(eig["A"]))
    v0 = V[:, 0]
    bordered = np.block(
        [[gold(eig["A"]).real - w.real[0] * np.eye(2), -v0.real[:, None]], [v0.real[None], np.zeros((1, 1))]]
    )
    pair = np.linalg.solve(bordered, np.concatenate((-gold(eig["A"]).dual @ v0.real, [0])))
    ls = GOLD["lstsq"][0]
    G = A1 @ A1.T
    u0 = al.svd(A1)[0][:, 0]
    return [
        Row("eq 26", "product of dual matrices", "A B + eps (A B' + A' B)", Dual(Aq.real @ Aq.real, Aq.real @ Aq.dual + Aq.dual @ Aq.real), Aq @ Aq),
        Row("eqs 27-28", "inverse", "A^-1 - eps A^-1 A' A^-1", Dual(inv, -inv @ X.dual @ inv), al.inv(X)),
        Row("eqs 29-30", "linear equations, A factored once", "A x = b; A x' = b' - A' x", Dual(x, dx), al.solve(X, b)),
        Row("eq 31", "QR decomposition of the example: Q", "0.316 - 0.569 eps, 0.949 + 0.190 eps; 0.949 + 0.190 eps, -0.316 + 0.569 eps", three([[0.316, 0.949], [0.949, -0.316]], [[-0.569, 0.190], [0.190, 0.569]]), Q, digits=THREE, right=gold(qr["Q"])),
        Row("sec. 7.8, example", "R", "3.162 + 8.854 eps, 3.478 + 1.328 eps; 0, 0.948 + 4.617 eps", three([[3.162, 3.478], [0, 0.948]], [[8.854, 1.328], [0, 4.617]]), R, digits=CUT, right=gold(qr["R"]), note="3.478 and 0.948 are cut, not rounded (3.4785, 0.94868)"),
        Row("eq 32", "pseudo-inverse", "(A^T A)^-1 A^T", al.inv(A1.T @ A1) @ A1.T, al.pinv(A1), right=right1, digits=1e-11),
        Row("eq 33", "pseudo-inverse of any shape", "A+ - eps A+ A' A+", al.pinv_simple(A1), al.pinv(A1), CANNOT, right1, note="right for square A; for A1 the symmetry A A+ fails by 2.55. Two terms are missing: see algebra.pinv"),
        Row("sec. 7.9, example", "A1+, real parts", "-0.051, -0.069, 0.418; 0.028, 0.073, -0.170", printed1.real, al.pinv(A1).real, digits=THREE),
        Row("sec. 7.9, example", "A1+, eps parts", "0.064, 0.082, -0.533; -0.025, -0.038, 0.199", printed1.dual, al.pinv(A1).dual, CANNOT, right1.dual, digits=THREE, note="they are eq 33's, next row"),
        Row("sec. 7.9, example", "A1+ by eq 33", "as printed", printed1, al.pinv_simple(A1), digits=THREE),
        Row("sec. 7.9, example", "A2+, eps parts", "-0.014, 0.000; -0.035, -0.001; -0.007, -0.011", printed2.dual, al.pinv(A2).dual, CANNOT, right2.dual, digits=THREE, note="they are eq 33's, next row"),
        Row("sec. 7.9, example", "A2+ by eq 33; entry (1,1) reads -0.035 eps - 0.014", "as printed", printed2, al.pinv_simple(A2), digits=THREE, note="with eps moved: -0.035 - 0.014 eps"),
        Row("eqs 34-35", "eigenvalues and vectors: (A - lambda) v = 0, and the bordered system for v', lambda'", "eq 35b", np.array([*pair]), np.array([*v0.dual, w.dual[0]]), right=None, note="dualpin: algebra.eig"),
        Row("eqs 34-35", "eigenvalues of a 3 x 3 matrix that is not symmetric", "", None, al.eigvals(gold(GOLD["eig"][1]["A"])), MEASURED, functions.stack([gold(p["lam"]) for p in GOLD["eig"][1]["pairs"]])),
        Row("eq 35", "A and A' must not be singular", "nonsingular", None, "not needed; needed are simple eigenvalues and v^T v not 0. dualpin refuses repeated ones, and returns isotropic vectors with v^H v = 1", FAILS),
        Row("eq 36", "singular values: shapes of U, Lambda, V", "3 x 3, 3 x 3, 2 x 3", "3 x 3, 3 x 3, 2 x 3", f"{U.shape[0]} x {U.shape[1]}, {S.shape[0]} x {S.shape[0]}, {Vh.shape[0]} x {Vh.shape[1]}", CANNOT, "3 x 2, 2 x 2, 2 x 2", note="a zero column in U contradicts U^T U = 1; the thin factors are what the numbers are"),
        Row("eq 36", "U U^T = 1 for the 3 x 2 factor", "1", np.eye(3), (U @ U.T).real, CANNOT, U.real @ U.real.T, note="a projector of rank two"),
        Row("eq 37", "singular values ascend, the appended zero comes last", "0 <= lambda_1 <= ...: 1.411, 10.631", np.array([1.411, 10.631]), S2.real[order], CONVENTION, digits=THREE, note="dualpin's descend, as NumPy's; the zero should come first"),
        Row("eqs 38-39", "A A^T u = lambda^2 u; v = A^T u / lambda", "", al.svd(A1)[1][0] * al.svd(A1)[1][0] * u0, G @ u0, digits=1e-11),
        Row("sec. 7.11, example", "singular values of the matrix as printed", "1.411 + 1.191 eps, 10.631 + 5.204 eps", three([1.411, 10.631], [1.191, 5.204]), S[order], CANNOT, functions.stack([gold(x) for x in GOLD["svd"][0]["sigma"]])[order], digits=THREE, note="the printed factors multiply to a matrix with 3 + 5 eps in place of 2 + 5 eps: next rows"),
        Row("sec. 7.11, example", "singular values with (1,2) = 3 + 5 eps", "1.411 + 1.191 eps, 10.631 + 5.204 eps", three([1.411, 10.631], [1.191, 5.204]), S2[order], digits=THREE),
        Row("sec. 7.11, example", "V, and U, with that entry", "0.805 - 0.050 eps, ...; -0.690 - 1.128 eps, ...", V_p, _signed(Vh2.T[:, order], V_p), digits=THREE, note="signs of columns as printed"),
        Row("sec. 7.11, example", "U with that entry", "-0.690 - 1.128 eps, 0.283 + 0.288 eps, ...", U_p, _signed(U2[:, order], U_p), digits=THREE),
        Row("sec. 7.12", "least squares by singular values", "", None, al.lstsq(gold(ls["A"]), gold(ls["b"])), MEASURED, gold(ls["x"]), note="dualpin: algebra.lstsq"),
        Row("sec. 8", "principle of transference: Rodrigues' rotation by a dual angle about a line is the displacement", "a -> a + eps a'", al.homogeneous(al.screw_matrix(al.line([1, 0, 0], [0, 0, 1]), Dual(0.8, 2.0))), dp.spatial.to_matrix(dp.spatial.exp([0, 0, 0.8, 0, -0.8, 2.0]))),
        Row("eq 40", "one step of the chain", "Theta Lambda", joint @ link, functions.stack(dp.mechanisms.DualChain(Dual([0.5], [2.0])).matrices(Dual([0.8], [-1.0])))[0]),
        Row("eq 41", "Theta", "cos, -sin; sin, cos", np.stack([np.cos(theta), -np.sin(theta), np.sin(theta)]), np.stack([joint[0, 0], joint[0, 1], joint[1, 0]])),
        Row("eq 41", "Lambda", "(0 0 1; cos -sin 0; sin cos 0)", shifted, al.screw_matrix([1, 0, 0, 0, 0, 0], alpha), CANNOT, link, note="columns shifted round: listing 14.2 and eqs 64 have (1 0 0; 0 cos -sin; 0 sin cos)"),
    ]


def _signed(X: Dual, like: Dual) -> Dual:
    return X * np.sign((X.real * like.real).sum(axis=0))


def screws() -> list[Row]:
    theta, d = 1e-6, 0.7
    x = dp.spatial.exp([0, 0, theta, 0, 0, d])
    with np.errstate(all="ignore"):
        printed = float((2 * np.arccos(Dual(x[0], x[4]))).dual)
    case = GOLD["compose"][0]
    E = [gold(case[k]["axis"]) for k in ("first", "second")]
    t = [gold(case[k]["dual_angle"]) for k in ("first", "second")]
    T = [al.rodrigues(*pair) for pair in zip(E, t, strict=True)]
    A = al.screw_matrix(E[0], t[0])
    e = al.euler_parameters(A)
    cases = []
    for axis in np.vstack([np.eye(3), [[0.2, 0.3, 0.1]]]):  # each case of Table 4 is the best one for one of them
        half = dp.spatial.exp([*(axis * (3.0 if axis.max() == 1 else 1.0)), 0.1, 0.2, 0.3])
        cases.append(np.abs(al.euler_parameters(al.dual_matrix(dp.spatial.to_matrix(half))).real - half[:4]).max())
    first, second = (np.tan(float(a.real) / 2) * b.real for a, b in zip(t, E, strict=True))
    real = (first + second - np.cross(first, second)) / (1 - first @ second)
    body = al.screw_matrix(E[0], t[0]) @ al.screw_matrix(E[1], t[1])
    s = dp.spatial.screw_parameters(al.homogeneous(body))
    return [
        Row("eq 42", "the dual matrix of a finite screw", "a_ij", al.dual_matrix(al.homogeneous(A)), A),
        Row("eqs 43-46, Table 4", "dual Euler parameters, four sets of formulas", "largest of four", np.zeros(4), np.array(cases), note="dualpin: algebra.euler_parameters takes the set with the largest divisor"),
        Row("sec. 9.1", "angle and axis: 2 acos e0, e_i / sin(theta / 2)", "2 acos e0", t[0], 2 * np.arccos(e[0])),
        Row("sec. 9.1", "the same at an angle of 1e-6: distance", "2 acos e0", printed, dp.spatial.screw_parameters(x).distance, CONVENTION, d, digits=1e-4, note="a formula that is right and badly conditioned near 0: here off by 4e-5, at 1e-9 by all; dualpin uses atan2 and a branch for translations"),
        Row("eqs 47-49", "Rodrigues vectors of two rotations in turn", "(t1 + t2 - t1 x t2) / (1 - t1.t2)", real, al.compose_screws(*T).real, CONVENTION, note="both axes fixed in space, the first motion first"),
        Row("eqs 50-51", "the same over dual numbers: finite screws", "(T1 + T2 - T1 x T2) / (1 - T1.T2)", gold(case["T3"]), al.compose_screws(*T).vector, CONVENTION, note="axes carried with the body: plus, algebra.compose_screws(..., body=True)"),
        Row("eqs 50-51", "with axes that move with the body: the axis found", "", None, al.screw_of(al.compose_screws(*T, body=True))[1].vector, MEASURED, Dual(s.axis, s.moment)),
    ]


def nonlinear() -> list[Row]:
    rows = []
    poly = GOLD["polynomials"]
    for case in poly:
        want = [tuple(complex(*numbers(r[part])) for part in ("real", "dual")) for r in case["roots"]]
        want.sort(key=lambda r: (r[0].real, r[0].imag))
        c = Dual(numbers(case["coeff_real_ascending"]), numbers(case["coeff_dual_ascending"]))
        right = Dual(np.array([r[0] for r in want]), np.array([r[1] for r in want]))
        roots = al.polyroots(c).astype(complex)
        formula = -np.polyval(c.dual[::-1], roots.real) / np.polyval(np.polyder(c.real[::-1]), roots.real)
        rows.append(
            Row("eqs 52-55", f"polynomial {case['name']}: real parts, then x' = -sum c'_k x^k / sum k c_k x^(k-1)", "eqs 53, 54", Dual(roots.real, formula), roots, right=right, note="dualpin: algebra.polyroots")
        )
    run = al.newton(lambda y: y * y - Dual(2.0, 1.0), Dual(1.0, 0.0))
    two = al.newton(
        lambda y: [y[0] * y[0] + y[1] - Dual(3.0, 1.0), y[0] - y[1] + Dual(1.0, 0.5)], [Dual(1.0, 0.0), Dual(1.0, 0.0)]
    )
    x, y = two.x
    return [
        *rows,
        Row("sec. 10.1", "coincident roots: an infinity of solutions, or x' infinite", "infinite", None, "no finite root exists, or every one solves; algebra.polyroots says which", PART),
        Row("eq 56", "Newton's method, one equation", "x - F / F'", np.sqrt(Dual(2.0, 1.0)), run.x, note="dualpin: algebra.newton"),
        Row("eq 57", "Newton's method, several equations", "x - J^-1 f", three([0.0, 0.0], [0.0, 0.0]), np.stack([x * x + y - Dual(3.0, 1.0), x - y + Dual(1.0, 0.5)])),
        Row("sec. 10.3", "real and dual unknowns mixed: use the pseudo-inverse of J", "J+", None, "a pseudo-inverse does not keep a real unknown real; its dual column is to be left out: newton(real_only=...), and mechanisms.Loop", FAILS),
    ]


def others() -> list[Row]:
    return [
        Row("eq 58", "a system of dual equations solved in dual form", "f_j(x_1 ... x_n) = 0", np.zeros(1), np.array([dp.mechanisms.RCCC(Dual(np.radians([30, 55, 45, 60]), [2.0, 4, 3, 5])) .method_c(np.radians(40)) .position.closure]), note="Method C below"),
        Row("sec. 1", "dual QR, singular values, pseudo-inverse and eigenvalues had not been discussed before", "", None, "", OUTSIDE, note="history"),
        Row("sec. 12", "splitting into real and dual parts is not required", "", None, "Dual arrays go through qr, pinv, solve and newton as they are; inside, LAPACK factors the real part, and the dual part follows", MEASURED),
        Row("sec. 2", "contributions by field", "", None, "", OUTSIDE, note="a bibliography"),
        Row("Figs 1-7", "line vector, products, dual angle, feet, sum, transference, adjacent links", "", None, "", OUTSIDE, note="sketches of definitions, without data; the numbering after Fig 7 skips"),
        Row("sec. 7.4, figure", "cylindroid of the example's two lines", "", None, "figures/cylindroid.svg", DRAWN),
        Row("sec. 12.1, figure", "angles and slides of the RCCC linkage over a turn (the printout of listing 14.2)", "", None, "figures/rccc.svg", DRAWN),
    ]


def page() -> Page:
    return Page(
        "pennestri",
        "Linear algebra with dual numbers, and the RCCC linkage",
        "E. Pennestri, R. Stefanelli: Linear algebra and numerical algorithms using dual numbers. Multibody System Dynamics 18 "
        "(2007) 323-344.",
        "Independent values are definitions, derivatives by complex steps, or golden values (mpmath, 140 digits). The paper "
        "prints three decimals for matrices, six for the linkage. Docs: [The five papers: dual linear algebra](../../docs/papers/pennestri.md).",
        [*motors(), *calculus(), *lines(), *matrices(), *screws(), *nonlinear(), *linkage(), *others()],
        {
            "rccc.svg": "The RCCC linkage of sec. 12.1 over a full turn, both ways to assemble it: angles and slides of joints 2, 3, 4 (the listing prints them as numbers; dots: the position of Tables 5 and 6).",
            "cylindroid.svg": "The cylindroid of the two lines of the example in sec. 7.4: the axes of all their sums.",
        },
        "the Ch programs themselves (listings 14.1 and 14.2 are followed, not run), the bibliography of sec. 2, and processor "
        "times of 2007, which are set beside measured ratios.",
        [operations(), times()],
    )
