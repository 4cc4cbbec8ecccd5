"""Public functions: what a call asks for is said in Python once, and answered by machine code from then on."""

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
_OPTIONS = (str, bool, int, type, Frame, NoneType, np.generic, np.dtype)  # that do not change


def ask(asked: Term | tuple[Any, ...], *arrays: Any) -> Any:
    """What the body of a public function returns: a term, or one followed by its options, and the arrays for it."""
    return asked, arrays


def public(body: Callable[P, T]) -> Callable[P, T]:
    """A function of a robot, arrays and options that returns one array, from a body that says what it asks for.

    Its arrays are called as the term calls them; `out`, `dtype` and `engine`, which it takes too, are seen to here.
    """
    parameters = list(inspect.signature(body).parameters)  # those without a place are the last

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


__all__ = ["ask", "public"]
