"""`dualpin view`: a robot in a browser."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import ArgumentError
from ..escape import is_number, line
from .angles import Degrees, in_rad, remarks
from .app import Floating, Mimic, RobotName, app
from .out import note, wrote

if TYPE_CHECKING:
    from ..model.robot import Robot


@app.command()
def view(
    robot: RobotName,
    floating: Floating = False,
    mimic: Mimic = False,
    dh: Annotated[str | None, typer.Option("--dh", help="DH frames: standard, or modified (Craig).")] = None,
    tip: Annotated[
        str | None, typer.Option("--tip", help="Link the DH chain ends at, and whose pose is shown.")
    ] = None,
    play: Annotated[
        Path | None,
        typer.Option("--play", help="CSV of configurations, a row of q each; a first column headed t holds times."),
    ] = None,
    dt: Annotated[float, typer.Option("--dt", min=1e-6, help="Seconds between rows without times.")] = 0.02,
    degrees: Degrees = False,
    record: Annotated[
        Path | None,
        typer.Option("--record", metavar="FILE.html", help="Write a page that opens without a server, and end."),
    ] = None,
    dark: Annotated[bool, typer.Option("--dark", help="Dark from the start.")] = False,
    port: Annotated[int, typer.Option("--port", min=0, max=65535)] = 8080,
) -> None:
    """Show a robot in a browser: links, frames, joint screws, masses, DH frames, sliders, a tool to drag.

    Examples:  dualpin view panda --dh modified --tip panda_link8  |  dualpin view ur5 --play q.csv --dt 0.01
    |  dualpin view ur5 --play q.csv --record motion.html
    """
    from ..io.urdf import load
    from ..view import Viewer

    r = load(robot, floating, mimic)
    run = None if play is None else motion(r, play, dt, degrees)
    viewer = Viewer(r, run, dt=dt, dh=dh, tip=tip, dark=dark, port=port)
    for text in viewer.warnings:
        print(f"remark: {line(text)}", file=sys.stderr)
    if record is not None:
        try:
            viewer.record(record)
        finally:
            viewer.stop()
        wrote(record)
        return
    print(f"{line(robot)} is at {viewer.url}; Ctrl-C ends", file=sys.stderr, flush=True)
    try:
        while True:
            time.sleep(3600)
    except KeyboardInterrupt:
        viewer.stop()


def motion(robot: Robot, path: Path, dt: float, degrees: bool) -> Any:
    """Configurations of a CSV file with their times: a first column whose heading begins with "t", else dt apart."""
    import numpy as np

    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        heading = lines[0].split(",") if lines and not is_number(lines[0].split(",")[0]) else []
        rows = np.loadtxt(lines[bool(heading) :], delimiter=",", ndmin=2)
    except (OSError, ValueError) as e:
        raise ArgumentError(f"view: cannot read configurations from {path} ({e})") from None
    timed = bool(heading) and heading[0].strip().lower().startswith("t")
    if rows.shape[1] != robot.nq + timed or not len(rows):
        wanted = f"a time and {robot.nq} numbers" if timed else f"{robot.nq} numbers"
        raise ArgumentError(f"view: {path} has rows of {rows.shape[1]} numbers; {wanted} expected")
    t = rows[:, 0] if timed else dt * np.arange(len(rows))
    if np.any(np.diff(t) < 0):
        raise ArgumentError(f"view: {path}: the times of the first column do not increase")
    q = in_rad(robot, rows[:, int(timed) :], degrees)
    for text in remarks(robot, q[0], degrees):
        note(f"{path.name}, first row: {text}")
    return SimpleNamespace(q=q, t=t)
