"""Checks of a term's arguments: shapes, types and unit quaternions, the same for every route of a call.

Algorithms do not handle the shapes of arrays; kernels do not handle names or options.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import numbers
from ..errors import ArgumentError, ArgumentTypeError, ShapeError
from ..model.robot import Robot, expect_numbers
from ..terms import Input, Shape, Term

_UNIT = 1e-6  # tolerance of a quaternion's norm: above rounding, below mistakes


def check_robot(robot: Robot, term: str) -> None:
    """Raise if it is not a robot with numeric constants."""
    expect_numbers(term, robot)


def separated(
    term: Term, arrays: tuple[Any, ...], out: np.ndarray | None, unknown: Mapping[str, Any]
) -> tuple[tuple[Any, ...], np.ndarray | None]:
    """The input arrays of the term, and the array for the result, which may be the last positional argument."""
    names = ", ".join(term.inputs)
    if unknown:
        raise ArgumentTypeError(
            f"{term.name}: arrays ({names}) are given in order, and `out` by its name; "
            f"{', '.join(unknown)} {'is' if len(unknown) == 1 else 'are'} not known"
        )
    if len(arrays) == len(term.inputs) + 1 and out is None:
        arrays, out = arrays[:-1], arrays[-1]
    if len(arrays) != len(term.inputs):
        raise ArgumentError(f"{term.name}: {len(term.inputs)} arrays ({names}) expected, got {len(arrays)}")
    return arrays, out


def rows(robot: Robot, term: Term, arrays: Sequence[ArrayLike]) -> tuple[list[np.ndarray], Shape]:
    """The inputs as arrays (n, size), n the number of samples after broadcasting; and the batch's shape."""
    given = [as_array(robot, term.name, x, value) for x, value in zip(term.arguments, arrays, strict=True)]
    ranks = [len(x.shape(robot)) for x in term.arguments]
    leading = [value.shape[: value.ndim - rank] for value, rank in zip(given, ranks, strict=True)]
    try:
        batch = np.broadcast_shapes(*leading)
    except ValueError:
        shapes = ", ".join(f"{name} {value.shape}" for name, value in zip(term.inputs, given, strict=True))
        raise ShapeError(f"{term.name}: the leading axes of {shapes} do not broadcast together") from None
    n = math.prod(batch)
    found = []
    for value, own in zip(given, leading, strict=True):
        sample = value.shape[len(own) :]
        whole = value if own == batch else np.broadcast_to(value, batch + sample)
        found.append(whole.reshape(n, math.prod(sample)))
    return found, batch


def as_array(robot: Robot, what: str, wanted: Input, value: ArrayLike) -> np.ndarray:
    """`value` as a float64 array whose last axes fit the robot; raises for other shapes and types."""
    x = numbers(f"{what}: {wanted.name}", value)
    shape = wanted.shape(robot)
    if x.ndim < len(shape) or x.shape[x.ndim - len(shape) :] != shape:
        axes = ", ".join(map(str, shape))
        raise ShapeError(
            f"{what}: {wanted.name} of shape (..., {axes}) expected for {robot.name} ({wanted.meaning(robot)}), "
            f"got {x.shape}"
        )
    if wanted.configuration:
        check_quaternions(robot, what, x)
    return x


def check_quaternions(robot: Robot, what: str, q: np.ndarray) -> None:
    """Raise if a quaternion is not a unit quaternion: normalising it silently would hide a wrong order of q."""
    for j in robot:
        for at_q in j.quaternions:
            norm = np.linalg.norm(q[..., at_q], axis=-1)
            wrong = np.abs(norm - 1) > _UNIT
            if np.any(wrong):
                at = tuple(int(i) for i in np.argwhere(wrong)[0])
                raise ArgumentError(
                    f"{what}: q[{at_q.start}:{at_q.stop}] of joint {j.name!r} must be a unit quaternion "
                    f"(w, x, y, z); its norm is {float(norm[at]):.9g}" + (f" at sample {at}" if at else "")
                )


def check_result(term: str, out: object, shape: Shape, dtype: np.dtype) -> None:
    """Raise if `out` is not a writeable array of this shape and type."""
    if not isinstance(out, np.ndarray):
        raise ArgumentError(f"{term}: out must be an array of {dtype}, got {type(out).__name__}")
    if out.dtype != dtype:
        raise ArgumentError(f"{term}: out of {dtype} expected, got {out.dtype}")
    if out.shape != shape:
        raise ShapeError(f"{term}: out of shape {shape} expected, got {out.shape}")
    if not out.flags.writeable:
        raise ArgumentError(f"{term}: out is read-only")
