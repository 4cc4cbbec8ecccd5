"""Measurements of kernels on a GPU, and their resources."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from .call import on_device
from .engine import cuda
from .engine.cuda import driver
from .engine.cuda.program import TooLongError
from .engine.cuda.resources import resources
from .engine.graph.trace import UntraceableError
from .errors import DualpinError, DualpinWarning
from .io import load
from .model.robot import Robot
from .terms import Options, Term, term

DTYPES = ("float64", "float32")
SECONDS, REPETITIONS = 0.1, 5
BLOCK = 10_000  # different states; larger batches repeat them


def work(robots: Sequence[str], terms: Sequence[str], floating: bool) -> Iterator[tuple[Robot, str, Term, Options]]:
    """Robots with their names, and terms with their options."""
    for name in robots:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DualpinWarning)  # remarks on robots are not relevant here
            robot = load(name, floating=floating)
        for asked in terms:
            found = term(asked)
            given: dict[str, Any] = {}
            if any(option.name == "frame" for option in found.options):
                given["frame"] = max(robot.frames, key=lambda f: len(list(f.joint.chain)) if f.joint else 0)
            if any(option.name == "reference" for option in found.options):
                given["reference"] = "local"
            yield robot, name, found, found.settled(robot, given)


def explained(
    robots: Sequence[str], terms: Sequence[str], device: str = "cuda", *, floating: bool = False
) -> list[dict[str, Any]]:
    """Registers, spills and occupancy of kernels, as the assembler reports them; no GPU is needed.

    Returns
    -------
    list of dict
        "robot", "term", "dtype", and the attributes of `dualpin.engine.cuda.resources.Resources`, or
        "reason" where a term is no program for a GPU.  For the GPU of this machine, or sm_90 without one.

    Raises
    ------
    DeviceError
        If the assembler, the wheel nvidia-cuda-nvcc, is not installed.
    """
    architecture = f"sm_{cuda.device(device).capability}" if driver.count() else "sm_90"
    rows = []
    for robot, name, found, options in work(robots, terms, floating):
        for dtype in DTYPES:
            row: dict[str, Any] = {"robot": name, "term": found.name, "dtype": dtype}
            try:
                row |= resources(cuda.plan(robot, found, options, dtype), architecture).as_dict()
            except (TooLongError, UntraceableError) as e:
                row["reason"] = str(e)
            rows.append(row)
    return rows


def run(
    robots: Sequence[str],
    terms: Sequence[str],
    batches: Sequence[int] = (4096, 1_000_000),
    device: str = "cuda",
    *,
    floating: bool = False,
) -> list[dict[str, Any]]:
    """Successive calls from Python, arguments and results on the device, with one wait at the end.

    Returns
    -------
    list of dict
        "robot", "term", "dtype", "batch", "us_per_call", "million_per_second" (samples), "device"; or
        "reason" where a term is no program for a GPU.

    Raises
    ------
    DeviceError
        If there is no such device.
    DualpinError
        If a result has other bits than the host's.
    """
    where = cuda.device(device)
    rows = []
    for robot, name, found, options in work(robots, terms, floating):
        for dtype in DTYPES:
            for n in batches:
                row: dict[str, Any] = {
                    "robot": name,
                    "term": found.name,
                    "dtype": dtype,
                    "batch": n,
                    "device": where.name,
                }
                try:
                    seconds = measured(robot, found, options, np.dtype(dtype), n, where)
                    row |= {"us_per_call": seconds * 1e6, "million_per_second": n / seconds * 1e-6}
                except (TooLongError, UntraceableError) as e:
                    row["reason"] = str(e)
                rows.append(row)
    return rows


def measured(robot: Robot, found: Term, options: Options, dtype: np.dtype, n: int, where: cuda.Device) -> float:
    """Seconds of a call, the best of several runs, checked against the host's kernel before and after."""
    q, v, a = robot.sample(BLOCK, seed=0)
    known = {"q": q, "v": v, "a": a, "tau": a, "q0": q, "q1": q[::-1]}
    sources = [
        np.ascontiguousarray(known.get(x.name, np.ones((BLOCK, *x.shape(robot)))), dtype) for x in found.arguments
    ]
    there = [cuda.to_device(np.resize(x, (n, *x.shape[1:])), where) for x in sources]
    out = cuda.DeviceArray((n, *found.shape(robot, **options)), dtype, where, 0)
    compute, few = on_device(robot, found, options, dtype, where), min(n, BLOCK)
    expected = robot.kernel(found.name, dtype, **options)(*(x[:few] for x in sources))

    def check() -> None:
        if not np.array_equal(out.to_host()[:few], expected, equal_nan=True):
            raise DualpinError(f"bench: {found.name} of {robot.name} has other bits on {where.name} than on the host")

    compute(*there, out=out)
    check()
    loops, best = 1, float("inf")
    for _ in range(REPETITIONS + 1):
        start = time.perf_counter()
        for _ in range(loops):
            compute(*there, out=out)
        where.wait(0)
        seconds = (time.perf_counter() - start) / loops
        best, loops = min(best, seconds), max(1, min(5000, int(SECONDS / seconds)))
    check()
    return best
