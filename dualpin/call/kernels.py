"""The kernels of a term of a robot, compiled at first use and kept."""

from __future__ import annotations

import contextlib
import functools
import os
import threading
import warnings
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

from ..errors import DualpinError, DualpinWarning
from ..locking import LOCK
from ..model.robot import Robot
from ..terms import Options, Term

if TYPE_CHECKING:
    from ..engine.jit.compiler import Workbench
    from ..engine.jit.fast_call import Code
    from ..engine.jit.kernel import Begun, Kernel


class Kernels:
    """Two kernels: one for a single sample, one for many.

    Threads that request the same kernel concurrently get the same one.
    """

    def __init__(self, robot: Robot, term: Term, options: Options, dtype: np.dtype) -> None:
        self.robot, self.term, self.options, self.dtype = robot, term, options, dtype
        self.shape = term.shape(robot, **options)
        self._found: list[Kernel | DualpinError | None] = [None, None]
        self._soon: Kernel | None = None  # until that for one sample is there
        self._code: Code | None = None
        self._claim, self._claimed_by = threading.Lock(), 0  # held by the thread that makes the batch kernel
        self._begun: Future[Begun | None] = Future()
        self.ahead = False  # whether the batch kernel is among those that are compiled ahead
        self._asked = [0, 0]  # ids of processes that compile in the background

    def kernel(self, *, single: bool, required: bool = False) -> Kernel | None:
        """The kernel; None if there is none, or, with `required`, an error with the reason."""
        found = self._found[single]
        if found is None:
            found = self._built(single)
        if not isinstance(found, DualpinError):
            return found
        if required:
            raise found
        from ..engine.jit.host import CompilerError

        if isinstance(found, CompilerError):
            _announce(str(found))
        return None

    def known(self, *, single: bool) -> Kernel | None:
        """The kernel, if it has been compiled."""
        found = self._found[single]
        return None if isinstance(found, DualpinError) else found

    def code(self, made: Code) -> Code:
        """The record that the fast call reads, `made` if there is none yet; each new kernel is entered there."""
        with LOCK:
            if self._code is None:
                self._code = made
                self._tell(single=False)
                self._tell(single=True)
            return self._code

    @property
    def any(self) -> bool:
        """Whether one of them is compiled."""
        return any(self.known(single=single) is not None for single in (False, True))

    def meanwhile(self, *, single: bool) -> Kernel | None:
        """The kernel if it is compiled; otherwise None, and a thread begins to compile it."""
        if self._found[single] is None and self._asked[single] != os.getpid():
            self._asked[single] = os.getpid()  # threads do not survive a fork
            later(lambda: self.kernel(single=single))
        return self.known(single=single)

    def soonest(self, *, single: bool) -> Kernel | None:
        """The kernel for one sample, or for a batch; the first time, unless it is short, bytecode of the same bits.

        That is made for one sample, and serves batches too.  When asked again, a thread begins to compile the kernel,
        which then takes its place.  A batch kernel that is compiled ahead is waited for.
        """
        found, first = self._found[single], self._first
        if first is not None and isinstance(found, DualpinError):
            return first  # it serves on where no other can be made
        if found is not None or (self.ahead and not single):
            return self.kernel(single=single)
        if first is not None:
            return self.meanwhile(single=single) or first
        if not single and self._kept():
            return self.kernel(single=False)
        with LOCK:
            if self._soon is None and self._found[True] is None:
                made = self._made(True, None, soon=True)
                if isinstance(made, DualpinError) or not made.soon:
                    self._found[True] = made
                    self._tell(single=True)
                else:
                    self._soon = made
        return self._first or self.kernel(single=single)

    @property
    def _first(self) -> Kernel | None:
        """A kernel for one sample, whatever it is made of."""
        return self.known(single=True) or self._soon

    def _kept(self) -> bool:
        """Whether the batch kernel is in the cache."""
        from ..engine.jit.host import CompilerError
        from ..engine.jit.kernel import kept

        try:
            return kept(self.robot, self.term, self.options, self.dtype)
        except CompilerError:
            return False

    def begin(self, bench: Workbench) -> None:
        """Trace and schedule the batch kernel now, and submit the rest to LLVM."""
        from ..engine.jit.kernel import begin

        if self._found[0] is not None or not self._claim.acquire(blocking=False):
            return
        self._claimed_by = os.getpid()
        try:
            self._begun.set_result(begin(self.robot, self.term, self.options, self.dtype, bench))
        except BaseException:  # raised again where the kernel is needed
            self._begun.set_result(None)

    def _what_is_begun(self) -> Begun | None:
        """The kernel that another thread of this process has begun; the caller takes it over."""
        if self._claim.acquire(blocking=False) or self._claimed_by != os.getpid():
            return None
        begun = self._begun.result()
        try:
            return begun if begun is None or begun.objects.exception() is None else None
        except CancelledError:
            return None

    def _tell(self, single: bool) -> None:
        kernel = self.known(single=single)
        if kernel is not None and self._code is not None:
            self._code.adopt(kernel, many=not single)

    def _built(self, single: bool) -> Kernel | DualpinError:
        begun = None if single else self._what_is_begun()  # before the lock is taken, which others may need
        with LOCK:
            found = self._found[single]
            if found is None:
                found = self._found[single] = self._made(single, begun)
                self._tell(single)
        return found

    def _made(self, single: bool, begun: Begun | None, soon: bool = False) -> Kernel | DualpinError:
        from ..engine.graph.trace import UntraceableError
        from ..engine.jit.host import CompilerError
        from ..engine.jit.kernel import build

        try:
            return build(self.robot, self.term, self.options, self.dtype, single, begun=begun, soon=soon)
        except (CompilerError, UntraceableError) as e:
            return e


_pool: dict[int, Executor] = {}  # by process id


def later(work: Callable[[], object]) -> None:
    """Run in a background thread: one for all, since LLVM runs in one thread at a time."""
    with contextlib.suppress(RuntimeError):  # the interpreter is ending
        pool = _pool.get(os.getpid()) or _pool.setdefault(
            os.getpid(), ThreadPoolExecutor(1, thread_name_prefix="dualpin-tiered")
        )
        pool.submit(work)


@functools.cache
def _announce(reason: str) -> None:
    warnings.warn(
        f"no compiler on this machine ({reason}): computing with NumPy, which is slower by orders of magnitude",
        DualpinWarning,
        stacklevel=5,
    )
