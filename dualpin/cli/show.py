"""Results as tables on a terminal, as aligned text in pipes."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from ..escape import line
from .out import note

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from ..crosscheck.results import Report, RobotResult, TermResult
    from ..report import Comparison

STYLES = {"agrees": "green", "passed": "bold green", "FAILED": "bold red"}
REMARKS = 8  # that are printed below a robot's terms
PIPE = 160  # columns of output that is not a terminal


def formats() -> tuple[str, ...]:
    """The formats a report is written in; says on stderr why HTML is not among them."""
    from ..report.page import HINT, available

    if available():
        return ("json", "md", "html")
    note(HINT)
    return ("json", "md")


def console() -> Console:
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else PIPE, highlight=False, emoji=False)


def table(*columns: str, title: str | None = None) -> Table:
    """A table without lines; a column whose name ends in ">" is flush right."""
    from rich.table import Table

    found = Table(box=None, pad_edge=False, title=title and _plain(title), title_justify="left", header_style="bold")
    for name in columns:
        found.add_column(name.removesuffix(">"), justify="right" if name.endswith(">") else "left", overflow="fold")
    return found


def show(report: Report) -> None:
    """The terms of one robot, or a line for each of several; refusals; the verdict."""
    out = console()
    single = len(report.robots) == 1 and report.robots[0].terms
    if report.robots:
        out.print(_terms(report.robots[0]) if single else _robots(report.robots))
        if single and report.robots[0].reason:
            out.print(line(report.robots[0].reason), markup=False)
    for refusal in report.refused:
        who = "dualpin and Pinocchio" if refusal.by_pinocchio else "dualpin only"
        out.print(f"refused by {who}: {line(refusal.name)}: {line(refusal.reason)}", markup=False)
    verdict = report.verdict.replace("failed", "FAILED")
    against = report.versions.get("pinocchio", "?")
    counts = f": {report.headline}" if report.robots else ""
    style = STYLES.get(verdict, "bold yellow") if not (report.passed and report.remarks) else "bold yellow"
    if single:
        _remarks(out, report)
    out.print(f"[{style}]{verdict}[/]: {len(report.robots)} robots against Pinocchio {against}{counts}")


def _remarks(out: Console, report: Report) -> None:
    """What is to be said about the model, cut where it is much."""
    for _, text in report.remarks[:REMARKS]:
        out.print(f"remark: {line(text)}", markup=False)
    left = len(report.remarks) - REMARKS
    if left > 0:
        out.print(f"remark: and {left} more, see `dualpin info {line(report.robots[0].name)}`", markup=False)


def _terms(r: RobotResult) -> Table:
    title = f"{r.label}: {r.nv} degrees of freedom, {r.samples} samples, seed {r.seed}"
    found = table("term", "max scaled error>", "tolerance>", "verdict", "oracle", "", title=title)
    for name, t in r.terms.items():
        at = f"at {t.worst['where']}" if t.status == "differs" and t.worst.get("where") else ""
        found.add_row(name, *t.figures, mark(t), t.oracle, _plain("; ".join(x for x in (at, t.remark) if x)))
    return found


def _robots(robots: list[RobotResult]) -> Table:
    found = table("robot", "nv>", "worst scaled error>", "in", "verdict", "remark")
    for r in robots:
        worst, error = r.worst
        found.add_row(_plain(r.label), str(r.nv), error, worst, mark(r), _plain(r.remark))
    return found


def show_comparison(found: Comparison) -> None:
    """What changed, the worst first, and the verdict."""
    out = console()
    if found.changes:
        listing = table("", "what", "where", "old", "new", "factor>")
        for c in found.changes:
            verdict = "[red]WORSE[/]" if c.worse else "better" if c.factor < 1 else "changed"
            factor = f"{c.factor:.3g}" if c.what in ("error", "speed", "evaluations") else ""
            listing.add_row(verdict, c.what, _plain(c.where), _plain(c.old), _plain(c.new), factor)
        out.print(listing)
    for name, old, new in found.versions:
        out.print(line(f"{name}: {old} -> {new}"), markup=False)
    verdict = "[bold green]nothing got worse[/]" if found.passed else f"[bold red]{len(found.worse)} got WORSE[/]"
    out.print(f"{verdict}: {found.compared} figures compared")


def mark(of: TermResult | RobotResult) -> str:
    """The verdict in its colour."""
    style = "bold red" if not of.passed else STYLES.get(of.status, "yellow")
    return f"[{style}]{of.verdict}[/]"


def _plain(text: str) -> str:
    """Text in which brackets are brackets, and controls are shown."""
    from rich.markup import escape

    return escape(line(text))
