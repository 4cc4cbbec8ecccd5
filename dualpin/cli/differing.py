"""`dualpin diff`: are two robots the same?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..escape import line, lines
from .app import Floating, Json, RobotName, Seed, app, show_json
from .out import write_files

LISTED = 30  # changes in a table for people; all of them are in --json and --html


@app.command()
def diff(
    a: RobotName,
    b: RobotName,
    samples: Annotated[
        int, typer.Option("--samples", "-n", min=1, help="Random states at which terms are compared.")
    ] = 64,
    seed: Seed = 0,
    floating: Floating = False,
    strict: Annotated[bool, typer.Option("--strict", help="Names, order and frames count too.")] = False,
    html: Annotated[Path | None, typer.Option("--html", help="Write a page with both trees side by side.")] = None,
    json: Json = False,
) -> None:
    """Compare two robots: kinematics, masses, limits, and the largest change of poses, torques and M.

    Renamed, reordered and re-framed parts, merged links and another place of the base are recognised.  Exit code 0 if
    both are the same robot (with --strict: if nothing differs at all), 1 if they are not, 2 if a file cannot be read.

    Examples:  dualpin diff old.urdf new.urdf  |  dualpin diff arm.urdf arm.xml --html diff.html
    """
    from ..analysis.diff import diff as compared

    found = compared(a, b, samples, seed, floating=floating)
    if html is not None:
        write_files(html.parent, {html.name: found.to_html()})
    if json:
        show_json(found.to_dict())
    else:
        _show(found)
    raise typer.Exit(0 if (found.identical if strict else found.same) else 1)


def _show(found: Any) -> None:
    from .show import console, table

    out = console()
    if found.changes:
        listing = table("", "where", "what")
        for c in found.changes[:LISTED]:
            listing.add_row("" if c.counts else "(frame, name)", lines(f"{c.about} {c.item}".strip()), lines(c.says))
        out.print(listing)
        if len(found.changes) > LISTED:
            out.print(f"... {len(found.changes)} differences in all; --json or --html has them", markup=False)
    if found.terms:
        listing = table(
            "term", "largest change>", "unit", "scaled>", "where", title="at the worst of the random states"
        )
        for t in found.terms.values():
            listing.add_row(t.term, f"{t.amount:.3g}", t.unit, f"{t.scaled:.1e}", lines(t.where))
        out.print(listing)
    if found.base_parameters:
        listing = table("base parameter", "a>", "b>", title="combinations of parameters that torques show")
        for name, (x, y) in list(found.base_parameters.items())[:LISTED]:
            listing.add_row(lines(name), f"{x:.6g}", f"{y:.6g}")
        out.print(listing)
    if found.reason:
        out.print(f"terms not compared: {found.reason}", markup=False)
    out.print(line(f"{found.a} and {found.b}: {found.verdict}"), markup=False)
