"""One lock for all objects that own native memory, and its behaviour in a fork.

A forked child has one thread, the one that forked.  If another was inside LLVM at that moment, LLVM's memory is
inconsistent in the child, and the locks of that thread are never released.  So a fork waits until no thread compiles or
imports modules of this package.  If that takes longer than `FORK_WAIT`, the fork proceeds, and the child must not use
LLVM: its kernels still run, and NumPy computes the rest.
"""

from __future__ import annotations

import functools
import importlib
import logging  # noqa: F401  its lock is taken at a fork too: after ours, if it comes before us
import os
import sys
import threading
import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")

FORK_WAIT = 20.0
"""Seconds a fork waits for other threads: all but the longest terms of the largest robots take less to compile."""


class Lock:
    """A reentrant lock that a fork can wait for and a child can replace."""

    def __init__(self) -> None:
        self.inner, self.depth = threading.RLock(), 0
        self.wanted = False  # by a fork

    def __enter__(self) -> None:
        self.inner.acquire()
        self.depth += 1

    def __exit__(self, *_: object) -> None:
        self.depth -= 1
        last = not self.depth
        self.inner.release()
        while last and self.wanted:  # otherwise this thread might take it again before the forking thread wakes up
            time.sleep(1e-3)


LOCK = Lock()
"""Held while compiling, linking, loading or creating objects that all threads share."""

lost = ""
"""Why this process must not use LLVM: it was forked while another thread was inside LLVM."""


def imported(module: str) -> Any:
    """A module of this package that is imported when first used; by one thread at a time.

    Python takes the lock of a submodule before that of its package.  Where one thread imports a package and another one
    of its submodules, each may wait for the other, and one of them gets an ImportError.
    """
    found = sys.modules.get(module)
    if found is None or getattr(found.__spec__, "_initializing", False):
        with LOCK:
            if package := module.rpartition(".")[0]:
                imported(package)
            found = importlib.import_module(module)
    return found


class Once(Generic[T]):
    """A function without arguments that runs once in a process, in one thread; others wait for its result.

    With `functools.cache` two threads could run it, and native memory that one of them uses could be freed.
    """

    def __init__(self, make: Callable[[], T]) -> None:
        functools.update_wrapper(self, make)
        self.make = make
        self.made: list[T] = []

    def __call__(self) -> T:
        if not self.made:
            with LOCK:
                if not self.made:
                    self.made.append(self.make())
        return self.made[0]


# --- forks ----------------------------------------------------------------------------------------

_IMPORTED = (
    "dualpin", "llvmlite", "lxml", "mpmath", "numpy", "pinocchio", "platformdirs", "scipy", "sympy", "yourdfpy",
)  # fmt: skip


class _Forking(threading.local):
    """The locks that the forking thread holds."""

    def __init__(self) -> None:
        self.held: list[Any] = []
        self.missed: list[Any] = []


_mine = _Forking()
_abandon: list[Callable[[], object]] = []


def when_lost(action: Callable[[], object]) -> None:
    """Called in a child that must not use LLVM."""
    _abandon.append(action)


def _before_fork() -> None:
    LOCK.wanted, end = True, time.monotonic() + FORK_WAIT
    _mine.held.clear()
    _mine.missed.clear()
    while _others_import() and time.monotonic() < end:
        time.sleep(1e-3)
    for find in (lambda: LOCK.inner, _llvm_lock):  # the second lock after the first, which prevents loading LLVM
        lock = find()
        if lock is not None:
            got = lock.acquire(timeout=max(0.0, end - time.monotonic()))
            (_mine.held if got else _mine.missed).append(lock)
    LOCK.wanted = False


def _release() -> None:
    while _mine.held:
        _mine.held.pop().release()


def _after_fork_in_child() -> None:
    global lost
    if _mine.missed:
        lost = "another thread was compiling when this process was forked"
        for action in _abandon:
            action()
    if LOCK.inner in _mine.missed:
        LOCK.inner, LOCK.depth = threading.RLock(), 0
    _release()
    if sys.version_info < (3, 12):
        _renew_locks_of_properties()


def _renew_locks_of_properties() -> None:
    """Until 3.11 a `cached_property` is computed under a lock of its own; another thread may have held it."""
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] == "dualpin":
            for kind in [x for x in vars(module).values() if isinstance(x, type)]:
                for x in vars(kind).values():
                    if isinstance(x, functools.cached_property):
                        x.lock = threading.RLock()  # type: ignore[attr-defined]


def _others_import() -> bool:
    """Whether another thread is importing modules of this package, whose import locks would stay locked in a child."""
    locks = getattr(importlib._bootstrap, "_module_locks", {})
    needed = [lock() for name, lock in list(locks.items()) if name.partition(".")[0] in _IMPORTED]
    return any(getattr(lock, "owner", None) not in (None, threading.get_ident()) for lock in needed)


def _llvm_lock() -> Any:
    """The lock that llvmlite takes around each call of LLVM, also for others that use it; None if it is not there."""
    ffi = sys.modules.get("llvmlite.binding.ffi")
    return getattr(getattr(getattr(ffi, "lib", None), "_lock", None), "_lock", None)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before_fork, after_in_parent=_release, after_in_child=_after_fork_in_child)
