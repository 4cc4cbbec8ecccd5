"""Speed beside Pinocchio, in one run: correctness first, then medians of alternating measurements."""

from __future__ import annotations

import gc
import os
import platform
import statistics
import time
import warnings
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np

from . import functions
from .call import find
from .crosscheck.oracles.pinocchio import Pinocchio
from .engine.jit.threads import get_num_threads, set_num_threads
from .errors import ArgumentError, DualpinError, DualpinWarning, nearest
from .io import load
from .machine import package, processor
from .model.robot import Robot
from .terms import TERMS

TERMS_MEASURED = (
    "rnea", "aba", "crba", "coriolis", "fk", "jacobian", "gravity", "bias", "minv", "centroidal_momentum_matrix",
    "joint_torque_regressor", "rnea_derivatives", "aba_derivatives",
)  # fmt: skip
AGREEMENT = 1e-8  # largest scaled difference of measured terms; the cross-check has the tight tolerances
REPETITIONS = 5
SLICE = 0.08  # seconds of each measurement: caches and clocks need some calls to settle

Call = Callable[[int], Any]
"""A function that does something a given number of times."""


def run(
    robots: Sequence[str | Robot],
    terms: Sequence[str] = TERMS_MEASURED,
    batches: Sequence[int] = (1, 4096),
    threads: Sequence[int] = (1,),
    *,
    floating: bool = False,
    repetitions: int = REPETITIONS,
    progress: Callable[[dict[str, Any]], None] | None = None,
) -> list[dict[str, Any]]:
    """Measure terms of robots; one row for each combination.

    Parameters
    ----------
    robots : names, paths or robots that were read from a file
    batches : int
        Samples in one call.  1 is one configuration through ``robot.kernel(term)`` with ``out=``.
    threads : int
        Threads for batches, on both sides where Pinocchio has them.

    Returns
    -------
    list of dict
        "robot", "floating", "term", "batch", "threads", "us_per_sample", "pinocchio_us_per_sample",
        "ratio" of medians of alternating runs, in microseconds; "reference": which of Pinocchio's
        functions it was measured against; "best_us_per_sample", "best_pinocchio_us_per_sample",
        "best_ratio" of the shortest runs, which a busy machine disturbs least; and "fill_us_per_sample",
        what NumPy takes to fill an array like the result with a number.

    Raises
    ------
    ArgumentError
        If a term cannot be measured.
    DualpinError
        If the results disagree.

    Examples
    --------
    >>> from dualpin import bench
    >>> rows = bench.run(["ur5"], ["rnea"], batches=[1], repetitions=1)
    >>> rows[0]["robot"], rows[0]["batch"], rows[0]["ratio"] > 0
    ('ur5', 1, True)
    """
    for term in terms:
        if term not in TERMS_MEASURED:
            raise ArgumentError(f"bench: term {term!r}; {nearest(term, TERMS_MEASURED, 'terms')}")
    before, rows = get_num_threads(), []
    try:
        for given in robots:
            robot, name = _loaded(given, floating)
            for term in terms:
                for batch in batches:
                    for count in threads if batch > 1 else (1,):
                        pair = Pair(robot, term, batch, count)
                        row = {
                            "robot": name,
                            "floating": robot.floating,
                            **pair.measured(repetitions),
                        }
                        rows.append(row)
                        if progress:
                            progress(row)
    finally:
        set_num_threads(before)
    return rows


def _loaded(given: str | Robot, floating: bool) -> tuple[Robot, str]:
    if isinstance(given, Robot):
        return given, given.name
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)  # remarks on robots are not relevant here
        return load(given, floating=floating), str(given)


