"""A term with 50 digits, from the same source as all others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..model.robot import Robot
from ..scalars import Exact
from ..terms import TERMS, flat

DIGITS = 50


def truth(robot: Robot, term: str, state: Mapping[str, np.ndarray], **options: Any) -> np.ndarray:
    """The value at one state, computed with 50 digits and rounded to doubles once.

    The constants of the robot are the doubles that were read, with rotations and the quaternions of
    q made orthonormal to 50 digits.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.crosscheck.exact import truth
    >>> robot = dp.load("ur5")
    >>> q = robot.sample(seed=0)[0]
    >>> bool(abs(truth(robot, "gravity", {"q": q}) - dp.gravity(robot, q)).max() < 1e-13)
    True
    """
    import mpmath

    with mpmath.workdps(DIGITS):
        lifted = robot.lift(mpmath.mpf)
        inputs = {key: [mpmath.mpf(float(x)) for x in np.ravel(value)] for key, value in state.items()}
        for j in robot:
            for r in j.quaternions if "q" in inputs else ():
                norm = mpmath.sqrt(sum(x * x for x in inputs["q"][r]))
                inputs["q"][r] = [x / norm for x in inputs["q"][r]]
        if "frame" in options:
            options["frame"] = lifted.frames[robot.frames.index(options["frame"])]
        values = [
            float(x.n if type(x) is Exact else x)
            for x in flat(TERMS[term].compute(lifted, *inputs.values(), **options))
        ]
    return np.array(values).reshape(TERMS[term].shape(robot, **options))
