"""python -m validation.papers: all pages, figures and the index, or the pages named; `--figures` only the figures."""

from __future__ import annotations

import importlib
import sys

from dualpin.files import write_text

from .common import HERE, READ, VERDICTS, Page

PAPERS = ("tapia_herrera", "laus", "pennestri", "gouasmi", "sariyildiz")


def main(names: list[str]) -> int:
    from .drawing import draw

    only = "--figures" in names
    chosen = [n for n in names if n != "--figures"] or list(PAPERS)
    for name in chosen:
        draw(name)
    if only:
        return 0
    pages = [importlib.import_module(f"validation.papers.{name}").page() for name in chosen]
    for page in pages:
        bad = [r for r in page.rows if r.wrong]
        for r in bad:
            print(f"{page.name}: {r.where}: {r.what}: {r.wrong}", file=sys.stderr)
        print(f"{page.write().name}: {len(page.rows)} rows, {len(bad)} open", file=sys.stderr)
    if len(chosen) == len(PAPERS):
        write_text(HERE / "README.md", index(pages))
    return int(any(r.wrong for p in pages for r in p.rows))


def index(pages: list[Page]) -> str:
    """The table of pages, the verdicts, and what is not covered."""
    lines = [
        "# The five papers, recomputed",
        "",
        "Every numbered equation, table, figure and claim of the five papers that dualpin stands on: what is printed, "
        "what is computed, and what becomes of it. `make papers` writes these pages and their figures; `tests/papers` "
        "holds every row and that no number is left out. Independent values are definitions written out with NumPy, "
        "derivatives by complex steps, golden values from mpmath at 140 digits, or, for dynamics, terms that are "
        "checked against Pinocchio.",
        "",
        READ,
        "",
        "| page | paper | rows |",
        "|---|---|---|",
    ]
    lines += [f"| [{p.title}]({p.name}.md) | {p.citation} | {len(p.rows)}: {p.counts} |" for p in pages]
    lines += ["", "## Verdicts", "", "| verdict | meaning |", "|---|---|"]
    lines += [f"| *{v}* | {meaning} |" for v, meaning in VERDICTS.items()]
    lines += ["", "## What is not covered", ""]
    lines += [f"- **{p.title}**: {p.missing}" for p in pages]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
