"""Every robot of example-robot-data against Pinocchio; run with ``make campaign``.

Writes results/report.md and results/report.json.  The committed JSON leaves out the states of the worst
samples: ``dualpin validate ROBOT --samples 100 --json`` with the same seed has them.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from dualpin.crosscheck import Report
from dualpin.crosscheck.campaign import all_cases, campaign

RESULTS = Path(__file__).parent / "results"
KEPT = ("sample", "ratio", "where", "against_50_digits")


def shortened(report: Report) -> Report:
    """The report without the states of its worst samples."""
    for robot in report.robots:
        for term in robot.terms.values():
            term.worst = {key: term.worst[key] for key in KEPT if key in term.worst}
            term.quantiles = []
    return report


def main() -> int:
    report = campaign(
        all_cases(), samples=100, seed=0, engine="numpy", arbitrate=True, jobs=os.cpu_count() or 1, folder=RESULTS,
        progress=lambda result, done, total: print(f"{done}/{total} {result.name}", file=sys.stderr),
    )  # fmt: skip
    shortened(report).write(RESULTS, ("json", "md"))
    return 0 if report.passed else 1


if __name__ == "__main__":
    sys.exit(main())
