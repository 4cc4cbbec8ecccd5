"""Evaluators of a robot, made at first use and kept in its caches."""

from __future__ import annotations

import functools
import os
from dataclasses import replace
from typing import Any

import numpy as np

from ..engine.jit import fast_call
from ..model.memory import memory
from ..model.robot import Robot
from ..terms import Options, Term, term
from .evaluator import DOUBLE, Evaluator
from .fast import fast_function
from .kernels import Kernels, later


def evaluator_of(
    robot: Robot, term: Term, options: Options, dtype: np.dtype = DOUBLE, engine: str = "auto"
) -> Evaluator:
    """The robot's evaluator for a term whose options are settled; made at first use."""
    if engine in ("auto", "tiered") and robot.numbers != "double":
        engine = "numpy"  # constants with more digits than a double cannot be compiled
    kept, key = memory(robot), (term, dtype, *options.values())
    found: Evaluator | None = kept.get((engine, *key))
    if found is None:
        constants = kept.get("constants") or kept.setdefault("constants", replace(robot))
        kernels = kept.setdefault(("kernels", *key), Kernels(constants, term, options, dtype))
        found = kept.setdefault((engine, *key), _made(kernels, engine))
    return found


def _made(kernels: Kernels, engine: str) -> Evaluator:
    if engine != "cuda":
        return Evaluator(kernels, engine)
    from ..engine.cuda.driver import device
    from .device import Copying

    return Copying(kernels, device())


def function_of(
    robot: Robot, term: Term, options: Options, dtype: np.dtype = DOUBLE, engine: str = "auto", *, alias: Any = None,
    now: bool = False,
) -> Evaluator:  # fmt: skip
    """The same, behind the fast call where there is one; arguments and results are the same.

    The code of the fast call is compiled once on a machine.  Until then the general call answers, unless it is needed
    `now`; another thread compiles it when there is a kernel to be called.  What is final is also kept as `alias`.
    """
    general = evaluator_of(robot, term, options, dtype, engine)
    if general.engine not in ("auto", "tiered") or (general.engine == "tiered" and not general.kernels.any):
        return general
    kept, key = memory(robot), ("function", general.engine, term, dtype, *options.values())
    found = kept.get(key)
    if found is None:
        if not (now or fast_call.at_hand()):
            if general.kernels.any:
                _compile_fast_call(os.getpid())
            return general
        found = kept.setdefault(key, fast_function(general.kernels, general) or general)
    if alias is not None:
        kept[alias] = found
    return found


@functools.cache
def _compile_fast_call(_process: int) -> None:
    later(fast_call.addresses)


def restored(robot: Robot, name: str, dtype: np.dtype, options: Options, engine: str) -> Evaluator:
    """An unpickled evaluator."""
    named = term(name)
    return function_of(robot, named, named.settled(robot, options), np.dtype(dtype.char), engine, now=True)
