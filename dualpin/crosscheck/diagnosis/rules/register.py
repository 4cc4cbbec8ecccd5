"""Rules, and the decorators that register them.

A rule proposes hypotheses for a case: one for the whole robot and, where that makes sense, one for each link
or joint.  To add a rule, write a small function under one of these decorators.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...subjects.questions import QUESTIONS
from ..case import Case
from ..description import Body, Description, Part, merged
from ..hypothesis import Hypothesis

ALL = tuple(QUESTIONS)
SIX = ("jacobian", "frame_velocity", "jacobian_dot")
FORCED = ("bias", "rnea", "aba")
WEIGHED = ("gravity", *FORCED)
PUSHED = ("rnea_f_ext", "aba_f_ext")
DERIVED = ("rnea_derivatives", "aba_derivatives")
INERTIAL = (
    "gravity", "crba", "com", "com_jacobian", "centroidal_momentum_matrix", "kinetic_energy", "potential_energy",
    *FORCED, "minv", "coriolis", *PUSHED, *DERIVED,
)  # fmt: skip
MASSIVE = (
    "crba", "centroidal_momentum_matrix", "kinetic_energy", *FORCED, "minv", "coriolis", *PUSHED, *DERIVED,
)  # fmt: skip
"""Terms in which inertia about the centre of mass counts."""


SLIPS, MERGING, READINGS = 1, 2, 3
"""Late rules: slips of algorithms; of merging, tried after those; rare readings of file and inputs, before those."""


@dataclass(frozen=True)
class Rule:
    """A proposer of hypotheses, and its line in the table of keys."""

    key: str
    says: str
    fix: str
    propose: Callable[[Case], Iterable[Hypothesis]]
    rows: Mapping[str, str] = field(default_factory=dict)
    """Where it proposes several keys: what each says."""
    late: int = 0
    """One of those above where its hypotheses are tried only if no single cause of other rules explains a term."""
    of_term: Callable[[Case, str], Iterable[Hypothesis]] | None = None
    """Where finding them takes long: those that show in one term, each as if it showed in all that it is asked for."""
    of_mistake: Callable[[Case, str, Any], Iterable[Hypothesis]] = lambda case, term, mistake: ()
    """Of these, those that are one mistake."""
    algorithm: Any = None
    """The one of which they are slips."""
    beside: Callable[[Case, str], Mapping[Any, Sequence[Hypothesis]]] = lambda case, term: {}
    """Slips of it that are none alone, since other rules have them, by mistakes: beside another they may be."""


RULES: list[Rule] = []
FIRST = "of joints on the base"
"""Which may be one alone, and is what a loop that begins with the base treats in another way."""
MOST_ITEMS = 80  # links or joints that are tried one at a time


@dataclass
class Family:
    """Hypotheses of one key: of the whole robot, and of one item at a time."""

    key: str
    says: str
    fix: str
    terms: tuple[str, ...]
    cost: float
    edit: Callable[[Description, Sequence[str]], Description]
    items: Callable[[Description], list[str]]
    singles: bool = field(default=True)
    groups: Callable[[Description], Mapping[str, Sequence[str]]] = field(default=lambda d: {})
    """Several items that a code may treat alike, by what they are."""
    of_bodies: bool = field(default=False)
    """Whether it is also tried after fixed links were merged into what carries them, as many codes do first."""

    def __call__(self, case: Case) -> Iterable[Hypothesis]:
        found = self.items(case.description)
        if not found:
            return
        whole = Hypothesis(self.key, self.says, self.terms, "edit", self.edit, self.fix, cost=self.cost)
        yield whole
        for words, names in self.groups(case.description).items():
            some = [item for item in found if item in set(names)]
            if (len(some) > 1 or (some and words == FIRST)) and len(some) < len(found):
                yield replace(whole, act=lambda d, i, some=some: self.edit(d, some), values=words, cost=self.cost + 0.1)
        if self.singles and 1 < len(found) <= MOST_ITEMS:
            for item in found:
                yield replace(whole, items=(item,), cost=self.cost + 1.0, single=True)
        lumped = case.merged
        if self.of_bodies and lumped is not case.description and self.items(lumped):
            yield replace(
                whole, act=lambda d, i: self.edit(merged(d), i), variant="of bodies merged from fixed links",
                cost=self.cost + 0.05,
            )  # fmt: skip


def _register(key: str, says: str, fix: str, propose: Callable[[Case], Iterable[Hypothesis]]) -> None:
    RULES.append(Rule(key, says, fix, propose))


def _links(d: Description) -> dict[str, list[str]]:
    """Links that a code may read alike."""
    return {
        "of links on fixed joints": [p.link for p in d.parts if not p.moves],
        "of links that joints move": [p.link for p in d.parts if p.moves],
    }  # fmt: skip


def _joints(d: Description) -> dict[str, list[str]]:
    """Joints that a code may read alike."""
    kinds = {k: [p.joint for p in d.parts if p.type == k] for k in ("fixed", "prismatic", "revolute", "continuous")}
    found = {f"of {kind} joints": names for kind, names in kinds.items()}
    found["of joints that move"] = [p.joint for p in d.parts if p.moves]
    found["of joints that turn"] = [p.joint for p in d.parts if p.turns]
    found[FIRST] = [p.joint for p in d.parts if p.parent == d.root]
    return found


def link_rule(
    key: str, says: str, fix: str, terms: tuple[str, ...] = INERTIAL, cost: float = 1.0
) -> Callable[[Callable[[Body], Body | None]], Callable[[Body], Body | None]]:
    """A function of one link's body: tried on all links, and on each."""

    def decorate(f: Callable[[Body], Body | None]) -> Callable[[Body], Body | None]:
        def items(d: Description) -> list[str]:
            bodies = [(d.root, d.base), *((p.link, p.body) for p in d.parts)]
            return [link for link, body in bodies if body is not None and differ(body, f(body))]

        family = Family(
            key, says, fix, terms, cost, lambda d, i: d.with_bodies(f, i), items, groups=_links, of_bodies=True
        )
        _register(key, says, fix, family)
        return f

    return decorate


