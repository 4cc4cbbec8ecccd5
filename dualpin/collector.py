"""Python's collector of cyclic garbage, kept from walking through many live objects again and again."""

from __future__ import annotations

import gc
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_LOCK = threading.Lock()
_inside = 0
"""Blocks that are entered, of all threads."""
_enabled = False
"""Whether it collected when the first of them was."""


@contextmanager
def paused() -> Iterator[None]:
    """Without it, for what makes many objects and no cycles; the last thread to leave turns it on again."""
    global _inside, _enabled
    with _LOCK:
        if not _inside:
            _enabled = gc.isenabled()
            gc.disable()
        _inside += 1
    try:
        yield
    finally:
        with _LOCK:
            _inside = max(_inside - 1, 0)
            if _enabled and not _inside:
                gc.enable()


def _forked() -> None:
    """The other threads, which would have turned it on again, are not in a forked process."""
    global _LOCK, _inside
    _LOCK = threading.Lock()
    if _inside and _enabled:
        gc.enable()
    _inside = 0


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)
