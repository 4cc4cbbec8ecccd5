"""Causes that more wrong answers contradict than they explain."""

from __future__ import annotations

from collections.abc import Mapping

from ..findings import Finding
from .case import Case
from .hypothesis import Hypothesis
from .rules.register import DERIVED, PUSHED
from .scores import scaled
from .spared import READ
from .stories import Explanation

SHOWN_BY = ("fk", "jacobian", "com")
"""Terms that are made of nothing but what was read: the first that was answered shows it."""
NEARER = 0.7
"""The share of the root mean square that a cause leaves at most where something else is wrong as well."""


def contradicted(case: Case, h: Hypothesis, told: Mapping[str, Explanation]) -> list[str]:
    """Of terms without a cause: those that a mistake in reading would have changed, and that it does not bring nearer.

    None, where what is made of positions and the file alone does not contradict it.
    """
    out = []
    unknown = [t for t, e in told.items() if not e.named and t not in (*PUSHED, *DERIVED)]
    for term in (t for t in unknown if t in h.terms and h.place in READ):
        x, p = case.predict(term, (h,)), case.predict(term)
        changed = x is not None and p is not None and (x.shape != p.shape or scaled(x, p) > case.tolerance)
        if changed and not case.score(term, (h,)).rms < NEARER * told[term].before.rms:
            out.append(term)
    shown = next((t for t in SHOWN_BY if t in case.observed), "")
    return out if shown in out else []


def doubtful(
    h: Hypothesis, terms: list[str], against: list[str], errors: Mapping[str, float], after: Mapping[str, float]
) -> Finding:
    """A cause that more wrong answers contradict than it explains."""
    says = f"partly: {h} would explain {', '.join(terms)}, but not {', '.join(against)}"
    evidence = {t: [errors[t], after[t]] for t in terms}
    before, left = max(errors[t] for t in terms), max(after.values())
    return Finding("partly", says, terms, before, left, list(h.items), fix=h.fix, evidence=evidence)
