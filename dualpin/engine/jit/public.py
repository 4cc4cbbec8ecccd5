"""Public functions as built-in functions: `rnea(robot, q, v, a)` finds its kernel in machine code.

A call has a form: the function, the robot, the number of positional arguments, the names of the others, and the
options, compared by identity.  The first call of a form runs in Python and records which fast call answers it and where
its arrays are; `codegen.fast_call.public` answers later calls of this form.

The built-in functions exist before there is machine code: until then, and for unknown forms, they call
`PyObject_Vectorcall`, whose arguments are those of a built-in function, with the callable as `self`.  As for all
built-in functions `self` is a module, here a callable one, so that they are pickled by name.
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
from .fast_call import _FAST_KEYWORDS, _FIELDS, _Method, _new_function, addresses, forms, spec_of


class Form(ctypes.Structure):
    """The form of a call, and the fast call that answers it."""

    _fields_ = [(name, _FIELDS[kind]) for name, kind in source.FORM.items()]
    kept: tuple[Any, ...] = ()

    def forget(self) -> None:
        """Invalidate the form when its robot is deleted and its address may be reused; by one atomic store."""
        self.robot = None
        self.kept = ()

    def alike(self, other: Form) -> bool:
        """Whether the options are equal but not identical; such forms are not recorded, to bound their number."""
        head = ("function", "robot", "given", "names", "out", "options")
        return self.kept[:2] == other.kept[:2] and all(getattr(self, x) == getattr(other, x) for x in head)


class Body(types.ModuleType):
    """The `self` of a public function, called when machine code does not answer."""

    def __init__(self, name: str, module: str, call: Callable[..., Any], doc: str) -> None:
        super().__init__(module)
        self.call = call
        self.method = _Method(name.encode(), ctypes.cast(_vectorcall(), ctypes.c_void_p), _FAST_KEYWORDS, doc.encode())

    def __call__(self, *args: Any, **named: Any) -> Any:
        return self.call(*args, **named)


def _vectorcall() -> Any:
    return ctypes.pythonapi.PyObject_Vectorcall


_bodies: list[Body] = []  # functions without machine code so far
_buckets: list[list[Form]] = [[] for _ in range(source.BUCKETS)]  # the targets of `forms`


def builtin(function: Callable[..., Any], call: Callable[..., Any]) -> Any:
    """A built-in function with name, signature and docstring of `function` that executes `call`."""
    plain = [p.replace(annotation=inspect.Parameter.empty) for p in inspect.signature(function).parameters.values()]
    signature = str(inspect.Signature(plain))
    doc = f"{function.__name__}{signature}\n--\n\n{inspect.getdoc(function)}"
    body = Body(function.__name__, function.__module__, call, doc)
    _bodies.append(body)
    return _new_function(ctypes.addressof(body.method), body, id(function.__module__))


def remember(
    function: Any, robot: Any, answer: Any, args: Sequence[Any], names: Sequence[str], arrays: Sequence[int], out: int
) -> None:
    """Record a form, so that machine code answers its calls.

    Parameters
    ----------
    answer : callable
        The callable for the arrays, in order.
    args : sequence
        All arguments, keyword arguments last.
    arrays, out : int
        Indices of the arrays, and of the array for the result; -1 if there is none.
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
            return  # a longer search would be slower than the Python route
        weakref.finalize(robot, form.forget).atexit = False
        here[free : free + 1] = [form]
        there[1 + free] = ctypes.addressof(form)
        there[0] = len(here)  # last, when the other fields are complete


def _adopt() -> None:
    """Switch all public functions to machine code."""
    address = addresses()["public"]
    for body in _bodies:
        body.method.function = address
    _bodies.clear()


__all__ = ["builtin", "remember"]
