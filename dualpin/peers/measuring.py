"""Alternating measurements of dualpin and peers: results compared before and after, medians with spread."""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..bench import alternating, loop
from ..engine.jit.threads import get_num_threads, set_num_threads
from ..errors import ArgumentError, DualpinError, nearest
from ..io import load
from ..model.robot import Robot
from ..terms import TERMS
from .adapters import NAMES
from .apart import ONE
from .looped import looped
from .process import AbsentError, Process, named, write_robot

MEASURED = ("rnea", "aba", "crba", "coriolis", "fk", "minv", "rnea_derivatives")
AGREEMENT = 1e-8
"""Scaled by the largest entry; `aba` and `minv`, which solve with M, times the condition of M over 1e5."""
SECONDS, FAST = 0.05, 3.0
"""Seconds of a measurement; and the factor on the sampled velocities."""


def run(
    robots: Sequence[str | Robot],
    names: Sequence[str] = NAMES,
    terms: Sequence[str] = MEASURED,
    batch: int = 4096,
    *,
    repetitions: int = 7,
    progress: Callable[[dict[str, Any]], None] | None = None,
) -> list[dict[str, Any]]:
    """Measure terms of robots beside peers, on one thread; one row for each cell, and one for each that is left out.

    Parameters
    ----------
    robots : names, paths or robots
        Of turning and sliding joints, on a fixed base.
    names : str
        Of `dualpin.peers.NAMES`.
    batch : int
        Samples in one call of the batched cells.
    terms : str
        Of `MEASURED`.
    repetitions : int
        Alternating runs of both.
    progress : callable, optional
        Called with each row.

    Returns
    -------
    list of dict
        "robot", "term", "peer", "batch" (1: single calls), "version", "how" the peer was called,
        "us" and "peer_us" a sample, medians of alternating runs, "spread" and "peer_spread" (lowest, highest),
        "ratio"; of single calls in a loop of C or C++ also "loop_us", "loop_spread" and "loop_ratio", with our kernel
        in a loop of machine code; or "skipped": why there are none.

    Raises
    ------
    ArgumentError
        If there is no such peer or term, or a robot cannot be given to peers.

    Examples
    --------
    >>> from dualpin import peers
    >>> rows = peers.run(["ur5"], ["pinocchio"], ["rnea"], batch=64, repetitions=2)
    >>> sorted({row["batch"] for row in rows})
    [1, 64]
    """
    for term in terms:
        if term not in MEASURED:
            raise ArgumentError(f"bench: term {term!r}; {nearest(term, MEASURED, 'terms')}")
    for name in names:
        named(name)
    rows: list[dict[str, Any]] = []
    before = get_num_threads()
    set_num_threads(1)
    try:
        for given in robots:
            robot = given if isinstance(given, Robot) else load(given)
            label = robot.name if isinstance(given, Robot) else str(given)
            with tempfile.TemporaryDirectory() as place:
                folder = Path(place)
                ours = Ours(robot, batch)
                write_robot(robot, folder, ours.states)
                for name in names:
                    for row in _beside(name, folder, ours, terms, repetitions):
                        rows.append({"robot": label, **row})
                        if progress:
                            progress(rows[-1])
    finally:
        set_num_threads(before)
    return rows


