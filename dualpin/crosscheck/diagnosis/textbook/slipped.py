"""A textbook algorithm with slips as the act of a hypothesis, and many of them in one run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from .steps import Slip, Steps

View = Any
"""`case.View`: the cases stand on this module."""
Run = Callable[[View, str, Steps], "np.ndarray | None"]
Formula = Callable[..., Any]


@dataclass(frozen=True)
class Slipped:
    """The prediction of a formulation with slips; two slips in one formulation are made in one run.

    So are slips of two formulations, where `run.beside` of one with the other is a formulation with the slips of both.
    """

    run: Run
    slips: tuple[Slip, ...]
    batched: bool = False
    """Whether the arrays of `run` have a first axis of runs: many predictions are then made in one."""

    def __call__(self, view: View, term: str) -> np.ndarray | None:
        x = self.run(view, term, Steps(*self.slips))
        return x[0] if self.batched and x is not None else x

    def joined(self, other: Formula) -> Slipped | None:
        """Both at once; None where the other is of an algorithm that is not made with this one."""
        if not isinstance(other, Slipped):
            return None
        run = made_with(self.run, other.run)
        return None if run is None else replace(self, run=run, slips=_narrowest((*self.slips, *other.slips)))

    def many(self, acts: Sequence[Slipped], view: View, term: str) -> Sequence[np.ndarray | None]:
        """The predictions of several acts of this formulation."""
        x = self.run(view, term, Steps.together([act.slips for act in acts]))
        return [None] * len(acts) if x is None else list(np.broadcast_to(x, (len(acts), *x.shape[1:])))


def _narrowest(slips: tuple[Slip, ...]) -> tuple[Slip, ...]:
    """Without those of a group of steps, where one of these steps has the same: what one of two algorithms has alone.

    An algorithm in which a group has one step names the group; made with another, it means that step.
    """

    def narrower(slip: Slip, other: Slip) -> bool:
        return other[1:] == slip[1:] and other.site.startswith(f"{slip.site}: ")

    return tuple(x for x in slips if not any(narrower(x, y) for y in slips))


@cache
def made_with(one: Run, other: Run) -> Run | None:
    """An algorithm with the slips of both, if there is one."""
    if one is other:
        return one
    for run, with_run in ((one, other), (other, one)):
        beside: Callable[[Run], Run | None] | None = getattr(run, "beside", None)
        if beside and (both := beside(with_run)):
            return both
    return None


def made_of(act: Formula, term: str) -> Any:
    """What determines its answer to a term: acts of which this is equal predict the same."""
    if not isinstance(act, Slipped):
        return act
    parts = getattr(act.run, "made_of", None)
    return act.run if parts is None else parts(term), act.slips


def algorithm(act: Formula) -> Any:
    """The one in which a slip is made; None for acts of other kinds."""
    return act.run if isinstance(act, Slipped) else None


def share(one: Formula, other: Formula) -> bool:
    """Whether both are of one algorithm, so that they can be made together."""
    return isinstance(one, Slipped) and one.joined(other) is not None


@dataclass(frozen=True)
class Added:
    """Formulas of several algorithms, as where an answer is put together of what each of them makes.

    What each makes wrong adds up.
    """

    acts: tuple[Formula, ...]

    def __call__(self, view: View, term: str) -> np.ndarray | None:
        if term == "fk":
            raise ValueError("rotations do not add up")
        right = view.compute(term, view.layout.how.reference)
        changes = [x - right for act in self.acts if (x := act(view, term)) is not None]
        return np.asarray(sum(changes, right)) if changes else None


def in_one(acts: Sequence[Formula]) -> Formula | None:
    """Formulas of one story as one: slips of the same algorithm are made together, what others change adds up."""
    several: list[Formula] = []
    for act in acts:
        for k, one in enumerate(several):
            both = one.joined(act) if isinstance(one, Slipped) else None
            if both:
                several[k] = both
                break
        else:
            several.append(act)
    return Added(tuple(several)) if len(several) > 1 else next(iter(several), None)


def predicted(acts: Sequence[Formula], view: View, term: str) -> Sequence[np.ndarray | None]:
    """What acts that are `alike` predict."""
    first = acts[0]
    several = [act for act in acts if isinstance(act, Slipped)]
    return first.many(several, view, term) if isinstance(first, Slipped) and len(acts) > 1 else [first(view, term)]


def alike(acts: Sequence[Formula | None], views: Sequence[View]) -> list[list[int]]:
    """The numbers of acts that one run can predict: of one algorithm, of the same robot and states."""
    groups: dict[Any, list[int]] = {}
    for k, (act, view) in enumerate(zip(acts, views, strict=True)):
        if isinstance(act, Slipped) and act.batched:
            groups.setdefault((act.run, id(view.states), id(view.description)), []).append(k)
        elif act is not None:
            groups[k] = [k]
    return list(groups.values())
