"""Units of work: a robot, a slice of its samples, and everything that the result depends on."""

from __future__ import annotations

import hashlib
import json
import secrets
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..engine.jit.fingerprint import robot_key
from ..errors import DualpinError
from ..io.catalogue import find
from ..machine import sources, versions
from ..model.robot import Robot
from .checks import Case, Check, chosen
from .results import Refusal, RobotResult

SLICE = 10_000
"""Samples of a unit, at most: some seconds of an arm, and 100 MB of its largest term."""

Result = RobotResult | Refusal


@dataclass(frozen=True)
class Settings:
    """What all units of a campaign share."""

    samples: int
    seed: int
    terms: tuple[str, ...]
    engine: str = "auto"
    arbitrate: bool = False

    @property
    def checks(self) -> list[Check]:
        return chosen(self.terms)

    @property
    def identity(self) -> str:
        """The settings and versions that decide results, as JSON: not the date, nor on which machine."""
        made_with = {k: v for k, v in versions(sources=sources()).items() if k not in ("date", "machine")}
        return json.dumps({**asdict(self), "made_with": made_with}, sort_keys=True)


@dataclass(frozen=True)
class Unit:
    """A slice of the samples of a case.

    Attributes
    ----------
    first : int
        The number of its first sample among those of the case.
    key : str
        Its identity: of the robot itself, not only of its name.
    """

    case: Case
    first: int
    samples: int
    seed: int
    key: str


def slices(case: Case, samples: int, seed: int) -> list[Unit]:
    """The units of a case.  The first one's seed is the case's, so that few samples are one plain validation."""
    name = "|".join(
        [case.name, str(case.floating), str(case.mimic), case.engine, case.against or "", case.oracle, identity(case)]
    )
    return [
        Unit(
            case, first, min(SLICE, samples - first), seed if first == 0 else _seed(seed, first // SLICE),
            f"{name}|{first}",
        )
        for first in range(0, samples, SLICE)
    ]  # fmt: skip


def _seed(seed: int, part: int) -> int:
    return int(np.random.SeedSequence([seed, part]).generate_state(1, np.uint64)[0])


def largest_first(units: Iterable[Unit]) -> list[Unit]:
    """Large files are large robots: they begin first, so that none is left to one process at the end."""
    return sorted(units, key=lambda u: _size(u.case), reverse=True)


def _size(case: Case) -> int:
    """Of the file, in bytes."""
    try:
        return find(str(case.robot)).stat().st_size
    except (DualpinError, OSError):
        return 0


def identity(case: Case) -> str:
    """A hash of the robot: of its file's bytes, or of its constants where it was built in code."""
    total = hashlib.sha256()
    for robot in (case.robot, case.against):
        if isinstance(robot, Robot):
            # with joint models from elsewhere it is never the same again
            total.update((robot_key(robot) or secrets.token_hex(8)).encode())
        elif robot is not None:
            total.update(_content(str(robot)))
    return total.hexdigest()[:16]


def _content(name: str) -> bytes:
    try:
        return find(name).read_bytes()
    except (DualpinError, OSError):
        return name.encode(errors="replace")  # refused later, with the reason


def packed(result: Result) -> dict[str, Any]:
    return {"kind": type(result).__name__, "data": asdict(result)}


def unpacked(entry: dict[str, Any]) -> Result:
    return Refusal(**entry["data"]) if entry["kind"] == "Refusal" else RobotResult.from_dict(entry["data"])
