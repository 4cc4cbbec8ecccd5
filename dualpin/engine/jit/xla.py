"""Terms as functions that XLA's programs call: handlers of machine code, kept as long as the process lives.

A program of XLA names a handler, and may be run at any time: neither may go.  The names are made of all that a kernel
depends on, so that equal robots share a handler, and that a program from XLA's cache on disk finds its own again.
"""

from __future__ import annotations

import ctypes
import hashlib
import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...locking import LOCK, Once
from .. import tuning
from ..codegen import xla as source
from . import cache as disk
from . import threads
from .compiler import loaded, object_code
from .fast_call import Code
from .fingerprint import compiler_key
from .host import this_host


class Spec(ctypes.Structure):
    """What a handler must know; each field takes eight bytes."""

    _fields_ = [
        ("code", ctypes.c_void_p),
        ("inputs", ctypes.c_int64),
        ("axes", ctypes.c_int64),
        ("strides", ctypes.c_void_p),
        ("configurations", ctypes.c_int64),
        ("quaternions", ctypes.c_int64),
        ("quaternion_at", ctypes.c_void_p),
        ("single", ctypes.c_int64),
        ("threads", ctypes.c_void_p),
        ("general", ctypes.c_void_p),
        ("minor", ctypes.c_int64),
    ]


_General = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_int64, ctypes.POINTER(ctypes.c_void_p))
_kept: list[Any] = []  # what handlers point to


def handler(
    code: Code, shapes: Sequence[tuple[int, ...]], dtype: np.dtype, configurations: int, quaternions: Sequence[int],
    general: Callable[..., Any], minor: int,
) -> int:  # fmt: skip
    """The address of a handler; `general`, (*arrays, out=), computes what it leaves.

    Parameters
    ----------
    shapes : sequence of tuple
        Of each input and, last, of the result, for one sample.
    configurations : int
        How many inputs, the first ones, are configurations, in which unit `quaternions` start at these places.
    minor : int
        XLA's interface is version 0.minor.

    Raises
    ------
    CompilerError
        If this machine has no working compiler.
    """
    number: Any = ctypes.c_float if dtype.itemsize == 4 else ctypes.c_double
    said: deque[Any] = deque(maxlen=64)  # XLA copies what it is told, soon after: a thread's own memory would be gone

    def array(address: int | None, n: int, shape: tuple[int, ...]) -> np.ndarray:
        size = n * math.prod(shape)
        flat = np.ctypeslib.as_array((number * size).from_address(address)) if size else np.empty(0, dtype)
        return flat.reshape(n, *shape)

    def computed(n: int, pointers: Any) -> int | None:
        try:
            *inputs, out = (array(pointers[k], n, shape) for k, shape in enumerate(shapes))
            general(*inputs, out=out)
        except BaseException as e:  # also Ctrl-C: nothing of Python's may pass through XLA
            message = ctypes.create_string_buffer((str(e) or type(e).__name__).encode())
            said.append(message)
            return ctypes.addressof(message)
        return None

    python = _General(computed)
    strides = np.array([math.prod(shape) for shape in shapes], np.int64)
    at = np.array([*quaternions, 0], np.int64)
    spec = Spec(
        ctypes.addressof(code), len(shapes) - 1, len(shapes[0]), strides.ctypes.data, configurations,
        len(quaternions), at.ctypes.data, dtype.itemsize == 4, ctypes.addressof(threads.count),
        ctypes.cast(python, ctypes.c_void_p).value, minor,
    )  # fmt: skip
    made = loaded([_object()], ("handler",), _imports() | {"spec": ctypes.addressof(spec)})
    with LOCK:
        _kept.append((code, python, strides, at, spec, made))
    address: int = made["handler"]
    return address


@Once
def _object() -> bytes:
    """The handler's code, the same for all: what it must know comes when it is linked."""
    fields = {name: "i64" if kind is ctypes.c_int64 else "ptr" for name, kind, *_ in Spec._fields_}
    text, host = source.text(fields, tuning.STACK), this_host()
    key = f"xla|{hashlib.sha256(text.encode()).hexdigest()}|{compiler_key(host)}"
    found = disk.load(key, "calls")
    if found is not None:
        return found[1]
    made = object_code(text, host)
    disk.store(key, {}, made, "calls")
    return made


def _imports() -> dict[str, int]:
    return {
        name: ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value or 0
        for name in ("PyMem_RawMalloc", "PyMem_RawFree")
    }
