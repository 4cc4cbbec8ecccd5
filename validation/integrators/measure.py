"""What the study measures: plain data, ready for JSON."""

from __future__ import annotations

import json
import platform
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import dualpin as dp
from dualpin.machine import package, processor
from dualpin.model import Builder, Robot, revolute
from dualpin.spatial import UY, Inertia, Pose, Vector3, diagonal
from dualpin.tracking.study import METHODS, measured_stability_limit, pa10, run, seven_joint_arm

CIRCLES = {
    "A": {"radius": 0.15, "period": 10.0, "plane": "xy", "start": [0, 45, 0, 90, 0, -45, 0], "turns": 6},
    "B": {"radius": 0.10, "period": 10.0, "plane": "yz", "start": [0, 30, 0, 60, 0, 60, 0], "turns": 2},
}
STEPS = (0.01, 0.1, 1.0)
WORK_STEPS = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
ORDER_STEPS = {"euler": (100, 200, 400), "rk4": (20, 40, 80)}


def everything(quick: bool, report: Callable[[str], None]) -> dict[str, Any]:
    """All measurements, and whether the methods are what they declare."""
    warnings.simplefilter("ignore", dp.DualpinWarning)
    results: dict[str, Any] = {"header": header()}
    for name, part in (
        ("pa10", pa10_rows), ("reference", reference_runs), ("orders", orders), ("stability", stability),
        ("growth", growth_by_turn), ("late", late_errors), ("work_precision", work_precision), ("others", other_robots),
    ):  # fmt: skip
        report(f"integrators: {name}")
        results[name] = part()
    report("integrators: drift")
    results["drift"] = drift(100 if quick else 1000)
    report("integrators: energy")
    results["energy"] = pendulum_energy(20_000 if quick else 1_000_000)
    results["talos"] = talos_energy()
    declared = {"euler": 1, "trapezoidal": 2, "abm4 (paper)": 3, "abm4 (rk4)": 4, "rk4": 4}
    results["passed"] = bool(
        results["reference"]["q_end_difference"] < 1e-9
        and all(abs(results["orders"][k] - v) <= 0.1 for k, v in declared.items())
        and all(abs(s["measured"] / s["computed"] - 1) < 0.01 for s in results["stability"].values())
    )
    return _finite(results)


def _finite(x: Any) -> Any:
    """Numbers that JSON cannot hold become null."""
    if isinstance(x, dict):
        return {k: _finite(v) for k, v in x.items()}
    if isinstance(x, list):
        return [_finite(v) for v in x]
    return None if isinstance(x, float) and not np.isfinite(x) else x


def header() -> dict[str, str]:
    """Machine and versions."""
    versions = {name: package(name) for name in ("numpy", "scipy", "llvmlite")}
    return {"cpu": processor(), "python": platform.python_version(), "dualpin": dp.__version__, **versions}


def circle(task: str) -> dp.Circle:
    """One of the two circles of the PA-10."""
    c = CIRCLES[task]
    return dp.Circle(c["radius"], c["period"], plane=c["plane"], start=np.radians(c["start"]))


def pa10_rows() -> list[dict[str, Any]]:
    """Both circles, open and closed loop, three steps, four methods."""
    arm, rows = pa10(), []
    for task, c in CIRCLES.items():
        path = {"q0": np.radians(c["start"]), "radius": c["radius"], "plane": c["plane"], "turns": c["turns"]}
        found = run(arm, **path, gains=(0.0, 1.0))
        found += run(arm, **path, gains=(1.0,), feedback="held")
        found += run(arm, **path, gains=(10.0,))
        rows += [{"task": task, **r.as_dict()} for r in found]
    return rows


