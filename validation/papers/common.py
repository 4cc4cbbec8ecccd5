"""What a paper prints, what is right, what dualpin computes: one row each, and a page of them."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dualpin import Dual
from dualpin.files import write_text

HERE = Path(__file__).parent


def golden() -> dict[str, Any]:
    """The golden values of the tests: 25 digits, from mpmath at 140."""
    return json.loads((HERE.parents[1] / "tests" / "data" / "reference.json").read_text())


def numbers(x: Any) -> Any:
    """Decimal strings as floats, in nested lists."""
    return [numbers(i) for i in x] if isinstance(x, list) else float(x)


def gold(x: Any) -> Dual:
    """{"real": ..., "dual": ...} as a dual array."""
    return Dual(np.array(numbers(x["real"]))[()], np.array(numbers(x["dual"]))[()])


@dataclass(frozen=True)
class Row:
    """One number, formula or claim of a paper.

    `printed` is the paper's, evaluated where it is a formula; `right` an independent value: another derivation,
    a definition, or the golden value; `ours` what dualpin computes.
    """

    where: str
    what: str
    printed: Any
    right: Any
    ours: Any
    erratum: str = ""
    """Number of the misprint (paper.number), empty if the print holds."""
    digits: float = 5e-13
    """Half a unit of the last printed digit, relative to max(1, |right|): how far a right print may be off."""
    tol: float = 1e-12
    """Allowed |ours - right| / max(1, |right|): rounding of a few operations."""
    note: str = ""

    @property
    def difference(self) -> float:
        return distance(self.ours, self.right)

    @property
    def misprint(self) -> float:
        return distance(self.printed, self.right)

    @property
    def ours_right(self) -> bool:
        return self.difference <= self.tol

    @property
    def print_right(self) -> bool:
        return self.printed is None or self.misprint <= self.digits

    @property
    def consistent(self) -> bool:
        """Ours is right, and the print is wrong exactly where an erratum says so."""
        return self.ours_right and self.print_right != bool(self.erratum)

    @property
    def verdict(self) -> str:
        if not self.ours_right:
            return "NOT REPRODUCED"
        if self.printed is None:
            return "measured"
        if self.print_right:
            return "holds" if not self.erratum else f"ERRATUM {self.erratum} NOT SEEN"
        return f"misprint (E {self.erratum})" if self.erratum else "UNEXPLAINED"


@dataclass(frozen=True)
class Claim:
    """A statement of a paper that is no single number: what becomes of it."""

    where: str
    claim: str
    finding: str
    verdict: str
    """"holds", "holds in part", "does not hold", "not reproducible"."""
    erratum: str = ""


@dataclass
class Page:
    """All rows of a paper, and tables of measurements that differ from run to run."""

    name: str
    title: str
    intro: str
    rows: list[Row]
    claims: list[Claim] = field(default_factory=list)
    tables: list[str] = field(default_factory=list)

    @property
    def markdown(self) -> str:
        bad = [r for r in self.rows if not r.consistent]
        lines = [f"# {self.title}", "", self.intro, ""]
        lines += [
            f"{len(self.rows)} values and formulas: {sum(r.verdict == 'holds' for r in self.rows)} hold, "
            f"{sum('misprint' in r.verdict for r in self.rows)} are misprints, "
            f"{sum(r.verdict == 'measured' for r in self.rows)} are measured only, {len(bad)} are open.",
            "",
            "| where | what | printed | corrected | dualpin | difference | verdict |",
            "|---|---|---|---|---|---|---|",
        ]
        for r in self.rows:
            cells = [r.where, r.what, shown(r.printed), shown(r.right), shown(r.ours), f"{r.difference:.1e}"]
            cells = [c.replace("|", "\\|") for c in cells]
            lines.append("| " + " | ".join([*cells, r.verdict + (f"; {r.note}" if r.note else "")]) + " |")
        if self.claims:
            lines += ["", "## Claims", "", "| where | claim | finding | verdict |", "|---|---|---|---|"]
            for c in self.claims:
                lines.append(
                    f"| {c.where} | {c.claim} | {c.finding} | {c.verdict}{f' (E {c.erratum})' if c.erratum else ''} |"
                )
        for t in self.tables:
            lines += ["", t]
        return "\n".join(lines) + "\n"

    def write(self) -> Path:
        path = HERE / f"{self.name}.md"
        write_text(path, self.markdown)
        return path


def parts(x: Any) -> tuple[np.ndarray, np.ndarray]:
    if hasattr(x, "dual"):
        a, b = np.broadcast_arrays(np.asarray(x.real), np.asarray(x.dual))
        return a, b
    if isinstance(x, (list, tuple)) and any(hasattr(i, "dual") for i in x):
        pairs = [parts(i) for i in x]
        return np.stack([p[0] for p in pairs]), np.stack([p[1] for p in pairs])
    a = np.asarray(x)
    return a, np.zeros(a.shape)


def distance(x: Any, y: Any) -> float:
    """max |x - y| / max(1, |y|) over both parts; of texts 0 or 1; of shapes that differ infinite."""
    if isinstance(x, str) or isinstance(y, str):
        return float(x != y)
    if x is None:
        return 0.0
    (a, da), (b, db) = parts(x), parts(y)
    if a.shape != b.shape:
        return float("inf")
    scale = max(1.0, np.abs(b).max(initial=0.0), np.abs(db).max(initial=0.0))
    return float(max(np.abs(a - b).max(initial=0.0), np.abs(da - db).max(initial=0.0)) / scale)


def shown(x: Any, digits: int = 7) -> str:
    """A value for a table."""
    if x is None:
        return ""
    if isinstance(x, str):
        return x
    a, b = parts(x)
    if a.size > 9:
        return f"{'x'.join(map(str, a.shape))} {'dual ' if np.any(b) else ''}array"
    few = digits if a.ndim == 0 else 5
    cells = [_number(p, few) + (_eps(q, few) if np.any(b) else "") for p, q in zip(a.ravel(), b.ravel(), strict=True)]
    return cells[0] if a.ndim == 0 else "(" + ", ".join(cells) + ")"


def _eps(x: Any, digits: int) -> str:
    if isinstance(x, complex):
        return f" + ({_number(x, digits)}) eps"
    return f" {'-' if x < 0 else '+'} {_number(abs(x), digits)} eps"


def _number(x: Any, digits: int) -> str:
    if isinstance(x, complex):
        return f"{x.real:.{digits}g}{x.imag:+.{digits}g}i"
    return f"{0.0 if abs(x) < 1e-15 else x:.{digits}g}"
