"""Commands about one robot, and the list of installed ones."""

from __future__ import annotations

import re
import sys
from math import isfinite
from typing import Annotated

import numpy as np
import typer

from ..errors import ArgumentError
from ..escape import line
from .angles import Degrees, typed
from .app import Floating, Json, Mimic, RobotName, app, show_json


@app.command("list")
def list_(json: Json = False) -> None:
    """Print the robots that can be named."""
    from ..io.catalogue import ALIASES, catalogue, shipped

    robots, models = catalogue(), shipped()
    aliases = {short: full for short, full in ALIASES.items() if full in robots}
    if json:
        paths = ({name: str(path) for name, path in found.items()} for found in (robots, models))
        show_json({"robots": next(paths), "aliases": aliases, "shipped": next(paths)})
        return
    if not robots and not models:
        raise ArgumentError("no robots are installed by name; pip install example-robot-data")
    short = {full: alias for alias, full in aliases.items()}
    for name in map(line, robots):
        print(f"{name}  (also {short[name]})" if name in short else name)
    for name in map(line, models):
        print(f"{name}  (ships with dualpin)")


@app.command()
def info(
    robot: RobotName, floating: Floating = False, mimic: Mimic = False, degrees: Degrees = False, json: Json = False
) -> None:
    """Print the tree of a robot, the order of q and v, limits, and what was assumed.

    --degrees is for the text; JSON is in rad and m.
    """
    from ..io.urdf import load
    from ..model.describe import total_mass

    def finite(x: float) -> float | None:
        """A number of JSON; None where there is no limit."""
        return x if isfinite(x) else None

    r = load(robot, floating, mimic)
    if not json:
        print(r.summary(degrees=degrees))
        return
    joints = [
        {
            "name": j.name, "kind": j.kind, "parent": j.parent.name if j.parent else None,
            "q": [j.q.start, j.q.stop], "v": [j.v.start, j.v.stop],
            "lower": [*map(finite, j.limits.lower)], "upper": [*map(finite, j.limits.upper)],
            "velocity": finite(j.limits.velocity), "effort": finite(j.limits.effort),
            "damping": j.damping, "friction": j.friction,
            "mass": float(j.inertia.mass), "mimic": j.mimic.joint if j.mimic else None,
        }
        for j in r
    ]  # fmt: skip
    show_json(
        {
            "name": r.name, "nq": r.nq, "nv": r.nv, "mass": r.mass, "moving_mass": r.mass, "total_mass": total_mass(r),
            "source": r.source, "joints": joints,
            "links": r.link_names, "frames": r.frame_names, "notes": list(r.notes),
        }
    )  # fmt: skip


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def fk(
    ctx: typer.Context,
    robot: RobotName,
    q: Annotated[
        str, typer.Option("--q", help="Configuration, numbers between commas or spaces; zero by default.")
    ] = "",
    frame: Annotated[str, typer.Option("--frame", help="Link or joint; the last frame by default.")] = "",
    dual_quaternion: Annotated[bool, typer.Option("--dual-quaternion", help="Print w x y z | w x y z.")] = False,
    floating: Floating = False,
    mimic: Mimic = False,
    degrees: Degrees = False,
    json: Json = False,
) -> None:
    """Print the pose of a frame in the world, as a 4x4 matrix or a dual quaternion.

    Examples:  dualpin fk ur5 --q 0,0,0,0,0,0  |  dualpin fk ur5 --q 0,-90,90,0,0,0 --degrees --frame tool0
    """
    from ..functions import fk as forward
    from ..io.urdf import load

    r = load(robot, floating, mimic)
    words = " ".join([q, *_numbers_after(ctx, q)])
    x = typed(r, parsed(words, r.nq, "--q"), degrees, "--q") if q else r.neutral
    name = frame or r.frame_names[-1]
    pose = forward(r, x, frame=name, as_="dual_quaternion" if dual_quaternion else "matrix", engine="numpy")
    if json:
        show_json({"robot": r.name, "frame": name, "q": x.tolist(), "pose": pose.tolist()})
        return
    print(f"{line(name)} in the world:", file=sys.stderr)
    for row in np.atleast_2d(pose):
        print("  ".join(f"{value: .16g}".rjust(23) for value in row))


def _numbers_after(ctx: typer.Context, q: str) -> list[str]:
    """The words after `--q 0.1`, as in `--q 0.1 -0.2 0.3`; anything that is no number there is refused."""
    for word in ctx.args:
        if not q or not re.fullmatch(r"[-+]?[\d.,][-+.,\de]*", word, re.IGNORECASE):
            raise ArgumentError(f"fk: {word!r} is not an option or a number of --q; see `dualpin fk --help`")
    return ctx.args


def parsed(text: str, n: int, what: str) -> np.ndarray:
    """n numbers out of text."""
    words = [w for w in re.split(r"[,\s]+", text.strip("[]() ")) if w]
    try:
        values = np.array([float(w) for w in words])
    except ValueError:
        raise ArgumentError(f"{what}: {text!r} is not a list of numbers such as 0.1,0.2") from None
    if len(values) != n or not np.isfinite(values).all():
        raise ArgumentError(f"{what}: {n} finite numbers expected, got {text!r}")
    return values
