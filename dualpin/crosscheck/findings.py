"""Findings of a diagnosis, in words and as data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from typing import Any

CONVENTIONS = frozenset({
    "rows", "reference_world", "reference_local", "reference_local_world_aligned", "order", "quaternion",
    "base_order",
    "angular_body", "angular_world", "linear_body", "linear_world", "linear_origin", "base_at_com", "in_base", "mimic",
    "spatial_acceleration",
    "no_gravity_in_bias", "about_origin", "base_counts", "potential_offset", "coriolis_other", "same_cv",
    "same_product", "upper", "lower", "inverse_pose", "at_com",
})  # fmt: skip
"""Keys that name another convention, not a mistake: such a difference reads "agrees under another convention"."""

SEARCHED = ("diagnosis: ", "refusal: ")
"""How remarks begin that say what a search for causes took: of no later judgement."""


@dataclass
class Finding:
    """One cause of differences between a subject and dualpin.

    Attributes
    ----------
    key : str
        Of the table of keys: "gravity", "rows", "inertial_rpy", ...; "partly" for one that explains part.
    says : str
        The cause, in words.
    terms : list of str
        The terms it explains.
    before, after : float
        The largest scaled error of these terms, without and with it (and what else was found).
    items : list of str
        The links or joints it is about; empty for all.
    alternatives : list of str
        What would explain the same answers as well.
    apart : dict
        A state at which the first alternative that differs would give something else: q, v, a, tau in the
        subject's columns, and what to look at.  Empty where no state distinguishes them.
    fix : str
        What to change in the subject's call or in the file.
    evidence : dict
        Of each term, the errors before and after.
    subject : str
        Whose it is.
    """

    key: str
    says: str
    terms: list[str] = field(default_factory=list)
    before: float = 0.0
    after: float = 0.0
    items: list[str] = field(default_factory=list)
    alternatives: list[str] = field(default_factory=list)
    apart: dict[str, Any] = field(default_factory=dict)
    fix: str = ""
    evidence: dict[str, list[float]] = field(default_factory=dict)
    subject: str = ""

    @classmethod
    def of(cls, data: Finding | dict[str, Any]) -> Finding:
        """From what was written, in this version or another."""
        if isinstance(data, Finding):
            return data
        known = {f.name for f in fields(cls)}
        return cls(**{k: x for k, x in data.items() if k in known})

    def __str__(self) -> str:
        falls = f" ({', '.join(self.terms)}: {self.before:.0e} -> {self.after:.0e})" if self.terms else ""
        return f"{self.says}{falls}"


def once(findings: Iterable[Finding]) -> list[Finding]:
    """Each only once."""
    found: list[Finding] = []
    for f in findings:
        if f not in found:
            found.append(f)
    return found
