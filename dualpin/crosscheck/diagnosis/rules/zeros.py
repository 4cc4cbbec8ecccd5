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


def _never_written(x: np.ndarray, form: str) -> np.ndarray:
    """Of each velocity, whether all that belongs to it is zero."""
    nv = x.shape[-1]
    zero = (x == 0).reshape(-1, nv).all(0)
    return zero & (x == 0).all(axis=(0, -1)) if form in BOTH else zero


@proposer(
    "zeros", "what belongs to some joints is zero in every state, as if nothing were written there",
    "look which joints the loop leaves out",
)  # fmt: skip
def zeros(h: Hypothesis, case: Case) -> list[Hypothesis]:
    of: dict[tuple[str, ...], list[str]] = {}
    for term, x in case.observed.items():
        form, p = QUESTIONS[term].form, case.predict(term)
        if form not in (*ROWS, *COLUMNS, *BOTH) or p is None or p.shape != x.shape or x.shape[-1] != len(case.how.v):
            continue
        lost = _never_written(x, form) & ~_never_written(p, form)
        if lost.any() and not lost.all():
            names = tuple(n for n, is_lost in zip(case.how.v, lost, strict=True) if is_lost)
            of.setdefault(names, []).append(term)

    def one(names: tuple[str, ...], terms: list[str]) -> Hypothesis:
        kept = np.array([float(n not in names) for n in case.how.v])

        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            return x * kept * kept[:, None] if QUESTIONS[term].form in BOTH else x * kept

        return replace(h, terms=tuple(terms), place="answer", act=act, items=names, cost=1.25)

    return [one(names, terms) for names, terms in of.items()]