def joint_rule(
    key: str, says: str, fix: str, terms: tuple[str, ...] = ALL, cost: float = 1.0
) -> Callable[[Callable[[Part, Description], Part]], Callable[[Part, Description], Part]]:
    """A function of one joint (and all of the description): tried on all joints, and on each."""

    def decorate(f: Callable[[Part, Description], Part]) -> Callable[[Part, Description], Part]:
        def items(d: Description) -> list[str]:
            return [p.joint for p in d.parts if changed(p, f(p, d))]

        edit = lambda d, i: d.with_parts(f, i)  # noqa: E731
        _register(key, says, fix, Family(key, says, fix, terms, cost, edit, items, groups=_joints))
        return f

    return decorate


def robot_rule(
    key: str, says: str, fix: str, terms: tuple[str, ...] = ALL, cost: float = 1.0
) -> Callable[[Callable[[Description], Description]], Callable[[Description], Description]]:
    """A function of the whole description."""

    def decorate(f: Callable[[Description], Description]) -> Callable[[Description], Description]:
        def items(d: Description) -> list[str]:
            new = f(d)
            old = {p.joint: p for p in d.parts}
            return [p.joint for p in new.parts if changed(old[p.joint], p)]

        _register(key, says, fix, Family(key, says, fix, terms, cost, lambda d, i: f(d), items, singles=False))
        return f

    return decorate


def rule(
    key: str, says: str, fix: str, terms: tuple[str, ...], place: str, cost: float = 1.0,
    when: Callable[[Case], Any] = lambda case: True, of_a_call: bool = False,
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:  # fmt: skip
    """A function that acts at `place`, tried where `when` holds."""

    def decorate(f: Callable[..., Any]) -> Callable[..., Any]:
        hypothesis = Hypothesis(key, says, terms, place, f, fix, cost=cost, of_a_call=of_a_call)
        _register(key, says, fix, lambda case: [hypothesis] if when(case) else [])
        return f

    return decorate


def proposer(
    key: str, says: str, fix: str, rows: Mapping[str, str] | None = None, late: int = 0
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A function (key, case) -> hypotheses, for rules whose words or number depend on the case."""

    def decorate(f: Callable[..., Any]) -> Callable[..., Any]:
        def propose(case: Case) -> Iterable[Hypothesis]:
            made: Iterable[Hypothesis] = f(Hypothesis(key, says, (), "", f, fix), case)
            return made

        RULES.append(Rule(key, says, fix, propose, rows or {}, late))
        return f

    return decorate


CHANGED = 1e-13
"""An edit that changes no number by more than this changes nothing."""


def differ(a: Body | None, b: Body | None) -> bool:
    if a is None or b is None:
        return a is not b and max(x.mass for x in (a, b) if x is not None) > 0
    return a is not b and bool(np.abs(a.parameters - b.parameters).max() > CHANGED)


def changed(a: Part, b: Part) -> bool:
    if a is b:
        return False
    return bool(np.abs(a.numbers - b.numbers).max() > CHANGED) or a.type != b.type or differ(a.body, b.body)


def changes(a: Description, b: Description) -> bool:
    """Whether an edit of the same joints changed a number."""
    return differ(a.base, b.base) or any(changed(x, y) for x, y in zip(a.parts, b.parts, strict=True))
