"""Kernels for Nvidia's GPUs: the graph that becomes vector code for the host, one thread a sample.

program    the graph as one thread's operations               order      the order of operations
thread     those lines as LLVM IR      warp      32 threads and their shared memory
ptx        IR to PTX, by LLVM          build     a term of a robot, from the cache or the compiler
driver     PTX to machine code, memory, streams, launches
arrays     arrays of PyTorch, CuPy, JAX and others, by dlpack and by their own names
"""

from __future__ import annotations

from .arrays import DeviceArray, to_device
from .build import plan
from .driver import Device, device

__all__ = ["Device", "DeviceArray", "device", "plan", "to_device"]
