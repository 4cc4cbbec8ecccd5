"""A term of a robot with its options settled: what a call needs to know, found once, and the general call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..interpret import interpret
from ..model import frames
from ..model.memory import memory
from ..model.robot import Robot
from ..terms import Options, Term, term
from .arguments import check_result, rows, separated
from .fast import fast_function
from .kernels import Kernels

ENGINES = ("auto", "compiled", "numpy", "cuda")
"""Compiled where there is a compiler and the term is a straight line, else NumPy; compiled, or an error
that says why not; the source itself on arrays; kernels of an Nvidia GPU, for arrays on it."""
DOUBLE, SINGLE = np.dtype(np.float64), np.dtype(np.float32)


class Evaluator:
    """One term of one robot on arrays, by one engine.

    It keeps the robot's constants and kernels alive, but not the robot, for which it is kept.
    """

    def __init__(self, kernels: Kernels, engine: str) -> None:
        self.kernels, self.engine = kernels, engine
        self.robot, self.term, self.options, self.dtype = kernels.robot, kernels.term, kernels.options, kernels.dtype
        self.shape = kernels.shape
        self.__name__ = self.term.name
        self.__doc__ = f"{self.term.name}({', '.join(self.term.inputs)}, out=None) of {self.robot.name}"

    def __call__(self, *arrays: ArrayLike | None, out: np.ndarray | None = None, **unknown: Any) -> np.ndarray:
        """Arrays (..., size) whose leading axes broadcast; returns (..., *shape), in `out` if given."""
        inputs, out = separated(self.term, arrays, out, unknown)
        samples, batch = rows(self.robot, self.term, inputs)
        shape = batch + self.shape
        if out is None:
            return self.rows(samples).reshape(shape)
        check_result(self.term.name, out, shape, self.dtype)
        if out.flags.c_contiguous and out.size:
            self.rows(samples, out.reshape(len(samples[0]), -1))
        else:
            out[...] = self.rows(samples).reshape(shape)
        return out

    def rows(self, inputs: Sequence[np.ndarray], out: np.ndarray | None = None) -> np.ndarray:
        """Arrays (n, size) in, one array (n, *shape) out, whose rows are those of `out` (n, width) if given."""
        kernel = None
        if self.engine != "numpy":
            kernel = self.kernels.kernel(single=len(inputs[0]) == 1, required=self.engine == "compiled")
        if kernel is not None:
            return kernel.rows(inputs, out).reshape((len(inputs[0]), *self.shape))
        result = interpret(self.robot, self.term, self.options, inputs).astype(self.dtype, copy=False)
        if out is not None:
            out[...] = result.reshape(out.shape)
        return result

    def __reduce__(self) -> tuple[Any, ...]:
        # what it is for; code and memory are this process's
        options = {key: frames.key(self.robot, x) if key == "frame" else x for key, x in self.options.items()}
        return _restored, (self.robot, self.term.name, self.dtype, options, self.engine)


def evaluator_of(
    robot: Robot, term: Term, options: Options, dtype: np.dtype = DOUBLE, engine: str = "auto"
) -> Evaluator:
    """The robot's evaluator for a term whose options are settled; made at first use."""
    if engine == "auto" and robot.numbers != "double":
        engine = "numpy"  # constants of more digits are no machine numbers
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
    robot: Robot, term: Term, options: Options, dtype: np.dtype = DOUBLE, engine: str = "auto"
) -> Evaluator:
    """The same, with the fast call in front where there is one: other code, same arguments, same results."""
    general = evaluator_of(robot, term, options, dtype, engine)
    if general.engine != "auto":
        return general
    kept, key = memory(robot), ("function", term, dtype, *options.values())
    return kept.get(key) or kept.setdefault(key, fast_function(general.kernels, general) or general)


def _restored(robot: Robot, name: str, dtype: np.dtype, options: Options, engine: str) -> Evaluator:
    named = term(name)
    return function_of(robot, named, named.settled(robot, options), np.dtype(dtype.char), engine)
