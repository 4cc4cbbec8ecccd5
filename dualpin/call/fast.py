"""The fast call: machine code that takes arrays which are plainly right, and batches shared among threads.

fast call     C-contiguous arrays of the kernel's type: one sample, or a batch and `out`
`Batched`     the same without `out`, or of so many samples that several threads are worth it
`Evaluator`   everything else: lists, other types, broadcasting, wrong arguments
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..engine.jit import fast_call
from ..engine.jit.host import CompilerError
from ..engine.jit.threads import spread
from ..errors import DualpinError
from .arguments import separated

if TYPE_CHECKING:
    from .evaluator import Evaluator

Function = Callable[..., np.ndarray]


def fast_function(general: Evaluator) -> Function | None:
    """The ways in front of the general call, where this Python, this machine and this term have them."""
    robot, term, kernels = general.robot, general.term, general.kernels
    shapes = [x.shape(robot) for x in term.arguments] + [general.shape]
    quaternions = [at.start for j in robot for at in j.quaternions]
    checked = [x.configuration for x in term.arguments]  # machine code checks the first array only
    if (quaternions and (not checked[0] or any(checked[1:]))) or 0 in general.shape or not fast_call.supported(shapes):
        return None
    code = kernels.code(fast_call.Code())
    entrance = partial(fast_call.bound, code, term.name, shapes, general.dtype, quaternions, str(general.__doc__))
    try:
        return entrance(slow=Batched(general, code, entrance(slow=general, alone=True)), alone=False)
    except CompilerError:
        return None


class Batched:
    """Batches that are plainly right: the result is allocated, the samples shared among threads.

    If a sample is wrong, others may have been written to `out` before the error is raised.
    """

    def __init__(self, general: Evaluator, code: fast_call.Code, alone: Function) -> None:
        self.general, self.code, self.alone = general, code, alone

    def __call__(self, *arrays: Any, out: np.ndarray | None = None, **unknown: Any) -> np.ndarray:
        general, kernel = self.general, self.code.many
        inputs, given = separated(general.term, arrays, out, unknown)
        n = self.samples(inputs, given)
        if kernel is None or not n:
            return general(*inputs, out=given)
        result = np.empty((n, *general.shape), general.dtype) if given is None else given
        try:
            spread(
                lambda start, stop: self.alone(*(x[start:stop] for x in inputs), result[start:stop]),
                n, kernel.seconds, kernel.lanes,
            )  # fmt: skip
        except DualpinError:  # said of a part of the batch: said again of the whole
            return general(*inputs, out=given)
        return result

    def __reduce__(self) -> tuple[Any, ...]:
        return self.general.__reduce__()

    def samples(self, inputs: tuple[Any, ...], out: Any) -> int | None:
        """How many; None where anything but a shape of one sample might be wrong."""
        general, n = self.general, None
        for x in inputs:
            if type(x) is not np.ndarray or x.dtype is not general.dtype or not x.flags.c_contiguous or x.ndim < 2:
                return None
            if n not in (None, len(x)) or (out is not None and np.may_share_memory(x, out)):
                return None
            n = len(x)
        if out is not None:
            plain = type(out) is np.ndarray and out.dtype is general.dtype and out.flags.c_contiguous
            if not plain or out.shape != (n, *general.shape):
                return None
        return n
