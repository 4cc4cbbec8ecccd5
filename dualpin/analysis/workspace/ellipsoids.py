"""Manipulability: ellipsoids of velocity, force and acceleration.

Rotation and translation have different units, of the frame and of joints; a characteristic length L
makes them comparable:

    [w; v / L] = D J S (v_joints in rad/s, slides over L)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import choice, flag, real
from ...call.arguments import check_robot
from ...errors import ArgumentError
from ...functions import jacobian, minv
from ...model.memory import memory
from ...model.robot import Frame, Robot

TASKS = {"pose": slice(0, 6), "position": slice(3, 6), "orientation": slice(0, 3)}
KINDS = ("velocity", "force", "dynamic")
SAMPLES = 500
"""Configurations that the characteristic length is looked for over."""


@dataclass(frozen=True, eq=False)
class Manipulability:
    """An ellipsoid at each configuration; made by `dualpin.manipulability`.

    Attributes
    ----------
    kind : "velocity", "force" or "dynamic"
    index : ndarray, shape (...)
        The product of the semi-axes, proportional to the volume; sqrt(det(J J^T)) for velocities (Yoshikawa).
    axes : ndarray, shape (..., r)
        Semi-axes, descending; infinite for forces that need no joint torques.
    directions : ndarray, shape (..., r, r)
        Unit vectors of the task (w, v, or both as [w; v / L]), in columns as the semi-axes; in world axes.
    condition : ndarray, shape (...)
        Longest semi-axis over the shortest, 1 to infinity; its inverse is the isotropy.
    length : float
        The characteristic length L [m] that was used.
    """

    kind: str
    index: np.ndarray
    axes: np.ndarray
    directions: np.ndarray
    condition: np.ndarray
    length: float


def manipulability(
    robot: Robot,
    q: ArrayLike,
    frame: str | int | Frame,
    kind: str = "velocity",
    task: str = "pose",
    *,
    length: float | None = None,
    effort: bool = False,
) -> Manipulability:
    """Ellipsoids of the velocities, forces or accelerations that unit joint velocities or torques give a frame.

        velocity   {D J v : |v| <= 1}            force   {f : |J^T f| <= 1}
        dynamic    {D J M^-1 tau : |tau| <= 1}   accelerations from rest, gravity left aside

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    frame : str, int or Frame
        Twists are about its origin, in world axes.
    kind : "velocity", "force" or "dynamic"
    task : "pose", "position" or "orientation"
    length : float, optional
        Characteristic length [m]; by default `characteristic_length`.  Only "pose" and robots with
        sliding joints depend on it.
    effort : bool
        With forces and accelerations: torques up to the description's effort limits instead of 1.

    Returns
    -------
    Manipulability

    Raises
    ------
    ArgumentError, FrameNotFoundError, ShapeError

    References
    ----------
    Yoshikawa (1985), manipulability and dynamic manipulability; Angeles (1992) for the length.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.from_dh([(0, 0, 1, 0)] * 2, joints="RR")
    >>> float(dp.manipulability(arm, [0.3, np.pi / 2], -1, task="position").index.round(12))  # no joint lifts it
    0.0
    >>> float(dp.manipulability(dp.load("ur5"), np.ones(6), "tool0", task="position").condition.round(3))
    10.201
    """
    check_robot(robot, "manipulability")
    choice("manipulability: kind", kind, KINDS)
    rows = TASKS[choice("manipulability: task", task, tuple(TASKS))]
    at = robot.frame(frame)
    needed = task == "pose" or bool(slides(robot).any())
    L = real("manipulability: length", length, "m", above=0) if length is not None else None
    L = L or (characteristic_length(robot, at) if needed else 1.0)
    J = jacobian(robot, q, at, "local_world_aligned")
    if task == "pose":
        J[..., 3:, :] /= L
    S = np.where(slides(robot), L, 1.0)
    torque = _effort(robot) if flag("manipulability: effort", effort) else 1 / S
    if kind == "dynamic":
        A = (J @ minv(robot, q))[..., rows, :] * torque
    elif kind == "force":
        A = J[..., rows, :] / torque
    else:
        A = J[..., rows, :] * S
    if A.shape[-1] < A.shape[-2]:  # with fewer joints than directions the other axes are zero
        A = np.concatenate([A, np.zeros((*A.shape[:-1], A.shape[-2] - A.shape[-1]))], axis=-1)
    U, axes, _ = np.linalg.svd(A, full_matrices=False)
    if kind == "force":
        with np.errstate(divide="ignore"):
            axes, U = (1 / axes)[..., ::-1], U[..., ::-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        condition = axes[..., 0] / axes[..., -1]
    condition = np.where(np.isnan(condition), np.inf, condition)
    return Manipulability(kind, np.prod(axes, axis=-1), axes, U, condition, L)


def characteristic_length(robot: Robot, frame: str | int | Frame) -> float:
    """The length that makes the least condition number of a frame's Jacobian least, over the limits [m].

    Over `SAMPLES` random configurations of a fixed seed, so accurate to some percent; 1 if it has no effect.

    Parameters
    ----------
    robot : Robot
    frame : str, int or Frame

    Returns
    -------
    float

    Raises
    ------
    FrameNotFoundError

    References
    ----------
    Angeles (1992), the design of isotropic manipulator architectures in the presence of redundancies.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.analysis.workspace import characteristic_length
    >>> 0.1 < characteristic_length(dp.load("ur5"), "tool0") < 0.5
    True
    """
    at = robot.frame(frame)
    kept = memory(robot)
    if ("characteristic_length", at) not in kept:
        kept["characteristic_length", at] = _length(robot, at)
    found: float = kept["characteristic_length", at]
    return found


def _length(robot: Robot, frame: Frame) -> float:
    q, _, _ = robot.sample(SAMPLES, seed=0)
    J = jacobian(robot, q, frame, "local_world_aligned")
    J = J[..., np.abs(J).max(axis=(0, 1), initial=0.0) > 0]
    slide = slides(robot)[np.abs(jacobian(robot, q, frame)).max(axis=(0, 1), initial=0.0) > 0]
    turning, moving = np.linalg.norm(J[:, :3]), np.linalg.norm(J[:, 3:])
    if not turning or not moving or not J.shape[-1]:
        return 1.0
    rank = int(np.median(np.linalg.matrix_rank(J)))

    def least(L: float) -> float:
        scaled = J.copy()
        scaled[:, 3:] /= L
        values = np.linalg.svd(scaled * np.where(slide, L, 1.0), compute_uv=False)
        with np.errstate(divide="ignore"):
            return float((values[:, 0] / values[:, rank - 1]).min())

    tried = moving / turning * np.geomspace(0.05, 20, 61)
    return float(min(tried, key=least))


def slides(robot: Robot) -> np.ndarray:
    """Which velocities are translations, (nv,)."""
    found = np.zeros(robot.nv, bool)
    for j in robot:
        for k, s in j.dofs:
            found[k] = not any(float(x) for x in s.real)
    return found


def _effort(robot: Robot) -> np.ndarray:
    """Torque limits of the description, (nv,); an error where there is none."""
    limit = np.zeros(robot.nv)
    for j in robot:
        if j.mimic is None:
            limit[j.v] = j.limits.effort
    missing = [j.name for j in robot if j.mimic is None and not (np.isfinite(limit[j.v]) & (limit[j.v] > 0)).all()]
    if missing:
        raise ArgumentError(f"effort limits of {', '.join(missing[:5])} are not in the description of {robot.name}")
    return limit
