"""Xacro to URDF, by xacro itself: the macro language of ROS has no other definition.

An xacro file is a program: its expressions are evaluated by Python with few names, it may include other files
and read YAML and environment variables.  dualpin runs no more of it than xacro does, in a process of its own
that is stopped after a time, and reads what comes out like any other URDF.
"""

from __future__ import annotations

import atexit
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from ..errors import ArgumentError, UrdfError
from ..extras import extra
from .apart import expand as worker
from .xml import MAX_BYTES

SECONDS = 60.0
"""Seconds after which an expansion is stopped; the largest public descriptions take two."""
SETTINGS = "DUALPIN_XACRO"
"""An environment variable, {"args": {...}, "packages": {...}} as JSON, with defaults for what a call does not give."""


def is_xacro(path: Path) -> bool:
    """Whether a file is one by its name: a `.urdf` is never run through xacro."""
    return path.suffix.lower() == ".xacro"


def expanded(
    path: Path,
    args: Mapping[str, Any] | None = None,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
) -> Path:
    """The URDF that an xacro file expands to: a file of the same stem that lasts as long as the program.

    Parameters
    ----------
    path : Path
    args : mapping
        What ``$(arg name)`` stands for.
    packages : mapping
        Name -> folder of ROS packages; others are looked for above the file and in ROS_PACKAGE_PATH.

    Raises
    ------
    UrdfError
        With what xacro says of the file.
    DualpinError
        If the extra "xacro" is not installed.
    """
    given = _settings()
    mappings = {**given["args"], **{k: _text(k, x) for k, x in (args or {}).items()}}
    folders = {k: str(Path(x).expanduser().resolve()) for k, x in {**given["packages"], **(packages or {})}.items()}
    for name, folder in folders.items():
        if not Path(folder).is_dir():
            raise ArgumentError(f"package {name!r}: {folder} is no folder")
    try:
        stamp = path.stat()
    except OSError as e:
        raise UrdfError(f"{path}: cannot be read ({e.strerror or e})") from None
    where = os.environ.get("ROS_PACKAGE_PATH", "")
    key = (tuple(sorted(mappings.items())), tuple(sorted(folders.items())), where)
    text = _run(path.resolve(), key, stamp.st_size)
    stem = path.stem.removesuffix(".urdf") or "robot"
    return _kept(text, stem)


def _settings() -> dict[str, dict[str, str]]:
    """Settings for all files, from the command line or from the program that started this one."""
    try:
        said = json.loads(os.environ.get(SETTINGS, "{}"))
        return {key: {str(k): str(x) for k, x in said.get(key, {}).items()} for key in ("args", "packages")}
    except (ValueError, AttributeError):
        raise ArgumentError(f"{SETTINGS} is no JSON of args and packages: {os.environ[SETTINGS][:60]!r}") from None


def _text(name: Any, value: Any) -> str:
    """An argument as xacro takes it."""
    if not isinstance(name, str) or not name:
        raise ArgumentError(f"xacro_args: a name expected, got {name!r}")
    if isinstance(value, bool):
        return "true" if value else "false"
    if not isinstance(value, (str, int, float, os.PathLike)):
        raise ArgumentError(f"xacro_args: {name!r} is {value!r}; text, a number or a truth value expected")
    return str(value)


Key = tuple[tuple[tuple[str, str], ...], tuple[tuple[str, str], ...], str]


def _run(path: Path, key: Key, size: int) -> str:
    """The text of the URDF; not cached, since included files may have changed."""
    if size > MAX_BYTES:
        raise UrdfError(f"{path.name}: {size >> 20} MiB; files up to {MAX_BYTES >> 20} MiB are read")
    extra("xacrodoc", "xacro", f"{path.name}: an xacro file")
    args, packages, where = key
    job = {"file": str(path), "args": dict(args), "packages": dict(packages),
           "folders": [x for x in where.split(os.pathsep) if x]}  # fmt: skip
    try:
        done = subprocess.run(
            [sys.executable, worker.__file__], input=json.dumps(job), capture_output=True, text=True,
            encoding="utf-8", timeout=SECONDS, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise UrdfError(f"{path.name}: xacro did not end within {SECONDS:g} s") from None
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        said = done.stderr.strip().splitlines()
        raise UrdfError(f"{path.name}: xacro ended without an answer ({(said or ['no message'])[-1][:300]})") from None
    if "error" in answer:
        raise UrdfError(f"{path.name}: xacro: {_explained(answer['error'])}")
    return str(answer["text"])


def _explained(error: str) -> str:
    """Advice for the commonest errors."""
    text = " ".join(error.split())
    if "PackageNotFound" in text or "ResourceNotFound" in text:
        return f"{text}; say where it is: packages={{name: folder}} or `--package name=folder`, or in ROS_PACKAGE_PATH"
    if "Undefined substitution argument" in text:
        return f"{text}; give it: xacro_args={{name: value}} or `--xacro-arg name:=value`"
    return text


@cache
def _kept(text: str, stem: str) -> Path:
    """A file of that text; one for the same text and stem, so that a robot's source stays what it is."""
    folder = tempfile.mkdtemp(prefix="dualpin-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    path = Path(folder, f"{stem}.urdf")
    path.write_text(text, encoding="utf-8")
    return path
