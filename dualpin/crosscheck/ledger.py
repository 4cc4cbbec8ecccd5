"""Intermediate results of a judgement, line by line on disk, so that an interrupted one can be resumed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..files import write_text, writing

KEPT = "judged.jsonl"


class Ledger:
    """The entries of a run, by key; those of an earlier run with the same settings are there from the start.

    Parameters
    ----------
    folder : Path, optional
        Where ``judged.jsonl`` stands; nothing is kept without one.
    settings : mapping
        What a run must share with an interrupted one to take up what that has left.

    Raises
    ------
    ArgumentError
        If the folder cannot be written.
    """

    def __init__(self, folder: Path | None, settings: Mapping[str, Any]) -> None:
        self.path = None if folder is None else folder / KEPT
        self.entries = _left(self.path, settings) if self.path else {}
        self._file = _opened(self.path, settings, self.entries) if self.path else None

    def add(self, key: str, data: Any) -> None:
        """One entry more, on disk before this returns."""
        self.entries[key] = data
        if self._file:
            self._file.write(json.dumps({"key": key, "data": data}) + "\n")
            self._file.flush()

    def close(self, *, done: bool = False) -> None:
        """Close the file; a finished run leaves none."""
        if self._file and self.path:
            self._file.close()
            if done:
                self.path.unlink(missing_ok=True)


def _left(path: Path, settings: Mapping[str, Any]) -> dict[str, Any]:
    """What an interrupted run with the same settings left behind."""
    found: dict[str, Any] = {}
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        if json.loads(lines[0]) != json.loads(json.dumps(settings)):
            return {}
        for line in lines[1:]:
            entry = json.loads(line)
            found[entry["key"]] = entry["data"]
    except (OSError, ValueError, LookupError, TypeError):
        pass  # nothing there, or the last line was cut off: what was read before it counts
    return found


def _opened(path: Path, settings: Mapping[str, Any], entries: Mapping[str, Any]) -> Any:
    with writing(f"cannot write into {path.parent}"):
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = [settings, *({"key": key, "data": data} for key, data in entries.items())]
        write_text(path, "".join(json.dumps(x) + "\n" for x in lines))
        return path.open("a", encoding="utf-8")
