"""A term of many stories and samples in one pass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...algorithms.sharing import sharing
from ...model.robot import Robot
from ...scalars import Exact
from ...terms import TERMS, flat
from ..subjects.questions import Question, pushed


def evaluate(
    robot: Robot, question: Question, inputs: Mapping[str, np.ndarray], frames: Sequence[str], reference: str
) -> np.ndarray:
    """A term of stories x samples: inputs (h, n, size), constants of the robot numbers or (h, 1); (h, n, ...) out."""
    if question.pushes:
        return pushed(question, inputs, lambda of, states: evaluate(robot, of, dict(states), frames, reference))
    term = TERMS[question.source]
    variants: list[dict[str, Any]] = [{}]
    if question.framed:
        variants = [{"frame": robot.frame(f), **question.options(reference)} for f in frames]
    columns = [list(np.moveaxis(inputs[k], -1, 0)) for k in question.inputs]
    h, n = columns[0][0].shape
    answers = []
    with np.errstate(all="ignore"), sharing():  # poses are the same for all frames
        for options in variants:
            shape = term.shape(robot, **options)
            out = np.empty((h, n, int(np.prod(shape, dtype=int))))
            for i, value in enumerate(flat(term.compute(robot, *columns, **options))):
                out[:, :, i] = float(value) if type(value) is Exact else value
            answers.append(out.reshape(h, n, *shape))
    return np.stack(answers, axis=2) if question.framed else answers[0]
