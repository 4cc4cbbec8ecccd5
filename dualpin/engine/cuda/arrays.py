"""Arrays on a device: dualpin's own, and those of PyTorch, CuPy, JAX and other libraries with their protocols.

Results have the type of the arguments, in the current stream of their library: without copies and without waiting.
"""

from __future__ import annotations

import contextlib
import itertools
import math
import sys
from collections import deque
from typing import Any

import numpy as np

from ...errors import ArgumentError
from . import dlpack
from .dlpack import Lent, contiguous
from .driver import Device, Event, device

LEGACY = 0  # the default stream, which synchronises with all others


class DeviceArray:
    """An array in the memory of a GPU, made by dualpin; other libraries can use it without a copy.

    It supports DLPack and the CUDA array interface: ``torch.from_dlpack(x)``, ``cupy.asarray(x)``.

    Attributes
    ----------
    shape, dtype
    device : Device
    """

    def __init__(self, shape: tuple[int, ...], dtype: np.dtype, where: Device, stream: int) -> None:
        self.shape, self.dtype, self.device, self.stream = shape, np.dtype(dtype), where, stream
        self.nbytes = math.prod(shape) * self.dtype.itemsize
        self.pointer = where.allocate(self.nbytes, stream)

    def __repr__(self) -> str:
        return f"<DeviceArray {self.shape} {self.dtype} on {self.device!r}>"

    def __del__(self) -> None:
        with contextlib.suppress(Exception):  # at the end of the process the driver may be gone
            self.device.free(self.pointer, self.stream)

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        return {
            "shape": self.shape, "typestr": self.dtype.str, "data": (self.pointer, False), "strides": None,
            "version": 3, "stream": self.stream or 1,
        }  # fmt: skip

    def __dlpack_device__(self) -> tuple[int, int]:
        return dlpack.CUDA, self.device.ordinal

    def __dlpack__(self, *, stream: int | None = None, **_: Any) -> Any:
        if stream not in (-1, None):
            self.device.follow(0 if stream == 1 else stream, self.stream)
        return dlpack.capsule(self, self.pointer, self.shape, self.dtype, self.device.ordinal)

    def to_host(self, into: np.ndarray | None = None) -> np.ndarray:
        """A copy as a NumPy array, or in a given contiguous array of the same size; waits for the results."""
        x = np.empty(self.shape, self.dtype) if into is None else into
        if x.nbytes != self.nbytes or not x.flags.c_contiguous:
            raise ArgumentError(f"an array of {self.nbytes} bytes without gaps expected, got {x.shape} of {x.dtype}")
        self.device.to_host(x.ctypes.data, self.pointer, x.nbytes, self.stream)
        self.device.wait(self.stream)
        return x


def to_device(x: np.ndarray, where: Device | str | int = "cuda", stream: int = LEGACY) -> DeviceArray:
    """A copy of a NumPy array on a device.

    Parameters
    ----------
    x : ndarray
    where : Device, str or int
        As of `device`.
    stream : int
        In which it is copied.

    Returns
    -------
    DeviceArray

    Raises
    ------
    DeviceError
        If there is no such device.

    Examples
    --------
    >>> from dualpin.engine.cuda import to_device
    >>> to_device(np.zeros(3)).to_host()          # doctest: +SKIP
    array([0., 0., 0.])
    """
    place = where if isinstance(where, Device) else device(where)
    source = np.ascontiguousarray(x)
    result = DeviceArray(source.shape, source.dtype, place, stream)
    place.to_device(result.pointer, source.ctypes.data, source.nbytes, stream)
    place.wait(stream)  # the source may be deleted afterwards
    return result


class Adapter:
    """The interface to arrays of a library.

    Attributes
    ----------
    follows : bool
        Whether its allocator is stream-ordered: freed arrays remain valid until kernels in the stream have read them.
    """

    follows = False

    def signature(self, x: Any) -> Any:
        """Shape, strides, type and device of an array, if they are cheap to read; else None."""
        return None

    def pointer(self, x: Any, stream: int) -> int:
        """The address of an array with a signature, for use in a stream."""
        raise NotImplementedError

    def lent(self, x: Any, stream: int) -> Lent:
        """An array as its address and strides in bytes, to be used in a stream."""
        if _on_cuda(x):
            return dlpack.received(x, stream)
        about = x.__cuda_array_interface__
        theirs = about.get("stream")
        if theirs is not None:
            device().follow(stream, 0 if theirs == 1 else theirs)
        dtype, shape = np.dtype(about["typestr"]), tuple(about["shape"])
        strides = about.get("strides") or contiguous(shape, dtype.itemsize)
        return Lent(about["data"][0], shape, tuple(strides), dtype, 0, x)

    def stream(self, where: Device) -> int:
        """The library's current stream."""
        return LEGACY

    def empty(self, shape: tuple[int, ...], dtype: np.dtype, where: Device, stream: int, columns: int) -> Any:
        """An array for results; if `columns` axes follow the first one, the first one is contiguous."""
        return DeviceArray(shape, dtype, where, stream)

    def finished(self, result: Any) -> Any:
        """What the caller gets."""
        return result


class Ours(Adapter):
    def signature(self, x: Any) -> Any:
        return x.shape, x.dtype, x.device.ordinal

    def pointer(self, x: Any, stream: int) -> int:
        if x.stream != stream:
            x.device.follow(stream, x.stream)
        return x.pointer

    def lent(self, x: Any, stream: int) -> Lent:
        strides = contiguous(x.shape, x.dtype.itemsize)
        return Lent(self.pointer(x, stream), x.shape, strides, x.dtype, x.device.ordinal, x)


