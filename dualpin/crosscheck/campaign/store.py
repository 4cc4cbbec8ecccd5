"""A store of results: one SQLite file, to which rows are only added.

A row is written whole or not at all, also when the process is killed.  A unit that is done twice
counts once.  Several campaigns, also running ones, may share a file.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
import time
import zlib
from collections import Counter
from collections.abc import Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import ArgumentError
from ..units import Result, Unit, packed, unpacked

TABLES = """
CREATE TABLE IF NOT EXISTS campaigns (id TEXT PRIMARY KEY, settings TEXT, units INTEGER, begun REAL);
CREATE TABLE IF NOT EXISTS results (
    campaign TEXT, unit TEXT, verdict TEXT, at REAL, result BLOB, PRIMARY KEY (campaign, unit)
) WITHOUT ROWID;
"""
PATIENCE = 60.0
"""Seconds to wait for another process that writes."""


@dataclass(frozen=True)
class Progress:
    """How far a campaign is.

    Attributes
    ----------
    settings : dict
        What it was asked.
    units, done : int
        Of the work, and of those the finished ones.
    verdicts : dict
        How many finished units have which verdict.
    rate : float
        Units a minute, over the last hundred.
    """

    id: str
    settings: dict[str, Any]
    units: int
    done: int
    verdicts: dict[str, int]
    begun: float
    latest: float
    rate: float

    @property
    def remaining(self) -> float:
        """Minutes, at this rate."""
        return (self.units - self.done) / self.rate if self.rate else float("inf" if self.done < self.units else 0)


class Store:
    """A file of results; without a path, in memory.

    Parameters
    ----------
    path : path, optional
        Is made where it does not exist.  On a disk of this machine: SQLite's locks do not hold on all network drives.

    Raises
    ------
    ArgumentError
        If the file cannot be opened or is no store.
    """

    def __init__(self, path: str | Path | None = None) -> None:
        self.path = None if path is None else Path(path)
        with self._spoken():
            if self.path is not None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = sqlite3.connect(":memory:" if self.path is None else self.path, timeout=PATIENCE)
            self._file.executescript(TABLES)

    @contextmanager
    def _spoken(self) -> Any:
        """SQLite's errors with the file's name, and what to do."""
        try:
            yield
        except sqlite3.DatabaseError as e:
            full = "full" in str(e) or "I/O" in str(e)
            advice = "; what was written before is kept, and the same command takes it up" if full else ""
            raise ArgumentError(f"campaign: {self.path or 'the store in memory'}: {e}{advice}") from None
        except OSError as e:
            raise ArgumentError(f"campaign: cannot write into {e.filename or self.path} ({e.strerror or e})") from None

    def campaign(self, settings: str, units: int, keys: Iterable[str] = ()) -> str:
        """The identity of a campaign by its settings and keys; it is entered where it is new."""
        name = hashlib.sha256("\n".join([settings, *sorted(keys)]).encode()).hexdigest()[:16]
        entry = "INSERT INTO campaigns VALUES (?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET units = max(units, ?)"
        with self._spoken(), self._file:
            self._file.execute(entry, (name, settings, units, time.time(), units))
        return name

    def add(self, campaign: str, unit: Unit, result: Result) -> None:
        """Enter a result; one that is there already stays."""
        text = zlib.compress(json.dumps(packed(result)).encode(), 1)
        verdict = getattr(result, "verdict", "refused")
        with self._spoken(), self._file:
            self._file.execute(
                "INSERT OR IGNORE INTO results VALUES (?, ?, ?, ?, ?)", (campaign, unit.key, verdict, time.time(), text)
            )

    def done(self, campaign: str) -> set[str]:
        """The keys of the units that are finished."""
        with self._spoken():
            return {key for (key,) in self._file.execute("SELECT unit FROM results WHERE campaign = ?", (campaign,))}

    def result(self, campaign: str, unit: Unit) -> Result | None:
        query = "SELECT result FROM results WHERE campaign = ? AND unit = ?"
        with self._spoken():
            found = self._file.execute(query, (campaign, unit.key)).fetchone()
        return unpacked(json.loads(zlib.decompress(found[0]))) if found else None

    def progress(self) -> list[Progress]:
        """Of every campaign in the file, the latest last."""
        with self._spoken():
            return [
                self._progress(*row)
                for row in self._file.execute("SELECT id, settings, units, begun FROM campaigns ORDER BY begun")
            ]

    def _progress(self, name: str, settings: str, units: int, begun: float) -> Progress:
        rows = self._file.execute("SELECT verdict, at FROM results WHERE campaign = ? ORDER BY at", (name,)).fetchall()
        times = [at for _, at in rows]
        last = times[-100:] if len(times) > 100 else [begun, *times]
        span = last[-1] - last[0]
        rate = 60 * (len(last) - 1) / span if span > 0 else 0.0
        counts = dict(Counter(verdict for verdict, _ in rows))
        latest = times[-1] if times else begun
        return Progress(name, json.loads(settings), units, len(rows), counts, begun, latest, rate)

    def close(self) -> None:
        self._file.close()
