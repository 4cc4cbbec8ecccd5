"""The `dualpin` program in this process: a second a call less than in a process of its own, with the same outcome."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from dualpin.cli import main


@dataclass
class Done:
    """What a process would leave behind."""

    returncode: int
    stdout: str
    stderr: str


def run(*words, cwd=None) -> Done:
    """Call it with these words; `test_cli.test_list_prints_names_and_aliases` says that a process does the same."""
    out, err, code, here = io.StringIO(), io.StringIO(), 0, Path.cwd()
    with (
        mock.patch.object(sys, "argv", ["dualpin", *map(str, words)]),
        contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings(),
    ):  # fmt: skip
        warnings.simplefilter("default")
        os.chdir(cwd or here)
        try:
            main()
        except SystemExit as e:
            code = e.code if isinstance(e.code, int) else int(e.code is not None)
        finally:
            os.chdir(here)
    return Done(code, out.getvalue(), err.getvalue())
