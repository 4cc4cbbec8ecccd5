"""Measure beside every peer that is installed:  python -m validation.benchmarks.peers [--robots ...] [--peers ...]

Adds this processor's rows of today to results.json, which keeps those of other processors and days, and writes
results.md.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import dualpin as dp
from dualpin import bench, peers
from dualpin.files import write_text
from dualpin.machine import versions
from validation.benchmarks.peers.table import markdown

HERE = Path(__file__).parent
ROBOTS = ("ur5", "panda", "talos")


def shown(row: dict[str, Any]) -> None:
    what = row.get("skipped") or f"{row['us']:.4g} us, {row['peer_us']:.4g} us, {row['ratio']}"
    print(row["robot"], row["peer"], row.get("term", ""), row.get("batch", ""), what[:100], file=sys.stderr, flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m validation.benchmarks.peers", description=__doc__.partition("\n")[0]
    )
    parser.add_argument("--robots", nargs="*", default=ROBOTS)
    parser.add_argument("--peers", nargs="*", default=peers.NAMES, choices=peers.NAMES)
    parser.add_argument("--repetitions", type=int, default=7)
    given = parser.parse_args()
    warnings.simplefilter("ignore", dp.DualpinWarning)
    start = time.perf_counter()
    rows = peers.run(given.robots, given.peers, repetitions=given.repetitions, progress=shown)
    path = HERE / "results.json"
    runs = json.loads(path.read_text()) if path.exists() else []
    machine = bench.machine()
    today = {"processor": machine["processor"], "date": versions()["date"]}
    kept, replaced = [], {(r["robot"], r["peer"]) for r in rows}
    for run in runs:
        if {key: run[key] for key in today} == today:
            rows += [r for r in run["rows"] if (r["robot"], r["peer"]) not in replaced]
        else:
            kept.append(run)
    new = {
        **today, "machine": machine, "load": [round(x, 2) for x in os.getloadavg()],
        "seconds": round(time.perf_counter() - start), "repetitions": given.repetitions, "rows": rows,
    }  # fmt: skip
    write_text(path, json.dumps([new, *kept], indent=1) + "\n")
    write_text(HERE / "results.md", markdown([new, *kept]))


if __name__ == "__main__":
    main()
