"""Sariyildiz and Temeltas: which integrator for the inverse kinematics of a redundant arm."""

# ruff: noqa: E501  (rows of a table, one a line)
# fmt: off

from __future__ import annotations

import time
import warnings
from functools import cache
from typing import Any

import numpy as np

import dualpin as dp

from .common import CANNOT, CONVENTION, DRAWN, FAILS, MEASURED, OUTSIDE, PART, Page, Row, golden

GOLD = golden()["pa10_tracking"]
NAMES = {"euler": "Euler", "trapezoidal": "trapezoid", "abm4": "AB4-AM4", "rk4": "RK4"}


def decay(t: float, y: np.ndarray) -> np.ndarray:
    return -y


def _order_of(method: str) -> float:
    return _order(lambda h: dp.integrators.solve(decay, [1.0], method=method, dt=h, t_end=1.0).y[-1, 0])


def _order(run: Any) -> float:
    """From the errors with steps 1/40 and 1/80."""
    e1, e2 = (abs(run(h) - np.exp(-1.0)) for h in (1 / 40, 1 / 80))
    return float(np.log2(e1 / e2))


def _trapezoid_on_predictions(h: float) -> float:
    """The printed recursion read literally: rates only along the uncorrected prediction."""
    y = p = 1.0
    for _ in range(round(1 / h)):
        ahead = p - h * p
        y += h / 2 * (-p - ahead)
        p = ahead
    return y


def pa10() -> dp.Robot:
    d, alpha = (0.317, 0, 0.450, 0, 0.480, 0, 0.070), np.radians([-90, 90, -90, 90, -90, 90, 0])
    return dp.from_dh([(0.0, x, 0.0, y) for x, y in zip(d, alpha, strict=True)], joints="R" * 7, convention="standard")


def circle(task: str) -> Any:
    t = GOLD["tasks"][task]
    return dp.Circle(t["radius"], t["period"], plane=t["plane"], start=np.radians(t["q0_deg"]))


# coefficients of the predictors and correctors, newest first
AB = {1: [1], 2: [3 / 2, -1 / 2], 3: [23 / 12, -16 / 12, 5 / 12], 4: [55 / 24, -59 / 24, 37 / 24, -9 / 24]}
AM = {2: [1 / 2, 1 / 2], 3: [5 / 12, 8 / 12, -1 / 12], 4: [9 / 24, 19 / 24, -5 / 24, 1 / 24]}


def logistic(t: float, y: Any) -> Any:
    return y * (1 - y) + 0.1 * np.cos(t)


def pece(n: int, h: float, y0: float) -> float:
    """Equations 10 to 17 written out, restarted from the corrected value, n steps."""
    y, rates = y0, [logistic(0.0, y0)]
    for k in range(n):
        ahead = y + h * sum(c * f for c, f in zip(AB[min(len(rates), 4)], rates, strict=False))
        new = [logistic((k + 1) * h, ahead), *rates]
        y = y + h * sum(c * f for c, f in zip(AM[min(len(rates) + 1, 4)], new, strict=False))
        rates = [logistic((k + 1) * h, y), *rates][:4]
    return y


def ours(method: str, n: int, h: float, y0: float) -> float:
    return float(dp.integrators.solve(logistic, [y0], method=method, dt=h, t_end=n * h, startup="paper").y[-1, 0])


