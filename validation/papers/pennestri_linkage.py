"""Pennestri and Stefanelli (2007): the RCCC linkage, and what the operations cost."""

# ruff: noqa: E501  (rows of a table, one a line)
# fmt: off

from __future__ import annotations

import time
from typing import Any

import numpy as np

import dualpin as dp
from dualpin import Dual
from dualpin import dual as functions
from dualpin.spatial import Vector3

from .common import ASSUMING, CANNOT, FAILS, MEASURED, PART, ROUNDING, Row, gold, golden, numbers
from .counting import Counted, count

al = dp.algebra
LINKAGE = dp.mechanisms.RCCC(Dual(np.radians([30, 55, 45, 60]), [2.0, 4, 3, 5]))
INPUT = np.radians(40.0)
GOLD = golden()
SIX = 5.01e-7  # half a unit of six decimals
NOISE = 6e-7  # five roundings of single precision, which an eps part gathers in the iteration
TABLE_5 = [Dual(1.745329, -1.300000), Dual(2.009102, -1.657790), Dual(2.035995, -1.767060), Dual(2.036356, -1.770564)]
F_5 = [Dual(-0.162529, -0.403280), Dual(-0.013617, -0.003539), Dual(-0.000178, 0.000931), Dual(-0.000000, 0.000001)]
SUMS_6 = (0.552520, 0.002172, 0.205704, 0.002170, 0.000049, 0.000003)


def single() -> tuple[list[Dual], list[Dual]]:
    """A, B, C, and the iterates of eq 56, all in single precision."""

    def f32(x: Any, dx: Any = 0.0) -> Dual:
        return Dual(np.array([x], np.float32), np.array([dx], np.float32))

    def cos_sin(x: Dual) -> tuple[Dual, Dual]:
        c, s = np.cos(x.real), np.sin(x.real)
        return Dual(c, -s * x.dual), Dual(s, c * x.dual)

    (c1, s1), (c2, _), (c3, s3), (c4, s4) = (
        cos_sin(f32(np.float32(np.radians(np.float32(a))), d)) for a, d in ((30, 2), (55, 4), (45, 3), (60, 5))
    )
    c, s = cos_sin(f32(np.radians(np.float32(40))))
    A, B, C = s1 * s3 * s, -s3 * (c1 * s4 + s1 * c4 * c), c3 * (c1 * c4 - s1 * s4 * c) - c2
    x, found = f32(1.745329, -1.3), []
    for _ in range(7):
        found.append(x)
        ct, st = cos_sin(x)
        x = x - (A * st + B * ct + C) / (A * ct - B * st)
    return [A[0], B[0], C[0]], [y[0] for y in found]


def sums(start: list[Dual]) -> tuple[list[float], float]:
    """Sum of f^2 + f'^2 of eqs 64 along the iterations of method B, and how far its end leaves the loop open."""
    run = LINKAGE.method_b(INPUT, start, check=False, tol=1e-9)
    found = []
    for x in run.trace[:6]:
        left = LINKAGE._left(Dual(INPUT, 0.0), x[2]).rows
        Z = [dp.spatial.Rotation.about(dp.spatial.UZ, x[i]) for i in (0, 1)]
        right = (Z[1].T @ LINKAGE.loop.links[1].T @ Z[0].T).rows
        f = [left[2].z - right[2].z, left[2].x - right[2].x, left[0].x - right[0].x]
        found.append(float(sum(y.real**2 + y.dual**2 for y in f)))
    return found, run.position.closure


