"""A peer as a process in its environment, with requests as lines of JSON."""

from __future__ import annotations

import importlib.util
import json
import os
import selectors
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..crosscheck.subjects.environments import Environment, literals, requirements
from ..crosscheck.subjects.running import stop
from ..errors import ArgumentError, DualpinError, nearest
from ..model.builder import Builder
from ..model.robot import Robot
from . import apart
from .adapters import FOLDER, NAMES

STARTING, ANSWERING = 900.0, 300.0
"""Seconds that a peer may take to start (Pinocchio's headers compile for minutes) and to answer."""


class AbsentError(DualpinError):
    """A peer that is not installed, does not read the robot, or does not answer."""


def named(name: str) -> Path:
    """The adapter of that name."""
    if name not in NAMES:
        raise ArgumentError(f"bench: peer {name!r} is not known; {nearest(name, NAMES, 'peers', most=99)}")
    return FOLDER / f"{name}.py"


def python(adapter: Path) -> Path:
    """The interpreter that has the library: that of the peer's environment, or this one."""
    said = literals(adapter)
    home = Environment(said.get("ENVIRONMENT") or adapter.stem, adapter, requirements(adapter))
    if home.python.exists():
        return home.python
    module = said.get("MODULE", "")
    if module and importlib.util.find_spec(module) is not None:
        return Path(sys.executable)
    raise AbsentError(
        f"not installed: no {module or 'environment'} here and none in {home.folder}; "
        f"python -m venv {home.folder}, then its pip install {' '.join(home.requires)}"
    )


def write_robot(robot: Robot, folder: Path, states: Mapping[str, np.ndarray]) -> None:
    """Write the files for a peer: the URDF, one without fixed links, the robot as numbers, and the states.

    Raises
    ------
    ArgumentError
        If a joint neither turns nor slides, or follows another.
    """
    if robot.coupled or any(len(b.model.screws) != 1 for b in robot):
        raise ArgumentError(
            f"bench: peers are measured on robots of turning and sliding joints; {robot.name} has others"
        )
    robot.to_urdf(folder / "robot.urdf")  # without meshes and transmissions
    merged(robot).to_urdf(folder / "merged.urdf")
    numbers, kinds = np.zeros((len(robot), 30)), np.zeros(len(robot), np.int32)
    for i, b in enumerate(robot):
        (s,), T, (com, about) = b.model.screws, b.placement.array, b.inertia.central
        turning = [float(x) for x in s.real]
        kinds[i] = 0 if any(turning) else 1
        numbers[i, :3] = turning if any(turning) else [float(x) for x in s.dual]
        numbers[i, 3:15] = [*T[:3, 3], *T[:3, :3].ravel()]
        numbers[i, 15:19] = [float(b.inertia.mass), *(float(x) for x in com)]
        numbers[i, 19:28] = [float(x) for row in about.rows for x in row]
        numbers[i, 28] = float(b.armature[0])
    parents = np.array([-1 if b.parent is None else b.parent.index for b in robot], np.int32)
    gravity = robot.gravity.array
    np.savez(
        folder / "model.npz", kinds=kinds, parents=parents, numbers=numbers, gravity=gravity, names=robot.joint_names
    )
    np.savez(folder / "states.npz", joints=robot.joint_names, **states)  # type: ignore[arg-type]


def merged(robot: Robot) -> Robot:
    """The same dynamics without fixed links: one link a joint, with the inertia of all that moves with it."""
    b = Builder(robot.name, [float(x) for x in robot.gravity])
    for j in robot:
        b.joint(j.name, j.model, j.parent.name if j.parent else None, j.placement, j.inertia, limits=j.limits)
    return b.robot()


class Process:
    """The process of a peer for the robot in a folder."""

    def __init__(self, name: str, folder: Path) -> None:
        adapter = named(name)
        self.folder, self.log = folder, folder / f"{name}.log"
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "XLA_FLAGS": SINGLE_THREAD}
        environment.pop("PYTHONPATH", None)
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(
                [str(python(adapter)), apart.__file__, str(adapter), str(folder)], stdin=subprocess.PIPE,
                stdout=subprocess.PIPE, stderr=log, cwd=folder, env=environment, start_new_session=True,
            )  # fmt: skip
        first = self._answer(STARTING)
        if "refused" in first:
            self.close()
            raise AbsentError(first["refused"])
        self.version, self.terms = first["version"], first["terms"]
        self.gravity: list[float] | None = first["gravity"]

    def _answer(self, limit: float) -> dict[str, Any]:
        pipe = self.process.stdout
        assert pipe is not None
        with selectors.DefaultSelector() as waiting:
            waiting.register(pipe, selectors.EVENT_READ)
            line = pipe.readline() if waiting.select(limit) else b""
        if not line:
            self.close()
            said = self.log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
            raise AbsentError(f"no answer within {limit:g} s or ended: {said[-1][:200] if said else 'it said nothing'}")
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise AbsentError(answer["error"])
        return answer

    def _ask(self, **question: Any) -> dict[str, Any]:
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(json.dumps(question).encode() + b"\n")
            self.process.stdin.flush()
        except (OSError, ValueError):  # ValueError: it was stopped, and its pipe closed
            raise AbsentError("it ended before") from None
        return self._answer(ANSWERING)

    def check(self, term: str, one: bool) -> np.ndarray:
        """Its results."""
        self._ask(do="check", term=term, one=one)
        return np.load(self.folder / "answer.npy")

    def seconds(self, term: str, one: bool) -> float:
        """What one run over the states takes."""
        return max(float(self._ask(do="time", term=term, one=one, times=1)["seconds"]), 1e-7)

    def time(self, term: str, one: bool, times: int) -> float:
        """Seconds a sample, of so many runs."""
        found = self._ask(do="time", term=term, one=one, times=times)
        return float(found["seconds"]) / (times * found["samples"])

    def close(self) -> None:
        stop(self.process)
        if self.process.stdout:
            self.process.stdout.close()


SINGLE_THREAD = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