def methods() -> list[Row]:
    h, y = 0.1, 0.3
    k1 = logistic(0, y)
    k2 = logistic(h / 2, y + h / 2 * k1)
    k3 = logistic(h / 2, y + h / 2 * k2)
    k4 = logistic(h, y + h * k3)
    stages = (k1 + 2 * k2 + 2 * k3 + k4) / 6
    trapezoid = y + h / 2 * (k1 + logistic(h, y + h * k1))
    robot = pa10()
    q0 = np.radians(GOLD["tasks"]["A"]["q0_deg"])
    J = dp.jacobian(robot, q0, robot.frame_names[-1], "local_world_aligned")
    V = np.array([0.1, -0.2, 0.3, 0.05, 0.1, -0.1])
    v = np.linalg.pinv(J) @ V
    exact = float(dp.integrators.solve(logistic, [y], method="rk4", dt=1e-3, t_end=1.0).y[-1, 0])
    literal = _order(_trapezoid_on_predictions)
    return [
        Row("eq 1", "joint rates by the generalised inverse", "q' = J^g V", J @ v, V, note="dualpin: track, the Moore-Penrose inverse"),
        Row("eq 2", "joint angles", "q = integral of q' from 0 to t", exact - y, exact, CANNOT, pece(100, 0.01, y), tol=1e-6, note="without q(0), which the steps of eqs 3 to 17 have"),
        Row("eqs 3-4", "explicit Euler", "q + q' dt", y + h * k1, ours("euler", 1, h, y)),
        Row("eq 5", "Runge-Kutta 4: the step", "q + (q'1 + 2 q'2 + 2 q'3 + q'4) / 6", y + stages, ours("rk4", 1, h, y), CANNOT, y + h * stages, note="radians and radians per second; with dt / 6 it is of order 4. Perhaps a lost symbol"),
        Row("eq 5", "with dt / 6", "q + dt (...) / 6", y + h * stages, ours("rk4", 1, h, y)),
        Row("eqs 6-7", "its stages", "J^g(q_i) V at k, k + 1/2, k + 1/2, k + 1", y + h * stages, ours("rk4", 1, h, y)),
        Row("eqs 8-9", "trapezoid with an Euler predictor", "q + dt (q'_k + q'_{k+1}) / 2", trapezoid, ours("trapezoidal", 1, h, y), CONVENTION, note="predicted anew from each corrected value"),
        Row("eqs 8-9", "the predictor runs on its own predictions: order", "2 expected", literal, _order_of("trapezoidal"), CANNOT, 2.0, digits=0.1, tol=0.1, note="read literally, rates along uncorrected predictions, the order is 1"),
        Row("eqs 10-17", "AB4 predictor, AM4 corrector, start by lower orders: six steps", "coefficients as printed", pece(6, h, y), ours("abm4", 6, h, y), CONVENTION, note="predicted from each corrected value; t_1 is the first instant"),
        Row("eqs 13, 17", "coefficients 55 -59 37 -9, 9 19 -5 1: exact for cubics", "/ 24", np.array([sum(c * (-i) ** m for i, c in enumerate(AB[4])) for m in range(4)]), np.array([1.0, 0.5, 1 / 3, 0.25])),
        Row("eqs 10-17", "order", "fourth order", 4.0, _order_of("abm4"), CANNOT, 3.0, digits=0.1, tol=0.1, note="the first step, by the trapezoid, has an error of dt^3, which remains; started by RK4 the order is 4: next row"),
        Row("eqs 10-17", "order when started by RK4", "fourth order", 4.0, _order(lambda s: dp.integrators.solve(decay, [1.0], method="abm4", dt=s, t_end=1.0, startup="rk4").y[-1, 0]), digits=0.15),
        Row("sec. 3.4", "two backward values of the rates", "two", None, "the corrector needs two, the predictor three (eq 13)", PART),
        Row("sec. 3", "orders of Euler and RK4", "1, 4", np.array([1.0, 4.0]), np.array([_order_of("euler"), _order_of("rk4")]), digits=0.02),
        Row("throughout", "sampling rate 10 ms, 100 ms, 1 s", "rate", None, "a period; large periods are meant where high rates are said", PART),
    ]


@cache
def tracked(task: str, method: str, dt: float, gain: float = 0.0, startup: str = "paper", turns: int = 6) -> Any:
    t = GOLD["tasks"][task]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return dp.track(
            model(), circle(task), method=method, dt=dt, t_end=turns * t["period"], gain=gain, startup=startup
        )


@cache
def model() -> dp.Robot:
    """The model that ships with dualpin: the same rows, with joint limits."""
    return dp.load("pa10")


