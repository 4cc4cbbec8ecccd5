"""The distance of a configuration to a singularity, and its reciprocal screw.

At a singularity there is a wrench on which no joint does work: the screw reciprocal to all joint screws
(Ball 1900).  The frame cannot make twists that would do work on it, and the bearings carry it without
joint torques.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...algebra import Motor
from ...arguments import choice, count, real, shaped
from ...call.arguments import check_robot
from ...errors import ArgumentError
from ...functions import fk, integrate, jacobian, jacobian_dot
from ...model.robot import Frame, Robot
from .ellipsoids import TASKS, characteristic_length, slides

FULL = 1e-6
"""Relative to the largest singular value over random configurations: smaller ones are zero everywhere."""
STEPS = 50
"""Of the search for the nearest singular configuration."""
CLOSE = 1e-10
"""Where it has arrived: the singular value over the largest."""


@dataclass(frozen=True, eq=False)
class Singularity:
    """Distances to singularities and their screws; made by `dualpin.singularity`.

    Attributes
    ----------
    distance : ndarray, shape (...)
        The least singular value of the scaled Jacobian: the least change of it that makes it singular
        (Eckart & Young 1936).
    lost : Motor, shape (...)
        The unit wrench f + eps n on which joints do the least work, about the world's origin: at a
        singularity the screw that is reciprocal to all joint screws.  `.axis`, `.point`, `.pitch`, `.kind`.
    work : ndarray, shape (..., nv)
        Its power for a unit velocity of each joint; zeros at a singularity.
    joints : ndarray, shape (..., nv)
        The unit joint velocity that moves the frame least.
    rank : int
        Rank of the Jacobian at most configurations; less than six for robots with fewer than six joints.
    length : float
        Characteristic length [m].
    """

    distance: np.ndarray
    lost: Motor
    work: np.ndarray
    joints: np.ndarray
    rank: int
    length: float


def singularity(
    robot: Robot, q: ArrayLike, frame: str | int | Frame, task: str = "pose", *, length: float | None = None
) -> Singularity:
    """The distance to singularity, and the screw that is lost there.

        J = U diag(s) V^T        distance s_r,  wrench D u_r,  joints v_r

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    frame : str, int or Frame
    task : "pose", "position" or "orientation"
        The components of the motion; with "position" the wrench is a force through the frame's origin.
    length : float, optional
        Characteristic length [m]; by default `characteristic_length`.

    Returns
    -------
    Singularity

    Raises
    ------
    ArgumentError
        If no joint moves the frame.
    FrameNotFoundError, ShapeError

    References
    ----------
    Ball (1900), reciprocal screws; Klein & Blaho (1987), the least singular value as a measure.

    Examples
    --------
    A stretched elbow loses the force along the arm, through shoulder and wrist:

    >>> import numpy as np, dualpin as dp
    >>> arm = dp.from_dh([(0, 0, 0, -np.pi / 2), (0, 0, 1, 0), (0, 0, 1, 0)], joints="RRR")
    >>> found = dp.singularity(arm, [0, 0.5, 0], -1, "position")
    >>> float(found.distance.round(12)), np.abs(found.lost.direction).round(3).tolist()
    (0.0, [0.878, 0.0, 0.479])
    """
    check_robot(robot, "singularity")
    at = robot.frame(frame)
    L = characteristic_length(robot, at) if length is None else real("singularity: length", length, "m", above=0)
    if robot.nv == 0:
        raise ArgumentError(f"singularity: {robot.name} has no joint")
    rank, ever = _rank(robot, at, L, task)
    J = jacobian(robot, q, at, "local_world_aligned")
    D, S = np.repeat([1.0, 1 / L], 3), np.where(slides(robot), L, 1.0)
    U, s, Vh = np.linalg.svd(ever.T @ (D[:, None] * J * S), full_matrices=False)
    row = D * (U[..., :, rank - 1] @ ever.T)  # [n; f] about the frame's origin
    origin = fk(robot, q, at)[..., :3, 3]
    wrench = Motor(row[..., 3:], row[..., :3] + np.cross(origin, row[..., 3:]))
    work = np.einsum("...i,...ij->...j", row, J)
    return Singularity(s[..., rank - 1], wrench, work, Vh[..., rank - 1, :] * S, rank, L)


def nearest_singularity(
    robot: Robot, q: ArrayLike, frame: str | int | Frame, task: str = "pose", *, length: float | None = None,
    steps: int = STEPS,
) -> tuple[np.ndarray, float]:  # fmt: skip
    """A singular configuration near q, and how far it is in joint velocities [rad, or m over L].

    Newton's method on the least singular value, ds = u^T dJ v, from q along its gradient, without limits.  It
    finds a local solution, if any.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (nq,)
    frame, task, length
        As in `singularity`.
    steps : int
        After which it gives up.

    Returns
    -------
    q_singular : ndarray, shape (nq,)
    distance : float
        inf where none was found.

    Raises
    ------
    ArgumentError, ShapeError, FrameNotFoundError
        If an argument is not as described above.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> from dualpin.analysis.workspace import nearest_singularity
    >>> arm = dp.from_dh([(0, 0, 0, -np.pi / 2), (0, 0, 1, 0), (0, 0, 1, 0)], joints="RRR")
    >>> found, distance = nearest_singularity(arm, [0, 0.5, 0.2], -1, "position")
    >>> round(float(abs(found[2])), 6), round(distance, 6)
    (0.0, 0.2)
    """
    at = robot.frame(frame)
    L = characteristic_length(robot, at) if length is None else real("singularity: length", length, "m", above=0)
    x = shaped("nearest_singularity: q", q, robot.nq, batch=False)
    rank, ever = _rank(robot, at, L, task)
    D, S = np.repeat([1.0, 1 / L], 3), np.where(slides(robot), L, 1.0)
    start, total = x, np.zeros(robot.nv)
    for _ in range(count("nearest_singularity: steps", steps, 1)):
        J = ever.T @ (D[:, None] * jacobian(robot, x, at, "local_world_aligned") * S)
        U, s, Vh = np.linalg.svd(J, full_matrices=False)
        if s[rank - 1] <= CLOSE * s[0]:
            return x, float(np.linalg.norm(total / S))
        u, v = ever @ U[:, rank - 1], Vh[rank - 1]
        dJ = jacobian_dot(robot, np.broadcast_to(x, (robot.nv, robot.nq)), np.eye(robot.nv), at, "local_world_aligned")
        gradient = np.einsum("i,kij,j->k", u * D, dJ, S * v) * S
        if not gradient @ gradient > 1e-20:
            break
        # the point of the linearised surface s = 0 that is nearest to where the search began
        done = total / S
        step = gradient * (gradient @ done - s[rank - 1]) / (gradient @ gradient) - done
        step *= min(1.0, 0.5 / max(float(np.linalg.norm(step)), 1e-12))
        total = total + S * step
        x = integrate(robot, start, total)
    return x, np.inf


def _rank(robot: Robot, frame: Frame, L: float, task: str) -> tuple[int, np.ndarray]:
    """The Jacobian's rank at most configurations, and an orthonormal basis of the directions it ever has.

    Directions in which no configuration can move, as out of the plane of a planar arm, are left out.
    """
    counts = np.zeros((6, 1))
    counts[TASKS[choice("singularity: task", task, tuple(TASKS))]] = 1.0
    q, _, _ = robot.sample(20, seed=0)
    J = counts * jacobian(robot, q, frame, "local_world_aligned")
    J[:, 3:] /= L
    J = J * np.where(slides(robot), L, 1.0)
    U, s, _ = np.linalg.svd(np.concatenate(list(J), axis=1))
    size = s[0] if len(s) and s[0] > 0 else 1.0
    ever = U[:, : int((s > FULL * size).sum())]
    rank = int(np.max((np.linalg.svd(J, compute_uv=False) > FULL * size).sum(axis=-1)))
    if rank == 0:
        raise ArgumentError(f"singularity: no joint of {robot.name} moves frame {frame.name!r}")
    return rank, ever
