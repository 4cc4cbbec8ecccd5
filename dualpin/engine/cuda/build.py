"""A term of a robot as a GPU kernel: traced, laid out, written as PTX, assembled, and cached on disk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...locking import LOCK
from ...model.robot import Robot
from ...terms import Options, Term
from ..codegen.host import Host
from ..codegen.number import DOUBLE, SINGLE, Number
from ..graph.trace import trace
from ..jit import cache as disk
from ..jit.fingerprint import key as kernel_key
from ..tuning import GPU_RESIDENT, GPU_STAGED, GPU_THREADS
from . import driver, ptx, warp
from . import layout as layouts
from .layout import WARP, Layout
from .program import PART, Program, program
from .scalar import DEVICE

NUMBERS = {8: 115, 4: 230}
"""How many numbers of this size fit into a thread's registers, beside addresses and counters."""


@dataclass(frozen=True)
class Plan:
    """The program and layout from which a kernel is made."""

    program: Program
    number: Number
    layout: Layout

    @property
    def dtype(self) -> np.dtype:
        return np.dtype(np.float64 if self.number.size == 8 else np.float32)

    def ptx(self, threads: int = GPU_THREADS, resident: int = GPU_RESIDENT) -> str:
        """The kernel as PTX."""
        return ptx.bounded(ptx.assembly(warp.device(self.program, self.number, self.layout)), threads, resident)

    def about(self) -> dict[str, Any]:
        """The data that a caller needs."""
        made = self.program
        return {
            "sizes": list(self.layout.sizes), "operations": made.operations, "parts": len(made.parts),
            "warp_bytes": self.layout.room * self.number.size, "threads": GPU_THREADS, "strided": self.layout.strided,
        }  # fmt: skip


def plan(
    robot: Robot,
    term: Term,
    options: Options,
    dtype: Any = np.float64,
    *,
    strided: bool = False,
    part: int = PART,
) -> Plan:
    """The program of a term and the layout of its arrays.

    Parameters
    ----------
    robot : Robot
    term : Term
    options : mapping
        Settled (`Term.settled`).
    dtype : float64 or float32
    strided : bool
        For arrays with any strides, such as structures of arrays.
    part : int
        Number of operations of one function.

    Returns
    -------
    Plan

    Raises
    ------
    UntraceableError
        If the term is not a straight-line program.
    TooLongError
        If it is too long for a GPU.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.engine.cuda import plan
    >>> plan(dp.load("ur5"), dp.terms.TERMS["gravity"], {}).layout.sizes
    (6, 6)
    """
    number = DOUBLE if np.dtype(dtype).itemsize == 8 else SINGLE
    made = program(trace(robot, term, options), NUMBERS[number.size], part)
    sizes = (*made.sizes, made.width)
    layout = layouts.strided(sizes) if strided else layouts.staged(sizes, GPU_STAGED // number.size)
    return Plan(made, number, layout)


def built(
    robot: Robot, term: Term, options: Options, dtype: Any, where: driver.Device, *, strided: bool
) -> tuple[dict[str, Any], driver.Function]:
    """The kernel on a device: read from the cache, or made and cached.

    Raises
    ------
    UntraceableError, TooLongError
        If the term cannot be compiled for a GPU.
    CompilerError, DeviceError
        If it cannot be compiled or loaded.
    """
    machine = Host(DEVICE.triple, f"sm_{where.capability}", f"{DEVICE.cpu},driver {driver.version()}", 8, True)
    with LOCK:
        key = kernel_key(robot, term, options, np.dtype(dtype), machine, WARP)
        if key and strided:
            key += "|strided"
        found = disk.load(key) if key else None
        if found is not None:
            try:
                return found[0], driver.Function(found[1], where)
            except Exception:  # a damaged file: compile again
                pass
        made = plan(robot, term, options, dtype, strided=strided)
        code = driver.assembled(made.ptx(), where)
        function = driver.Function(code, where)
        if key:
            disk.store(key, made.about(), code)
        return made.about(), function