def claims() -> list[Row]:
    peak = {(m, dt): float(tracked("A", m, dt).position_error.max()) for m in NAMES for dt in (0.1, 1.0)}
    order = all(peak["euler", dt] > peak["trapezoidal", dt] > peak["abm4", dt] > peak["rk4", dt] for dt in (0.1, 1.0))
    euler = tracked("A", "euler", 1.0)
    beyond = np.abs(euler.q) > np.minimum(-model().lower, model().upper)
    t, far = euler.t[beyond.any(axis=-1)], euler.t[beyond[:, [0, 1, 2, 4, 5, 6]].any(axis=-1)]
    late = {m: float(tracked("A", m, 0.1, 10.0).position_error[-100:].max()) for m in ("abm4", "rk4")}
    first = {m: float(tracked("A", m, 0.1, 10.0).position_error.max()) for m in ("abm4", "rk4")}
    limits = {m: dp.integrators.stability_limit(m) for m in NAMES}
    evaluations = {m: tracked("A", m, 0.1, turns=1).cost.evaluations / 100 for m in NAMES}
    return [
        Row("Figs 1-2", "block diagrams", "", None, "", OUTSIDE, note="Simulink; dualpin.tracking is the same loop"),
        Row("Fig 3", "the PA-10, animated", "", None, "dualpin view pa10 --play q.csv", MEASURED),
        Row("Fig 4", "Euler takes the least time, Runge-Kutta 4 the most", "bars, no numbers", None, "pseudo-inverses a step " + ", ".join(f"{NAMES[m]} {n:.2f}" for m, n in evaluations.items()) + ": by evaluations it holds; by the clock only where each costs more than the step around it: figures/pa10_times.svg and the table below", PART),
        Row("Figs 5-8", "errors at 100 and 10 ms of the four methods", "curves", None, "figures/pa10_errors.svg", DRAWN, note="the paper gives no radius, period, pose, gain or table; circle A is ours"),
        Row("Figs 9-10", "errors at 1 s (cited as 10 and 11)", "curves", None, "figures/pa10_errors_1s.svg", DRAWN),
        Row("sec. 5", "accuracy: RK4, Adams-Moulton, trapezoid, Euler, in this order", "order", None, ("in open loop at 0.1 and 1 s: " if order else "NOT: ") + ", ".join(f"{NAMES[m]} {peak[m, 0.1]:.1e}, {peak[m, 1.0]:.1e} m" for m in NAMES), MEASURED),
        Row("sec. 5", "with RK4 at 1 s the error is about 1e-4", "10^-4", None, f"{peak['rk4', 1.0]:.1e} m on circle A", MEASURED),
        Row("sec. 5", "Euler at 1 s makes the system unstable, the others stay stable", "", None, "as drift in open loop, yes; as stability, no: with feedback the limits of K dt are " + ", ".join(f"{NAMES[m]} {x:.3f}" for m, x in limits.items()) + ", so that no gain makes Euler unstable and keeps AB4-AM4 stable", FAILS),
        Row("sec. 5", "circle A, Euler, 1 s: the joints stay within their limits", "", None, f"joint 4 passes 137 degrees from t = {t[0]:.0f} s on, in every turn, the others theirs from t = {far[0]:.0f} s on: the errors of turns 5 and 6 are those of an arm that does not exist", FAILS),
        Row("sec. 1", "a feedback of the pose overcomes the drift, and the method still matters", "", None, f"circle A, Euler, 0.1 s: {tracked('A', 'euler', 0.1).position_error[-100:].max():.1e} m in the last turn without, {tracked('A', 'euler', 0.1, 10.0).position_error[-100:].max():.1e} m with K = 10; RK4 {tracked('A', 'rk4', 0.1, 10.0).position_error[-100:].max():.1e} m", MEASURED),
        Row("sec. 6", "RK4 is the most accurate and most stable (with feedback)", "", None, f"for the peak ({first['rk4']:.1e} against {first['abm4']:.1e} m, 0.1 s, K = 10); after the start AB4-AM4 is better ({late['abm4']:.1e} against {late['rk4']:.1e} m)", PART),
        Row("sec. 6", "Adams-Moulton is computationally more efficient", "", None, f"{evaluations['abm4']:.2f} against {evaluations['rk4']:.2f} pseudo-inverses a step; at equal accuracy RK4 is cheaper: {tracked('A', 'rk4', 0.05).position_error.max():.1e} m at 0.05 s with 80 a second, {tracked('A', 'abm4', 0.01).position_error.max():.1e} m at 0.01 s with 200", PART),
        Row("sec. 5", "radius, period, duration, pose, gain, DH table, damping", "not given", None, "circle A: " + ", ".join(f"{k} {v}" for k, v in GOLD["tasks"]["A"].items() if k in ("radius", "period", "plane")) + "; rows of urdf/pa10", MEASURED),
    ]


