"""What all commands share: the program they register with, their common arguments, JSON."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from .. import __version__
from .stdin import named

app = typer.Typer(
    name="dualpin",
    help="Robot kinematics and dynamics in dual numbers, checked against Pinocchio.",
    epilog="ROBOT is a name from example-robot-data (`dualpin list`), a path to a URDF, or - for standard input.  "
    "Examples:  dualpin info panda  |  dualpin validate panda --samples 100  |  dualpin fk ur5 --q 0,0,0,0,0,0",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def robot_names(incomplete: str) -> list[str]:
    """The robots and short names a shell completes; paths are completed by the shell itself."""
    from ..io.catalogue import ALIASES, catalogue

    robots = catalogue()
    names = [*robots, *(short for short, full in ALIASES.items() if full in robots)]
    return sorted(n for n in names if n.startswith(incomplete))


RobotName = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A name of `dualpin list`, a path to a URDF, or - for one on standard input.",
        autocompletion=robot_names,
        callback=named,
    ),
]
Floating = Annotated[bool, typer.Option("--floating", help="Give the base six degrees of freedom.")]
Mimic = Annotated[bool, typer.Option("--mimic", help="Let joints with a <mimic> tag follow.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document.")]


def show_json(value: Any) -> None:
    print(json.dumps(value, indent=1))


def _version(wanted: bool) -> None:
    if wanted:
        print(f"dualpin {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Robot kinematics and dynamics in dual numbers, checked against Pinocchio."""
