"""DLPack: sharing arrays between libraries.  (dmlc/dlpack, version 0.8, which all of them read)"""

from __future__ import annotations

import ctypes
import itertools
from ctypes import POINTER, Structure, c_char_p, c_int32, c_int64, c_uint8, c_uint16, c_uint64, c_void_p
from typing import Any, NamedTuple

import numpy as np

from ..jit.fast_call import python_function

CUDA = 2
_FLOAT = 2


class _Tensor(Structure):
    _fields_ = [
        ("data", c_void_p), ("device_type", c_int32), ("device_id", c_int32), ("ndim", c_int32),
        ("code", c_uint8), ("bits", c_uint8), ("lanes", c_uint16),
        ("shape", POINTER(c_int64)), ("strides", POINTER(c_int64)), ("byte_offset", c_uint64),
    ]  # fmt: skip


class _Managed(Structure):
    _fields_ = [("tensor", _Tensor), ("context", c_void_p), ("deleter", c_void_p)]


_Deleter = ctypes.CFUNCTYPE(None, c_void_p)
_new = python_function("PyCapsule_New", ctypes.py_object, c_void_p, c_char_p, c_void_p)
_pointer = python_function("PyCapsule_GetPointer", c_void_p, ctypes.py_object, c_char_p)
_valid = python_function("PyCapsule_IsValid", ctypes.c_int, ctypes.py_object, c_char_p)
_raw_valid = python_function("PyCapsule_IsValid", ctypes.c_int, c_void_p, c_char_p)
_raw_pointer = python_function("PyCapsule_GetPointer", c_void_p, c_void_p, c_char_p)


class Lent(NamedTuple):
    """An array of another library, valid as long as `keep` exists."""

    pointer: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]
    dtype: np.dtype
    device: int
    keep: Any


def received(array: Any, stream: int) -> Lent:
    """An array that can be used from this stream on.

    The capsule owns the memory: it is not consumed, so its own destructor releases the memory.
    """
    capsule = array.__dlpack__(stream=stream or 1)  # 1 means the default stream in DLPack
    if not _valid(capsule, b"dltensor"):
        raise ValueError("not a DLPack capsule that can be read")
    t = _Managed.from_address(_pointer(capsule, b"dltensor")).tensor
    if t.device_type != CUDA or t.lanes != 1:
        raise ValueError("not an array of numbers on a CUDA device")
    kinds = {0: "i", 1: "u", _FLOAT: "f", 5: "c", 6: "b"}
    dtype = np.dtype(f"{kinds.get(t.code, 'V')}{t.bits // 8}")
    shape = tuple(t.shape[: t.ndim])
    strides = tuple(s * dtype.itemsize for s in t.strides[: t.ndim]) if t.strides else contiguous(shape, dtype.itemsize)
    return Lent((t.data or 0) + t.byte_offset, shape, strides, dtype, t.device_id, capsule)


def contiguous(shape: tuple[int, ...], itemsize: int) -> tuple[int, ...]:
    """Strides in bytes of a C-contiguous array."""
    steps = itertools.accumulate((max(1, n) for n in reversed(shape[1:])), lambda a, b: a * b, initial=itemsize)
    return tuple(reversed(list(steps))) if shape else ()


_lent: dict[int, tuple[Any, Any]] = {}
"""Arrays that other libraries hold, by the address of the descriptor."""


@_Deleter
def _returned(address: int) -> None:
    _lent.pop(address, None)


@_Deleter
def _unread(capsule: int) -> None:
    """The destructor of a capsule: releases the array if no library has taken it."""
    if _raw_valid(capsule, b"dltensor"):
        _returned(_raw_pointer(capsule, b"dltensor"))


def capsule(owner: Any, pointer: int, shape: tuple[int, ...], dtype: np.dtype, device: int) -> Any:
    """A capsule that shares a contiguous array; `owner` is kept until it is released."""
    axes = (c_int64 * len(shape))(*shape)
    item = dtype.itemsize
    steps = (c_int64 * len(shape))(*(s // item for s in contiguous(shape, item)))
    tensor = _Tensor(pointer, CUDA, device, len(shape), _FLOAT, 8 * item, 1, axes, steps, 0)
    managed = _Managed(tensor, None, ctypes.cast(_returned, c_void_p))
    address = ctypes.addressof(managed)
    _lent[address] = (owner, (managed, axes, steps))
    return _new(address, b"dltensor", ctypes.cast(_unread, c_void_p))
