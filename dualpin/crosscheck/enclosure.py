"""A term as a ball that is proved to hold it: midpoint and radius by Arb's ball arithmetic (extra ``balls``)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from ..extras import extra
from ..model.robot import Robot
from ..scalars import Exact, register
from ..terms import TERMS, flat

DIGITS = 80
"""Of the balls' arithmetic: what cancels leaves more than 50."""


@cache
def _balls() -> Any:
    """The library, its numbers known as scalars."""
    flint = extra("flint", "balls", "an enclosure")
    names = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")
    functions = {n: (lambda x, n=n: getattr(x, n)()) for n in names}
    register(flint.arb, SimpleNamespace(**functions, atan2=lambda y, x: flint.arb.atan2(y, x), hypot=_hypot))
    return flint


def _hypot(x: Any, y: Any) -> Any:
    return (x * x + y * y).sqrt()


def enclosure(robot: Robot, term: str, state: Mapping[str, np.ndarray], **options: Any) -> list[Any]:
    """Balls that hold the entries of a term at one state, as `flint.arb`, in the order of the array.

    The robot's constants and the state are the doubles that they are; its rotations and the quaternions of q
    are made orthonormal first, in balls too.  The algorithm is the package's own: this proves what rounding did,
    not that the algorithm is right, which its definition decides (`crosscheck.definitions`).

    Raises
    ------
    DualpinError
        If python-flint is not installed.

    References
    ----------
    Johansson, Arb: efficient arbitrary-precision midpoint-radius interval arithmetic (2017).

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.crosscheck.enclosure import enclosure, error
    >>> arm = dp.load("ur5")
    >>> q = arm.sample(seed=0)[0]
    >>> balls = enclosure(arm, "gravity", {"q": q})
    >>> least, most = error(balls[1], float(dp.gravity(arm, q)[1]))
    >>> 0 < least <= most < 1e-13
    True
    """
    flint = _balls()
    before, flint.ctx.dps = flint.ctx.dps, DIGITS
    try:
        inputs = {key: [flint.arb(float(x)) for x in np.ravel(value)] for key, value in state.items()}
        for j in robot:
            for r in j.quaternions if "q" in inputs else ():
                norm = sum(x * x for x in inputs["q"][r]).sqrt()
                inputs["q"][r] = [x / norm for x in inputs["q"][r]]
        lifted = robot.lift(lambda x: flint.arb(float(x)))
        if "frame" in options:
            options["frame"] = lifted.frames[robot.frames.index(options["frame"])]
        found = flat(TERMS[term].compute(lifted, *inputs.values(), **options))
        return [flint.arb(x.n) if type(x) is Exact else flint.arb(x) for x in found]
    finally:
        flint.ctx.dps = before


def error(ball: Any, x: float) -> tuple[float, float]:
    """The least and the largest distance of a double from what a ball holds."""
    flint = _balls()
    before, flint.ctx.dps = flint.ctx.dps, DIGITS
    try:
        distance = abs(ball - flint.arb(x))
        return max(0.0, float(distance.lower())), float(distance.upper())
    finally:
        flint.ctx.dps = before
