"""Pennestri and Stefanelli (2007): linear algebra and numerical algorithms using dual numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

import dualpin as dp
from dualpin import Dual
from dualpin import dual as functions

from .common import Claim, Page, Row, gold, golden, numbers
from .pennestri_linkage import linkage, operations, times

al = dp.algebra
GOLD = golden()
THREE = 5e-3 / 2  # three decimals, rounded or cut
FOUR = 1e-4  # four decimals, cut


def functions_() -> list[Row]:
    M = al.Motor([1.0, -2.0, 2.0], [0.5, 1.0, 3.0])
    x, h = Dual(0.75, -1.25), 1e-30
    sine = Dual(np.sin(0.75), np.sin(0.75 - 1.25j * h).imag / h)
    cosine = Dual(np.cos(0.75), np.cos(0.75 - 1.25j * h).imag / h)
    a, b = M.real, np.array([0.3, 0.1, -1.0])
    couple = al.Motor([0.0, 0, 0], [1.0, 2, 3])
    return [
        Row("eq 5", "magnitude a = M.M", 9.0, 3.0, M.magnitude.real, "2.1"),
        Row("eq 6", "pitch M.M' / M.M", 4.5 / 9, 0.5, M.pitch),
        Row(
            "Table 1", "class of M = 0, M' != 0 by the printed conditions", "zero", "couple", couple.kind.item(), "2.2"
        ),
        Row("eq 8", "f(x) + x' f'(x) without eps, f = sin", Dual(sine.real + sine.dual, 0.0), sine, np.sin(x), "2.3"),
        Row(
            "Table 2",
            "dual part of the cross product, printed A.B' + A'.B",
            np.dot(a, b) + np.dot(M.dual, b),
            np.cross(M.real, b) + np.cross(M.dual, a),
            M.cross(al.Motor(a, b)).dual,
            "2.5",
        ),
        Row("Table 2", "cos, printed as the line of the sine", sine, cosine, np.cos(x), "2.6"),
    ]


def lines() -> list[Row]:
    l1, l2 = al.line([0, 0, 1.0], [1, 0, 0]), al.line([0, 0, 1.0], [1, 1, 0])  # they meet
    p1, p2 = al.line([0, 0, 0.0], [1, 0, 0]), al.line([0, 3.0, 0], [1, 0, 0])  # parallel, 3 apart
    z, x5 = al.line([0, 0, 0], [0, 0, 1]), al.line([0, 1, 5], [1, 0, 0])
    normal, _, _ = al.common_perpendicular(l1, l2)
    star = np.array([0.0, 1.0, 0.0])  # from the first parallel line to the second
    r1, a = np.array([1.0, 2, 3]), np.array([1.0, 1, 2])
    r2, b = np.array([-1.0, 0, 2]), np.array([0.0, 3, 1])
    by_definition = np.cross(a, np.cross(r2, b)) + np.cross(np.cross(r1, a), b)
    shortcut = np.dot(a, b) * (r2 - r1) + np.cross(r1, np.cross(a, b))
    A, B = al.Motor(a, np.cross(r1, a)), al.Motor(b, np.cross(r2, b))
    case = GOLD["motor_sum"][0]
    s = al.screw_sum(gold(case["A1"]), gold(case["A2"]))
    half = np.sqrt(0.5)
    rows = [
        Row("eq 10, 2nd line", "dual part of A x B by the shortcut", shortcut, by_definition, A.cross(B).dual, "2.9"),
        Row(
            "Table 3",
            "lines that meet: A x B = a b S*",
            normal.vector,
            normal.vector * np.sin(np.pi / 4),
            l1.cross(l2),
            "2.10",
        ),
        Row(
            "Table 3",
            "parallel lines: A x B = eps a b s*",
            Dual(np.zeros(3), star),
            Dual(np.zeros(3), 3 * np.array([0.0, 1, 0])),
            p1.cross(p2),
            "2.11",
        ),
        Row(
            "sec. 7.3, step 6",
            "foot on a line through the origin",
            np.zeros(3),
            np.array([0.0, 0, 5]),
            al.common_perpendicular(z, x5)[1],
            "2.12",
        ),
        Row("sec. 7.4", "dual angle pi/2 - eps", Dual(np.pi / 2, -1.0), Dual(np.pi / 2, -1.0), s.theta),
        Row("sec. 7.4", "common perpendicular", np.array([-1.0, 0, 0]), np.array([-1.0, 0, 0]), s.perpendicular.real),
        Row("sec. 7.4", "alpha1 = pi/4 - eps/2", Dual(np.pi / 4, -0.5), gold(case["alpha1"]), s.alpha1),
        Row("sec. 7.4", "magnitude sqrt 2 (1 + eps/2)", Dual(2 * half, half), gold(case["magnitude"]), s.magnitude),
        Row(
            "sec. 7.4",
            "sum (0, 1, 1 + eps), of pitch 1/2",
            Dual([0.0, 1, 1], [0.0, 0, 1]),
            al.motor_sum(gold(case["A1"]), gold(case["A2"])),
            s.sum,
        ),
    ]
    for i, pair in enumerate(GOLD["line_pairs"]):
        u = [al.line(*(np.array(numbers(pair[k][n])) for n in ("point", "direction"))) for k in ("line1", "line2")]
        _, foot1, foot2 = al.common_perpendicular(*u)
        rows.append(
            Row("secs. 7.2, 7.3", f"pair {i + 1}: dual angle", None, gold(pair["dual_angle"]), al.dual_angle(*u))
        )
        rows.append(
            Row(
                "sec. 7.3",
                f"pair {i + 1}: both feet",
                None,
                np.array(numbers([pair["P1"], pair["P2"]])),
                np.stack([foot1, foot2]),
            )
        )
    return rows


def matrices() -> list[Row]:
    qr = GOLD["qr"][0]
    Q, R = al.qr(gold(qr["A"]))
    printed_Q = Dual([[0.3162, 0.9487], [0.9487, -0.3162]], [[-0.5692, 0.1897], [0.1897, 0.5692]])
    printed_R = Dual([[3.1623, 3.4785], [0, 0.9487]], [[8.8544, 1.3282], [0, 4.6169]])
    A1, A2 = (gold(c["A"]) for c in GOLD["pinv"])
    right1, right2 = (gold(c["pinv"]) for c in GOLD["pinv"])
    s_right = _sigma(GOLD["svd"][0])
    U, S, Vh = al.svd(gold(GOLD["svd"][0]["A"]))
    alpha = Dual(0.5, 2.0)
    c, s = np.cos(alpha), np.sin(alpha)
    one, zero = Dual(1.0, 0.0), Dual(0.0, 0.0)
    link = np.stack([np.stack([one, zero, zero]), np.stack([zero, c, -s]), np.stack([zero, s, c])])
    shifted = np.stack([np.stack([zero, zero, one]), np.stack([c, -s, zero]), np.stack([s, c, zero])])
    rows = [
        Row("sec. 7.8", "QR example: Q", printed_Q, gold(qr["Q"]), Q, digits=FOUR),
        Row("sec. 7.8", "QR example: R", printed_R, gold(qr["R"]), R, digits=FOUR),
        Row(
            "eq 32", "pseudo-inverse of A1, (A^T A)^-1 A^T", al.inv(A1.T @ A1) @ A1.T, right1, al.pinv(A1), digits=1e-11
        ),
        Row("eq 33", "pseudo-inverse of A1, A+ - eps A+ A' A+", al.pinv_simple(A1), right1, al.pinv(A1), "2.13"),
        Row(
            "sec. 7.9",
            "A1+, dual parts",
            np.array([[0.064, 0.082, -0.533], [-0.025, -0.038, 0.199]]),
            right1.dual,
            al.pinv(A1).dual,
            "2.14",
            digits=THREE,
            note="the printed numbers are those of eq 33",
        ),
        Row(
            "sec. 7.9",
            "A2+ (2,:) and (3,:), dual parts",
            np.array([[-0.035, -0.001], [-0.007, -0.011]]),
            right2.dual[1:],
            al.pinv(A2).dual[1:],
            "2.15",
            digits=THREE,
        ),
        Row(
            "sec. 7.9",
            "A2+ (1,1), printed -0.035 eps - 0.014",
            Dual(-0.014, -0.035),
            right2[0, 0],
            al.pinv(A2)[0, 0],
            "2.16",
            digits=THREE,
        ),
        Row(
            "sec. 7.9",
            "A2+ by eq 33, (1,1)",
            Dual(-0.035, -0.014),
            gold(GOLD["pinv"][1]["pinv_eq33_of_paper002"])[0, 0],
            al.pinv_simple(A2)[0, 0],
            digits=THREE,
        ),
        Row(
            "sec. 7.11",
            "singular values of the matrix as printed",
            Dual([10.63, 1.41], [5.20, 1.19]),
            s_right,
            S,
            "2.17",
            digits=THREE,
            note="the printed factors belong to the matrix with (1,2) = 3 + 5 eps",
        ),
        Row(
            "sec. 7.11",
            "singular values with (1,2) = 3 + 5 eps",
            Dual([10.63, 1.41], [5.20, 1.19]),
            _sigma(GOLD["svd"][1]),
            al.svd(gold(GOLD["svd"][1]["A"]))[1],
            digits=THREE,
        ),
        Row("eq 36", "U U^T = 1 for the 3 x 2 factor", np.eye(3), U.real @ U.real.T, (U @ U.T).real, "2.18"),
        Row(
            "eq 36",
            "shapes of U, S, V",
            "3x3, 3x3, 2x3",
            "3x2, 2x2, 2x2",
            f"{_shape(U)}, {S.shape[0]}x{S.shape[0]}, {_shape(Vh)}",
            "2.18",
        ),
        Row(
            "eq 41", "X(alpha) with columns shifted", shifted, link, al.screw_matrix([1, 0, 0, 0, 0, 0], alpha), "2.21"
        ),
    ]
    for case in GOLD["eig"]:
        w, _ = al.eig(gold(case["A"]))
        rows.append(
            Row("sec. 7.10", f"eigenvalues, {case['name']}", None, _stacked([gold(p["lam"]) for p in case["pairs"]]), w)
        )
    A, b = gold(GOLD["lstsq"][0]["A"]), gold(GOLD["lstsq"][0]["b"])
    rows.append(Row("sec. 7.12", "least squares", None, gold(GOLD["lstsq"][0]["x"]), al.lstsq(A, b)))
    return rows


def _sigma(case: Any) -> Dual:
    return _stacked([gold(s) for s in case["sigma"]])


def _stacked(items: list[Dual]) -> Dual:
    return functions.stack(items)


def _shape(x: Dual) -> str:
    return "x".join(map(str, x.shape))


def screws() -> list[Row]:
    theta, d = 1e-6, 0.7
    x = dp.spatial.exp([0, 0, theta, 0, 0, d])
    e0 = Dual(x[0], x[4])
    with np.errstate(all="ignore"):
        printed = float((2 * np.arccos(e0)).dual)
    case = GOLD["compose"][0]
    E = [gold(case[k]["axis"]) for k in ("first", "second")]
    t = [gold(case[k]["dual_angle"]) for k in ("first", "second")]
    T = [al.rodrigues(*pair) for pair in zip(E, t, strict=True)]
    body = al.screw_matrix(E[0], t[0]) @ al.screw_matrix(E[1], t[1])  # the second about the axis carried along
    _, axis = al.screw_of(al.compose_screws(*T, body=True))
    wrong = al.screw_of(al.compose_screws(*T))[1]
    right = al.Motor(*(getattr(_axis_of(body), p) for p in ("real", "dual")))
    return [
        Row(
            "after Table 4",
            "distance by 2 acos(e0) at an angle of 1e-6",
            printed,
            d,
            dp.spatial.screw_parameters(x).distance,
            "2.23",
            digits=1e-9,
        ),
        Row("eq 50", "composition, axes fixed in space", gold(case["T3"]), gold(case["T3"]), al.compose_screws(*T)),
        Row("eqs 49-50", "the minus sign for axes fixed in the body", wrong.vector, right.vector, axis.vector, "2.24"),
    ]


def _axis_of(A: Dual) -> al.LineVector:
    s = dp.spatial.screw_parameters(al.homogeneous(A))
    return al.LineVector(s.axis, s.moment)


def polynomials() -> list[Row]:
    rows = []
    for case in GOLD["polynomials"]:
        want = [tuple(complex(*numbers(r[part])) for part in ("real", "dual")) for r in case["roots"]]
        want.sort(key=lambda r: (r[0].real, r[0].imag))
        c = Dual(numbers(case["coeff_real_ascending"]), numbers(case["coeff_dual_ascending"]))
        right = Dual(np.array([r[0] for r in want]), np.array([r[1] for r in want]))
        rows.append(Row("sec. 10.1", f"roots, {case['name']}", None, right, al.polyroots(c).astype(complex)))
    return rows


CLAIMS = [
    Claim(
        "eq 8",
        "follows from the analytic test (7)",
        "(7) also admits an extra eps h(x); (8) is the natural extension",
        "holds in part",
        "2.4",
    ),
    Claim(
        "eq 35",
        "A and A' must be nonsingular",
        "not needed; needed are simple eigenvalues and v^T v != 0. dualpin refuses "
        "repeated ones and returns isotropic vectors with v^H v = 1",
        "does not hold",
        "2.20",
    ),
    Claim(
        "sec. 10.3",
        "a pseudo-inverse serves mixed real and dual unknowns",
        "it does not keep a real unknown real; newton(real_only=...) leaves its dual part out",
        "does not hold",
        "2.39",
    ),
    Claim(
        "sec. 10.1",
        "coincident roots have an infinite dual part",
        "no finite one exists, or every one solves",
        "holds in part",
        "2.40",
    ),
    Claim(
        "sec. 12.1",
        "three alternatives C",
        "four are listed, and the input angle is not given: 40 degrees, a4 = 5",
        "holds in part",
        "2.25, 2.26, 2.35",
    ),
    Claim(
        "abstract",
        "substantial gain of computing time",
        "C2, C3, C4 take 15, 17, 10 % less than C1 in print; measured below",
        "holds in part",
        "2.38",
    ),
    Claim(
        "Table 6",
        "residuals .5525, .0022, .2057",
        "the starting values of theta2, theta3 are not stated",
        "not reproducible",
        "2.32",
    ),
]


def page() -> Page:
    return Page(
        "pennestri",
        "Linear algebra with dual numbers (Pennestri, Stefanelli)",
        "Corrected values are definitions, derivatives by complex steps, or the golden values (mpmath, 140 digits).",
        [*functions_(), *lines(), *matrices(), *screws(), *polynomials(), *linkage()],
        CLAIMS,
        [operations(), times()],
    )
