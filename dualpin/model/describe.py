"""A robot in words: its tree, the order of q and v, its limits, and what was assumed."""

from __future__ import annotations

from math import isfinite

from .robot import Joint, Robot

_UNITS = {"angle": "rad", "length": "m", "quaternion": ""}


def summary(robot: Robot) -> str:
    """The text of `Robot.summary`."""
    symbolic = robot.numbers == "symbolic"
    g = ", ".join(str(x) if symbolic else f"{float(x):g}" for x in robot.gravity)
    weight = "symbolic constants" if symbolic else f"{robot.mass:.6g} kg"
    lines = [
        f"{robot.name}: {len(robot.joints)} joints, nq = {robot.nq}, nv = {robot.nv}, {len(robot.links)} links, "
        f"{weight}, gravity ({g}) m/s^2",
        *([f"read from {robot.source}"] if robot.source else []),
        "",
        *_table(robot),
    ]
    layouts = dict.fromkeys(f"{j.kind}: {j.model.layout}" for j in robot if j.model.layout)
    lines += ["", *layouts] if layouts else []
    if robot.notes:
        lines += ["", "remarks:", *(f"  - {note}" for note in robot.notes)]
    return "\n".join(lines)


def rows(robot: Robot) -> list[tuple[str, ...]]:
    """The joints as rows of text, the heading first."""
    found: list[tuple[str, ...]] = [("", "joint", "kind", "parent", "q", "v", "limits")]
    return found + [
        (
            str(j.index),
            j.name,
            j.kind + _following(j),
            j.parent.name if j.parent else "-",
            _span(j.q),
            _span(j.v),
            _limits(j),
        )
        for j in robot
    ]


def _table(robot: Robot) -> list[str]:
    lines = rows(robot)
    widths = [max(len(row[k]) for row in lines) for k in range(len(lines[0]))]
    return ["  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in lines]


def _span(s: slice) -> str:
    return str(s.start) if s.stop == s.start + 1 else f"{s.start}:{s.stop}"


def _following(j: Joint) -> str:
    return f" = {j.mimic.multiplier:g} {j.mimic.joint} + {j.mimic.offset:g}" if j.mimic else ""


def _limits(j: Joint) -> str:
    if not j.limits.lower:
        return "none"
    return "; ".join(
        f"{lo:.6g} to {up:.6g} {_UNITS[what]}" if isfinite(lo) or isfinite(up) else "none"
        for lo, up, what in zip(j.limits.lower, j.limits.upper, j.model.coordinates, strict=True)
    )
