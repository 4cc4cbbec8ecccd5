"""Pennestri and Stefanelli (2007): the RCCC linkage, and what the operations cost."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import dualpin as dp
from dualpin import Dual
from dualpin import dual as functions
from dualpin.spatial import Vector3

from .common import Row, gold, golden, numbers
from .counting import Counted, count

al = dp.algebra
LINKAGE = dp.mechanisms.RCCC(Dual(np.radians([30, 55, 45, 60]), [2.0, 4, 3, 5]))
INPUT = np.radians(40.0)
GOLD = golden()
SIX = 5.01e-7 / 2  # six decimals of numbers near 2


def linkage() -> list[Row]:
    g = GOLD["rccc"]
    A, B, C = LINKAGE.coefficients(INPUT)
    run = LINKAGE.method_a(INPUT, gold(g["newton"][0]["theta4"]))
    printed = {1: Dual(2.009102, -1.657790), 2: Dual(2.035995, -1.767060), 3: Dual(2.036356, -1.770564)}
    rows = [
        Row("sec. 12.1", "A", Dual(0.227260, 1.469030), gold(g["A"]), A, digits=5.01e-7),
        Row("sec. 12.1", "B, dual part", -2.212148, gold(g["B"]).dual, B.dual, "2.27", digits=SIX),
        Row("sec. 12.1", "C, real part", -0.501943, gold(g["C"]).real, C.real, "2.27", digits=5.01e-7),
    ]
    for k, value in printed.items():
        rows.append(
            Row(
                "Table 5",
                f"theta4, iterate {k}",
                value,
                gold(g["newton"][k]["theta4"]),
                run.iterates[k],
                "2.31",
                digits=SIX,
            )
        )
    rows.append(
        Row(
            "Table 5",
            "F at the start",
            Dual(-0.162529, -0.403280),
            gold(g["newton"][0]["F"]),
            run.values[0],
            digits=5.01e-7,
        )
    )
    rows.append(Row("Table 5", "root", Dual(2.036356, -1.770566), gold(g["newton"][5]["theta4"]), run.x, digits=SIX))
    rows.append(
        Row(
            "Table 6",
            "theta4 by method B, dual part",
            -1.770567,
            gold(g["newton"][5]["theta4"]).dual,
            LINKAGE.solve(INPUT)[1].theta4.dual,
            "2.32",
            digits=SIX,
        )
    )
    spurious = Dual(*numbers(g["spurious_root_of_eq64"]["theta3"]))
    true = gold(g["cases"][0]["solutions"][1]["theta3"])
    rows.append(
        Row(
            "Method B",
            "theta3 by three entries from 100 degrees",
            spurious,
            true,
            LINKAGE.solve(INPUT)[1].theta3,
            "2.30",
            digits=SIX,
            note="the root of the three entries leaves the loop open; method_b refuses it",
        )
    )
    return rows + loop_formulas()


def loop_formulas() -> list[Row]:
    """Equations 64a, 72 against the matrices themselves, multiplied out with NumPy."""
    p = LINKAGE.solve(INPUT)[1]
    theta = [p.theta1, p.theta2 + 0.1, p.theta3 - 0.2, p.theta4 + 0.3]
    (c1, s1), (c2, _), (c3, _), (c4, s4) = (functions.cos_sin(LINKAGE.alpha[i]) for i in range(4))
    A, B, C = LINKAGE.coefficients(INPUT)
    ct, (c, s) = np.cos(Dual(INPUT, 0.0)), functions.cos_sin(theta[3])
    printed = A * s + B * c + c3 * (c1 * c4 + s1 * s4 * ct) - c2
    X = [al.screw_matrix([1, 0, 0, 0, 0, 0], LINKAGE.alpha[i]) for i in range(4)]
    Z = [al.screw_matrix([0, 0, 1, 0, 0, 0], t) for t in theta]
    element = (X[2] @ Z[3] @ X[3] @ Z[0] @ X[0])[2, 2] - X[1][2, 2]
    joints = LINKAGE.joint_matrices(theta)
    Q = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 0]])
    h = 1e-30
    turned = [np.asarray(a.real, complex) for a in joints]
    z = np.array([[np.cos(1j * h), -np.sin(1j * h), 0], [np.sin(1j * h), np.cos(1j * h), 0], [0, 0, 1]])
    slope = (turned[0] @ z @ turned[1] @ turned[2] @ turned[3]).imag / h
    missing = joints[0].real @ Q @ joints[2].real @ joints[3].real
    with_it = joints[0] @ (Q @ (joints[1] @ joints[2] @ joints[3]))
    degrees = np.radians(np.arange(0, 91))
    counts = {v: np.mean(LINKAGE.sweep_by_iteration(degrees, variant=v)[1][1:]) for v in ("C1", "C1-listing", "C2")}
    return [
        Row("eq 64a", "f1 with - cos a3 sin a4", printed, element, A * s + B * c + C, "2.29"),
        Row("eq 72", "derivative of the loop, A1 Q A3 A4", missing, slope, with_it.real, "2.33"),
        Row(
            "listing 14.2",
            "iterations a degree of C1",
            counts["C1-listing"],
            counts["C2"],
            counts["C1"],
            "2.36",
            digits=0.05,
            tol=0.05,
            note="the dual right-hand side of the listing holds the last correction",
        ),
    ]


def operations() -> str:
    """Table 2, measured: the functions of dualpin run on a scalar that counts."""

    def one() -> Dual:
        return Dual(Counted(), Counted())

    def three() -> Vector3:
        return Vector3(one(), one(), one())

    cases: list[tuple[str, tuple[int, int, int], Any]] = [
        ("sum", (0, 2, 0), lambda: one() + one()),
        ("product", (3, 1, 0), lambda: one() * one()),
        ("quotient", (5, 1, 0), lambda: one() / one()),
        ("scalar times vector", (9, 3, 0), lambda: three() * one()),
        ("dot product", (9, 7, 0), lambda: three().dot(three())),
        ("cross product", (18, 12, 0), lambda: three().cross(three())),
        ("sin", (1, 0, 2), lambda: functions.sin(one())),
        ("cos", (1, 0, 2), lambda: functions.cos(one())),
        ("tan", (2, 0, 2), lambda: functions.tan(one())),
        ("asin", (3, 1, 1), lambda: functions.asin(one())),
        ("acos", (3, 1, 1), lambda: functions.acos(one())),
        ("atan", (2, 1, 1), lambda: functions.atan(one())),
    ]
    notes = {
        "quotient": "q = x / y is reused (E 2.8)",
        "tan": "1 + tan^2 in place of 1 / cos^2",
        "atan": "1 / (1 + x^2) and a product, in the paper one division",
        "asin": "the root is an elementary call, in the paper 8 products",
        "acos": "the root is an elementary call, in the paper 8 products",
    }
    lines_ = [
        "## Table 2, measured",
        "",
        "Products and divisions / sums / elementary calls, counted by running.",
        "",
        "| operation | printed | measured | |",
        "|---|---|---|---|",
    ]
    for name, printed, f in cases:
        n = count(f)
        note = "same" if n == printed else notes.get(name, "differs")
        lines_.append(f"| {name} | {' / '.join(map(str, printed))} | {' / '.join(map(str, n))} | {note} |")
    return "\n".join(lines_)


def times() -> str:
    """Table 7 as ratios, measured side by side."""
    degrees = np.radians(np.arange(0, 361))
    paper = {"C1": 1.422, "C2": 1.214, "C3": 1.175, "C4": 1.276}
    best: dict[str, float] = {}
    counts: dict[str, float] = {}
    for _ in range(2):
        for variant in ("C1", "C1-listing", "C2", "C3", "C4"):
            start = time.perf_counter()
            counts[variant] = float(np.mean(LINKAGE.sweep_by_iteration(degrees, variant=variant)[1][1:]))
            best[variant] = min(best.get(variant, np.inf), time.perf_counter() - start)
    start = time.perf_counter()
    LINKAGE.sweep(degrees)
    closed = time.perf_counter() - start
    lines_ = [
        "## Table 7: a sweep of 0 to 360 degrees",
        "",
        "Times relative to the listing's C1, best of 2, side by side in one "
        "run; the paper's are those of an interpreter of 2007.",
        "",
        "| method | paper | measured | iterations a degree |",
        "|---|---|---|---|",
    ]
    for v, t in best.items():
        printed = f"{paper[v] / paper['C1']:.2f}" if v in paper else "1.00 (if timed as listed)"
        lines_.append(f"| {v} | {printed} | {t / best['C1-listing']:.2f} | {counts[v]:.2f} |")
    lines_.append(f"| closed form, both branches at once | | {closed / best['C1-listing']:.3f} | |")
    return "\n".join(lines_)
