"""python -m validation.papers: all pages and their index, or the pages named."""

from __future__ import annotations

import importlib
import sys

from dualpin.files import write_text

from .common import HERE, Page

PAPERS = ("tapia_herrera", "laus", "pennestri", "gouasmi", "sariyildiz")
INTRO = """# The papers, recomputed

Every table, example and formula of five papers that dualpin stands on: what is printed, what is right, what dualpin
computes. `make papers` writes these pages; `tests/papers` holds every row. Corrected values are definitions written
out with NumPy, derivatives by complex steps, golden values from mpmath at 140 digits, or, for dynamics, Lagrangian
terms that are checked against Pinocchio.

Verdicts: *holds*; *misprint* with the number of the erratum; *measured*, where the paper prints nothing.
"""


def main(names: list[str]) -> int:
    pages = [importlib.import_module(f"validation.papers.{name}").page() for name in names or PAPERS]
    for page in pages:
        print(page.markdown)
        bad = sum(not r.consistent for r in page.rows)
        print(f"{page.write().name}: {len(page.rows)} rows, {bad} open", file=sys.stderr)
    if not names:
        write_text(HERE / "README.md", index(pages))
    return int(any(not r.consistent for p in pages for r in p.rows))


def index(pages: list[Page]) -> str:
    """The table of pages, and all misprints in one list."""
    lines = [INTRO, "| page | values and formulas | hold | misprints | measured | open |", "|---|---|---|---|---|---|"]
    for p in pages:
        verdicts = [r.verdict.split(" ")[0] for r in p.rows]
        counts = [verdicts.count(v) for v in ("holds", "misprint", "measured")]
        bad = sum(not r.consistent for r in p.rows)
        lines.append(f"| [{p.title}]({p.name}.md) | {len(p.rows)} | {' | '.join(map(str, counts))} | {bad} |")
    lines += ["", "## Misprints", "", "| number | where | what |", "|---|---|---|"]
    for p in pages:
        for r in p.rows:
            if r.erratum:
                what = r.what.replace("|", "\\|")
                lines.append(f"| {r.erratum} | {p.title}, {r.where} | {what} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
