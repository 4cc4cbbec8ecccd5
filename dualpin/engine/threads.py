"""Large batches on several threads: each takes a range of samples, so the bits do not depend on how many."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from ..errors import ArgumentError

WORTH = 100e-6
"""Seconds of work a thread must have: handing it over costs some 20 microseconds."""

count = ctypes.c_int64(0)
"""The number in use as last asked for, where machine code can read it; 0 is not known yet."""

_chosen: int | None = None
_pool: tuple[int, ThreadPoolExecutor] | None = None


def available() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def get_num_threads() -> int:
    """How many threads batched calls may use.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.get_num_threads() >= 1
    True
    """
    count.value = _chosen or _from_environment()
    return count.value


def _from_environment() -> int:
    text = os.environ.get("DUALPIN_NUM_THREADS", "").strip()
    if not text:
        return available()
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentError(f"DUALPIN_NUM_THREADS={text!r}: a number of threads, 1 or more, expected")
    return int(text)


def set_num_threads(n: int | None) -> None:
    """Let batched calls use up to n threads; None returns to ``DUALPIN_NUM_THREADS``, or all cores.

    Results have the same bits for any number.

    Raises
    ------
    ArgumentError
        If n is not a positive integer.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.set_num_threads(1)
    >>> dp.get_num_threads()
    1
    >>> dp.set_num_threads(None)
    """
    global _chosen
    if n is not None and (not isinstance(n, (int, np.integer)) or isinstance(n, bool) or n < 1):
        raise ArgumentError(f"set_num_threads: a number of threads, 1 or more, or None expected, got {n!r}")
    _chosen = None if n is None else int(n)
    count.value = _chosen or 0


def spread(work: Callable[[int, int], object], n: int, seconds: float, multiple: int) -> None:
    """work(start, stop) over 0 ... n, in parts of a multiple of samples, on as many threads as are worth it.

    `seconds` is what one sample is expected to take.
    """
    parts = min(int(n * seconds / WORTH), n // multiple)
    parts = min(parts, get_num_threads()) if parts > 1 else 1
    if parts < 2:
        work(0, n)
        return
    step = -(-n // (parts * multiple)) * multiple
    ranges = [(k, min(k + step, n)) for k in range(0, n, step)]
    pool = _workers(parts - 1)
    pending = [pool.submit(work, *r) for r in ranges[1:]]
    try:
        work(*ranges[0])
    finally:
        for future in pending:
            future.result()


def _workers(n: int) -> ThreadPoolExecutor:
    global _pool
    pool = _pool
    if pool is None or pool[0] < n:
        if pool is not None:
            pool[1].shutdown(wait=False)  # those at work finish
        _pool = pool = (n, ThreadPoolExecutor(n, thread_name_prefix="dualpin"))
    return pool[1]


def _forget() -> None:
    global _pool
    _pool = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)  # threads do not survive a fork
