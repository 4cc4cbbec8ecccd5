"""A robot as text: its tree, the order of q and v, its limits, and the assumptions of the reader."""

from __future__ import annotations

from math import degrees as to_degrees
from math import inf, isfinite

from ..escape import line
from .robot import Joint, Robot

_UNITS = {"angle": "rad", "length": "m", "quaternion": ""}
_STATED = ("effort", "damping", "friction")  # shown where a joint has one


def summary(robot: Robot, degrees: bool = False) -> str:
    """The text of `Robot.summary`; limits of angles in degrees where asked."""
    symbolic = robot.numbers == "symbolic"
    g = ", ".join(str(x) if symbolic else f"{float(x):g}" for x in robot.gravity)
    weight = "symbolic constants" if symbolic else _masses(robot)
    lines = [
        f"{line(robot.name)}: {len(robot.joints)} joints, nq = {robot.nq}, nv = {robot.nv}, {len(robot.links)} links, "
        f"{weight}, gravity ({g}) m/s^2",
        *([f"read from {line(robot.source)}"] if robot.source else []),
        "",
        *_table(robot, degrees),
    ]
    layouts = dict.fromkeys(f"{j.kind}: {j.model.layout}" for j in robot if j.model.layout)
    lines += ["", *layouts] if layouts else []
    if robot.notes:
        lines += ["", "remarks:", *(f"  - {line(note)}" for note in robot.notes)]
    return "\n".join(lines)


def total_mass(robot: Robot) -> float:
    """Mass of all links, the base too [kg]."""
    return float(sum(float(link.inertia.mass) for link in robot.links))


def _masses(robot: Robot) -> str:
    total, moving = total_mass(robot), robot.mass
    still = abs(total - moving) > 1e-9 * max(total, 1.0)
    return f"{moving:.6g} kg" + (f" moving of {total:.6g} kg" if still else "")


def rows(robot: Robot, degrees: bool = False) -> list[tuple[str, ...]]:
    """The joints as rows of text, the heading first."""
    more = [name for name in _STATED if any(getattr(j.limits, name) not in (0.0, inf) for j in robot)]
    found: list[tuple[str, ...]] = [("", "joint", "kind", "parent", "q", "v", "limits", *more)]
    return found + [
        (
            str(j.index),
            line(j.name),
            j.kind + _following(j) + (" (passive)" if j.passive else ""),
            line(j.parent.name) if j.parent else "-",
            _span(j.q),
            _span(j.v),
            _limits(j, degrees),
            *(f"{getattr(j.limits, name):.6g}".replace("inf", "none") for name in more),
        )
        for j in robot
    ]


def _table(robot: Robot, degrees: bool) -> list[str]:
    table = rows(robot, degrees)
    widths = [max(len(row[k]) for row in table) for k in range(len(table[0]))]
    return ["  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in table]


def _span(s: slice) -> str:
    return str(s.start) if s.stop == s.start + 1 else f"{s.start}:{s.stop}"


def _following(j: Joint) -> str:
    return f" = {j.mimic.multiplier:g} {line(j.mimic.joint)} + {j.mimic.offset:g}" if j.mimic else ""


def _limits(j: Joint, in_degrees: bool) -> str:
    if not j.limits.lower:
        return "none"
    said = []
    for low, high, what in zip(j.limits.lower, j.limits.upper, j.model.coordinates, strict=True):
        unit, turn = ("deg", to_degrees) if in_degrees and what == "angle" else (_UNITS[what], float)
        known = isfinite(low) or isfinite(high)
        said.append(f"{turn(low):.6g} to {turn(high):.6g} {unit}" if known else "none")
    return "; ".join(said)
