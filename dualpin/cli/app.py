"""What all commands share: the program they register with, their common arguments, JSON."""

from __future__ import annotations

import json
import os
from typing import Annotated, Any

import typer

from .. import __version__
from ..errors import ArgumentError
from .stdin import named

XACRO_ARG, PACKAGE = "--xacro-arg", "--package"

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
    from ..io.catalogue import ALIASES, catalogue, shipped

    robots = catalogue()
    names = [*robots, *shipped(), *(short for short, full in ALIASES.items() if full in robots)]
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
Seed = Annotated[int, typer.Option("--seed", min=0)]
Terms = Annotated[str, typer.Option("--terms", help="Some terms, between commas.")]
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
    xacro_arg: Annotated[
        list[str] | None, typer.Option(XACRO_ARG, metavar="NAME:=VALUE", help="Of xacro files; after the command too.")
    ] = None,
    package: Annotated[
        list[str] | None,
        typer.Option(PACKAGE, metavar="NAME=FOLDER", help="A ROS package of xacro files; after the command too."),
    ] = None,
) -> None:
    """Robot kinematics and dynamics in dual numbers, checked against Pinocchio."""
    args = dict(_pair(x, ":=", XACRO_ARG) for x in xacro_arg or [])
    packages = dict(_pair(x, "=", PACKAGE) for x in package or [])
    if args or packages:
        from ..io.expand import SETTINGS

        os.environ[SETTINGS] = json.dumps({"args": args, "packages": packages})  # for processes started from here too


def _pair(text: str, sign: str, option: str) -> tuple[str, str]:
    name, found, value = text.partition(sign)
    if not name or not found:
        raise ArgumentError(f"{option}: {text!r} is not of the form name{sign}value")
    return name, value


def in_front(words: list[str]) -> list[str]:
    """The command line with the options of all commands before the command, where their parser takes them."""
    front: list[str] = []
    rest: list[str] = []
    end = words.index("--") if "--" in words else len(words)
    waiting = iter(words[:end])
    for word in waiting:
        if word in (XACRO_ARG, PACKAGE):
            front += [word, *[x for x in [next(waiting, None)] if x is not None]]
        elif word.startswith((f"{XACRO_ARG}=", f"{PACKAGE}=")):
            front.append(word)
        else:
            rest.append(word)
    return [*front, *rest, *words[end:]]
