"""The limits of a robot's coordinates: what its joints and those that follow them allow together.

A joint that follows another (mimic) states its limits in its own coordinate, so they bound the leader's too:

    lower <= multiplier q + offset <= upper
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isfinite, pi

import numpy as np

from ..scalars import Scalar
from .robot import Joint, Robot

HUGE = {"angle": 200.0, "length": 100.0}
"""Bounds farther out [rad, m] are placeholders, not stops: half of 32 turns; ten times a large gantry."""
FREE = {"angle": pi, "length": 1.0}
"""How far either way a coordinate without limits is sampled [rad, m]: one turn; two metres."""

ROUNDING = 1e-12
"""Of (limit - offset) / multiplier, relative to the bounds: three operations, with room for decimals in files."""


def position_limits(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bounds of the coordinates, each (nq,); infinite where there is none.

    The limits of followers are included.  Where they leave a leader nothing, its own limits stand
    alone: `remarks` says so.
    """
    own, (lower, upper) = _own(robot), _common(robot)
    empty = _empty(own, (lower, upper))
    return np.where(empty, own[0], lower), np.where(empty, own[1], upper)


def velocity_limits(robot: Robot) -> np.ndarray:
    """Of the velocities, either way, (nv,); infinite where there is none, 0 where the description says 0."""
    most = np.full(robot.nv, inf)
    for j in robot:
        if j.mimic is None:
            most[j.v] = j.limits.velocity
    for j in robot:
        ratio = abs(_number(j.coupling[0]))
        if j.mimic is not None and ratio > 0 and j.limits.velocity > 0:
            most[j.v] = np.minimum(most[j.v], j.limits.velocity / ratio)
    return most


def ranges(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Finite ranges to take coordinates from, (nq,) each: the limits, or a turn (2 m) where there are none.

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
    """What is odd about the limits of leaders and followers, one sentence each."""
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
    """Bounds as the joints that follow none state them."""
    lower, upper = np.full(robot.nq, -inf), np.full(robot.nq, inf)
    for j in robot:
        if j.mimic is None:
            lower[j.q], upper[j.q] = j.limits.lower or -inf, j.limits.upper or inf
    return lower, upper


def _common(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Those of followers too; a bound that passes the opposite one by rounding only meets it."""
    lower, upper = _own(robot)
    for _, i, low, high in _followers(robot):
        slack = ROUNDING * max([1.0, *(abs(x) for x in (lower[i], upper[i]) if isfinite(x))])
        low = upper[i] if 0 < low - upper[i] <= slack else low
        high = lower[i] if 0 < lower[i] - high <= slack else high
        lower[i], upper[i] = max(lower[i], low), min(upper[i], high)
    return lower, upper


def _empty(own: tuple[np.ndarray, np.ndarray], common: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Where followers leave nothing of bounds that were in order."""
    return (common[0] > common[1]) & (own[0] <= own[1])


def _followers(robot: Robot) -> Iterator[tuple[Joint, int, float, float]]:
    """(follower, index of its leader's coordinate, what its limits allow that coordinate)."""
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
    """nan for what is no number: a symbol bounds nothing."""
    try:
        return float(x)
    except (TypeError, ValueError):
        return float("nan")