def linkage() -> list[Row]:
    g = GOLD["rccc"]
    A, B, C = LINKAGE.coefficients(INPUT)
    run = LINKAGE.method_a(INPUT, gold(g["newton"][0]["theta4"]))
    (_, B32, C32), iterates = single()
    found, left_open = sums([Dual(np.radians(105), -2.2875), Dual(np.radians(50), -2.1465), Dual(1.745329, -1.3)])
    rows = [
        Row("eq 59", "input-output equation of the closed linkage", "A sin theta4 + B cos theta4 + C = 0", Dual(0.0, 0.0), A * np.sin(LINKAGE.solve(INPUT)[1].theta4) + B * np.cos(LINKAGE.solve(INPUT)[1].theta4) + C),
        Row("eq 60", "A", "0.227260 + 1.469030 eps", Dual(0.227260, 1.469030), A, ASSUMING, gold(g["A"]), digits=SIX, note="theta1 = 40 degrees, which is not printed, and a4 = 5 where the text says a5"),
        Row("eq 61", "B, real part", "-0.665749", -0.665749, B.real, ASSUMING, gold(g["B"]).real, digits=SIX, note="theta1 = 40 degrees"),
        Row("eq 61", "B, eps part", "-2.212148", -2.212148, B.dual, ROUNDING, gold(g["B"]).dual, B32.dual, digits=SIX / 2.2, note="-2.2121486 in double precision"),
        Row("eq 62", "C, real part", "-0.501943", -0.501943, C.real, ROUNDING, gold(g["C"]).real, C32.real, digits=SIX, note="-0.50194247 in double precision"),
        Row("eq 62", "C, eps part", "-1.433104", -1.433104, C.dual, ASSUMING, gold(g["C"]).dual, digits=SIX, note="theta1 = 40 degrees"),
    ]
    for k, (x, F) in enumerate(zip(TABLE_5, F_5, strict=True)):
        real, dual = run.iterates[k].real, run.iterates[k].dual
        want = gold(g["newton"][k]["theta4"])
        for part, value, ours, right, low in (
            ("real", x.real, real, want.real, iterates[k].real),
            ("eps", x.dual, dual, want.dual, iterates[k].dual),
        ):
            close = abs(value - ours) <= SIX
            rows.append(
                Row("Table 5", f"theta4, iterate {k}, {part} part", f"{value:.6f}", value, ours, "holds to the printed digits" if close else ROUNDING, right, low, digits=SIX / max(1.0, abs(ours)), noise=0.0 if part == "real" else NOISE, note="" if close else f"{ours:.7f} in double precision")
            )
        rows.append(
            Row("Table 5", f"F at iterate {k}", f"{F.real:.6f} {F.dual:+.6f} eps", F, run.values[k], right=gold(g["newton"][k]["F"]) if k < 4 and "F" in g["newton"][k] else None, digits=SIX)
        )
    rows += [
        Row("Table 6", "theta4 at the end, real part", "2.036356", 2.036356, LINKAGE.solve(INPUT)[1].theta4.real, digits=SIX),
        Row("Table 6", "theta4 at the end, eps part", "-1.770567", -1.770567, LINKAGE.solve(INPUT)[1].theta4.dual, ROUNDING, gold(g["newton"][5]["theta4"]).dual, iterates[6].dual, digits=SIX / 1.77, noise=NOISE, note=f"-1.7705659 in double precision, {float(iterates[6].dual):.7f} in single"),
        Row("Table 6", "sums of f^2 + f'^2, iterations 0 to 5", ".552520 .002172 .205704 .002170 .000049 .000003", np.array(SUMS_6), np.array(found), ASSUMING, digits=2.1e-4, note="theta2 = 105, theta3 = 50 degrees with the slides -2.2875, -2.1465 of the root, which are not printed; the start is known to half a degree"),
        Row("Table 6", "the run ends in a position of the linkage", "", None, f"with that start it leaves the loop open by {left_open:.2f}: the three equations have roots that are no positions", FAILS),
    ]
    spurious = Dual(*numbers(g["spurious_root_of_eq64"]["theta3"]))
    true = gold(g["cases"][0]["solutions"][1]["theta3"])
    return [
        *rows,
        Row("Method B", "three elements of eq 63 fix the position: theta3 from (3,3), (3,1), (1,1)", "theta3 is not printed", spurious, LINKAGE.solve(INPUT)[1].theta3, CANNOT, true, note="a root of eqs 64 with theta3 = 60.42 degrees leaves the loop open by more than 1; footnote 7 of the paper asks for a fourth element. method_b refuses it"),
        Row("footnote 7", "three elements and one of four values of a fourth fix an orientation", "four elements", None, _fourth(g), MEASURED, note="the theorem of Beggs that the paper cites; eqs 64 use three"),
        *loop_formulas(),
    ]


def _fourth(g: Any) -> str:
    """What the other elements say at the spurious root of method B."""
    s = {k: Dual(*numbers(x)) for k, x in g["spurious_root_of_eq64"].items() if k != "note"}
    off = np.abs(LINKAGE.closure([Dual(INPUT, 0.0), s["theta2"], s["theta3"], s["theta4"]]).real)
    return f"at the spurious root of method B the loop matrix misses 1 by {off.max():.2f} in its worst element, so a fourth tells it"


