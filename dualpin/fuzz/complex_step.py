"""Derivatives to rounding by complex steps: the algorithms, run on complex numbers.

f(x + i h) = f(x) + i h f'(x) + O(h^2): with h = 1e-30 nothing is subtracted and the error is that of
one evaluation (Squire & Trapp 1998).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..model.robot import Robot
from ..scalars import Exact
from ..terms import TERMS, flat

STEP = 1e-30


def evaluate(robot: Robot, name: str, *inputs: Any, **options: Any) -> np.ndarray:
    """One term on scalars of any kind, as an array of objects turned complex."""
    term = TERMS[name]
    values = [
        complex(float(x)) if type(x) is Exact else complex(x) for x in flat(term.compute(robot, *inputs, **options))
    ]
    return np.array(values).reshape(term.shape(robot, **options))


def moved(robot: Robot, q: np.ndarray, v: np.ndarray) -> list[complex]:
    """q, moved on the group with the velocity v for the time i h."""
    step = [complex(0, STEP * x) for x in v]
    found: list[complex] = evaluate(robot, "integrate", q.tolist(), step).tolist()
    return found


def along(
    robot: Robot, name: str, q: np.ndarray, v: np.ndarray, *rates: tuple[np.ndarray, np.ndarray], **options: Any
) -> np.ndarray:
    """d/dt of a term while q moves with v and each further input x with its rate dx/dt."""
    inputs = [[complex(x, STEP * d) for x, d in zip(*pair, strict=True)] for pair in rates]
    rate: np.ndarray = evaluate(robot, name, moved(robot, q, v), *inputs, **options).imag / STEP
    return rate


def gradient(robot: Robot, name: str, q: np.ndarray, **options: Any) -> np.ndarray:
    """The derivative of a term of q along each velocity; the last axis is that of v."""
    columns = [along(robot, name, q, e, **options) for e in np.eye(robot.nv)]
    return np.stack(columns, axis=-1) if columns else np.zeros((*TERMS[name].shape(robot, **options), 0))
