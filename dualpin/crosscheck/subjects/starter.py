"""Skeletons of programs that answer an exchange folder, for those who write one."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path

from ...errors import ArgumentError, nearest
from ...escape import c_string, julia_string, matlab_string
from ...files import write_text, writing
from .asking import Asking
from .convention import columns, parameter_names

LITERALS = {"c": c_string, "cpp": c_string, "python": repr, "matlab": matlab_string, "julia": julia_string}
LANGUAGES = {"c": "answer.c", "cpp": "answer.cpp", "python": "answer.py", "matlab": "answer.m", "julia": "answer.jl"}


def write_starter(asking: Asking, folder: Path, language: str) -> Path:
    """A program that reads the states and writes answers, with functions to fill in.

    Parameters
    ----------
    asking : Asking
    folder : Path
        Where to write it.
    language : str
        Of `LANGUAGES`.

    Returns
    -------
    Path
        Of the program.

    Raises
    ------
    ArgumentError
        If the language is not one of `LANGUAGES`, or the folder cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from dualpin.crosscheck.subjects import asking, write_starter
    >>> write_starter(asking("ur5", 4, 0, ("rnea",)), pathlib.Path(tempfile.mkdtemp()), "python").name
    'answer.py'
    """
    if language not in LANGUAGES:
        raise ArgumentError(f"ask: language {language!r} is not known; {nearest(language, LANGUAGES, 'languages')}")
    path = folder / LANGUAGES[language]
    if path.exists():
        raise ArgumentError(f"ask: {path} is there already; it is left as it is (move it away for a new one)")
    with writing(f"ask: cannot write {path}"):
        folder.mkdir(parents=True, exist_ok=True)
        write_text(path, starter(asking, language))
    return path


def starter(asking: Asking, language: str) -> str:
    """Its text, with the robot's names."""
    text = (resources.files(__package__) / "starters" / f"{LANGUAGES[language]}.in").read_text(encoding="utf-8")
    q, v = columns(asking.robot)
    parameters = parameter_names(asking.robot)
    values = {
        "ROBOT": _plain(asking.name), "GRAVITY": ", ".join(f"{x:g}" for x in asking.gravity), "NQ": str(len(q)),
        "NV": str(len(v)), "NF": str(len(asking.frames)), "Q": _listed(q, language), "V": _listed(v, language),
        "NP": str(len(parameters)), "PARAMETERS": _listed(parameters, language),
        "FRAMES": _listed(asking.frames, language) or ('""' if language == "c" else ""),
    }  # fmt: skip
    # all at once: a name may look like a place of another
    return re.sub(rf"@({'|'.join(values)})@", lambda place: values[place[1]], text)


def _listed(names: tuple[str, ...], language: str) -> str:
    """Names as literals of the language."""
    return ", ".join(map(LITERALS[language], names))


def _plain(name: str) -> str:
    """A name in a comment, which it cannot end."""
    return "".join(c if c.isalnum() or c in "._-/ " else "_" for c in name).replace("*/", "_")
