"""`dualpin report`: results again, in other formats, and what changed between two of them."""

from __future__ import annotations

import json as jsonlib
import re
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ArgumentError
from .app import Floating, Json, Mimic, app, robot_names, show_json
from .listing import show_rows
from .out import write_files, wrote
from .show import formats, show, show_comparison
from .stdin import named


@app.command()
def report(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE.json...|ROBOT",
            help="Result files (.json): validation, speed, ...; anything else is a robot.",
            autocompletion=robot_names,
            callback=named,
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", help="Write one report.html into this folder; of a robot by default here.")
    ] = None,
    badge: Annotated[
        Path | None, typer.Option("--badge", metavar="FILE.svg", help="Write a badge of the validations among them.")
    ] = None,
    compare: Annotated[
        bool, typer.Option("--compare", help="Two files, OLD NEW: what got worse, slower, or changed verdict.")
    ] = False,
    error_factor: Annotated[
        float, typer.Option("--error-factor", min=1.0, help="An error that grew by more is worse.")
    ] = 10.0,
    speed_factor: Annotated[
        float, typer.Option("--speed-factor", min=1.0, help="A time that grew by more is worse.")
    ] = 1.1,
    frame: Annotated[str | None, typer.Option("--frame", help="Of a robot: what forms and workspace are of.")] = None,
    samples: Annotated[
        int, typer.Option("--samples", min=0, help="Of a robot: states of the validation; 0 leaves it out.")
    ] = 200,
    floating: Floating = False,
    mimic: Mimic = False,
    json: Json = False,
) -> None:
    """Print results again, write them as one HTML page, or compare two of them; or write a robot's data sheet.

    Exit code 1 if a validation among them failed, or, with --compare, if something got worse.

    Examples:  dualpin report out/report.json --out page  |  dualpin report --compare old.json new.json
    |  dualpin report out/report.json --badge badge.svg  |  dualpin report ur5 --out sheet
    """
    from ..report import compare as compared
    from ..report import read

    robots = [x for x in files if not _is_result(x)]
    if robots:
        if len(files) > 1 or compare or badge:
            raise ArgumentError(f"report: one robot, or result files (.json) expected; {robots[0]!r} is a robot")
        _sheet(robots[0], frame, samples, out, floating=floating, mimic=mimic, json=json)
        return
    studies = [read(Path(file)) for file in files]
    if compare:
        if len(studies) != 2:
            raise ArgumentError(f"report --compare: two files expected, OLD and NEW; {len(studies)} given")
        if badge:
            raise ArgumentError("report: a badge is of results, not of a comparison; leave out --compare or --badge")
        found = compared(studies[0], studies[1], error_factor=error_factor, speed_factor=speed_factor)
        if out:
            _write(out, found)
        if json:
            show_json(found.to_dict())
        else:
            show_comparison(found)
        raise typer.Exit(0 if found.passed else 1)
    if badge:
        _write_badge(badge, [s.report for s in studies if s.report is not None])
    if out:
        if len(studies) == 1 and studies[0].report is not None:
            wrote(*studies[0].report.write(out, formats()))
        else:
            _write(out, *studies)
    if json:
        documents = [s.report.to_dict() if s.report else s.tables for s in studies]
        print(jsonlib.dumps(documents[0] if len(documents) == 1 else documents, indent=1))
    else:
        for s in studies:
            if s.report is not None:
                show(s.report)
            for name, rows in s.tables.items():
                show_rows(name, rows)
    raise typer.Exit(0 if all(s.report is None or s.report.passed for s in studies) else 1)


def _is_result(name: str) -> bool:
    """A file whose name ends in .json, or a pipe; anything else is a robot."""
    path = Path(name)
    return name.lower().endswith(".json") or (path.exists() and not path.is_file() and not path.is_dir())


def _sheet(
    name: str, frame: str | None, samples: int, out: Path | None, *, floating: bool, mimic: bool, json: bool
) -> None:
    """The page of a robot, into a folder, or here under the robot's name."""
    from ..io.urdf import load
    from ..report import robot_page

    robot = load(name, floating=floating, mimic=mimic)
    text = robot_page(robot, frame, samples=samples)
    file = "report.html" if out else f"{re.sub(r'[^A-Za-z0-9_.-]+', '_', robot.name).strip('.') or 'robot'}.html"
    write_files(out or Path(), {file: text})
    if json:
        show_json({"robot": robot.name, "page": str((out or Path()) / file)})


def _write_badge(path: Path, reports: list[Any]) -> None:
    """One badge of all reports together."""
    from ..crosscheck.results import Report

    if not reports:
        raise ArgumentError("report: --badge needs the JSON of `dualpin validate` or `dualpin judge`")
    together = Report(
        [r for one in reports for r in one.robots],
        [r for one in reports for r in one.refused],
        partial=any(one.partial for one in reports),
    )
    write_files(path.parent, {path.name: together.badge()})


def _write(folder: Path, *of: object) -> None:
    """One page into a folder."""
    from ..report import page

    write_files(folder, {"report.html": page(*of)})  # type: ignore[arg-type]
