"""The `dualpin` program.  Results go to stdout, progress and remarks to stderr.

Exit codes: 0 all passed, 1 something is out of tolerance, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import sys
import warnings

from ..errors import DualpinError, DualpinWarning
from ..escape import lines
from .app import app


def main() -> None:
    """Run the program; errors become one line on stderr and exit code 2."""
    from . import cache, campaigns, commands, forms, judging, measure, report, subjects, validation, view  # noqa: F401  (they register themselves)

    warnings.simplefilter("ignore", DualpinWarning)  # remarks are printed where they belong
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")  # a terminal without a character shows its number
    try:
        app(prog_name="dualpin")
    except DualpinError as e:
        print(f"dualpin: {lines(str(e))}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("dualpin: interrupted", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:  # `dualpin list | head`
        sys.stderr.close()
        sys.exit(0)
