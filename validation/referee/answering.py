"""Answers of libraries, asked once and kept: the table is judged from them, again whenever judging gets better."""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from dualpin.crosscheck.subjects import Answers, Asking, environments
from dualpin.crosscheck.subjects.kept import plain, restored
from dualpin.crosscheck.subjects.resolve import resolve
from dualpin.files import write_text

LIMIT = 120.0
"""Seconds that a term of one robot may take before the library counts as hanging."""


class Cell:
    """One library and one robot: what it answered, and which rewritten files it reads.

    Another version of the library, another adapter, another file of the robot or other states are another cell.
    """

    def __init__(self, subject: str, adapter: environments.Environment, asking: Asking, folder: Path) -> None:
        self.adapter, self.asking = adapter, asking
        self.ask = resolve(subject, limit=LIMIT)
        states = {k: asking.states[k].tolist() for k in ("q", "v", "a", "tau")}  # f_ext is drawn apart from them
        source = adapter.adapter.read_text(encoding="utf-8")
        of = [subject, adapter.requires, source, asking.text, asking.floating, asking.gravity, asking.frames, states]
        self.path = folder / "answers" / f"{hashlib.sha256(json.dumps(of).encode()).hexdigest()[:24]}.json"
        self.kept: dict[str, Any] = {"answers": None, "terms": [], "reads": {}}
        if self.path.exists():
            self.kept |= json.loads(self.path.read_text(encoding="utf-8"))

    @property
    def missing(self) -> tuple[str, ...]:
        """Terms that the library's adapter has and that it was not asked yet."""
        has = environments.terms(self.adapter.adapter, self.asking.terms)
        return tuple(t for t in has if t not in self.kept["terms"])

    def answers(self) -> Answers:
        """From what is kept; the library is asked what is missing."""
        missing, kept = self.missing, self.kept["answers"]
        if kept is None or missing:
            if kept is None or not kept["refused"]:
                new = plain(self.ask(replace(self.asking, terms=missing), _shown))
                if kept:
                    joined = ("states", "sent", "terms", "silent", "remarks", "history")
                    new = {**new, **{k: kept[k] | new[k] for k in joined}}
                self.kept["answers"] = new
            self.kept["terms"] += missing
            self._save()
        return restored(self.kept["answers"], self.asking)

    def refusal(self, asking: Asking, seconds: float) -> str:
        """Why the library does not read a rewritten file; asked once."""
        key = hashlib.sha256(asking.text.encode()).hexdigest()[:24]
        if key not in self.kept["reads"]:
            assert self.ask.refusal is not None  # a library has a process of its own
            self.kept["reads"][key] = self.ask.refusal(asking, seconds)
            self._save()
        return str(self.kept["reads"][key])

    def _save(self) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        write_text(self.path, json.dumps(self.kept))


def _shown(what: str) -> None:
    if sys.stderr.isatty():
        print(f"  {what}", file=sys.stderr, flush=True)
