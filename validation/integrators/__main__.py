"""Run the study and write results.json, README.md and the figures beside this file.

    python -m validation.integrators [--quick]

--quick shortens the long runs (100 turns, 20,000 steps) and writes nothing.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from dualpin.files import write_text

from . import figures, measure, page

HERE = Path(__file__).parent


def main() -> int:
    """0 if every claim about the methods themselves was confirmed, 1 if not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="shorten the long runs and write nothing")
    quick = parser.parse_args().quick
    results = measure.everything(quick, report=lambda text: print(text, file=sys.stderr))
    if quick:
        print(page.markdown(results))
    else:
        write_text(HERE / "results.json", json.dumps(results, indent=1, allow_nan=False) + "\n")
        write_text(HERE / "README.md", page.markdown(results))
        figures.draw(results, HERE)
    return 0 if results["passed"] else 1


if __name__ == "__main__":
    sys.exit(main())
