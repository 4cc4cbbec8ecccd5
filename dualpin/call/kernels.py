"""The machine code of a term of a robot: compiled when it is first needed, then kept."""

from __future__ import annotations

import functools
import warnings
from typing import TYPE_CHECKING

import numpy as np

from ..errors import DualpinError, DualpinWarning
from ..locking import LOCK
from ..model.robot import Robot
from ..terms import Options, Term

if TYPE_CHECKING:
    from ..engine.jit.fast_call import Code
    from ..engine.jit.kernel import Kernel


class Kernels:
    """Two kernels: one for a single sample, one for many.

    Threads that want the same kernel at the same time get the same one.
    """

    def __init__(self, robot: Robot, term: Term, options: Options, dtype: np.dtype) -> None:
        self.robot, self.term, self.options, self.dtype = robot, term, options, dtype
        self.shape = term.shape(robot, **options)
        self._found: list[Kernel | DualpinError | None] = [None, None]
        self._code: Code | None = None

    def kernel(self, *, single: bool, required: bool = False) -> Kernel | None:
        """The kernel; None where there is none, or with `required` the error that says why."""
        found = self._found[single]
        if found is None:
            found = self._built(single)
            if not (required or isinstance(found, DualpinError)):
                return found
            from ..engine.jit.host import CompilerError

            if isinstance(found, CompilerError) and not required:
                _announce(str(found))
        if isinstance(found, DualpinError):
            if required:
                raise found
            return None
        return found

    def known(self, *, single: bool) -> Kernel | None:
        """The kernel, if there was reason to compile it yet."""
        found = self._found[single]
        return None if isinstance(found, DualpinError) else found

    def code(self, made: Code) -> Code:
        """What the fast call looks into, `made` if there is none yet: it is told of every kernel."""
        with LOCK:
            if self._code is None:
                self._code = made
                self._tell(single=False)
                self._tell(single=True)
            return self._code

    def _tell(self, single: bool) -> None:
        kernel = self.known(single=single)
        if kernel is not None and self._code is not None:
            self._code.adopt(kernel, many=not single)

    def _built(self, single: bool) -> Kernel | DualpinError:
        from ..engine.graph.trace import UntraceableError
        from ..engine.jit.host import CompilerError
        from ..engine.jit.kernel import build

        with LOCK:
            found = self._found[single]
            if found is None:
                try:
                    found = build(self.robot, self.term, self.options, self.dtype, single)
                except (CompilerError, UntraceableError) as e:
                    found = e
                self._found[single] = found
                self._tell(single)
        return found


@functools.cache
def _announce(reason: str) -> None:
    warnings.warn(
        f"no compiler on this machine ({reason}): computing with NumPy, which is slower by orders of magnitude",
        DualpinWarning,
        stacklevel=5,
    )
