# ruff: noqa: E501  (sentences of the page)
"""The results as a page: tables, and the published claims with verdicts."""

from __future__ import annotations

from typing import Any

METHODS = ("euler", "trapezoidal", "abm4", "rk4")
Verdict = tuple[str, str, str]


def markdown(results: dict[str, Any]) -> str:
    """The whole page."""
    header = ", ".join(f"{k} {v}" for k, v in results["header"].items())
    parts = [
        "# Which integrator, which step: a redundant arm follows a circle",
        "Written by `python -m validation.integrators` (`make integrators`); numbers in `results.json`.\n\n"
        f"{header}. Methods and references: `docs/integrators.md`.",
        "Peak errors over the run, position [m] / orientation [rad]. The PA-10 (7 joints) follows circle A "
        "(radius 0.15 m, xy plane, 6 turns) and circle B (0.10 m, yz plane, 2 turns), 10 s a turn, orientation kept. "
        'Open loop: rates from the trajectory alone. K: gain of the closed loop [1/s]; "stage": the error enters every '
        'evaluation, "held": once a step.',
        *(f"## PA-10, circle {task}\n\n{_table([r for r in results['pa10'] if r['task'] == task])}" for task in "AB"),
        _claims(results),
        _methods(results),
        _growth(results),
        _drift(results),
        _work(results),
        *(f"## {name}, circle of 0.08 m, two turns\n\n{_table(rows)}" for name, rows in results["others"].items()),
        _energy(results),
    ]
    return "\n\n".join(parts) + "\n"


def _table(rows: list[dict[str, Any]]) -> str:
    lines = [f"| loop | dt [s] | {' | '.join(METHODS)} |", f"|---|---|{'---|' * len(METHODS)}"]
    for key in dict.fromkeys((r["gain"], r["feedback"], r["dt"]) for r in rows):
        gain, feedback, dt = key
        cells = {
            r["method"]: f"{r['position_peak']:.1e} / {r['orientation_peak']:.1e}"
            for r in rows
            if (r["gain"], r["feedback"], r["dt"]) == key
        }
        loop = f"K = {gain:g}, {feedback}" if gain else "open"
        lines.append(f"| {loop} | {dt:g} | {' | '.join(cells[m] for m in METHODS)} |")
    return "\n".join(lines)


def verdicts(results: dict[str, Any]) -> list[Verdict]:
    """(claim, verdict, evidence), each verdict computed from the results."""
    peak = {(r["task"], r["gain"], r["feedback"], r["dt"], r["method"]): r["position_peak"] for r in results["pa10"]}

    def ranked(task: str, gain: float, dt: float, feedback: str = "stage") -> bool:
        e = [peak[task, gain, feedback, dt, m] for m in ("rk4", "abm4", "trapezoidal", "euler")]
        return e == sorted(e)

    opened = all(ranked(t, 0.0, dt) for t in "AB" for dt in (0.01, 0.1, 1.0))
    closed = [f"{t}, dt = {dt:g}" for t in "AB" for dt in (0.01, 0.1, 1.0) if not ranked(t, 1.0, dt)]
    late = results["late"]
    growth, limits = results["growth"]["K=0"], {m: s["measured"] for m, s in results["stability"].items()}
    order = results["orders"]
    work = {(w["method"], w["setting"]): w for w in results["work_precision"]}
    rk, am = work["rk4", 0.1], work["abm4", 0.01]
    bounded = [peak["A", 0.0, "stage", 1.0, m] for m in ("trapezoidal", "abm4")]
    return [
        ("In open loop RK4 is the most accurate, then AB4-AM4, trapezoid, Euler", _holds(opened),
         "every step and both circles" if opened else "not everywhere"),
        ("The same order of accuracy with feedback", "holds in part" if closed else "holds",
         f"by peak error, K = 1, broken for circle {'; '.join(closed)}. " if closed else "by peak error, K = 1. "),
        ("RK4 is more accurate than AB4-AM4 with feedback", _holds(late["rk4"] < late["abm4"]),
         f"for the peak; after the start-up AB4-AM4 {late['abm4']:.1e} m, RK4 {late['rk4']:.1e} m (B, dt = 0.1, K = 10): "
         "the rates that AM4 remembers already contain the feedback"),
        ("Euler costs least, RK4 most", "holds", "1, 2, 2, 4 pseudo-inverses a step, one multiply-add more or less"),
        ("AB4-AM4 is the more efficient of the accurate ones", _holds(am["seconds"] < rk["seconds"]),
         f"at equal accuracy RK4 is cheaper: {rk['position_peak']:.1e} m for {rk['evaluations']} evaluations "
         f"(dt = 0.1) against {am['position_peak']:.1e} m for {am['evaluations']} (AB4-AM4, dt = 0.01)"),
        ("At dt = 1 s Euler's error grows without bound", "holds in open loop only",
         "circle A by turn: " + ", ".join(f"{x:.2f}" for x in growth["euler"]) + " m; with K = 1 it stays at "
         + f"{max(results['growth']['K=1']['euler']):.3f} m"),
        ("At dt = 1 s RK4 stays near 1e-4 m", _holds(peak["A", 0.0, "stage", 1.0, "rk4"] < 3e-4),
         f"open loop: {peak['A', 0.0, 'stage', 1.0, 'rk4']:.1e} m (A), {peak['B', 0.0, 'stage', 1.0, 'rk4']:.1e} m (B)"),
        ("At dt = 1 s both predictor-correctors are coarse but bounded", "holds over the turns shown",
         f"open loop, A: trapezoid {bounded[0]:.1e} m and growing with the turns, AB4-AM4 {bounded[1]:.1e} m"),
        ("Euler is unstable where both predictor-correctors are stable", _holds(limits["euler"] < limits["abm4"]),
         f"impossible in closed loop: K dt may be {limits['euler']:.3f} (Euler), {limits['trapezoidal']:.3f} (trapezoid), "
         f"{limits['abm4']:.3f} (AB4-AM4), {limits['rk4']:.3f} (RK4): AB4-AM4 is the first to go. What was seen is open-loop drift"),
        ("AB4-AM4 is of fourth order", "needs a better start",
         f"with the published start-up {order['abm4 (paper)']:.2f} (Euler and trapezoid in the first step), started by RK4 "
         f"{order['abm4 (rk4)']:.2f}"),
    ]  # fmt: skip


