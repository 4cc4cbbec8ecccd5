"""The limits of a robot's coordinates, including those of mimic joints.

The limits of a mimic joint are in its own coordinate, and bound that of its leader:

    lower <= multiplier q + offset <= upper
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isfinite, pi

import numpy as np

from ..scalars import Scalar
from .robot import Joint, Robot

HUGE = {"angle": 200.0, "length": 100.0}
"""Larger bounds [rad, m] are placeholders, not stops: about 32 turns; ten times a large gantry."""
FREE = {"angle": pi, "length": 1.0}
"""A coordinate without limits is sampled between plus and minus this value [rad, m]."""

ROUNDING = 1e-12
"""Relative rounding of (limit - offset) / multiplier: three operations, and decimals in files."""


def position_limits(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bounds of the coordinates, each (nq,); infinite where there is none.

    The limits of mimic joints are included.  If they leave no value for a leader, only its own limits count,
    and `remarks` reports it.
    """
    own, (lower, upper) = _own(robot), _common(robot)
    empty = _empty(own, (lower, upper))
    return np.where(empty, own[0], lower), np.where(empty, own[1], upper)


def velocity_limits(robot: Robot) -> np.ndarray:
    """Limits of the absolute velocities, (nv,); infinite where there is none, 0 where the description says 0."""
    most = np.full(robot.nv, inf)
    for j in robot:
        if j.mimic is None:
            most[j.v] = j.limits.velocity
    for j in robot:
        ratio = abs(_number(j.coupling[0]))
        if j.mimic is not None and ratio > 0 and j.limits.velocity > 0:
            most[j.v] = np.minimum(most[j.v], j.limits.velocity / ratio)
    return most


def effort_limits(robot: Robot) -> np.ndarray:
    """Limits of the absolute torques and forces, (nv,); infinite where the description has none above 0."""
    most = np.full(robot.nv, inf)
    for j in robot:
        if j.mimic is None and j.limits.effort > 0:
            most[j.v] = j.limits.effort
    return most


def ranges(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Finite ranges for sampling coordinates, (nq,) each: the limits, or one turn (2 m) where there are none.

    Bounds beyond `HUGE` count as none.  The turn is centred between such bounds if that is no huge
    number too, else at zero; next to a single bound it reaches at least half a turn inwards.
    """
    lower, upper = (x.copy() for x in position_limits(robot))
    for i, what in _coordinates(robot):
        free, huge = FREE.get(what, 1.0), HUGE.get(what, inf)
        low, high = (x if abs(x) <= huge else np.copysign(inf, x) for x in (lower[i], upper[i]))
        if not isfinite(low) and not isfinite(high):
            middle = lower[i] / 2 + upper[i] / 2 if isfinite(lower[i]) and isfinite(upper[i]) else 0.0
            middle = middle if abs(middle) <= huge else 0.0
            low, high = middle - free, middle + free
        lower[i] = low if isfinite(low) else min(-free, high - free)
        upper[i] = max(lower[i], high if isfinite(high) else max(free, low + free))
    return lower, upper


def remarks(robot: Robot) -> list[str]:
    """Remarks about inconsistent or huge limits, one sentence each."""
    empty, found = _empty(_own(robot), _common(robot)), []
    huge = [j.name for j in robot if any(_beyond(j))]
    if huge:
        found.append(
            f"limit: {', '.join(huge)}: farther than {HUGE['angle']:g} rad or {HUGE['length']:g} m, which counts as "
            "no limit where configurations are sampled"
        )
    for leader in robot:
        if leader.mimic is None and empty[leader.q].any():
            names = ", ".join(repr(j.name) for j, i, *_ in _followers(robot) if i == leader.q.start)
            found.append(
                f"limit: joint {leader.name!r} and those that follow it ({names}) are nowhere within their limits "
                "together; the limits of the followers are not used"
            )
    return found


def _own(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of the joints that have coordinates of their own."""
    lower, upper = np.full(robot.nq, -inf), np.full(robot.nq, inf)
    for j in robot:
        if j.mimic is None:
            lower[j.q], upper[j.q] = j.limits.lower or -inf, j.limits.upper or inf
    return lower, upper


def _common(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """With those of mimic joints; a bound that passes the opposite one only by rounding is set equal to it."""
    lower, upper = _own(robot)
    for _, i, low, high in _followers(robot):
        slack = ROUNDING * max([1.0, *(abs(x) for x in (lower[i], upper[i]) if isfinite(x))])
        low = upper[i] if 0 < low - upper[i] <= slack else low
        high = lower[i] if 0 < lower[i] - high <= slack else high
        lower[i], upper[i] = max(lower[i], low), min(upper[i], high)
    return lower, upper


def _empty(own: tuple[np.ndarray, np.ndarray], common: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Where valid bounds become empty by the limits of mimic joints."""
    return (common[0] > common[1]) & (own[0] <= own[1])


def _followers(robot: Robot) -> Iterator[tuple[Joint, int, float, float]]:
    """(mimic joint, index of its leader's coordinate, bounds of that coordinate by the mimic joint's limits)."""
    for j in robot:
        if j.mimic is None or not (j.limits.lower or j.limits.upper):
            continue
        multiplier, offset = map(_number, j.coupling)
        low, high = (j.limits.lower or (-inf,))[0], (j.limits.upper or (inf,))[0]
        if low > high or not isfinite(multiplier) or not isfinite(offset):
            continue  # crossed limits bound nothing
        if multiplier == 0:
            inside = low <= offset <= high
            yield (j, j.q.start, -inf, inf) if inside else (j, j.q.start, inf, -inf)
        else:
            a, b = (low - offset) / multiplier, (high - offset) / multiplier
            yield j, j.q.start, min(a, b), max(a, b)


def _beyond(j: Joint) -> Iterator[bool]:
    """Whether its finite bounds are huge."""
    for bounds in (j.limits.lower, j.limits.upper):
        for x, what in zip(bounds, j.model.coordinates, strict=False):
            yield isfinite(x) and abs(x) > HUGE.get(what, inf)


def _coordinates(robot: Robot) -> Iterator[tuple[int, str]]:
    """(index in q, what it is) of each coordinate."""
    for j in robot:
        if j.mimic is None:
            yield from zip(range(j.q.start, j.q.stop), j.model.coordinates, strict=True)


def _number(x: Scalar) -> float:
    """The number, or nan for a symbol."""
    try:
        return float(x)
    except (TypeError, ValueError):
        return float("nan")
