"""`dualpin integrate`: integrators compared on a circle."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from .angles import Degrees, shown, typed, unit
from .app import Json, RobotName, app, show_json
from .listing import show_rows
from .numbers import real, words
from .out import Out, command, note, write_result, wrote

if TYPE_CHECKING:
    from ..tracking import study


@app.command()
def integrate(
    robot: RobotName,
    frame: Annotated[str | None, typer.Option("--frame", help="Frame that moves; the last by default.")] = None,
    radius: Annotated[float, typer.Option("--radius", help="Of the circle, in metres.")] = 0.05,
    period: Annotated[float, typer.Option("--period", help="Of one revolution, in seconds.")] = 10.0,
    plane: Annotated[
        str | None, typer.Option("--plane", help="xy, yz or zx; by default one in which the robot can move.")
    ] = None,
    turns: Annotated[int, typer.Option("--turns", min=1)] = 2,
    steps: Annotated[str, typer.Option("--dt", help="Steps in seconds, between commas.")] = "0.01,0.1,1",
    gains: Annotated[str, typer.Option("--gain", help="Feedback gains in 1/s; 0 is open loop.")] = "0,1",
    methods: Annotated[str, typer.Option("--methods", help="Between commas.")] = "euler,trapezoidal,abm4,rk4",
    start: Annotated[
        str | None, typer.Option("--start", help="Configuration, rad and m, between commas; by default a good one.")
    ] = None,
    task: Annotated[
        str, typer.Option("--task", help="pose, position, position+axis, or six of 0 and 1: wx wy wz vx vy vz.")
    ] = "pose",
    unreachable: Annotated[
        str, typer.Option("--unreachable", help="Of a circle out of reach: raise, warn or ignore.")
    ] = "raise",
    feedback: Annotated[str, typer.Option("--feedback", help="stage or held.")] = "stage",
    startup: Annotated[str, typer.Option("--startup", help="Of multistep methods: paper or rk4.")] = "paper",
    rtol: Annotated[float, typer.Option("--rtol", help="Of adaptive methods and SciPy's.")] = 1e-9,
    degrees: Degrees = False,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE", help="Draw errors against evaluations and time: .png, .svg or .pdf."),
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Follow a circle with several integrators, and print the peak errors and the cost.

    Examples:  dualpin integrate ur5 --frame tool0  |  dualpin integrate arm.urdf --task position --out study
    """
    from ..io.urdf import load
    from ..tracking import study

    r = load(robot)
    q0 = None
    if start is not None:
        given = np.array(real(start, "--start"))
        q0 = typed(r, given, degrees, "--start") if given.shape == (r.nq,) else given
    found = study.run(
        r, frame=frame, radius=radius, period=period, plane=plane, turns=turns,
        methods=words(methods), steps=real(steps, "--dt"), gains=real(gains, "--gain"),
        q0=q0, task=_task(task), unreachable=unreachable, feedback=feedback, startup=startup, rtol=rtol,
    )  # fmt: skip
    notes = study.remarks(found)
    if plot:
        found.save(plot)
        wrote(plot)
    if out:
        from ..report import document

        rows = [row.as_dict() for row in found]
        write_result(out, "integrate", document(found.title, rows, settings=found.settings, notes=notes,
                                                command=command()))  # fmt: skip
    if json:
        show_json([row.as_dict() for row in found])
        return
    print(found.title)
    table = [_shown(row, degrees) for row in found]
    show_rows("", table, list(table[0]))
    for text in notes:
        note(text)


def _shown(row: study.Row, degrees: bool) -> dict[str, Any]:
    """The row of a table."""
    from ..tracking.study import kind_of

    kinds = ", ".join(dict.fromkeys(kind_of(w) for w in row.warnings)).replace("unstable", "UNSTABLE")
    return {
        "method": row.method, "dt": row.dt, "gain": row.gain, "position_peak [m]": row.position_peak,
        f"orientation_peak [{unit(degrees)}]": shown(row.orientation_peak, degrees),
        "evaluations": row.evaluations, "seconds": row.seconds, "remark": kinds,
    }  # fmt: skip


def _task(text: str) -> str | list[int]:
    """A task's name, or its six zeros and ones, also with commas or blanks between."""
    digits = text.replace(",", "").replace(" ", "")
    return [int(c) for c in digits] if len(digits) == 6 and set(digits) <= {"0", "1"} else text
