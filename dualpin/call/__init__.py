"""The path of a call: arguments are checked once, options resolved once, then one of three executions.

    functions -> evaluator(robot, term, engine)(*arrays, out)

The call is the fast one (machine code), the batched one (threads), or the general one (`Evaluator.__call__`), which
converts arguments and raises errors.  A kernel or NumPy (`interpret`) computes the numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..arguments import choice
from ..errors import ArgumentError
from ..model.memory import MEMORY
from ..model.robot import Frame, Robot
from ..terms import Options, Term
from ..terms import term as term_named
from .ahead import Ahead
from .arguments import check_robot
from .evaluator import DOUBLE, ENGINES, SINGLE, Evaluator
from .making import evaluator_of, function_of

if TYPE_CHECKING:
    from ..engine.jit.kernel import Kernel
    from .device import DeviceEvaluator


def evaluator(
    robot: Robot, asked: Term | tuple[Any, ...], engine: str, dtype: DTypeLike = "float64"
) -> Evaluator | DeviceEvaluator:
    """The callable for a term, or for a term followed by its options as the user gave them."""
    if engine == "auto" and dtype == "float64":
        try:
            return MEMORY[robot.serial][asked]
        except (AttributeError, KeyError, TypeError):
            pass
    term, *given = asked if isinstance(asked, tuple) else (asked,)
    check_robot(robot, term.name)
    options = term.settled(robot, {x.name: value for x, value in zip(term.options, given, strict=False)})
    kind = number_type(term.name, dtype)
    if choice("engine", engine, ENGINES) == "cuda":
        return on_device(robot, term, options, kind if kind == SINGLE else None)
    # kept only for types whose equal values mean the same: 1.0 and True equal the index 1
    keep = engine == "auto" and kind == DOUBLE and all(isinstance(x, (str, bool, Frame)) for x in given)
    return function_of(robot, term, options, kind, engine, alias=asked if keep else None)


def number_type(what: str, dtype: DTypeLike) -> np.dtype:
    """The dtype float64 or float32 of any of its names."""
    try:
        kind = None if dtype is None else np.dtype(dtype)
    except TypeError:
        kind = None
    if kind is None or kind not in (DOUBLE, SINGLE):  # NumPy: None == dtype("float64")
        raise ArgumentError(f"{what}: dtype float64 or float32 expected, got {repr(dtype) if kind is None else kind}")
    return SINGLE if kind == SINGLE else DOUBLE  # these objects: machine code compares identities


def evaluate(
    robot: Robot, name: str, arrays: Mapping[str, ArrayLike], *, engine: str = "auto", out: np.ndarray | None = None,
    dtype: Any = np.float64, **options: Any,
) -> np.ndarray:  # fmt: skip
    """One term by its name on arrays by their names; see `Evaluator`."""
    term = term_named(name)
    check_robot(robot, name)
    settled = term.settled(robot, options)
    found = evaluator_of(robot, term, settled, np.dtype(dtype), choice("engine", engine, ENGINES))
    return found(*(arrays[key] for key in term.inputs), out=out)


def find(
    robot: Robot, term: Term, options: Options, dtype: Any = np.float64, *, required: bool = False, single: bool = False
) -> Kernel | None:
    """The kernel of a term whose options are settled; see `Kernels.kernel`."""
    return evaluator_of(robot, term, options, np.dtype(dtype)).kernels.kernel(single=single, required=required)


def made_ahead(robot: Robot, wanted: Sequence[tuple[str, Mapping[str, Any]]], engine: str = "auto") -> Ahead:
    """A context manager that compiles the kernels of these terms and options in other threads, in this order."""
    check_robot(robot, "ahead")
    named = [(term_named(name), options) for name, options in wanted]
    return Ahead([evaluator_of(robot, term, term.settled(robot, options), engine=engine) for term, options in named])


def run(robot: Robot, term: Term, options: Options, inputs: Sequence[np.ndarray], engine: str = "auto") -> np.ndarray:
    """Compute a term with settled options: arrays (n, size) in, one array (n, *shape) out; without checks."""
    return evaluator_of(robot, term, options, engine=choice("engine", engine, ENGINES)).rows(inputs)


def on_device(
    robot: Robot, term: Term, options: Options, dtype: np.dtype | None = None, device: Any = "cuda"
) -> DeviceEvaluator:
    """The term on arrays of a GPU; see `DeviceEvaluator`."""
    from .device import device_evaluator

    return device_evaluator(robot, term, options, dtype, device)


def kernel(
    robot: Robot, name: str, dtype: Any = np.float64, device: str | int | None = None, **options: Any
) -> Callable[..., Any]:
    """One term as a callable for loops, (*arrays, out=None) -> array, with the least overhead.

    Parameters
    ----------
    name : str
        A name in `dualpin.terms.TERMS`: "rnea", "crba", "fk", "frame_pose", "jacobian", ...
    dtype : float64 or float32
        Type of the computation and of the result; other arrays are converted.
    device : "cuda", "cuda:1", ..., optional
        A GPU, for arrays that are on it; see docs/gpu.md.
    **options
        Options of the term: ``frame=`` (a name, an index or a `Frame`), ``reference=``, ``classical=``.

    Returns
    -------
    callable
        Takes the term's arrays (..., size) in the order of ``TERMS[name].inputs``, and ``out=``,
        an array for the result.  Contiguous arrays of `dtype`, one configuration or a batch with ``out``,
        take the fast call; others give the same result some microseconds later.

    Raises
    ------
    ArgumentError
        If there is no such term, or it has no such option.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> inverse_dynamics, tau = robot.kernel("rnea"), np.empty(6)
    >>> q, v, a = robot.sample(seed=0)
    >>> inverse_dynamics(q, v, a, out=tau) is tau
    True
    >>> bool(np.array_equal(tau, dp.rnea(robot, q, v, a)))
    True
    """
    term = term_named(name)
    check_robot(robot, name)
    kind = number_type(f"kernel {name}", dtype)
    settled = term.settled(robot, options)
    if device is not None:
        return on_device(robot, term, settled, kind, device)
    find(robot, term, settled, kind, single=True)  # compile now, not at the first call
    return function_of(robot, term, settled, kind, now=True)


__all__ = ["ENGINES", "Evaluator", "evaluate", "evaluator", "find", "kernel", "made_ahead", "on_device", "run"]
