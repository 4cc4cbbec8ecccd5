"""The differences of two robots."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

IDENTICAL, RENAMED, FRAMES, DYNAMICS, COORDINATES, DIFFERENT = (
    "identical", "same robot, other names or order", "same robot, other frames",
    "same dynamics, other parameters", "same robot, other coordinates", "different",
)  # fmt: skip


LONG = 40  # characters of a regrouped parameter in a line


@dataclass(frozen=True)
class Change:
    """One difference.

    Attributes
    ----------
    about : str
        "joint", "link", "limit", "body", "gravity" or "base".
    what : str
        In words: "renamed", "moved", "turned", "mass", "lower", "only in a", ...
    item : str
        The joint or link, by its name in a (or in b where it is only there).
    a, b : str
        What it is in either.
    says : str
        The sentence.
    amount : float
        How much, in the unit that the sentence names; 0 for what has none.
    counts : bool
        Whether it makes the robots different; False for names, order and frames.
    """

    about: str
    what: str
    item: str
    says: str
    a: str = ""
    b: str = ""
    amount: float = 0.0
    counts: bool = True

    def to_dict(self) -> dict[str, Any]:
        return {k: getattr(self, k) for k in ("about", "what", "item", "says", "a", "b", "amount", "counts")}


@dataclass(frozen=True)
class TermChange:
    """The largest change of one term over the states, and the state where it happens.

    Attributes
    ----------
    scaled : float
        max|b - a| / max(1, max|a|)
    where : str
        The entry in words.
    state : dict
        q, v, a of the first robot.
    """

    term: str
    amount: float
    unit: str
    scaled: float
    where: str
    state: dict[str, list[float]] = field(default_factory=dict, repr=False)

    def to_dict(self) -> dict[str, Any]:
        return dict(vars(self))

    def __str__(self) -> str:
        return f"{self.term}: {self.amount:.3g} {self.unit}{f' at {self.where}' if self.where else ''}"


@dataclass
class Diff:
    """Two robots compared; made by `dualpin.diff`.

    Attributes
    ----------
    verdict : str
        "identical", "same robot, other names or order", "same robot, other frames", "same dynamics, other
        parameters", "same robot, other coordinates" (a zero was moved, a joint counts the other way) or "different".
    changes : list of Change
        Those that count first, the largest first.
    terms : dict of TermChange
        By term; empty where the joints are not the same, `reason` says why.
    joints, links : dict
        Name in a -> name in b, or None.
    """

    a: str
    b: str
    verdict: str = IDENTICAL
    changes: list[Change] = field(default_factory=list)
    terms: dict[str, TermChange] = field(default_factory=dict)
    joints: dict[str, str | None] = field(default_factory=dict)
    links: dict[str, str | None] = field(default_factory=dict)
    base_parameters: dict[str, list[float]] = field(default_factory=dict)
    """Base parameters that differ: name -> [value in a, value in b]."""
    reason: str = ""
    trees: tuple[list[dict[str, Any]], list[dict[str, Any]]] = field(default=([], []), repr=False)

    @property
    def same(self) -> bool:
        """Whether both move alike under the same torques at the same q, independent of names and frames."""
        return self.verdict not in (DIFFERENT, COORDINATES)

    @property
    def identical(self) -> bool:
        return self.verdict == IDENTICAL

    def to_dict(self) -> dict[str, Any]:
        return {
            "a": self.a, "b": self.b, "verdict": self.verdict, "same": self.same,
            "changes": [c.to_dict() for c in self.changes],
            "terms": {k: x.to_dict() for k, x in self.terms.items()},
            "joints": self.joints, "links": self.links, "base_parameters": self.base_parameters, "reason": self.reason,
        }  # fmt: skip

    def to_html(self) -> str:
        """A page with both trees side by side."""
        from ...delegates import home

        return home("Diff.to_html")(self)

    def __str__(self) -> str:
        lines = [f"{c.about} {c.item!r}: {c.says}" if c.item else f"{c.about}: {c.says}" for c in self.changes]
        if self.terms:
            lines.append("largest changes: " + "; ".join(map(str, self.terms.values())))
        if self.base_parameters:
            first = [n if len(n) <= LONG else n[: LONG - 4] + " ..." for n in self.base_parameters][:4]
            lines.append(f"{len(self.base_parameters)} base parameters differ: {', '.join(first)}")
        if self.reason:
            lines.append(f"terms not compared: {self.reason}")
        return "\n".join([*lines, f"{self.a} and {self.b}: {self.verdict}"])
