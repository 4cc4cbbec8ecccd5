"""The array boundary: shapes and types are checked here, once, before anything is computed.

Algorithms never see the shapes of arrays; kernels never see names or options.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .algorithms.kinematics import References
from .errors import ArgumentError, ShapeError, nearest
from .model.memory import MEMORY, memory
from .model.robot import Robot
from .terms import TERMS, Options, Term, input_shape

_UNIT = 1e-6  # how far a quaternion's norm may be from 1: more than any rounding, less than a mistake


def prepared(
    robot: Robot, key: str | tuple[Any, ...], engine: str, names: tuple[str, ...] = ()
) -> Callable[..., np.ndarray]:
    """What a public function calls with its arrays and `out`: the robot's own callable for the term, or `call`.

    It is made at first use.  `key` is the term's name, followed by its options as the user gave
    them, which are called `names`.
    """
    if engine == "auto":
        try:
            found: Callable[..., np.ndarray] = MEMORY[robot.serial][key]
        except (AttributeError, KeyError, TypeError):
            pass
        else:
            return found
    name, *values = (key,) if isinstance(key, str) else key
    check_robot(robot, name)
    settled = settle(robot, dict(zip(names, values, strict=True)))
    if engine != "auto" or robot.numbers != "double":
        # constants of more digits are no machine numbers: they run uncompiled
        return partial(_called, robot, name, "numpy" if engine == "auto" else engine, settled)
    from .engine.bind import bind

    found = bind(robot, name, **settled)
    with contextlib.suppress(TypeError):  # options that are no keys: settled every time
        memory(robot)[key] = found
    return found


def _called(robot: Robot, name: str, engine: str, options: Options, *arrays: Any) -> np.ndarray:
    *inputs, out = arrays
    return call(robot, name, dict(zip(TERMS[name].inputs, inputs, strict=True)), engine=engine, out=out, **options)


def settle(robot: Robot, options: Mapping[str, Any]) -> dict[str, Any]:
    """Options as the algorithms want them: frames found, references checked."""
    settled = dict(options)
    if "frame" in settled:
        settled["frame"] = robot.frame(settled["frame"])
    if "reference" in settled:
        choice("reference", settled["reference"], References)
    return settled


def call(
    robot: Robot,
    name: str,
    arrays: Mapping[str, ArrayLike],
    *,
    engine: str = "auto",
    out: np.ndarray | None = None,
    dtype: Any = np.float64,
    **options: Any,
) -> np.ndarray:
    """One term on arrays (..., size), the leading axes broadcast; returns (..., *shape), in `out` if given."""
    from .engine import run

    term = TERMS[name]
    check_robot(robot, name)
    inputs = plain(robot, name, arrays)
    batch: tuple[int, ...]
    if inputs is None:
        inputs, batch = flattened(robot, term, {key: as_array(robot, name, key, x) for key, x in arrays.items()})
    else:
        batch = inputs[0].shape[:1]
    if out is None:
        result = run(robot, term, options, inputs, engine=engine, dtype=dtype)
        return result.reshape(batch + result.shape[1:])
    check_out(name, out, batch + term.shape(robot, **options), np.dtype(dtype))
    if out.flags.c_contiguous and out.size:
        run(robot, term, options, inputs, engine=engine, dtype=dtype, out=out.reshape(len(inputs[0]), -1))
    else:
        out[...] = run(robot, term, options, inputs, engine=engine, dtype=dtype).reshape(out.shape)
    return out


def check_out(term: str, out: object, shape: tuple[int, ...], dtype: np.dtype) -> None:
    """An array of exactly this shape and type that may be written to, or an error that says so."""
    if not isinstance(out, np.ndarray):
        raise ArgumentError(f"{term}: out must be an array of {dtype}, got {type(out).__name__}")
    if out.dtype != dtype:
        raise ArgumentError(f"{term}: out of {dtype} expected, got {out.dtype}")
    if out.shape != shape:
        raise ShapeError(f"{term}: out of shape {shape} expected, got {out.shape}")
    if not out.flags.writeable:
        raise ArgumentError(f"{term}: out is read-only")


def plain(robot: Robot, term: str, arrays: Mapping[str, ArrayLike]) -> list[np.ndarray] | None:
    """The inputs as they are, where all are float64 arrays of one batch axis: the common case, made quick."""
    n = -1
    for key, x in arrays.items():
        if type(x) is not np.ndarray or x.dtype != np.float64 or x.ndim != 2 or key == "f_ext":
            return None
        rows, size = x.shape
        if size != input_shape(robot, key)[0] or n not in (-1, rows):
            return None
        n = rows
        if key.startswith("q"):
            check_quaternions(robot, term, x)
    return list(arrays.values())  # type: ignore[arg-type]


def flattened(robot: Robot, term: Term, given: Mapping[str, np.ndarray]) -> tuple[list[np.ndarray], tuple[int, ...]]:
    """Inputs broadcast to one batch and reshaped to (n, size), and the batch's shape."""
    rank = {key: len(input_shape(robot, key)) for key in given}
    try:
        batch = np.broadcast_shapes(*(x.shape[: x.ndim - rank[key]] for key, x in given.items()))
    except ValueError:
        shapes = ", ".join(f"{key} {x.shape}" for key, x in given.items())
        raise ShapeError(f"{term.name}: the leading axes of {shapes} do not broadcast together") from None
    n = math.prod(batch)
    inputs = []
    for key, x in given.items():
        size = math.prod(input_shape(robot, key))
        inputs.append(np.broadcast_to(x, batch + x.shape[x.ndim - rank[key] :]).reshape(n, size))
    return inputs, batch


