"""Hypotheses about what turns dualpin's answer into the subject's, as data.

A hypothesis predicts what the subject would answer if it were true.  Each acts at one place of the way

    sent columns -> word -> edit -> state -> formula -> force -> change -> columns of the subject -> answer -> relation

so that several compose in one way only, and every one can be tried on every subject.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ..subjects.convention import Convention

PLACES = ("word", "edit", "state", "formula", "force", "change", "answer", "relation")

ESTIMATED = frozenset({"joint_scale", "column_scale", "scale", "constant_entries", "one_link"})
"""Keys of numbers that are estimated for many entries: where they do not explain all, they mean nothing."""


@dataclass(frozen=True)
class Wording:
    """A convention, with further changes that a `Convention` cannot express."""

    how: Convention
    turned: tuple[tuple[str, float], ...] = ()
    point: tuple[float, ...] | None = None


def reordered(here: Sequence[str], names: Sequence[str]) -> Callable[[Wording], Wording]:
    """Columns with the names `here` in the places of `names`."""
    to = dict(zip(here, names, strict=True))

    def act(w: Wording) -> Wording:
        q, v = (tuple(to.get(n, n) for n in columns) for columns in (w.how.q, w.how.v))
        return replace(w, how=replace(w.how, q=q, v=v))

    return act


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One possible cause of a difference.

    Attributes
    ----------
    key : str
        Of the table of keys.
    says : str
        What would be the case, in plain words.
    terms : tuple of str
        The terms it can touch.
    place : str
        Where it acts, one of `PLACES`.
    act : callable
        word (Wording) -> Wording;  edit (Description, items) -> Description;  state (View) -> states;
        formula (View, term) -> array or None;  force (View) -> (n, nv);  change (View, term, x) -> x;
        answer (View, term, x) -> x, in the subject's columns;  relation (View, term, x, observed) -> x, of what the
        observed answer need only have in common with x.
    fix : str
        What to change in the subject's call or in the file.
    items : tuple of str
        The links or joints it is about; all where empty.
    values : str
        What was estimated.
    cost : float
        How much it claims: the cheapest common story is preferred.
    single : bool
        Whether it is about one link or joint of several.
    most : float
        The largest scaled error that it makes: it is not tried on larger ones.
    variant : str
        What tells two computations of one cause apart, which are told in the same words.
    mistake : tuple of str
        What it has in common with causes that are the same mistake, as other formulations show it.
    afterwards : bool
        Whether it takes so long that it is tried only where the same mistake explains another term.
    of_a_call : bool
        Whether each call makes it for itself: that other terms are right then says nothing against it.
    made_of : tuple of str
        Other terms of which it says that this one is made: it explains nothing where these are not explained.
    """

    key: str
    says: str
    terms: tuple[str, ...]
    place: str
    act: Callable[..., Any]
    fix: str = ""
    items: tuple[str, ...] = ()
    values: str = ""
    cost: float = 1.0
    single: bool = False
    most: float = math.inf
    variant: str = ""
    mistake: tuple[str, ...] = ()
    afterwards: bool = False
    of_a_call: bool = False
    made_of: tuple[str, ...] = ()

    @cached_property
    def identity(self) -> tuple[Any, ...]:
        return *self.cause, self.variant

    @property
    def named(self) -> bool:
        """Whether it is a slip with a key of its own, which all formulations share."""
        return len(self.mistake) == 1

    @cached_property
    def alone(self) -> frozenset[Any]:
        """The identity of the story that says nothing else."""
        return frozenset((self.identity,))

    @cached_property
    def cause(self) -> tuple[Any, ...]:
        """What is told: variants of one cause claim no more than one of them."""
        return self.key, self.says, self.items, self.values

    def __str__(self) -> str:
        return (
            self.says
            + (f" [{', '.join(self.items)}]" if self.items else "")
            + (f": {self.values}" if self.values else "")
        )


def style(h: Hypothesis) -> str:
    """The name of the formulation in which a slip is made; empty for causes of other kinds."""
    name, colon, _ = h.says.partition(": ")
    return name if colon and h.place == "formula" else ""


Story = tuple[Hypothesis, ...]
"""A set of hypotheses that hold together, in the order in which they act."""


def ordered(story: Iterable[Hypothesis]) -> Story:
    story = tuple(story)
    return story if len(story) < 2 else tuple(sorted(story, key=lambda h: (PLACES.index(h.place), h.key, h.items)))


def identity(story: Story) -> frozenset[Any]:
    return story[0].alone if len(story) == 1 else frozenset(h.identity for h in story)


def cost(story: Iterable[Hypothesis]) -> float:
    return round(sum(h.cost for h in story), 6)
