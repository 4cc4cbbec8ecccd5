"""Drawings of results by Matplotlib: what `.plot()` of tables, trajectories and results does.

Every function draws into the axes it is given, or into new ones of pyplot's, and returns them.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ArgumentError
from ..extras import extra
from ..files import writing

if TYPE_CHECKING:
    from ..crosscheck.results import Report
    from ..forms.screws import Screws
    from ..forms.table import DHTable
    from ..tracking import IKResult, SimulationResult, TrackingResult, Trajectory
    from ..tracking.study import IntegratorStudy
    from .changes import Comparison

POINTS = 600  # of a curve: more are not seen
MEMBERS = 12  # of a batch that are drawn
LEAST = 1e-17  # drawn instead of an error of 0 on a logarithmic axis
ENDINGS = (".png", ".svg", ".pdf")


def dh_table(table: DHTable, q: Any = None, axes: Any = None) -> Any:
    """The frames of a table at a configuration of the whole robot (zero by default), in the base link's frame."""
    whole = table.chain.robot if table.chain else table.robot
    q = whole.neutral if q is None else np.asarray(q, dtype=float)
    base = table.base.matrix
    frames = [base, *table.frames(q, engine="numpy"), table.fk(q, engine="numpy")]
    axes = _space(axes)
    places = np.array([T[:3, 3] for T in frames])
    axes.plot(*places.T, color="0.6", linewidth=3, solid_capstyle="round", zorder=0)
    size = 0.12 * max(float(np.ptp(places, axis=0).max()), 1e-3)
    for k, T in enumerate(frames):
        for column, colour in enumerate(("tab:red", "tab:green", "tab:blue")):
            axes.plot(*np.array([T[:3, 3], T[:3, 3] + size * T[:3, column]]).T, color=colour, linewidth=1.6)
        name = "tool" if k == len(frames) - 1 else str(k)
        axes.text(*(T[:3, 3] + 1.2 * size * T[:3, 2]), name, fontsize=8)
    axes.set_title(f"{table.name}, {table.convention} Denavit-Hartenberg frames")
    return _proportional(axes, places, size)


def screws(found: Screws, axes: Any = None) -> Any:
    """The axes of the screws at home, in the base link's frame, with the tip."""
    S = found.Slist.T
    axes = _space(axes)
    tip = found.home[:3, 3]
    turning = [(s, np.linalg.norm(s[:3])) for s in S]
    places = np.array([np.cross(s[:3], s[3:]) / n**2 if n else tip for s, n in turning] + [tip, np.zeros(3)])
    size = 0.25 * max(float(np.ptp(places, axis=0).max()), 1e-3)
    for (s, n), p, name in zip(turning, places[:-2], found.joint_names, strict=True):
        u = (s[:3] if n else s[3:]) / (n or np.linalg.norm(s[3:]) or 1.0)
        axes.plot(*np.array([p - size * u, p + size * u]).T, "-" if n else "--", label=name)
    axes.plot(*tip[:, None], "k^", label="tip")
    axes.set_title(f"{found.chain.robot.name}: screws at home")
    axes.legend(fontsize=7)
    return _proportional(axes, places, size)


def trajectory(path: Trajectory, T0: Any = None, axes: Any = None) -> Any:
    """The path of the frame over its duration, from a pose (the identity by default)."""
    start = np.eye(4) if T0 is None else np.asarray(T0, dtype=float)
    t = np.linspace(0.0, path.duration, 200)
    pose, _ = path.at(start)(t)
    places = pose.reshape(-1, 4, 4)[:, :3, 3]
    axes = _space(axes)
    axes.plot(*pose[..., :3, 3].reshape(len(t), -1, 3)[:, 0].T, label=type(path).__name__)
    axes.plot(*places[0][:, None], "o", label="start")
    axes.set_title(f"{type(path).__name__} over {path.duration:g} s")
    axes.legend()
    return _proportional(axes, places, 0.05 * max(float(np.ptp(places, axis=0).max()), 1e-3))