def runs() -> list[Row]:
    robot, rows = pa10(), []
    for run in GOLD["runs"]:
        method = {"trap": "trapezoidal", "am4": "abm4"}.get(run["method"], run["method"])
        found = dp.track(
            robot,
            circle(run["task"]),
            method=method,
            dt=run["dt"],
            t_end=run["t_end"],
            gain=run["K"],
            startup=run["startup"],
        )
        what = f"circle {run['task']}, {NAMES.get(method, method)}, dt {run['dt']} s, K {run['K']}: joint angles at the end"
        rows.append(
            Row("sec. 5, runs", what, "", None, found.q[-1], MEASURED, np.array(run["q_end"], dtype=float), tol=1e-9, note="against an independent simulation")
        )
    return rows


def table() -> str:
    lines = [
        "## Circle A in open loop, six turns",
        "",
        "Peak position error in m; Euler at 1 s leaves the joint limits: joint 4 from 6 s on, others from 47 s on.",
        "",
        "| dt in s | " + " | ".join(NAMES.values()) + " |",
        "|---|---|---|---|---|",
    ]
    for dt in (0.01, 0.1, 1.0):
        lines.append(f"| {dt} | " + " | ".join(f"{tracked('A', m, dt).position_error.max():.1e}" for m in NAMES) + " |")
    return "\n".join(lines)


def clock() -> dict[str, tuple[float, float, float]]:
    """Evaluations a step, and seconds of 500 steps compiled and with NumPy's calls: the least of five and of two."""
    found = {}
    for m in NAMES:
        times = []
        for engine, repeats in (("auto", 5), ("numpy", 2)):
            best = np.inf
            for _ in range(repeats):
                start = time.perf_counter()
                run = dp.track(pa10(), circle("A"), method=m, dt=0.02, t_end=10.0, engine=engine)
                best = min(best, time.perf_counter() - start)
            times.append(best)
        found[m] = (run.cost.evaluations / 500, *times)
    return found


def costs(found: dict[str, tuple[float, float, float]] | None = None) -> str:
    found = found or clock()
    lines = ["## Fig 4: cost of 500 steps on circle A", "", "Seconds are those of this run, the least of several.", ""]
    lines += ["| method | pseudo-inverses a step | compiled, s | NumPy, s |", "|---|---|---|---|"]
    lines += [f"| {NAMES[m]} | {n:.2f} | {a:.3f} | {b:.3f} |" for m, (n, a, b) in found.items()]
    return "\n".join(lines)


def page() -> Page:
    return Page(
        "sariyildiz",
        "Integrators for redundant arms: the PA-10",
        "E. Sariyildiz, H. Temeltas: A comparison study of the numerical integration methods in the trajectory tracking application "
        "of redundant robot manipulators. ELECO 2011, II-420 to II-424.",
        "The paper prints formulas and curves, and no numbers: its curves cannot be set beside ours digit by digit. The PA-10 has "
        "the lengths of public sources; reference runs are an independent simulation. Docs: [The five papers: integrators](../../docs/papers/sariyildiz.md).",
        [*methods(), *claims(), *runs()],
        {
            "pa10_times.svg": "Cost of a run: pseudo-inverses a step, and seconds of 500 steps, compiled and with NumPy (Fig 4).",
            "pa10_errors.svg": "Circle A in open loop, six turns: position and orientation errors of the four methods at 100 ms and 10 ms (Figs 5 to 8).",
            "pa10_errors_1s.svg": "The same at 1 s (Figs 9 and 10); shaded: where Euler's joints are outside of their limits.",
        },
        "Simulink's diagrams (Figs 1 and 2) and the processor of 2011; the curves' own data, which are not given.",
        [table(), costs()],
    )
