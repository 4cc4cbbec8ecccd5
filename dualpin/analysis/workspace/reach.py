"""Reachability maps: the cells of space that a frame can reach, and the directions in each.

Forward kinematics of random configurations within the limits marks a grid of cells times directions.  The index of a
cell is the share of directions in which the frame reached it (Zacharias, Borst & Hirzinger 2007): a lower bound that
rises with the number of samples.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import choice, count, real, shaped
from ...call.arguments import check_robot
from ...delegates import home
from ...errors import ArgumentError, ShapeError
from ...files import replacing
from ...functions import fk
from ...model.limits import ranges
from ...model.robot import Frame, Robot

AXES = ("x", "y", "z")
BLOCK = 1 << 15
"""Configurations of a block, whose poses fit into the cache."""
PILOT = 20_000
"""Configurations of the pilot run that determines the size of the grid."""
EACH, FEWEST, MOST = 5, 20, 60
"""Where no size of cells is given: configurations for each direction of a cell of the cube around all, and
the bounds of the number of cells along its side."""
PAD = 0.02
"""Margin around the cells of the pilot run, relative to the longest side; the grid grows if necessary."""


@dataclass(eq=False)
class ReachMap:
    """Where a frame can be; made by `dualpin.reach_map`.

    Attributes
    ----------
    robot : Robot
    frame : Frame
    cell : float
        Side of a cell [m].
    origin : ndarray, shape (3,)
        Corner of the first cell in the world [m].
    seen : ndarray of bool, shape (nx, ny, nz, bins)
        In which directions the frame was in a cell: bands of equal height of the sphere, each cut into
        sectors from -pi on, all of one area; times turns about the direction.
    counts : ndarray of int, shape (nx, ny, nz)
        Configurations in each cell.
    axis : str
        The frame's axis whose direction is meant.
    bands, rolls : int
    samples : int
    seed : int
    seconds : float
        Computing time [s].
    coverage : float
        Share of the last configurations that marked no new cell and direction; near 1 only cells that few
        configurations reach are missing.
    """

    robot: Robot
    frame: Frame
    cell: float
    origin: np.ndarray
    seen: np.ndarray
    counts: np.ndarray
    axis: str
    bands: int
    rolls: int
    samples: int
    seed: int
    seconds: float = 0.0
    coverage: float = 0.0

    @property
    def shape(self) -> tuple[int, int, int]:
        x, y, z = self.counts.shape
        return x, y, z

    @property
    def index(self) -> np.ndarray:
        """The share of directions seen in each cell, (nx, ny, nz)."""
        return self.seen.mean(axis=-1)

    @property
    def volume(self) -> float:
        """Volume of the reached cells [m^3]."""
        return float((self.counts > 0).sum() * self.cell**3)

    @property
    def mean(self) -> float:
        """Of the index, over the cells that were reached."""
        return float(self.index[self.counts > 0].mean()) if self.counts.any() else 0.0

    def centres(self, axis: int) -> np.ndarray:
        """Coordinates of the cells' centres along x (0), y (1) or z (2) [m]."""
        return np.asarray(self.origin[axis] + self.cell * (np.arange(self.shape[axis]) + 0.5))

    def at(self, points: ArrayLike) -> np.ndarray:
        """The index at points (..., 3) in the world; 0 outside the grid."""
        p = shaped("ReachMap.at: points", points, 3)
        i = np.floor((p - self.origin) / self.cell).astype(int)
        inside = ((i >= 0) & (i < self.shape)).all(axis=-1)
        return np.where(inside, self.index[tuple(np.moveaxis(np.where(inside[..., None], i, 0), -1, 0))], 0.0)

    def survey(
        self, measure: Callable[[np.ndarray], np.ndarray], how: str = "max", n: int = 20_000, seed: int = 1
    ) -> np.ndarray:
        """The largest or least value of a measure in each cell, (nx, ny, nz); nan without a configuration.

        Parameters
        ----------
        measure : callable
            Takes q (m, nq), returns numbers (m,): of `dualpin.manipulability`, `dualpin.payload_capacity`, ...
        how : "max" or "min"
        n, seed : int
            How many random configurations.

        Examples
        --------
        >>> import dualpin as dp
        >>> arm = dp.load("ur5")
        >>> reach = dp.reach_map(arm, "tool0", n=50_000)
        >>> capacity = reach.survey(lambda q: dp.payload_capacity(arm, q, "tool0"), "min", n=2000)
        >>> capacity.shape == reach.shape
        True
        """
        worst = -np.inf if choice("survey: how", how, ("max", "min")) == "max" else np.inf
        best = np.full(self.counts.size, worst)
        pick = np.maximum if how == "max" else np.minimum
        for q in _configurations(self.robot, self.frame, count("survey: n", n), seed):
            i = np.floor((fk(self.robot, q, self.frame)[:, :3, 3] - self.origin) / self.cell).astype(np.int64)
            inside = ((i >= 0) & (i < self.shape)).all(axis=1)
            value = np.asarray(measure(q), float)
            if value.shape != (len(q),):
                raise ShapeError(f"survey: the measure of {len(q)} configurations has shape {value.shape}")
            pick.at(best, np.ravel_multi_index(tuple(i[inside].T), self.shape), value[inside])
        return np.where(np.isinf(best) & (best == worst), np.nan, best).reshape(self.shape)

    def save(self, path: str | PathLike[str]) -> None:
        """Everything as a compressed NumPy file, `.npz`; the directions as bits."""
        with replacing(path) as beside, beside.open("wb") as file:
            np.savez_compressed(
                file, seen=np.packbits(self.seen, axis=-1), bins=self.seen.shape[-1], counts=self.counts,
                cell=self.cell, origin=self.origin, axis=self.axis, bands=self.bands, rolls=self.rolls,
                samples=self.samples, seed=self.seed, robot=self.robot.name, frame=self.frame.name,
            )  # fmt: skip

    def plot(self, path: Any = None, **more: np.ndarray) -> Any:
        """Slices through the middle of the index, and of surveys of the same grid given by name."""
        return home("ReachMap.plot")(self, path, **more)

    def _repr_html_(self) -> str:
        return str(home("ReachMap._repr_html_")(self))

    def __repr__(self) -> str:
        return (
            f"<reach of {self.frame.name!r} of {self.robot.name!r}: {self.volume:.3g} m^3, cells of {self.cell:.3g} m, "
            f"mean index {self.mean:.3f}, {self.samples} samples>"
        )


