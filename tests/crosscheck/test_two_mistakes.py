"""Two mistakes of one code, made together, and what cases of one robot have in common."""

from __future__ import annotations

import itertools

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from dualpin.crosscheck.diagnosis import Case, additive, diagnose, shared
from dualpin.crosscheck.diagnosis.choice import cheapest
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis, identity, ordered
from dualpin.crosscheck.diagnosis.rules.register import RULES
from dualpin.crosscheck.diagnosis.spared import instead, shows, spared
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
    terms = sorted(first.wrong & second.wrong)
    found, again = ([h for t in terms for h in rule.of_term(c, t)] for c in (first, second))
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


# --- changes that add up ---


@given(st.integers(0, 2**31), st.integers(2, 12), st.integers(1, 4))
def test_pairs_that_add_up_are_those_of_all_pairs(seed, n, size):
    changes = np.random.default_rng(seed).integers(-3, 4, (n, size)).astype(float)
    whole = changes[0] + changes[-1]
    found = set(map(frozenset, additive.adding_up(changes, whole, 1e-9)))
    every = itertools.combinations(range(n), 2)
    assert found == {frozenset(p) for p in every if np.array_equal(changes[list(p)].sum(0), whole)}


def asked(code, *names, terms):
    ask = asking(PROBE, 2, 0, terms)
    return Case(ask_here(written(code, *names)(ask.text), ask, lambda what: None))


def proposed(of, *rules):
    return [h for rule in RULES if rule.key in rules for h in rule.propose(of)]


KEYS = {"f_ext_written", "gyroscopic", "gyroscopic_sign", "centripetal", "tangential"}


def test_mistakes_of_two_algorithms_are_found_by_what_they_change():
    """A wrench in the frame's axes, and forces that lack w x I w: no algorithm makes both."""
    both = asked("jacobians", "jac_r_gyro", "jac_f_local", terms=("rnea_f_ext",))
    found = [h for h in proposed(both, "f_ext_written", "Newton-Euler in world axes") if h.key in KEYS]
    told = [((h,), x) for h, x in zip(found, both.predictions("rnea_f_ext", [(h,) for h in found]), strict=True)]
    right = [s for s in additive.pairs(both, "rnea_f_ext", told) if both.score("rnea_f_ext", s).right]
    assert not any(score.right for score in both.scores("rnea_f_ext", [(h,) for h in found]))
    assert {h.key for s in right for h in s} == {"f_ext_written", "gyroscopic"}


def test_what_is_read_wrongly_would_show_beside_the_mistakes_that_explain_other_terms():
    """Without m Jv^T dJv C is as if all xyz were ignored; poses, which another mistake explains, are not."""
    both = asked("jacobians", "jac_prismatic_pose", "jac_C_mass", terms=("fk", "coriolis"))
    still = next(h for h in proposed(both, "joint_unread") if str(h).startswith("positions of prismatic"))
    ignored = next(h for h in proposed(both, "xyz_ignored") if "and of" in str(h))
    assert both.score("fk", (still,)).right
    assert both.score("coriolis", ordered((still, ignored))).right
    assert not spared(both, ignored)
    assert shows(both, ignored)
    both.told = {"fk": [(still,)]}
    assert spared(both, ignored) == ["fk"]
    assert not shows(both, ignored)
    assert not spared(both, still)
    other = next(h for h in proposed(both, "joint_still") if str(h) != str(still))
    stories = instead(both, [ordered((still, ignored))], [[ignored, other], [still]], lambda h: [(h,)])
    assert [identity(s) for s in stories] == [identity((still, other))]


def slip(says, terms):
    return Hypothesis("step_left_out", says, terms, "formula", lambda view, term: None, cost=1.15)


def test_causes_of_one_way_of_writing_come_first():
    jacobians, newton, other = (slip(f"{name}: a", ("bias",)) for name in ("Jacobians", "Newton-Euler", "Jacobians"))
    first = slip("Jacobians: b", ("gravity",))
    picked = cheapest({"gravity": [(first,)], "bias": [(newton,), (jacobians,)]})
    assert picked["bias"] == (jacobians,)
    assert other.cause == jacobians.cause
