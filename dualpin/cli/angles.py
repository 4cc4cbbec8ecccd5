"""Angles typed and printed: `--degrees` of every command, and what a configuration's numbers seem to mean."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from ..escape import line
from .out import note

if TYPE_CHECKING:
    from ..model.robot import Joint, Robot

Degrees = Annotated[bool, typer.Option("--degrees", help="Angles in degrees, those typed and those printed.")]
TURNS = 2.0  # turns beyond which an angle of a joint without limits is asked about
MOST = 720.0  # degrees; larger numbers are hardly typed on purpose
SLACK = 1e-9  # rad or m: a limit typed with the digits that are printed is inside


def unit(degrees: bool) -> str:
    """What angles are in."""
    return "deg" if degrees else "rad"


def shown(angle: float, degrees: bool) -> float:
    """An angle in rad as it is printed."""
    return math.degrees(angle) if degrees else angle


def typed(robot: Robot, values: np.ndarray, degrees: bool, what: str) -> np.ndarray:
    """A configuration in rad and m from one as it was typed; stderr gets a note on what is odd about it."""
    q = in_rad(robot, values, degrees)
    for text in remarks(robot, q, degrees):
        note(f"{what}: {text}")
    return q


def in_rad(robot: Robot, values: np.ndarray, degrees: bool) -> np.ndarray:
    """Configurations (..., nq) in rad and m."""
    return np.where(_angular(robot), np.radians(values), values) if degrees else np.asarray(values, dtype=float)


def remarks(robot: Robot, q: np.ndarray, degrees: bool = False) -> list[str]:
    """What a user may want to know about a configuration: coordinates outside limits, degrees taken for rad."""
    angular, said, turned = _angular(robot), [], []
    for joint in robot:
        for i in range(joint.q.start, joint.q.stop) if joint.mimic is None else ():
            x, low, high = float(q[i]), float(robot.lower[i]), float(robot.upper[i])
            outside = x < low - SLACK or x > high + SLACK
            if angular[i] and not degrees and _means_degrees(x, low, high, outside):
                turned.append(f"{x:g} of {line(joint.name)}")
            elif outside:
                said.append(f"{_value(x, angular[i], degrees)} of {_name(joint, i)} is outside its limits, "
                            f"{_value(low, angular[i], degrees)} to {_value(high, angular[i], degrees)}")  # fmt: skip
    if turned:
        said.insert(0, f"{', '.join(turned)} {'is' if len(turned) == 1 else 'are'} read as rad; "
                       "if degrees are meant, add --degrees")  # fmt: skip
    return said


def _means_degrees(x: float, low: float, high: float, outside: bool) -> bool:
    """Whether a number read as rad is not where the joint can be, or many turns on, and would be at home in degrees."""
    odd = outside if math.isfinite(low) or math.isfinite(high) else abs(x) > TURNS * 2 * math.pi
    return odd and 2 * math.pi < abs(x) <= MOST and low <= math.radians(x) <= high


def _angular(robot: Robot) -> np.ndarray:
    """Which coordinates are angles."""
    found = np.zeros(robot.nq, dtype=bool)
    for joint in robot:
        for i, kind in zip(range(joint.q.start, joint.q.stop), joint.model.coordinates, strict=False):
            found[i] = kind == "angle"
    return found


def _value(x: float, angular: bool, degrees: bool) -> str:
    return f"{shown(x, degrees):.6g} {unit(degrees)}" if angular else f"{x:.6g}"


def _name(joint: Joint, i: int) -> str:
    several = joint.q.stop - joint.q.start > 1
    return line(joint.name) + (f" (coordinate {i - joint.q.start})" if several else "")