def reach_map(
    robot: Robot,
    frame: str | int | Frame | None = None,
    *,
    n: int = 10_000_000,
    cell: float | None = None,
    axis: str = "z",
    bands: int = 6,
    rolls: int = 1,
    seed: int = 0,
    memory: float = 512.0,
    progress: Callable[[int, int], object] | None = None,
) -> ReachMap:
    """The reachability map of a frame: positions, and directions at each.

    Parameters
    ----------
    robot : Robot
    frame : str, int or Frame, optional
        By default the last one.
    n : int
        Random configurations, uniform within the limits.
    cell : float, optional
        Side of a cell [m]; by default 1/20 to 1/60 of the longest side, finer with more samples.
    axis : "x", "y" or "z"
        The frame's axis whose directions are distinguished.
    bands : int
        Bands of the sphere; each has twice as many sectors, all of one area: 72 directions by default.
    rolls : int
        Rotations about the direction that are distinguished; with more than 1 the index is that of orientations.
    seed : int
    memory : float
        Limit of the map's memory [MB].
    progress : callable, optional
        Called with (done, n); by default a line on a terminal's stderr.

    Returns
    -------
    ReachMap

    Raises
    ------
    ArgumentError
        If the base floats, nothing moves the frame, or the map would not fit into `memory`.

    References
    ----------
    Zacharias, Borst & Hirzinger (2007), capturing robot workspace structure.

    Examples
    --------
    >>> import dualpin as dp
    >>> reach = dp.reach_map(dp.load("ur5"), "tool0", n=100_000)
    >>> 2 < reach.volume < 5, float(reach.at([2.0, 0, 0]))
    (True, 0.0)
    """
    found: ReachMap | None = None
    tell = progress or _teller()
    n = count("reach_map: n", n, 1)
    for found in growing(robot, frame, n=n, cell=cell, axis=axis, bands=bands, rolls=rolls, seed=seed, memory=memory):
        tell(found.samples, n)
    assert found is not None
    return found


def growing(
    robot: Robot, frame: str | int | Frame | None = None, *, n: int, cell: float | None, axis: str, bands: int,
    rolls: int, seed: int, memory: float,
) -> Iterator[ReachMap]:  # fmt: skip
    """Yield the growing map, so that an interruption leaves a valid one."""
    check_robot(robot, "reach_map")
    at = robot.frames[-1] if frame is None else robot.frame(frame)
    _check(robot, at)
    column = AXES.index(choice("reach_map: axis", axis, AXES))
    bands, rolls = count("reach_map: bands", bands, 1), count("reach_map: rolls", rolls, 1)
    bins, most = 2 * bands * bands * rolls, real("reach_map: memory", memory, "MB", above=0) * 1e6
    started = time.perf_counter()
    places = np.concatenate([fk(robot, q, at)[:, :3, 3] for q in _configurations(robot, at, PILOT, seed)])
    low, high = places.min(axis=0), places.max(axis=0)
    side = float((high - low).max())
    cells = float(np.clip((n / (EACH * bins)) ** (1 / 3), FEWEST, MOST))
    size = max(side, 1e-3) / cells if cell is None else real("reach_map: cell", cell, "m", above=0)
    low, high = low - PAD * side - size / 2, high + PAD * side + size / 2
    shape = np.ceil((high - low) / size).astype(int)
    _fits(shape, bins, most, size)
    empty = np.zeros((*shape, bins), bool)
    found = ReachMap(robot, at, size, low, empty, np.zeros(shape, np.int64), axis, bands, rolls, 0, seed)
    poses = np.empty((BLOCK, 4, 4))
    for q in _configurations(robot, at, n, seed):
        T = fk(robot, q, at, out=poses[: len(q)])
        i = np.floor((T[:, :3, 3] - found.origin) / size).astype(np.int64)
        if (i < 0).any() or (i >= found.shape).any():
            _grow(found, i, most)
            i = np.floor((T[:, :3, 3] - found.origin) / size).astype(np.int64)
        flat = (i[:, 0] * found.shape[1] + i[:, 1]) * found.shape[2] + i[:, 2]
        marks, seen = flat * bins + _bin(T[:, :3, :3], column, bands, rolls), found.seen.reshape(-1)
        found.coverage = float(seen[marks].mean())
        seen[marks] = True
        found.counts.reshape(-1)[:] += np.bincount(flat, minlength=found.counts.size)
        found.samples += len(q)
        found.seconds = time.perf_counter() - started
        yield found


