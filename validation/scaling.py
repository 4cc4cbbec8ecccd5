"""How campaigns scale: ``python -m validation.scaling`` (some 8 min alone; writes validation/scaling.json).

Three figures decide what a campaign costs: a unit's own time, what one worker adds to it (its process,
transport, kernels from the cache), and what the parent needs for each unit, which no worker shares.
"""

from __future__ import annotations

import json
import os
import platform
import time
from concurrent.futures import Executor, Future
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dualpin.crosscheck import units
from dualpin.crosscheck.campaign import campaign
from dualpin.crosscheck.checks import Case
from dualpin.machine import versions

ROBOTS = ("ur5", "panda", "solo12", "talos")
UNITS_EACH = 2
SHORT = 1000
"""Units of one sample, for what is not computing."""
CORES, MANY_ROBOTS, MANY_SAMPLES = 1000, 10_000, 1_000_000
PATH = Path(__file__).parent / "scaling.json"


class Ready(Executor):
    """Answers every unit with the same result at once: what is left is the parent's own work."""

    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(self.answer)
        return future


def timed(cases: list[Case], samples: int, **how: Any) -> dict[str, float]:
    """Wall time, the sum of the units' own times, and how many there were."""
    own: list[float] = []
    last: list[Any] = []

    def progress(result: Any, done: int, of: int) -> None:
        own.append(result.seconds)
        last[:] = [result]

    with TemporaryDirectory() as folder:
        start = time.perf_counter()
        campaign(cases, samples, 0, progress=progress, store=Path(folder) / "s.sqlite", **how)
        wall = time.perf_counter() - start
    return {"wall": wall, "own": sum(own), "units": len(own), "answer": last[0]}


def main() -> None:
    whole, cases = units.SLICE, [Case(name) for name in ROBOTS]
    found: dict[str, Any] = {"machine": {"cores": os.cpu_count(), "processor": platform.processor()}}
    found["versions"] = {k: v for k, v in versions().items() if k != "machine"}
    timed(cases, 1000)  # kernels are in the cache from now on
    for jobs in (1, 2):
        run = timed(cases, UNITS_EACH * whole, jobs=jobs)
        found[f"units_{jobs}"] = {
            "workers": jobs, "units": run["units"], "samples": run["units"] * whole, "seconds": run["wall"],
            "samples_per_second": run["units"] * whole / run["wall"], "own_seconds_a_unit": run["own"] / run["units"],
            "added_seconds_a_unit": (run["wall"] * jobs - run["own"]) / run["units"],
        }  # fmt: skip
    units.SLICE = 1
    for jobs in (1, 2):
        run = timed(cases[:1], SHORT, jobs=jobs)
        found[f"short_{jobs}"] = {"added_seconds_a_unit": (run["wall"] * jobs - run["own"]) / run["units"]}
    answer = run["answer"]
    run = timed(cases[:1], SHORT, executor=Ready(answer))
    found["parent_seconds_a_unit"] = run["wall"] / run["units"]
    units.SLICE = whole
    one = found["units_1"]
    n = MANY_ROBOTS * MANY_SAMPLES // whole
    busy = one["own_seconds_a_unit"] + found["short_2"]["added_seconds_a_unit"]
    found["estimate"] = {
        "units": n, "cores": CORES, "core_hours": n * busy / 3600, "hours_by_workers": n * busy / CORES / 3600,
        "hours_by_parent": n * found["parent_seconds_a_unit"] / 3600,
        "speedup_with_2": found["units_2"]["samples_per_second"] / one["samples_per_second"],
    }  # fmt: skip
    PATH.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
