"""Environments of subjects: each library is installed in a separate one, so that dependencies cannot conflict.

An adapter is a file with a tuple ``REQUIRES`` of what pip installs for it, versions named.  Its environment
is a folder of the user's data, made with `venv`; `ready` is written last, so half an installation is none.
"""

from __future__ import annotations

import ast
import contextlib
import json
import os
import shutil
import subprocess
import sys
import time
import venv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import ArgumentError, nearest

ADAPTERS = Path(__file__).parent / "adapters"
_READY = "ready.json"


@dataclass(frozen=True)
class Environment:
    """Where a subject's library is installed.

    Attributes
    ----------
    name : str
        Of the adapter: a shipped name, or the stem of its file.
    adapter : Path
    requires : tuple of str
        What pip installs, versions named.
    """

    name: str
    adapter: Path
    requires: tuple[str, ...]

    @property
    def folder(self) -> Path:
        return folder() / self.name

    @property
    def python(self) -> Path:
        return self.folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")

    @property
    def ready(self) -> bool:
        """Whether it is installed, with what the adapter asks for today."""
        return self.facts().get("requires") == list(self.requires) and self.python.exists()

    def facts(self) -> dict[str, object]:
        """What was installed: requires, seconds, mebibytes, date; empty where nothing was."""
        try:
            return dict(json.loads((self.folder / _READY).read_text(encoding="utf-8")))
        except (OSError, ValueError):
            return {}


def shipped() -> list[str]:
    """The names of the subjects that come with dualpin.

    Returns
    -------
    list of str

    Examples
    --------
    >>> from dualpin.crosscheck.subjects import shipped
    >>> "mujoco" in shipped()
    True
    """
    return sorted(p.stem for p in ADAPTERS.glob("*.py") if not p.stem.startswith("_"))


def folder() -> Path:
    """Where environments are: ``DUALPIN_SUBJECTS_DIR``, or the platform's folder for dualpin's data."""
    import platformdirs

    chosen = os.environ.get("DUALPIN_SUBJECTS_DIR")
    if chosen:
        return Path(chosen).expanduser()
    return Path(platformdirs.user_data_dir("dualpin", appauthor=False)) / "subjects"


def environment(name: str | Path) -> Environment:
    """That of a shipped adapter, or of an adapter's file; ``"mujoco==3.12.0"`` is one with another version.

    Raises
    ------
    ArgumentError
        If there is no such adapter, or it does not say what it requires.
    """
    text, _, version = str(name).partition("==")
    path = ADAPTERS / f"{text}.py" if text in shipped() else Path(text)
    if path.suffix != ".py" or not path.is_file():
        raise ArgumentError(
            f"subjects: {text!r} is no shipped subject and no adapter's file; {nearest(text, shipped(), 'shipped')}"
        )
    found = requirements(path)
    if not version:
        return Environment(path.stem, path, found)
    if not found:
        raise ArgumentError(f"subjects: {path} has no REQUIRES, so there is no version of it to choose")
    library = found[0].partition("==")[0]
    return Environment(f"{path.stem}-{version}", path, (f"{library}=={version}", *found[1:]))


def literals(path: Path) -> dict[str, Any]:
    """The constants of an adapter, None for what is no literal; the file is read, not run."""
    try:
        tree = ast.parse(path.read_text(encoding="utf-8"), str(path))
    except (SyntaxError, ValueError) as e:
        raise ArgumentError(f"subjects: {path} is not Python ({e})") from None
    found: dict[str, Any] = {}
    for node in tree.body:
        if isinstance(node, ast.Assign):
            value = None
            with contextlib.suppress(ValueError):
                value = ast.literal_eval(node.value)
            found |= {target.id: value for target in node.targets if isinstance(target, ast.Name)}
    return found


def requirements(path: Path) -> tuple[str, ...]:
    """What pip installs for an adapter: its literal ``REQUIRES``."""
    found = literals(path).get("REQUIRES", ())
    if not isinstance(found, tuple) or not all(isinstance(x, str) for x in found):
        raise ArgumentError(f"subjects: REQUIRES of {path} must be a tuple of texts")
    return found


def interpreter(adapter: Path, version: str = "") -> str | None:
    """The Python of the adapter's environment where it is installed, else None.

    Raises
    ------
    ArgumentError
        If a version is asked for that is not installed.
    """
    try:
        found = environment(f"{adapter}=={version}" if version else adapter)
    except ArgumentError:
        return None
    if version and not found.ready:
        name = adapter.stem if adapter.stem in shipped() else adapter
        raise ArgumentError(
            f"subjects: {found.requires[0]} is not installed; `dualpin subjects install {name}=={version}` does it"
        )
    return str(found.python) if found.requires and found.ready else None


def install(name: str | Path, tick: Callable[[str], None] = lambda what: None) -> Environment:
    """Make the environment of a subject, or make it anew where its adapter asks for something else by now.

    Raises
    ------
    ArgumentError
        If pip fails; it says what pip said last.
    """
    found = environment(name)
    if found.ready:
        return found
    if not found.requires:
        raise ArgumentError(f"subjects: {found.adapter} has no REQUIRES, so there is nothing to install")
    start = time.perf_counter()
    shutil.rmtree(found.folder, ignore_errors=True)
    tick(f"{found.name}: an environment in {found.folder}")
    try:
        found.folder.parent.mkdir(parents=True, exist_ok=True)
        venv.create(found.folder, with_pip=True, clear=True)
        tick(f"{found.name}: {', '.join(found.requires)}")
        command = [str(found.python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *found.requires]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except (OSError, subprocess.SubprocessError) as e:
        shutil.rmtree(found.folder, ignore_errors=True)
        raise ArgumentError(f"subjects: {found.folder} cannot be made ({e})") from None
    except BaseException:  # interrupted: half an environment is none
        shutil.rmtree(found.folder, ignore_errors=True)
        raise
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if line.strip()][-3:]
        shutil.rmtree(found.folder, ignore_errors=True)
        raise ArgumentError(f"subjects: pip cannot install {', '.join(found.requires)}: {' | '.join(said)}")
    facts = {
        "requires": list(found.requires), "seconds": round(time.perf_counter() - start, 1),
        "python": sys.version.split()[0],
        "mebibytes": round(sum(f.stat().st_size for f in found.folder.rglob("*") if f.is_file()) / 2**20),
    }  # fmt: skip
    (found.folder / _READY).write_text(json.dumps(facts), encoding="utf-8")
    return found


def remove(name: str | Path) -> bool:
    """Remove an environment; whether there was one."""
    found = environment(name)
    there = found.folder.exists()
    shutil.rmtree(found.folder, ignore_errors=True)
    return there


def terms(adapter: Path, known: tuple[str, ...]) -> list[str]:
    """The terms that an adapter's classes define; the file is read, not run."""
    tree = ast.parse(adapter.read_text(encoding="utf-8"), str(adapter))
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    defined = {f.name for node in classes for f in node.body if hasattr(f, "name")}
    # attributes that are set when the subject is made, such as compiled functions
    inside = (x for node in classes for x in ast.walk(node) if isinstance(x, ast.Attribute))
    defined |= {x.attr for x in inside if isinstance(x.ctx, ast.Store)}
    listed = {
        x.value for node in ast.walk(tree) if isinstance(node, ast.Dict) for x in node.keys
        if isinstance(x, ast.Constant) and isinstance(x.value, str)
    }  # fmt: skip
    return [t for t in known if t in defined | listed]
