"""Null-space motions of a redundant arm: away from joint limits, or towards higher manipulability."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..errors import ArgumentError, ShapeError, nearest
from ..functions import jacobian, jacobian_dot
from ..model.robot import Frame, Robot

HUGE = 1e6  # rad or m
OBJECTIVES = ("joint_limits", "manipulability")
Objective = Callable[[np.ndarray], np.ndarray]


def objective_named(robot: Robot, frame: Frame, what: Any, gain: float, engine: str) -> Objective | None:
    """z(q), shape (B, nv), for the name or function given."""
    if what is None:
        return None
    if callable(what):
        return lambda q: _checked(robot, what(q), len(q))
    if what == "joint_limits":
        return lambda q: gain * away_from_limits(robot, q)
    if what == "manipulability":
        return lambda q: gain * manipulability_gradient(robot, frame, q, engine=engine)[1]
    raise ArgumentError(f"track: nullspace {what!r} is not known; {nearest(str(what), OBJECTIVES)}, or a function of q")


def _checked(robot: Robot, z: Any, n: int) -> np.ndarray:
    z = np.asarray(z, dtype=float)
    if z.shape not in ((n, robot.nv), (robot.nv,)):
        raise ShapeError(f"track: nullspace(q) of shape {(n, robot.nv)} expected, got {z.shape}")
    return np.broadcast_to(z, (n, robot.nv))


def away_from_limits(robot: Robot, q: np.ndarray) -> np.ndarray:
    """The downhill direction of sum ((q - middle) / range)^2 / 2, shape (..., nv); 0 where there are no limits.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)

    Returns
    -------
    ndarray, shape (..., nv)

    References
    ----------
    Liegeois (1977).

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.tracking import away_from_limits
    >>> robot = dp.load("panda")
    >>> away_from_limits(robot, (robot.lower + robot.upper) / 2).tolist()
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    z = np.zeros((*np.shape(q)[:-1], robot.nv))
    for j in robot:
        low, high = robot.lower[j.q], robot.upper[j.q]
        if np.abs(low).max(initial=0.0) > HUGE or np.abs(high).max(initial=0.0) > HUGE:
            continue  # a placeholder for no limit, or none
        if j.mimic is None and j.q.stop - j.q.start == j.v.stop - j.v.start and np.isfinite(high - low).all():
            z[..., j.v] = (low + (high - low) / 2 - q[..., j.q]) / np.where(high > low, high - low, np.inf) ** 2
    return z


def manipulability_gradient(
    robot: Robot, frame: Frame, q: np.ndarray, *, engine: str = "auto"
) -> tuple[np.ndarray, np.ndarray]:
    """w = sqrt(det J J^T), shape (...,), and its gradient w tr(J^+ dJ/dq_k), shape (..., nv).

    dJ/dq_k is the Jacobian's rate of change when joint k alone moves with unit speed.

    Parameters
    ----------
    robot : Robot
    frame : str, int or Frame
        A link or joint name, its index, or the frame itself.
    q : array_like, shape (..., nq)
    engine : "auto", "compiled" or "numpy"
        How it is computed, see docs/engine.md.

    Returns
    -------
    w : ndarray, shape (...,)
    slope : ndarray, shape (..., nv)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Yoshikawa (1985).

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.tracking import manipulability_gradient
    >>> robot = dp.load("panda")
    >>> w, slope = manipulability_gradient(robot, robot.frame("panda_hand"), (robot.lower + robot.upper) / 2)
    >>> slope.shape
    (9,)
    """
    q = np.asarray(q, dtype=float)
    J = jacobian(robot, q, frame, "local_world_aligned", engine=engine)
    dJ = jacobian_dot(robot, q[..., None, :], np.eye(robot.nv), frame, "local_world_aligned", engine=engine)
    s = np.linalg.svd(J, compute_uv=False)
    w = np.prod(s, axis=-1)
    return w, w[..., None] * np.einsum("...ji,...kij->...k", np.linalg.pinv(J), dJ)
