"""Kernels: compiled terms of one robot, from the cache or the compiler, called on arrays."""

from __future__ import annotations

import ctypes
import logging
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any

import numpy as np

from ... import collector
from ...locking import LOCK
from ...memory import empty
from ...model.robot import Robot
from ...terms import Options, Term
from .. import tuning
from ..codegen import module as ir
from ..codegen.number import DOUBLE, SINGLE
from ..graph.schedule import Schedule, schedule
from ..graph.trace import Trace, trace
from . import cache as disk
from .compiler import Compilers, Workbench, loaded, split
from .fingerprint import key as kernel_key
from .host import Host, this_host
from .threads import spread

log = logging.getLogger("dualpin.engine")

_scratch = threading.local()


class Kernel:
    """Machine code of one term of one robot.

    Attributes
    ----------
    sizes : list of int
        Numbers in a row of each input.
    shape : tuple of int
        Shape of one result.
    dtype : dtype
        float64 or float32, of inputs and results.
    operations : int
        Floating-point instructions a tile takes; `lanes` samples make a tile.
    soon : bool
        Bytecode, which is made in a few milliseconds, and takes several times as long to run; the bits are the same.
    """

    def __init__(self, about: dict[str, Any], code: bytes, shape: tuple[int, ...], dtype: np.dtype) -> None:
        self.sizes: list[int] = about["sizes"]
        self.shape, self.dtype = shape, np.dtype(dtype)
        self.width = int(np.prod(shape, dtype=int))
        self.operations: int = about["operations"]
        self.lanes: int = about["lanes"]
        self.scratch: int = about["scratch"]
        self.soon: bool = about.get("soon", False)
        self._code = loaded(split(code, about["objects"]))  # keeps the memory
        self.address: int = self._code["kernel"]
        count = len(self.sizes) + 1
        self._pointers, self._strides = ctypes.c_void_p * count, ctypes.c_int64 * count
        prototype = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_void_p, self._pointers, self._strides)
        self._function = prototype(self.address)
        self.seconds = (  # an estimate, to choose the number of threads
            tuning.CALL_SECONDS
            + tuning.OPERATION_SECONDS * self.operations / self.lanes
            + tuning.NUMBER_SECONDS * (sum(self.sizes) + self.width)
        )

    def rows(self, inputs: Sequence[np.ndarray], out: np.ndarray | None = None) -> np.ndarray:
        """Arrays (n, size) in, an array (n, width) out; rows may be strided or repeated."""
        n = len(inputs[0])
        arrays = [rowwise(x, self.dtype) for x in inputs]
        result = empty((n, self.width), self.dtype) if out is None else out
        if n == 0 or self.width == 0:
            return result
        if out is not None and (
            out.dtype != self.dtype or not out.flags.c_contiguous or any(np.may_share_memory(out, x) for x in arrays)
        ):
            result = np.empty((n, self.width), self.dtype)
        everything = [*arrays, result]
        steps = [x.strides[0] for x in everything]
        strides = self._strides(*(step // self.dtype.itemsize for step in steps))
        bases = [x.ctypes.data for x in everything]

        def work(start: int, stop: int) -> None:
            memory, address = scratch(self.scratch)
            pointers = self._pointers(*(base + start * step for base, step in zip(bases, steps, strict=True)))
            self._function(stop - start, address, pointers, strides)
            del memory

        spread(work, n, self.seconds, self.lanes)
        if out is not None and result is not out:
            out[...] = result
            return out
        return result


def rowwise(x: np.ndarray, dtype: np.dtype) -> np.ndarray:
    """x, or a copy of it whose rows are contiguous numbers of this type."""
    fits = (
        x.dtype == dtype and x.strides[0] % dtype.itemsize == 0 and (x.shape[1] < 2 or x.strides[1] == dtype.itemsize)
    )
    return x if fits else np.ascontiguousarray(x, dtype=dtype)


def scratch(size: int) -> tuple[np.ndarray, int]:
    """This thread's scratch memory of at least `size` bytes, and its aligned address."""
    known = getattr(_scratch, "memory", None)
    if known is None or len(known[0]) < size + 64:
        memory = np.empty(size + 64, np.uint8)
        known = _scratch.memory = (memory, -(-memory.ctypes.data // 64) * 64)
    return known


def build(
    robot: Robot, term: Term, options: Options, dtype: Any = np.float64, single: bool = False, host: Host | None = None,
    begun: Begun | None = None, soon: bool = False,
) -> Kernel:  # fmt: skip
    """The kernel of a term: read from the cache, or traced, compiled and cached.

    `single` makes the kernel for one configuration at a time; its results have the same bits.
    `begun` is what was done of that already.  With `soon`, it is bytecode unless it is short or in the cache.

    Raises
    ------
    UntraceableError
        If the term is not a straight-line program.
    CompilerError
        If this machine has no working compiler.
    """
    machine = this_host() if host is None else host
    shape, kind = term.shape(robot, **options), np.dtype(dtype)
    lanes = 1 if single else machine.lanes(kind.itemsize)
    with LOCK:
        key = kernel_key(robot, term, options, kind, machine, lanes)
        for name in (key, key + _SOON)[: 1 + soon] if key and begun is None else ():
            found = disk.load(name)
            if found is not None:
                try:
                    return Kernel(*found, shape, kind)
                except Exception as e:  # whatever is wrong with it, it can be made again
                    log.warning("kernel of %s from the cache cannot be used (%s); compiling again", term.name, e)
        about, code = compiled(robot, term, options, kind, machine, lanes, soon) if begun is None else begun.result()
        kernel = Kernel(about, code, shape, kind)
        if key:
            disk.store(key + _SOON if kernel.soon else key, about, code)
        return kernel


_SOON = "|soon"  # in the name of what waits for the real one


@dataclass
class Begun:
    """A batch kernel that is traced and scheduled, and is being compiled by another thread."""

    about: dict[str, Any]
    objects: Future[list[bytes]]

    def result(self) -> tuple[dict[str, Any], bytes]:
        objects = self.objects.result()
        return self.about | {"objects": [len(x) for x in objects]}, b"".join(objects)


def kept(robot: Robot, term: Term, options: Options, dtype: np.dtype) -> bool:
    """Whether the batch kernel is in the cache."""
    host = this_host()
    key = kernel_key(robot, term, options, dtype, host, host.lanes(dtype.itemsize))
    return bool(key and disk.stored(key))


def begin(robot: Robot, term: Term, options: Options, dtype: np.dtype, bench: Workbench) -> Begun | None:
    """Trace a batch kernel and submit it for compilation; None if it is in the cache."""
    host = this_host()
    lanes = host.lanes(dtype.itemsize)
    if kept(robot, term, options, dtype):
        return None
    program = trace(robot, term, options)
    plan, about, texts = _written(program, dtype, host, lanes, lambda: 1)
    return Begun(about, bench.submit(texts, host, plan.operations > tuning.QUICK_FROM))


def compiled(
    robot: Robot, term: Term, options: Options, dtype: np.dtype, host: Host, lanes: int, soon: bool = False
) -> tuple[dict[str, Any], bytes]:
    """Trace and compile: the data for calling the kernel, and its object code."""
    start = time.perf_counter()
    with LOCK, collector.paused():
        program = trace(robot, term, options)
    with Compilers(host, 0 if soon else len(program.graph.nodes)) as compilers:
        with LOCK, collector.paused():
            plan, about, texts = _written(program, dtype, host, lanes, lambda: compilers.count, soon)
        about["soon"] = soon and tuning.SOON_FROM < plan.operations <= tuning.BYTECODE_FROM
        objects = compilers.object_codes(texts, about["soon"] or plan.operations > tuning.QUICK_FROM)
    about["objects"] = [len(x) for x in objects]
    seconds = time.perf_counter() - start
    if seconds > 0.5:
        log.info("compiled %s of %s: %d operations, %.2f s", term.name, robot.name, plan.operations, seconds)
    return about, b"".join(objects)


def _written(
    program: Trace, dtype: np.dtype, host: Host, lanes: int, parts: Callable[[], int], soon: bool = False
) -> tuple[Schedule, dict[str, Any], list[str]]:
    """The schedule, the data for calling the kernel, and its text in several parts."""
    number = DOUBLE if dtype.itemsize == 8 else SINGLE
    together = max(1, min(host.width, tuning.TOGETHER) // number.size) if lanes == 1 else 1
    least = min(tuning.SOON_FROM, tuning.BYTECODE_FROM) if soon else None
    plan = schedule(program, together=together, direct=lanes == 1, bytecode_from=least)
    about = {
        "sizes": plan.sizes, "operations": plan.operations, "lanes": lanes,
        "scratch": ir.scratch_bytes(plan, number, host, lanes),
    }  # fmt: skip
    return plan, about, ir.modules(plan, number, host, lanes, parts=1 if plan.bytecode else parts())
