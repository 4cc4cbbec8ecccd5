"""`dualpin convert`: a robot in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..escape import line, lines
from .app import Floating, Json, RobotName, Seed, app, show_json
from .out import wrote


@app.command()
def convert(
    robot: RobotName,
    out: Annotated[Path, typer.Argument(metavar="OUT", help="FILE.urdf, or FILE.xml for MJCF.")],
    samples: Annotated[
        int, typer.Option("--samples", "-n", min=2, help="Random states at which terms are compared.")
    ] = 16,
    seed: Seed = 0,
    floating: Floating = False,
    json: Json = False,
) -> None:
    """Write a robot as URDF or MJCF, and print the largest difference of every term in the library of that format.

    Pinocchio reads what was written as URDF, MuJoCo what was written as MJCF.  Exit code 0 if all terms agree,
    1 if some differ or could not be compared, 2 if the robot cannot be read or the format cannot hold it.

    Examples:  dualpin convert arm.urdf.xacro arm.urdf --xacro-arg gripper:=true  |  dualpin convert panda panda.xml
    """
    from ..analysis.convert import convert as converted

    done = converted(robot, out, samples, seed, floating=floating)
    wrote(out)
    if json:
        show_json(done.to_dict())
    else:
        for note in done.notes:
            print(f"note: {lines(note)}")
        width = max(map(len, done.terms), default=0)
        for term, error in done.terms.items():
            print(f"{term.ljust(width)}  {error:.1e}{'  DIFFERS' if term in done.differs else ''}")
        if done.reason:
            print(f"not compared: {lines(done.reason)}")
        verdict = "agrees" if done.passed else "DIFFERS" if done.differs else "is not proven"
        print(
            f"{line(str(out))} {verdict}{f' with {done.library}' if done.library else ''}: "
            f"{done.diff and done.diff.verdict}"
        )
    raise typer.Exit(0 if done.passed else 1)
