"""The general call: a term of a robot with settled options, on any arguments."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..delegates import home
from ..engine import tuning
from ..interpret import interpret
from ..model import frames
from .arguments import check_result, rows, separated
from .kernels import Kernels

ENGINES = ("auto", "compiled", "tiered", "numpy", "cuda")
"""auto: compiled where there is a compiler and the term is a straight-line program, else NumPy; compiled: an error if
that is impossible; tiered: NumPy until a thread has compiled it; numpy: the source itself on arrays; cuda: kernels of
an Nvidia GPU, for arrays on it."""
DOUBLE, SINGLE = np.dtype(np.float64), np.dtype(np.float32)


class Evaluator:
    """One term of one robot on arrays, by one engine.

    It references the robot's constants and kernels, but not the robot, in whose caches it is kept.
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
        kernel, n = None, len(inputs[0])
        if self.engine == "tiered":
            kernel = self.kernels.meanwhile(single=n == 1)
        elif self.engine == "auto" and n <= tuning.SOON_SAMPLES:
            kernel = self.kernels.soonest(single=n == 1)
        elif self.engine != "numpy":
            kernel = self.kernels.kernel(single=n == 1, required=self.engine == "compiled")
        if kernel is not None:
            return kernel.rows(inputs, out).reshape((n, *self.shape))
        result = interpret(self.robot, self.term, self.options, inputs).astype(self.dtype, copy=False)
        if out is not None:
            out[...] = result.reshape(out.shape)
        return result

    def __reduce__(self) -> tuple[Any, ...]:
        # the arguments that remake it; code and memory belong to this process
        options = {key: frames.key(self.robot, x) if key == "frame" else x for key, x in self.options.items()}
        return home("Evaluator.__reduce__"), (self.robot, self.term.name, self.dtype, options, self.engine)
