"""Compilation ahead of use: while one kernel is used, a thread traces the next, and LLVM compiles in other processes.

LLVM takes more than half of the time to make a kernel.  It does not hold the GIL, but runs in one thread of a process
at a time; so other processes compile too.  A call that needs an unfinished kernel waits for it.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable

from ..engine.jit.compiler import Workbench
from ..engine.jit.host import CompilerError, this_host
from .evaluator import Evaluator


class Ahead:
    """A context manager that compiles the batch kernels of these evaluators, in order, until it exits."""

    def __init__(self, evaluators: Iterable[Evaluator]) -> None:
        self._kernels = [x.kernels for x in evaluators if x.engine in ("auto", "compiled")]
        for kernels in self._kernels:
            kernels.ahead = True
        self._ended, self._bench = False, Workbench()
        self._thread = threading.Thread(target=self._begin, name="dualpin-ahead", daemon=True)

    def _begin(self) -> None:
        for kernels in self._kernels:
            if self._ended:
                return
            kernels.begin(self._bench)

    def __enter__(self) -> Ahead:
        try:
            this_host()
        except CompilerError:  # NumPy computes
            self._kernels.clear()
        if len(self._kernels) > 1:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended = True
        if self._thread.ident:
            self._thread.join()
        self._bench.close()


__all__ = ["Ahead"]
