"""Measure beside every peer that is installed:  python -m validation.benchmarks.peers [--robots ...] [--peers ...]

Adds this processor's rows of today to results.json, which keeps those of other processors and days, and writes
results.md.  Both are written after each robot and peer; a run that was interrupted, or ended after --minutes, goes on
where it was (--again measures anew).
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
    parser.add_argument("--minutes", type=float, default=8.0, help="after which no further peer is begun")
    parser.add_argument("--again", action="store_true", help="also what was measured today")
    given = parser.parse_args()
    warnings.simplefilter("ignore", dp.DualpinWarning)
    end = time.monotonic() + 60 * given.minutes
    asked = [(robot, peer) for robot in given.robots for peer in given.peers]
    left = asked if given.again else [x for x in asked if x not in measured(opened()[0])]
    for k, (robot, peer) in enumerate(left):
        if time.monotonic() > end:
            print(f"{len(left) - k} of {len(asked)} robots and peers are left: run it again to go on", file=sys.stderr)
            break
        print(f"[{k + 1}/{len(left)}] {robot} beside {peer}", file=sys.stderr, flush=True)
        start = time.perf_counter()
        rows = peers.run([robot], [peer], repetitions=given.repetitions, progress=shown)
        new, others = opened()
        new["rows"] = [r for r in new["rows"] if (r["robot"], r["peer"]) != (robot, peer)] + [
            {**r, "repetitions": given.repetitions} for r in rows
        ]
        new["loads"] = [*new["loads"], round(os.getloadavg()[0], 2)]
        new["seconds"] = round(new["seconds"] + time.perf_counter() - start)
        write_text(HERE / "results.json", json.dumps([new, *others], indent=1) + "\n")
        write_text(HERE / "results.md", markdown([new, *others]))


def opened() -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """This processor's run of today, begun if there is none, and all others."""
    path, machine = HERE / "results.json", bench.machine()
    runs = json.loads(path.read_text()) if path.exists() else []
    today = {"processor": machine["processor"], "date": versions()["date"]}
    mine = [r for r in runs if {key: r.get(key) for key in today} == today]
    others = [r for r in runs if r not in mine]
    return mine[0] if mine else {**today, "machine": machine, "loads": [], "seconds": 0, "rows": []}, others


def measured(run: dict[str, Any]) -> set[tuple[str, str]]:
    """Robots and peers of which there are rows."""
    return {(r["robot"], r["peer"]) for r in run["rows"] if "term" in r and "repetitions" in r}


if __name__ == "__main__":
    main()
