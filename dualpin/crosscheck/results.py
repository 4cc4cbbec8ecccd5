"""What a comparison found, and how it is written down."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from typing import Any

from ..errors import ArgumentError, nearest


@dataclass
class TermResult:
    """One term of one robot.

    ``max_scaled_error`` is the largest of max|x - ref| / max(1, max|ref|) over the samples;
    ``tolerance`` the bound at the sample that comes nearest to its own; ``worst`` that sample, with the
    place of the worst entry in words. ``quantiles`` are scaled errors that 5, 25, 50, 75 and 95 % of
    the samples stay below, and the largest.
    """

    max_scaled_error: float
    tolerance: float
    passed: bool
    reason: str = ""
    oracle: str = "Pinocchio"
    compared: int = 0
    note: str = ""
    worst: dict[str, Any] = field(default_factory=dict)
    quantiles: list[float] = field(default_factory=list)

    @property
    def remark(self) -> str:
        """What could not be compared, and who is nearer the truth where that was asked."""
        exact = self.worst.get("against_50_digits")
        nearer = (
            f"off 50 digits by: dualpin {exact['dualpin']:.1e}, {self.oracle} {exact['oracle']:.1e}" if exact else ""
        )
        return "; ".join(x for x in (self.note, nearer) if x)


@dataclass
class RobotResult:
    """All terms of one robot, or why there are none."""

    name: str
    floating: bool
    mimic: bool
    nv: int
    samples: int
    seed: int
    passed: bool
    terms: dict[str, TermResult] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    error: str = ""
    seconds: float = 0.0

    @property
    def label(self) -> str:
        return self.name + (" floating" if self.floating else "") + (" mimic" if self.mimic else "")

    @property
    def worst_error(self) -> float:
        return max((t.max_scaled_error for t in self.terms.values()), default=float("nan"))


@dataclass
class Refusal:
    """A file that did not become a robot."""

    name: str
    reason: str
    by_pinocchio: bool


@dataclass
class Report:
    """The outcome of a validation.

    Examples
    --------
    >>> import dualpin as dp
    >>> report = dp.validate("ur5", samples=5, seed=0)
    >>> report.passed, report.terms["rnea"].max_scaled_error < 1e-13
    (True, True)
    """

    robots: list[RobotResult] = field(default_factory=list)
    refused: list[Refusal] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=dict)
    partial: bool = False

    @property
    def passed(self) -> bool:
        """Whether there are robots, all passed, no file was refused by dualpin alone, and nothing is missing."""
        return (
            not self.partial
            and all(r.passed for r in self.robots)
            and all(r.by_pinocchio for r in self.refused)
            and bool(self.robots)
        )

    @property
    def terms(self) -> dict[str, TermResult]:
        """The terms of the only robot; see `robots` where there are several."""
        if len(self.robots) != 1:
            raise ArgumentError(
                f"the report holds {len(self.robots)} robots; report.robots[i].terms has the terms of one"
            )
        return self.robots[0].terms

    # writing

    def to_dict(self) -> dict[str, Any]:
        return {
            "passed": self.passed,
            "partial": self.partial,
            "robots": [asdict(r) for r in self.robots],
            "refused": [asdict(r) for r in self.refused],
            "versions": self.versions,
        }

    def to_json(self) -> str:
        """One JSON document; not-a-number and infinities are written as null and a large number."""
        return json.dumps(_finite(self.to_dict()), indent=1)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Report:
        robots = []
        for r in data["robots"]:
            terms = {k: TermResult(**t) for k, t in r["terms"].items()}
            robots.append(RobotResult(**{**r, "terms": terms}))
        refused = [Refusal(**r) for r in data["refused"]]
        return cls(robots, refused, data["versions"], data.get("partial", False))

    def to_markdown(self) -> str:
        from .markdown import markdown

        return markdown(self)

    def write(self, folder: str | Path, formats: Iterable[str] = ("json", "md")) -> list[Path]:
        """Write report.json, report.md, ... into a folder; returns the paths."""
        writers = {"json": self.to_json, "md": self.to_markdown, "html": self.to_html}
        folder = Path(folder)
        paths = []
        formats = [formats] if isinstance(formats, str) else list(formats)
        for form in formats:
            if form not in writers:
                raise ArgumentError(f"report format {form!r} is not known; {nearest(form, writers, 'formats')}")
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for form in formats:
                paths.append(folder / f"report.{form}")
                paths[-1].write_text(writers[form](), encoding="utf-8")
        except OSError as e:
            raise ArgumentError(f"report: cannot write into {folder} ({e.strerror or e})") from None
        return paths

    def to_html(self) -> str:
        """One self-contained page; needs Jinja (``pip install 'dualpin[report]'``)."""
        from ..report import page

        return page(self)

    def _repr_html_(self) -> str:
        from ..report.notebook import report_html

        return report_html(self)


def _finite(x: Any) -> Any:
    if isinstance(x, dict):
        return {k: _finite(v) for k, v in x.items()}
    if isinstance(x, list):
        return [_finite(v) for v in x]
    if isinstance(x, float) and x != x:
        return None
    if isinstance(x, float) and abs(x) == float("inf"):
        return 1.7976931348623157e308 if x > 0 else -1.7976931348623157e308
    return x


def versions(**more: str) -> dict[str, str]:
    """Versions of everything that matters to a figure, the machine, and the date."""
    from .. import __version__

    found = {"dualpin": __version__, "python": platform.python_version()}
    for package in ("numpy", "yourdfpy", "lxml", "llvmlite", "example-robot-data"):
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "absent"
    found["machine"] = f"{platform.machine()}, {_cpu()}"
    found["date"] = datetime.now(timezone.utc).strftime("%Y-%m-%d")
    return {**found, **more}


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown processor"
