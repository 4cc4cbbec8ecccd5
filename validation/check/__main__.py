"""How often each rule of `dualpin check` finds something; run with ``make faults DIR=...``.

Looks at every URDF below a folder (without a folder: at the robots of example-robot-data, with their meshes), writes
``rates.md`` and every finding as a line of ``findings.jsonl``.  An interrupted run is taken up where it stopped.
``judged.tsv`` beside this file holds a hundred of the findings, judged by hand.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
import warnings
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from dualpin.analysis.check import RULES, check
from dualpin.errors import DualpinError
from dualpin.files import write_text
from dualpin.io.catalogue import catalogue
from dualpin.machine import versions

HERE = Path(__file__).parent
FINDINGS = "findings.jsonl"
FILES = {"missing-mesh", "package-not-found", "mesh-absolute"}
"""Rules about files beside the description, which a collection may be without."""


def looked(name: str, file: str) -> dict[str, Any]:
    """What is found in one file, or why it cannot be read."""
    warnings.simplefilter("ignore")
    start = time.perf_counter()
    try:
        found = check(file)
    except DualpinError as e:
        return {"name": name, "refused": str(e), "seconds": time.perf_counter() - start}
    findings = [{k: x for k, x in f.to_dict().items() if k not in ("file", "fix")} for f in found]
    return {"name": name, "findings": findings, "seconds": time.perf_counter() - start}


def rates(rows: list[dict[str, Any]], what: str) -> str:
    """The table, most frequent first."""
    read = [r for r in rows if "findings" in r]
    files: Counter[str] = Counter()
    count: Counter[str] = Counter()
    for r in read:
        files.update({f["rule"] for f in r["findings"]})
        count.update(f["rule"] for f in r["findings"])
    clean = sum(not r["findings"] for r in read)
    apart = sum(not {f["rule"] for f in r["findings"]} - FILES for r in read)
    seconds = sorted(r["seconds"] for r in rows)
    lines = [
        f"# What `dualpin check` finds in {what}",
        "",
        f"{len(rows)} files: {len(read)} were read, {len(rows) - len(read)} refused; nothing was found in {clean}, "
        f"nothing but meshes that are not there in {apart - clean} more. "
        f"Half of the files take less than {seconds[len(seconds) // 2]:.2g} s, the slowest {seconds[-1]:.2g} s "
        f"(under load). {', '.join(f'{k} {v}' for k, v in versions().items() if k in ('dualpin', 'python', 'numpy'))}.",
        "",
        "| rule | severity | files | of those read | findings |",
        "|---|---|---:|---:|---:|",
    ]
    for rule, n in files.most_common():
        lines.append(f"| `{rule}` | {RULES[rule].severity} | {n} | {n / len(read):.1%} | {count[rule]} |")
    silent = ", ".join(f"`{r}`" for r in RULES if r not in files)
    return "\n".join([*lines, "", f"Found nowhere: {silent}.", ""]) if silent else "\n".join([*lines, ""])


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m validation.check", description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, help="of URDFs; the robots of example-robot-data without it")
    parser.add_argument("--out", type=Path, default=Path("out/check"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args()
    if given.folder is None:
        files, what = {k: str(v) for k, v in catalogue().items()}, "the robots of example-robot-data, which have meshes"
    else:
        found = sorted(p for p in given.folder.rglob("*") if p.suffix.lower() == ".urdf")
        files = {str(p.relative_to(given.folder)): str(p) for p in found}
        what = f"{len(found)} URDF files that others wrote"
    given.out.mkdir(parents=True, exist_ok=True)
    kept = given.out / FINDINGS
    rows = [json.loads(x) for x in kept.read_text(encoding="utf-8").splitlines()] if kept.exists() else []
    done = {r["name"] for r in rows}
    waiting = {k: v for k, v in files.items() if k not in done}
    with ProcessPoolExecutor(given.jobs) as pool, kept.open("a", encoding="utf-8") as out:
        for row in pool.map(looked, waiting, waiting.values()):
            rows.append(row)
            out.write(json.dumps(row) + "\n")
            out.flush()
            if sys.stderr.isatty():
                print(f"\r{len(rows)} of {len(files)}", end="", file=sys.stderr)
    text = rates(rows, what)
    write_text(given.out / "rates.md", text)
    print(text)


if __name__ == "__main__":
    main()
