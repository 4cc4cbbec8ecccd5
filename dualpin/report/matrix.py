"""A validation as a matrix of robots and terms, and the details of every robot."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite, log10
from typing import Any

from ..crosscheck.findings import Finding
from ..crosscheck.results import DIFFERS, NOT_COMPARED, Report, RobotResult, TermResult
from . import paged
from .chart import Strips

SHADES = 5
"""Shades of a passed cell: an error under 1e-4 of its tolerance is the lightest, over 1e-1 the darkest."""

LIMITS = (
    "States are drawn at random within the limits of the joints (anywhere, where limits leave no room); "
    "behaviour outside them is not looked at.",
    "Terms that belong to a frame are compared at up to three frames a robot: the last, one with the longest path "
    "to it, and a random one.",
    "Where the mass matrix is singular to working precision, forward dynamics and its inverse have no digits to "
    "compare; such samples are counted in the remark of the term.",
    "Agreement of two libraries on a URDF says that both read and compute the same; it does not say that the URDF "
    "describes the robot on your table.",
)


@dataclass
class Cell:
    """One term of one robot, as it is shown."""

    term: str
    result: TermResult | None
    href: str

    @property
    def ratio(self) -> float | None:
        """Error over tolerance at the worst sample."""
        t = self.result
        if t is None or not t.compared:
            return None
        ratio = t.worst.get("ratio")
        if ratio is None:
            ratio = t.max_scaled_error / t.tolerance if t.tolerance else None
        return ratio

    @property
    def shade(self) -> str:
        """The class of its colour."""
        if self.result is None or not self.result.compared:
            return "none"
        if not self.result.passed:
            return "bad"
        return "other" if self.result.status == DIFFERS else f"k{shade(self.ratio)}"

    @property
    def text(self) -> str:
        if self.shade == "none" or self.result is None:
            return "–"
        return short(self.result.max_scaled_error)

    @property
    def hover(self) -> str:
        t = self.result
        if t is None or not t.compared:
            why = t.remark if t else ""
            return f"{self.term}: not compared" + (f": {why}" if why else "")
        part = f"{self.ratio:.2g} of the tolerance {t.tolerance:.1e}" if self.ratio is not None else ""
        where = t.worst.get("where", "")
        verdict = f"{t.verdict}: {t.remark}\n" if t.status == DIFFERS else ""
        return f"{self.term}: {verdict}{number(t.max_scaled_error)}, {part}" + (f"\nat {where}" if where else "")

    @property
    def box(self) -> dict[str, float] | None:
        """The quantiles over samples, placed on an axis from 1e-18 to 1e-10 that is 100 wide."""
        t = self.result
        if t is None or len(t.quantiles) != 6 or not all(isinstance(x, (int, float)) for x in t.quantiles):
            return None
        at = [round(100 * (min(max(log10(x), -18.0), -10.0) + 18) / 8, 1) if x > 0 else 0.0 for x in t.quantiles]
        bound = round(100 * (min(max(log10(t.tolerance), -18.0), -10.0) + 18) / 8, 1) if t.tolerance else 100.0
        return dict(zip(("p5", "p25", "p50", "p75", "p95", "most"), at, strict=True)) | {"bound": bound}


@dataclass
class State:
    """A worst sample, to copy, and the terms that are worst there."""

    sample: int
    terms: list[str]
    q: list[float]
    v: list[float]
    a: list[float]

    @property
    def python(self) -> str:
        return "\n".join(f"{name} = {values!r}" for name, values in (("q", self.q), ("v", self.v), ("a", self.a)))


@dataclass
class RobotView:
    """One robot (on one base) as it is shown."""

    number: int
    result: RobotResult
    terms: list[str]

    @property
    def id(self) -> str:
        return f"r{self.number}"

    @property
    def base(self) -> str:
        return "mimic" if self.result.mimic else "floating" if self.result.floating else "fixed"

    @property
    def mark(self) -> str:
        """A sign for the verdict: a tick only where everything that was compared agrees."""
        if not self.result.passed:
            return "✗"
        return {NOT_COMPARED: "–", DIFFERS: "≠"}.get(self.result.status, "✓")

    @cached_property
    def cells(self) -> list[Cell]:
        return [Cell(t, self.result.terms.get(t), f"#{self.id}") for t in self.terms]

    @cached_property
    def worst(self) -> Cell | None:
        """The cell nearest to its tolerance."""
        compared = [c for c in self.cells if c.ratio is not None]
        return max(compared, key=lambda c: c.ratio or 0.0, default=None)

    @cached_property
    def ratio(self) -> float:
        return (self.worst.ratio or 0.0) if self.worst else 0.0

    @property
    def findings(self) -> list[Finding]:
        return self.result.findings

    @property
    def programs(self) -> list[tuple[str, str]]:
        """For each term that differs: lines that show it again."""
        terms = self.result.terms.items()
        return [(name, t.worst["reproduce"]) for name, t in terms if t.worst.get("reproduce")]

    @property
    def reasons(self) -> list[str]:
        return list(dict.fromkeys(t.tolerance_reason for t in self.result.terms.values() if t.tolerance_reason))

    @property
    def states(self) -> list[State]:
        found: dict[int, State] = {}
        for name, t in self.result.terms.items():
            if "q" in t.worst:
                w = t.worst
                state = found.setdefault(w["sample"], State(w["sample"], [], w["q"], w["v"], w["a"]))
                state.terms.append(name)
        return [found[k] for k in sorted(found)]

    @property
    def command(self) -> str:
        """The command that does this again."""
        r = self.result
        options = (" --floating" if r.floating else "") + (" --mimic" if r.mimic else "")
        if r.subject:
            return f"dualpin judge {r.name} {r.subject} --samples {r.samples} --seed {r.seed}{options}"
        return f"dualpin validate {r.name} --samples {r.samples} --seed {r.seed}{options}"


@dataclass
class Matrix:
    """The whole validation as it is shown."""

    report: Report
    terms: list[str] = field(init=False)
    robots: list[RobotView] = field(init=False)
    many: bool = field(init=False)
    shown: list[RobotView] = field(init=False)

    def __post_init__(self) -> None:
        self.terms = list(dict.fromkeys(t for r in self.report.robots for t in r.terms))
        self.robots = [RobotView(k, r, self.terms) for k, r in enumerate(self.report.robots)]
        self.many = len(self.robots) > paged.MANY
        self.shown = paged.worst(self.robots) if self.many else self.robots

    limits = LIMITS

    @property
    def rows(self) -> list[list[Any]]:
        """Of all robots, for a table that is drawn a page at a time."""
        return paged.rows(self.robots, self.shown)

    @property
    def subjects(self) -> list[str]:
        """The subject whose answers are compared; empty in a validation."""
        return list(dict.fromkeys(r.result.subject for r in self.robots if r.result.subject))

    @property
    def against(self) -> str:
        """What dualpin is compared with."""
        judged = {r.result.subject: r.result.subject_version for r in self.robots if r.result.subject}
        found = ", ".join(f"{name} {version}".strip() for name, version in judged.items())
        return found or f"Pinocchio {self.report.versions.get('pinocchio', '')}".strip()

    @property
    def verdict(self) -> str:
        return self.report.verdict

    @property
    def failed(self) -> list[RobotView]:
        return [r for r in self.robots if not r.result.passed]

    @property
    def incomplete(self) -> list[RobotView]:
        """Robots that passed and yet do not agree in every term."""
        return [r for r in self.robots if r.result.passed and r.result.remark]

    @property
    def names(self) -> int:
        """How many different robots there are, whatever base they stand on."""
        return len({r.result.name for r in self.robots})

    @property
    def settings(self) -> list[str]:
        return sorted({f"{r.samples} samples, seed {r.seed}" for r in self.report.robots})

    @property
    def comparisons(self) -> int:
        return sum(t.compared for r in self.report.robots for t in r.terms.values())

    @property
    def worst(self) -> RobotView | None:
        """The robot nearest to a tolerance."""
        return max(self.robots, key=lambda r: r.ratio, default=None)

    @property
    def bases(self) -> list[str]:
        return [b for b in ("fixed", "floating", "mimic") if any(r.base == b for r in self.robots)]

    def worst_of(self, term: str) -> tuple[RobotView, Cell] | None:
        """The robot with the largest error of a term, and its cell."""
        return max(self._having(term), key=lambda rc: _number(rc[1]), default=None)

    def _having(self, term: str) -> Iterator[tuple[RobotView, Cell]]:
        k = self.terms.index(term)
        return ((r, r.cells[k]) for r in self.robots if r.cells[k].ratio is not None)

    @property
    def columns(self) -> list[tuple[str, int, RobotView, Cell]]:
        """For each term: how many robots, and which is worst."""
        found = []
        for term in self.terms:
            worst = self.worst_of(term)
            if worst:
                found.append((term, sum(1 for _ in self._having(term)), *worst))
        return found

    def strips(self) -> Strips:
        """Error over tolerance of every robot, a row a term."""
        rows = []
        for term in self.terms:
            having = paged.thinned(list(self._having(term)))
            points = [(c.ratio or 0.0, f"{r.result.label}\n{c.hover}", c.shade == "bad") for r, c in having]
            rows.append((term, points))
        return Strips(
            "Largest error of every robot, relative to its tolerance", "error / tolerance", rows, 1e-5, 10.0,
            note="One dot is one robot on one base; left of the line is within tolerance. "
            "Dots at the left edge are at or below 1e-5.",
        )  # fmt: skip


def shade(ratio: float | None) -> int:
    """Which of the shades an error over tolerance has."""
    if not ratio:
        return 0
    return int(min(SHADES - 1, max(0, log10(ratio) + SHADES)))


def short(x: float | None) -> str:
    """An error in few characters, enough for its order of magnitude."""
    if x is None or not isfinite(x) or x > 1e300:
        return "inf"
    if x == 0:
        return "0"
    mantissa, exponent = f"{x:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def number(x: Any) -> str:
    """A number for a table."""
    if x is None:
        return "–"
    if isinstance(x, bool):
        return "yes" if x else "no"
    if isinstance(x, int):
        return str(x)
    if isinstance(x, float):
        return "inf" if x > 1e300 else f"{x:.1e}" if x and (abs(x) < 1e-3 or abs(x) >= 1e6) else f"{x:.4g}"
    return str(x)


def _number(cell: Cell) -> float:
    return (cell.result.max_scaled_error or 0.0) if cell.result else 0.0
