"""Measure everything that docs/benchmarks.md reports:  python -m validation.benchmarks [--prepare] [--only SECTION ...]

Writes results/PROCESSOR.json and .md, one for each processor, and results.md, their index, after each section and each
robot of the main table, with the date and the commit.  What this commit has measured on this processor is not measured
again (--again: it is), so a run that was interrupted, or ended after --minutes, goes on where it was.  --prepare only
compiles, so that a later run spends its time measuring.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
import warnings
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import dualpin as dp
from dualpin import bench
from dualpin.files import write_text

from .report import index, markdown, named
from .sections import SECTIONS, label, prepare, units

HERE = Path(__file__).parent
RESULTS = HERE / "results"


def commit() -> str:
    """The commit checked out here."""
    done = subprocess.run(
        ["git", "-C", str(HERE), "rev-parse", "--short", "HEAD"], check=False, capture_output=True, text=True
    )
    return done.stdout.strip() if done.returncode == 0 else "unknown"


def part(section: str, unit: str) -> str:
    """The name of a section, or of a unit of it."""
    return f"{section} {unit}".strip()


def opened(machine: dict[str, Any]) -> dict[str, Any]:
    """What is known of this processor."""
    path = RESULTS / f"{named(machine['processor'])}.json"
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {"made": {}}
    return {**found, "machine": machine, "command": "python -m validation.benchmarks"}


def entered(results: dict[str, Any], section: str, unit: str, rows: list[dict[str, Any]]) -> None:
    """Replace the rows of a unit; those of the main table keep the order of the robots."""
    kept = [r for r in results.get(section, []) if unit and label(r) != unit]
    places = {name: k for k, name in enumerate(units(section))}
    results[section] = sorted([*kept, *rows], key=lambda r: places.get(label(r), len(places))) if unit else rows


def written(results: dict[str, Any]) -> None:
    path = RESULTS / f"{named(results['machine']['processor'])}.json"
    write_text(path, json.dumps(results, indent=1) + "\n")
    write_text(path.with_suffix(".md"), markdown(results))
    every = {p.stem: json.loads(p.read_text(encoding="utf-8")) for p in sorted(RESULTS.glob("*.json"))}
    write_text(HERE / "results.md", index(every))


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m validation.benchmarks", description=__doc__.partition("\n")[0])
    parser.add_argument("--prepare", action="store_true", help="compile, measure nothing")
    parser.add_argument("--only", nargs="*", choices=SECTIONS, help="these sections")
    parser.add_argument("--minutes", type=float, default=60.0, help="after which nothing further is begun")
    parser.add_argument("--again", action="store_true", help="also what this commit has measured")
    parser.add_argument("--repetitions", type=int, default=bench.REPETITIONS, help="of each cell of the main table")
    given = parser.parse_args()
    warnings.simplefilter("ignore", dp.DualpinWarning)
    if given.prepare:
        prepare()
        return
    end, now = time.monotonic() + 60 * given.minutes, commit()
    results = opened(bench.machine())
    made = results["made"]
    asked = [(section, unit) for section in given.only or SECTIONS for unit in units(section)]
    left = asked if given.again else [x for x in asked if made.get(part(*x), {}).get("commit") != now]
    for k, (section, unit) in enumerate(left):
        if time.monotonic() > end:
            print(f"{len(left) - k} of {len(asked)} parts are left: run it again to go on", file=sys.stderr)
            break
        print(f"[{k + 1}/{len(left)}] {section} {unit}", file=sys.stderr, flush=True)
        start = time.perf_counter()
        entered(results, section, unit, units(section, given.repetitions)[unit]())
        made[part(section, unit)] = {
            "date": datetime.now(timezone.utc).strftime("%Y-%m-%d"), "commit": now,
            "dualpin": results["machine"]["dualpin"], "load": round(os.getloadavg()[0], 2),
            "seconds": round(time.perf_counter() - start),
        }  # fmt: skip
        written(results)


if __name__ == "__main__":
    main()
