"""Find a subject by a shipped name, module:attribute, an object, a mapping, a folder, a command."""

from __future__ import annotations

import contextlib
import hashlib
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import ArgumentError, nearest
from . import exchange
from .answers import Answers
from .asking import Asking
from .commands import Command, ask_command, refusal_of_command
from .environments import ADAPTERS, interpreter, shipped
from .kept import Kept
from .running import ask_apart, ask_object, refusal_apart

MUJOCO = "mujoco"  # reads MJCF itself
_SPEC = re.compile(r"^([\w.]+|.+\.py):[\w.]+(:.*)?$")


@dataclass(frozen=True)
class Asker:
    """Asks one subject.

    Attributes
    ----------
    ask : callable
        (asking, tick, kept) -> `Answers`.
    refusal : callable, optional
        (asking, seconds) -> why it does not read the robot, empty if it does; None for a subject that is not
        given a file in a process of its own.
    """

    ask: Callable[[Asking, Callable[[str], None], Kept], Answers]
    refusal: Callable[[Asking, float], str] | None = None
    identity: str = ""
    """What it is known by when a judgement goes on: empty for a subject that cannot be known again."""

    def __call__(self, asking: Asking, tick: Callable[[str], None], kept: Kept | None = None) -> Answers:
        return self.ask(asking, tick, kept or Kept())


def resolve(subject: Any, *, python: str | None = None, limit: float = 60.0) -> Asker:
    """What asks the subject.

    Parameters
    ----------
    subject : str, Path, object, mapping or Command
        As of `dualpin.judge`.
    python : str, optional
        The interpreter of the subject's own environment.
    limit : float
        Seconds after which it counts as hanging.

    Returns
    -------
    Asker

    Raises
    ------
    ArgumentError
        If nothing is known by that name.

    Examples
    --------
    >>> from dualpin.crosscheck.subjects import asking, resolve
    >>> given = asking("ur5", 4, 0, ("gravity",))
    >>> answers = resolve({"gravity": lambda q: 0 * q})(given, lambda what: None)
    >>> answers.terms["gravity"].shape
    (4, 6)
    """
    if isinstance(subject, Command):
        return Asker(
            lambda asking, tick, kept: ask_command(subject, asking, tick),
            lambda asking, seconds: refusal_of_command(subject, asking, seconds),
            _identity(subject.line, "", [Path(w) for w in subject.words("")]),
        )
    if isinstance(subject, (str, Path)):
        text = str(subject)
        if Path(text).is_dir():
            folder = Path(text)
            exchange.asked(folder)
            return Asker(lambda asking, tick, kept: exchange.read(exchange.with_states(asking, folder), folder))
        named, _, option = text.partition(":")
        name, _, version = named.partition("==")
        if name in shipped():
            adapter = ADAPTERS / f"{name}.py"
            own = python or interpreter(adapter, version) or sys.executable
            text = ":".join(x for x in (name, option) if x)  # one subject in all its versions

            def spec(asking: Asking) -> str:
                of = ",".join(x for x in (option, f"mjcf={asking.mjcf}") if x) if asking.mjcf and name == MUJOCO else ""
                return f"{adapter}:Subject:{of or option}"

            return Asker(
                lambda asking, tick, kept: _named(
                    ask_apart(spec(asking), asking, tick, python=own, limit=limit, kept=kept), text
                ),
                lambda asking, seconds: refusal_apart(spec(asking), asking, seconds, python=own),
                _identity(f"{adapter}:{text}:{version}", own, [adapter]),
            )
        if _SPEC.match(text):
            own = python or interpreter(Path(name)) or sys.executable
            return Asker(
                lambda asking, tick, kept: ask_apart(text, asking, tick, python=own, limit=limit, kept=kept),
                lambda asking, seconds: refusal_apart(text, asking, seconds, python=own),
                _identity(text, own, [Path(name if name.endswith(".py") else f"{name.replace('.', '/')}.py")]),
            )
        raise ArgumentError(
            f"judge: subject {text!r} is no shipped name, no folder that `dualpin ask` wrote and no module:attribute; "
            + nearest(name, shipped(), "shipped")
        )
    return Asker(lambda asking, tick, kept: ask_object(subject, asking, tick, limit))


def _identity(said: str, python: str, named: Sequence[Path]) -> str:
    """What is asked, and the contents of the files that it names and of those beside them with the same ending.

    A user edits a program, or a module that it imports, between two runs: its answers are others then.
    """
    files = {f for path in named if path.is_file() for f in (path, *_beside(path))}
    contents = hashlib.sha256()
    for f in sorted(files):
        with contextlib.suppress(OSError):
            contents.update(f"{f.name} ".encode() + hashlib.sha256(f.read_bytes()).digest())
    return f"{said}|{python}|{contents.hexdigest()[:16]}"


def _beside(path: Path) -> list[Path]:
    ending = path.suffix
    return [f for f in path.resolve().parent.glob(f"*{ending}") if f.is_file()] if ending else []


def _named(answers: Answers, name: str) -> Answers:
    answers.name = name
    if "ModuleNotFoundError" in answers.refused:
        answers.refused += f"; `dualpin subjects install {name.partition(':')[0]}` makes an environment that has it"
    return answers
