"""The fast call: a function of machine code that Python calls, and that calls a kernel.

For a robot of a few joints the kernel takes less time than any Python code around it, for one
configuration and for thousands.  So the function that Python calls is compiled too, from
`codegen.fast_call`: one for all kernels, with a `Spec` in the capsule that is its `self`.  It accepts float64 (or
float32) arrays, C-contiguous, of the right shape or with one batch axis before it.  All other calls go to a Python
function that converts, allocates large results, uses several threads or raises the error.

Only the stable ABI of CPython 3.11 and later and the binary interface of NumPy 2 are used: its table of functions, and
the fields of an array, whose places are verified first.  To ask Python for them instead (the attribute `dtype` and a
buffer of each array) takes longer than the inverse dynamics of an arm: 0.24 us a call instead of 0.15 (ur5).
"""

from __future__ import annotations

import copyreg
import ctypes
import hashlib
import sys
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from ... import memory
from ...locking import LOCK, Once
from .. import tuning
from ..codegen import fast_call as source
from . import cache as disk
from . import threads
from .compiler import loaded, object_code, stores
from .fingerprint import compiler_key
from .host import CompilerError, this_host
from .kernel import Kernel

_FAST_KEYWORDS = 0x82  # METH_FASTCALL | METH_KEYWORDS
_NUMPY = 2  # version of the binary interface
_FIELDS: dict[str, Any] = {"i64": ctypes.c_int64, "i32": ctypes.c_int32, "ptr": ctypes.c_void_p}


class Code(ctypes.Structure):
    """The two kernels of a term, for one sample and for many; an address is 0 until it is compiled."""

    _fields_ = [("address", ctypes.c_void_p * 2), ("scratch", ctypes.c_int64 * 2), ("most", ctypes.c_int64)]
    one: Kernel | None = None
    many: Kernel | None = None

    def adopt(self, kernel: Kernel, many: bool) -> None:
        """Let the entry call this kernel directly."""
        with LOCK:
            if self.address[many]:
                return  # another thread was first, and its kernel may be in use
            if many:
                self.many, self.most = kernel, int(tuning.PARALLEL_FROM / kernel.seconds)
            else:
                self.one = kernel
            self.scratch[many] = kernel.scratch
            self.address[many] = kernel.address  # last: the entry reads the other fields only if it is set


class Spec(ctypes.Structure):
    """The data of the entry; each field has eight bytes."""

    _fields_ = [
        ("code", ctypes.c_void_p),
        ("inputs", ctypes.c_int64),
        ("dtype", ctypes.py_object),
        ("array", ctypes.py_object),
        ("slow", ctypes.py_object),
        ("out_name", ctypes.py_object),
        ("none", ctypes.py_object),
        ("quaternions", ctypes.c_int64),
        ("quaternion_at", ctypes.c_void_p),
        ("shapes", ctypes.c_void_p),
        ("strides", ctypes.c_void_p),
        ("single", ctypes.c_int64),
        ("alone", ctypes.c_int64),
        ("threads", ctypes.c_void_p),
        ("pooled", ctypes.c_int64),
    ]


class _Method(ctypes.Structure):
    _fields_ = [
        ("name", ctypes.c_char_p), ("function", ctypes.c_void_p), ("flags", ctypes.c_int), ("doc", ctypes.c_char_p),
    ]  # fmt: skip


def supported(shapes: Sequence[tuple[int, ...]] = ()) -> bool:
    """Whether this Python has the required stable ABI, and the shapes fit into the tables."""
    return (
        sys.implementation.name == "cpython"
        and sys.version_info >= (3, 11)
        and not _without_gil()  # borrowed references need it
        and ctypes.sizeof(ctypes.c_void_p) == 8
        and hasattr(ctypes.pythonapi, "PyObject_Vectorcall")
        and len(shapes) <= source.MOST
        and all(len(shape) <= source.AXES for shape in shapes)
    )


def _without_gil() -> bool:
    """Whether Python was built without the GIL, as is possible from 3.13 on."""
    if sys.version_info < (3, 13):
        return False
    import sysconfig

    return bool(sysconfig.get_config_var("Py_GIL_DISABLED"))


def bound(
    code: Code, name: str, shapes: list[tuple[int, ...]], dtype: np.dtype, quaternions: list[int], doc: str,
    *, slow: Callable[..., Any], alone: bool,
) -> Callable[..., np.ndarray]:  # fmt: skip
    """A callable (*arrays, out=None) -> array; `slow` gets all calls that need conversion.

    It accepts batches if `out` is given and does not overlap the inputs.

    Parameters
    ----------
    shapes : list of tuple
        Shapes of each input and, last, of the result, for one sample.
    quaternions : list of int
        Indices of unit quaternions in the first input; if a norm is wrong, the call goes to `slow`.
    alone : bool
        Whether all batches are computed on this thread; else `slow` gets those worth several threads.
    """
    table = np.zeros((len(shapes), 2 + source.AXES), np.int64)  # ndim, bytes, axes
    for row, shape in zip(table, shapes, strict=True):
        row[0], row[1] = len(shape), int(np.prod(shape, dtype=int)) * dtype.itemsize
        row[2 : 2 + len(shape)] = shape
    at, strides = np.array([*quaternions, 0], np.int64), table[:, 1] // dtype.itemsize
    spec = Spec(
        ctypes.addressof(code), len(shapes) - 1, dtype, np.ndarray, slow, "out", None,
        len(quaternions), at.ctypes.data, table.ctypes.data, strides.ctypes.data, dtype.itemsize == 4,
        alone, ctypes.addressof(threads.count), memory.FROM,
    )  # fmt: skip
    spec.out_name = sys.intern("out")
    method = _Method(name.encode(), addresses()["entry"], _FAST_KEYWORDS, doc.encode())
    owner = SimpleNamespace(name=name, slow=slow, memory=(code, spec, method, table, at, strides), objects=(dtype,))
    capsule = _new_capsule(ctypes.addressof(spec), None, addresses()["release"])
    _keep(owner)  # released by `release`, the capsule's destructor
    _set_context(capsule, id(owner))
    copyreg.pickle(type(capsule), _reduced)
    return _new_function(ctypes.addressof(method), capsule, None)


