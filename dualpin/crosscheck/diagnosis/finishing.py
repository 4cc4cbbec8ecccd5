"""What remains after a term itself, of many stories at once: forces, changes, the subject's columns, changes there."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...errors import DualpinError
from ..subjects.layout import Layout
from ..subjects.questions import QUESTIONS
from .forces import by_velocity, forces_of
from .hypothesis import Story

View = Any
"""`case.View`: the cases stand on this module."""
BEFORE = ("word", "edit", "state", "formula")
"""Places that have done all that they do once the term is evaluated."""


def finish(
    term: str,
    together: Sequence[tuple[Story, View]],
    xs: Sequence[Any],
    others: Sequence[Any],
    observed: Mapping[str, np.ndarray],
) -> list[np.ndarray | None]:
    """Predictions, from the evaluated term and the mass matrix or Jacobian that its layout needs besides."""
    out: list[np.ndarray | None] = [None] * len(together)
    groups: dict[Any, list[int]] = {}
    for k, ((story, view), x, other) in enumerate(zip(together, xs, others, strict=True)):
        if x is None:
            continue
        form = _form(term, story)
        if form == "regressor" and _placed_elsewhere(view):
            out[k] = tried(_regressor, term, story, view, x)
        elif all(h.place in BEFORE for h in story):
            shapes = form, x.shape, x.dtype, None if other is None else (other.shape, other.dtype)
            groups.setdefault((id(view.layout), id(view.states), shapes), []).append(k)
        else:
            out[k] = tried(_alone, term, story, view, x, other, observed)
    for at in groups.values():
        view = together[at[0]][1]
        parts = [None if some[at[0]] is None else np.stack([some[k] for k in at]) for some in (xs, others)]
        form = _form(term, together[at[0]][0])
        found = tried(view.layout.answers, form, parts[0], view.states, parts[1])
        for k, x in zip(at, [None] * len(at) if found is None else found, strict=True):
            out[k] = x
    return out


def _form(term: str, story: Story) -> str:
    """Formulas of regressors make the subject's columns themselves, also those of links on fixed joints."""
    form = QUESTIONS[term].form
    made = form == "regressor" and any(h.place == "formula" and term in h.terms for h in story)
    return "rows" if made else form


def _placed_elsewhere(view: View) -> bool:
    """Whether a story puts links in other places on the bodies that carry them, or on other bodies."""
    if view.description is view.case.description:
        return False
    here, there = view.description.carried(), view.case.description.carried()
    return here.keys() != there.keys() or any(
        on != there[link][0] or not np.array_equal(H, there[link][1]) for link, (on, H) in here.items()
    )


def _regressor(term: str, story: Story, view: View, x: np.ndarray) -> np.ndarray:
    """Of a robot that is read in another way: its links have other places on the bodies that carry them."""
    x = Layout(view.robot, view.layout.how).answer(QUESTIONS[term].form, x, view.states)
    for h in story:
        if h.place == "answer" and term in h.terms:
            x = h.act(view, term, x)
    return x


def _alone(
    term: str,
    story: Story,
    view: View,
    x: np.ndarray,
    other: np.ndarray | None,
    observed: Mapping[str, np.ndarray],
) -> np.ndarray:
    forces = forces_of(story, view, term) if QUESTIONS[term].source in ("gravity", "bias", "rnea") else None
    if forces is not None:
        x = x + (forces[:, None] if QUESTIONS[term].pushes else forces)
    if term == "rnea_derivatives":
        x = x + by_velocity(story, view)
    for h in story:
        if h.place == "change" and term in h.terms:
            x = h.act(view, term, x)
    x = view.layout.answer(_form(term, story), x, view.states, other)
    for h in story:
        if h.place == "answer" and term in h.terms:
            x = h.act(view, term, x)
        elif h.place == "relation" and term in h.terms:
            x = h.act(view, term, x, observed[term])
    return x


SENSELESS = (DualpinError, ArithmeticError, LookupError, ValueError, np.linalg.LinAlgError)


def tried(f: Callable[..., Any], *args: Any) -> Any:
    """None where a story makes no sense for this robot."""
    try:
        return f(*args)
    except SENSELESS:
        return None
