"""The findings of a check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

ERROR, WARNING, NOTE = "error", "warning", "note"
SEVERITIES = (NOTE, WARNING, ERROR)
"""In ascending order."""


@dataclass(frozen=True)
class Edit:
    """A new value of an attribute of an element, which is given by its index in the order of start tags."""

    element: int
    attribute: str
    value: str


@dataclass(frozen=True)
class Effect:
    """The effect of a fault on a term: the largest change over some states, and where.

    Attributes
    ----------
    term : str
        "gravity", "rnea", "crba" or "fk"; empty where no term is concerned.
    amount : float
        In `unit`.
    says : str
        The sentence.
    """

    term: str
    amount: float
    unit: str
    says: str


@dataclass
class Finding:
    """One fault of a description.

    Attributes
    ----------
    rule : str
        Its id in `dualpin.analysis.check.RULES`.
    severity : str
        "error", "warning" or "note".
    says : str
        What is the case.
    file, line, item : str, int or None, str
        Where: the file, the line in it, the link or joint ("link 'hand'").
    why : str
        Its effect on a term, with a number if there is one.
    effect : Effect or None
        That number.
    fix : str
        What to change.
    edits : sequence of Edit
        The change itself, where it is certain.
    """

    rule: str
    severity: str
    says: str
    item: str = ""
    file: str = ""
    line: int | None = None
    why: str = ""
    effect: Effect | None = None
    fix: str = ""
    edits: Sequence[Edit] = field(default=(), repr=False)

    @property
    def certain(self) -> bool:
        """Whether `--fix` may make the change."""
        return bool(self.edits)

    @property
    def where(self) -> str:
        return ":".join(str(x) for x in (self.file, self.line) if x)

    def to_dict(self) -> dict[str, Any]:
        found = {
            k: getattr(self, k) for k in ("rule", "severity", "says", "item", "file", "line", "why", "fix", "certain")
        }
        effect = self.effect
        found["effect"] = effect and {"term": effect.term, "amount": effect.amount, "unit": effect.unit}
        return found

    def __str__(self) -> str:
        head = ": ".join(x for x in (self.where, f"{self.severity} [{self.rule}]", self.item, self.says) if x)
        return "\n".join([head, *(f"    {k}: {x}" for k, x in (("why", self.why), ("fix", self.fix)) if x)])


@dataclass
class Checked:
    """The findings about one robot or file; a sequence of them.

    Attributes
    ----------
    name : str
        Of the robot or file.
    findings : list of Finding
        In the order of the file.
    links, joints : int
        How many were looked at.
    """

    name: str
    findings: list[Finding] = field(default_factory=list)
    links: int = 0
    joints: int = 0
    text: str | None = field(default=None, repr=False)
    """The original text, if its elements can be edited individually."""
    notes: list[str] = field(default_factory=list)
    """What could not be checked, and why."""

    @property
    def passed(self) -> bool:
        """Whether nothing was found."""
        return not self.findings

    def __iter__(self) -> Any:
        return iter(self.findings)

    def __len__(self) -> int:
        return len(self.findings)

    def __getitem__(self, at: Any) -> Any:
        return self.findings[at]

    def at_least(self, severity: str) -> Checked:
        """Only findings of at least this severity."""
        least = SEVERITIES.index(severity)
        kept = [f for f in self.findings if SEVERITIES.index(f.severity) >= least]
        return Checked(self.name, kept, self.links, self.joints, self.text, self.notes)

    def to_dict(self) -> dict[str, Any]:
        return {
            "name": self.name, "passed": self.passed, "links": self.links, "joints": self.joints,
            "findings": [f.to_dict() for f in self.findings], "notes": self.notes,
        }  # fmt: skip

    def __str__(self) -> str:
        count = len(self.findings)
        total = "nothing found" if not count else f"{count} finding{'s' if count > 1 else ''}"
        lines = [*map(str, self.findings), *(f"{self.name}: note: {n}" for n in self.notes)]
        return "\n".join([*lines, f"{self.name}: {total} ({self.links} links, {self.joints} joints)"])
