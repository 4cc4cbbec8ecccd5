"""`dualpin workspace`: where a frame can be, how well it moves there, and what it can carry there."""

from __future__ import annotations

import json as jsonlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import ArgumentError
from ..escape import line
from .app import Json, Mimic, RobotName, Seed, app, show_json
from .out import command, note, write_files, wrote

if TYPE_CHECKING:
    import numpy as np

    from ..analysis.workspace import ReachMap
    from ..model.robot import Robot


@app.command()
def workspace(
    robot: RobotName,
    frame: Annotated[str | None, typer.Option("--frame", help="What moves; the last frame by default.")] = None,
    samples: Annotated[int, typer.Option("--samples", min=1, help="Random configurations.")] = 10_000_000,
    cell: Annotated[
        float | None, typer.Option("--cell", help="Side of a cell [m]; by default fits the samples.")
    ] = None,
    bands: Annotated[int, typer.Option("--bands", min=1, help="Bands of directions: 2 BANDS^2 in all.")] = 6,
    payload: Annotated[
        float, typer.Option("--payload", min=0.0, help="Mass [kg] that the map of joint torques carries.")
    ] = 0.0,
    survey: Annotated[
        int, typer.Option("--survey", min=0, help="Configurations for manipulability and loads; 0 leaves them out.")
    ] = 50_000,
    seed: Seed = 0,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write maps (npz), pictures, JSON and an interactive page."),
    ] = None,
    mimic: Mimic = False,
    json: Json = False,
) -> None:
    """Map the workspace of a frame: reachability, manipulability, joint torques under a payload, capacity.

    After Ctrl-C what was mapped so far is shown and written, and the exit code is 130.

    Examples:  dualpin workspace ur5 --frame tool0 --out out  |  dualpin workspace panda --payload 2 --samples 1000000
    """
    from ..analysis.workspace.reach import growing
    from ..io.urdf import load

    r = load(robot, mimic=mimic)
    found, stopped = None, False
    try:
        for found in growing(r, frame, n=samples, cell=cell, axis="z", bands=bands, rolls=1, seed=seed, memory=1024.0):
            if sys.stderr.isatty():
                print(f"\rreach: {100 * found.samples / samples:3.0f} % ", end="", file=sys.stderr)
    except KeyboardInterrupt:
        stopped = True
        if found is None:
            raise
    if sys.stderr.isatty():
        print(file=sys.stderr)
    assert found is not None
    surveys = {} if stopped or not survey else _surveys(r, found, payload, survey)
    summary = _summary(found, surveys, stopped)
    if out:
        _write(out, found, surveys, summary)
    if json:
        show_json(summary)
    else:
        for key, value in summary.items():
            print(f"{key.replace('_', ' ')}: {line(_text(value))}")
    if stopped:
        raise typer.Exit(130)


def _surveys(robot: Robot, found: ReachMap, payload: float, n: int) -> dict[str, np.ndarray]:
    """The best manipulability of each cell, and the worst loads."""
    from ..analysis.workspace import manipulability, payload_capacity, static_load

    at = found.frame
    surveys = {
        "isotropy, best": found.survey(lambda q: 1 / manipulability(robot, q, at).condition, "max", n),
        "manipulability, best": found.survey(lambda q: manipulability(robot, q, at).index, "max", n),
    }
    try:
        surveys[f"torque share with {payload:g} kg, worst"] = found.survey(
            lambda q: abs(static_load(robot, q, at, payload)).max(axis=-1), "max", n
        )
        surveys["capacity [kg], least"] = found.survey(lambda q: payload_capacity(robot, q, at), "min", n)
    except ArgumentError as e:
        note(f"no map of loads: {e}")
    return surveys


def _summary(found: ReachMap, surveys: dict[str, np.ndarray], stopped: bool) -> dict[str, Any]:
    import numpy as np

    ranges = {}
    for name, values in surveys.items():
        kept = values[np.isfinite(values)]
        if kept.size:
            ranges[name] = {"min": float(kept.min()), "median": float(np.median(kept)), "max": float(kept.max())}
    low, high = (np.array([found.centres(k)[i] for k in range(3)]) for i in (0, -1))
    return {
        "robot": found.robot.name, "frame": found.frame.name, "samples": found.samples, "seed": found.seed,
        "interrupted": stopped, "seconds": found.seconds, "cell": found.cell, "shape": list(found.shape),
        "lower": low.tolist(), "upper": high.tolist(), "volume": found.volume, "mean_index": found.mean,
        "coverage": found.coverage, "surveys": ranges,
    }  # fmt: skip


def _write(folder: Path, found: ReachMap, surveys: dict[str, np.ndarray], summary: dict[str, Any]) -> None:
    from importlib.util import find_spec

    from ..report.document import document
    from ..report.page import HINT, available, page
    from ..report.voxels import workspace_section

    rows = [{k: v for k, v in summary.items() if isinstance(v, (int, float, str))}]
    title = f"{found.robot.name}: workspace of {found.frame.name}"
    contents = {"workspace.json": jsonlib.dumps(document(title, rows, command=command(), summary=summary), indent=1)}
    if available():
        contents["report.html"] = page(workspace_section(found, surveys), title=title)
    else:
        note(HINT)
    write_files(folder, contents)
    found.save(folder / "reach.npz")
    wrote(folder / "reach.npz")
    if find_spec("matplotlib") is None:
        note("pictures need Matplotlib: pip install 'dualpin[figures]'")
        return
    found.plot(folder / "workspace.png", **surveys)
    wrote(folder / "workspace.png")


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list):
        return ", ".join(_text(x) for x in value)
    if isinstance(value, dict):
        return "; ".join(f"{k} {_text(list(v.values()))} (least, median, greatest)" for k, v in value.items()) or "none"
    return str(value)
