"""Answers that an interrupted judgement left behind."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..ledger import Ledger
from .answers import Answers


class Kept:
    """Answers of one subject that an interrupted judgement left, and where new ones are kept.

    Parameters
    ----------
    ledger : Ledger, optional
        Nothing is kept without one.
    key : str
        Of the subject.
    """

    def __init__(self, ledger: Ledger | None = None, key: str = "") -> None:
        self.ledger, self.key = ledger or Ledger(None, {}), key

    def restore(self, term: str, answers: Answers) -> bool:
        """Whether the term was answered by this version of the subject before; then it is taken from there."""
        entry = self.ledger.entries.get(f"{self.key}|{term}")
        if entry is None or entry["version"] != answers.version:
            return False
        if "silent" in entry:
            answers.silent[term] = entry["silent"]
        else:
            answers.take(term, None if entry["x"] is None else np.array(entry["x"]), entry["note"])
        return True

    def answer(self, term: str, answers: Answers, x: np.ndarray | None, note: Mapping[str, Any]) -> None:
        x = None if x is None else x.tolist()
        self.ledger.add(f"{self.key}|{term}", {"version": answers.version, "x": x, "note": dict(note)})

    def silent(self, term: str, answers: Answers, why: str) -> None:
        self.ledger.add(f"{self.key}|{term}", {"version": answers.version, "silent": why})
