"""The CUDA driver, called by ctypes: devices, memory, streams, modules, launches.

No other part of CUDA is needed: the driver assembles PTX.  All libraries on a device share its primary context, so
their arrays and streams can be used together.
"""

from __future__ import annotations

import contextlib
import ctypes
import sys
import threading
from collections.abc import Iterator, Sequence
from ctypes import byref, c_char_p, c_int, c_size_t, c_uint, c_uint64, c_void_p
from functools import cache
from typing import Any

from ...errors import DeviceError

_ATTRIBUTES = {
    "multiprocessors": 16, "registers": 82, "major": 75, "minor": 76, "pools": 115,
}  # fmt: skip
_FUNCTION = {"shared": 1, "local": 3, "registers": 4}
_DYNAMIC_SHARED = 8
_ERROR_LOG, _ERROR_LOG_SIZE = 5, 6
_PTX = 1
_OUT_OF_MEMORY, _NOT_READY = 2, 600
_NO_TIMING = 2
_ELSEWHERE = (201, 400, 709)  # invalid context or handle: this thread has another device, or none yet


@cache
def library() -> ctypes.CDLL:
    """The driver, initialised.

    Raises
    ------
    DeviceError
        If there is none, or no device.
    """
    name = "nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1"
    try:
        found = ctypes.CDLL(name)
    except OSError as e:
        raise DeviceError(f"no CUDA driver on this machine ({e}); device='cuda' needs an Nvidia GPU") from None
    status = found.cuInit(0)
    if status:
        raise DeviceError(f"the CUDA driver finds no device it can use: {_reason(found, status)}")
    return found


def _reason(found: ctypes.CDLL, status: int) -> str:
    name, text = c_char_p(), c_char_p()
    found.cuGetErrorName(status, byref(name))
    found.cuGetErrorString(status, byref(text))
    return f"{(name.value or b'?').decode()} ({(text.value or b'').decode()})"


def call(name: str, *args: Any) -> None:
    """Call a function of the driver; raises with the driver's message if it fails."""
    found = library()
    status = getattr(found, name)(*args)
    if status:
        hint = "; smaller batches take less" if status == _OUT_OF_MEMORY else ""
        raise DeviceError(f"CUDA: {name}: {_reason(found, status)}{hint}")


def version() -> int:
    """The driver's CUDA version: 13000 is CUDA 13.0."""
    value = c_int()
    call("cuDriverGetVersion", byref(value))
    return value.value


def count() -> int:
    """The number of devices; 0 without a driver."""
    try:
        value = c_int()
        call("cuDeviceGetCount", byref(value))
    except DeviceError:
        return 0
    return value.value