class Torch(Adapter):
    follows = True

    def signature(self, x: Any) -> Any:
        return x.shape, x.stride(), x.dtype, x.get_device()

    def pointer(self, x: Any, stream: int) -> int:
        return x.data_ptr()

    def lent(self, x: Any, stream: int) -> Lent:
        item = x.element_size()
        kind = np.dtype(str(x.dtype).removeprefix("torch.").replace("bfloat16", "V2"))
        return Lent(x.data_ptr(), tuple(x.shape), tuple(s * item for s in x.stride()), kind, x.get_device(), x)

    def stream(self, where: Device) -> int:
        torch = sys.modules["torch"]
        quick = getattr(torch._C, "_cuda_getCurrentRawStream", None)
        return quick(where.ordinal) if quick else torch.cuda.current_stream(where.ordinal).cuda_stream

    def empty(self, shape: tuple[int, ...], dtype: np.dtype, where: Device, stream: int, columns: int) -> Any:
        torch = sys.modules["torch"]
        kind, place = (torch.float64 if dtype.itemsize == 8 else torch.float32), f"cuda:{where.ordinal}"
        if columns:
            return torch.empty((*shape[1:], shape[0]), dtype=kind, device=place).movedim(-1, 0)
        return torch.empty(shape, dtype=kind, device=place)


class CuPy(Adapter):
    follows = True

    def signature(self, x: Any) -> Any:
        return x.shape, x.strides, x.dtype, x.data.device_id

    def pointer(self, x: Any, stream: int) -> int:
        return x.data.ptr

    def lent(self, x: Any, stream: int) -> Lent:
        return Lent(x.data.ptr, x.shape, x.strides, x.dtype, x.data.device_id, x)

    def stream(self, where: Device) -> int:
        return sys.modules["cupy"].cuda.get_current_stream(where.ordinal).ptr

    def empty(self, shape: tuple[int, ...], dtype: np.dtype, where: Device, stream: int, columns: int) -> Any:
        cupy = sys.modules["cupy"]
        with cupy.cuda.Device(where.ordinal):
            if columns:
                return cupy.moveaxis(cupy.empty((*shape[1:], shape[0]), dtype), -1, 0)
            return cupy.empty(shape, dtype)


class Jax(Adapter):
    def stream(self, where: Device) -> int:
        # XLA's streams are not accessible: an own stream waits for them, and they wait for it
        if where.ordinal not in _streams:
            _streams[where.ordinal] = where.stream()
        return _streams[where.ordinal]

    def finished(self, result: Any) -> Any:
        return sys.modules["jax"].dlpack.from_dlpack(result)


_streams: dict[int, int] = {}
_OTHERS, _OURS, _TORCH, _CUPY, _JAX = Adapter(), Ours(), Torch(), CuPy(), Jax()


def adapter(x: Any) -> Adapter | None:
    """The adapter for an array on a device; None for arrays on the host."""
    kind = type(x)
    if kind is DeviceArray:
        return _OURS
    top = kind.__module__.partition(".")[0]
    if top == "torch" and hasattr(x, "data_ptr"):
        return _TORCH if x.is_cuda else None
    if top == "cupy" and hasattr(x, "strides"):
        return _CUPY
    if top in ("jaxlib", "jax"):
        return _JAX if _on_cuda(x) else None
    if isinstance(x, (np.ndarray, list, tuple, float, int)):
        return None
    return _OTHERS if hasattr(x, "__cuda_array_interface__") or _on_cuda(x) else None


def _on_cuda(x: Any) -> bool:
    ask = getattr(x, "__dlpack_device__", None)
    return ask is not None and ask()[0] == dlpack.CUDA


_reading: deque[tuple[Event, Any]] = deque()
"""Arguments that kernels may still read, each with the event after which they are free."""


def held(needs: Any, stream: int) -> None:
    """Keep arguments until the work in the stream is done; release those of finished calls."""
    _reading.append((Event(stream), needs))
    with contextlib.suppress(IndexError):  # another thread took it
        while _reading[0][0].passed():
            _reading.popleft()


def handle(stream: Any) -> int:
    """A stream of any library as a number."""
    for name in ("cuda_stream", "ptr", "handle"):
        if hasattr(stream, name):
            return int(getattr(stream, name) or 0)
    if isinstance(stream, bool) or not isinstance(stream, int):
        kind = type(stream).__name__
        raise ArgumentError(f"stream: a number, or an object with .cuda_stream or .ptr, expected, got {kind}")
    return stream


def one_step(shape: tuple[int, ...], strides: tuple[int, ...], itemsize: int) -> int | None:
    """The constant stride, in numbers, of several axes taken as one; None if there is none."""
    axes = [(size, step) for size, step in zip(shape, strides, strict=True) if size != 1]
    if not axes:
        return 1
    for (_, outer), (size, inner) in itertools.pairwise(axes):
        if outer != size * inner:
            return None
    step = axes[-1][1]
    return step // itemsize if step % itemsize == 0 else None


def span(x: Lent) -> tuple[int, int]:
    """The first and last byte of an array, relative to its address."""
    steps = [(size - 1) * step for size, step in zip(x.shape, x.strides, strict=True)]
    if 0 in x.shape:
        return 0, 0
    return sum(min(0, s) for s in steps), sum(max(0, s) for s in steps) + x.dtype.itemsize


class _Description:
    def __init__(self, x: Lent) -> None:
        self.__array_interface__ = {
            "version": 3, "shape": x.shape, "strides": x.strides, "typestr": x.dtype.str, "data": (x.pointer, True),
        }  # fmt: skip


def overlap(a: Lent, b: Lent) -> bool:
    """Whether two arrays share a number."""
    # NumPy decides from addresses and strides; the memory on the device is not accessed
    return bool(np.shares_memory(np.asarray(_Description(a)), np.asarray(_Description(b))))
