"""`-` for ROBOT: the URDF on standard input, as a file that every command and Pinocchio can open."""

from __future__ import annotations

import atexit
import shutil
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import TypeVar

from ..errors import UrdfError

DASH = "-"
Names = TypeVar("Names", str, "list[str]", "list[str] | None")


def named(value: Names) -> Names:
    """The names that were given, standard input as the path of a copy of it."""
    if isinstance(value, list):
        return [_file() if name == DASH else name for name in value]
    return _file() if value == DASH else value


@cache
def _file() -> str:
    from ..io.xml import MAX_BYTES

    data = sys.stdin.buffer.read(MAX_BYTES + 1)
    if not data.strip():
        raise UrdfError("standard input: a URDF expected, it is empty")
    folder = tempfile.mkdtemp(prefix="dualpin-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    path = Path(folder, "stdin.urdf")
    path.write_bytes(data)
    return str(path)
