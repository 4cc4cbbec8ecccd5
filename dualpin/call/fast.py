"""The fast call, in machine code, for arrays that need no conversion; and batches shared among threads.

fast call     C-contiguous arrays of the kernel's type: one sample, or a batch and `out`
`Batched`     the same without `out`, or of so many samples that several threads are worth it
`Evaluator`   all other arguments: lists, other types, broadcasting, mistakes
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..engine.jit import fast_call
from ..engine.jit.host import CompilerError
from ..engine.jit.stores import settle
from ..engine.jit.threads import spread
from ..errors import DualpinError
from ..memory import FROM, empty
from .arguments import separated
from .kernels import Kernels

Function = Callable[..., np.ndarray]


def fast_function(kernels: Kernels, general: Function) -> Function | None:
    """The fast call and `Batched` before the general call; None if this Python, machine or term has no fast call."""
    robot, term = kernels.robot, kernels.term
    shapes = [x.shape(robot) for x in term.arguments] + [kernels.shape]
    quaternions = [at.start for j in robot for at in j.quaternions]
    checked = [x.configuration for x in term.arguments]  # machine code checks the first array only
    if (quaternions and (not checked[0] or any(checked[1:]))) or 0 in kernels.shape or not fast_call.supported(shapes):
        return None
    code = kernels.code(fast_call.Code())
    entrance = partial(fast_call.bound, code, term.name, shapes, kernels.dtype, quaternions, str(general.__doc__))
    try:
        return entrance(slow=Batched(kernels, code, general, entrance(slow=general, alone=True)), alone=False)
    except CompilerError:
        return None


class Batched:
    """Batches that need no conversion: allocates the result and shares the samples among threads.

    If a sample is invalid, other samples may have been written to `out` before the error is raised.
    """

    def __init__(self, kernels: Kernels, code: fast_call.Code, general: Function, alone: Function) -> None:
        self.term, self.shape, self.dtype = kernels.term, kernels.shape, kernels.dtype
        self.code, self.general, self.alone = code, general, alone

    def __call__(self, *arrays: Any, out: np.ndarray | None = None, **unknown: Any) -> np.ndarray:
        kernel = self.code.many
        inputs, given = separated(self.term, arrays, out, unknown)
        n = self.samples(inputs, given)
        if kernel is None or not n:
            return self.general(*inputs, out=given)
        if n * int(np.prod(self.shape, dtype=int)) * self.dtype.itemsize >= FROM:
            settle()
        result = empty((n, *self.shape), self.dtype) if given is None else given
        try:
            spread(
                lambda start, stop: self.alone(*(x[start:stop] for x in inputs), result[start:stop]),
                n, kernel.seconds, kernel.lanes,
            )  # fmt: skip
        except DualpinError:  # its index is that of a part; the general call raises it for the whole
            return self.general(*inputs, out=given)
        return result

    def __reduce__(self) -> str | tuple[Any, ...]:
        return self.general.__reduce__()

    def samples(self, inputs: tuple[Any, ...], out: Any) -> int | None:
        """The number of samples; None if the arguments have to take the general call."""
        n = None
        for x in inputs:
            if type(x) is not np.ndarray or x.dtype is not self.dtype or not x.flags.c_contiguous or x.ndim < 2:
                return None
            if n not in (None, len(x)) or (out is not None and np.may_share_memory(x, out)):
                return None
            n = len(x)
        if out is not None:
            plain = type(out) is np.ndarray and out.dtype is self.dtype and out.flags.c_contiguous
            if not plain or out.shape != (n, *self.shape):
                return None
        return n