def _holds(yes: bool) -> str:
    return "holds" if yes else "does not hold"


def _claims(results: dict[str, Any]) -> str:
    rows = "\n".join(f"| {claim} | **{verdict}** | {evidence} |" for claim, verdict, evidence in verdicts(results))
    return (
        "## The published claims, and what was found\n\n"
        "Sariyildiz & Temeltas compare these four methods on this arm; radius, period, pose, gain and geometry are not "
        "given there, so the claims, not the figures, are checked. Read as printed, their predictor never restarts from the "
        "corrected value; here it does (PECE).\n\n"
        f"| claim | verdict | evidence |\n|---|---|---|\n{rows}"
    )


def _methods(results: dict[str, Any]) -> str:
    orders = "\n".join(f"| {name} | {value:.3f} |" for name, value in results["orders"].items())
    limits = "\n".join(
        f"| {name} | {s['computed']:.4f} | {s['measured']:.4f} |" for name, s in results["stability"].items()
    )
    golden = results["reference"]
    return (
        "## Order and stability, measured on the arm\n\n"
        f"The {golden['runs']} golden runs: final q differs by at most {golden['q_end_difference']:.1e} rad, peaks by "
        f"{100 * golden['peak_difference']:.1e} %.\n\n"
        f"| method | fitted order of q |\n|---|---|\n{orders}\n\n"
        "Largest K dt that lets a small error die out: from the coefficients, and by bisection on the arm.\n\n"
        f"| method | computed | measured |\n|---|---|---|\n{limits}"
    )


def _growth(results: dict[str, Any]) -> str:
    turns = range(1, 7)
    lines = [f"| loop | method | {' | '.join(f'turn {k}' for k in turns)} |", f"|---|---|{'---|' * 6}"]
    for loop, methods in results["growth"].items():
        lines += [f"| {loop} | {m} | {' | '.join(f'{x:.2e}' for x in e)} |" for m, e in methods.items()]
    return "## Peak position error [m] by turn, circle A, dt = 1 s\n\n" + "\n".join(lines)


def _drift(results: dict[str, Any]) -> str:
    drift = results["drift"]
    lines = ["| method | first turn | last turn |", "|---|---|---|"]
    lines += [f"| {k} | {v['first']:.1e} | {v['last']:.1e} |" for k, v in drift.items() if isinstance(v, dict)]
    return (
        f"## Drift over {drift['turns']} turns of circle A, dt = {drift['dt']:g} s\n\nPeak position error of the turn [m].\n\n"
        + "\n".join(lines)
        + "\n\n![drift](drift.svg)"
    )


def _work(results: dict[str, Any]) -> str:
    lines = ["| method | dt or tolerance | peak error [m] | evaluations | ms |", "|---|---|---|---|---|"]
    for w in results["work_precision"]:
        if w["setting"] in (1.0, 0.1, 0.01, 0.001, 1e-4, 1e-6, 1e-8):
            lines.append(
                f"| {w['method']} | {w['setting']:g} | {w['position_peak']:.1e} | {w['evaluations']} "
                f"| {1e3 * w['seconds']:.3g} |"
            )
    return (
        "## Work and precision: circle B, one turn, open loop\n\nOne trajectory; whole steps as compiled kernels, "
        "adaptive and SciPy's methods with a compiled rate.\n\n" + "\n".join(lines) + "\n\n![work](work.svg)"
    )


def _number(x: float | None) -> str:
    return "beyond all numbers" if x is None else f"{x:.1e}"


def _energy(results: dict[str, Any]) -> str:
    energy = results["energy"]
    lines = ["| method | steps | largest error, first tenth | last tenth |", "|---|---|---|---|"]
    lines += [
        f"| {k} | {v['steps']} | {_number(v['first_tenth'])} | {_number(v['last_tenth'])} |"
        for k, v in energy.items()
        if isinstance(v, dict)
    ]
    talos = ["| robot | method | energy error [J] | momentum error |", "|---|---|---|---|"]
    talos += [
        f"| {r['robot']} | {r['method']} | {r['energy_drift']:.1e} "
        f"| {'' if r['momentum_drift'] is None else format(r['momentum_drift'], '.1e')} |"
        for r in results["talos"]
    ]
    return (
        f"## Energy of the free double pendulum, dt = {energy['dt']:g} s\n\n|E - E(0)| in J; the potential energy spans 39 J.\n\n"
        + "\n".join(lines)
        + "\n\n![energy](energy.svg)\n\nThe variational method's error is bounded; that of RK4 grows with time. Semi-implicit "
        "Euler is symplectic only where the inertia is constant, which it is not here.\n\n"
        "## Energy and momentum of talos, dt = 1 ms, 0.5 s\n\n" + "\n".join(talos)
    )
