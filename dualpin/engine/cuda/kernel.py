"""A term of a robot as a function of arrays on a device."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import ArgumentError, ShapeError
from ...model.robot import Robot
from ...terms import Options, Term
from . import arrays
from .build import built
from .dlpack import Lent
from .driver import Device, Function
from .layout import WARP

PIECE = 1 << 28  # bytes of a batch on the device at a time, where arrays of the host are copied


class Loaded:
    """A kernel on a device, and how to begin it."""

    def __init__(self, about: dict[str, Any], function: Function, where: Device) -> None:
        self.function, self.device = function, where
        self.threads: int = about["threads"]
        self.warp_bytes: int = about["warp_bytes"]
        function.allow_shared(self.warp_bytes * (self.threads // WARP))

    def start(self, n: int, stream: int, numbers: list[int]) -> None:
        """n samples; few are spread over all multiprocessors, a warp each."""
        tiles = -(-n // WARP)
        warps = max(1, min(self.threads // WARP, tiles // self.device.multiprocessors))
        self.function.launch(-(-tiles // warps), WARP * warps, warps * self.warp_bytes, stream, [n, *numbers])


class DeviceKernel:
    """A term of one robot on one device: arrays in, an array out, like `Robot.kernel` for arrays of the host.

    Parameters
    ----------
    robot, term, options, dtype
        What is computed, in float64 or float32.
    where : Device

    Notes
    -----
    Launches are asynchronous, as everything on a device is: quaternions are not checked for their norm,
    since that would wait for them.
    """

    def __init__(self, robot: Robot, term: Term, options: Options, dtype: Any, where: Device) -> None:
        self.robot, self.term, self.options = replace(robot), term, options
        self.dtype, self.device = np.dtype(dtype), where
        self.shape = term.shape(robot, **options)
        self.inputs = [x.shape(robot) for x in term.arguments]
        self._loaded: dict[bool, Loaded] = {}
        self.__name__ = term.name
        self.__doc__ = f"{term.name}({', '.join(term.inputs)}, out=None, stream=None, copy=False) of {robot.name}"

    def loaded(self, strided: bool = False) -> Loaded:
        """The kernel for rows without gaps, or for any strides."""
        if strided not in self._loaded:
            made = built(self.robot, self.term, self.options, self.dtype, self.device, strided=strided)
            self._loaded[strided] = Loaded(*made, self.device)
        return self._loaded[strided]

    def __call__(self, *given: Any, out: Any = None, stream: Any = None, copy: bool = False) -> Any:
        """The term of these states.

        Parameters
        ----------
        given : arrays on the device, shape (..., size)
            Of the kernel's type, from PyTorch, CuPy, JAX or any library with the CUDA array interface or
            DLPack.  All have the same leading axes, or one sample for all.  Any strides; rows without gaps,
            or columns, are fast.
        out : array on the device, optional
            Where the results go.
        stream : int or object with ``.cuda_stream`` or ``.ptr``, optional
            Where the kernel runs; the library's current stream by default.
        copy : bool
            Arrays are on the host: copy them to the device, and the results back.

        Returns
        -------
        array of the arguments' library, shape (..., *shape); a NumPy array with `copy`

        Raises
        ------
        ArgumentError, ShapeError, DeviceError
        """
        name = self.term.name
        if len(given) != len(self.inputs):
            wanted = ", ".join(self.term.inputs)
            raise ArgumentError(f"{name}: {len(self.inputs)} arrays ({wanted}) expected, got {len(given)}")
        kinds = {key: arrays.library_of(x) for key, x in zip(self.term.inputs, given, strict=True)}
        libraries = set(kinds.values())
        if "host" in libraries:
            if len(libraries) > 1:
                raise arrays.mixed(name, kinds)
            if not copy:
                here = ", ".join(kinds)
                raise ArgumentError(f"{name}: {here} on the host; copy=True copies to the device, and the result back")
            return self._copied(given, out)
        library = kinds[self.term.inputs[0]]
        place = arrays.current_stream(library, self.device) if stream is None else handle(stream)
        views = [
            self._checked(key, arrays.lent(x, kinds[key], place), shape)
            for key, x, shape in zip(self.term.inputs, given, self.inputs, strict=True)
        ]
        batch = self._batch(views)
        shape = batch + self.shape
        result = arrays.empty(library, shape, self.dtype, self.device, place) if out is None else out
        target = self._target(result, shape, place)
        self._run(views, target, math.prod(batch), place)
        if library not in ("torch", "cupy") or stream is not None:
            with self.device.current():
                arrays.held((given, views), place)
        return result if out is not None else arrays.finished(result, library)

    def _checked(self, key: str, x: Lent, shape: tuple[int, ...]) -> Lent:
        name = f"{self.term.name}: {key}"
        if x.dtype != self.dtype:
            raise ArgumentError(f"{name}: {self.dtype} expected, got {x.dtype}")
        if x.device != self.device.ordinal:
            raise ArgumentError(f"{name}: on cuda:{x.device}, but this kernel is on cuda:{self.device.ordinal}")
        if x.shape[len(x.shape) - len(shape) :] != shape or len(x.shape) < len(shape):
            wanted = ", ".join(map(str, shape))
            raise ShapeError(f"{name} of shape (..., {wanted}) expected for {self.robot.name}, got {x.shape}")
        return x

    def _batch(self, views: list[Lent]) -> tuple[int, ...]:
        batches = {
            key: x.shape[: len(x.shape) - len(shape)]
            for key, x, shape in zip(self.term.inputs, views, self.inputs, strict=True)
        }
        batch = max(batches.values(), key=lambda b: (math.prod(b), len(b)))
        for key, b in batches.items():
            if b != batch and math.prod(b) != 1:
                shapes = ", ".join(f"{k} {x}" for k, x in batches.items())
                raise ShapeError(
                    f"{self.term.name}: equal leading axes expected, or one sample for all; got {shapes} ({key})"
                )
        return batch

    def _target(self, out: Any, shape: tuple[int, ...], stream: int) -> Lent:
        name, kind = f"{self.term.name}: out", arrays.library_of(out)
        if kind == "host":
            raise ArgumentError(f"{name}: an array on the device expected, got {type(out).__name__}")
        if kind == "jax":
            raise ArgumentError(f"{name}: arrays of JAX cannot be written to")
        target = arrays.lent(out, kind, stream)
        if target.dtype != self.dtype or target.device != self.device.ordinal:
            wanted = f"{self.dtype} on cuda:{self.device.ordinal}"
            raise ArgumentError(f"{name}: {wanted} expected, got {target.dtype} on cuda:{target.device}")
        if target.shape != shape:
            raise ShapeError(f"{name} of shape {shape} expected, got {target.shape}")
        return target

    def _run(self, views: list[Lent], target: Lent, n: int, stream: int) -> None:
        width = math.prod(self.shape)
        if n == 0 or width == 0:
            return
        ranks = [*(len(s) for s in self.inputs), len(self.shape)]
        steps = [self._steps(x, rank, n) for x, rank in zip([*views, target], ranks, strict=True)]
        strided = any(column not in (0, 1) for _, column in steps)
        if steps[-1][0] == 0 and n > 1:
            raise ArgumentError(f"{self.term.name}: out: samples lie on top of each other")
        self._apart(views, target)
        numbers = [v for x, two in zip([*views, target], steps, strict=True) for v in (x.pointer, *two)]
        self.loaded(strided).start(n, stream, numbers)

    def _steps(self, x: Lent, rank: int, n: int) -> tuple[int, int]:
        """Numbers from a sample to the next, and from an entry to the next; 0 where there is only one."""
        split = len(x.shape) - rank
        row, column = (
            one_step(x.shape[a:b], x.strides[a:b], x.dtype.itemsize) for a, b in ((0, split), (split, len(x.shape)))
        )
        if row is None or column is None:
            raise ArgumentError(
                f"{self.term.name}: an array of shape {x.shape} whose axes do not follow each other "
                f"(strides {x.strides} bytes) cannot be walked along; make it contiguous first"
            )
        return row if math.prod(x.shape[:split]) > 1 else 0, column

    def _apart(self, views: list[Lent], target: Lent) -> None:
        """Threads read while others write: results may not lie where arguments do."""
        low, high = extent(target)
        for key, x in zip(self.term.inputs, views, strict=True):
            start, end = extent(x)
            if start < high and low < end and np.shares_memory(described(target), described(x)):
                raise ArgumentError(f"{self.term.name}: out overlaps {key}")

    def _copied(self, given: tuple[Any, ...], out: Any) -> np.ndarray:
        """Arrays of the host, in pieces that have room on the device."""
        from ...call.arguments import check_result, rows

        inputs, batch = rows(self.robot, self.term, given)
        n, width = len(inputs[0]), math.prod(self.shape)
        if out is not None:
            check_result(self.term.name, out, batch + self.shape, self.dtype)
        result = np.empty((n, width), self.dtype)
        per_sample = (sum(x.shape[1] for x in inputs) + width) * self.dtype.itemsize
        step = max(WARP, PIECE // max(1, per_sample))
        for start in range(0, n, step):
            piece = result[start : start + step]
            sources = [np.ascontiguousarray(x[start : start + step], self.dtype) for x in inputs]
            there = [
                arrays.to_device(x.reshape(len(piece), *s), self.device)
                for x, s in zip(sources, self.inputs, strict=True)
            ]
            piece[...] = self(*there).to_host().reshape(piece.shape)
        result = result.reshape(batch + self.shape)
        if out is None:
            return result
        out[...] = result
        return out


def handle(stream: Any) -> int:
    """A stream as a number."""
    for name in ("cuda_stream", "ptr", "handle"):
        if hasattr(stream, name):
            return int(getattr(stream, name) or 0)
    if not isinstance(stream, int):
        raise ArgumentError(
            f"stream: a number, or an object with .cuda_stream or .ptr, expected, got {type(stream).__name__}"
        )
    return stream


def one_step(shape: tuple[int, ...], strides: tuple[int, ...], itemsize: int) -> int | None:
    """The distance in numbers between neighbours of axes that are walked along as one; None if they cannot be."""
    axes = [(size, step) for size, step in zip(shape, strides, strict=True) if size != 1]
    if not axes:
        return 1
    for (_, outer), (size, inner) in itertools.pairwise(axes):
        if outer != size * inner:
            return None
    step = axes[-1][1]
    return step // itemsize if step % itemsize == 0 else None


def extent(x: Lent) -> tuple[int, int]:
    """The addresses between which an array lies."""
    start = end = x.pointer
    for size, step in zip(x.shape, x.strides, strict=True):
        if size == 0:
            return 0, 0
        if step < 0:
            start += (size - 1) * step
        else:
            end += (size - 1) * step
    return start, end + x.dtype.itemsize


class _Description:
    def __init__(self, x: Lent) -> None:
        self.__array_interface__ = {
            "version": 3, "shape": x.shape, "strides": x.strides, "typestr": x.dtype.str, "data": (x.pointer, True),
        }  # fmt: skip


def described(x: Lent) -> np.ndarray:
    """An array as NumPy sees it, to ask where it lies; its numbers, on a device, must not be touched."""
    return np.asarray(_Description(x))
