"""A term of a robot as one callable, in three layers: whatever one cannot do it leaves to the next.

entry        C-contiguous arrays of the kernel's type: one sample, or a batch and `out`
`Spreading`  the same without `out`, or of so many samples that several threads are worth it
`Careful`    everything else: lists, other types, broadcasting, wrong arguments
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..errors import ArgumentError, DualpinError, nearest
from ..model.memory import memory
from ..model.robot import Robot
from ..terms import TERMS, Options, Term, input_shape
from . import find, known
from .jit import fast_call as entry
from .jit.host import CompilerError
from .jit.threads import spread

Function = Callable[..., np.ndarray]


def kernel(robot: Robot, name: str, dtype: Any = np.float64, **options: Any) -> Function:
    """One term as a callable for loops: (*arrays, out=None) -> array, with the least overhead there is.

    Parameters
    ----------
    name : str
        A name in `dualpin.terms.TERMS`: "rnea", "crba", "fk", "frame_pose", "jacobian", ...
    dtype : float64 or float32
        What it computes in and returns; other arrays are converted.
    **options
        What the term takes besides arrays: ``frame=`` (a name, an index or a `Frame`), ``reference=``.

    Returns
    -------
    callable
        Takes the term's arrays (..., size) in the order of ``TERMS[name].inputs``, and ``out=``,
        an array for the result.  Contiguous arrays of `dtype`, of one configuration or a batch with
        ``out``, take the shortest way; whatever else comes out the same, some microseconds later.

    Raises
    ------
    ArgumentError
        If there is no such term.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> inverse_dynamics, tau = robot.kernel("rnea"), np.empty(6)
    >>> q, v, a = robot.sample(seed=0)
    >>> inverse_dynamics(q, v, a, out=tau) is tau
    True
    >>> bool(np.array_equal(tau, dp.rnea(robot, q, v, a)))
    True
    """
    if "frame" in options:
        options["frame"] = robot.frame(options["frame"])
    return bind(robot, name, dtype, ready=True, **options)


def bind(robot: Robot, name: str, dtype: Any = np.float64, *, ready: bool = False, **options: Any) -> Function:
    """The callable of a term.  With `ready`, the kernel for one sample is compiled now, not when it is needed."""
    if name not in TERMS:
        raise ArgumentError(f"kernel {name!r} is not known; {nearest(name, TERMS, 'terms')}")
    kind = np.dtype(dtype)
    if kind not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise ArgumentError(f"kernel {name}: dtype float64 or float32 expected, got {kind}")
    bound = memory(robot).setdefault("bound", {})
    key = (name, kind.char, *sorted(options.items()))
    found = bound.get(key)
    if found is None:
        careful = Careful(robot, TERMS[name], options, kind)
        found = bound.setdefault(key, (quick(careful), careful))
    function, careful = found
    if ready and function is not careful:
        find(careful.robot, careful.term, options, kind, single=True)
        careful.adopt()
    return function


def quick(careful: Careful) -> Function:
    """The layers before `careful`, where this Python, this machine and this term have them."""
    robot, term = careful.robot, careful.term
    shapes = [input_shape(robot, x) for x in term.inputs] + [careful.shape]
    one_q = term.inputs[0] == "q" and "q1" not in term.inputs
    if not (one_q and 0 not in careful.shape and entry.supported(shapes)):
        return careful
    quaternions = [at.start for j in robot for at in j.quaternions]
    entrance = partial(entry.bound, careful.code, term.name, shapes, careful.dtype, quaternions, str(careful.__doc__))
    try:
        return entrance(slow=Spreading(careful, entrance(slow=careful, alone=True)), alone=False)
    except CompilerError:
        return careful


class Careful:
    """Any arguments: converted, broadcast, computed by whatever engine there is, or explained.

    It keeps the robot's constants and kernels alive, not the robot, which holds the callable.
    """

    def __init__(self, robot: Robot, term: Term, options: Options, dtype: np.dtype) -> None:
        self.robot = replace(robot)
        memory(self.robot)["kernels"] = memory(robot).setdefault("kernels", {})
        self.term, self.options, self.dtype = term, options, dtype
        self.shape, self.code = term.shape(robot, **options), entry.Code()
        self.__name__ = term.name
        self.__doc__ = f"{term.name}({', '.join(term.inputs)}, out=None) of {robot.name}"

    def __call__(self, *arrays: Any, out: np.ndarray | None = None, **other: Any) -> np.ndarray:
        from ..boundary import call

        if other:
            raise TypeError(
                f"{self.term.name}: arrays ({', '.join(self.term.inputs)}) are given in order, and `out` by its name; "
                f"{', '.join(other)} is not known"
            )
        arrays, out = self.separated(arrays, out)
        if len(arrays) != len(self.term.inputs):
            raise ArgumentError(
                f"{self.term.name}: {len(self.term.inputs)} arrays ({', '.join(self.term.inputs)}) expected, "
                f"got {len(arrays)}"
            )
        named, options = dict(zip(self.term.inputs, arrays, strict=True)), dict[str, Any](self.options)
        result = call(self.robot, self.term.name, named, out=out, dtype=self.dtype, **options)
        self.adopt()
        return result

    def separated(self, arrays: tuple[Any, ...], out: np.ndarray | None) -> tuple[tuple[Any, ...], np.ndarray | None]:
        """Inputs, and the array for the result, which may come as the last of them."""
        if len(arrays) == len(self.term.inputs) + 1 and out is None:
            return arrays[:-1], arrays[-1]
        return arrays, out

    def adopt(self) -> None:
        """From the next call on, the entry uses the kernels that are compiled by now."""
        for many in (False, True):
            if not self.code.address[many]:
                kernel = known(self.robot, self.term, self.options, self.dtype, single=not many)
                if kernel is not None:
                    self.code.adopt(kernel, many)


class Spreading:
    """Batches that are plainly right: the result is allocated, the samples shared among threads.

    If a sample is wrong, others may have been written to `out` before the error is raised.
    """

    def __init__(self, careful: Careful, alone: Function) -> None:
        self.careful, self.alone = careful, alone

    def __call__(self, *arrays: Any, out: np.ndarray | None = None, **other: Any) -> np.ndarray:
        inputs, given = self.careful.separated(arrays, out)
        kernel = self.careful.code.many
        n = None if other else self.samples(inputs, given)
        if kernel is None or not n:
            return self.careful(*arrays, out=out, **other)
        result = np.empty((n, *self.careful.shape), self.careful.dtype) if given is None else given
        try:
            spread(
                lambda start, stop: self.alone(*(x[start:stop] for x in inputs), result[start:stop]),
                n, kernel.seconds, kernel.lanes,
            )  # fmt: skip
        except DualpinError:  # said of a part of the batch: said again of the whole
            return self.careful(*arrays, out=out)
        return result

    def samples(self, inputs: tuple[Any, ...], out: Any) -> int | None:
        """How many; None where anything but a shape of one sample might be wrong."""
        careful, n = self.careful, None
        if len(inputs) != len(careful.term.inputs):
            return None
        for x in inputs:
            if type(x) is not np.ndarray or x.dtype is not careful.dtype or not x.flags.c_contiguous or x.ndim < 2:
                return None
            if n not in (None, len(x)) or (out is not None and np.may_share_memory(x, out)):
                return None
            n = len(x)
        if out is not None:
            plain = type(out) is np.ndarray and out.dtype is careful.dtype and out.flags.c_contiguous
            if not plain or out.shape != (n, *careful.shape):
                return None
        return n


__all__ = ["bind", "kernel"]
