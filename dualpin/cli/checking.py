"""`dualpin check`: faults of robot descriptions."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ArgumentError, DualpinError, nearest
from ..escape import line, lines
from .app import Json, app, robot_names, show_json
from .numbers import words
from .out import write_files
from .stdin import named

Rules = Annotated[str, typer.Option(help="Ids of rules, between commas; `dualpin check --rules` lists them.")]


def _listed(wanted: bool) -> None:
    if wanted:
        from ..analysis.check import RULES

        width = max(map(len, RULES))
        for r in RULES.values():
            print(f"{r.id.ljust(width)}  {r.severity.ljust(7)}  {r.says}")
        raise typer.Exit


@app.command()
def check(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...",
            help="URDF, xacro or MJCF files, names, or -.",
            autocompletion=robot_names,
            callback=named,
        ),
    ],
    only: Rules = "",
    without: Rules = "",
    level: Annotated[str, typer.Option("--level", help="The mildest severity: note, warning or error.")] = "note",
    fix: Annotated[
        bool, typer.Option("--fix", help="Write NAME.fixed.urdf with what is certain corrected, and print the diff.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="Write check.json, check.junit.xml and check.sarif into this folder.")
    ] = None,
    listed: Annotated[
        bool, typer.Option("--rules", callback=_listed, is_eager=True, help="List the rules and exit.")
    ] = False,
    json: Json = False,
) -> None:
    """Look for faults: tensors that no body has, wrong frames and units, limbs that do not mirror, missing meshes, ...

    Each finding says where, why it matters (what it does to which term) and what to change.  Exit code 0 if nothing
    was found, 1 if something was, 2 if a file cannot be read.

    Examples:  dualpin check arm.urdf  |  dualpin check *.urdf --level warning --out out  |  dualpin check a.urdf --fix
    """
    from ..analysis.check import Checked
    from ..analysis.check import check as checked
    from ..analysis.check.findings import SEVERITIES

    if level not in SEVERITIES:
        raise ArgumentError(f"check: --level {level!r}; {nearest(level, SEVERITIES)}")
    chosen = [words(text) for text in (only, without)]
    found: list[Checked] = []
    refused: dict[str, str] = {}
    diffs: dict[str, str] = {}
    for file in files:
        try:
            one = checked(file, only=chosen[0], without=chosen[1])
        except ArgumentError:
            raise
        except DualpinError as e:
            refused[file] = str(e)
            print(f"dualpin: {lines(str(e))}", file=sys.stderr)
            continue
        if fix:
            diffs[file] = _fixed(one, out or Path())
        one = one.at_least(level)
        found.append(one)
        if not json:
            print(lines(str(one)))
            if diffs.get(file):
                print(diffs[file], end="")
    data = {"passed": all(c.passed for c in found) and not refused, "files": [c.to_dict() for c in found],
            "refused": [{"name": k, "reason": x} for k, x in refused.items()]}  # fmt: skip
    if fix:
        data["diffs"] = diffs
    if json:
        show_json(data)
    elif len(files) > 1:
        _totals(found, refused)
    if out is not None:
        _written(out, found, data)
    raise typer.Exit(2 if refused else int(not data["passed"]))


def _totals(found: list[Any], refused: dict[str, str]) -> None:
    """How many files each rule is found in."""
    from .show import console, table

    rates: dict[str, list[int]] = {}
    for c in found:
        for rule in {f.rule for f in c.findings}:
            rates.setdefault(rule, [0, 0])[0] += 1
        for f in c.findings:
            rates[f.rule][1] += 1
    listing = table("rule", "files>", "findings>", title=f"{len(found)} files, {len(refused)} that cannot be read")
    for rule, (n, count) in sorted(rates.items(), key=lambda x: -x[1][0]):
        listing.add_row(rule, str(n), str(count))
    console().print(listing)


def _fixed(one: Any, folder: Path) -> str:
    """The certain corrections as a diff, and a copy with them in the folder."""
    from ..analysis.check import diff, fixed

    certain = [f for f in one.findings if f.certain]
    if not certain or one.text is None:
        print(f"{line(one.name)}: nothing that is certain to correct", file=sys.stderr)
        return ""
    new = fixed(one)
    write_files(folder, {f"{Path(one.name).stem}.fixed.urdf": new}, f": {len(certain)} corrections")
    return str(diff(one, Path(one.name).name, new))


def _written(out: Path, found: list[Any], data: dict[str, Any]) -> None:
    from json import dumps

    from ..analysis.check.exports import junit, sarif

    text = dumps(data, indent=1) + "\n"
    write_files(out, {"check.json": text, "check.junit.xml": junit(found), "check.sarif": sarif(found)})
