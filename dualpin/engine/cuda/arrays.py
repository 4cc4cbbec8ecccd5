"""Arrays on a device: ours, and those of PyTorch, CuPy, JAX and whatever speaks their protocols.

Results come in the arguments' own kind, on their library's current stream: nothing is copied and
nobody waits.
"""

from __future__ import annotations

import contextlib
import math
import sys
from collections import deque
from typing import Any

import numpy as np

from ...errors import ArgumentError
from . import dlpack
from .dlpack import Lent, contiguous
from .driver import Device, Event, device

LEGACY = 0  # the default stream, which waits for all others and for which all others wait


class DeviceArray:
    """An array in the memory of a GPU, made by dualpin; other libraries take it as theirs without a copy.

    It speaks DLPack and the CUDA array interface: ``torch.from_dlpack(x)``, ``cupy.asarray(x)``.

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

    def to_host(self) -> np.ndarray:
        """A copy as a NumPy array; waits for the results."""
        x = np.empty(self.shape, self.dtype)
        self.device.to_host(x.ctypes.data, self.pointer, x.nbytes, self.stream)
        self.device.wait(self.stream)
        return x


def to_device(x: np.ndarray, where: Device | str | int = "cuda", stream: int = LEGACY) -> DeviceArray:
    """A copy of a NumPy array on a device.

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
    place.wait(stream)  # the source may go
    return result


def library_of(x: Any) -> str:
    """ "torch", "cupy", "jax", "device" for all others on a device, or "host"."""
    top = type(x).__module__.partition(".")[0]
    if top == "torch" and hasattr(x, "data_ptr"):
        return "torch" if x.is_cuda else "host"
    if top == "cupy":
        return "cupy"
    if isinstance(x, DeviceArray):
        return "device"
    if top in ("jaxlib", "jax"):
        return "jax" if _on_cuda(x) else "host"
    if isinstance(x, (np.ndarray, list, tuple, float, int)):
        return "host"
    return "device" if hasattr(x, "__cuda_array_interface__") or _on_cuda(x) else "host"


def _on_cuda(x: Any) -> bool:
    ask = getattr(x, "__dlpack_device__", None)
    return ask is not None and ask()[0] == dlpack.CUDA


def lent(x: Any, library: str, stream: int) -> Lent:
    """An array as its address and strides in bytes, to be used in a stream."""
    if library == "torch":
        item = x.element_size()
        kind = np.dtype(str(x.dtype).removeprefix("torch.").replace("bfloat16", "V2"))
        return Lent(x.data_ptr(), tuple(x.shape), tuple(s * item for s in x.stride()), kind, x.device.index, x)
    if library == "cupy":
        return Lent(x.data.ptr, x.shape, x.strides, x.dtype, x.device.id, x)
    if isinstance(x, DeviceArray):
        x.device.follow(stream, x.stream)
        return Lent(x.pointer, x.shape, contiguous(x.shape, x.dtype.itemsize), x.dtype, x.device.ordinal, x)
    if _on_cuda(x):
        return dlpack.received(x, stream)
    about = x.__cuda_array_interface__
    theirs = about.get("stream")
    if theirs is not None:
        device().follow(stream, 0 if theirs == 1 else theirs)
    dtype = np.dtype(about["typestr"])
    strides = about.get("strides") or contiguous(tuple(about["shape"]), dtype.itemsize)
    return Lent(about["data"][0], tuple(about["shape"]), tuple(strides), dtype, 0, x)


def current_stream(library: str, where: Device) -> int:
    """Where the library's next operation would go."""
    if library == "torch":
        return sys.modules["torch"].cuda.current_stream(where.ordinal).cuda_stream
    if library == "cupy":
        return sys.modules["cupy"].cuda.get_current_stream(where.ordinal).ptr
    if library == "jax":  # XLA's own streams cannot be asked for: ours follows them, and they follow ours
        return _own_stream(where)
    return LEGACY


_streams: dict[int, int] = {}


def _own_stream(where: Device) -> int:
    if where.ordinal not in _streams:
        _streams[where.ordinal] = where.stream()
    return _streams[where.ordinal]


def empty(library: str, shape: tuple[int, ...], dtype: np.dtype, where: Device, stream: int) -> Any:
    """An array for results, of the library if its arrays can be written to."""
    if library == "torch":
        torch = sys.modules["torch"]
        kind = torch.float64 if dtype.itemsize == 8 else torch.float32
        return torch.empty(shape, dtype=kind, device=f"cuda:{where.ordinal}")
    if library == "cupy":
        cupy = sys.modules["cupy"]
        with cupy.cuda.Device(where.ordinal):
            return cupy.empty(shape, dtype)
    return DeviceArray(shape, dtype, where, stream)


_reading: deque[tuple[Event, Any]] = deque()
"""Arguments that kernels may still be reading, and the point in the stream after which they are not."""


def held(needs: Any, stream: int) -> None:
    """Keep arguments until what is in the stream is done; those of calls that are done are let go."""
    _reading.append((Event(stream), needs))
    with contextlib.suppress(IndexError):  # another thread took it
        while _reading[0][0].passed():
            _reading.popleft()


def finished(result: Any, library: str) -> Any:
    """What the caller gets: for JAX, its own array of the same memory."""
    return sys.modules["jax"].dlpack.from_dlpack(result) if library == "jax" else result


def mixed(term: str, kinds: dict[str, str]) -> ArgumentError:
    """Arguments here and there."""
    where = ", ".join(f"{name}: {'host' if kind == 'host' else 'device'}" for name, kind in kinds.items())
    return ArgumentError(f"{term}: all arrays on the device or all on the host expected, got {where}")
