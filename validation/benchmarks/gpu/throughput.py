"""Samples a second of our kernels: data on the device, and with copies."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from ctypes import byref, c_size_t, c_uint64, c_void_p
from typing import Any

import numpy as np

from dualpin.engine import cuda
from dualpin.engine.cuda import driver
from dualpin.model.robot import Robot
from dualpin.terms import TERMS

from .correctness import options, robot_and_states

BATCHES = (1024, 4096, 100_000, 1_000_000, 10_000_000)
WORK = (
    ("panda", False, ("rnea", "aba", "crba", "fk", "rnea_derivatives")),
    ("talos", False, ("rnea", "aba", "crba")),
    ("g1", True, ("rnea", "aba")),
    ("ur5", False, ("rnea", "aba")),
    ("talos_arm", False, ("rnea", "aba")),
)
BLOCK = 100_000  # different states; larger batches repeat them
LARGEST = 24 << 30  # bytes of a batch
SECONDS = 0.05  # of each measurement
REPETITIONS = 5


def tiled(x: np.ndarray, n: int) -> cuda.DeviceArray:
    """n rows on the device, x over and over."""
    where = cuda.device()
    block = cuda.to_device(x[: min(n, len(x))])
    result = cuda.DeviceArray((n, *x.shape[1:]), x.dtype, where, 0)
    row = block.nbytes // len(x[: min(n, len(x))])
    with where.current():
        for start in range(0, n, len(x)):
            size = c_size_t(row * min(len(x), n - start))
            target = c_uint64(result.pointer + start * row)
            driver.call("cuMemcpyDtoDAsync_v2", target, c_uint64(block.pointer), size, c_void_p(0))
    where.wait(0)
    return result


def on_device(start: Callable[[int], None], many: int = 1) -> float:
    """Seconds of one launch by the device's own clock: the median of several.

    Many launches are replayed as one graph: the device would wait for Python between them.
    """
    where = cuda.device()
    stream = where.stream()
    with where.current():
        graph = captured(start, stream, many) if many > 1 else None

        def work() -> None:
            if graph is None:
                start(stream)
            else:
                driver.call("cuGraphLaunch", graph, c_void_p(stream))

        times = []
        work()
        for _ in range(4 * REPETITIONS):
            before = driver.Event(stream, timing=True)
            work()
            after = driver.Event(stream, timing=True)
            after.wait()
            times.append(after.since(before) / many)
    return statistics.median(times)


def captured(start: Callable[[int], None], stream: int, many: int) -> c_void_p:
    """So many launches as one graph that can be replayed."""
    graph, executable = c_void_p(), c_void_p()
    driver.call("cuStreamBeginCapture_v2", c_void_p(stream), 2)
    for _ in range(many):
        start(stream)
    driver.call("cuStreamEndCapture", c_void_p(stream), byref(graph))
    driver.call("cuGraphInstantiateWithFlags", byref(executable), graph, c_uint64(0))
    return executable


def per_call(call: Callable[[], Any], wait: Callable[[], Any]) -> float:
    """Seconds of a call from Python, many of them one after the other, waited for at the end: the best of several."""
    call()
    wait()
    start = time.perf_counter()
    call()
    wait()
    once = time.perf_counter() - start
    loops = max(1, min(2000, int(SECONDS / max(once, 1e-6))))
    best = float("inf")
    for _ in range(REPETITIONS if once < 1 else 2):
        start = time.perf_counter()
        for _ in range(loops):
            call()
        wait()
        best = min(best, (time.perf_counter() - start) / loops)
    return best


def measured(robot: Robot, term: str, dtype: str, n: int, states: dict[str, np.ndarray]) -> dict[str, Any]:
    """One row: checked against the host before and after."""
    made, chosen = TERMS[term], options(robot, term)
    shape = made.shape(robot, **chosen)
    item = np.dtype(dtype).itemsize
    entries = sum(made.sizes(robot)) + int(np.prod(shape))
    row: dict[str, Any] = {"term": term, "dtype": dtype, "batch": n, "bytes_per_sample": entries * item}
    if n * entries * item > LARGEST:
        return row | {"left_out": f"{n * entries * item / 1e9:.0f} GB"}
    sources = [np.ascontiguousarray(states[x], dtype=dtype) for x in made.inputs]
    arrays = [tiled(x, n) for x in sources]
    out = cuda.DeviceArray((n, *shape), np.dtype(dtype), cuda.device(), 0)
    compute = robot.kernel(term, dtype, device="cuda", **chosen)
    few = min(n, 1000)
    last = [np.resize(np.roll(x, -((n - few) % len(x)), axis=0), (few, *x.shape[1:])) for x in sources]
    expected = robot.kernel(term, dtype=dtype, **chosen)(*last)

    def check() -> bool:
        return bool(np.array_equal(tail(out, few), expected))

    def call() -> None:
        compute(*arrays, out=out)

    def start(stream: int) -> None:
        rows = [(x.pointer, x.nbytes // n // item, 1) for x in (*arrays, out)]
        compute.launch(dtype).start(n, stream, [x for row in rows for x in row])

    call()
    before = check()
    many = 50 if n <= BLOCK else 1
    row |= {"device_seconds": on_device(start, many), "call_seconds": per_call(call, lambda: cuda.device().wait(0))}
    row["equal"] = before and check()
    if n <= 1_000_000 and n * entries * item <= 4 << 30:
        there = [np.resize(x, (n, *x.shape[1:])) for x in sources]
        result = np.empty((n, *shape), dtype)
        row["copied_seconds"] = per_call(lambda: compute(*there, out=result, copy=True), lambda: None)
        row["equal"] = row["equal"] and bool(np.array_equal(result[n - few :], expected))
    return row


def tail(x: cuda.DeviceArray, n: int) -> np.ndarray:
    """The last n rows, on the host."""
    result = np.empty((n, *x.shape[1:]), x.dtype)
    x.device.to_host(result.ctypes.data, x.pointer + x.nbytes - result.nbytes, result.nbytes, 0)
    x.device.wait(0)
    return result


def run(
    batches: tuple[int, ...] = BATCHES, work: Any = WORK, progress: Callable[[dict[str, Any]], None] | None = None
) -> list[dict[str, Any]]:
    """All rows; a device that others use meanwhile gives figures that mean nothing."""
    rows = []
    for name, floating, terms in work:
        robot, states = robot_and_states(name, floating, BLOCK)
        for term in terms:
            for dtype in ("float64", "float32"):
                for n in batches:
                    row = {"robot": name, "floating": floating, **measured(robot, term, dtype, n, states)}
                    rows.append(row)
                    if progress:
                        progress(row)
    return rows


WIDE = (("panda", False, ("rnea", "fk", "crba", "rnea_derivatives")), ("talos", False, ("rnea", "fk", "crba")))


def columns(progress: Callable[[dict[str, Any]], None] | None = None) -> list[dict[str, Any]]:
    """Structures of arrays, by the device's clock: each entry's samples are neighbours, as threads are."""
    rows = []
    for name, floating, terms in WIDE:
        robot, states = robot_and_states(name, floating, BLOCK)
        for term in terms:
            for dtype in ("float64", "float32"):
                made = TERMS[term]
                width = int(np.prod(made.shape(robot)))
                n = 1_000_000 if width < 300 else BLOCK
                sources = [np.resize(states[x], (n, states[x].shape[1])).astype(dtype) for x in made.inputs]
                arrays = [cuda.to_device(np.ascontiguousarray(x.T)) for x in sources]
                out = cuda.DeviceArray((width, n), np.dtype(dtype), cuda.device(), 0)
                launch = robot.kernel(term, dtype, device="cuda").launch(dtype, strided=True)
                numbers = [x for array in (*arrays, out) for x in (array.pointer, 1, n)]
                seconds = on_device(lambda stream: launch.start(n, stream, numbers))  # noqa: B023
                expected = robot.kernel(term, dtype)(*(x[:1000] for x in sources)).reshape(1000, width)
                equal = bool(np.array_equal(out.to_host()[:, :1000].T, expected))
                row = {"robot": name, "floating": floating, "term": term, "dtype": dtype, "batch": n}
                rows.append(row | {"device_seconds": seconds, "equal": equal})
                if progress:
                    progress(rows[-1])
    return rows


def copy_rate(size: int = 4 << 30) -> float:
    """Bytes a second that the device's memory moves, read and written both counted."""
    where = cuda.device()
    a, b = (cuda.DeviceArray((size // 8,), np.dtype(np.float64), where, 0) for _ in range(2))

    def start(stream: int) -> None:
        source, target = c_uint64(a.pointer), c_uint64(b.pointer)
        driver.call("cuMemcpyDtoDAsync_v2", target, source, c_size_t(size), c_void_p(stream))

    return 2 * size / on_device(start)
