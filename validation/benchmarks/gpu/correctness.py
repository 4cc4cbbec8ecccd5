"""Every term on the device against the host's kernel, state by state."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import lru_cache
from multiprocessing import get_context
from typing import Any

import numpy as np

import dualpin as dp
from dualpin.engine import cuda
from dualpin.engine.cuda.program import TooLongError
from dualpin.errors import DualpinError
from dualpin.model.robot import Robot
from dualpin.terms import TERMS

ROBOTS = (("ur5", False), ("panda", False), ("talos", False), ("anymal_c", True), ("g1", True), ("tiago_dual", False))
STATES = 1_000_000
MEMORY = 1 << 30  # bytes of arguments and results at a time: what is larger has fewer states
SLOW, WIDE = 30_000, 50_000  # operations and results beyond which a term is left out: the host's compiler takes minutes


def options(robot: Robot, term: str) -> dict[str, Any]:
    """A frame with most joints under it, and the reference that costs most."""
    chosen: dict[str, Any] = {}
    if term.startswith(("frame_", "jacobian")):
        chosen["frame"] = max(robot.frames, key=lambda f: len(list(f.joint.chain)) if f.joint else 0)
    if term.startswith("jacobian") or term in ("frame_velocity", "frame_acceleration"):
        chosen["reference"] = "local_world_aligned"
    if term == "frame_acceleration":
        chosen["classical"] = True
    return chosen


@lru_cache(maxsize=1)
def robot_and_states(name: str, floating: bool, n: int) -> tuple[Robot, dict[str, np.ndarray]]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = dp.load(name, floating=floating)
    q, v, a = robot.sample(n, seed=0)
    return robot, {"q": q, "v": v, "a": a, "tau": 10 * a, "q0": q, "q1": q[::-1]}


def compared(name: str, floating: bool, term: str, dtype: str, states: int) -> dict[str, Any]:
    """One row: how far device and host are apart."""
    start = time.perf_counter()
    dp.set_num_threads(1)
    robot, known = robot_and_states(name, floating, states)
    row: dict[str, Any] = {"robot": name, "floating": floating, "term": term, "dtype": dtype}
    chosen, made = options(robot, term), TERMS[term]
    try:
        operations = cuda.plan(robot, made, chosen, dtype).program.operations
    except (TooLongError, DualpinError) as e:
        return row | {"left_out": str(e)}
    row["operations"] = operations
    if operations > SLOW:
        return row | {"left_out": f"{operations} operations: more than the {SLOW} that this check takes time for"}
    shape = made.shape(robot, **chosen)
    if np.prod(shape) > WIDE:
        return row | {"left_out": f"{int(np.prod(shape))} results: more than the {WIDE} that this check takes time for"}
    entries = sum(made.sizes(robot)) + int(np.prod(shape))
    n = min(states, max(1000, MEMORY // (entries * np.dtype(dtype).itemsize)))
    rng = np.random.default_rng(0)
    arrays = []
    for x in made.arguments:
        source = known[x.name][:n] if x.name in known else rng.uniform(-10, 10, (n, *x.shape(robot)))
        arrays.append(np.ascontiguousarray(source, dtype=dtype))
    compute = robot.kernel(term, dtype, device="cuda", **chosen)
    got = compute(*arrays, copy=True)
    expected = robot.kernel(term, dtype=dtype, **chosen)(*arrays)
    function = compute.launch(dtype).function
    with np.errstate(invalid="ignore"):
        apart = float(np.max(np.abs(got - expected), initial=0.0))
        scale = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    return row | {
        "states": n, "same_bits": bool(np.array_equal(got, expected, equal_nan=True)),
        "scaled_difference": apart / scale, "registers": function.registers, "local_bytes": function.local,
        "seconds": round(time.perf_counter() - start, 2),
    }  # fmt: skip


def run(
    states: int = STATES, processes: int = 0, progress: Callable[[dict[str, Any]], None] | None = None,
    robots: tuple[tuple[str, bool], ...] = ROBOTS, terms: tuple[str, ...] = tuple(TERMS),
) -> list[dict[str, Any]]:  # fmt: skip
    """All rows, by several processes that share the device; those that take longest begin first."""
    work = [(name, floating, term, dtype) for name, floating in reversed(robots) for term in terms for dtype in DTYPES]
    count = processes or min(12, max(1, (os.cpu_count() or 1) - 2))
    rows = list(_rows(work, states, count, progress))
    order = {(n, f, t, d): i for i, (n, f) in enumerate(robots) for t in terms for d in DTYPES}
    return sorted(rows, key=lambda r: (order[r["robot"], r["floating"], r["term"], r["dtype"]], terms.index(r["term"])))


DTYPES = ("float64", "float32")


def _rows(
    work: list[tuple[str, bool, str, str]], states: int, count: int, progress: Callable[[dict[str, Any]], None] | None
) -> Iterator[dict[str, Any]]:
    """Rows as they are done; those that find no memory beside the others are asked again by fewer processes.

    A process keeps the local memory of its largest kernel for all threads that the device can hold: up to 11 GB here.
    """
    crowded = []
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        asked = {pool.submit(compared, *one, states): one for one in work}
        for done in as_completed(asked):
            name, floating, term, dtype = one = asked[done]
            row = {"robot": name, "floating": floating, "term": term, "dtype": dtype}
            try:
                row = done.result()
            except Exception as e:  # a row that says so; the others go on
                if count > 1 and "OUT_OF_MEMORY" in str(e):
                    crowded.append(one)
                    continue
                row["error"] = f"{type(e).__name__}: {e}"
            if progress:
                progress(row)
            yield row
    if crowded:
        yield from _rows(crowded, states, max(1, count // 4), progress)


def passed(row: dict[str, Any]) -> bool:
    """The same operations in the same order: every bit, or it is wrong."""
    return "left_out" in row or row.get("same_bits", False)
