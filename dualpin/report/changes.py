"""What changed between two results."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from ..delegates import home

LAST_DIGITS = 1e-14
"""An error below this is a few roundings of the largest entry; its changes are not significant."""


@dataclass(frozen=True)
class Change:
    """One difference.

    Attributes
    ----------
    what : str
        "verdict", "error", "speed", "evaluations", "model" (a body, joint or limit is another), "remark" (of the
        loader, or about a run), "missing" or "new".
    where : str
        The robot and the term, or the setting.
    old, new : str
        As they were, as they are.
    worse : bool
        Whether it is worse by more than the threshold.
    factor : float
        How many times larger the new figure is; 1 where that has no meaning.
    """

    what: str
    where: str
    old: str
    new: str
    worse: bool
    factor: float = 1.0


@dataclass(repr=False)
class Comparison:
    """All differences of two results, the worst first.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.report import compare, Study
    >>> report = dp.validate("ur5", samples=2, terms=["fk"])
    >>> compare(report, report).passed
    True
    """

    old: dict[str, str]
    new: dict[str, str]
    changes: list[Change] = field(default_factory=list)
    compared: int = 0
    error_factor: float = 10.0
    speed_factor: float = 1.1

    @property
    def worse(self) -> list[Change]:
        return [c for c in self.changes if c.worse]

    @property
    def passed(self) -> bool:
        """Whether nothing is worse past the thresholds."""
        return not self.worse

    @property
    def versions(self) -> list[tuple[str, str, str]]:
        """(name, old, new) of the versions and machines that differ."""
        names = dict.fromkeys([*self.old, *self.new])
        pairs = [(n, self.old.get(n, "–"), self.new.get(n, "–")) for n in names]
        return [p for p in pairs if p[1] != p[2]]

    def changed(self, what: str, where: str, old: str, new: str, factor: float) -> Iterator[Change]:
        """The change of a figure, if it is past the threshold."""
        most = self.error_factor if what == "error" else self.speed_factor
        if factor > most or factor < 1 / most:
            yield Change(what, where, old, new, factor > 1, factor)

    def __repr__(self) -> str:
        verdict = "nothing got worse" if self.passed else f"{len(self.worse)} got worse"
        return f"<Comparison: {verdict}, {len(self.changes)} changes, {self.compared} figures compared>"

    def _repr_html_(self) -> str:
        return str(home("Comparison._repr_html_")(self))

    def plot(self, axes: Any = None) -> Any:
        """Draw by which factor figures changed; returns the axes.  Needs ``pip install 'dualpin[figures]'``."""
        return home("Comparison.plot")(self, axes)

    def to_dict(self) -> dict[str, Any]:
        return {
            "passed": self.passed,
            "compared": self.compared,
            "error_factor": self.error_factor,
            "speed_factor": self.speed_factor,
            "changes": [vars(c) for c in self.changes],
            "versions": {n: {"old": o, "new": w} for n, o, w in self.versions},
        }
