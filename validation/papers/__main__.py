"""python -m validation.papers: all pages, or those named."""

from __future__ import annotations

import importlib
import sys

PAPERS = ("tapia_herrera", "laus", "pennestri", "gouasmi", "sariyildiz")


def main(names: list[str]) -> int:
    open_rows = 0
    for name in names or PAPERS:
        page = importlib.import_module(f"validation.papers.{name}").page()
        print(page.markdown)
        open_rows += sum(not r.consistent for r in page.rows)
        print(f"{page.write().name}: {len(page.rows)} rows, {open_rows} open\n", file=sys.stderr)
    return 1 if open_rows else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
