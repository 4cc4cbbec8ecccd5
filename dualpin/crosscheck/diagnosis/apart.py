"""A state that distinguishes two stories (sets of hypotheses) that explain the same answers."""

from __future__ import annotations

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
    layout = Layout(case.robot, case.how)
    rng = np.random.default_rng([case.asking.seed, 4])
    q, v, acc = case.robot.sample(TRIED, int(rng.integers(1 << 30)))
    for j in case.robot:
        if j.mimic is None and j.model.additive:
            q[:, j.q] = rng.uniform(-3, 3, (TRIED, j.model.nq))
    states = {"q": q, "v": v, "a": acc, "tau": rng.uniform(-5, 5, v.shape), "f_ext": rng.uniform(-10, 10, (TRIED, 6))}
    asking = replace(case.asking, states=states)
    asking.__dict__["frames"] = case.frames
    sent = layout.states(states)
    silent = Answers(case.answers.name, "", case.how, asking, sent)
    other = Case(silent, case.tolerance)
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
        **{name: z[k].tolist() for name, z in sent.items()},
    }  # fmt: skip
