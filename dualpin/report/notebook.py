"""What notebooks show: robots, tables and reports as small HTML tables (no Jinja needed)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from .matrix import Matrix, short

if TYPE_CHECKING:
    from ..crosscheck.results import Report
    from ..forms.table import DHTable
    from ..model.robot import Robot

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
    head = ["joint", "kind", "theta [rad]", "d [m]", "a [m]", "alpha [rad]"]
    rows = [
        (r.joint or "fixed", r.letter, *(f"{x:.10g}" for x in (r.theta, r.d, r.a, r.alpha))) for r in table.rows
    ]  # fmt: skip
    caption = f"{table.convention} Denavit-Hartenberg table"
    return table_html(head, rows, caption, table.notes)


def report_html(report: Report) -> str:
    """The verdict and the worst terms of a validation.

    Examples
    --------
    >>> import dualpin as dp
    >>> "passed" in dp.validate("ur5", samples=2, terms=["fk"])._repr_html_()
    True
    """
    view = Matrix(report)
    caption = f"{view.verdict}: {report.summary}; {'; '.join(view.settings)}, against Pinocchio"
    notes = [f"refused: {f.name}: {f.reason}" for f in report.refused]
    if len(view.robots) == 1:
        notes += [report.robots[0].remark] * bool(report.robots[0].reason)
        rows = [
            (c.term, c.text, short(c.result.tolerance) if c.result.compared else "–", c.result.verdict, c.result.remark)
            for c in view.robots[0].cells
            if c.result
        ]
        return table_html(
            ["term", "max scaled error", "tolerance", "verdict", "remark"],
            rows,
            f"{view.robots[0].result.label}, {caption}",
            notes,
        )
    summary = [
        (r.result.label, r.result.nv, r.worst.text if r.worst else "–", r.worst.term if r.worst else "–",
         r.result.verdict, r.result.remark)
        for r in sorted(view.robots, key=lambda r: r.result.passed)
    ]  # fmt: skip
    return table_html(["robot", "nv", "worst scaled error", "in", "verdict", "remark"], summary, caption, notes)
