"""Who is meant by a subject: a shipped name, module:attribute, an object, a mapping, a folder, a command."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...errors import ArgumentError, nearest
from . import exchange
from .answers import Answers
from .asking import Asking
from .commands import Command, ask_command
from .running import ask_apart, ask_object

ADAPTERS = Path(__file__).parent / "adapters"
_SPEC = re.compile(r"^([\w.]+|.+\.py):[\w.]+(:.*)?$")


def shipped() -> list[str]:
    """The names of the subjects that come with dualpin."""
    return sorted(p.stem for p in ADAPTERS.glob("*.py") if not p.stem.startswith("_"))


def resolve(
    subject: Any, *, python: str | None = None, limit: float = 60.0
) -> Callable[[Asking, Callable[[str], None]], Answers]:
    """A function that asks the subject.

    Raises
    ------
    ArgumentError
        If nothing is known by that name.
    """
    python = python or sys.executable
    if isinstance(subject, Command):
        return lambda asking, tick: ask_command(subject, asking, tick)
    if isinstance(subject, (str, Path)):
        text = str(subject)
        if Path(text).is_dir():
            folder = Path(text)
            exchange.asked(folder)
            return lambda asking, tick: exchange.read(exchange.with_states(asking, folder), folder)
        name, _, option = text.partition(":")
        if name in shipped():
            spec = f"{ADAPTERS / name}.py:Subject:{option}"
            return lambda asking, tick: _named(ask_apart(spec, asking, tick, python=python, limit=limit), text)
        if _SPEC.match(text):
            return lambda asking, tick: ask_apart(text, asking, tick, python=python, limit=limit)
        raise ArgumentError(
            f"judge: subject {text!r} is no shipped name, no folder that `dualpin ask` wrote and no module:attribute; "
            + nearest(name, shipped(), "shipped")
        )
    return lambda asking, tick: ask_object(subject, asking, tick)


def _named(answers: Answers, name: str) -> Answers:
    answers.name = name
    return answers
