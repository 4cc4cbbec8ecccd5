"""A pool of memory for large results, which is reused when their arrays are deleted.

The C library returns large blocks to the system when they are freed. The next result of that size is mapped again,
with a fault for each page, which takes up to six times as long as the kernel that fills it. So results from `FROM`
bytes on are placed in blocks of a pool. A block becomes idle when the last array or view on it is deleted; it is then
used for the next result, or returned to the system if more than the limit would be idle. Blocks are aligned to pages,
and use huge pages where the system has them.

    limit()    bytes that may lie idle: ``DUALPIN_MEMORY_LIMIT``, or the lesser of 2 GiB and an eighth of the memory
    limit(0)   no pool: NumPy allocates all results
    clear()    return idle blocks to the system
    stats()    sizes and counters of the pool

Arrays of the pool are ordinary NumPy arrays, except that they do not own their memory, so that
``x.resize(...)`` in place is refused (`numpy.resize` makes a copy).

The pool uses single, atomic operations on lists and dicts and no lock, since an array can be deleted at any moment.  A
forked child does not reuse blocks of its parent and has a pool of its own.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import math
import mmap
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .arguments import count
from .errors import ArgumentError

FROM = 2 << 20
"""Bytes of a result from which it is allocated in the pool.

Emerald Rapids: Python code around a call takes 2 to 3 us, filling 2 MB at least 50; malloc reuses freed memory for
smaller results, without a page fault.
"""
HUGE = 2 << 20
"""Bytes of a huge page, to which blocks are aligned: one fault in place of 512, and few entries of the TLB."""
MOST_IDLE = 64
"""The most idle blocks; an allocation searches all of them."""

# private, or forked children would share it
_FLAGS: dict[str, int] = {"flags": mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS} if hasattr(mmap, "MAP_PRIVATE") else {}


class Block:
    """Mapped memory, and the buffer type of its size, whose finalizer returns it to the pool."""

    def __init__(self, size: int) -> None:
        self.size, self.process = size, _process
        self.map = mmap.mmap(-1, size + HUGE, **_FLAGS)
        with contextlib.suppress(AttributeError, OSError, ValueError):  # not on this system
            self.map.madvise(mmap.MADV_HUGEPAGE)
        start = ctypes.addressof(ctypes.c_char.from_buffer(self.map))
        self.address = -(-start // HUGE) * HUGE
        self.lease = _lease(size)


@functools.cache
def _lease(size: int) -> Any:
    """The buffer type of blocks of this size: one for all, since Python frees a type only when it collects garbage."""
    return type("Lease", (ctypes.c_char * size,), {"__del__": _returned, "__slots__": ("block",)})


_idle: list[Block] = []  # the last to become idle is the last
_lent: dict[int, int] = {}  # address -> bytes
_process = 0  # how many forks ago the first process was
_done = {"served": 0, "mapped": 0}
_limit: int | None = None


def empty(shape: tuple[int, ...], dtype: np.dtype) -> np.ndarray:
    """A C-contiguous array whose content is arbitrary, from the pool if it is large and there is one."""
    need = math.prod(shape) * dtype.itemsize
    if need < FROM or need > limit():
        return np.empty(shape, dtype)
    size = _size(need)
    block = next(_taken(size), None)
    if block is None:
        try:
            block = Block(size)
        except (OSError, ValueError, OverflowError):
            return np.empty(shape, dtype)  # raises the error
        _done["mapped"] += 1
    else:
        _done["served"] += 1
    lease = block.lease.from_address(block.address)
    lease.block = block
    _lent[block.address] = size
    return np.ndarray(shape, dtype, lease)


def _size(need: int) -> int:
    """The next of eight sizes between two powers of two, in whole huge pages, so that similar results share blocks."""
    step = max(HUGE, 1 << max(0, need.bit_length() - 4))
    return -(-need // step) * step


def _taken(size: int) -> Iterator[Block]:
    """Take idle blocks of this size, the most recently used first."""
    for block in reversed(_idle.copy()):
        if block.size == size:
            with contextlib.suppress(ValueError):  # another thread was first
                _idle.remove(block)
                yield block


def _returned(lease: Any) -> None:
    """Called when the last array on a block is deleted."""
    block = lease.block
    if block.process == _process:
        _lent.pop(block.address, None)
        _idle.append(block)
        _shrink(limit())


def _shrink(most: int) -> int:
    """Return the longest idle blocks to the system, until at most this many bytes are idle."""
    freed = 0
    while (blocks := _idle.copy()) and (sum(x.size for x in blocks) > most or len(blocks) > MOST_IDLE):
        with contextlib.suppress(ValueError):
            _idle.remove(blocks[0])
            freed += blocks[0].size
    return freed


def limit(size: int | None = None) -> int:
    """The number of bytes that may be idle; with an argument, set it.  0 disables the pool.

    Parameters
    ----------
    size : int, optional
        Bytes.

    Returns
    -------
    int

    Raises
    ------
    ArgumentError
        If it is not a number of bytes.

    Examples
    --------
    >>> import dualpin as dp
    >>> before = dp.memory.limit()
    >>> dp.memory.limit(1 << 28)
    268435456
    >>> dp.memory.limit(before) == before
    True
    """
    global _limit
    if size is not None:
        _limit = count("memory.limit: bytes", size)
        _shrink(_limit)
    if _limit is None:
        _limit = _usual_limit()
    return _limit


def _usual_limit() -> int:
    text = os.environ.get("DUALPIN_MEMORY_LIMIT", "").strip()
    if text:
        if not text.isdecimal():
            raise ArgumentError(f"DUALPIN_MEMORY_LIMIT={text!r}: a number of bytes, 0 or more, expected")
        return int(text)
    return min(2 << 30, _machine() // 8)


def _machine() -> int:
    """Bytes of memory this process may use, as reported by the system."""
    found = [16 << 30]
    with contextlib.suppress(AttributeError, OSError, ValueError):
        found[0] = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    for place in "/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes":
        with contextlib.suppress(OSError, ValueError):  # "max" is no number
            found.append(int(Path(place).read_text()))
    return min(found)


def clear() -> int:
    """Return idle blocks to the system; returns the number of bytes.  Arrays in use are not affected.

    Returns
    -------
    int

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.memory.clear() >= 0
    True
    >>> dp.memory.stats()["idle_bytes"]
    0
    """
    return _shrink(-1)


def stats() -> dict[str, int]:
    """Sizes and counters of the pool.

    Returns
    -------
    dict
        "limit", "idle_bytes", "idle_blocks", "lent_bytes", "lent_blocks"; "mapped" and "served": the numbers of
        results with a new block and with a reused one.

    Examples
    --------
    >>> import dualpin as dp
    >>> sorted(dp.memory.stats())
    ['idle_blocks', 'idle_bytes', 'lent_blocks', 'lent_bytes', 'limit', 'mapped', 'served']
    """
    idle, lent = [x.size for x in _idle.copy()], list(_lent.values())
    return {
        "limit": limit(), "idle_bytes": sum(idle), "idle_blocks": len(idle),
        "lent_bytes": sum(lent), "lent_blocks": len(lent), **_done,
    }  # fmt: skip


def _forked() -> None:
    global _process
    _process += 1
    _idle.clear()
    _lent.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)

__all__ = ["clear", "limit", "stats"]
