"""The table of rules: id -> severity, description, and function."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from ...errors import ArgumentError, nearest
from .description import Body, Description, Hinge
from .effects import Effects
from .findings import Finding


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
    """

    id: str
    severity: str
    says: str


@dataclass(frozen=True)
class Case:
    """The input of rules: the description, and the effects of faults."""

    about: Description
    effects: Effects


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


def finding(case: Case, rule: str, at: Body | Hinge | None, says: str, **more: object) -> Finding:
    """A finding of a rule about a link, a joint or the whole robot."""
    effect = more.get("effect")
    why = str(more.pop("why", "") or (effect.says if effect else ""))  # type: ignore[attr-defined]
    item, line = ("", None) if at is None else (at.item, at.line)
    return Finding(
        rule, RULES[rule].severity, says, item, case.about.file, line, why, **more,  # type: ignore[arg-type]
    )  # fmt: skip


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
