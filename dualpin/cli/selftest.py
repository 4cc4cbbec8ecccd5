"""`dualpin selftest`: every command on one robot, in an empty folder, with what is installed."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import typer

from ..files import write_text
from ..machine import versions
from .app import Json, app, show_json

LIMIT = 120.0  # seconds a command may take: the slowest takes 5 on an idle machine
STEPS = (
    ("list",),
    ("info", "arm.urdf"),
    ("fk", "arm.urdf", "--q", "0,0.1,0.2,0.3,0.4,0.5"),
    ("dh", "arm.urdf"),
    ("screws", "arm.urdf"),
    ("validate", "arm.urdf", "--samples", "10", "--jobs", "1", "--store", "store"),
    ("ask", "arm.urdf", "asked", "--language", "python"),
    ("judge", "arm.urdf", "mine.py:Arm", "--samples", "4", "--out", "judged"),
    ("subjects", "list"),
    ("bench", "arm.urdf", "--terms", "gravity", "--batch", "16"),
    ("check", "arm.urdf", "--level", "warning"),
    ("diff", "arm.urdf", "arm.urdf"),
    ("convert", "arm.urdf", "again.urdf"),
    ("workspace", "arm.urdf", "--samples", "20000", "--survey", "0"),
    ("fuzz", "--robots", "2", "--seed", "1", "--jobs", "1"),
    ("integrate", "arm.urdf", "--dt", "0.5", "--turns", "1", "--methods", "rk4"),
    ("view", "arm.urdf", "--port", "0"),
    ("cache", "info"),
)
AFTER = (("report", "judged/report.json"), ("campaign", "status", "store"))
"""What reads files of other steps."""
SUBJECT = """
import dualpin as dp

class Arm:
    def __init__(self, urdf):
        self.robot = dp.load(urdf)
    def gravity(self, q):
        return dp.gravity(self.robot, q)
"""
PASSED, SKIPPED, FAILED = "passed", "skipped", "FAILED"


@dataclass(frozen=True)
class Outcome:
    """How one command went."""

    command: str
    outcome: str
    seconds: float
    said: str = ""


@app.command()
def selftest(
    keep: Annotated[Path | None, typer.Option("--keep", help="Run in this folder, and keep it.")] = None,
    json: Json = False,
) -> None:
    """Run every command on one robot, in an empty folder; what needs a package that is not installed is skipped.

    Exit code 1 if a command fails.
    """
    begun = time.perf_counter()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        folder = keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        found = []
        for one in _outcomes(folder):
            found.append(one)
            if not json:
                said = f"  {one.said}" if one.said else ""
                print(f"{one.outcome:8}{one.seconds:6.1f} s  dualpin {one.command}{said}", flush=True)
    failed = sum(one.outcome == FAILED for one in found)
    seconds = round(time.perf_counter() - begun, 1)
    if json:
        show_json({"outcomes": [asdict(one) for one in found], "seconds": seconds, "versions": versions()})
    else:
        skipped = sum(one.outcome == SKIPPED for one in found)
        print(f"{len(found) - failed - skipped} passed, {skipped} skipped, {failed} failed in {seconds} s")
    raise typer.Exit(1 if failed else 0)


def _outcomes(folder: Path) -> Iterator[Outcome]:
    from ..forms import from_dh

    body = {"mass": 2.0, "com": (0.0, 0.0, 0.1), "inertia": [[0.02, 0, 0], [0, 0.02, 0], [0, 0, 0.01]]}
    rows = [(0, 0.4, 0.1, 1.5), (0, 0, 0.4, 0), (0, 0.1, 0, 1.5), (0, 0.4, 0, -1.5), (0, 0, 0, 1.5), (0, 0.1, 0, 0)]
    from_dh(rows, "RRRRRR", name="arm", inertias=[body] * 6).to_urdf(folder / "arm.urdf")
    write_text(folder / "mine.py", SUBJECT)
    with ThreadPoolExecutor(max_workers=2) as pool:
        for steps in (STEPS, AFTER):
            yield from pool.map(lambda words: _run(folder, words), steps)


def _run(folder: Path, words: tuple[str, ...]) -> Outcome:
    environment = {**os.environ, "DUALPIN_CACHE_DIR": str(folder / "cache"), "PYTHONUTF8": "1"}
    command, begun = [sys.executable, "-m", "dualpin", *words], time.perf_counter()
    log, name = tempfile.mkstemp(dir=folder, suffix=".log")
    errors = Path(name)
    with os.fdopen(log, "wb"):
        ran = subprocess.Popen(command, cwd=folder, env=environment, stdout=log, stderr=subprocess.STDOUT)
        try:
            code = _served(ran, errors) if words[0] == "view" else ran.wait(LIMIT)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            ran.kill()
            ran.wait()
    said = errors.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    seconds, last = round(time.perf_counter() - begun, 1), said[-1] if said else ""
    missing = next((x for x in said if "pip install" in x), "")
    if code == 0:
        return Outcome(" ".join(words), PASSED, seconds)
    if code in (1, 2) and missing:
        return Outcome(" ".join(words), SKIPPED, seconds, missing)
    if words in AFTER and not (folder / words[-1]).exists():
        return Outcome(" ".join(words), SKIPPED, seconds, f"{words[-1]} was not written")
    return Outcome(" ".join(words), FAILED, seconds, last or ("took too long" if code is None else f"exit code {code}"))


def _served(ran: subprocess.Popen, errors: Path) -> int | None:
    """Whether a server says where it is: it would serve until it is stopped."""
    for _ in range(int(LIMIT / 0.1)):
        if ran.poll() is not None:
            return ran.returncode
        if b" is at http" in errors.read_bytes():
            return 0
        time.sleep(0.1)
    return None
