"""Two mistakes of one code, made together, and what cases of one robot have in common."""

from __future__ import annotations

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose, shared
from dualpin.crosscheck.diagnosis.hypothesis import ordered
from dualpin.crosscheck.diagnosis.rules.register import RULES
from dualpin.crosscheck.diagnosis.textbook.slipped import share
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.unseen_codes import written
from validation.referee.unseen import PROBE


def case(*names):
    ask = asking(PROBE, 2, 0, ("fk", "crba"))
    return Case(ask_here(written("sixvectors", *names)(ask.text), ask, lambda what: None))


def slips(of, *names):
    """Slips of these algorithms that explain M."""
    found = [h for rule in RULES if rule.key in names for h in rule.propose(of)]
    found = [h for h in found if "crba" in h.terms]
    return [h for h, score in zip(found, of.scores("crba", [(h,) for h in found]), strict=True) if score.right]


def test_a_slip_of_a_recursion_over_links_that_a_slip_places():
    walk, place = "x_crba_off_by_one", "x_slide_axis_unturned"
    both = case(walk, place)
    (carried, *_), placed = slips(case(walk), "spatial vectors"), slips(case(place), "forward kinematics")
    pairs = [ordered((h, carried)) for h in placed if share(h.act, carried.act)]
    assert pairs
    assert not any(both.score("crba", (h,)).right for h in (carried, *placed))
    assert any(both.score("crba", pair).right for pair in pairs)


def test_slips_in_poses_and_in_sums_over_bodies():
    """c_rodrigues_mixed is in a rotation, c_tensor_world_transposed in a sum; each is told by its own rule."""
    ask = asking(PROBE, 2, 0, ("fk", "crba"))

    def made(*names):
        return Case(ask_here(written("controller", *names)(ask.text), ask, lambda what: None))

    one, other = "c_rodrigues_mixed", "c_tensor_world_transposed"
    turned, summed = slips(made(one), "forward kinematics"), slips(made(other), "geometric Jacobians")
    pairs = [ordered((h, k)) for h in turned for k in summed if share(h.act, k.act)]
    both = made(one, other)
    assert pairs
    assert any(both.score("crba", pair).right for pair in pairs)


@pytest.mark.parametrize("most", [2**26, 1])
def test_what_is_kept_between_cases_is_what_each_would_predict(monkeypatch, most):
    monkeypatch.setattr(shared, "BYTES", most)
    monkeypatch.setattr(shared, "_ROBOTS", type(shared._ROBOTS)())
    first, second = case("x_crba_off_by_one"), case("x_slide_axis_unturned")
    assert first.shared is second.shared
    rule = next(r for r in RULES if r.key == "geometric Jacobians")
    found, again = (list(rule.propose(c)) for c in (first, second))
    assert found
    assert [h.identity for h in found] == [h.identity for h in again]
    monkeypatch.setattr(shared, "_ROBOTS", type(shared._ROBOTS)())
    alone = case("x_slide_axis_unturned")
    for h in again[::10]:
        expected, kept = (
            alone.predict(h.terms[0], (h,)),
            (first.predict(h.terms[0], (h,)), second.predict(h.terms[0], (h,))),
        )
        assert all(np.array_equal(expected, x) for x in kept)
    assert len(shared._ROBOTS) == 1


def test_poses_are_predicted_for_each_subject(monkeypatch):
    """What a slip makes of a quaternion is a rotation or none, as the subject's pose is: no two subjects share it."""
    monkeypatch.setattr(shared, "_ROBOTS", type(shared._ROBOTS)())
    slipped, right = (
        Case(ask_here(written("controller", *names)(ask.text), ask, lambda what: None))
        for ask in [asking(PROBE, 2, 0, ("fk",))] for names in (["c_rodrigues_mixed"], [])
    )  # fmt: skip
    found = next(hs for r in RULES if r.key == "quaternions throughout" and (hs := list(r.propose(slipped))))
    for h in found[::2]:
        slipped.predict("fk", (h,))
        x = right.predict("fk", (h,))
        monkeypatch.setattr(shared, "_ROBOTS", type(shared._ROBOTS)())
        y = Case(right.answers).predict("fk", (h,))
        assert x is y is None or np.array_equal(x, y)


def test_few_robots_are_kept(monkeypatch):
    monkeypatch.setattr(shared, "_ROBOTS", type(shared._ROBOTS)())
    kept = [shared.shared(k) for k in range(5)]
    assert len(shared._ROBOTS) == shared.ROBOTS
    assert shared.shared(4) is kept[4]
    assert shared.shared(0) is not kept[0]


def test_a_mistake_beside_a_history_is_that_of_the_first_answer():
    ask = asking(PROBE, 4, 0, ("fk", "crba"))
    both = written("sixvectors", "x_moments_order", "x_inertia_accumulates")
    found = diagnose(Case(ask_here(both(ask.text), ask, lambda what: None))).findings
    assert {f.key for f in found} == {"history", "inertia_order"}, found
    assert any(f.says.endswith("as the first answer shows") for f in found)
