"""Large batches on several threads: each takes a range of samples, so the bits do not depend on how many."""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import os
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from ... import arguments
from ...errors import ArgumentError
from .. import tuning

count = ctypes.c_int64(0)
"""Read by machine code: one thread (1), several (2), or not yet known (0)."""

_chosen: int | None = None
_pool: tuple[int, ThreadPoolExecutor] | None = None
_pool_lock = threading.Lock()  # the pool must not be replaced between finding it and the last `submit`
_here = threading.local()  # `busy` in a worker thread, which must not wait for the pool: that would be a deadlock


def available() -> int:
    """Cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def get_num_threads() -> int:
    """How many threads batched calls may use.

    Returns
    -------
    int

    Raises
    ------
    ArgumentError
        If ``DUALPIN_NUM_THREADS`` is not a number.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.get_num_threads() >= 1
    True
    """
    n = _chosen or _from_environment()
    if _chosen is None:
        count.value = min(n, 2)
    return n


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

    Parameters
    ----------
    n : int or None
        1 or more; None for the default.

    Returns
    -------
    None

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
    _chosen = None if n is None else arguments.count("set_num_threads: n", n, 1)
    count.value = min(_chosen or 0, 2)


def spread(work: Callable[[int, int], object], n: int, seconds: float, multiple: int) -> None:
    """work(start, stop) over 0 ... n, in parts of a multiple of samples, on as many threads as are worth it.

    `seconds` is the expected time of one sample.  Each thread takes the next part when it has finished
    one, so that a slow one does not delay the others.
    """
    step = max(1, int(tuning.PART / seconds) // multiple) * multiple
    parts = -(-n // step)
    busy = getattr(_here, "busy", False)
    if busy or n * seconds < tuning.PARALLEL_FROM or parts < 2 or get_num_threads() < 2:
        work(0, n)
        return
    numbers, end = itertools.count(), [parts]

    def some() -> None:
        _here.busy = True
        try:
            while (k := next(numbers)) < end[0]:
                work(k * step, min((k + 1) * step, n))
        except BaseException:  # an error, or Ctrl-C: all threads stop
            end[0] = 0
            raise
        finally:
            _here.busy = False

    others = _submitted(some, min(get_num_threads(), parts) - 1)
    try:
        some()
    finally:
        for future in others:
            future.cancel()  # a task that has not begun has nothing left to do
        for future in others:
            if not future.cancelled():
                future.result()


def _submitted(task: Callable[[], None], n: int) -> list[Future]:
    """The task, n times on other threads; fewer where the interpreter is ending and starts no more."""
    global _pool
    futures: list[Future] = []
    with _pool_lock, contextlib.suppress(RuntimeError):
        if _pool is None or _pool[0] < n:
            if _pool is not None:
                _pool[1].shutdown(wait=False)  # running tasks finish
            _pool = (n, ThreadPoolExecutor(n, thread_name_prefix="dualpin"))
        for _ in range(n):
            futures.append(_pool[1].submit(task))
    return futures


def _forget() -> None:
    global _pool, _pool_lock
    _pool, _pool_lock = None, threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)  # threads do not survive a fork
