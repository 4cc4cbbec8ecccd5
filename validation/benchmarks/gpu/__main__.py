"""Check and measure GPU kernels:  python -m validation.benchmarks.gpu [--only SECTION ...] [--out FOLDER]

Writes results.json and results.md.  Without a device it says so and writes nothing.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from typing import Any

import dualpin
from dualpin.engine import cuda
from dualpin.engine.cuda import driver
from dualpin.errors import DeviceError

from . import correctness, peers, throughput
from .page import markdown

SECTIONS = ("throughput", "columns", "peers", "correctness")


def shown(row: dict[str, Any]) -> None:
    print(" ".join(f"{k}={v:.4g}" if isinstance(v, float) else f"{k}={v}" for k, v in row.items()), file=sys.stderr)


def about() -> dict[str, Any]:
    """What the figures depend on."""
    where = cuda.device()
    return {
        "device": where.name, "multiprocessors": where.multiprocessors, "driver": driver.version(),
        "bytes_per_second": throughput.copy_rate(), "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}", "python": platform.python_version(),
        **{p: metadata.version(p) for p in ("numpy", "llvmlite")}, "dualpin": dualpin.__version__,
    }  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m validation.benchmarks.gpu")
    parser.add_argument(
        "--only", nargs="*", default=SECTIONS, choices=SECTIONS, metavar="SECTION", help=", ".join(SECTIONS)
    )
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    parser.add_argument("--grid", default="", help="folder with ROBOT/grid.cuh, made by GRiD's generator")
    parser.add_argument("--states", type=int, default=correctness.STATES)
    args = parser.parse_args()
    try:
        machine = about()
    except DeviceError as e:
        print(f"nothing measured: {e}", file=sys.stderr)
        return 2
    command = "python -m validation.benchmarks.gpu " + " ".join(sys.argv[1:])
    path = args.out / "results.json"
    results = json.loads(path.read_text()) if path.exists() else {}
    if results.get("machine", {}).get("device") != machine["device"]:
        results = {}  # figures of another device are not mixed with these
    results |= {"machine": machine, "command": command.strip()}
    today = datetime.now(timezone.utc).strftime("%Y-%m-%d")
    for section in SECTIONS:
        if section not in args.only:
            continue
        start = time.perf_counter()
        if section == "throughput":
            results[section] = throughput.run(progress=shown)
        elif section == "columns":
            results[section] = throughput.columns(progress=shown)
        elif section == "peers":
            results[section] = peers.run(grid=args.grid, progress=shown)
        else:
            results[section] = correctness.run(args.states, progress=shown)
        results["dates"] = results.get("dates", {}) | {section: today}
        print(f"{section}: {time.perf_counter() - start:.0f} s", file=sys.stderr)
        args.out.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(results, indent=1) + "\n")
        (args.out / "results.md").write_text(markdown(results))
    wrong = [r for r in results.get("correctness", []) if not correctness.passed(r)]
    wrong += [r for name in ("throughput", "columns") for r in results.get(name, []) if not r.get("equal", True)]
    for row in wrong:
        print("wrong:", end=" ", file=sys.stderr)
        shown(row)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
