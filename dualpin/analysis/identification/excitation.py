"""Exciting motions: finite Fourier series with a small condition number."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, pi
from os import PathLike
from typing import Any

import numpy as np

from ...arguments import count, numbers, real
from ...delegates import home
from ...errors import ArgumentError, ShapeError, nearest
from ...extras import extra
from ...files import write_text
from ...model.limits import ranges
from ...model.robot import Robot
from .base import BaseParameters, base_parameters
from .fourier import Fourier

Progress = Callable[[int, float], object]
"""Progress of a search: evaluations and the least condition number."""

ACCELERATION = 2 * pi
"""[rad/s^2, m/s^2] Where nothing is said: descriptions state no limits of accelerations."""
VELOCITY = 2 * pi
"""[rad/s, m/s] At most, where the description says more or nothing."""
SHOWN = 1e7
"""A larger condition number is useless: relative noise of 1e-3 would exceed the parameters."""


@dataclass(frozen=True)
class Bounds:
    """Limits of a motion; arrays (nv,)."""

    lower: np.ndarray
    upper: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


@dataclass(frozen=True, eq=False)
class Excitation:
    """An exciting motion; made by `dualpin.excite`.

    Attributes
    ----------
    base : BaseParameters
        The parameters that it excites.
    motion : Fourier
    bounds : Bounds
    condition : float
        Of the base regressor over one period.
    first : float
        The condition number of the best random motion, where the search began.
    evaluations : int
    """

    base: BaseParameters
    motion: Fourier
    bounds: Bounds
    condition: float
    first: float
    evaluations: int

    @property
    def robot(self) -> Robot:
        return self.base.robot

    @property
    def period(self) -> float:
        return self.motion.period

    def sample(self, rate: float = 100.0, periods: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """t (n,), q, v, a (n, nv) at this sampling rate [1/s]."""
        real("sample: rate", rate, "1/s", above=0)
        t = np.arange(round(count("sample: periods", periods, 1) * self.period * rate)) / rate
        return (t, *self.motion.at(t))

    def margins(self) -> dict[str, np.ndarray]:
        """Distance to each limit over the whole continuous period, (nv,); none is negative."""
        (low, high), (v0, v1), (a0, a1) = map(self.motion.range, range(3))
        return {
            "lower": low - self.bounds.lower,
            "upper": self.bounds.upper - high,
            "velocity": self.bounds.velocity - np.maximum(-v0, v1),
            "acceleration": self.bounds.acceleration - np.maximum(-a0, a1),
        }

    def to_csv(self, path: str | PathLike[str] | None = None, rate: float = 100.0) -> str:
        """t, then q, v and a of each coordinate, a line a sample; written to `path` too."""
        t, q, v, a = self.sample(rate)
        names = [f"{b.name}" if b.model.nv == 1 else f"{b.name}.{x}" for b in self.robot if b.mimic is None
                 for x in b.model.velocity_names]  # fmt: skip
        quoted = [n if n.replace("_", "").isalnum() else '"' + n.replace('"', '""') + '"' for n in names]
        head = ",".join(["t", *(f"{kind} {n}".replace(f'{kind} "', f'"{kind} ') for kind in "qva" for n in quoted)])
        rows = (",".join(map(repr, row)) for row in np.column_stack([t, q, v, a]).tolist())
        text = "\n".join([head, *rows]) + "\n"
        if path is not None:
            write_text(path, text)
        return text

    def plot(self, path: Any = None) -> Any:
        """Positions, velocities and accelerations over their limits."""
        return home("Excitation.plot")(self, path)

    def __repr__(self) -> str:
        return (
            f"<exciting motion of {self.robot.name!r}: {self.period:g} s, {self.motion.a.shape[1]} harmonics, "
            f"condition {self.condition:.4g} for {len(self.base)} base parameters>"
        )


def excite(
    robot: Robot,
    limits: Mapping[str, Any] | None = None,
    *,
    period: float = 10.0,
    harmonics: int = 5,
    samples: int = 100,
    share: float = 0.95,
    base: BaseParameters | None = None,
    weights: Any = None,
    iterations: int = 30,
    starts: int = 20,
    seed: int = 0,
    progress: Progress | None = None,
) -> Excitation:
    """A periodic motion that excites the base parameters well: small condition number within limits.

        minimise  cond(W^1/2 Y_b)      q = q0 + sum a_l / (w l) sin(w l t) - b_l / (w l) cos(w l t)

    Limits of position, velocity and acceleration hold over the whole continuous period.  **Collisions are not
    checked**, neither of links with each other nor with the surroundings: look at the motion before a robot
    runs it.  It starts and ends at rest.

    Parameters
    ----------
    robot : Robot
        On a fixed base, of joints whose coordinates add.
    limits : mapping, optional
        "lower", "upper", "velocity", "acceleration": numbers or arrays (nv,).  By default those of the
        description (at most 2 pi rad/s, m/s), and accelerations of 2 pi.
    period : float
        [s]
    harmonics : int
        Of the fundamental 1 / period.
    samples : int
        States of the period that count.
    share : float
        How much of the limits is used, at most.
    base : BaseParameters, optional
        The parameters to excite; by default `dualpin.base_parameters(robot)`.
    weights : array_like, shape (nv,), optional
        1 / variance of each torque.
    iterations, starts, seed : int
        Of the search: steps of a quasi-Newton method from the best of so many random motions.
    progress : callable, optional
        Called with (evaluations, condition number); by default a line on a terminal's stderr.

    Returns
    -------
    Excitation

    Raises
    ------
    ArgumentError, ShapeError

    References
    ----------
    Swevers, Ganseman, Tukel, De Schutter & Van Brussel (1997), optimal robot excitation and
    identification; Gautier & Khalil (1992), exciting trajectories.

    Examples
    --------
    >>> import dualpin as dp
    >>> motion = dp.excite(dp.from_dh([(0, 0, 0.5, 0)] * 2, joints="RR"), iterations=3)
    >>> bool(motion.condition <= motion.first), bool(min(x.min() for x in motion.margins().values()) >= 0)
    (True, True)
    """
    minimize = extra("scipy.optimize", "identify", "excite").minimize
    base = base_parameters(robot) if base is None else base
    if not isinstance(base, BaseParameters) or base.robot is not robot:
        raise ArgumentError(
            "excite: base: the base parameters of this robot expected, as dualpin.base_parameters makes them"
        )
    odd = [j.name for j in robot if not j.model.additive]
    if odd or robot.nv == 0:
        raise ArgumentError(
            f"excite: joints whose coordinates add expected; not so {', '.join(odd) or 'none is there'}"
        )
    bounds = _bounds(robot, limits)
    shapes = _Shapes(
        bounds, real("excite: period", period, "s", above=0), count("excite: harmonics", harmonics, 2), _share(share)
    )
    t = np.arange(count("excite: samples", samples, 2)) * period / samples
    root = np.ones(robot.nv) if weights is None else np.sqrt(numbers("excite: weights", weights))
    if root.shape != (robot.nv,) or not np.isfinite(root).all():
        raise ShapeError(f"excite: weights of shape ({robot.nv},), finite and not negative, expected")
    tell = progress or _teller()
    done, best = 0, inf

    def regressor(x: np.ndarray) -> np.ndarray:
        Y = base.regressor(*shapes.motion(x).at(t)) * root[:, None]
        return Y.reshape(-1, len(base))

    def cost(x: np.ndarray) -> float:
        nonlocal done, best
        Y = regressor(x)
        # of the small Gram matrix: beyond 1e7 rounding hides the condition number, and all are equally bad
        eigenvalues = np.linalg.eigvalsh(Y.T @ Y)
        value = float(np.log(eigenvalues[-1] / max(eigenvalues[0], 1e-14 * eigenvalues[-1]))) / 2
        done, best = done + 1, min(best, value)
        if done % 50 == 0:
            tell(done, float(np.exp(best)))
        return value

    rng = np.random.default_rng(count("excite: seed", seed))
    tried = [rng.standard_normal(shapes.size) for _ in range(count("excite: starts", starts, 1))]
    start = min(tried, key=cost)
    first = best
    found = start
    if count("excite: iterations", iterations):
        found = minimize(cost, start, method="L-BFGS-B", options={"maxiter": iterations, "maxfun": 10**9}).x
    if progress is None and sys.stderr.isatty():
        print(file=sys.stderr)
    condition = float(np.linalg.cond(regressor(found)))
    if not condition < SHOWN:
        raise ArgumentError(f"excite: no motion within these limits shows all {len(base)} base parameters")
    return Excitation(base, shapes.motion(found), bounds, condition, float(np.exp(first)), done)


class _Shapes:
    """Motions within bounds, by unbounded numbers x: per coordinate the offset, a size, and 2 N - 2 of a shape.

    Rest at the ends takes two: sum a_l = 0 and sum l b_l = 0.  The shape is made as large as bounds of
    its extremes and the limits allow, times a share between 0 and 1; the offset then uses the room left.
    """

    def __init__(self, bounds: Bounds, period: float, harmonics: int, share: float) -> None:
        self.bounds, self.period, self.share = bounds, period, share
        n = np.arange(1, harmonics + 1)
        self.still_a, self.still_b = _null(np.ones(harmonics)), _null(n.astype(float))
        self.size = len(bounds.lower) * (2 + 2 * (harmonics - 1))

    def motion(self, x: np.ndarray) -> Fourier:
        n = len(self.bounds.lower)
        rows = x.reshape(n, -1)
        split = self.still_a.shape[1]
        a, b = rows[:, 2 : 2 + split] @ self.still_a.T, rows[:, 2 + split :] @ self.still_b.T
        shape = Fourier(self.period, np.zeros(n), a, b)
        (low, high), (v0, v1), (a0, a1) = map(shape.bound, range(3))
        room = (self.bounds.upper - self.bounds.lower) * self.share
        middle = (self.bounds.upper + self.bounds.lower) / 2
        tiny = np.finfo(float).tiny
        most = np.minimum.reduce([
            room / np.maximum(high - low, tiny),
            self.share * self.bounds.velocity / np.maximum(np.maximum(-v0, v1), tiny),
            self.share * self.bounds.acceleration / np.maximum(np.maximum(-a0, a1), tiny),
        ])  # fmt: skip
        size = most / (1 + np.exp(-2.0 - rows[:, 1]))
        free = np.maximum(0.0, room - size * (high - low)) / 2
        offset = middle + free * np.tanh(rows[:, 0]) - size * (high + low) / 2
        return Fourier(self.period, offset, size[:, None] * a, size[:, None] * b)


def _null(row: np.ndarray) -> np.ndarray:
    """An orthonormal basis, in columns, of the null space of a row."""
    return np.asarray(np.linalg.svd(row[None, :])[2][1:].T)


def _share(share: Any) -> float:
    if real("excite: share", share, above=0) > 1:
        raise ArgumentError(f"excite: share = {share!r}, a number from 0 to 1 expected")
    return float(share)


def _bounds(robot: Robot, limits: Mapping[str, Any] | None) -> Bounds:
    """The given limits, completed by the description's."""
    if limits is not None and not isinstance(limits, Mapping):
        raise ArgumentError(
            f"excite: limits: a mapping such as {{'velocity': 1.0}} expected, got {type(limits).__name__}"
        )
    lower, upper = ranges(robot)
    most = robot.velocity_limit
    known = {
        "lower": lower, "upper": upper,
        "velocity": np.where(most > 0, np.minimum(most, VELOCITY), 1.0),
        "acceleration": np.full(robot.nv, ACCELERATION),
    }  # fmt: skip
    for name, value in (limits or {}).items():
        if name not in known:
            raise ArgumentError(f"excite: limit {name!r} is not known; {nearest(str(name), known, 'limits')}")
        x = numbers(f"excite: {name}", value)
        if x.shape not in ((), (robot.nv,)) or not np.isfinite(x).all():
            raise ShapeError(
                f"excite: {name}: a finite number, or ({robot.nv},) of them, expected, got shape {x.shape}"
            )
        known[name] = np.broadcast_to(x, (robot.nv,))
    found = Bounds(**known)
    bad = (found.upper <= found.lower) | (found.velocity <= 0) | (found.acceleration <= 0)
    if bad.any():
        names = [b.name for b in robot if bad[b.v].any()]
        raise ArgumentError(f"excite: limits leave no room to move: {', '.join(names)}; give limits= that do")
    return found


def _teller() -> Progress:
    if not sys.stderr.isatty():
        return lambda done, condition: None
    return lambda done, condition: print(
        f"\rexcite: {done} motions, condition {condition:.4g} ", end="", file=sys.stderr
    )