def reference_runs() -> dict[str, float]:
    """The golden runs of the tests: largest differences of the final q and of the peaks."""
    golden = json.loads((Path(__file__).parents[2] / "tests" / "data" / "reference.json").read_text())["pa10_tracking"]
    q_end, peaks = 0.0, 0.0
    for r in golden["runs"]:
        found = dp.track(pa10(), circle(r["task"]), method=r["method"], dt=r["dt"], t_end=r["t_end"], gain=r["K"],
                         startup=r["startup"])  # fmt: skip
        q_end = max(q_end, float(np.abs(found.q[-1] - np.array(r["q_end"], dtype=float)).max()))
        peaks = max(peaks, abs(found.position_error.max() / r["pos_peak"] - 1))
        peaks = max(peaks, abs(found.orientation_error.max() / r["ori_peak"] - 1))
    return {"runs": len(golden["runs"]), "q_end_difference": q_end, "peak_difference": float(peaks)}


def orders() -> dict[str, float]:
    """Fitted orders of the configuration reached after half a turn of circle B, open loop."""
    path, arm, out = circle("B"), pa10(), {}
    truth = dp.track(arm, path, method="rk4", dt=1 / 200, t_end=5.0).q[-1]
    cases = [(m, "paper") for m in METHODS] + [
        ("abm4", "rk4"),
        ("heun", "paper"),
        ("midpoint", "paper"),
        ("rkmk4", "paper"),
    ]
    for method, startup in cases:
        steps = np.array(ORDER_STEPS["rk4"] if method.endswith("k4") else ORDER_STEPS["euler"])
        errors = [np.abs(dp.track(arm, path, method=method, dt=5.0 / n, t_end=5.0, startup=startup).q[-1] - truth).max()
                  for n in steps]  # fmt: skip
        name = f"{method} ({startup})" if method == "abm4" else method
        out[name] = float(-np.polyfit(np.log(steps), np.log(errors), 1)[0])
    return out


def stability() -> dict[str, dict[str, float]]:
    """Largest K dt: of the coefficients, and measured on the arm."""
    q0 = np.radians(CIRCLES["B"]["start"])
    return {
        m: {"computed": dp.integrators.stability_limit(m), "measured": measured_stability_limit(pa10(), q0, None, m)}
        for m in (*METHODS, "heun", "midpoint", "crouch_grossman3")
    }


def growth_by_turn() -> dict[str, dict[str, list[float]]]:
    """Largest position error of each turn of circle A with dt = 1 s."""
    out: dict[str, dict[str, list[float]]] = {}
    for gain in (0.0, 1.0):
        for method in METHODS:
            e = dp.track(pa10(), circle("A"), method=method, dt=1.0, t_end=60.0, gain=gain).position_error
            out.setdefault(f"K={gain:g}", {})[method] = [float(e[10 * k + 1 : 10 * k + 11].max()) for k in range(6)]
    return out


def late_errors() -> dict[str, float]:
    """Largest position error after the start-up has died out: circle B, dt = 0.1 s, K = 10."""
    return {
        m: float(dp.track(pa10(), circle("B"), method=m, dt=0.1, t_end=20.0, gain=10.0).position_error[150:].max())
        for m in METHODS
    }


def work_precision() -> list[dict[str, Any]]:
    """Error against evaluations and seconds: circle B, one turn, open loop; each run timed as the best of three."""
    arm, path, rows = pa10(), circle("B"), []

    def add(method: str, setting: float, **options: Any) -> None:
        runs = [dp.track(arm, path, method=method, t_end=10.0, **options) for _ in range(3)]
        best = min(runs, key=lambda r: r.cost.seconds)
        rows.append({"method": method, "setting": setting, "position_peak": float(best.position_error.max()),
                     "evaluations": best.cost.evaluations, "seconds": best.cost.seconds})  # fmt: skip

    for method in (*METHODS, "heun", "crouch_grossman3"):
        for dt in WORK_STEPS:
            add(method, dt, dt=dt)
    for method in ("rk45", "DOP853", "LSODA"):
        for rtol in TOLERANCES:
            add(method, rtol, dt=0.5, rtol=rtol, atol=rtol)
    return rows


