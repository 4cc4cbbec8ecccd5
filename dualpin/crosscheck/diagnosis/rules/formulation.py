"""A textbook formulation as a rule: every single slip that its steps allow becomes a hypothesis.

These hypotheses are many, so they are tried on a term only where no single cause of the other rules explains it.
The algorithms stand in the folder `textbook`; this registers them:

    def run(view, term, steps):
        ...                                     # the term, (samples, ...), or None where it cannot say

    formulation("Jacobians by cross products", ("jacobian", "jacobian_dot"))(run)
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..case import Case, View
from ..hypothesis import Hypothesis
from ..textbook.slipped import Run, Slipped
from ..textbook.steiner import MERGING
from ..textbook.steps import Slip, Steps
from ..textbook.words import rows
from .register import RULES, Rule

LIKELY = {
    "step_overwritten": 0.001, "step_first": 0.004, "step_last": 0.004, "step_other": 0.005, "step_other_turn": 0.005,
    "step_last_alone": 0.005, "step_first_alone": 0.006, "step_mistaken": 0.008,
}  # fmt: skip
"""What kinds of slips cost more than a term that is left out, or has another sign or factor, since they are rarer."""
COST = 1.15
"""More than that of a cause of the other rules: what these explain as well, they explain first."""
RARE = ("quaternions", "products of exponentials", "about centres of mass", "about their centres", "body Jacobians")
RARER = 0.02
"""What an algorithm costs more that fewer codes use: of two whose slips give the same answers the usual one is told."""
SPATIAL = 0.002
"""What products of exponentials cost less where Jacobians are about the world's origin, as these codes make them."""
USUAL = 0.06
"""What a slip costs less that has a key of its own: codes have these, and of equal ones they are told first.

More than what right terms add to the price of one and not of the other, where a formulation predicts more terms.
"""
FUSING = 0.0005
"""What it costs more if fixed links are merged first: codes do either, and the first is told of two that fit."""

Terms = Sequence[str] | Callable[[Case], Sequence[str]]
"""The terms that a formulation predicts, of all cases or of one."""


