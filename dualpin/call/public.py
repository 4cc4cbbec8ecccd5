"""Public functions: the first call of a form runs in Python; machine code answers later calls of that form."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from types import NoneType
from typing import Any, ParamSpec, TypeVar

import numpy as np

from ..engine.jit import fast_call
from ..engine.jit import public as machine
from ..model.robot import Frame, Robot
from ..terms import Term
from . import evaluator

P = ParamSpec("P")
T = TypeVar("T")
_OPTIONS = (str, bool, int, type, Frame, NoneType, np.generic, np.dtype)  # immutable types


def ask(asked: Term | tuple[Any, ...], *arrays: Any) -> Any:
    """The return value of a public function's body: a term, or a term followed by its options, and its arrays."""
    return asked, arrays


def public(body: Callable[P, T]) -> Callable[P, T]:
    """Make a public function, of a robot, arrays and options and with one array as result, from a body that uses `ask`.

    Its arrays have the term's names.  The arguments `out`, `dtype` and `engine` are handled here.
    """
    parameters = list(inspect.signature(body).parameters)  # keyword-only parameters are last

    ask_for: Callable[..., Any] = body

    @functools.wraps(body)
    def call(*args: Any, **named: Any) -> Any:
        asked, arrays = ask_for(*args, **named)
        robot = args[0] if args else named["robot"]
        engine = named.get("engine", "auto")
        found = evaluator(robot, asked, engine, named.get("dtype", "float64"))
        result = found(*arrays, named.get("out"))
        if function is not call and args and engine == "auto" and type(robot) is Robot:
            term = asked[0] if isinstance(asked, tuple) else asked
            names, everything = list(named), [*args, *named.values()]
            places = {name: k for k, name in enumerate([*parameters[: len(args)], *names])}
            at = [places[name] for name in term.inputs]
            out = places.get("out", -1)
            if all(isinstance(x, _OPTIONS) for k, x in enumerate(everything) if k and k not in at and k != out):
                machine.remember(function, robot, found, everything, names, at, out)
        return result

    function: Any = machine.builtin(body, call) if fast_call.supported() else call
    return function


def several(rank: int) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Make a public function whose results are the parts of one array, along the first of its last `rank` axes."""

    def public_parts(body: Callable[P, T]) -> Callable[P, T]:
        whole: Any = public(body)
        rest = (slice(None),) * (rank - 1)

        @functools.wraps(body)
        def call(*args: P.args, **named: P.kwargs) -> Any:
            found = whole(*args, **named)
            if found.ndim == rank:
                return tuple(found)
            places = ((..., k, *rest) for k in range(found.shape[-rank]))  # as any library's arrays understand
            return tuple(map(found.__getitem__, places))

        return call

    return public_parts


__all__ = ["ask", "public", "several"]
