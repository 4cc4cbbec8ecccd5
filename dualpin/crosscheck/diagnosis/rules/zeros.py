"""Rows and columns that are never written: what belongs to a joint is zero in every state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...subjects.questions import QUESTIONS
from ..case import Case, View
from ..hypothesis import Hypothesis
from .register import proposer

ROWS = ("force", "pushed_force", "bias", "acceleration", "pushed_acceleration")
COLUMNS = ("columns", "six", "six_rate")
BOTH = ("matrix", "coriolis")
"""Forms of answers by which of their axes belong to joints."""


Lost = tuple[np.ndarray, np.ndarray]
"""Of each velocity, whether its row and its column are zero; where there are no rows, none is."""


def _never_written(x: np.ndarray, form: str) -> Lost:
    columns = (x == 0).reshape(-1, x.shape[-1]).all(0)
    return (x == 0).all(axis=(0, -1)) if form in BOTH else np.zeros_like(columns), columns


@proposer(
    "zeros", "what belongs to some joints is zero in every state, as if nothing were written there",
    "look which joints the loop leaves out",
)  # fmt: skip
def zeros(h: Hypothesis, case: Case) -> list[Hypothesis]:
    of: dict[tuple[str, ...], dict[str, Lost]] = {}
    for term, x in case.observed.items():
        form, p = QUESTIONS[term].form, case.predict(term)
        if form not in (*ROWS, *COLUMNS, *BOTH) or p is None or p.shape != x.shape or x.shape[-1] != len(case.how.v):
            continue
        rows, columns = (
            zero & ~known for zero, known in zip(_never_written(x, form), _never_written(p, form), strict=True)
        )
        lost = rows | columns
        if lost.any() and not lost.all():
            names = tuple(n for n, is_lost in zip(case.how.v, lost, strict=True) if is_lost)
            of.setdefault(names, {})[term] = rows, columns

    def one(names: tuple[str, ...], lost: dict[str, Lost]) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            rows, columns = lost[term]
            return x * ~columns * (~rows[:, None] if QUESTIONS[term].form in BOTH else 1)

        return replace(h, terms=tuple(lost), place="answer", act=act, items=names, cost=1.25)

    return [one(names, lost) for names, lost in of.items()]
