"""Kernels made ahead: while one is used, Python's part of the next is done in a thread, and LLVM's in others.

LLVM takes more than half of the time to make a kernel.  It needs no lock of Python's, but lets one thread of a process
work at a time: so other processes help.  Who needs a kernel that is begun waits for it.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable

from ..engine.jit.compiler import Workbench
from ..engine.jit.host import CompilerError, this_host
from .evaluator import Evaluator


class Ahead:
    """With this, the kernels of these evaluators for many samples are made, in order; at its end no more is begun."""

    def __init__(self, evaluators: Iterable[Evaluator]) -> None:
        self._kernels = [x.kernels for x in evaluators if x.engine in ("auto", "compiled")]
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
