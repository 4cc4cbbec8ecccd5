"""Public functions as built-in functions: `rnea(robot, q, v, a)` finds its kernel in machine code.

A call has a form: the function, the robot, how many arguments come by position, the names of the others, and the
options, each the very object.  The first call of a form is Python's; it says which fast call answers such calls and
where the arrays are, and from then on `codegen.fast_call.public` knows it.  Whatever differs is a form of its own.

The built-in functions are made before there is any machine code: until then, and for every call of no known form,
they are `PyObject_Vectorcall`, whose arguments are those of a built-in function, with the callable as `self`.  As for
all built-in functions that is a module, here one that can be called, so that they are pickled by their name.
"""

from __future__ import annotations

import ctypes
import inspect
import types
import weakref
from collections.abc import Callable, Sequence
from typing import Any

from ...locking import LOCK
from ..codegen import fast_call as source
from .fast_call import _FAST_KEYWORDS, _Method, _new_function, addresses, forms, spec_of

_FIELDS: dict[str, Any] = {"i64": ctypes.c_int64, "ptr": ctypes.c_void_p}


class Form(ctypes.Structure):
    """How a function was called, and what answers such a call."""

    _fields_ = [(name, _FIELDS[kind]) for name, kind in source.FORM.items()]
    kept: tuple[Any, ...] = ()

    def forget(self) -> None:
        """The robot is gone, and another may soon have its address.  One store: this may come at any moment."""
        self.robot = None
        self.kept = ()

    def alike(self, other: Form) -> bool:
        """Whether the options are equal, if not the same: of such there may be no end."""
        head = ("function", "robot", "given", "names", "out", "options")
        return self.kept[:2] == other.kept[:2] and all(getattr(self, x) == getattr(other, x) for x in head)


class Body(types.ModuleType):
    """The `self` of a public function: what Python calls when machine code does not answer."""

    def __init__(self, name: str, module: str, call: Callable[..., Any], doc: str) -> None:
        super().__init__(module)
        self.call = call
        self.method = _Method(name.encode(), ctypes.cast(_vectorcall(), ctypes.c_void_p), _FAST_KEYWORDS, doc.encode())

    def __call__(self, *args: Any, **named: Any) -> Any:
        return self.call(*args, **named)


def _vectorcall() -> Any:
    return ctypes.pythonapi.PyObject_Vectorcall


_bodies: list[Body] = []  # that are not machine code yet
_buckets: list[list[Form]] = [[] for _ in range(source.BUCKETS)]  # what `forms` points to


def builtin(function: Callable[..., Any], call: Callable[..., Any]) -> Any:
    """A built-in function with the name, the signature and the docstring of `function`, that does what `call` does."""
    plain = [p.replace(annotation=inspect.Parameter.empty) for p in inspect.signature(function).parameters.values()]
    signature = str(inspect.Signature(plain))
    doc = f"{function.__name__}{signature}\n--\n\n{inspect.getdoc(function)}"
    body = Body(function.__name__, function.__module__, call, doc)
    _bodies.append(body)
    return _new_function(ctypes.addressof(body.method), body, id(function.__module__))


def remember(
    function: Any, robot: Any, answer: Any, args: Sequence[Any], names: Sequence[str], arrays: Sequence[int], out: int
) -> None:
    """From now on machine code knows this form of call.

    Parameters
    ----------
    answer : callable
        Takes such calls' arrays, in order.
    args : sequence
        All arguments, those with names last.
    arrays, out : int
        Which of them are the arrays, and which the array for the result; -1 if there is none.
    """
    spec = spec_of(answer)
    rest = [k for k in range(1, len(args)) if k not in arrays and k != out]
    if spec is None or len(rest) > source.OPTIONS:
        return
    body = function.__self__
    input_at = (ctypes.c_int64 * len(arrays))(*arrays)
    option_at = (ctypes.c_int64 * len(rest))(*rest)
    option = (ctypes.c_void_p * len(rest))(*(id(args[k]) for k in rest))
    name = (ctypes.c_void_p * len(names))(*map(id, names))
    form = Form(
        id(body), id(robot), len(args) - len(names), len(names), spec, len(arrays), out, len(rest),
        *(ctypes.addressof(x) for x in (input_at, option_at, option, name)),
    )  # fmt: skip
    form.kept = ([args[k] for k in rest], list(names), answer, input_at, option_at, option, name)
    number = (id(body) >> 5) + (id(robot) >> 4) & source.BUCKETS - 1
    with LOCK:
        _adopt()
        here, there = _buckets[number], forms[number]
        if any(x.alike(form) for x in here):
            return
        free = next((k for k, x in enumerate(here) if not x.robot), len(here))
        if free == source.FORMS:
            return  # looking through more would take longer than Python's way
        weakref.finalize(robot, form.forget).atexit = False
        here[free : free + 1] = [form]
        there[1 + free] = ctypes.addressof(form)
        there[0] = len(here)  # last: it says that the rest is there


def _adopt() -> None:
    """Every public function is machine code now."""
    address = addresses()["public"]
    for body in _bodies:
        body.method.function = address
    _bodies.clear()


__all__ = ["builtin", "remember"]
