"""A GPU kernel compiled for the host, with its warps as loops, for tests without a GPU.

It is slow, and equal to the GPU's result bit for bit: the same functions, in the same order of operations.
"""

from __future__ import annotations

import ctypes

import numpy as np

from ..jit.compiler import loaded, object_code
from ..jit.host import this_host
from . import warp
from .build import Plan


class Emulated:
    """A term of a robot, compiled as for a GPU but for this machine.

    Parameters
    ----------
    plan : Plan
        The plan of a GPU kernel.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        host = this_host()
        text = warp.emulated(plan.program, plan.number, plan.layout, host)
        self._code = loaded([object_code(text, host)])
        self._function = ctypes.CFUNCTYPE(None, ctypes.c_int64, *[ctypes.c_void_p] * 4)(self._code["kernel"])

    def __call__(self, *arrays: np.ndarray) -> np.ndarray:
        """Arrays (n, size) of the kernel's type, in any strides; returns (n, width)."""
        n, T = max(len(x) for x in arrays), self.plan.dtype
        out = np.full((n, self.plan.program.width), np.nan, T)
        everything = [*arrays, out]
        if any(x.dtype != T or len(x) not in (1, n) for x in arrays):
            raise ValueError("arrays of the kernel's type and of one length expected")
        tile = np.full(max(1, self.plan.layout.room), np.nan, T)
        pointers = (ctypes.c_void_p * len(everything))(*(x.ctypes.data for x in everything))
        rows = (ctypes.c_int64 * len(everything))(
            *(0 if len(x) == 1 else x.strides[0] // x.itemsize for x in everything)
        )
        columns = (ctypes.c_int64 * len(everything))(*(x.strides[1] // x.itemsize for x in everything))
        addresses = (ctypes.addressof(x) for x in (pointers, rows, columns))
        self._function(n, tile.ctypes.data, *addresses)
        return out
