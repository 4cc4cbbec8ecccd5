"""States and answers in a subject's columns obey the same laws as in dualpin's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import dualpin as dp
from dualpin.crosscheck.subjects import QUESTIONS, Convention, Layout, asking
from dualpin.crosscheck.subjects.asking import expected
from dualpin.crosscheck.subjects.convention import BASE_Q, BASE_V

TERMS = ("fk", "jacobian", "jacobian_dot", "rnea", "bias", "crba", "coriolis", "aba", "minv", "gravity")
ASKED = asking("solo12", 3, 0, TERMS, floating=True)
EPS = 1e-9  # sums of some hundred products of numbers up to 1e2


@st.composite
def conventions(draw: st.DrawFn) -> Convention:
    q, v = (list(x) for x in (Convention.of(ASKED.robot).q, Convention.of(ASKED.robot).v))
    return Convention(
        tuple(draw(st.permutations(q))), tuple(draw(st.permutations(v))), tuple(draw(st.permutations(BASE_V))),
        draw(st.sampled_from(["body", "world"])), draw(st.sampled_from(["body", "world", "origin"])),
        draw(st.sampled_from(["world", "local", "local_world_aligned"])),
    )  # fmt: skip


def answers(how: Convention) -> dict[str, np.ndarray]:
    layout = Layout(ASKED.robot, how)
    return {t: expected(ASKED.robot, layout, t, ASKED.states, ASKED.frames) for t in TERMS}


@settings(max_examples=12, deadline=None)
@given(conventions())
def test_states_come_back(how):
    layout = Layout(ASKED.robot, how)
    again = layout.back(layout.states(ASKED.states))
    for k, x in ASKED.states.items():
        assert np.abs(again[k] - x).max() < EPS * max(1, np.abs(x).max()), k


@settings(max_examples=12, deadline=None)
@given(conventions())
def test_the_equations_of_motion_hold_in_any_columns(how):
    s, x = Layout(ASKED.robot, how).states(ASKED.states), answers(how)

    def near(a, b, what):
        assert np.abs(a - b).max() < EPS * max(1, np.abs(b).max()), what

    def dot(A, y):
        return np.einsum("nij,nj->ni", A, y)

    near(dot(x["crba"], s["a"]) + x["bias"], x["rnea"], "tau = M a + h")
    near(dot(x["coriolis"], s["v"]) + x["gravity"], x["bias"], "h = C v + g")
    near(dot(x["crba"], x["aba"]) + x["bias"], s["tau"], "M a = tau - h")
    near(x["minv"] @ x["crba"], np.broadcast_to(np.eye(ASKED.robot.nv), x["crba"].shape), "M^-1 M = 1")
    power = (ASKED.states["v"] * dp.rnea(ASKED.robot, *(ASKED.states[k] for k in "qva"), engine="numpy")).sum(-1)
    near((s["v"] * x["rnea"]).sum(-1), power, "power is the same in all columns")


@settings(max_examples=12, deadline=None)
@given(conventions())
def test_answers_come_back(how):
    layout, x = Layout(ASKED.robot, how), answers(how)
    plain = answers(replace(Convention.of(ASKED.robot), reference=how.reference))
    for term, form in ((t, QUESTIONS[t].form) for t in TERMS):
        needs = {"bias": "crba", "coriolis": "crba", "six_rate": "jacobian"}.get(form)
        again = layout.read(form, x[term], ASKED.states, x[needs] if needs else None)
        assert np.abs(again - plain[term]).max() < EPS * max(1, np.abs(plain[term]).max()), term


def test_an_oracle_is_read_by_the_same_algebra_as_a_subject():
    from dualpin.crosscheck.oracles.pinocchio import Layout as OfPinocchio

    assert issubclass(OfPinocchio, Layout) and OfPinocchio.read is Layout.read


@settings(max_examples=6, deadline=None)
@given(conventions())
def test_jacobians_give_the_same_motion(how):
    layout, x = Layout(ASKED.robot, how), answers(how)
    s, rows = layout.states(ASKED.states), layout.rows
    q, v, a = (ASKED.states[k] for k in "qva")
    for k, frame in enumerate(ASKED.frames):
        twist = dp.frame_velocity(ASKED.robot, q, v, frame=frame, reference=how.reference, engine="numpy")
        assert np.abs(np.einsum("nij,nj->ni", x["jacobian"][:, k], s["v"]) - twist[:, rows]).max() < EPS * 1e2
        J = dp.jacobian(ASKED.robot, q, frame=frame, reference=how.reference, engine="numpy")
        D = dp.jacobian_dot(ASKED.robot, q, v, frame=frame, reference=how.reference, engine="numpy")
        rate = np.einsum("nij,nj->ni", D, v) + np.einsum("nij,nj->ni", J, a)
        theirs = np.einsum("nij,nj->ni", x["jacobian_dot"][:, k], s["v"]) + np.einsum(
            "nij,nj->ni", x["jacobian"][:, k], s["a"]
        )
        assert np.abs(theirs - rate[:, rows]).max() < EPS * max(1, np.abs(rate).max())


def test_names_decide_and_wrong_ones_are_named():
    arm = dp.load("ur5")
    names = Convention.of(arm).q
    with pytest.raises(dp.ArgumentError, match=r"'elbow'.*did you mean 'elbow_joint'"):
        Layout(arm, Convention(("elbow", *names[1:]), names))
    with pytest.raises(dp.ArgumentError, match="lacks shoulder_pan_joint"):
        Layout(arm, Convention(names[1:], names))
    with pytest.raises(dp.ArgumentError, match="twice"):
        Convention(("a", "a"), ("a",))
    with pytest.raises(dp.ArgumentError, match="did you mean 'world'"):
        Convention(names, names, reference="wrld")
    with pytest.raises(dp.ArgumentError, match="rows"):
        Convention(names, names, rows=("wx", "wy"))
    assert Convention.of(dp.load("solo12", floating=True)).q[:7] == BASE_Q
