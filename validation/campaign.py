"""Every robot of example-robot-data against Pinocchio; run with ``make campaign``.

Writes results/report.md and results/report.json.  All robots are computed by compiled kernels, every eighth by
NumPy too.  With ``--also FOLDER`` (the robots of another release of the package, say) files of that
folder that are not, byte for byte, among the installed ones are validated as well.  The committed JSON leaves
out the states of the worst samples: ``dualpin validate ROBOT --samples 100 --json`` with the same seed has them.
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path

from dualpin.crosscheck import Report
from dualpin.crosscheck.campaign import all_cases, campaign
from dualpin.crosscheck.checks import Case
from dualpin.io.catalogue import catalogue

RESULTS = Path(__file__).parent / "results"
KEPT = ("sample", "ratio", "where", "against_50_digits")
NUMPY = 8
"""Which robots NumPy computes too: one in so many."""


def shortened(report: Report) -> Report:
    """The report without the states of its worst samples, and times that are new in every run."""
    for robot in report.robots:
        robot.seconds = 0.0
        for term in robot.terms.values():
            term.worst = {key: term.worst[key] for key in KEPT if key in term.worst}
            term.quantiles = []
    return report


def new_files(folder: Path) -> list[Case]:
    """The URDF files of a folder whose bytes are not those of an installed one, fixed and floating."""
    known = {path.read_bytes() for path in catalogue().values()}
    files = [path for path in sorted(folder.rglob("*.urdf")) if path.read_bytes() not in known]
    return [
        Case(str(path), floating, title=f"{folder.name}: {path.stem}") for path in files for floating in (False, True)
    ]


def figures(report: Report) -> str:
    """What the README quotes: the worst error of each term, and who was nearer where 50 digits were asked."""
    worst: dict[str, float] = {}
    asked: list[dict[str, float]] = []
    for robot in report.robots:
        for name, term in robot.terms.items():
            if term.compared:
                worst[name] = max(worst.get(name, 0.0), term.max_scaled_error)
            asked += [term.worst["against_50_digits"]] if "against_50_digits" in term.worst else []
    lines = [f"{name}: {error:.1e}" for name, error in worst.items()]
    ratios = sorted(x["oracle"] / max(x["dualpin"], 1e-20) for x in asked)
    if ratios:
        share = sum(r > 1 for r in ratios) / len(ratios)
        lines.append(
            f"50 digits were asked {len(ratios)} times: dualpin nearer in {share:.0%}, in the median by a factor of "
            f"{ratios[len(ratios) // 2]:.3g}"
        )
    return "\n".join([report.summary, *lines])


def main() -> int:
    parser = argparse.ArgumentParser(description="Validate every robot and write validation/results.")
    parser.add_argument("--also", type=Path, help="a folder with more URDF files")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    arguments = parser.parse_args()
    cases = all_cases()
    if arguments.also:
        cases += new_files(arguments.also)
    cases += [replace(case, engine="numpy") for case in cases[::NUMPY]]
    report = campaign(
        cases, samples=100, seed=0, engine="compiled", arbitrate=True, jobs=arguments.jobs, folder=RESULTS,
        progress=lambda result, done, total: print(f"{done}/{total} {result.name}", file=sys.stderr),
    )  # fmt: skip
    shortened(report).write(RESULTS, ("json", "md"))
    print(figures(report))
    return 0 if report.passed else 1


if __name__ == "__main__":
    sys.exit(main())
