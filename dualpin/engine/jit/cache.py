"""Compiled kernels, and other things that take long to make, kept between runs.

There is one file for each kernel.  It holds machine code, so it is used only if no other user could have written it
and it is undamaged: the folder belongs to the user and is not writable by others, the file names the machine, the
compiler, the sources and the robot for which it was made, and a checksum covers all.  Any other file is compiled again.
Files are written by an atomic rename, so concurrent processes never read an incomplete one.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import stat
import tempfile
import warnings
from functools import cache
from pathlib import Path
from typing import Any

from ...errors import DualpinWarning

SUFFIX = ".kernel"
_MAGIC = b"dualpin kernel 1\n"
OTHERS = ("calls", "slips")
"""What is kept besides kernels."""


def folder(room: str = "kernels") -> Path:
    """The folder of kernels, or of one of `OTHERS`: in ``DUALPIN_CACHE_DIR``, or in the platform's cache folder."""
    chosen = os.environ.get("DUALPIN_CACHE_DIR")
    return (Path(chosen).expanduser() if chosen else _usual_folder()) / room


@cache
def _usual_folder() -> Path:
    import platformdirs

    return Path(platformdirs.user_cache_dir("dualpin", appauthor=False))


def info() -> dict[str, Any]:
    """The cache as plain data.

    Returns
    -------
    dict
        "folder" (str), "usable" (bool), "reason" (str, why it is not), "kernels" (int), "bytes" (int).

    Examples
    --------
    >>> from dualpin.engine.jit import cache
    >>> sorted(cache.info())
    ['bytes', 'folder', 'kernels', 'reason', 'usable']
    """
    place = folder()
    reason = refusal(place) if place.exists() else ""
    sizes = [f.stat().st_size for f in _files(place)]
    return {
        "folder": str(place), "usable": not reason, "reason": reason, "kernels": len(sizes), "bytes": sum(sizes),
    }  # fmt: skip


def clear() -> dict[str, Any]:
    """Remove every kernel; returns {"folder", "removed" (int), "bytes" (int)}."""
    for f in (f for room in OTHERS for f in _files(folder(room))):
        with contextlib.suppress(OSError):
            f.unlink()
    place, removed, size = folder(), 0, 0
    for f in _files(place):
        with contextlib.suppress(OSError):
            one = f.stat().st_size
            f.unlink()
            removed, size = removed + 1, size + one
    return {"folder": str(place), "removed": removed, "bytes": size}


def _files(place: Path) -> list[Path]:
    try:
        return sorted(f for f in place.iterdir() if f.suffix == SUFFIX and f.is_file())
    except OSError:
        return []


def refusal(place: Path) -> str:
    """Why the folder cannot be trusted with machine code, or an empty string."""
    try:
        about = place.lstat()
    except OSError as e:
        return f"{place}: {e.strerror or e}"
    if not stat.S_ISDIR(about.st_mode):
        return f"{place} is not a folder of its own"
    if hasattr(os, "geteuid"):
        if about.st_uid != os.geteuid():
            return f"{place} belongs to another user"
        if about.st_mode & 0o022:
            return f"{place} may be written by others (mode {stat.S_IMODE(about.st_mode):04o}); chmod go-w would do"
    return ""


@cache
def _announce(message: str) -> None:
    warnings.warn(message, DualpinWarning, stacklevel=4)


def load(key: str, room: str = "kernels") -> tuple[dict[str, Any], bytes] | None:
    """The content stored under this key, or None if it has to be made."""
    place = folder(room)
    path = place / _name(key)
    try:
        with open(path, "rb", opener=_opened) as f:
            reason = refusal(place) or _doubtful(path, os.fstat(f.fileno()))
            content = b"" if reason else f.read()
    except FileNotFoundError:
        return None
    except OSError as e:
        _announce(f"{_cache(room)}: {path.name} cannot be read ({e.strerror or e}); made anew")
        return None
    if reason:
        _announce(f"{_cache(room)} not used: {reason}")
        return None
    try:
        return unpacked(key, content)
    except ValueError as e:
        _announce(f"{_cache(room)}: {path.name} is damaged ({e}); made anew")
        with contextlib.suppress(OSError):
            path.unlink()
        return None


def _cache(room: str) -> str:
    return f"{room.removesuffix('s')} cache"


def _opened(path: str, flags: int) -> int:
    """Opened without following a link and without waiting, as for the other end of a pipe."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))


def _doubtful(path: Path, about: os.stat_result) -> str:
    """Why a file that is open is not read, or an empty string."""
    if not stat.S_ISREG(about.st_mode):
        return f"{path} is no regular file"
    if hasattr(os, "geteuid") and (about.st_uid != os.geteuid() or about.st_mode & 0o022):
        return f"{path} is not this user's alone"
    return ""


def stored(key: str, room: str = "kernels") -> bool:
    """Whether there is a file for this key; `load` checks it."""
    return (folder(room) / _name(key)).exists()


def store(key: str, about: dict[str, Any], code: bytes, room: str = "kernels") -> None:
    """Store a kernel, or what else is made; if that is impossible, warn once and continue."""
    place = folder(room)
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        reason = refusal(place)
        if reason:
            _announce(f"{_cache(room)} not used: {reason}")
            return
        handle, name = tempfile.mkstemp(dir=place, suffix=".new")  # mode 0600
        try:
            with os.fdopen(handle, "wb") as f:
                f.write(packed(key, about, code))
            Path(name).replace(place / _name(key))
        except BaseException:
            with contextlib.suppress(OSError):
                Path(name).unlink()
            raise
    except OSError as e:
        _announce(f"{_cache(room)} not written: {place}: {e.strerror or e}")


def _name(key: str) -> str:
    return hashlib.sha256(key.encode()).hexdigest()[:40] + SUFFIX


def packed(key: str, about: dict[str, Any], code: bytes) -> bytes:
    """Magic line, checksum of the rest, one line of JSON, the object code."""
    rest = json.dumps({"key": key, "about": about}).encode() + b"\n" + code
    return _MAGIC + hashlib.sha256(rest).hexdigest().encode() + b"\n" + rest


def unpacked(key: str, content: bytes) -> tuple[dict[str, Any], bytes]:
    """The inverse of `packed`; `ValueError` for any other content or key."""
    magic, checksum, rest = content[: len(_MAGIC)], content[len(_MAGIC) : len(_MAGIC) + 65], content[len(_MAGIC) + 65 :]
    if magic != _MAGIC:
        raise ValueError("not a kernel of this format")
    if hashlib.sha256(rest).hexdigest().encode() + b"\n" != checksum:
        raise ValueError("the checksum does not fit")
    header, _, code = rest.partition(b"\n")
    entry = json.loads(header)
    if not isinstance(entry, dict) or entry.get("key") != key or not isinstance(entry.get("about"), dict):
        raise ValueError("made for something else")
    return entry["about"], code
