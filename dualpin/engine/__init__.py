"""How a term is executed on arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import ArgumentError, nearest
from ..model.robot import Robot
from ..terms import Options, Term
from . import reference

ENGINES = ("auto", "numpy")


def run(robot: Robot, term: Term, options: Options, inputs: Sequence[np.ndarray], engine: str = "auto") -> np.ndarray:
    """Arrays (n, size) in, one array (n, *shape) out, by the engine of that name."""
    if engine not in ENGINES:
        raise ArgumentError(f"engine {engine!r} is not known; {nearest(engine, ENGINES, 'engines')}")
    return reference.run(robot, term, options, inputs)
