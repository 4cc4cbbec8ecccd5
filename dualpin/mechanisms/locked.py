"""A robot with some coordinates held: the same algorithms on what is left."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .. import functions
from ..errors import ArgumentError, ShapeError
from ..model.robot import Frame, Robot


class Locked:
    """A robot whose coordinates other than `free` are held at the values `at`.

    Parameters
    ----------
    robot : Robot
        With one velocity for each coordinate (no floating base).
    free : sequence of int
        Indices of the coordinates that move.
    at : array_like, shape (nq,)
        Where the others are held (free entries are ignored).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.mechanisms.TwoC(0.1, 0.07)
    >>> dp.mechanisms.Locked(arm.robot, [0, 2], np.zeros(4)).nv
    2
    """

    def __init__(self, robot: Robot, free: Sequence[int], at: ArrayLike) -> None:
        if robot.nq != robot.nv:
            raise ArgumentError(f"Locked: {robot.name} has nq = {robot.nq} and nv = {robot.nv}; equal ones are needed")
        self.robot, self.free = robot, list(free)
        if len(set(self.free)) != len(self.free) or not all(0 <= i < robot.nq for i in self.free):
            raise ArgumentError(f"Locked: free {self.free} must name coordinates 0 to {robot.nq - 1}, each once")
        self.at = np.array(at, dtype=float)
        if self.at.shape != (robot.nq,):
            raise ShapeError(f"Locked: at of shape ({robot.nq},) expected, got {self.at.shape}")

    @property
    def nv(self) -> int:
        return len(self.free)

    def spread(self, x: ArrayLike, others: ArrayLike = 0.0) -> np.ndarray:
        """Free coordinates (..., n) among all (..., nq)."""
        x = np.asarray(x, dtype=float)
        if x.shape[-1:] != (self.nv,):
            raise ShapeError(f"Locked: an array of shape (..., {self.nv}) expected, got {x.shape}")
        full = np.broadcast_to(others, (*x.shape[:-1], self.robot.nq)).copy()
        full[..., self.free] = x
        return full

    def q(self, x: ArrayLike) -> np.ndarray:
        """All coordinates, from the free ones."""
        return self.spread(x, self.at)

    def fk(self, x: ArrayLike, frame: str | int | Frame) -> np.ndarray:
        """Pose of a frame, shape (..., 4, 4)."""
        return functions.fk(self.robot, self.q(x), frame)

    def jacobian(self, x: ArrayLike, frame: str | int | Frame, reference: str = "world") -> np.ndarray:
        """Shape (..., 6, n)."""
        return functions.jacobian(self.robot, self.q(x), frame, reference)[..., self.free]

    def rnea(self, x: ArrayLike, v: ArrayLike, a: ArrayLike) -> np.ndarray:
        """Inverse dynamics of the free coordinates, shape (..., n)."""
        return functions.rnea(self.robot, self.q(x), self.spread(v), self.spread(a))[..., self.free]

    def reactions(self, x: ArrayLike, v: ArrayLike, a: ArrayLike) -> np.ndarray:
        """What the locks must hold, shape (..., nv - n), in the order of the locked coordinates."""
        held = [i for i in range(self.robot.nv) if i not in self.free]
        return functions.rnea(self.robot, self.q(x), self.spread(v), self.spread(a))[..., held]

    def crba(self, x: ArrayLike) -> np.ndarray:
        """Mass matrix, shape (..., n, n)."""
        return functions.crba(self.robot, self.q(x))[..., self.free, :][..., self.free]

    def bias(self, x: ArrayLike, v: ArrayLike) -> np.ndarray:
        """C v + g, shape (..., n)."""
        return functions.bias(self.robot, self.q(x), self.spread(v))[..., self.free]

    def aba(self, x: ArrayLike, v: ArrayLike, tau: ArrayLike) -> np.ndarray:
        """Forward dynamics M^-1 (tau - C v - g), shape (..., n)."""
        rest = np.asarray(tau, dtype=float) - self.bias(x, v)
        return np.linalg.solve(self.crba(x), rest[..., None])[..., 0]
