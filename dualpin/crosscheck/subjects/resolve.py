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
from .environments import ADAPTERS, interpreter, shipped
from .running import ask_apart, ask_object

_SPEC = re.compile(r"^([\w.]+|.+\.py):[\w.]+(:.*)?$")


def resolve(
    subject: Any, *, python: str | None = None, limit: float = 60.0
) -> Callable[[Asking, Callable[[str], None]], Answers]:
    """A function that asks the subject.

    Raises
    ------
    ArgumentError
        If nothing is known by that name.
    """
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
            adapter = ADAPTERS / f"{name}.py"
            spec, own = f"{adapter}:Subject:{option}", python or interpreter(adapter) or sys.executable
            return lambda asking, tick: _named(ask_apart(spec, asking, tick, python=own, limit=limit), text)
        if _SPEC.match(text):
            own = python or interpreter(Path(name)) or sys.executable
            return lambda asking, tick: ask_apart(text, asking, tick, python=own, limit=limit)
        raise ArgumentError(
            f"judge: subject {text!r} is no shipped name, no folder that `dualpin ask` wrote and no module:attribute; "
            + nearest(name, shipped(), "shipped")
        )
    return lambda asking, tick: ask_object(subject, asking, tick)


def _named(answers: Answers, name: str) -> Answers:
    answers.name = name
    if "ModuleNotFoundError" in answers.refused:
        answers.refused += f"; `dualpin subjects install {name.partition(':')[0]}` makes an environment that has it"
    return answers
