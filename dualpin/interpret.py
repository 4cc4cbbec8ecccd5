"""Execution of a term by NumPy: the algorithm, run on columns of numbers.

One sample runs on plain floats, a batch on arrays with one number a sample.  Nothing is compiled;
this is the reference the compiled engine is tested against, and the path without a compiler.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np

from .algorithms.sharing import sharing
from .model.robot import Robot
from .scalars import ZERO, Exact, Scalar
from .terms import Options, Term, flat

SLICE = 1024  # samples at a time, so that the columns of one slice stay in the cache

_KNOWN: ContextVar[dict[Any, Any] | None] = ContextVar("known", default=None)


@contextmanager
def remembered() -> Iterator[None]:
    """Within this, in this thread, a term of the same robot, options and numbers is computed once, and so is what
    different terms or options have in common (for checks that share terms)."""
    if _KNOWN.get() is not None:  # the outer one remembers
        yield
        return
    token = _KNOWN.set({})
    try:
        with sharing():
            yield
    finally:
        _KNOWN.reset(token)


def interpret(robot: Robot, term: Term, options: Options, inputs: Sequence[np.ndarray]) -> np.ndarray:
    """Arrays (n, size) in, one array (n, *shape) out."""
    known = _KNOWN.get()
    if known is None:
        return _interpreted(robot, term, options, inputs)
    key = id(robot), term.name, *options.items(), *(x.tobytes() for x in inputs)
    if key not in known:
        known[key] = robot, _interpreted(robot, term, options, inputs)  # with the robot, so that its id stays its own
    return known[key][1].copy()


def _interpreted(robot: Robot, term: Term, options: Options, inputs: Sequence[np.ndarray]) -> np.ndarray:
    n, shape = len(inputs[0]), term.shape(robot, **options)
    out = np.zeros((n, math.prod(shape)))
    for start in range(0, n, SLICE):
        part = [x[start : start + SLICE] for x in inputs]
        block = out[start : start + SLICE]
        for i, value in enumerate(_results(robot, term, options, part)):
            if value is not ZERO:
                block[:, i] = float(value) if type(value) is Exact else value
    return out.reshape((n, *shape))


def _results(robot: Robot, term: Term, options: Options, part: Sequence[np.ndarray]) -> list[Scalar]:
    if len(part[0]) == 1:
        try:
            return list(flat(term.compute(robot, *(_columns(x, alone=True) for x in part), **options)))
        except (ArithmeticError, ValueError):
            pass  # floats raise where arrays give inf or nan: compute with arrays
    with np.errstate(all="ignore"):
        return list(flat(term.compute(robot, *map(_columns, part), **options)))


def _columns(x: np.ndarray, alone: bool = False) -> list[Scalar]:
    """The columns of an array, or the numbers of its only row; the same objects for the same numbers, if remembered."""
    known = _KNOWN.get()
    key = None if known is None else (alone, x.shape, x.tobytes())
    if known is None or key not in known:
        found: list[Scalar] = x[0].tolist() if alone else list(np.ascontiguousarray(x.T))
        if known is None:
            return found
        known[key] = found
    return list(known[key])
