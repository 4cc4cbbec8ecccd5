"""Random states of a robot."""

from __future__ import annotations

from math import pi

import numpy as np

from ..arguments import count
from .limits import ranges
from .robot import Robot


def sample(robot: Robot, n: int | None = None, seed: int | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random states within the limits.

    Parameters
    ----------
    n : int, optional
        Number of states; None gives one state without a batch axis.
    seed : int, optional
        Seed of `numpy.random.default_rng`.

    Returns
    -------
    q, v, a : ndarray, shapes (n, nq), (n, nv), (n, nv)
        Coordinates uniform within the limits, those of followers (mimic) included; unit quaternions
        uniform; velocities uniform within theirs (at most 2 pi either way), accelerations uniform in
        [-2 pi, 2 pi].  Angles without limit are in [-pi, pi], lengths in [-1, 1]; limits beyond
        200 rad or 100 m count as none.

    Raises
    ------
    ArgumentError
        If `n` or `seed` is not a whole number.

    Examples
    --------
    >>> import dualpin as dp
    >>> q, v, a = dp.load("panda").sample(5, seed=0)
    >>> q.shape, v.shape
    ((5, 9), (5, 9))
    """
    states = 1 if n is None else count("sample: n", n)
    rng = np.random.default_rng(None if seed is None else count("sample: seed", seed))
    q, (lower, upper) = np.empty((states, robot.nq)), ranges(robot)
    for j in robot:
        if j.mimic is not None:
            continue
        for i in range(j.q.start, j.q.stop):
            share = rng.uniform(0, 1, states)
            q[:, i] = lower[i] * (1 - share) + upper[i] * share
        for quaternion in j.quaternions:
            r = rng.standard_normal((states, 4))
            q[:, quaternion] = r / np.linalg.norm(r, axis=-1, keepdims=True)
    most = robot.velocity_limit
    v = rng.uniform(-1, 1, (states, robot.nv)) * np.where(most > 0, np.minimum(most, 2 * pi), 1.0)
    a = rng.uniform(-1, 1, (states, robot.nv)) * 2 * pi
    return (q[0], v[0], a[0]) if n is None else (q, v, a)
