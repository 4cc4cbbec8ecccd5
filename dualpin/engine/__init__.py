"""How a term is executed on arrays: compiled for this machine, or by NumPy.

"auto"      compiled where there is a compiler and the term is a straight line, else NumPy
"compiled"  compiled, or an error that says why not
"numpy"     the source itself on arrays
"""

from __future__ import annotations

import functools
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ArgumentError, DualpinError, DualpinWarning, nearest
from ..model.memory import memory
from ..model.robot import Robot
from ..terms import Options, Term
from . import reference

if TYPE_CHECKING:
    from .jit.kernel import Kernel

ENGINES = ("auto", "compiled", "numpy")


def run(
    robot: Robot,
    term: Term,
    options: Options,
    inputs: Sequence[np.ndarray],
    engine: str = "auto",
    *,
    out: np.ndarray | None = None,
    dtype: Any = np.float64,
) -> np.ndarray:
    """Arrays (n, size) in, one array (n, *shape) out, by the engine of that name.

    Parameters
    ----------
    out : ndarray (n, width), optional
        Where the results go, one row a sample.
    """
    if engine not in ENGINES:
        raise ArgumentError(f"engine {engine!r} is not known; {nearest(engine, ENGINES, 'engines')}")
    kernel = None
    if engine != "numpy":
        single = len(inputs[0]) == 1
        kernel = find(robot, term, options, dtype, required=engine == "compiled", single=single)
    if kernel is not None:
        return kernel.rows(inputs, out).reshape((len(inputs[0]), *kernel.shape))
    result = reference.run(robot, term, options, inputs).astype(dtype, copy=False)
    if out is not None:
        out[...] = result.reshape(out.shape)
        return out.reshape(result.shape)
    return result


def find(
    robot: Robot, term: Term, options: Options, dtype: Any = np.float64, *, required: bool = False, single: bool = False
) -> Kernel | None:
    """The term's kernel, compiled at first use and kept with the robot; None where there is none.

    With `required` the reason is raised instead; `single` asks for the one made for one configuration.
    """
    kernels, key = memory(robot).setdefault("kernels", {}), _key(term, options, dtype, single)
    found = kernels.get(key)
    if found is None:
        from .graph.trace import UntraceableError
        from .jit.host import CompilerError
        from .jit.kernel import build

        try:
            found = kernels[key] = build(robot, term, options, dtype, single)
        except (CompilerError, UntraceableError) as e:
            found = kernels[key] = e
            if isinstance(e, CompilerError) and not required:
                _announce(str(e))
    if isinstance(found, DualpinError):
        if required:
            raise found
        return None
    return found


def known(robot: Robot, term: Term, options: Options, dtype: Any, *, single: bool) -> Kernel | None:
    """The kernel, if there was reason to compile it yet."""
    found = memory(robot).get("kernels", {}).get(_key(term, options, dtype, single))
    return None if isinstance(found, DualpinError) else found


def _key(term: Term, options: Options, dtype: Any, single: bool) -> tuple:
    return (term.name, np.dtype(dtype).char, single, *sorted(options.items()))


@functools.cache
def _announce(reason: str) -> None:
    warnings.warn(
        f"no compiler on this machine ({reason}): computing with NumPy, which is slower by orders of magnitude",
        DualpinWarning,
        stacklevel=5,
    )


__all__ = ["ENGINES", "find", "known", "run"]
