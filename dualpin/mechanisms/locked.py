"""A robot with some coordinates held constant: a smaller robot, on which the same algorithms run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from .. import functions
from ..arguments import shaped
from ..errors import ArgumentError
from ..model.joints import Axial
from ..model.robot import Frame, Joint, Link, Robot


def held(robot: Robot, free: Sequence[int], at: np.ndarray) -> Robot:
    """The robot whose coordinates other than `free` stand at `at`: they are constants of its joints.

    An axial joint is an axis times sum(u_i q_i) + offset, in dual numbers; what is held joins the offset.
    """
    place = {old: new for new, old in enumerate(free)}
    new: dict[Joint | None, Joint | None] = {None: None}
    end = 0
    for j in robot:
        indices = range(j.q.start, j.q.stop)
        if not isinstance(j.model, Axial):
            raise ArgumentError(f"Locked: joint {j.name!r} is {j.kind}; joints about an axis can be held")
        keep = [k for k, i in enumerate(indices) if i in place]
        offset = j.model.offset
        for k, i in enumerate(indices):
            offset = offset if i in place else offset + j.model.units[k] * float(at[i])
        model = Axial(j.model.axis, *(j.model.units[k] for k in keep), kind=j.kind, offset=offset,
                      coordinates=tuple(j.model.coordinates[k] for k in keep))  # fmt: skip
        lower, upper = (tuple(x[k] for k in keep) if x else () for x in (j.limits.lower, j.limits.upper))
        span = slice(place[indices[keep[0]]], place[indices[keep[-1]]] + 1) if keep else slice(end, end)
        end = max(end, span.stop)
        new[j] = replace(
            j, model=model, parent=new[j.parent], q=span, v=span, limits=replace(j.limits, lower=lower, upper=upper),
            mimic=j.mimic if keep else None, armature=tuple(j.armature[k] for k in keep),
        )  # fmt: skip
    frames = tuple(Frame(f.name, f.role, new[f.joint], f.placement, f.parent) for f in robot.frames)
    links = tuple(Link(k.name, k.inertia, new[k.joint], k.placement) for k in robot.links)
    return replace(robot, joints=tuple(j for j in new.values() if j is not None), frames=frames, links=links)


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
        self.at = shaped("Locked: at", at, robot.nq, batch=False).copy()
        if self.free != sorted(self.free):
            raise ArgumentError(f"Locked: free {self.free} must be in ascending order")
        self.rest = held(robot, self.free, self.at)
        """The robot that is left: its coordinates are the free ones."""

    @property
    def nv(self) -> int:
        """How many coordinates move."""
        return len(self.free)

    def spread(self, x: ArrayLike, others: ArrayLike = 0.0) -> np.ndarray:
        """Free coordinates (..., n) among all (..., nq)."""
        x = shaped("Locked: an array", x, self.nv)
        full = np.broadcast_to(others, (*x.shape[:-1], self.robot.nq)).copy()
        full[..., self.free] = x
        return full

    def q(self, x: ArrayLike) -> np.ndarray:
        """All coordinates, from the free ones."""
        return self.spread(x, self.at)

    def fk(self, x: ArrayLike, frame: str | int | Frame) -> np.ndarray:
        """Pose of a frame, shape (..., 4, 4)."""
        return functions.fk(self.rest, x, self._frame(frame))

    def jacobian(self, x: ArrayLike, frame: str | int | Frame, reference: str = "world") -> np.ndarray:
        """Shape (..., 6, n)."""
        return functions.jacobian(self.rest, x, self._frame(frame), reference)

    def rnea(self, x: ArrayLike, v: ArrayLike, a: ArrayLike) -> np.ndarray:
        """Inverse dynamics of the free coordinates, shape (..., n)."""
        return functions.rnea(self.rest, x, v, a)

    def reactions(self, x: ArrayLike, v: ArrayLike, a: ArrayLike) -> np.ndarray:
        """Constraint forces of the locked coordinates, shape (..., nv - n), in their order."""
        locked = [i for i in range(self.robot.nv) if i not in self.free]
        return functions.rnea(self.robot, self.q(x), self.spread(v), self.spread(a))[..., locked]

    def crba(self, x: ArrayLike) -> np.ndarray:
        """Mass matrix, shape (..., n, n)."""
        return functions.crba(self.rest, x)

    def bias(self, x: ArrayLike, v: ArrayLike) -> np.ndarray:
        """C v + g, shape (..., n)."""
        return functions.bias(self.rest, x, v)

    def aba(self, x: ArrayLike, v: ArrayLike, tau: ArrayLike) -> np.ndarray:
        """Forward dynamics M^-1 (tau - C v - g), shape (..., n)."""
        return functions.aba(self.rest, x, v, tau)

    def _frame(self, frame: str | int | Frame) -> str | int:
        """A frame of the whole robot as one of what is left."""
        return self.robot.frames.index(frame) if isinstance(frame, Frame) else frame