def tracking(run: TrackingResult, axes: Any = None) -> Any:
    """Position and orientation error over time."""
    axes = _plane(axes)
    k = _thinned(len(run.t))
    for errors, name, style in ((run.position_error, "position [m]", "-"), (run.orientation_error, "turn [rad]", "--")):
        rows = np.reshape(errors, (-1, errors.shape[-1]))[:MEMBERS]
        for i, row in enumerate(rows):
            if np.any(row > 0):
                axes.plot(run.t[k], np.maximum(row[k], LEAST), style, label=name if i == 0 else None)
    axes.set(xlabel="time [s]", ylabel="error", yscale="log", title=f"{run.method.name}: tracking errors")
    return _legend(axes)


def simulation(run: SimulationResult, axes: Any = None) -> Any:
    """Coordinates, and energy, over time: two axes."""
    upper, lower = _two(axes)
    k = _thinned(len(run.t))
    q = run.q.reshape(-1, *run.q.shape[-2:])[0]
    for i, x in enumerate(q[k].T):
        upper.plot(run.t[k], x, label=f"q[{i}]" if q.shape[-1] <= MEMBERS else None)
    energy, loss = (x.reshape(-1, x.shape[-1])[0][k] for x in (run.energy, run.energy_loss))
    lower.plot(run.t[k], energy, label="energy")
    if np.any(loss):
        lower.plot(run.t[k], energy + loss, "--", label="energy and losses")
    upper.set(xlabel="time [s]", ylabel="q [rad, m]", title=f"{run.method.name}: coordinates")
    lower.set(xlabel="time [s]", ylabel="energy [J]", title=f"drift {run.energy_drift:.2g} J")
    return np.array([_legend(upper), _legend(lower)])


def solved(found: IKResult, axes: Any = None) -> Any:
    """The remaining error of each target, reached and not reached ones in two series."""
    axes = _plane(axes)
    error = np.maximum(np.linalg.norm(found.error, axis=-1).ravel(), LEAST)
    reached = np.asarray(found.success).ravel()
    for mask, name, mark in ((reached, "reached", "o"), (~reached, "not reached", "x")):
        if mask.any():
            axes.plot(np.flatnonzero(mask), error[mask], mark, label=name)
    axes.set(xlabel="target", ylabel="error [rad, m]", yscale="log", title=f"{reached.sum()} of {reached.size} reached")
    return _legend(axes)


def integrators(study: IntegratorStudy, axes: Any = None) -> Any:
    """Peak error of every run against evaluations and against time: two axes."""
    left, right = _two(axes)
    gains = list(dict.fromkeys(r.gain for r in study))
    methods = list(dict.fromkeys(r.method for r in study))
    for ax, cost, label in ((left, "evaluations", "evaluations"), (right, "seconds", "time [s]")):
        for i, gain in enumerate(gains):
            for k, method in enumerate(methods):
                runs = [r for r in study if r.method == method and r.gain == gain]
                points = np.array([(getattr(r, cost), max(r.position_peak, LEAST)) for r in runs], dtype=float)
                points = points[np.isfinite(points).all(axis=1)]
                if len(points):
                    points = points[np.argsort(points[:, 0])]
                    name = f"{method}, K = {gain:g}" if len(gains) > 1 else method
                    ax.loglog(*points.T, ("o-", "s--", "^:", "v-.")[i % 4], color=f"C{k % 10}", label=name)
        ax.set(xlabel=label, ylabel="peak position error [m]")
    left.legend(fontsize=7)
    if study.settings:
        s = study.settings
        left.set_title(f"{s['robot']}: {s['frame']}, r = {s['radius']:g} m, {s['plane']}", fontsize=9)
    return np.array([left, right])