def formulation(
    name: str, terms: Terms, known: Mapping[tuple[str, str, str], str] | None = None, variant: str = "",
    when: Callable[[Case], Any] = lambda case: True, cost: float = COST, says: Mapping[str, str] | None = None,
    batched: bool = False, like: Callable[[str], str] = lambda term: term,
    afterwards: Callable[[Case], bool] = lambda case: False, alike: str = "",
    only: Callable[[Slip], bool] = lambda slip: True,
) -> Callable[[Run], Run]:  # fmt: skip
    """Register an algorithm whose single slips are hypotheses.

    Parameters
    ----------
    name : str
        As it is called in the field: "Newton-Euler in link axes".
    terms : sequence of str, or a function of the case
        What it predicts, of `QUESTIONS`.
    known : mapping
        Keys of slips (site, what, how) that have one of their own in the table of keys.
    variant : str
        What tells this variant of the formulation from others ("of bodies merged from fixed links"); it is not told.
    when : callable
        Whether it covers the robot of a case.
    cost : float
        Of its hypotheses.
    says : mapping
        Lines in the table of keys for those of `known` that no other rule has.
    batched : bool
        Whether all arrays of the algorithm, and of what it returns, have a first axis of runs (`Steps.together`).
    like : callable
        The term in which the slips of a term are looked for, where the same steps are quicker to see there.
    afterwards : callable
        Whether it takes so long that a slip is tried only where it explains another term.
    only : callable
        Which of its slips are hypotheses.
    alike : str
        Formulations of which this is equal have the same slips, and share no mistake with any other.
    """

    rarer = RARER * any(words in name for words in RARE)

    def extra(case: Case) -> float:
        of_space = "exponentials" in name and case.how.reference == "world"
        return -SPATIAL if of_space else rarer

    def decorate(run: Run) -> Run:
        number = len(RULES)

        def asked(case: Case) -> list[str]:
            if number not in case.asked:
                found = (terms(case) if callable(terms) else terms) if when(case) else []
                case.asked[number] = [t for t in found if t in case.observed]
            return case.asked[number]

        def slips(case: Case, term: str, which: Callable[[Slip], bool] = only) -> Mapping[Any, Sequence[Slip]]:
            """By the mistakes that they are; found once for a robot."""

            where = like(term)

            def found() -> dict[tuple[str, ...], list[Slip]]:
                out: dict[tuple[str, ...], list[Slip]] = {}
                for slip in case.shared.slips.of(number, where, lambda: _slips(run, case, where, alike)):
                    if which(slip):
                        out.setdefault(mistake_of(slip, (known or {}).get(slip), alike), []).append(slip)
                return out

            if case.view(()) is None:  # what it answers cannot be written: nothing is found out about the robot
                return {}
            return case.shared.once(("slips of a rule", number, where, which), found)

        def made(case: Case, slip: Slip, shown: Sequence[str]) -> Hypothesis:
            key = (known or {}).get(slip)
            return Hypothesis(
                key or slip.how, f"{name}: {slip.says}", tuple(shown), "formula", Slipped(run, (slip,), batched),
                slip.fix, variant=variant, cost=cost + LIKELY.get(slip.how, 0.0) + extra(case) - USUAL * bool(key),
                afterwards=afterwards(case), mistake=mistake_of(slip, key, alike),
            )  # fmt: skip

        def propose(case: Case) -> list[Hypothesis]:
            touched: dict[Slip, set[str]] = {}
            all_asked = asked(case)
            right = {t for t in all_asked if t not in case.wrong}  # of these `spared` finds out
            for term in (t for t in all_asked if t in case.wrong):
                for slip in itertools.chain(*slips(case, term).values()):
                    touched.setdefault(slip, set(right)).add(term)
            return [made(case, slip, [t for t in all_asked if t in shown]) for slip, shown in touched.items()]

        def once(case: Case, slip: Slip) -> Hypothesis:
            """What all terms have in common."""
            kept = case.slips.setdefault(number, {})
            if slip not in kept:
                kept[slip] = made(case, slip, asked(case))
            return kept[slip]

        def of_term(case: Case, term: str) -> list[Hypothesis]:
            every = slips(case, term) if term in asked(case) else {}
            return [once(case, slip) for slip in itertools.chain(*every.values())]

        def of_mistake(case: Case, term: str, mistake: Any) -> list[Hypothesis]:
            return [once(case, slip) for slip in slips(case, term).get(mistake, ())] if term in asked(case) else []

        def but_only(slip: Slip) -> bool:
            return not only(slip)

        def beside(case: Case, term: str) -> dict[Any, list[Hypothesis]]:
            every = slips(case, term, but_only) if term in asked(case) else {}
            return {mistake: [once(case, slip) for slip in some] for mistake, some in every.items()}

        lines = {**(says or {}), **rows()}
        fix = "compare the step with the equation of the book"
        RULES.append(Rule(name, name, fix, propose, lines, True, of_term, of_mistake, run, beside))
        return run

    return decorate


def mistake_of(slip: Slip, key: str | None = None, alike: str = "") -> tuple[str, ...]:
    """Slips with a key of their own are the same mistake in every formulation, others at steps of the same words."""
    site = slip.site.partition(": ")[0].removesuffix(MERGING)
    return (key,) if key else (site, slip.what, slip.how, *([alike] if alike else []))


def _slips(run: Run, case: Case, term: str, alike: str) -> Sequence[Slip]:
    """Of formulations that are alike, and of algorithms that several are made of, they are found once for a robot."""
    steps_of = getattr(run, "steps_of", None)
    sources = steps_of(term) if steps_of else {(alike or run, term): term}

    def found(key: Any, where: str) -> Sequence[Slip]:
        return case.shared.once(("slips", key), lambda: possible(run, case, where))

    return list(dict.fromkeys(slip for key, where in sources.items() for slip in found(key, where)))


def possible(run: Run, case: Case, term: str) -> Sequence[Slip]:
    """Every slip that a run without one meets, on one sample."""
    view, steps = case.view(()), Steps()
    assert view is not None
    states = {k: x[:1] for k, x in view.states.items()}
    try:
        run(View(case, view.description, view.layout, states), term, steps)
    except (ValueError, ArithmeticError, LookupError, np.linalg.LinAlgError):
        return []  # a robot that the formulation does not cover
    return list(steps.found)
