"""`dualpin bench` and `dualpin integrate`: figures measured here and now."""

from __future__ import annotations

import sys
from typing import Annotated, Any

import typer

from ..errors import ArgumentError
from ..escape import line
from .app import Floating, Json, RobotName, app, show_json
from .stdin import named


@app.command()
def bench(
    robots: Annotated[
        list[str], typer.Argument(metavar="ROBOT...", help="Names or paths; - is standard input.", callback=named)
    ],
    terms: Annotated[str, typer.Option("--terms", help="Some terms, between commas.")] = "",
    batch: Annotated[str, typer.Option("--batch", help="Samples a call; 1 is a single call.")] = "1,4096",
    threads: Annotated[str, typer.Option("--threads", help="Thread counts, between commas.")] = "1",
    device: Annotated[str, typer.Option("--device", help="A GPU: cuda, cuda:1, ...; terms are measured there.")] = "",
    explain: Annotated[
        bool, typer.Option("--explain", help="With --device: registers, spills and occupancy; needs no GPU.")
    ] = False,
    floating: Floating = False,
    json: Json = False,
) -> None:
    """Measure terms beside Pinocchio, in one run, after checking that both agree.

    With --device, kernels on a GPU are measured instead, after checking that they give the bits of the host's.
    """
    from .. import bench as measure

    if explain and not device:
        raise ArgumentError("bench: --explain is of kernels on a GPU; --device cuda")
    if device:
        _on_device(robots, terms, batch, device, explain, floating, json)
        return

    chosen = [t for t in terms.replace(",", " ").split() if t] or measure.TERMS_MEASURED
    batches, counts = whole(batch, "--batch"), whole(threads, "--threads")

    def tick(row: dict[str, Any]) -> None:
        if sys.stderr.isatty():
            print(f"{line(row['robot'])} {row['term']} batch {row['batch']}", file=sys.stderr)

    rows = measure.run(robots, chosen, batches, counts, floating=floating, progress=tick)
    if json:
        show_json(rows)
    else:
        show_rows(rows, ("robot", "term", "batch", "threads", "us_per_sample", "pinocchio_us_per_sample", "ratio"))


def _on_device(
    robots: list[str], terms: str, batch: str, device: str, explain: bool, floating: bool, json: bool
) -> None:
    from .. import bench_device as measure

    chosen = [t for t in terms.replace(",", " ").split() if t] or ["rnea", "aba", "crba", "fk"]
    if explain:
        rows = measure.explained(robots, chosen, device, floating=floating)
        columns: tuple[str, ...] = ("robot", "term", "dtype", "operations", "registers", "stack", "spill_stores")
        columns += ("spill_loads", "shared", "occupancy", "architecture")
    else:
        rows = measure.run(robots, chosen, whole(batch.removeprefix("1,"), "--batch"), device, floating=floating)
        columns = ("robot", "term", "dtype", "batch", "us_per_call", "million_per_second", "device")
    if json:
        show_json(rows)
        return
    said = [r for r in rows if "reason" in r]
    show_rows([r for r in rows if "reason" not in r], columns)
    for r in said:
        print(f"note: {r['robot']} {r['term']} {r['dtype']}: {r['reason']}", file=sys.stderr)


@app.command()
def integrate(
    robot: RobotName,
    frame: Annotated[str | None, typer.Option("--frame", help="What follows; the last frame by default.")] = None,
    radius: Annotated[float, typer.Option("--radius", help="Of the circle, in metres.")] = 0.05,
    period: Annotated[float, typer.Option("--period", help="Of a turn, in seconds.")] = 10.0,
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
    json: Json = False,
) -> None:
    """Follow a circle with several integrators, and print the peak errors and the cost."""
    from ..io.urdf import load
    from ..tracking import study

    rows = study.run(
        load(robot), frame=frame, radius=radius, period=period, plane=plane, turns=turns,
        methods=methods.replace(",", " ").split(), steps=real(steps, "--dt"), gains=real(gains, "--gain"),
        q0=None if start is None else real(start, "--start"), task=_task(task), unreachable=unreachable,
        feedback=feedback, startup=startup, rtol=rtol,
    )  # fmt: skip
    data = [row.as_dict() for row in rows]
    if json:
        show_json(data)
    else:
        columns = ("method", "dt", "gain", "position_peak", "orientation_peak", "evaluations", "seconds", "remark")
        for row, shown in zip(rows, data, strict=True):
            shown["remark"] = ", ".join(study.kind_of(w) for w in row.warnings).replace("unstable", "UNSTABLE")
        show_rows(data, columns)
        for note in study.remarks(rows):
            print(f"note: {line(note)}", file=sys.stderr)


def _task(text: str) -> str | list[int]:
    """A task's name, or its six zeros and ones, also with commas or blanks between."""
    digits = text.replace(",", "").replace(" ", "")
    return [int(c) for c in digits] if len(digits) == 6 and set(digits) <= {"0", "1"} else text


def whole(text: str, what: str) -> list[int]:
    """Positive whole numbers out of text."""
    values = real(text, what)
    if any(v < 1 or v != int(v) for v in values):
        raise ArgumentError(f"{what}: whole numbers from 1 expected, got {text!r}")
    return [int(v) for v in values]


def real(text: str, what: str) -> list[float]:
    """Numbers out of text."""
    try:
        values = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        values = []
    if not values:
        raise ArgumentError(f"{what}: numbers between commas expected, got {text!r}")
    return values


def show_rows(rows: list[dict[str, Any]], columns: tuple[str, ...]) -> None:
    """Aligned text, numbers to four digits."""
    cells = [[f"{r[c]:.4g}" if isinstance(r[c], float) else line(str(r[c])) for c in columns] for r in rows]
    widths = [max(len(c), *(len(row[i]) for row in cells)) for i, c in enumerate(columns)]
    for row in ([*columns], *cells):
        print("  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)))