class Ours:
    """The same states by dualpin."""

    def __init__(self, robot: Robot, batch: int) -> None:
        self.robot, self.batch = robot, batch
        q, v, a = robot.sample(max(batch, ONE), seed=0)
        self.states = {"q": q, "v": FAST * v, "a": a}

    def inputs(self, term: str) -> list[np.ndarray]:
        known = {**self.states, "tau": self.states["a"]}
        return [known[key] for key in TERMS[term].inputs]

    def call(self, term: str, one: bool) -> tuple[Callable[[int], Any], int, np.ndarray]:
        """A loop, how many samples a run of it has, and where the results of a batch go."""
        f, inputs = self.robot.kernel(term), self.inputs(term)
        shape = TERMS[term].shape(self.robot)
        if one:
            out = np.empty(shape)
            rows = [tuple(x[i].copy() for x in inputs) for i in range(ONE)]
            return loop(f, rows, out), ONE, out
        out = np.empty((len(inputs[0]), *shape))
        return loop(f, [inputs], out), len(inputs[0]), out

    def looped(self, term: str) -> Callable[[int], None]:
        """The same single calls in a loop of machine code, each result stored."""
        inputs, out = [x[:ONE] for x in self.inputs(term)], np.empty((ONE, *TERMS[term].shape(self.robot)))
        run = looped(self.robot, term, inputs, out)
        run(1)
        if not np.array_equal(out, self.right(term, True)):
            raise DualpinError("our loop of machine code gives something else than our calls")
        return run

    def right(self, term: str, one: bool) -> np.ndarray:
        """By the public function on all states at once, or by single calls."""
        f, inputs = self.robot.kernel(term), self.inputs(term)
        return np.array([f(*(x[i] for x in inputs)) for i in range(ONE)]) if one else f(*inputs)


def _beside(name: str, folder: Path, ours: Ours, terms: Sequence[str], repetitions: int) -> list[dict[str, Any]]:
    """The rows of one peer and robot."""
    try:
        peer = Process(name, folder)
    except AbsentError as e:
        return [{"peer": name, "skipped": str(e)}]
    if peer.gravity is not None:
        ours = Ours(ours.robot.with_gravity(peer.gravity), ours.batch)
    rows: list[dict[str, Any]] = []
    try:
        for term in terms:
            for one in (False, True):
                row = {"peer": name, "version": peer.version, "term": term, "batch": 1 if one else ours.batch}
                if term not in peer.terms:
                    rows.append({**row, "skipped": "not offered"})
                    continue
                try:
                    rows.append(row | _measured(peer, ours, term, one, repetitions))
                except DualpinError as e:
                    rows.append({**row, "skipped": str(e)})
    finally:
        peer.close()
    return rows


def _measured(peer: Process, ours: Ours, term: str, one: bool, repetitions: int) -> dict[str, Any]:
    _check(peer, ours, term, one)
    call, samples, _ = ours.call(term, one)
    how = peer.terms[term]["one" if one else "many"]
    calls = {"": call}
    if one and not how.startswith("Python"):  # like for like: single calls without Python on both sides
        calls["loop_"] = ours.looped(term)
    runs = max(1, round(SECONDS / peer.seconds(term, one)))
    times: dict[str, list[float]] = {name: [] for name in (*calls, "peer_")}
    for _ in range(repetitions):
        for name, f in calls.items():
            times[name].append(min(alternating([f], 1, SECONDS)[0]) / samples)
        times["peer_"].append(peer.time(term, one, runs))
    _check(peer, ours, term, one)
    row: dict[str, Any] = {"how": how}
    for name, found in times.items():
        row[f"{name}us"] = round(1e6 * statistics.median(found), 5)
        row[f"{name}spread"] = [round(1e6 * min(found), 5), round(1e6 * max(found), 5)]
    return row | {f"{name}ratio": round(row["peer_us"] / row[f"{name}us"], 2) for name in calls}


class DifferenceError(DualpinError):
    """A peer's result is another than dualpin's: it is no cell to time, and no refusal."""


def _check(peer: Process, ours: Ours, term: str, one: bool) -> None:
    """Raise DifferenceError if the two results differ."""
    theirs, right = peer.check(term, one), ours.right(term, one)
    right = right[: len(theirs)]
    if theirs.shape != right.shape:
        raise DifferenceError(f"it gives {theirs.shape} where {right.shape} was expected")
    bound = AGREEMENT
    if term in ("aba", "minv"):
        M = ours.right("crba", True)
        bound *= max(1.0, float(np.linalg.cond(M).max()) / 1e5)
    error = float(np.abs(theirs - right).max() / max(1.0, np.abs(right).max()))
    if not error <= bound:
        raise DifferenceError(f"it differs by {error:.2g} (scaled)")
