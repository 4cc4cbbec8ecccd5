"""What releases of libraries changed: `python -m validation.referee.history`.

Each case is a robot, a subject, and two of its versions.  Both are judged, and `dualpin report --compare` says what
changed.  Writes a folder a case with both reports, and README.md with what the comparisons say.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import dualpin as dp
from dualpin.crosscheck.subjects import environments
from dualpin.report import compare

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Case:
    """A robot, a subject with an option, two versions, and what is known of them."""

    robot: str
    subject: str
    option: str
    old: str
    new: str
    says: str


CASES = (
    Case(
        "rotated_inertia", "mujoco", "clean", "3.12.0", "4.0.0",
        "A diagonal `<inertia>` in axes that `rpy` of `<inertial>` turns: 3.12.0 loses the turn, 4.0.0 keeps it.",
    ),
)  # fmt: skip


def main() -> int:
    lines = [
        "# What releases changed",
        "",
        "`python -m validation.referee.history` judges two versions and compares them.",
    ]
    for case in CASES:
        reports = []
        for version in (case.old, case.new):
            environments.install(f"{case.subject}=={version}", lambda what: print(what, file=sys.stderr))
            of = f"{case.subject}=={version}:{case.option}"
            report = dp.judge(HERE / f"{case.robot}.urdf", of)
            report.robots[0].name = case.robot  # where it lies is of this machine
            reports.append(report)
            (HERE / f"{case.name.rsplit('-', 2)[0]}-{version}.json").write_text(
                report.to_json() + "\n", encoding="utf-8"
            )
        lines += ["", f"## {case.robot}: {case.subject} {case.old} and {case.new}", "", case.says, ""]
        for version, report in zip((case.old, case.new), reports, strict=True):
            found = "; ".join(f"`{f.key}`: {f}" for f in report.findings) or "nothing found"
            lines.append(f"- {case.subject} {version}: {found}")
        lines += [
            "",
            "`dualpin report --compare` of the two:",
            "",
            "| what | where | before | after |",
            "|---|---|---|---|",
        ]
        lines += [f"| {c.what} | {c.where} | {c.old} | {c.new} |" for c in compare(*reports).changes]
    (HERE / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
