"""`dualpin dh` and `dualpin screws`."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from ..escape import line
from .app import Json, Mimic, RobotName, app

Format = Annotated[str, typer.Option("--format", help="table, csv, json, yaml, markdown, latex, python or matlab.")]
Base = Annotated[str | None, typer.Option("--base", help="Link the chain starts from; the root by default.")]
Tip = Annotated[str | None, typer.Option("--tip", help="Link it ends at; the only leaf by default.")]
Degrees = Annotated[bool, typer.Option("--degrees", help="Angles in degrees.")]
Digits = Annotated[int | None, typer.Option("--digits", min=1, help="Significant digits; all by default.")]


@app.command()
def dh(
    robot: RobotName,
    convention: Annotated[
        str, typer.Option("--convention", help="standard, modified (Craig), or khalil-kleinfinger.")
    ] = "standard",
    format: Format = "table",
    base: Base = None,
    tip: Tip = None,
    snap: Annotated[
        float | None, typer.Option("--snap", help="Round angles within this many rad to multiples of 90 degrees.")
    ] = None,
    degrees: Degrees = False,
    digits: Digits = None,
    mimic: Mimic = False,
    json: Json = False,
) -> None:
    """Print the Denavit-Hartenberg table of a chain, exactly as the robot has it."""
    from ..forms import to_dh
    from ..io.urdf import load

    table = to_dh(load(robot, mimic=mimic), base, tip, convention, snap=snap)
    print(table.export("json" if json else format, degrees=degrees, digits=digits))
    for note in table.notes:
        print(f"note: {line(note)}", file=sys.stderr)


@app.command()
def screws(
    robot: RobotName,
    frame: Annotated[str, typer.Option("--frame", help="space, or body.")] = "space",
    format: Format = "table",
    base: Base = None,
    tip: Tip = None,
    degrees: Degrees = False,
    digits: Digits = None,
    mimic: Mimic = False,
    json: Json = False,
) -> None:
    """Print the home pose and the screws of a chain (product of exponentials)."""
    from ..forms import to_screws
    from ..io.urdf import load

    found = to_screws(load(robot, mimic=mimic), tip, frame, base=base)
    print(found.export("json" if json else format, degrees=degrees, digits=digits))
