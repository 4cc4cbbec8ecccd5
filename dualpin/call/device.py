"""A term of a robot as a function of arrays on a device: the counterpart of `Evaluator` for GPUs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np

from ..engine.cuda import arrays
from ..engine.cuda.arrays import Adapter
from ..engine.cuda.build import built
from ..engine.cuda.dlpack import Lent
from ..engine.cuda.driver import Device, device
from ..engine.cuda.launch import Launch
from ..errors import ArgumentError, ShapeError
from ..model.memory import memory
from ..model.robot import Robot
from ..terms import Options, Shape, Term
from .arguments import separated
from .evaluator import DOUBLE, SINGLE, Evaluator
from .kernels import Kernels

PIECE = 1 << 28  # bytes of a batch on the device at a time, where arrays of the host are copied
KNOWN = 256  # calls (shapes, strides) that are remembered


class Way(NamedTuple):
    """The plan of a call for certain shapes and strides, independent of addresses.

    Attributes
    ----------
    n : int
        Number of samples.
    shape : tuple of int
        Shape of the result.
    steps : tuple of (int, int)
        For each array, the distances from a sample to the next and from an entry to the next, in numbers.
    spans : tuple of (int, int)
        For each array, its first and last byte relative to its address.
    columns : int
        Axes after the first, if the samples of each entry are contiguous in all arguments; else 0.
    launch : Launch or None
        None if there is nothing to compute.
    """

    dtype: np.dtype
    n: int
    shape: Shape
    steps: tuple[tuple[int, int], ...]
    spans: tuple[tuple[int, int], ...]
    columns: int
    launch: Launch | None


class DeviceEvaluator:
    """One term of one robot on one device: arrays in, an array out.

    Launches are asynchronous.  The norm of quaternions is not checked, since that would require waiting.

    Parameters
    ----------
    dtype : dtype or None
        float64 or float32; None takes either, by the arguments.
    """

    def __init__(self, robot: Robot, term: Term, options: Options, dtype: np.dtype | None, where: Device) -> None:
        self.robot, self.term, self.options, self.dtype, self.device = robot, term, options, dtype, where
        self.shape = term.shape(robot, **options)
        self.inputs = [x.shape(robot) for x in term.arguments]
        self._launches: dict[tuple[np.dtype, bool], Launch] = {}
        self._known: dict[Any, Way] = {}
        self.__name__ = term.name
        self.__doc__ = f"{term.name}({', '.join(term.inputs)}, out=None, stream=None, copy=False) of {robot.name}"

    def __call__(self, *given: Any, out: Any = None, stream: Any = None, copy: bool = False, **unknown: Any) -> Any:
        """The term of these states.

        Parameters
        ----------
        given : arrays on the device, shape (..., size)
            Of the kernel's type, from PyTorch, CuPy, JAX or any library with the CUDA array interface or
            DLPack.  All have the same leading axes, or one sample for all.  Any strides are allowed;
            contiguous rows, or columns, are fast.
        out : array on the device, optional
            An array for the results.
        stream : int or object with ``.cuda_stream`` or ``.ptr``, optional
            The stream of the kernel; by default the library's current stream.
        copy : bool
            Take arrays on the host: copy them to the device, and the results back.

        Returns
        -------
        array of the arguments' library, shape (..., *shape); a NumPy array with `copy`

        Raises
        ------
        ArgumentError, ShapeError, DeviceError
        """
        given, out = separated(self.term, given, out, unknown)
        adapter = arrays.adapter(given[0])
        if adapter is None:
            return self._from_host(given, out, copy)
        place = adapter.stream(self.device) if stream is None else arrays.handle(stream)
        way, pointers = self._known_way(adapter, given, out, place) or self._checked_way(given, out, place)
        result = out
        if out is None:
            result = adapter.empty(way.shape, way.dtype, self.device, place, way.columns)
            pointers.append(cast(Adapter, arrays.adapter(result)).pointer(result, place))
        if way.launch is not None:
            numbers = [x for pointer, steps in zip(pointers, way.steps, strict=True) for x in (pointer, *steps)]
            way.launch.start(way.n, place, numbers)
            if stream is not None or not adapter.follows:
                with self.device.current():
                    arrays.held(given, place)
        return result if out is not None else adapter.finished(result)

    def _known_way(
        self, adapter: Adapter, given: tuple[Any, ...], out: Any, stream: int
    ) -> tuple[Way, list[int]] | None:
        """The plan of an earlier call with the same shapes, and the addresses; None if the call has to be checked."""
        everything = given if out is None else (*given, out)
        try:
            key = (adapter, len(everything), *map(adapter.signature, everything))
            way = self._known[key]
            pointers = [adapter.pointer(x, stream) for x in everything]
        except (KeyError, AttributeError, TypeError):  # a new call, or arrays of another library
            return None
        if out is not None:
            low, high = (pointers[-1] + x for x in way.spans[-1])
            for pointer, (start, end) in zip(pointers, way.spans[:-1], strict=False):
                if pointer + start < high and low < pointer + end:
                    return None
        return way, pointers

    def _checked_way(self, given: tuple[Any, ...], out: Any, stream: int) -> tuple[Way, list[int]]:
        """The plan of a call, and the addresses; raises for wrong arguments."""
        name, term = self.term.name, self.term
        adapters = [arrays.adapter(x) for x in given]
        if None in adapters:
            here = ", ".join(x for x, found in zip(term.inputs, adapters, strict=True) if found is None)
            raise ArgumentError(f"{name}: all arrays on the device or all on the host expected; on the host: {here}")
        views = [cast(Adapter, a).lent(x, stream) for a, x in zip(adapters, given, strict=True)]
        dtype = self.dtype or (views[0].dtype if views[0].dtype in (DOUBLE, SINGLE) else DOUBLE)
        for key, x, shape in zip(term.inputs, views, self.inputs, strict=True):
            self._check(key, x, dtype, shape)
        batch = self._batch(views)
        shape = batch + self.shape
        ranks = [*map(len, self.inputs), len(self.shape)]
        n, width = math.prod(batch), math.prod(self.shape)
        everything = list(views)
        if out is not None:
            everything.append(self._target(out, dtype, shape, views, stream))
        steps = [self._steps(x, rank) for x, rank in zip(everything, ranks, strict=False)]
        columns = 0
        if out is None:
            adapter = cast(Adapter, adapters[0])
            if adapter.follows and len(batch) == 1 and n > 1 and all(s[0] == 1 and s[1] >= n for s in steps):
                columns = len(self.shape)
            steps.append((1, n) if columns else (width, 1))
        elif steps[-1][0] == 0 and n > 1:
            raise ArgumentError(f"{name}: out: samples lie on top of each other")
        strided = any(column not in (0, 1) for _, column in steps)
        launch = self.launch(dtype, strided=strided) if n and width else None
        way = Way(dtype, n, shape, tuple(steps), tuple(map(arrays.span, everything)), columns, launch)
        asked = given if out is None else (*given, out)
        signatures = [
            cast(Adapter, adapters[0]).signature(x) if arrays.adapter(x) is adapters[0] else None for x in asked
        ]
        if None not in signatures:
            if len(self._known) >= KNOWN:
                self._known.clear()
            known = (adapters[0], len(signatures), *signatures)
            self._known[known] = way
        return way, [x.pointer for x in everything]

    def launch(self, dtype: Any = np.float64, *, strided: bool = False) -> Launch:
        """The kernel for contiguous rows, or for any strides; made at first use."""
        key = (np.dtype(dtype), strided)
        if key not in self._launches:
            made = built(self.robot, self.term, self.options, key[0], self.device, strided=strided)
            self._launches[key] = Launch(*made, self.device)
        return self._launches[key]

    def _check(self, key: str, x: Lent, dtype: np.dtype, shape: Shape) -> None:
        name = f"{self.term.name}: {key}"
        if x.dtype != dtype:
            raise ArgumentError(f"{name}: {dtype} expected, got {x.dtype}")
        if x.device != self.device.ordinal:
            raise ArgumentError(f"{name}: on cuda:{x.device}, but this kernel is on cuda:{self.device.ordinal}")
        if x.shape[len(x.shape) - len(shape) :] != shape or len(x.shape) < len(shape):
            wanted = ", ".join(map(str, shape))
            raise ShapeError(f"{name} of shape (..., {wanted}) expected for {self.robot.name}, got {x.shape}")

    def _batch(self, views: list[Lent]) -> Shape:
        batches = [x.shape[: len(x.shape) - len(shape)] for x, shape in zip(views, self.inputs, strict=True)]
        batch = max(batches, key=lambda b: (math.prod(b) != 1, len(b)))
        if any(b != batch and math.prod(b) != 1 for b in batches):
            shapes = ", ".join(f"{key} {b}" for key, b in zip(self.term.inputs, batches, strict=True))
            raise ShapeError(f"{self.term.name}: equal leading axes, or one sample for all, expected; got {shapes}")
        return batch

    def _target(self, out: Any, dtype: np.dtype, shape: Shape, views: list[Lent], stream: int) -> Lent:
        name, adapter = f"{self.term.name}: out", arrays.adapter(out)
        if adapter is None:
            raise ArgumentError(f"{name}: an array on the device expected, got {type(out).__name__}")
        if isinstance(adapter, arrays.Jax):
            raise ArgumentError(f"{name}: arrays of JAX cannot be written to")
        target = adapter.lent(out, stream)
        if target.dtype != dtype or target.device != self.device.ordinal:
            wanted = f"{dtype} on cuda:{self.device.ordinal}"
            raise ArgumentError(f"{name}: {wanted} expected, got {target.dtype} on cuda:{target.device}")
        if target.shape != shape:
            raise ShapeError(f"{name} of shape {shape} expected, got {target.shape}")
        for key, x in zip(self.term.inputs, views, strict=True):
            if arrays.overlap(target, x):  # threads would read what others write
                raise ArgumentError(f"{name} overlaps {key}")
        return target

    def _steps(self, x: Lent, rank: int) -> tuple[int, int]:
        """The distances from a sample to the next and from an entry to the next, in numbers; 0 if there is only one."""
        split = len(x.shape) - rank
        row, column = (
            arrays.one_step(x.shape[a:b], x.strides[a:b], x.dtype.itemsize)
            for a, b in ((0, split), (split, len(x.shape)))
        )
        if row is None or column is None:
            raise ArgumentError(
                f"{self.term.name}: an array of shape {x.shape} with strides of {x.strides} bytes cannot be walked "
                "along in even steps; make it contiguous first"
            )
        return row if math.prod(x.shape[:split]) > 1 else 0, column

    def _from_host(self, given: tuple[Any, ...], out: Any, copy: bool) -> np.ndarray:
        name, there = self.term.name, [arrays.adapter(x) is not None for x in given]
        if any(there):
            on_device = ", ".join(key for key, x in zip(self.term.inputs, there, strict=True) if x)
            raise ArgumentError(
                f"{name}: all arrays on the device or all on the host expected; on the device: {on_device}"
            )
        if not copy:
            raise ArgumentError(
                f"{name}: {', '.join(self.term.inputs)} on the host; "
                f"robot.kernel({name!r}, device='cuda')(..., copy=True) copies to the device, and the result back"
            )
        return Copying(Kernels(self.robot, self.term, self.options, self.dtype or DOUBLE), self.device)(*given, out=out)


class Copying(Evaluator):
    """Computes arrays of the host on a device, in pieces that fit into its memory."""

    def __init__(self, kernels: Kernels, where: Device) -> None:
        super().__init__(kernels, "cuda")
        self.there = DeviceEvaluator(self.robot, self.term, self.options, self.dtype, where)

    def rows(self, inputs: Sequence[np.ndarray], out: np.ndarray | None = None) -> np.ndarray:
        """Arrays (n, size) in, one array (n, *shape) out, whose rows are those of `out` (n, width) if given."""
        n, width = len(inputs[0]), math.prod(self.shape)
        result = np.empty((n, width), self.dtype) if out is None else out
        per_sample = (sum(x.shape[1] for x in inputs) + width) * self.dtype.itemsize
        step = max(1024, PIECE // max(1, per_sample))
        for start in range(0, n, step):
            piece = result[start : start + step]
            shapes = [(len(piece), *shape) for shape in self.there.inputs]
            sources = [np.ascontiguousarray(x[start : start + step], self.dtype) for x in inputs]
            moved = [arrays.to_device(x.reshape(s), self.there.device) for x, s in zip(sources, shapes, strict=True)]
            self.there(*moved).to_host(piece)
        return result.reshape((n, *self.shape))


def device_evaluator(
    robot: Robot, term: Term, options: Options, dtype: np.dtype | None = None, where: str | int | Device = "cuda"
) -> DeviceEvaluator:
    """The robot's evaluator on a device for a term whose options are settled; made at first use."""
    place = where if isinstance(where, Device) else device(where)
    kept, key = memory(robot), ("device", term, dtype, place.ordinal, *options.values())
    found: DeviceEvaluator | None = kept.get(key)
    if found is None:
        constants = kept.get("constants") or kept.setdefault("constants", replace(robot))
        found = kept.setdefault(key, DeviceEvaluator(constants, term, options, dtype, place))
    return found
