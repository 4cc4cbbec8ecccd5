"""Writing files: always in UTF-8, and completely or not at all."""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import ArgumentError, DualpinError


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text as UTF-8 to a temporary file, which is then renamed, so that the file is never incomplete.

    Line ends are written as they are.  What has no place in UTF-8 (lone surrogates, as in names of files
    that are no text) is written as an escape.

    Raises
    ------
    OSError
        If it cannot be written; an earlier file is then unchanged.
    """
    with replacing(path) as beside:
        beside.write_bytes(text.encode("utf-8", "backslashreplace"))


@contextmanager
def writing(failure: str, error: type[DualpinError] = ArgumentError) -> Iterator[None]:
    """Says what failed, and why, where a file within cannot be written."""
    try:
        yield
    except OSError as e:
        raise error(f"{failure} ({e.strerror or e})") from None


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside `path`, renamed at the end and removed after an error.

    Links are followed.  Devices and pipes are written directly, since they cannot be replaced.
    """
    target = Path(os.path.realpath(path))
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        mode = None
    if mode is not None and not stat.S_ISREG(mode):
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(21, "Is a directory", str(path))
        yield target
        return
    if mode is not None and not os.access(target, os.W_OK):
        raise PermissionError(13, "Permission denied", str(path))
    beside = target.with_name(f".{secrets.token_hex(4)}-{target.name[-40:]}")
    os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    try:
        yield beside
        if mode is not None:
            beside.chmod(stat.S_IMODE(mode))
        beside.replace(target)
    except BaseException:
        with suppress(OSError):
            beside.unlink()
        raise
