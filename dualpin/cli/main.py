"""The `dualpin` program.  Results go to stdout, progress and remarks to stderr.

Exit codes: 0 all passed, 1 something is out of tolerance, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import sys
import warnings
from importlib import import_module

import typer

from ..errors import DualpinError, DualpinWarning
from ..escape import lines
from .app import app, in_front

# modules of this folder that register commands, in the order of `dualpin --help`
MODULES = (
    "commands",
    "forms",
    "validation",
    "judging",
    "subjects",
    "checking",
    "differing",
    "converting",
    "measure",
    "integrate",
    "report",
    "view",
    "workspace",
    "fuzzing",
    "campaigns",
    "cache",
    "selftest",
)


def program() -> typer.Typer:
    """The program with all its commands."""
    for name in MODULES:
        import_module(f"{__package__}.{name}")
    return app


def main() -> None:
    """Run the program; errors become one line on stderr and exit code 2."""
    run = program()
    warnings.simplefilter("ignore", DualpinWarning)  # remarks are printed where they belong
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")  # a terminal without a character shows its number
    try:
        run(in_front(sys.argv[1:]), prog_name="dualpin")
    except DualpinError as e:
        print(f"dualpin: {lines(str(e))}", file=sys.stderr)
        sys.exit(2)
    except SystemExit as e:
        if e.code == 130:  # what Typer makes of Ctrl-C, and commands that kept what they had
            print("dualpin: interrupted", file=sys.stderr)
        raise
    except KeyboardInterrupt:
        print("dualpin: interrupted", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:  # `dualpin list | head`
        sys.stderr.close()
        sys.exit(0)
