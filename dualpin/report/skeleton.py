"""A robot as lines: drawn in the page, moved there by sliders."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, isfinite, pi, sin
from typing import Any

import numpy as np

from ..functions import fk
from ..model.joints import Axial
from ..model.limits import ranges
from ..model.robot import Joint, Robot

AZIMUTH, ELEVATION = 0.8, 0.35
"""Direction of view [rad]."""
SIZE = 200.0
"""Half the side of the drawing."""
AXIS = 0.08
"""Half the length of a drawn joint axis, of the robot's size."""


@dataclass(frozen=True)
class Line:
    """A line of the drawing as it stands, and what it is: "bone" or "hinge"."""

    x1: float
    y1: float
    x2: float
    y2: float
    kind: str
    says: str


@dataclass(frozen=True)
class Slider:
    """A coordinate that can be moved."""

    name: str
    index: int
    low: float
    high: float
    value: float
    unit: str


@dataclass(frozen=True)
class Skeleton:
    """The data with which a page draws a robot, and draws it again when it moves."""

    lines: list[Line]
    sliders: list[Slider]
    data: dict[str, Any]


def skeleton(robot: Robot, q: np.ndarray) -> Skeleton:
    """The robot at a configuration: bones from joint to joint and to frames, and the joints' axes."""
    world = [np.eye(4), *fk(robot, q, engine="numpy")]

    def at(joint: Joint | None) -> np.ndarray:
        return np.asarray(world[0 if joint is None else joint.index + 1])

    bones: list[tuple[Joint | None, np.ndarray, np.ndarray, str, str]] = []
    ends = [(j.parent, j.placement.array[:3, 3], j.name) for j in robot]
    ends += [(k.joint, k.placement.array[:3, 3], k.name) for k in robot.links]
    bones += [(on, np.zeros(3), end, "bone", name) for on, end, name in ends if np.linalg.norm(end) > 0]
    points = [at(on)[:3, :3] @ p + at(on)[:3, 3] for on, _, p, *_ in bones] + [T[:3, 3] for T in world]
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    size = max(float(np.linalg.norm(high - low)) / 2, 1e-3)
    axes = []
    for j in robot:
        for screw in j.model.free.drawn:
            u = screw.real.array
            u = u if u.any() else screw.dual.array
            half = AXIS * size * u / np.linalg.norm(u)
            axes.append((j, -half, half, "hinge", j.name))
    centre, scale = (low + high) / 2, 0.8 * SIZE / size
    lines = []
    for on, a, b, kind, says in [*bones, *axes]:
        ends_ = [_seen(at(on)[:3, :3] @ p + at(on)[:3, 3] - centre, scale) for p in (a, b)]
        lines.append(Line(*ends_[0], *ends_[1], kind, says))
    data = {
        "q": q.tolist(), "azimuth": AZIMUTH, "elevation": ELEVATION, "centre": centre.tolist(), "scale": scale,
        "joints": [_moving(j, q) for j in robot],
        "lines": [[-1 if on is None else on.index, a.tolist(), b.tolist()] for on, a, b, *_ in [*bones, *axes]],
    }  # fmt: skip
    return Skeleton(lines, _sliders(robot, q), data)


def _seen(p: np.ndarray, scale: float) -> tuple[float, float]:
    """Where a point appears, x to the right and y downwards."""
    ca, sa, ce, se = cos(AZIMUTH), sin(AZIMUTH), cos(ELEVATION), sin(ELEVATION)
    x, y, z = p
    return round(scale * (ca * y - sa * x), 1), round(-scale * (ce * z - se * (ca * x + sa * y)), 1)


def _moving(j: Joint, q: np.ndarray) -> dict[str, Any]:
    """A joint as the page's script moves it: a dual angle about an axis; others stand still."""
    found: dict[str, Any] = {
        "parent": -1 if j.parent is None else j.parent.index, "placement": j.placement.array[:3].ravel().tolist(),
        "offset": [0.0, 0.0], "terms": [], "axis": None,
        "still": j.model.motion(q[j.q].tolist()).array[:3].ravel().tolist(),
    }  # fmt: skip
    if isinstance(j.model, Axial):
        found["axis"] = [float(x) for x in j.model.axis]
        found["offset"] = [float(j.model.offset.real), float(j.model.offset.dual)]
        units = zip(range(j.q.start, j.q.stop), j.model.units, strict=True)
        found["terms"] = [[i, float(u.real), float(u.dual)] for i, u in units]
    return found


def _sliders(robot: Robot, q: np.ndarray) -> list[Slider]:
    lower, upper = ranges(robot)
    found = []
    for j in robot:
        if isinstance(j.model, Axial) and j.mimic is None:
            for i, what in zip(range(j.q.start, j.q.stop), j.model.coordinates, strict=True):
                low, high = float(lower[i]), float(upper[i])
                if not isfinite(low) or not isfinite(high) or low >= high:
                    low, high = -pi, pi
                unit = "rad" if what == "angle" else "m"
                found.append(Slider(j.name, i, low, high, float(np.clip(q[i], low, high)), unit))
    return found