class Pair:
    """The same term at the same states, computed by dualpin and by Pinocchio, as two loops."""

    def __init__(self, robot: Robot, term: str, batch: int, threads: int) -> None:
        if robot.source is None:
            raise ArgumentError(f"bench: {robot.name} was not read from a file, and Pinocchio needs one")
        self.robot, self.term, self.batch, self.threads = robot, TERMS[term], batch, threads
        self.oracle = Pinocchio.of_file(robot, robot.source, robot.floating)
        q, v, a = robot.sample(batch, seed=0)
        self.states = {"q": q, "v": v, "a": a, "tau": a}
        self.options: dict[str, Any] = {}
        if term == "jacobian":
            # the frame with the most joints on its path: Pinocchio's cost grows with them, too
            frame = max(robot.frames, key=lambda f: len(list(f.joint.chain)) if f.joint else 0)
            self.options = {"frame": frame, "reference": "local"}
        self.inputs = [self.states[key] for key in self.term.inputs]

    def ours(self) -> tuple[Call, np.ndarray]:
        shape = self.term.shape(self.robot, **self.options)
        f = self.robot.kernel(self.term.name, **self.options)
        if self.batch == 1:
            out, args = np.empty(shape), [x[0].copy() for x in self.inputs]
        else:
            out, args = np.empty((self.batch, *shape)), self.inputs
            find(self.robot, self.term, self.term.settled(self.robot, self.options))  # not while it is measured
        return loop(f, [args], out), out

    def function(self) -> Call:
        """The public function, for one configuration."""
        arrays = (x[0].copy() for x in self.inputs)
        return loop(getattr(functions, self.term.name), [[self.robot, *arrays, *self.options.values()]])

    def theirs(self) -> tuple[Call, int, str]:
        """Pinocchio's fastest form: its parallel loop in C++ where there is one, else its Python call.

        Returns the call, how many samples it computes, and its name.
        """
        pin, model = self.oracle.pin, self.oracle.free.model
        states = self.oracle.free.of(self.states, coupled=False)
        in_parallel = {"rnea": "rneaInParallel", "aba": "abaInParallel"}.get(self.term.name)
        if self.batch > 1 and in_parallel:
            pool = pin.ModelPool(model, self.threads)
            arrays = [np.asfortranarray(states[key].T) for key in self.term.inputs]
            out, f, n = np.empty((model.nv, self.batch), order="F"), getattr(pin, in_parallel), self.threads
            return loop(f, [[n, pool, *arrays, out]]), self.batch, f"{in_parallel}({n})"
        data = model.createData()
        name = _PINOCCHIO[self.term.name]
        call = getattr(pin, name)
        extra: list[Any] = []
        if self.term.name == "jacobian":
            extra = [self.oracle._frame(model, self.options["frame"]), pin.LOCAL]
        few = min(self.batch, 64)
        samples = [[np.ascontiguousarray(states[key][i]) for key in self.term.inputs] + extra for i in range(few)]
        calls = [[model, data, *one] for one in samples]
        return loop(call, calls), few, name if few == 1 else f"{name}, Python loop"

    def check(self) -> None:
        """Raise if the two results differ."""
        call, out = self.ours()
        call(1)
        few = min(self.batch, 16)
        states = {key: x[:few] for key, x in zip(self.term.inputs, self.inputs, strict=True)}
        expected = self.oracle.compute(self.term.name, states, [self.options])[0]
        got = out.reshape((self.batch, *expected.shape[1:]))[:few]
        error = float(np.abs(got - expected).max() / max(1.0, np.abs(expected).max()))
        if not error <= AGREEMENT:
            raise DualpinError(
                f"bench: {self.term.name} of {self.robot.name} differs from Pinocchio by {error:.2g} (scaled)"
            )

    def measured(self, repetitions: int = REPETITIONS) -> dict[str, Any]:
        """The row of this pair."""
        set_num_threads(self.threads)
        self.check()
        theirs, samples, name = self.theirs()
        ours, out = self.ours()
        blank = np.empty_like(out)
        mine, other, filling = alternating([ours, theirs, loop(blank.fill, [[1.0]])], repetitions)
        row: dict[str, Any] = {"term": self.term.name, "batch": self.batch, "threads": self.threads}
        for prefix, measure in (("", statistics.median), ("best_", min)):
            us, pins = measure(mine) / self.batch * 1e6, measure(other) / samples * 1e6
            row |= {
                f"{prefix}us_per_sample": round(us, 5), f"{prefix}pinocchio_us_per_sample": round(pins, 5),
                f"{prefix}ratio": round(pins / us, 2),
            }  # fmt: skip
        return row | {"reference": name, "fill_us_per_sample": round(min(filling) / self.batch * 1e6, 5)}


_PINOCCHIO = {
    "rnea": "rnea", "aba": "aba", "crba": "crba", "coriolis": "computeCoriolisMatrix", "fk": "forwardKinematics",
    "jacobian": "computeFrameJacobian", "gravity": "computeGeneralizedGravity", "bias": "nonLinearEffects",
    "minv": "computeMinverse", "centroidal_momentum_matrix": "computeCentroidalMap",
    "joint_torque_regressor": "computeJointTorqueRegressor", "rnea_derivatives": "computeRNEADerivatives",
    "aba_derivatives": "computeABADerivatives",
}  # fmt: skip


def loop(f: Callable[..., Any], calls: Sequence[Sequence[Any]], out: np.ndarray | None = None) -> Call:
    """A loop that calls f with each of these arguments, and `out`, as a user would write it.

    Unpacking arguments or calling a function that calls f would cost a tenth of a microsecond.
    """
    names = [f"x{i}" for i in range(len(calls[0]))]
    statement = f"f({', '.join(names + (['out=out'] if out is not None else []))})"
    lines = [f"{', '.join(names)}, = calls[0]", "for _ in range(times):", f"    {statement}"]
    if len(calls) > 1:
        lines = ["for _ in range(times):", f"    for {', '.join(names)}, in calls:", f"        {statement}"]
    scope: dict[str, Any] = {}
    exec("def call(times, f, calls, out):\n    " + "\n    ".join(lines), scope)
    return partial(scope["call"], f=f, calls=calls, out=out)


def alternating(calls: Iterable[Call], repetitions: int = REPETITIONS, seconds: float = SLICE) -> list[list[float]]:
    """Seconds of each call, measured alternately so that other load slows all of them."""
    calls = list(calls)
    loops = []
    for f in calls:
        f(1)
        start = time.perf_counter()
        f(1)
        loops.append(max(1, int(seconds / max(time.perf_counter() - start, 1e-7))))
    times: list[list[float]] = [[] for _ in calls]
    collecting = gc.isenabled()
    gc.disable()
    try:
        for _ in range(repetitions):
            for k, f in enumerate(calls):
                start = time.perf_counter()
                f(loops[k])
                times[k].append((time.perf_counter() - start) / loops[k])
    finally:
        if collecting:
            gc.enable()
    return times


def machine() -> dict[str, Any]:
    """Machine and versions, for the head of a report."""
    from .engine.jit.host import this_host

    host = this_host()
    return {
        "processor": f"{processor()} ({host.cpu})", "cores": os.cpu_count(), "vector_bits": 8 * host.width,
        "fma": host.fma,
        "system": f"{platform.system()} {platform.machine()}", "python": platform.python_version(),
        **{p: package(p) for p in ("dualpin", "numpy", "llvmlite", "pin")},
        "pin_is": "the PyPI wheel, compiled for any x86-64 (SSE2)",
    }  # fmt: skip