class Device:
    """One GPU.

    Attributes
    ----------
    name : str
    capability : int
        90 is 9.0.
    multiprocessors, registers : int
        The device's resources; registers of a multiprocessor.
    """

    multiprocessors: int
    registers: int

    def __init__(self, ordinal: int) -> None:
        self.ordinal, handle = ordinal, c_int()
        call("cuDeviceGet", byref(handle), ordinal)
        name = ctypes.create_string_buffer(256)
        call("cuDeviceGetName", name, 256, handle)
        self.name = name.value.decode()
        value = c_int()
        for attribute, number in _ATTRIBUTES.items():
            call("cuDeviceGetAttribute", byref(value), number, handle)
            setattr(self, attribute, value.value)
        self.capability = 10 * int(self.major) + int(self.minor)  # type: ignore[attr-defined]
        self.context = c_void_p()
        call("cuDevicePrimaryCtxRetain", byref(self.context), handle)

    def __repr__(self) -> str:
        return f"<cuda:{self.ordinal} {self.name}>"

    @contextlib.contextmanager
    def current(self) -> Iterator[None]:
        """A context manager that makes this device current for the thread."""
        before = c_void_p()
        call("cuCtxGetCurrent", byref(before))
        if before.value == self.context.value:
            yield
            return
        call("cuCtxPushCurrent_v2", self.context)
        try:
            yield
        finally:
            call("cuCtxPopCurrent_v2", byref(before))

    # memory

    def allocate(self, size: int, stream: int) -> int:
        """Allocate bytes in stream order; returns the address."""
        address = c_uint64()
        with self.current():
            if self.pools:  # type: ignore[attr-defined]
                call("cuMemAllocAsync", byref(address), c_size_t(max(1, size)), c_void_p(stream))
            else:
                call("cuMemAlloc_v2", byref(address), c_size_t(max(1, size)))
        return address.value

    def free(self, address: int, stream: int) -> None:
        """Free memory in stream order."""
        with self.current():
            if self.pools:  # type: ignore[attr-defined]
                call("cuMemFreeAsync", c_uint64(address), c_void_p(stream))
            else:
                call("cuMemFree_v2", c_uint64(address))

    def to_device(self, target: int, source: int, size: int, stream: int) -> None:
        with self.current():
            call("cuMemcpyHtoDAsync_v2", c_uint64(target), c_void_p(source), c_size_t(size), c_void_p(stream))

    def to_host(self, target: int, source: int, size: int, stream: int) -> None:
        with self.current():
            call("cuMemcpyDtoHAsync_v2", c_void_p(target), c_uint64(source), c_size_t(size), c_void_p(stream))

    # streams

    def wait(self, stream: int) -> None:
        """Wait until all work in the stream is done."""
        with self.current():
            call("cuStreamSynchronize", c_void_p(stream))

    def follow(self, stream: int, other: int) -> None:
        """Let later work in a stream wait for the present work of another; the thread does not wait."""
        if stream == other:
            return
        with self.current():
            event = Event(other)
            call("cuStreamWaitEvent", c_void_p(stream), event.handle, 0)

    def stream(self) -> int:
        """A new non-blocking stream."""
        handle = c_void_p()
        with self.current():
            call("cuStreamCreate", byref(handle), 1)
        return handle.value or 0


class Event:
    """A point in a stream; the context must be current."""

    def __init__(self, stream: int, timing: bool = False) -> None:
        self.handle = c_void_p()
        call("cuEventCreate", byref(self.handle), 0 if timing else _NO_TIMING)
        call("cuEventRecord", self.handle, c_void_p(stream))

    def __del__(self) -> None:
        with contextlib.suppress(Exception):  # at the end of the process the driver may be gone
            library().cuEventDestroy_v2(self.handle)

    def passed(self) -> bool:
        status = library().cuEventQuery(self.handle)
        if status not in (0, _NOT_READY):
            raise DeviceError(f"CUDA: {_reason(library(), status)}")
        return status == 0

    def wait(self) -> None:
        call("cuEventSynchronize", self.handle)

    def since(self, earlier: Event) -> float:
        """Seconds between two points that have passed."""
        milliseconds = ctypes.c_float()
        call("cuEventElapsedTime", byref(milliseconds), earlier.handle, self.handle)
        return milliseconds.value * 1e-3


_devices: dict[int, Device] = {}
_lock = threading.Lock()


def device(which: str | int = "cuda") -> Device:
    """The device of a number or name: "cuda" is the first, "cuda:1" the second.

    Parameters
    ----------
    which : str or int

    Returns
    -------
    Device

    Raises
    ------
    DeviceError
        If there is no such device.

    Examples
    --------
    >>> from dualpin.engine.cuda import device
    >>> device("cuda:0")                          # doctest: +SKIP
    """
    text = str(which)
    kind, _, number = text.partition(":") if not text.isdigit() else ("cuda", ":", text)
    if kind != "cuda" or not (number or "0").isdigit():
        raise DeviceError(f"device {which!r} is not known; 'cuda', or 'cuda:1' for the second, are")
    ordinal = int(number or 0)
    library()
    if ordinal >= count():
        raise DeviceError(f"device {which!r}: there are {count()} devices, the first is 'cuda:0'")
    with _lock:
        if ordinal not in _devices:
            _devices[ordinal] = Device(ordinal)
        return _devices[ordinal]


