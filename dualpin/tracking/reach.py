"""Whether a pose is out of reach: a bound on distances that needs no search.

A point on a joint's axis is fixed in both bodies that the joint joins.  Choose one point on each
axis of the chain: whatever the joints do, the distance from the first (fixed on the ground) to the
last (fixed in the frame) is at most the sum of the distances between neighbours, and at least the
longest less all others.  The points are chosen to make that sum small; any choice gives a true bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from ..dual import Dual
from ..model.joints import Axial
from ..model.memory import memory
from ..model.robot import Frame, Joint, Robot
from ..spatial.pose import Pose
from .task import Rows, rows_of

ROUNDS = 100  # of reweighted least squares; the bound holds after any number of them


@dataclass(frozen=True)
class Reach:
    """How far a point of the frame can be from a point of the ground.

    Attributes
    ----------
    base : ndarray, shape (3,)
        A point on the first axis, in the world [m].
    tip : ndarray, shape (3,)
        A point on the last axis, in the frame [m]; where turns are free, the frame's origin or a point of its axis.
    nearest, farthest : float
        Bounds on their distance [m].
    first, last : str
        The joints of these axes.
    """

    base: np.ndarray
    tip: np.ndarray
    nearest: float
    farthest: float
    first: str
    last: str

    def distance(self, poses: np.ndarray) -> np.ndarray:
        """The distance from base to tip if the frame were at these poses (..., 4, 4) [m]."""
        there = np.einsum("...ij,j->...i", poses[..., :3, :3], self.tip) + poses[..., :3, 3]
        return np.linalg.norm(there - self.base, axis=-1)

    def excess(self, poses: np.ndarray) -> np.ndarray:
        """By how much the poses are out of reach [m]; 0 within the bounds (necessary, not sufficient)."""
        d = self.distance(poses)
        allowed = 1e-9 * (1 + self.farthest)  # rounding of the poses and of the chain's constants
        miss = np.maximum(d - self.farthest, self.nearest - d)
        return np.where(miss > allowed, miss, 0.0)


def reach(robot: Robot, frame: str | int | Frame, task: Any = "pose") -> Reach | None:
    """The bound for a frame; None where the chain has no axis, or a joint travels without limit.

    Parameters
    ----------
    robot : Robot
    frame : str, int or Frame
    task : str or six booleans
        Components of the task, see `dualpin.track`.  A free rotation counts as one more joint at the frame.

    Returns
    -------
    Reach or None

    Raises
    ------
    ArgumentError
        For a task that is not known.
    FrameNotFoundError

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.tracking import reach
    >>> robot = dp.load("ur5")
    >>> bound = reach(robot, "tool0")
    >>> bound.first, bound.last, round(bound.farthest, 3)
    ('shoulder_pan_joint', 'wrist_3_joint', 0.919)
    """
    return reach_of(robot, robot.frame(frame), rows_of("reach", task))


def reach_of(robot: Robot, frame: Frame, rows: Rows) -> Reach | None:
    """`reach` for the components of a task, computed once."""
    known = memory(robot).setdefault("reach", {})
    if (frame, rows) not in known:
        known[frame, rows] = _reach(robot, frame, rows)
    found: Reach | None = known[frame, rows]
    return found


def _reach(robot: Robot, frame: Frame, rows: Rows) -> Reach | None:
    if frame.joint is None or not {3, 4, 5} <= set(rows):
        return None
    pivots: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []  # point and direction before, direction after
    names: list[str] = []
    slack, T = 0.0, np.eye(4)
    for joint in reversed(list(frame.joint.chain)):
        if not isinstance(joint.model, Axial):
            return None
        T = T @ joint.placement.array
        axis = joint.model.axis.array
        low, high = _travel(robot, joint)
        if not isfinite(high - low):
            return None
        if any(float(u.real) for u in joint.model.units):
            pivots.append((T[:3, 3].copy(), T[:3, :3] @ axis, axis))
            names.append(joint.name)
            slack += max(abs(low), abs(high))
            T = np.eye(4)
        else:
            turned = Dual(float(joint.model.offset.real), (low + high) / 2)
            T = T @ Pose.about(joint.model.axis, turned).array
            slack += (high - low) / 2
    if not pivots:
        return None
    T = T @ frame.placement.array
    free = [k for k in range(3) if k not in rows]
    if free:
        axis = np.eye(3)[free[0]] if len(free) == 1 else np.zeros(3)
        pivots.append((T[:3, 3].copy(), T[:3, :3] @ axis, axis))
        T = np.eye(4)
    s, lengths = _short_chain(pivots)
    base = pivots[0][0] + s[0] * pivots[0][1]
    tip = np.linalg.inv(T) @ np.append(s[-1] * pivots[-1][2], 1.0)
    total, longest = float(lengths.sum()), float(lengths.max(initial=0.0))
    nearest = max(0.0, 2 * longest - total - slack)
    return Reach(base, tip[:3], nearest, total + slack, names[0], names[-1])


def _short_chain(pivots: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Points s_i along the axes that make the sum of the distances small, and the distances.

    Weiszfeld's iteration: least squares, each distance weighted by its inverse.
    """
    n = len(pivots)
    rows = np.zeros((n - 1, 3, n))
    fixed = np.zeros((n - 1, 3))
    for i in range(n - 1):
        rows[i, :, i] = -pivots[i][2]
        rows[i, :, i + 1] = pivots[i + 1][1]
        fixed[i] = pivots[i + 1][0]
    s = np.zeros(n)
    for _ in range(ROUNDS):
        lengths = np.linalg.norm(rows @ s + fixed, axis=-1)
        weight = 1 / np.sqrt(np.maximum(lengths, 1e-9))
        A = np.vstack([(rows * weight[:, None, None]).reshape(-1, n), 1e-6 * np.eye(n)])
        b = np.append(-(fixed * weight[:, None]).ravel(), np.zeros(n))
        s = np.linalg.lstsq(A, b, rcond=None)[0]
    return s, np.linalg.norm(rows @ s + fixed, axis=-1)


def _travel(robot: Robot, joint: Joint) -> tuple[float, float]:
    """The least and greatest slide along the axis [m], for coordinates within the robot's limits."""
    assert isinstance(joint.model, Axial)
    low = high = float(joint.model.offset.dual)
    for i, u in enumerate(joint.model.units, joint.q.start):
        per = float(u.dual)
        if per:
            ends = sorted(per * float(x) for x in (robot.lower[i], robot.upper[i]))
            low, high = low + ends[0], high + ends[1]
    return low, high
