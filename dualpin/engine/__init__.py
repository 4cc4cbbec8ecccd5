"""How a term is executed on arrays: compiled for this machine, or by NumPy.

"auto"      compiled where there is a compiler and the term is a straight line, else NumPy
"compiled"  compiled, or an error that says why not
"numpy"     the source itself on arrays
"""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ArgumentError, DualpinError, DualpinWarning, nearest
from ..model.robot import Robot
from ..terms import TERMS, Options, Term, input_shape
from . import reference

if TYPE_CHECKING:
    from .kernel import Kernel

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
    kernel = None if engine == "numpy" else find(robot, term, options, dtype, required=engine == "compiled")
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
    kernels = robot.__dict__.setdefault("_kernels", {})
    key = (term.name, np.dtype(dtype).char, single, *sorted(options.items()))
    found = kernels.get(key)
    if found is None:
        from .host import CompilerError
        from .kernel import build
        from .trace import UntraceableError

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


@functools.cache
def _announce(reason: str) -> None:
    warnings.warn(
        f"no compiler on this machine ({reason}): computing with NumPy, which is slower by orders of magnitude",
        DualpinWarning,
        stacklevel=5,
    )


def bind(robot: Robot, name: str, dtype: Any = np.float64, **options: Any) -> Callable[..., np.ndarray]:
    """What `Robot.kernel` returns."""
    if name not in TERMS:
        raise ArgumentError(f"kernel {name!r} is not known; {nearest(name, TERMS, 'terms')}")
    kind = np.dtype(dtype)
    if kind not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise ArgumentError(f"kernel {name}: dtype float64 or float32 expected, got {kind}")
    known = robot.__dict__.setdefault("_bound", {})
    key = (name, kind.char, *sorted(options.items()))
    found = known.get(key)
    if found is None:
        found = known[key] = _bind(robot, TERMS[name], kind, options)
    return found


def _bind(robot: Robot, term: Term, dtype: np.dtype, options: dict[str, Any]) -> Callable[..., np.ndarray]:
    from dataclasses import replace

    from ..boundary import call
    from . import entry

    one_q = term.inputs[0] == "q" and "q1" not in term.inputs
    code = find(robot, term, options, dtype, single=True) if one_q and entry.supported() else None
    # the callable must outlive the robot without holding it: the robot holds the callable
    twin = replace(robot)
    twin.__dict__["_kernels"] = robot.__dict__.setdefault("_kernels", {})

    def anything(*arrays: Any, out: np.ndarray | None = None) -> np.ndarray:
        if len(arrays) == len(term.inputs) + 1 and out is None:
            *arrays, out = arrays  # type: ignore[assignment]
        if len(arrays) != len(term.inputs):
            raise ArgumentError(
                f"{term.name}: {len(term.inputs)} arrays ({', '.join(term.inputs)}) expected, got {len(arrays)}"
            )
        named = dict(zip(term.inputs, arrays, strict=True))
        return call(twin, term.name, named, out=out, dtype=dtype, **options)

    doc = f"{term.name}({', '.join(term.inputs)}, out=None) of {robot.name}"
    anything.__name__, anything.__doc__ = term.name, doc
    if code is None or code.width == 0:
        return anything
    shapes = [input_shape(robot, x) for x in term.inputs] + [code.shape]
    if len(shapes) > 6 or max(map(len, shapes)) > 4:
        return anything
    quaternions = [j.q.start + 3 for j in robot if j.kind == "floating"]
    return entry.bound(code, term.name, shapes, quaternions, anything, doc)


__all__ = ["ENGINES", "bind", "find", "run"]