def _bin(R: np.ndarray, column: int, bands: int, rolls: int) -> np.ndarray:
    """Which direction, and turn about it.  Bands of equal height have equal areas (Archimedes)."""
    x, y, z = (R[:, i, column] for i in range(3))
    band = np.minimum(((z + 1) * (bands / 2)).astype(np.int64), bands - 1)
    sectors = 2 * bands
    sector = ((np.arctan2(y, x) / (2 * np.pi) + 0.5) * sectors).astype(np.int64) % sectors
    found = np.maximum(band, 0) * sectors + sector
    if rolls == 1:
        return found
    other = R[:, :, (column + 1) % 3]  # its angle from the meridian, in the plane across the direction
    around, along = y * other[:, 0] - x * other[:, 1], other[:, 2]
    roll = ((np.arctan2(around, along) / (2 * np.pi) + 0.5) * rolls).astype(np.int64) % rolls
    return found * rolls + roll


def _configurations(robot: Robot, frame: Frame, n: int, seed: int) -> Iterator[np.ndarray]:
    """Blocks of random configurations; joints that do not move the frame keep their neutral value."""
    rng = np.random.default_rng(count("seed", seed))
    lower, upper = ranges(robot)
    chain = list(frame.joint.chain) if frame.joint else []
    moving = np.unique(np.concatenate([np.arange(j.q.start, j.q.stop) for j in chain])) if chain else np.zeros(0, int)
    still = np.where(np.isnan(robot.neutral), 0.0, robot.neutral)
    plain = [j.q for j in robot if not j.quaternions and j.mimic is None]
    for at in plain:
        still[at] = np.clip(still[at], lower[at], upper[at])
    for start in range(0, n, BLOCK):
        q = np.tile(still, (min(BLOCK, n - start), 1))
        q[:, moving] = lower[moving] + (upper - lower)[moving] * rng.random((len(q), len(moving)))
        for j in chain:
            for quaternion in j.quaternions if j.mimic is None else ():
                r = rng.standard_normal((len(q), 4))
                q[:, quaternion] = r / np.linalg.norm(r, axis=1, keepdims=True)
        yield q


def _grow(found: ReachMap, cells: np.ndarray, most: float) -> None:
    """Extend the grid where positions are outside, with some reserve."""
    before = np.maximum(0, -cells.min(axis=0))
    after = np.maximum(0, cells.max(axis=0) + 1 - np.array(found.shape))
    before, after = before + (before > 0), after + (after > 0)
    _fits(np.array(found.shape) + before + after, found.seen.shape[-1], most, found.cell)
    pad = list(zip(before.tolist(), after.tolist(), strict=True))
    found.seen, found.counts = np.pad(found.seen, [*pad, (0, 0)]), np.pad(found.counts, pad)
    found.origin = found.origin - found.cell * before


def _fits(shape: np.ndarray, bins: int, most: float, cell: float) -> None:
    need = float(np.prod(shape.astype(float))) * (bins + 8)
    if need > most:
        better = cell * (need / most) ** (1 / 3) * 1.01
        raise ArgumentError(
            f"reach_map: cells of {cell:.3g} m would take {need / 1e6:.0f} MB; cell={better:.2g} fits, or give memory="
        )


def _check(robot: Robot, frame: Frame) -> None:
    if frame.joint is None:
        raise ArgumentError(f"reach_map: nothing moves frame {frame.name!r}, it stands on the ground")
    if robot.floating:
        raise ArgumentError(f"reach_map: the base of {robot.name} floats, so the frame goes anywhere; fix the base")


def _teller() -> Callable[[int, int], object]:
    if not sys.stderr.isatty():
        return lambda done, n: None
    return lambda done, n: print(f"\rreach: {100 * done / n:3.0f} % ", end="\n" if done == n else "", file=sys.stderr)
