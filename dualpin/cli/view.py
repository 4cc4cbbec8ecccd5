"""`dualpin view`: a robot in a browser."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Annotated

import typer

from ..errors import ArgumentError
from ..escape import line
from .app import Floating, Mimic, RobotName, app


@app.command()
def view(
    robot: RobotName,
    floating: Floating = False,
    mimic: Mimic = False,
    dh: Annotated[str | None, typer.Option("--dh", help="DH frames: standard, or modified (Craig).")] = None,
    tip: Annotated[
        str | None, typer.Option("--tip", help="Link the DH chain ends at; the only leaf by default.")
    ] = None,
    play: Annotated[
        Path | None, typer.Option("--play", help="Configurations to play, a row of q each, 20 ms apart (CSV).")
    ] = None,
    port: Annotated[int, typer.Option("--port", min=0, max=65535)] = 8080,
) -> None:
    """Show a robot in a browser: links, frames, joint screws, DH frames, sliders for q.

    Examples:  dualpin view panda --dh modified --tip panda_link8  |  dualpin view ur5 --play q.csv
    """
    import numpy as np

    from ..io.urdf import load
    from ..view import Viewer

    run = None
    if play is not None:
        try:
            run = np.loadtxt(play, delimiter=",", ndmin=2)
        except (OSError, ValueError) as e:
            raise ArgumentError(f"view: cannot read configurations from {play} ({e})") from None
    viewer = Viewer(load(robot, floating, mimic), run, dh=dh, tip=tip, port=port)
    print(f"{line(robot)} is at {viewer.url}; Ctrl-C ends", file=sys.stderr, flush=True)
    try:
        while True:
            time.sleep(3600)
    except KeyboardInterrupt:
        viewer.stop()
