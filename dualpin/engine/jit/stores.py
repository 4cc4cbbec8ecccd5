"""The size from which results use non-temporal stores: measured once on each machine, and kept with the kernels.

Ordinary stores leave lines in the caches, where they can be read soon.  Non-temporal stores wait for memory, but fetch
no lines and evict none.  Which is faster for which size differs even between processors of one vendor, so it is
measured: rows like those of a kernel, of 1 to 32 MB, with both stores alternately.  The bits are the same.

It takes a tenth of a second, at the first result of `memory.FROM` bytes.
"""

from __future__ import annotations

import contextlib
import json
import time
from typing import Any

import numpy as np

from ... import memory
from ...files import write_text
from ...locking import LOCK
from .. import tuning
from ..codegen import module as ir
from ..codegen.number import DOUBLE
from ..graph.schedule import schedule
from ..graph.trace import Graph, Trace
from . import cache as disk
from .compiler import object_code
from .compiler import stores as known
from .host import this_host
from .kernel import Kernel

SIZES = tuple(1 << k for k in range(20, 26))
REPETITIONS, GAIN = 5, 0.98
_COLUMNS = 81  # an inertia matrix of nine joints: unaligned rows
_NEVER = 1 << 62


def settle() -> None:
    """Set the threshold if it is not set: from the file, or by measuring."""
    if known[1]:
        return
    with LOCK:
        if known[1]:
            return
        host = this_host()
        found = _read(host.key)
        if found is None:
            found = _measured() if host.width == 64 else known[0]  # other widths do not store whole lines
            _write(host.key, found)
        known[0], known[1] = found, 1


def _place() -> Any:
    return disk.folder().parent / "stores.json"


def _read(key: str) -> int | None:
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
        about = json.loads(_place().read_text(encoding="utf-8"))
        found = about["past the caches from"]
        if about["machine"] == key and type(found) is int and SIZES[0] <= found <= _NEVER:
            return found
    return None


def _write(key: str, found: int) -> None:
    with contextlib.suppress(OSError):  # the next process will measure again
        _place().parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        write_text(_place(), json.dumps({"machine": key, "past the caches from": found}, indent=1) + "\n")


def _measured() -> int:
    """The least size from which non-temporal stores are faster for all larger sizes."""
    kernel, width = _rows_like_a_kernels(), 8 * _COLUMNS
    x, out = np.ones((SIZES[-1] // width, 9)), memory.empty((SIZES[-1] // width, _COLUMNS), np.dtype(float))
    out.fill(0.0)  # page faults before the measurement
    best, before = _NEVER, known[0]
    try:
        for size in reversed(SIZES):
            n = size // width
            times: dict[int, list[float]] = {0: [], _NEVER: []}
            for _ in range(REPETITIONS):
                for known[0] in times:
                    start = time.perf_counter()
                    kernel.rows([x[:n]], out[:n])
                    times[known[0]].append(time.perf_counter() - start)
            if min(times[0]) > GAIN * min(times[_NEVER]):
                break
            best = size
    finally:
        known[0] = before
    return best


def _rows_like_a_kernels() -> Kernel:
    """A kernel with little arithmetic and rows of results, from the same code generator."""
    graph, host = Graph(), this_host()
    x = graph.inputs(0, 9)
    plan = schedule(Trace(graph, [9], [a * b + c for a, b in zip(x, reversed(x), strict=True) for c in x]))
    lanes = host.lanes(8)
    (text,) = ir.modules(plan, DOUBLE, host, lanes)
    code = object_code(text, host)
    about = {"sizes": plan.sizes, "operations": plan.operations, "lanes": lanes, "objects": [len(code)],
             "scratch": ir.scratch_bytes(plan, DOUBLE, host, lanes)}  # fmt: skip
    kernel = Kernel(about, code, (_COLUMNS,), np.dtype(float))
    kernel.seconds = tuning.PARALLEL_FROM / (1 << 40)  # one thread only
    return kernel


__all__ = ["settle"]
