"""A state that distinguishes two stories (sets of hypotheses) that explain the same answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..subjects.answers import Answers
from ..subjects.layout import Layout
from .case import Case
from .hypothesis import Story
from .scores import scaled

TRIED = 64


def told_apart(case: Case, term: str, a: Story, b: Story) -> dict[str, Any]:
    """The state among many, also outside the limits, at which the two predictions are farthest apart; empty if none."""
    rng = np.random.default_rng([case.asking.seed, 4])
    q, v, acc = case.robot.sample(TRIED, int(rng.integers(1 << 30)))
    for j in case.robot:
        if j.mimic is None and j.model.additive:
            q[:, j.q] = rng.uniform(-3, 3, (TRIED, j.model.nq))
    states = {"q": q, "v": v, "a": acc, "tau": rng.uniform(-5, 5, v.shape), "f_ext": rng.uniform(-10, 10, (TRIED, 6))}
    other = elsewhere(case, states)
    x, y = other.predict(term, a), other.predict(term, b)
    if x is None or y is None or x.shape != y.shape:
        return {}
    errors = [scaled(x[k : k + 1], y[k : k + 1]) for k in range(TRIED)]
    if np.isnan(errors).all():
        return {}
    k = int(np.nanargmax(errors))
    if not errors[k] > case.tolerance:
        return {}
    apart = np.abs(np.nan_to_num(x[k] - y[k]))
    at = np.unravel_index(int(apart.argmax()), apart.shape)
    return {
        "term": term, "entry": [int(i) for i in at], "first": float(x[k][at]), "other": float(y[k][at]),
        **{name: z[k].tolist() for name, z in other.sent.items()},
    }  # fmt: skip


def elsewhere(case: Case, states: Mapping[str, np.ndarray]) -> Case:
    """The same subject at other states (in dualpin's columns), of which nothing was asked: for predictions."""
    asking = replace(case.asking, states=dict(states))
    asking.__dict__["frames"] = case.frames
    sent = Layout(case.robot, case.how).states(dict(states))
    return Case(Answers(case.answers.name, "", case.how, asking, sent), case.tolerance)
