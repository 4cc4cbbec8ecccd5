"""Operations as functions that XLA's programs call: what each is named, and where it is."""

from __future__ import annotations

import hashlib
import itertools

import numpy as np

from ..call.making import evaluator_of, function_of
from ..engine.jit import fast_call, xla
from ..engine.jit.fingerprint import key
from ..engine.jit.host import CompilerError, this_host
from ..locking import LOCK
from ..model.memory import memory
from .operation import Operation

_made: dict[str, int] = {}
_numbers = itertools.count()  # of robots with joints from outside the package, which have no fingerprint


def handler_of(operation: Operation, dtype: np.dtype, minor: int) -> tuple[str, int] | None:
    """A name and the address of the handler; None where there is no compiler, or the numbers are no machine numbers.

    The name says all that the code depends on: in another process it means the same, and equal robots share it.
    """
    robot, term = operation.robot, operation.term
    kept, place = memory(robot), ("handler", term, dtype, operation.options)
    if place not in kept:
        with LOCK:
            kept[place] = kept.get(place) or (_handler(operation, dtype, minor) if robot.numbers == "double" else None)
    found: tuple[str, int] | None = kept[place]
    return found


def _handler(operation: Operation, dtype: np.dtype, minor: int) -> tuple[str, int] | None:
    robot, term, settled = operation.robot, operation.term, operation.settled
    try:
        host = this_host()
        known = key(robot, term, settled, dtype, host, host.lanes(dtype.itemsize))
        mark = hashlib.sha256(known.encode()).hexdigest()[:32] if known else f"here_{next(_numbers)}"
        name = f"dualpin_{term.name}_{mark}"
        if name not in _made:
            _made[name] = xla.handler(
                evaluator_of(robot, term, settled, dtype).kernels.code(fast_call.Code()),
                [x.shape(robot) for x in term.arguments] + [operation.shape],
                dtype,
                sum(x.configuration for x in term.arguments),  # which come first
                [at.start for j in robot for at in j.quaternions],
                function_of(robot, term, settled, dtype, now=True),
                minor,
            )
    except CompilerError:
        return None
    return name, _made[name]
