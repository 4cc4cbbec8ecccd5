"""`dualpin dh` and `dualpin screws`."""

from __future__ import annotations

import json as jsonlib
from pathlib import Path
from typing import Annotated, Any

import typer

from .angles import Degrees
from .app import Json, Mimic, RobotName, app
from .out import Out, command, note, write_result

Format = Annotated[str, typer.Option("--format", help="table, csv, json, yaml, markdown, latex, python or matlab.")]
Base = Annotated[str | None, typer.Option("--base", help="Link the chain starts from; the root by default.")]
Tip = Annotated[str | None, typer.Option("--tip", help="Link it ends at; the only leaf by default.")]
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
    out: Out = None,
    json: Json = False,
) -> None:
    """Print the Denavit-Hartenberg table of a chain.

    The table rounds off what is below its residual; every other format, and --out, has the numbers in full.

    Examples:  dualpin dh panda --tip panda_link8 --convention modified --degrees
    |  dualpin dh ur5 --tip tool0 --out dh
    """
    from ..forms import to_dh
    from ..io.urdf import load

    table = to_dh(load(robot, mimic=mimic), base, tip, convention, snap=snap)
    print(table.export("json" if json else format, degrees=degrees, digits=digits))
    if out:
        _write(out, "dh", table, degrees)
    if json or format != "table":  # which holds them
        for text in table.notes:
            note(text)


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
    out: Out = None,
    json: Json = False,
) -> None:
    """Print the home pose and the screws of a chain (product of exponentials).

    Examples:  dualpin screws ur5 --tip tool0  |  dualpin screws panda --tip panda_hand --frame body --out screws
    """
    from ..forms import to_screws
    from ..io.urdf import load

    found = to_screws(load(robot, mimic=mimic), tip, frame, base=base)
    print(found.export("json" if json else format, degrees=degrees, digits=digits))
    if out:
        _write(out, "screws", found, degrees)


def _write(folder: Path, name: str, found: Any, degrees: bool) -> None:
    """The form in full, as a document with a page, and as CSV."""
    from ..report import document

    data = jsonlib.loads(found.export("json", degrees=degrees))
    rows = data.pop("rows", None) or [
        {"joint": s["joint"], "q": s["q"], **dict(zip(("wx", "wy", "wz", "vx", "vy", "vz"), s["screw"], strict=True))}
        for s in data.get("screws", ())
    ]
    data |= {"home": [dict(zip("xyzt", row, strict=True)) for row in data["home"]]} if "home" in data else {}
    plain = {k: data.pop(k) for k in [*data] if isinstance(data[k], (str, float, int))}
    notes = data.pop("notes", [])
    if "residual" in plain:
        notes.append(f"residual {plain['residual']:.1e} (m and matrix entries)")
    title = f"{plain.pop('robot', name)}: {plain.get('convention', 'screws')}"
    written = document(title, rows, settings=plain, notes=notes, command=command(), **data)
    write_result(folder, name, written, csv=found.export("csv", degrees=degrees))