def drift(turns: int) -> dict[str, Any]:
    """Largest position error of each turn over many turns of circle A, dt = 0.1 s."""
    out: dict[str, Any] = {"turns": turns, "dt": 0.1}
    for gain in (0.0, 1.0):
        for method in METHODS:
            e = dp.track(pa10(), circle("A"), method=method, dt=0.1, t_end=10.0 * turns, gain=gain).position_error
            by_turn = e[1:].reshape(turns, -1).max(axis=1)
            out[f"{method} K={gain:g}"] = {"first": float(by_turn[0]), "last": float(by_turn[-1]),
                                           "by_turn": _thinned(by_turn)}  # fmt: skip
    return out


def _thinned(x: np.ndarray, most: int = 200) -> list[float]:
    return [float(f"{v:.4g}") for v in x[:: max(1, len(x) // most)]]


def other_robots() -> dict[str, list[dict[str, Any]]]:
    """The same comparison on arms read from URDF files, and on one with the iiwa's proportions."""
    arms = {
        "panda": (dp.load("panda"), {"frame": "panda_hand"}),
        "ur5": (dp.load("ur5"), {"frame": "tool0"}),
        "seven_joint_arm": (seven_joint_arm(), {"q0": np.radians([0, 30, 0, -70, 0, 60, 0])}),
    }
    return {name: [r.as_dict() for r in run(arm, radius=0.08, **where)] for name, (arm, where) in arms.items()}


def double_pendulum() -> Robot:
    """Two equal rods in a vertical plane."""
    rod = Inertia(1.0, Vector3(0.5, 0.0, 0.0), diagonal(1.0 / 3.0))
    b = Builder("double_pendulum")
    b.joint("upper", revolute(UY), inertia=rod)
    b.joint("lower", revolute(UY), on="upper", placement=Pose(position=Vector3(1.0, 0.0, 0.0)), inertia=rod)
    return b.robot()


def pendulum_energy(steps: int) -> dict[str, Any]:
    """|E - E_0| of the free double pendulum, dt = 0.02 s; the largest in each thousandth of the run."""
    out: dict[str, Any] = {"steps": steps, "dt": 0.02}
    every = max(1, steps // 10_000)
    short = steps // 10
    for method, n in (("variational", steps), ("semi_implicit_euler", short), ("rk4", steps), ("heun", short)):
        found = dp.simulate(double_pendulum(), [0.4, 0.3], [0.0, 0.0], method=method, dt=0.02, t_end=0.02 * n,
                            every=every)  # fmt: skip
        error = np.abs(found.energy - found.energy[0])[1:]
        pieces = [float(x.max()) for x in np.array_split(error, 200)]
        tenth = len(error) // 10
        by_time = [float(f"{x:.4g}") for x in pieces]
        ends = {"first_tenth": float(error[:tenth].max()), "last_tenth": float(error[-tenth:].max())}
        out[method] = {"steps": n, "by_time": by_time, **ends, "seconds": found.cost.seconds}
    return out


def talos_energy() -> list[dict[str, Any]]:
    """Energy and momentum of talos: hanging from its base, and adrift without gravity."""
    rows = []
    fixed, adrift = dp.load("talos"), dp.load("talos", floating=True).with_gravity([0.0, 0.0, 0.0])
    for robot, kind, methods in (
        (fixed, "fixed base, gravity", ("semi_implicit_euler", "variational", "rk4")),
        (
            adrift,
            "floating, no gravity",
            ("semi_implicit_euler", "euler", "crouch_grossman3", "crouch_grossman4", "rkmk4"),
        ),
    ):
        _, v, _ = robot.sample(seed=0)
        for method in methods:
            found = dp.simulate(robot, robot.neutral, 0.1 * v, method=method, dt=1e-3, t_end=0.5)
            row = {"robot": f"talos, {kind}", "method": method, "dt": 1e-3, "t_end": 0.5}
            row |= {"energy": float(found.energy[0]), "energy_drift": found.energy_drift}
            row |= {"momentum_drift": found.momentum_drift if robot is adrift else None, "seconds": found.cost.seconds}
            rows.append(row)
    return rows
