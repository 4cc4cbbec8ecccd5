"""What is asked of a frame: six numbers for a pose, three for a position, five for a position and a direction.

The motion of a frame has six components [w; v].  A task names those that count.  Where not all of them do,
the angular ones are about the frame's own axes (a drill may turn about its z-axis) and the linear ones along
the world's; the turns that are left free are taken out of the error before it is measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..dual import sqrt, where
from ..errors import ArgumentError, nearest
from ..model.robot import Frame, Robot
from ..scalars import ZERO, Scalar
from ..spatial.pose import Pose
from ..spatial.quaternion import Quaternion
from ..spatial.rotation import Rotation
from ..spatial.vector import Vector3

HUGE_TRAVEL = 1e6  # of a slide: a placeholder for no limit, also where a description is in millimetres
Rows = tuple[int, ...]
"""Indices among the six components [wx wy wz vx vy vz]."""
POSE: Rows = (0, 1, 2, 3, 4, 5)
TASKS: dict[str, Rows] = {"pose": POSE, "position": (3, 4, 5), "position+axis": (0, 1, 3, 4, 5)}


def rows_of(what: str, task: Any, mask: Any = None, position_only: Any = False) -> Rows:
    """The components of a task: by name, by six booleans, or as ``position_only=True``.

    Examples
    --------
    >>> from dualpin.tracking.task import rows_of
    >>> rows_of("ik", "position+axis")
    (0, 1, 3, 4, 5)
    >>> rows_of("ik", "pose", mask=[0, 0, 1, 1, 1, 0])
    (2, 3, 4)
    """
    if not isinstance(position_only, (bool, np.bool_)):
        raise ArgumentError(f"{what}: position_only = {position_only!r}, True or False expected")
    if sum((mask is not None, bool(position_only), not (isinstance(task, str) and task == "pose"))) > 1:
        raise ArgumentError(f"{what}: only one of task=, mask= and position_only= expected")
    if position_only:
        return TASKS["position"]
    if mask is None and isinstance(task, str):
        if task not in TASKS:
            raise ArgumentError(f"{what}: task {task!r} is not known; {nearest(task, TASKS)}, or six booleans")
        return TASKS[task]
    given = task if mask is None else mask
    chosen = np.asarray(given)
    if chosen.shape != (6,) or chosen.dtype.kind not in "biuf" or not np.isin(chosen, (0, 1)).all() or not chosen.any():
        raise ArgumentError(
            f"{what}: mask of six booleans [wx, wy, wz, vx, vy, vz] expected, at least one of them true, got {given!r}"
        )
    return tuple(int(i) for i in np.flatnonzero(chosen))


def freedoms(frame: Frame) -> int:
    """How many velocities of the robot carry the frame."""
    if frame.joint is None:
        return 0
    return len({i for j in frame.joint.chain for i in range(j.v.start, j.v.stop)})


def numbers_wanted(rows: Rows) -> str:
    """'6 numbers (a pose)'."""
    name = {v: f" (a {k})" for k, v in TASKS.items()}.get(rows, "")
    return f"{len(rows)} number{'s' if len(rows) > 1 else ''}{name.replace('+axis', ' and an axis')}"


def too_few(frame: Frame, rows: Rows) -> str:
    """'4 joints cannot follow 6 numbers (a pose); ask for less: task="position" ...', or '' if they are enough."""
    have = freedoms(frame)
    if have >= len(rows):
        return ""
    fit = [k for k, v in TASKS.items() if len(v) < len(rows) and len(v) <= max(have, 3)]
    less = max(fit, key=lambda k: len(TASKS[k]), default="")
    hint = f"task='{less}' (--task {less})" if less else "a mask with fewer components, or a motion that they can make"
    joints = f"{have} joint{'' if have == 1 else 's'}"
    return f"{joints} cannot follow {numbers_wanted(rows)}; ask for less: {hint}"


def chain_length(robot: Robot, frame: Frame) -> float:
    """A length [m] of the size of the frame's chain: its links and slides put end to end; 1 where there are none."""
    lower, upper = robot.lower, robot.upper
    total, joint = _length(frame.placement), frame.joint
    for j in () if joint is None else joint.chain:
        total += _length(j.placement)
        if j.mimic is None:
            for i, what in enumerate(j.model.coordinates, j.q.start):
                travel = float(upper[i]) - float(lower[i]) if what == "length" else 0.0
                total += travel if 0 < travel < HUGE_TRAVEL else 0.0
    return total if 0 < total < np.inf else 1.0


def _length(X: Pose) -> float:
    return float(np.linalg.norm(X.position.array))


# --- over any scalar -----------------------------------------------------------------------------


def selected(rows: Rows, R: Rotation, motion: Sequence[Scalar]) -> list[Scalar]:
    """The components of a motion [w; v] (world axes) that the task asks for; R is the frame's orientation."""
    if rows == POSE:
        return list(motion)
    six = [*(R.T @ Vector3(*motion[:3])), *motion[3:]]
    return [six[i] for i in rows]


def task_error(rows: Rows, wanted: Pose, X: Pose) -> list[Scalar]:
    """What the task still lacks: six numbers, the turn [rad] and the way [m] in the axes of `selected`, 0 elsewhere."""
    free = [i for i in range(3) if i not in rows]
    if rows == POSE:
        turn = Quaternion.from_rotation(wanted.rotation @ X.rotation.T).log * 2
    elif len(free) == 3:
        turn = Vector3(ZERO, ZERO, ZERO)
    else:
        r = Quaternion.from_rotation(X.rotation.T @ wanted.rotation)
        turn = (r if len(free) != 1 else _without_turn(r, free[0])).log * 2
    six = [*turn, *(wanted.position - X.position)]
    return [x if i in rows else ZERO for i, x in enumerate(six)]


def _without_turn(r: Quaternion, k: int) -> Quaternion:
    """The swing of r: r times the turn about axis k that makes the rest smallest.

    Of a half turn that carries the axis to its opposite every turn leaves the same rest; r stays as it is.
    """
    w, u = r.w, [*r.v][k]
    n = w * w + u * u
    opposite = n < 1e-24  # rounding of unit quaternions, squared
    size = sqrt(where(opposite, n * 0.0 + 1.0, n))
    turn: list[Scalar] = [where(opposite, n * 0.0 + 1.0, w / size), ZERO, ZERO, ZERO]
    turn[k + 1] = where(opposite, n * 0.0, -u / size)
    return r * Quaternion(*turn)
