"""Answers as plain data, kept from an interrupted judgement, or to be judged again later."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..ledger import Ledger
from .answers import Answers
from .asking import Asking
from .convention import Convention

SAID = ("name", "version", "silent", "remarks", "history", "refused", "seconds", "calls")


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


def plain(answers: Answers) -> dict[str, Any]:
    """All that a subject said and was asked: which robot, since it may not know some joints, and which states."""
    asking = answers.asking
    return {k: getattr(answers, k) for k in SAID} | {
        "how": answers.how.to_dict(),
        "text": asking.text,
        "frames": list(asking.frames),
        "states": _lists(asking.states),
        "sent": _lists(answers.sent),
        "terms": _lists(answers.terms),
    }


def restored(data: Mapping[str, Any], asked: Asking) -> Answers:
    """The answers that `plain` wrote, to what was asked of the same robot."""
    asking = asked if data["text"] == asked.text else asked.of_text(data["text"])
    asking = asking.at(_arrays(data["states"]), tuple(data["frames"]))
    return Answers(
        how=Convention(**data["how"]), asking=asking, sent=_arrays(data["sent"]), terms=_arrays(data["terms"]),
        **{k: data[k] for k in SAID},
    )  # fmt: skip


def _lists(arrays: Mapping[str, np.ndarray]) -> dict[str, Any]:
    return {k: x.tolist() for k, x in arrays.items()}


def _arrays(lists: Mapping[str, Any]) -> dict[str, np.ndarray]:
    return {k: np.array(x, float) for k, x in lists.items()}