def validation(report: Report, axes: Any = None) -> Any:
    """The largest error of every term over its tolerance: a dot a robot."""
    from .matrix import Matrix

    axes, view = _plane(axes), Matrix(report)
    terms = [t for t in view.terms if view.worst_of(t)]
    for y, term in enumerate(terms):
        ratios = [
            max(c.ratio or 0.0, 1e-6) for r in view.robots for c in r.cells if c.term == term and c.ratio is not None
        ]
        axes.semilogx(ratios, [y] * len(ratios), "o", color="C0", alpha=0.6)
    axes.axvline(1.0, color="tab:red", linestyle="--")
    axes.set_yticks(range(len(terms)), terms, fontsize=8)
    axes.set(xlabel="error / tolerance", title=f"{view.verdict}: {report.headline}")
    axes.invert_yaxis()
    return axes


def comparison(found: Comparison, axes: Any = None) -> Any:
    """By which factor figures changed; those that are worse in red."""
    axes = _plane(axes)
    changed = [c for c in found.changes if c.factor != 1.0][:40]
    axes.barh([c.where for c in changed], [np.log10(max(c.factor, 1e-12)) for c in changed],
              color=["tab:red" if c.worse else "tab:green" if c.factor < 1 else "0.6" for c in changed])  # fmt: skip
    axes.axvline(0.0, color="0.4", linewidth=0.8)
    axes.invert_yaxis()
    verdict = "nothing got worse" if found.passed else f"{len(found.worse)} got worse"
    axes.set(xlabel="log10 (new / old)", title=f"{verdict}; {found.compared} figures compared")
    return axes


def save(of: Any, path: str | PathLike[str]) -> None:
    """The drawing of anything that has `.plot(axes=)` or is drawn by one of these functions, as a file."""
    path = Path(path)
    if path.suffix.lower() not in ENDINGS:
        raise ArgumentError(f"plot: {path} ends in {path.suffix!r}; {', '.join(ENDINGS)} expected")
    figure = drawn(of)
    with writing(f"plot: cannot write {path}"):
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)


def drawn(of: Any, size: tuple[float, float] = (9.0, 3.6)) -> Any:
    """A figure outside pyplot, so that none stays open."""
    figure = extra("matplotlib.figure", "figures", "plot").Figure(figsize=size, layout="constrained")
    two = type(of).__name__ in ("IntegratorStudy", "SimulationResult")
    of.plot(axes=figure.subplots(1, 2) if two else figure.subplots())
    return figure


# axes


def _plane(axes: Any) -> Any:
    return (
        extra("matplotlib.pyplot", "figures", "plot").figure(layout="constrained").subplots() if axes is None else axes
    )


def _two(axes: Any) -> Sequence[Any]:
    if axes is None:
        figure = extra("matplotlib.pyplot", "figures", "plot").figure(figsize=(9.0, 3.6), layout="constrained")
        return list(figure.subplots(1, 2))
    both = list(np.ravel(np.asarray(axes, dtype=object)))
    if len(both) != 2:
        raise ArgumentError(f"plot: two axes expected, as plt.subplots(1, 2) makes, got {len(both)}")
    return both


def _space(axes: Any) -> Any:
    if axes is None:
        return extra("matplotlib.pyplot", "figures", "plot").figure(layout="constrained").add_subplot(projection="3d")
    if not hasattr(axes, "get_zlim"):
        raise ArgumentError("plot: axes in space expected, as figure.add_subplot(projection='3d') makes")
    return axes


def _proportional(axes: Any, places: np.ndarray, margin: float) -> Any:
    """Equal scales, everything inside."""
    low, high = places.min(axis=0) - margin, places.max(axis=0) + margin
    half = max(float((high - low).max()) / 2, 1e-3)
    for middle, limits in zip((low + high) / 2, (axes.set_xlim, axes.set_ylim, axes.set_zlim), strict=True):
        limits(middle - half, middle + half)
    axes.set_box_aspect((1, 1, 1))
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    return axes


def _legend(axes: Any) -> Any:
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)
    return axes


def _thinned(n: int) -> np.ndarray:
    """Indices of a curve's points that are drawn, the ends among them."""
    return np.unique(np.linspace(0, n - 1, min(n, POINTS)).round().astype(int))


__all__ = [
    "comparison", "dh_table", "drawn", "integrators", "save", "screws", "simulation", "solved", "tracking",
    "trajectory", "validation",
]  # fmt: skip