def loop_formulas() -> list[Row]:
    """Equations 63 to 76 against the matrices themselves, multiplied out with NumPy."""
    p = LINKAGE.solve(INPUT)[1]
    theta = [p.theta1, p.theta2 + 0.1, p.theta3 - 0.2, p.theta4 + 0.3]
    (c1, s1), (c2, s2_), (c3, s3), (c4, s4) = (functions.cos_sin(LINKAGE.alpha[i]) for i in range(4))
    A, B, C = LINKAGE.coefficients(INPUT)
    (ct, st), (c, s) = functions.cos_sin(theta[0]), functions.cos_sin(theta[3])
    (k2, n2), (k3, n3) = functions.cos_sin(theta[1]), functions.cos_sin(theta[2])
    printed = (s3 * s * st - (s3 * c4 * c - c3 * s4) * ct) * s1 + (c3 * c4 - s3 * c * s4) * c1 - c2
    X = [al.screw_matrix([1, 0, 0, 0, 0, 0], LINKAGE.alpha[i]) for i in range(4)]
    Z = [al.screw_matrix([0, 0, 1, 0, 0, 0], t) for t in theta]
    left, right = X[2] @ Z[3] @ X[3] @ Z[0] @ X[0], Z[2].T @ X[1].T @ Z[1].T
    at_root = [al.screw_matrix([0, 0, 1, 0, 0, 0], t) for t in (p.theta1, p.theta2, p.theta3, p.theta4)]
    eq63 = X[2] @ at_root[3] @ X[3] @ at_root[0] @ X[0] - at_root[2].T @ X[1].T @ at_root[1].T
    extra = X[2] @ at_root[3] @ X[3] @ at_root[0] @ X[0] @ at_root[2] - at_root[2].T @ X[1].T @ at_root[1].T
    f2 = s3 * s * ct + (s3 * c4 * c + c3 * s4) * st - s2_ * n2
    f3 = c * ct - c4 * s * st - k3 * k2 + n3 * c2 * n2
    joints = LINKAGE.joint_matrices(theta)
    Q = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 0]])
    h = 1e-30
    turned = [np.asarray(a.real, complex) for a in joints]
    z = np.array([[np.cos(1j * h), -np.sin(1j * h), 0], [np.sin(1j * h), np.cos(1j * h), 0], [0, 0, 1]])
    slope = (turned[0] @ z @ turned[1] @ turned[2] @ turned[3]).imag / h
    whole = joints[0] @ joints[1] @ joints[2] @ joints[3]
    B2 = joints[0] @ (Q @ (joints[1] @ joints[2] @ joints[3]))
    missing = joints[0].real @ Q @ joints[2].real @ joints[3].real
    M, v = LINKAGE._system(p.theta1, functions.stack(theta[1:]))
    entries = (np.array([0, 1, 2, 1, 2, 2]), np.array([0, 0, 0, 1, 1, 2]))
    bad = -whole[1, 0]
    step = al.pinv(M) @ v
    normal = al.solve(M.T @ M, M.T @ v)
    nine = LINKAGE.method_c(INPUT).position
    closed = LINKAGE.solve(INPUT)[1]
    counts = {
        w: float(np.mean(LINKAGE.sweep_by_iteration(np.radians(np.arange(0, 46)), variant=w)[1][1:]))
        for w in ("C1", "C1-listing", "C2", "C3", "C4")
    }
    return [
        Row("eq 63", "closure in two halves; its third bracket reads Lambda_1 Theta_3", "Theta_3 inside", extra, eq63, CANNOT, Dual(np.zeros((3, 3)), np.zeros((3, 3))), note="with Theta_3 the loop is not closed; without it X3 Z4 X4 Z1 X1 = Z3^T X2^T Z2^T. Perhaps a reading of the layout"),
        Row("eq 64a", "f1: a sign", "... - cos a3 sin a4 ...", printed, A * s + B * c + C, CANNOT, left[2, 2] - right[2, 2], note="plus: then it is eq 59 and the element (3,3) of eq 63"),
        Row("eq 64b", "f2", "as printed", f2, left[2, 0] - right[2, 0]),
        Row("eq 64c", "f3", "as printed", f3, left[0, 0] - right[0, 0]),
        Row("eqs 65-67", "derivative of a joint's matrix", "Q A", Q @ turned[1].real, (z @ turned[1]).imag / h),
        Row("eqs 68-70", "loop A1 A2 A3 A4 = 1, corrections, linear equations; the position they lead to", "theta + delta theta", functions.stack([closed.theta2, closed.theta3, closed.theta4]), functions.stack([nine.theta2, nine.theta3, nine.theta4]), digits=1e-6, note="stopped at 1e-6, as the listing; dualpin: RCCC.method_c, mechanisms.Loop for any joints"),
        Row("eq 71", "B1", "A1 A2 A3 A4", whole - np.eye(3), LINKAGE.closure(theta)),
        Row("eq 72", "B_i: A_i missing", "A1 ... A_{i-1} Q A_{i+1} ... A4", missing, B2.real, CANNOT, slope, note="the derivative is A1 ... A_{i-1} Q A_i ... A4; listing 14.2 has it so"),
        Row("eq 73", "right-hand side, first entry", "1 - B_121", 1 + bad, v[0], CANNOT, 1 - whole[0, 0], note="1 - B_111; listing 14.2 has it so"),
        Row("eqs 73-74", "six equations, the other five", "M d = v", (np.eye(3) - whole)[entries][1:], v[1:]),
        Row("eqs 75-76", "normal equations, and the pseudo-inverse: the same step", "(M^T M)^-1 M^T v; M+ v", normal, step, digits=1e-9),
        Row("sec. 12.1", "alternatives C1 to C4: the list says three", "three", None, f"four are listed and run: {', '.join(f'{w} {n:.2f}' for w, n in counts.items())} iterations a degree", PART),
        Row("listing 14.2", "C1 as listed: iterations a degree", "linsolve(dd, ..., dual(u) - dual(N) * real(d))", counts["C1-listing"], counts["C1"], CANNOT, counts["C2"], digits=0.05, tol=0.05, note="d is the last iteration's correction; real(rd) is meant. 5 iterations a degree in place of 3, which makes C1's time in Table 7 no fair comparison"),
        Row("Table 7", "CPU times 1.422, 1.214, 1.175, 1.276 s", "C2, C3, C4 take 15, 17, 10 % less than C1", None, "measured as ratios: see the table below", MEASURED),
        Row("abstract", "a substantial reduction of CPU time", "substantial", None, "10 to 17 % in print, with printing, against a C1 that makes needless iterations", PART),
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
