"""Who is right in the last digits: the same algorithm, run with 50 digits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..call import evaluate
from ..errors import DualpinError
from ..model.robot import Robot
from ..scalars import Exact
from ..terms import TERMS, flat

DIGITS = 50


def arbitrate(
    robot: Robot, term: str, state: Mapping[str, np.ndarray], theirs: np.ndarray, **options: Any
) -> dict[str, float]:
    """Scaled errors of ours and of the oracle's value against 50 digits, at one state.

    The constants of the robot are the doubles that were read, with rotations and the quaternions of
    q made orthonormal to 50 digits.
    """
    try:
        import mpmath
    except ImportError:
        raise DualpinError("arbitration computes with mpmath (pip install mpmath)") from None
    ours = evaluate(robot, term, state, engine="numpy", **options)
    with mpmath.workdps(DIGITS):
        lifted = robot.lift(mpmath.mpf)
        inputs = {key: [mpmath.mpf(float(x)) for x in np.ravel(value)] for key, value in state.items()}
        for j in robot:
            for r in j.quaternions if "q" in inputs else ():
                norm = mpmath.sqrt(sum(x * x for x in inputs["q"][r]))
                inputs["q"][r] = [x / norm for x in inputs["q"][r]]
        truth = [
            mpmath.mpf(x.n) if type(x) is Exact else mpmath.mpf(x)
            for x in flat(TERMS[term].compute(lifted, *inputs.values(), **_lifted(lifted, robot, options)))
        ]
        scale = max(1, max((abs(x) for x in truth), default=1))

        def error(values: np.ndarray) -> float:
            pairs = zip(np.ravel(values).tolist(), truth, strict=True)
            return float(max((abs(mpmath.mpf(x) - t) for x, t in pairs), default=0) / scale)

        return {"dualpin": error(ours), "oracle": error(theirs)}


def _lifted(lifted: Robot, robot: Robot, options: Mapping[str, Any]) -> dict[str, Any]:
    """Frames of the robot become those of the lifted one."""
    return {k: lifted.frames[robot.frames.index(v)] if k == "frame" else v for k, v in options.items()}
