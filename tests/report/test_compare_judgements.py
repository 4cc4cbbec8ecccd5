"""Judgements of a subject before and after a change."""

from __future__ import annotations

import dualpin as dp
from dualpin.report import compare


def test_what_a_search_took_is_no_change_and_a_changed_model_is():
    arm = dp.load("double_pendulum")
    wrong = {"gravity": lambda q: -dp.gravity(arm, q), "name": "mine"}
    old, new = (dp.judge(arm, wrong, 3, terms=["gravity"]) for _ in range(2))
    old.robots[0].notes[-1] = "diagnosis: 1 answers predicted in 99.0 s"
    assert compare(old, new).changes == []
    right = dp.judge(arm, {"gravity": lambda q: dp.gravity(arm, q), "name": "mine"}, 3, terms=["gravity"])
    assert {(c.what, c.worse) for c in compare(right, new).changes} == {("verdict", True), ("error", True)}
    link = next(x for x in old.robots[0].model["links"].values() if x["mass"])
    link["mass"] *= 2
    assert [c.what for c in compare(old, new).worse] == ["model"]