def as_array(robot: Robot, term: str, key: str, value: ArrayLike) -> np.ndarray:
    """`value` as a float64 array whose last axes fit the robot, or an error that says what was expected."""
    x = numbers(f"{term}: {key}", value)
    expected = input_shape(robot, key)
    if x.ndim < len(expected) or x.shape[x.ndim - len(expected) :] != expected:
        counts = {"f_ext": f"a wrench [n; f] for each of {len(robot)} joints", "q": f"nq = {robot.nq}"}
        meaning = counts.get("q" if key.startswith("q") else key, f"nv = {robot.nv}")
        wanted = ", ".join(map(str, expected))
        raise ShapeError(f"{term}: {key} of shape (..., {wanted}) expected for {robot.name} ({meaning}), got {x.shape}")
    if key.startswith("q"):
        check_quaternions(robot, term, x)
    return x


def numbers(what: str, value: ArrayLike) -> np.ndarray:
    """`value` as float64; complex, text and objects are refused rather than cut."""
    try:
        x = np.asarray(value)
    except ValueError as e:
        raise ShapeError(f"{what}: not an array ({e})") from None
    if x.dtype.kind not in "fiub":
        raise ArgumentError(f"{what}: real numbers expected, got {x.dtype} ({type(value).__name__})")
    return x.astype(np.float64, copy=False)


def check_robot(robot: Robot, term: str) -> None:
    if not isinstance(robot, Robot):
        hint = f"; dualpin.load({robot!r}) reads one" if isinstance(robot, str) else ""
        raise ArgumentError(f"{term}: a Robot expected first, got {type(robot).__name__}{hint}")
    if robot.numbers == "symbolic":
        raise ArgumentError(
            f"{term}: the constants of {robot.name} are symbols; arrays of numbers need numbers. "
            "The functions of dualpin.algorithms take lists of symbols"
        )


def check_quaternions(robot: Robot, term: str, q: np.ndarray) -> None:
    """Orientations must be unit quaternions: silently normalising would hide a wrong order of q."""
    for j in robot:
        for at_q in j.quaternions:
            norm = np.linalg.norm(q[..., at_q], axis=-1)
            wrong = np.abs(norm - 1) > _UNIT
            if np.any(wrong):
                at = tuple(int(i) for i in np.argwhere(wrong)[0])
                raise ArgumentError(
                    f"{term}: q[{at_q.start}:{at_q.stop}] of joint {j.name!r} must be a unit quaternion "
                    f"(w, x, y, z); its norm is {float(norm[at]):.9g}" + (f" at sample {at}" if at else "")
                )


def choice(what: str, value: str, choices: tuple[str, ...]) -> str:
    """`value` if it is one of the choices, else an error that offers the nearest."""
    if value not in choices:
        raise ArgumentError(f"{what} {value!r} is not known; {nearest(str(value), choices)}")
    return value


__all__ = ["Options", "as_array", "call", "check_robot", "choice", "flattened", "numbers", "prepared"]
