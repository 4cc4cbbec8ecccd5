"""What a paper prints and what is computed here: one row each, and a page of them."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dualpin import Dual
from dualpin.files import write_text

HERE = Path(__file__).parent
FIGURES = HERE / "figures"

HOLDS = "holds to the printed digits"
ROUNDING = "rounding"
CONVENTION = "convention"
CANNOT = "as read here it cannot hold"
ASSUMING = "reproduced by assuming"
FAILS = "claim fails"
PART = "claim holds in part"
MEASURED = "measured"
DRAWN = "drawn afresh"
OUTSIDE = "not computed"
VERDICTS = {
    HOLDS: "the print, evaluated, is what is computed, to half a unit of its last digit (of a formula, to 1e-12)",
    ROUNDING: "the print differs in its last digits, and the same computation in single precision gives the print",
    CONVENTION: "right under a convention that the paper does not state, or in other units than ours",
    CANNOT: "the text, read by machine, says what no computation can give; the row has the evidence",
    ASSUMING: "a datum is missing; with the one named here the print comes out",
    FAILS: "a statement that measurement or a counter-example contradicts",
    PART: "a statement that is right with a restriction",
    MEASURED: "nothing is printed to compare with; what is computed here is given",
    DRAWN: "a figure, computed from the equations and drawn in our own way",
    OUTSIDE: "outside of what a computation can decide (history, hardware, wording); said so, and why",
}
READ = (
    "The papers' texts were read by machine: a symbol that is missing here may be the reading's fault, not the paper's."
)


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
    """One equation, number, table, figure or claim.

    `printed` is the text of the paper, with its digits, or its formula in the notation of this project; `value` what
    that is in numbers; `computed` what dualpin computes; `right` an independent value for it, where the print is none.
    """

    where: str
    what: str
    printed: str
    value: Any = None
    computed: Any = None
    verdict: str = HOLDS
    right: Any = None
    single: Any = None
    """The computation in single precision, for the verdict *rounding*."""
    noise: float = 0.0
    """How far rounding carries that from the print, beside half a unit of the last digit, relative to max(1, |it|)."""
    digits: float = 1e-12
    """Half a unit of the last printed digit, relative to max(1, |computed|); of a formula, rounding."""
    tol: float = 1e-12
    """Allowed |computed - right| / max(1, |right|)."""
    note: str = ""

    @property
    def print_right(self) -> bool:
        return self.value is not None and distance(self.value, self.computed) <= self.digits

    @property
    def ours_right(self) -> bool:
        return self.right is None or distance(self.computed, self.right) <= self.tol

    @property
    def wrong(self) -> str:
        """What contradicts the verdict; empty where nothing does."""
        if self.verdict not in VERDICTS:
            return f"unknown verdict {self.verdict!r}"
        if not self.ours_right:
            return f"dualpin is off by {distance(self.computed, self.right):.2g}"
        if self.verdict in (HOLDS, CONVENTION, ASSUMING):
            if self.value is None or self.computed is None:
                return "nothing was compared"
            if not self.print_right:
                return f"the print is off by {distance(self.value, self.computed):.2g}"
        if self.verdict == ROUNDING and self.print_right:
            return "the print holds in double precision"
        if self.verdict == ROUNDING and distance(self.value, self.single) > self.digits + self.noise:
            return f"single precision is off by {distance(self.value, self.single):.2g}"
        if self.verdict == CANNOT and (self.value is None or self.right is None or self.print_right):
            return "no evidence: a print, an independent value, and a difference are needed"
        if self.verdict in (FAILS, PART, MEASURED, DRAWN) and self.computed is None:
            return "no finding"
        return ""


@dataclass
class Page:
    """All rows of a paper, its figures, and tables of measurements that differ from run to run."""

    name: str
    title: str
    citation: str
    intro: str
    rows: list[Row]
    figures: dict[str, str] = field(default_factory=dict)
    """File in figures/ -> what it shows."""
    missing: str = ""
    """What of the paper is not covered, and why."""
    tables: list[str] = field(default_factory=list)

    @property
    def counts(self) -> str:
        found = {v: sum(r.verdict == v for r in self.rows) for v in VERDICTS}
        return ", ".join(f"{n} {v}" for v, n in found.items() if n)

    @property
    def markdown(self) -> str:
        bad = [r for r in self.rows if r.wrong]
        lines = [f"# {self.title}", "", f"*{self.citation}*", "", self.intro, "", f"{READ} Verdicts: see the "]
        lines[-1] += f"[index](README.md). {len(self.rows)} rows: {self.counts}; {len(bad)} open."
        lines += [
            "",
            "Where a formula is printed, it was evaluated at one set of numbers; *computed* is dualpin's value there.",
        ]
        lines += ["", "| where | what | printed | computed | verdict |", "|---|---|---|---|---|"]
        for r in self.rows:
            verdict = (r.verdict if not r.wrong else f"OPEN: {r.wrong}") + (f": {r.note}" if r.note else "")
            cells = [r.where, r.what, r.printed or "-", shown(r.computed) or "-", verdict]
            lines.append("| " + " | ".join(c.replace("|", "\\|") for c in cells) + " |")
        if self.figures:
            lines += ["", "## Figures", "", "`make papers` computes and draws them."]
            for file, caption in self.figures.items():
                lines += ["", f"![{caption}](figures/{file})", "", f"*{caption}*"]
        for t in self.tables:
            lines += ["", t]
        lines += ["", "## Not covered", "", self.missing or "Nothing."]
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
    if x is None or y is None:
        return float("inf")
    (a, da), (b, db) = parts(x), parts(y)
    if a.shape != b.shape:
        return float("inf")
    scale = max(1.0, np.abs(b).max(initial=0.0), np.abs(db).max(initial=0.0))
    return float(max(np.abs(a - b).max(initial=0.0), np.abs(da - db).max(initial=0.0)) / scale)


def shown(x: Any, digits: int = 8) -> str:
    """A value for a table."""
    if x is None:
        return ""
    if isinstance(x, str):
        return x
    a, b = parts(x)
    if a.size > 9:
        return f"{' x '.join(map(str, a.shape))} {'dual ' if np.any(b) else ''}numbers"
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
