"""Arbitration where two libraries differ: each is compared with the term's definition in 50 digits and more."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..model.robot import Robot
from .checks import CHECKS, Check
from .definitions import WORKING_DIGITS, Definitions, UndecidedError
from .results import DUALPIN, NEITHER, ORACLE, UNDECIDED

SECONDS = 20.0
"""Processor seconds for one term; entries of tiago_dual, 107 degrees of freedom, take 0.2 to 4 s."""


def arbitrate(
    robot: Robot, check: Check, state: Mapping[str, np.ndarray], index: tuple[int, ...], ours: float, theirs: float,
    scale: float, seconds: float = SECONDS, **options: Any,
) -> dict[str, float]:  # fmt: skip
    """Scaled errors of dualpin's and the oracle's value of one entry at one state.

    Parameters
    ----------
    state : mapping
        The sampled quantities of one sample, by their names in `Check.inputs`.
    index : tuple of int
        The entry's place in the term's array.
    scale : float
        What errors are divided by, or by the entry's true size where that is more: where one answer is far too
        small, nothing else says how large a right one is.

    Raises
    ------
    UndecidedError
        If it has no value (M is singular), or time is over.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.crosscheck.arbiter import arbitrate
    >>> from dualpin.crosscheck.checks import CHECKS
    >>> arm, q = dp.load("ur5"), [0.1, -0.2, 0.3, 0.4, 0.5, 0.6]
    >>> M = dp.crba(arm, q)
    >>> errors = arbitrate(arm, CHECKS["crba"], {"q": q}, (0, 1), M[0, 1], M[0, 1] + 1e-9, 1.0)
    >>> errors["dualpin"] < 1e-15, round(errors["oracle"], 12)
    (True, 1e-09)
    """
    import mpmath

    with mpmath.workdps(WORKING_DIGITS):
        try:
            truth = check.entry(Definitions(robot, state, seconds), index, options)
        except ZeroDivisionError:
            raise UndecidedError("it has no value: M is singular") from None
        scale = max(scale, float(abs(truth)))

        def error(x: float) -> float:
            off = float(abs(mpmath.mpf(x) - truth) / scale) if np.isfinite(x) else float("inf")
            return off if off > 1e-50 else 0.0  # of what is zero, a difference leaves less than 50 digits

        return {"dualpin": error(float(ours)), "oracle": error(float(theirs))}


def defined(
    robot: Robot, term: str, state: Mapping[str, np.ndarray], shape: tuple[int, ...], seconds: float = SECONDS,
    **options: Any,
) -> np.ndarray:  # fmt: skip
    """A term at one state by its definition, found with 130 digits and rounded to doubles once.

    Parameters
    ----------
    shape : tuple of int
        Of the term's array.
    seconds : float
        Of the processor, after which it gives up.

    Raises
    ------
    UndecidedError
        As in `arbitrate`.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.crosscheck.arbiter import defined
    >>> robot = dp.load("ur5")
    >>> q = robot.sample(seed=0)[0]
    >>> bool(abs(defined(robot, "gravity", {"q": q}, (6,)) - dp.gravity(robot, q)).max() < 1e-13)
    True
    """
    import mpmath

    with mpmath.workdps(WORKING_DIGITS):
        try:
            return CHECKS[term].whole(Definitions(robot, state, seconds), shape, options).astype(float)
        except ZeroDivisionError:
            raise UndecidedError("it has no value: M is singular") from None


def nearer(errors: Mapping[str, float], tolerance: float) -> str:
    """Which is nearer to 50 digits: the one within the tolerance, the closer one if both are, neither if none is."""
    ours, theirs = errors["dualpin"], errors["oracle"]
    if min(ours, theirs) > tolerance:
        return NEITHER
    return DUALPIN if ours <= theirs else ORACLE


def worst_of(verdicts: list[str]) -> str:
    """The common verdict of several samples."""
    return min(verdicts, key=[ORACLE, NEITHER, UNDECIDED, DUALPIN].index, default=UNDECIDED)
