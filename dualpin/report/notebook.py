"""Representations in notebooks: robots, tables and reports as small HTML tables (no Jinja needed)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from html import escape
from io import StringIO
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import DualpinError
from ..forms.export import caption, display, residual_line
from ..forms.text import tidy
from ..tracking.study import remarks
from .figures import drawn
from .matrix import Matrix, short

if TYPE_CHECKING:
    from ..analysis.workspace.reach import ReachMap
    from ..crosscheck.results import Report
    from ..forms.screws import Screws
    from ..forms.table import DHTable
    from ..model.robot import Robot
    from ..tracking import IKResult, SimulationResult, TrackingResult
    from ..tracking.study import IntegratorStudy
    from .changes import Comparison

MOST = 60  # rows a notebook shows before it says how many are left out


def table_html(head: Sequence[str], rows: Iterable[Sequence[Any]], caption: str = "", notes: Sequence[str] = ()) -> str:
    """A table with escaped cells, cut after `MOST` rows, with its caption above and remarks below.

    Examples
    --------
    >>> from dualpin.report.notebook import table_html
    >>> print(table_html(["joint"], [["<a>"]]))
    <table><thead><tr><th>joint</th></tr></thead><tbody><tr><td>&lt;a&gt;</td></tr></tbody></table>
    """
    rows = list(rows)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(x))}</td>" for x in row) + "</tr>" for row in rows[:MOST])
    left = [f"{len(rows) - MOST} more rows"] if len(rows) > MOST else []
    below = "".join(f"<li>{escape(n)}</li>" for n in [*left, *notes])
    top = "".join(f"<th>{escape(h)}</th>" for h in head)
    return (
        (f"<p><b>{escape(caption)}</b></p>" if caption else "")
        + f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
        + (f"<ul>{below}</ul>" if below else "")
    )


def robot_html(robot: Robot) -> str:
    """The tree of a robot, the order of q and v, limits, and what was assumed.

    Examples
    --------
    >>> import dualpin as dp
    >>> "<td>elbow_joint</td>" in dp.load("ur5")._repr_html_()
    True
    """
    from ..model.describe import rows

    head, *body = rows(robot)
    caption = f"{robot.name}: nq = {robot.nq}, nv = {robot.nv}, {len(robot.links)} links, {robot.mass:.6g} kg"
    return table_html(head, body, caption, robot.notes)


def dh_html(table: DHTable) -> str:
    """A Denavit-Hartenberg table.

    Examples
    --------
    >>> import dualpin as dp
    >>> "<td>shoulder_pan_joint</td>" in dp.to_dh(dp.load("ur5"), tip="tool0")._repr_html_()
    True
    """
    head = ["row", "joint", "kind", "theta [rad]", "d [m]", "a [m]", "alpha [rad]"]
    return table_html(head, display(table), caption(table), [residual_line(table), *table.notes])


def drawing(of: Any, size: tuple[float, float] = (9.0, 3.6)) -> str:
    """The drawing of a result as SVG, or what is needed to have one."""
    return _svg(lambda: drawn(of, size))


def _svg(figured: Callable[[], Any]) -> str:
    try:
        figure = figured()
    except DualpinError as e:
        return f"<p>{escape(str(e))}</p>"
    text = StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return f'<div style="max-width:60rem;background:#fff">{svg[svg.index("<svg") :]}</div>'


def tracking_html(run: TrackingResult) -> str:
    """The errors of a followed trajectory over time, their peaks, the cost, and what is to be said.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> path = dp.Circle(0.02, 1.0, start=[0.0, -1.2, 1.4, -0.4, -1.5, 0.0])
    >>> "evaluations" in dp.track(dp.load("ur5"), path, frame="tool0", dt=0.1, t_end=1.0)._repr_html_()
    True
    """
    peaks = [f"{float(np.max(e, initial=0.0)):.3g}" for e in (run.position_error, run.orientation_error)]
    row = (run.method.name, run.q.shape, *peaks, run.cost.evaluations, f"{run.cost.seconds:.3g}")
    head = ["method", "q", "position error up to [m]", "turn up to [rad]", "evaluations", "seconds"]
    return table_html(head, [row], "Tracking", run.warnings) + drawing(run)


def simulation_html(run: SimulationResult) -> str:
    """Coordinates and energy over time, drifts and cost."""
    row = (run.method.name, run.q.shape, f"{run.t[-1]:.6g}", f"{run.energy_drift:.3g}", f"{run.momentum_drift:.3g}",
           run.cost.evaluations, f"{run.cost.seconds:.3g}")  # fmt: skip
    head = ["method", "q", "to t [s]", "energy drift [J]", "momentum drift", "evaluations", "seconds"]
    return table_html(head, [row], "Simulation", run.notes) + drawing(run)


def ik_html(found: IKResult) -> str:
    """How many targets were reached, and the remaining errors of the others."""
    lacking = np.linalg.norm(found.error, axis=-1)
    row = (found.q.shape, f"{int(found.success.sum())} of {found.success.size}", f"{np.max(lacking, initial=0.0):.3g}",
           int(np.max(found.starts, initial=0)), f"{found.cost.seconds:.3g}")  # fmt: skip
    head = ["q", "reached", "largest error [rad, m]", "starts up to", "seconds"]
    return table_html(head, [row], "Inverse kinematics", found.notes) + (drawing(found) if found.success.size else "")


def integrators_html(study: IntegratorStudy) -> str:
    """A study of integrators: its rows and its drawing."""
    head = ["method", "dt", "K", "position peak [m]", "turn peak [rad]", "evaluations", "seconds"]
    rows = [(r.method, r.dt, r.gain, f"{r.position_peak:.3g}", f"{r.orientation_peak:.3g}", r.evaluations,
             f"{r.seconds:.3g}") for r in study]  # fmt: skip
    title = study.title if study.settings else "Integrators"
    return table_html(head, rows, title, remarks(study)) + (drawing(study) if study else "")


def comparison_html(found: Comparison) -> str:
    """What changed between two results, the worst first."""
    rows = [("worse" if c.worse else "better" if c.factor < 1 else "changed", c.what, c.where, c.old, c.new)
            for c in found.changes]  # fmt: skip
    verdict = "Nothing got worse" if found.passed else f"{len(found.worse)} got worse"
    notes = [f"{name}: {old} -> {new}" for name, old, new in found.versions]
    html = table_html(["", "what", "where", "old", "new"], rows, f"{verdict}; {found.compared} figures compared", notes)
    return html + (drawing(found) if any(c.factor != 1.0 for c in found.changes) else "")


def workspace_html(found: ReachMap) -> str:
    """Where a frame can be: volume, index, and slices."""
    row = (found.frame.name, f"{found.volume:.3g}", f"{found.cell:.3g}", f"{found.mean:.3f}", found.samples,
           f"{found.coverage:.3f}")  # fmt: skip
    head = ["frame", "volume [m^3]", "cell [m]", "mean index", "samples", "coverage"]
    return table_html(head, [row], f"{found.robot.name}: workspace") + _svg(found.plot)


def screws_html(found: Screws) -> str:
    """Home pose and screws."""
    head = ["joint", "wx", "wy", "wz", "vx", "vy", "vz"]
    rows = [(name, *(tidy(x) for x in s)) for name, s in zip(found.joint_names, found.screws, strict=True)]
    rows.extend((f"home, row {k + 1}", *(tidy(x) for x in row), "", "") for k, row in enumerate(found.home))
    return table_html(head, rows, f"{found.chain.robot.name}: screws in the {found.frame} frame")


def report_html(report: Report) -> str:
    """The verdict and the worst terms of a validation.

    Examples
    --------
    >>> import dualpin as dp
    >>> "passed" in dp.validate("ur5", samples=2, terms=["fk"])._repr_html_()
    True
    """
    view = Matrix(report)
    caption = f"{view.verdict}: {report.headline}; {'; '.join(view.settings)}, against Pinocchio"
    notes = [f"refused: {f.name}: {f.reason}" for f in report.refused]
    if len(view.robots) == 1:
        notes += [report.robots[0].remark] * bool(report.robots[0].reason)
        rows = [
            (c.term, c.text, short(c.result.tolerance) if c.result.compared else "–", c.result.verdict, c.result.remark)
            for c in view.robots[0].cells
            if c.result
        ]
        html = table_html(
            ["term", "max scaled error", "tolerance", "verdict", "remark"],
            rows,
            f"{view.robots[0].result.label}, {caption}",
            notes,
        )
        return html + _drawn_report(report)
    summary = [
        (r.result.label, r.result.nv, r.worst.text if r.worst else "–", r.worst.term if r.worst else "–",
         r.result.verdict, r.result.remark)
        for r in sorted(view.robots, key=lambda r: r.result.passed)
    ]  # fmt: skip
    html = table_html(["robot", "nv", "worst scaled error", "in", "verdict", "remark"], summary, caption, notes)
    return html + _drawn_report(report)


def _drawn_report(report: Report) -> str:
    terms = {name for r in report.robots for name, t in r.terms.items() if t.compared}
    return drawing(report, (7.0, 1.0 + 0.22 * len(terms))) if terms else ""
