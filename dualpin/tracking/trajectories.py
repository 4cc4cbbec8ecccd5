"""Trajectories of a frame: pose and twist as functions of time.

A trajectory is a description (`Circle(0.1, 10)`) until it is bound to where a motion starts:
``at(T0)`` gives a function t -> (pose, twist).  Poses are homogeneous (..., 4, 4); twists are
[w; v] (..., 6) with world axes, v the velocity of the frame's origin.  t may be an array (n,): the
results are then (n, ..., 4, 4) and (n, ..., 6), with the batch axes of T0 in between.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import choice, numbers, real, shaped
from ..delegates import home
from ..errors import ArgumentError, ShapeError
from ..spatial import compose, exp, from_matrix, inverse, log, to_matrix

Sampled = tuple[np.ndarray, np.ndarray]
Bound = Callable[[np.ndarray], Sampled]
PLANES = {"xy": (0, 1), "yz": (1, 2), "zx": (2, 0)}


class Trajectory:
    """A motion still to be bound to its start."""

    duration: float
    """Once through [s]."""
    start: Any = None
    """The configuration it starts from, when it was given one."""

    def at(self, T0: np.ndarray) -> Bound:
        """The motion that starts at the poses T0 (..., 4, 4)."""
        raise NotImplementedError  # every trajectory has its own

    def plot(self, T0: ArrayLike | None = None, axes: Any = None) -> Any:
        """Draw the path from a pose (the identity by default); returns the axes.  Needs the extra `figures`."""
        return home("Trajectory.plot")(self, T0, axes)


@dataclass(frozen=True)
class Circle(Trajectory):
    """A circle through the start, orientation kept.

        p(t) = c + r (cos(w t) u + sin(w t) v),   c = p(0) - r u,   w = 2 pi / period

    Parameters
    ----------
    radius : float
        [m]
    period : float
        [s]
    plane : "xy", "yz" or "zx"
        Of the world; u and v are its two axes in this order.
    start : array_like, shape (..., nq), optional
        Where the robot starts; `dualpin.track` takes it for q0.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> pose, twist = dp.Circle(0.1, 2 * np.pi).at(np.eye(4))(0.0)
    >>> pose[:3, 3].tolist(), twist[4:].tolist()
    ([0.0, 0.0, 0.0], [0.1, 0.0])
    """

    radius: float
    period: float
    plane: str = "xy"
    start: Any = None

    def __post_init__(self) -> None:
        _settle(self, radius=real("Circle: radius", self.radius, "m", least=0))
        _settle(self, period=real("Circle: period", self.period, "s", above=0))
        choice("Circle: plane", self.plane, tuple(PLANES))

    @property
    def duration(self) -> float:  # type: ignore[override]
        return self.period

    def at(self, T0: np.ndarray) -> Bound:
        w, (i, j) = 2 * pi / self.period, PLANES[self.plane]

        def circle(t: np.ndarray) -> Sampled:
            t = np.asarray(t, dtype=float)
            pose, twist = _still(T0, t)
            c, s = (_spread(f(w * t), T0) for f in (np.cos, np.sin))
            pose[..., i, 3] += self.radius * (c - 1)
            pose[..., j, 3] += self.radius * s
            twist[..., 3 + i] = -self.radius * w * s
            twist[..., 3 + j] = self.radius * w * c
            return pose, twist

        return circle


@dataclass(frozen=True)
class Line(Trajectory):
    """A straight line at constant speed, orientation kept; at rest once there.

    Parameters
    ----------
    displacement : array_like, shape (3,)
        From the start, world axes [m].
    duration : float
        [s]

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> pose, twist = dp.Line([0.0, 0.0, 0.3], duration=2.0).at(np.eye(4))(1.0)
    >>> pose[:3, 3].tolist(), twist[3:].tolist()
    ([0.0, 0.0, 0.15], [0.0, 0.0, 0.15])
    """

    displacement: Any
    duration: float
    start: Any = None

    def __post_init__(self) -> None:
        shaped("Line: displacement", self.displacement, 3, batch=False)
        _settle(self, duration=real("Line: duration", self.duration, "s", above=0))

    def at(self, T0: np.ndarray) -> Bound:
        d = np.asarray(self.displacement, dtype=float)

        def line(t: np.ndarray) -> Sampled:
            t = np.asarray(t, dtype=float)
            pose, twist = _still(T0, t)
            pose[..., :3, 3] += _spread(np.clip(t / self.duration, 0, 1), T0)[..., None] * d
            twist[..., 3:] = _spread(_moving(t, self.duration), T0)[..., None] * d / self.duration
            return pose, twist

        return line


@dataclass(frozen=True)
class Screw(Trajectory):
    """Screw linear interpolation from the start to a target pose: one constant screw motion.

        X(t) = X_0 (X_0^-1 X_1)^(t / duration)

    Parameters
    ----------
    target : array_like, shape (4, 4) or (8,)
        Homogeneous matrix or unit dual quaternion, in the world.
    duration : float
        [s]; at rest once there.

    References
    ----------
    Kavan et al. (2008), ScLERP.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> pose, twist = dp.Screw(dp.spatial.exp([0, 0, 1, 0, 0, 2]), 1.0).at(np.eye(4))(0.5)
    >>> pose[:3, 3].tolist(), twist.round(12).tolist()
    ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0, 0.0, 2.0])
    """

    target: Any
    duration: float
    start: Any = None

    def __post_init__(self) -> None:
        _pose("Screw: target", self.target)
        _settle(self, duration=real("Screw: duration", self.duration, "s", above=0))

    def at(self, T0: np.ndarray) -> Bound:
        return _screws(from_matrix(T0), [_pose("Screw: target", self.target)], [0.0, self.duration])


@dataclass(frozen=True)
class Waypoints(Trajectory):
    """Poses at given times, joined by constant screw motions; the first leg begins at the start.

    Parameters
    ----------
    poses : sequence of array_like, each (4, 4) or (8,)
    times : sequence of float
        When each is reached [s], increasing and positive.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> there = dp.spatial.to_matrix(dp.spatial.exp([0, 0, 0, 0, 0, 1]))
    >>> motion = dp.Waypoints([there, np.eye(4)], times=[1.0, 2.0]).at(np.eye(4))
    >>> motion(1.5)[0][:3, 3].tolist()
    [0.0, 0.0, 0.5]
    """

    poses: Sequence[Any]
    times: Sequence[float]
    start: Any = None

    def __post_init__(self) -> None:
        if len(self.poses) != len(self.times) or not len(self.times):
            raise ShapeError(f"Waypoints: one time for each pose expected, got {len(self.poses)} and {len(self.times)}")
        steps = np.diff([0.0, *map(float, self.times)])
        if not (steps > 0).all() or not np.isfinite(steps).all():
            raise ArgumentError(f"Waypoints: times increasing from above 0 expected, got {list(self.times)}")
        for i, X in enumerate(self.poses):
            _pose(f"Waypoints: pose {i}", X)

    @property
    def duration(self) -> float:  # type: ignore[override]
        return float(self.times[-1])

    def at(self, T0: np.ndarray) -> Bound:
        return _screws(from_matrix(T0), [_pose("Waypoints", X) for X in self.poses], [0.0, *map(float, self.times)])


@dataclass(frozen=True)
class Callback(Trajectory):
    """A function of one instant, t -> (pose (4, 4), twist (6,)), checked whenever it is called."""

    function: Callable[[float], Any]
    duration: float = float("nan")

    def at(self, T0: np.ndarray) -> Bound:
        batch = T0.shape[:-2]

        def sampled(t: np.ndarray) -> Sampled:
            times = np.asarray(t, dtype=float)
            poses, twists = zip(*(self._one(float(x), batch) for x in times.ravel()), strict=True)
            return np.stack(poses).reshape(*times.shape, *batch, 4, 4), np.stack(twists).reshape(
                *times.shape, *batch, 6
            )

        return sampled

    def _one(self, t: float, batch: tuple[int, ...]) -> Sampled:
        result = self.function(t)
        if not isinstance(result, tuple) or len(result) != 2:
            raise ShapeError(
                f"trajectory({t:g}): a tuple (pose (4, 4), twist (6,)) expected, got {type(result).__name__}"
                + (f" of length {len(result)}" if isinstance(result, (tuple, list)) else "")
            )
        out = []
        for what, value, tail in (("pose", result[0], (4, 4)), ("twist", result[1], (6,))):
            x = numbers(f"trajectory({t:g}): {what}", value)
            if x.shape not in (tail, batch + tail):
                choices = f"{tail}" + (f" or {batch + tail}" if batch else "")
                raise ShapeError(f"trajectory({t:g}): {what} of shape {choices} expected, got {x.shape}")
            if not np.isfinite(x).all():
                raise ArgumentError(f"trajectory({t:g}): {what} has entries that are not finite")
            out.append(np.broadcast_to(x, batch + tail))
        skewness = np.abs(np.swapaxes(out[0][..., :3, :3], -1, -2) @ out[0][..., :3, :3] - np.eye(3)).max(initial=0.0)
        if skewness > 1e-6:
            raise ArgumentError(
                f"trajectory({t:g}): the pose's 3x3 block is not a rotation, |R^T R - 1| = {skewness:.3g}"
            )
        return out[0], out[1]


def _settle(trajectory: Trajectory, **values: float) -> None:
    """Checked values into a frozen description."""
    for name, x in values.items():
        object.__setattr__(trajectory, name, x)


def _screws(X0: np.ndarray, poses: Sequence[np.ndarray], times: Sequence[float]) -> Bound:
    """Legs of constant twist through the poses."""
    corners = [X0, *(np.broadcast_to(X, X0.shape) for X in poses)]
    steps = [log(compose(inverse(a), b)) for a, b in pairwise(corners)]
    knots = np.asarray(times)

    def motion(t: np.ndarray) -> Sampled:
        t = np.asarray(t, dtype=float)
        leg = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(steps) - 1)
        length = knots[leg + 1] - knots[leg]
        s = _spread(np.clip((t - knots[leg]) / length, 0, 1), X0, 1)[..., None]
        begin, twist = np.stack(corners)[leg], np.stack(steps)[leg]
        pose = to_matrix(compose(begin, exp(twist * s)))
        rate = twist / _spread(length, X0, 1)[..., None] * _spread(_moving(t, knots[-1]), X0, 1)[..., None]
        # the body twist is constant along a leg; at the origin with world axes it turns with the frame
        R = pose[..., :3, :3]
        return pose, np.concatenate([_turned(R, rate[..., :3]), _turned(R, rate[..., 3:])], axis=-1)

    return motion


def _turned(R: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.einsum("...ij,...j->...i", R, x)


def _still(T0: np.ndarray, t: np.ndarray) -> Sampled:
    """The start, at rest, for every instant."""
    batch = T0.shape[:-2]
    return np.broadcast_to(T0, (*t.shape, *T0.shape)).copy(), np.zeros((*t.shape, *batch, 6))


def _spread(x: np.ndarray, T0: np.ndarray, tail: int = 2) -> np.ndarray:
    """x (n,) with an axis of one for each batch axis of T0."""
    return np.asarray(x).reshape(np.shape(x) + (1,) * (T0.ndim - tail))


def _moving(t: np.ndarray, duration: float) -> np.ndarray:
    return ((t >= 0) & (t <= duration)).astype(float)


def _pose(what: str, X: ArrayLike) -> np.ndarray:
    x = numbers(what, X)
    if x.shape == (4, 4):
        return from_matrix(x)
    if x.shape != (8,):
        raise ShapeError(f"{what}: a homogeneous matrix (4, 4) or a dual quaternion (8,) expected, got shape {x.shape}")
    return x


def as_trajectory(value: Any) -> Trajectory:
    """A trajectory, or a function of time as one; anything else is refused."""
    if isinstance(value, Trajectory):
        return value
    if callable(value):
        return Callback(value)
    raise ArgumentError(
        f"track: a trajectory expected (Circle, Line, Screw, Waypoints, or a function t -> (pose, twist)), "
        f"got {type(value).__name__}"
    )
