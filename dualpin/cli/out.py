"""`--out DIR` of the commands that measure or convert: JSON, a page, and what else the command has."""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..escape import line
from ..files import write_text, writing

Out = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Write JSON (with processor, versions, date, command) and a page."),
]


def command() -> str:
    """The command as it was typed."""
    return shlex.join(["dualpin", *sys.argv[1:]])


def write_result(folder: Path, name: str, found: Mapping[str, Any], **texts: str) -> None:
    """NAME.json, NAME.csv and what else is given by its ending, and report.html; says on stderr what was written.

    Infinite and undefined numbers become null, as JSON has none.
    """
    from ..report import page, study
    from ..report.page import HINT, available

    contents = {f"{name}.json": json.dumps(_plain(found), indent=1)}
    contents |= {f"{name}.{ending}": text for ending, text in texts.items()}
    if available():
        contents["report.html"] = page(study(found, f"{name}.json"), title=str(found["title"]))
    else:
        note(HINT)
    write_files(folder, contents)


def write_files(folder: Path, contents: Mapping[str, str], more: str = "") -> None:
    """Texts into a folder; `more` ends the line that says so."""
    with writing(f"--out: cannot write into {folder}"):
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in contents.items():
            write_text(folder / name, text)
            wrote(folder / name, more=more)


def wrote(*paths: Path, more: str = "") -> None:
    """Say on stderr what was written."""
    for path in paths:
        print(f"wrote {line(str(path))}{more}", file=sys.stderr)


def note(text: str) -> None:
    """A remark on stderr."""
    print(f"note: {line(text)}", file=sys.stderr)


def _plain(x: Any) -> Any:
    if isinstance(x, Mapping):
        return {str(k): _plain(v) for k, v in x.items()}
    if isinstance(x, (list, tuple)):
        return [_plain(v) for v in x]
    return None if isinstance(x, float) and not -1e308 <= x <= 1e308 else x