def assembled(ptx: str, where: Device) -> bytes:
    """Machine code for a device."""
    log = ctypes.create_string_buffer(8192)
    options = (c_int * 2)(_ERROR_LOG, _ERROR_LOG_SIZE)
    values = (c_void_p * 2)(ctypes.addressof(log), len(log))
    state, code, size = c_void_p(), c_void_p(), c_size_t()
    text = ptx.encode() + b"\0"
    with where.current():
        call("cuLinkCreate_v2", 2, options, values, byref(state))
        try:
            call("cuLinkAddData_v2", state, _PTX, text, c_size_t(len(text)), b"dualpin", 0, None, None)
            call("cuLinkComplete", state, byref(code), byref(size))
            return ctypes.string_at(code, size.value)
        except DeviceError as e:
            raise DeviceError(f"{e}: {log.value.decode(errors='replace').strip()}") from None
        finally:
            library().cuLinkDestroy(state)


@cache
def launcher() -> Any:
    """The driver's launch function with its argument types."""
    types = (c_void_p, *[c_uint] * 7, c_void_p, c_void_p, c_void_p)
    return ctypes.CFUNCTYPE(c_int, *types)(("cuLaunchKernel", library()))


class Function:
    """A kernel on a device.

    Attributes
    ----------
    registers, local : int
        Registers, and bytes of local memory, of a thread.
    """

    def __init__(self, code: bytes, where: Device, name: bytes = b"kernel") -> None:
        self.device, self._module, self.handle = where, c_void_p(), c_void_p()
        with where.current():
            call("cuModuleLoadData", byref(self._module), code)
            call("cuModuleGetFunction", byref(self.handle), self._module, name)
        self._launch = launcher()
        self._blocks = threading.local()
        self.registers, self.local = self._attribute("registers"), self._attribute("local")

    def _attribute(self, name: str) -> int:
        value = c_int()
        with self.device.current():
            call("cuFuncGetAttribute", byref(value), _FUNCTION[name], self.handle)
        return value.value

    def allow_shared(self, size: int) -> None:
        """Allow blocks this many bytes of shared memory."""
        with self.device.current():
            call("cuFuncSetAttribute", self.handle, _DYNAMIC_SHARED, size)

    def resident(self, threads: int, shared: int) -> int:
        """The number of such blocks that fit on a multiprocessor."""
        value = c_int()
        with self.device.current():
            call("cuOccupancyMaxActiveBlocksPerMultiprocessor", byref(value), self.handle, threads, c_size_t(shared))
        return value.value

    def launch(self, blocks: int, threads: int, shared: int, stream: int, numbers: Sequence[int]) -> None:
        """Launch the kernel; arguments are 64-bit integers and addresses."""
        values, extra = self._arguments(len(numbers))
        values[:] = numbers
        arguments = (self.handle, blocks, 1, 1, threads, 1, 1, shared, stream, None, extra)
        status = self._launch(*arguments)
        if status in _ELSEWHERE:
            with self.device.current():
                status = self._launch(*arguments)
        if status:
            raise DeviceError(f"CUDA: launch of {blocks} blocks: {_reason(library(), status)}")

    def _arguments(self, count: int) -> tuple[Any, Any]:
        """This thread's buffer of arguments, and the pointers to them for the driver."""
        found = getattr(self._blocks, "found", None)
        if found is None:
            values, size = (ctypes.c_int64 * count)(), c_size_t(8 * count)
            extra = (c_void_p * 5)(1, ctypes.addressof(values), 2, ctypes.addressof(size), 0)
            found = self._blocks.found = (values, extra, size)
        return found[0], found[1]
