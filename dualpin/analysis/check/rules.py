"""The table of rules: id -> severity, description, and function."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import ArgumentError, nearest
from .description import Body, Description, Hinge
from .effects import Effects
from .findings import Edit, Effect, Finding


@dataclass(frozen=True)
class Rule:
    """One rule.

    Attributes
    ----------
    id : str
        A short name.
    severity : str
        "error", "warning" or "note".
    says : str
        What is wrong, in one sentence.
    fix : str
        What to change, where that is always the same.
    """

    id: str
    severity: str
    says: str
    fix: str = ""


@dataclass(frozen=True)
class Case:
    """The input of rules: the description, and the effects of faults."""

    about: Description
    effects: Effects

    def found(
        self, rule: str, at: Body | Hinge | None, says: str, why: str = "", fix: str = "", *,
        instead: tuple[float, np.ndarray, np.ndarray] | None = None, effect: Effect | None = None,
        edits: Sequence[Edit] = (),
    ) -> Finding:  # fmt: skip
        """A finding of a rule about a link, a joint or the whole robot.

        Parameters
        ----------
        why : str
            Why it matters; the effect by default.
        fix : str
            What to change; by default as the rule says.
        instead : (mass, com, tensor), optional
            What the link might have instead: the effect on the torques is said after `why`.
        """
        if instead is not None:
            assert isinstance(at, Body)
            effect = self.effects.of_body(at, *instead)
            why = f"{why} {effect.says}"
        item, line = ("", None) if at is None else (at.item, at.line)
        of = RULES[rule]
        why = why or (effect.says if effect else "")
        return Finding(rule, of.severity, says, item, self.about.file, line, why, effect, fix or of.fix, edits)


Looker = Callable[[Case], Iterable[Finding]]
RULES: dict[str, Rule] = {}
"""Every rule by its id."""
LOOKERS: list[tuple[tuple[str, ...], Looker]] = []


def rules(*table: Rule) -> Callable[[Looker], Looker]:
    """Register rules with the function that finds them."""

    def enter(look: Looker) -> Looker:
        RULES.update({r.id: r for r in table})
        LOOKERS.append((tuple(r.id for r in table), look))
        return look

    return enter


def wanted(names: Iterable[str] | None, what: str) -> set[str]:
    """Ids of rules; an unknown one is an error with the nearest."""
    found = set(names or ())
    for name in found:
        if name not in RULES:
            raise ArgumentError(f"check: {what}: {name!r} is no rule; {nearest(name, RULES, 'rules', most=99)}")
    return found


def run(case: Case, ids: set[str]) -> Iterator[Finding]:
    """The findings of some rules, in the order of the file."""
    found = [f for these, look in LOOKERS if ids & set(these) for f in look(case) if f.rule in ids]
    order = {name: i for i, name in enumerate(RULES)}
    yield from sorted(found, key=lambda f: (f.line or 0, order[f.rule]))
