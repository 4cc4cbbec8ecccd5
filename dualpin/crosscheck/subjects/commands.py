"""A program of any language as a subject: it is given an exchange folder, and answers into it."""

from __future__ import annotations

import os
import shlex
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from ...errors import ArgumentError
from . import exchange
from .answers import Answers
from .asking import Asking
from .running import ended, stop


@dataclass(frozen=True)
class Command:
    """A program that reads an exchange folder and answers into it.

    Parameters
    ----------
    line : str
        How it is run; the word FOLDER stands for the folder, and is put at the end where it is missing.
    limit : float
        Seconds it may take before it is stopped; what it has written by then counts.

    Examples
    --------
    >>> from dualpin.crosscheck.subjects import Command
    >>> Command("./two_link FOLDER").words("/tmp/x")
    ['./two_link', '/tmp/x']
    """

    line: str
    limit: float = 60.0

    def words(self, folder: str) -> list[str]:
        try:
            words = shlex.split(self.line, posix=os.name != "nt")
        except ValueError as e:
            raise ArgumentError(f"judge: command {self.line!r}: {e}") from None
        if not words:
            raise ArgumentError("judge: the command is empty")
        if not any("FOLDER" in w for w in words):
            words.append("FOLDER")
        return [w.replace("FOLDER", folder) for w in words]

    @property
    def name(self) -> str:
        return Path(self.words("FOLDER")[0]).name


UNWRITTEN = "; nothing of this term was written: its function is not filled in, or was not reached"
"""Of a program that died after it had answered others: nothing tells the two apart."""


def ask_command(command: Command, asking: Asking, tick: Callable[[str], None]) -> Answers:
    """Run it on a new folder; run it again for the terms that a crash or a hang left open, as long as that helps."""
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as at:
        folder = Path(at)
        waiting = list(asking.terms)
        blamed: dict[str, str] = {}
        while waiting:
            exchange.write(asking, folder, waiting)
            tick(", ".join(waiting[:1]))
            wrong = _run(command, folder)
            done = [t for t in waiting if (folder / "answers" / f"{t}.csv").exists()]
            if not wrong or not done:
                blamed |= dict.fromkeys(waiting if wrong else [], wrong)
                break
            # the last file it touched is the one it died in, unless that file is whole
            waiting = [t for t in waiting if t not in done]
            blamed |= dict.fromkeys(waiting, wrong)
        answers = exchange.read(asking, folder, command.name)
    for term, why in blamed.items():
        if term in answers.silent:
            answers.silent[term] = why + (UNWRITTEN if answers.terms else "")
    if blamed and not answers.terms:
        answers.refused = next(iter(blamed.values()))
    answers.seconds = time.perf_counter() - start
    return answers


def refusal_of_command(command: Command, asking: Asking, seconds: float) -> str:
    """Why a program does not read this robot; empty if it does.  It is asked for no terms."""
    with tempfile.TemporaryDirectory() as at:
        exchange.write(asking, Path(at), [])
        return _run(replace(command, limit=min(seconds, command.limit)), Path(at))


def _run(command: Command, folder: Path) -> str:
    """What went wrong, if anything."""
    log = folder / "log.txt"
    words = command.words(str(folder))
    try:
        with log.open("wb") as out:
            process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True)
    except OSError as e:
        raise ArgumentError(f"judge: command {words[0]!r} cannot be started ({e.strerror or e})") from None
    try:
        code = process.wait(command.limit)
    except subprocess.TimeoutExpired:
        return f"no answer within {command.limit:g} s"
    finally:
        stop(process)
    return "" if code == 0 else ended(code, log)


__all__ = ["Command", "ask_command", "refusal_of_command"]
