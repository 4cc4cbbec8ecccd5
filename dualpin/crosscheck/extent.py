"""Sizes of the summands of a term, relative to the term itself (cancellation).

A recursion carries inertias, momenta and forces about points far from the body: the joints before it, or
the world's origin.  There a body of inertia I has m r^2 + I, and what is left of I after the way
back has lost the digits of m r^2 / I.  So it is for a heavy wheel on a large car.  The same holds of
positions: a velocity seen in a frame is what is left of  v + r x w.

Each degree of freedom has the weight  D^2 = |w|^2 sum (J + 2 |h| r + m r^2) + |v|^2 sum m  over the
bodies that it moves, for its screw w + eps v and distances r from the world's origin.  Then terms of
M are no larger than D_i D_j, and forces no larger than D_i times the accelerations that D weighs.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from ..model.robot import Robot

Array = np.ndarray

ORDINARY = 16.0
"""How far these sizes exceed the largest entry of a term on ordinary robots: 1.5 to 30 in the median of panda, ur5,
talos and anymal_c, and 225 to 10^6 on those that lose digits.  `tolerance.PER_BODY` allows for the ordinary."""


class Extent:
    """Of a robot in a batch of states.

    Parameters
    ----------
    positions : ndarray (n, njoints, 3)
        Of the bodies, as the oracle has them.
    states : mapping
        "v", "a", "f_ext" of the batch.
    """

    def __init__(self, robot: Robot, positions: Array, states: Mapping[str, Array]) -> None:
        self.robot, self.positions, self.states = robot, positions, states
        self.distance = np.linalg.norm(positions, axis=-1)
        self.reach = 1.0 + self.distance.max(axis=-1, initial=0.0)
        self.outreach = self.reach + _farthest_centre(robot)
        self.mass = sum(abs(float(j.inertia.mass)) for j in robot)
        self.gravity = float(np.linalg.norm(robot.gravity.array))

    def part(self, rows: slice) -> Extent:
        """Of some of the states; of all of them itself, with what it knows."""
        if len(self.positions[rows]) == len(self.positions):
            return self
        return Extent(self.robot, self.positions[rows], {key: x[rows] for key, x in self.states.items()})

    @cached_property
    def weights(self) -> Array:
        """D, shape (n, nv)."""
        n, robot = len(self.distance), self.robot
        m = np.array([abs(float(j.inertia.mass)) for j in robot])
        h = np.array([np.linalg.norm(j.inertia.moment.array) for j in robot])
        J = np.array([max(abs(float(x)) for row in j.inertia.rotational.rows for x in row) for j in robot])
        turning = J + 2 * h * self.distance + m * self.distance**2
        for j in reversed(robot):
            if j.parent is not None:
                turning[:, j.parent.index] += turning[:, j.index]
                m[j.parent.index] += m[j.index]
        D = np.zeros((n, robot.nv))
        for j in robot:
            for k, s in zip(range(j.v.start, j.v.stop), j.model.screws, strict=True):
                w, v = (sum(float(x) ** 2 for x in part) for part in (s.real, s.dual))
                D[:, k] += w * turning[:, j.index] + v * m[j.index]
        return np.sqrt(D)

    @property
    def heaviest(self) -> Array:
        return self.weights.max(axis=-1, initial=0.0)

    @cached_property
    def speed(self) -> Array:
        return np.linalg.norm(self.states["v"], axis=-1)

    @cached_property
    def acceleration(self) -> Array:
        return np.linalg.norm(self.states["a"], axis=-1)

    @property
    def fall(self) -> float:
        """Gravity, as D weighs it."""
        return self.gravity * self.mass**0.5

    @property
    def swing(self) -> Array:
        """Velocity-dependent accelerations, as D weighs them."""
        return self.speed * np.linalg.norm(self.weights * self.states["v"], axis=-1)

    def push(self, a: Array) -> Array:
        """Accelerations, as D weighs them."""
        return np.linalg.norm(self.weights * a, axis=-1)

    @property
    def efforts(self) -> Array:
        """All accelerations together, as D weighs them."""
        return self.push(self.states["a"]) + self.swing + self.fall

    def f_ext(self) -> Array:
        wrenches = np.linalg.norm(self.states["f_ext"].reshape(len(self.reach), -1, 6), axis=-1)
        return (wrenches * (1 + self.distance)).sum(axis=-1)


def _farthest_centre(robot: Robot) -> float:
    """The largest distance of a body's centre of mass from its frame."""
    bodies = [(abs(float(j.inertia.mass)), [float(x) for x in j.inertia.moment]) for j in robot]
    return max((float(np.linalg.norm(h)) / m for m, h in bodies if m), default=0.0)