def spec_of(f: Any) -> int | None:
    """The address of the spec of a fast call; None for other objects."""
    capsule = getattr(f, "__self__", None)
    if type(capsule).__name__ != "PyCapsule" or _destructor(capsule) != addresses()["release"]:
        return None
    found: int | None = _pointer(capsule, None)
    return found


def _reduced(capsule: Any) -> tuple[Any, ...]:
    """Pickling of a capsule: a C function is pickled as an attribute of its `self`."""
    if _destructor(capsule) != addresses()["release"]:
        raise TypeError("cannot pickle 'PyCapsule' object")
    owner = ctypes.cast(_context(capsule), ctypes.py_object).value
    return _self_with, (owner.name, *owner.slow.__reduce__())


def _self_with(name: str, make: Callable[..., Any], arguments: tuple[Any, ...]) -> SimpleNamespace:
    return SimpleNamespace(**{name: make(*arguments)})


def python_function(name: str, result: Any, *arguments: Any) -> Any:
    """A function of the C API with its own types, since other packages may change those of `ctypes.pythonapi`."""
    return ctypes.PYFUNCTYPE(result, *arguments)((name, ctypes.pythonapi))


_object, _address = ctypes.py_object, ctypes.c_void_p
_new_capsule = python_function("PyCapsule_New", _object, _address, ctypes.c_char_p, _address)
_set_context = python_function("PyCapsule_SetContext", ctypes.c_int, _object, _address)
_context = python_function("PyCapsule_GetContext", _address, _object)
_pointer = python_function("PyCapsule_GetPointer", _address, _object, ctypes.c_char_p)
_destructor = python_function("PyCapsule_GetDestructor", _address, _object)
_new_function = python_function("PyCFunction_NewEx", _object, _address, _object, _address)
_keep = python_function("Py_IncRef", None, _object)


@Once
def addresses() -> dict[str, Any]:
    """The emitted functions; compiled once in a process.

    Raises
    ------
    CompilerError
        If there is no compiler, or arrays are not what they are known to be.
    """
    if not _arrays_as_known():
        raise CompilerError("this NumPy's arrays are laid out in another way")
    names = ("entry", "public", "release")
    api = {name: ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value or 0 for name in _PYTHON}
    imports = api | _numpy() | {"forms": ctypes.addressof(forms), "stores": ctypes.addressof(stores)}
    text, key = _written()
    found = disk.load(key, "calls")
    try:
        code = loaded([found[1]], names, imports) if found else None
    except CompilerError:  # damaged: compile again
        code = None
    if code is None:
        made = object_code(text, this_host())
        code = loaded([made], names, imports)
        disk.store(key, {}, made, "calls")
    return {name: code[name] for name in names} | {"code": code}  # keeps the memory


@Once
def _written() -> tuple[str, str]:
    """The functions as text, and the key of their machine code in the cache."""
    fields = {name: "i64" if kind is ctypes.c_int64 else "ptr" for name, kind, *_ in Spec._fields_}
    text = source.text(fields, tuning.STACK)
    return text, f"fast call|{hashlib.sha256(text.encode()).hexdigest()}|{compiler_key(this_host())}"


def at_hand() -> bool:
    """Whether `addresses` answers at once, if only to say that there are none: to compile them takes longer."""
    try:
        return bool(addresses.made) or not (supported() and _arrays_as_known()) or disk.stored(_written()[1], "calls")
    except CompilerError:
        return True


_PYTHON = (*source.API, "PyObject_Vectorcall")
forms = ((ctypes.c_void_p * (source.FORMS + 1)) * source.BUCKETS)()
"""The known forms of calls, in buckets: their number and addresses."""


def _table() -> Any:
    """NumPy's binary interface."""
    return ctypes.cast(_pointer(np._core._multiarray_umath._ARRAY_API, None), ctypes.POINTER(ctypes.c_void_p))  # type: ignore[attr-defined]


def _numpy() -> dict[str, int]:
    """Functions of NumPy's binary interface."""
    table = _table()
    return {name: table[place] or 0 for name, (_, place) in source.NUMPY.items()}


class _Array(ctypes.Structure):
    _fields_ = [(name, _FIELDS[kind]) for name, kind in source.ARRAY.items()]


def _arrays_as_known() -> bool:
    """Whether NumPy's binary interface is that of version 2, and an array has its fields where they should be."""
    version = ctypes.CFUNCTYPE(ctypes.c_uint)(_table()[0])()
    x = np.zeros((2, 3))
    found = _Array.from_address(id(x))
    if version >> 24 != _NUMPY or (found.type, found.dtype, found.ndim) != (id(np.ndarray), id(x.dtype), x.ndim):
        return False
    shape, strides = (ctypes.cast(at, ctypes.POINTER(ctypes.c_int64)) for at in (found.shape, found.strides))
    places = found.data, (shape[0], shape[1]), (strides[0], strides[1]), found.base
    flags = x.flags.num
    return places == (x.ctypes.data, x.shape, x.strides, None) and found.flags & 0xFFFF == flags & 0xFFFF
