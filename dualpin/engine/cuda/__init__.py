"""Terms on Nvidia's GPUs: the graph that becomes vector code for the host becomes a kernel, one thread a sample.

program    the graph as one thread's lines of operations
thread     those lines as LLVM IR             warp      32 threads and their shared memory
ptx        IR to PTX, by LLVM                 driver    PTX to machine code, memory, streams, launches
arrays     arrays of PyTorch, CuPy, JAX       kernel    a term as a function of such arrays
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...errors import ArgumentError, nearest
from ...model.memory import memory
from ...model.robot import Robot
from ...terms import TERMS
from .arrays import DeviceArray, to_device
from .build import plan
from .driver import Device, device
from .kernel import DeviceKernel


def kernel(
    robot: Robot, name: str, dtype: Any = np.float64, device_: str | int | Device = "cuda", **options: Any
) -> DeviceKernel:
    """A term of a robot as a function of arrays on a device; made once for each robot, type and options.

    Raises
    ------
    ArgumentError
        If the term or the type is not known.
    DeviceError
        If there is no such device.
    """
    if name not in TERMS:
        raise ArgumentError(f"kernel {name!r} is not known; {nearest(name, TERMS, 'terms')}")
    kind = np.dtype(dtype)
    if kind not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise ArgumentError(f"kernel {name}: dtype float64 or float32 expected, got {kind}")
    where = device_ if isinstance(device_, Device) else device(device_)
    kernels = memory(robot).setdefault("device kernels", {})
    key = (name, kind.char, where.ordinal, *sorted(options.items()))
    if key not in kernels:
        kernels[key] = DeviceKernel(robot, TERMS[name], options, kind, where)
    return kernels[key]


__all__ = ["DeviceArray", "DeviceKernel", "device", "kernel", "plan", "to_device"]
