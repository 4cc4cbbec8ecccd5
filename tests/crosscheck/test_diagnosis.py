"""Causes of differences are named, and nothing else is."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import RULES, Case, diagnose
from dualpin.crosscheck.diagnosis.apart import told_apart
from dualpin.crosscheck.diagnosis.description import built
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.keys import keys, table
from dualpin.crosscheck.diagnosis.reading import describe
from dualpin.crosscheck.subjects import QUESTIONS, Answers, Asking, asking
from dualpin.crosscheck.subjects.asking import expected
from dualpin.crosscheck.subjects.layout import Layout
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.planted import FIXED, FLOATING, MISTAKES, PAIRS
from tests.crosscheck.planted_more import MORE, Written
from tests.crosscheck.student import Student

ROOT = Path(__file__).parents[2]
PROBE = str(ROOT / "urdf/probe/probe.urdf")


def asked(robot: str, floating: bool = False, samples: int = 12) -> Asking:
    return asking(robot, samples, 0, tuple(QUESTIONS), floating=floating)


def diagnosed(ask: Asking, wrong: tuple[str, ...]):
    """What is off, and what is said of it."""
    answers = ask_here(Student(ask.text, ask.floating, wrong), ask, lambda what: None)
    case = Case(answers)
    off = {t for t in answers.terms if not case.score(t).right}
    return off, diagnose(case)


def test_a_slow_subject_is_judged_by_the_states_that_it_answered(probe):
    """Rules that compare terms, or look at all of a matrix, look at the states at which all terms were answered."""
    answers = ask_here(Student(probe.text, False, ()), probe, lambda what: None)
    a, b = np.random.default_rng(0).normal(size=(2, *answers.sent["v"].shape))
    u = answers.sent["v"] / np.linalg.norm(answers.sent["v"], axis=1, keepdims=True)
    a, b = (x - (x * u).sum(1, keepdims=True) * u for x in (a, b))  # across v
    answers.terms["coriolis"] += a[:, :, None] * b[:, None] - b[:, :, None] * a[:, None]
    for term, x in answers.terms.items():
        x[2 if term == "crba" else 1 if term == "com" else 3 :] = np.nan
    assert [f.key for f in diagnose(Case(answers)).findings] == ["same_cv"]


def rightly_named(ask: Asking, wrong: tuple[str, ...]) -> bool | None:
    """Whether every mistake is named and nothing else; None where nothing shows."""
    off, found = diagnosed(ask, wrong)
    named = {f.key for f in found.findings}
    if not off and not named:
        return None
    beside = {"follows"}  # that a term is made of others is no cause
    return all(named & set(MISTAKES[w]) for w in wrong) and named <= beside.union(*(MISTAKES[w] for w in wrong))


@pytest.fixture(scope="module")
def probe() -> Asking:
    return asked(PROBE)


@pytest.mark.parametrize(("robot", "floating"), [(PROBE, False), ("panda", False), ("solo12", True)])
def test_right_code_of_another_kind_gets_no_finding(robot, floating):
    off, found = diagnosed(asked(robot, floating, 4), ())
    assert off == set() and found.findings == []


@pytest.mark.parametrize(
    "wrong",
    [
        ("inertial_rpy_transposed",), ("fixed_unturned",), ("axis_in_parent",), ("no_gyroscopic",), ("g_odd",),
        ("order_alphabetical",), ("one_mass",), ("one_origin",), ("rotor",), ("coriolis_other",), ("float32_answers",),
        ("g_9.8", "damping"), ("inertial_rpy_transposed", "products_dropped"),
    ],
    ids="+".join,
)  # fmt: skip
def test_mistakes_are_named_on_the_probe(probe, wrong):
    assert rightly_named(probe, wrong)


def test_a_base_in_world_axes_is_named():
    assert rightly_named(asked("solo12", True, 6), ("linear_world",))


@pytest.mark.campaign
@pytest.mark.parametrize("mistake", FIXED)
def test_every_mistake_shows_on_the_probe_and_is_named(probe, mistake):
    assert rightly_named(probe, (mistake,))


@pytest.mark.campaign
@pytest.mark.parametrize("mistake", MORE)
def test_mistakes_of_other_kinds_are_named_on_the_probe(probe, mistake):
    case = Case(ask_here(Written(probe.text, False, mistake), probe, lambda what: None))
    named = {f.key for f in diagnose(case).findings}
    assert named and named <= set(MORE[mistake])


def test_a_new_hypothesis_takes_less_than_fifteen_lines(probe):
    """From the decorator to the finding: written, registered, found, and documented."""
    source = """
from dataclasses import replace
from dualpin.crosscheck.diagnosis.rules.register import MASSIVE, link_rule

@link_rule("test_heavy_iyy", "iyy is counted twice", "count it once", MASSIVE)
def heavy_iyy(b):
    inertia = b.inertia.copy()
    inertia[1, 1] *= 2
    return replace(b, inertia=inertia)
"""
    assert len([line for line in source.splitlines() if line.strip()]) < 15
    before = list(RULES)
    try:
        exec(source, {})

        class Heavy(Student):
            def _link(self, e):
                k = super()._link(e)
                k.I = k.I + np.diag([0, k.I[1, 1], 0])
                return k

        case = Case(ask_here(Heavy(probe.text), replace(probe, terms=("crba",)), lambda what: None))
        assert [f.key for f in diagnose(case).findings] == ["test_heavy_iyy"]
        assert "test_heavy_iyy" in keys()
    finally:
        RULES[:] = before


@pytest.mark.campaign
@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_pairs_are_named_on_the_probe(probe, pair):
    assert rightly_named(probe, pair)


@pytest.mark.campaign
@pytest.mark.parametrize(("robot", "floating"), [("panda", False), ("ur5", False), ("solo12", True)])
def test_most_visible_mistakes_are_named_on_any_robot(robot, floating):
    ask = asked(robot, floating)
    results = {m: rightly_named(ask, (m,)) for m in (MISTAKES if floating else FIXED)}
    visible = {m: r for m, r in results.items() if r is not None}
    missed = [m for m, r in visible.items() if not r]
    assert len(missed) <= 0.1 * len(visible), missed


# --- rules of the search -------------------------------------------------------------------------


@pytest.mark.parametrize(("robot", "floating"), [(PROBE, False), ("panda", False), ("solo12", True)])
def test_a_description_builds_the_robot_it_was_read_from(robot, floating):
    ask = asked(robot, floating, 3)
    again = built([describe(ask.text, ask.robot)], ask.robot)
    how = Layout(ask.robot, Case(_silent(ask)).how)
    for term in QUESTIONS:
        x, y = (expected(r, how, term, ask.states, ask.frames) for r in (ask.robot, again))
        assert np.abs(x - y).max() < 1e-13 * max(1, np.abs(x).max()), term


def test_many_descriptions_at_once_are_the_same_as_one_by_one(probe):
    case = Case(_silent(probe))
    stories = [(h,) for rule in RULES for h in rule.propose(case) if h.place == "edit"]
    for term in ("rnea", "crba", "fk", "coriolis"):
        chosen = [s for s in stories if term in s[0].terms][::19]
        together = case.predictions(term, chosen)
        for story, x in zip(chosen, together, strict=True):
            (alone,) = Case(_silent(probe)).predictions(term, [story])
            assert (x is None) == (alone is None)
            assert x is None or np.abs(x - alone).max() < 1e-11 * max(1, np.abs(alone).max()), story


def _silent(ask: Asking) -> Answers:
    from dualpin.crosscheck.subjects import Convention

    how = Convention.of(ask.robot)
    return Answers("nobody", "", how, ask, Layout(ask.robot, how).states(ask.states))


# --- findings -------------------------------------------------------------------------------------


def test_what_explains_as_well_is_said_and_told_apart(probe):
    _, found = diagnosed(replace(probe, terms=("gravity",)), ("com_ignored",))
    (finding,) = found.findings
    assert finding.key in ("inertial_xyz", "inertial_origin") and finding.alternatives
    assert finding.apart == {}  # gravity cannot distinguish them: both leave the centres at the links' origins


@pytest.mark.parametrize("term", ["rnea_f_ext", "aba_f_ext"])
def test_stories_of_a_robot_under_a_wrench_are_told_apart(probe, term):
    case = Case(_silent(probe))
    dropped = next(h for rule in RULES for h in rule.propose(case) if h.key == "fixed_dropped")
    state = told_apart(case, term, (), (dropped,))
    assert state["term"] == term and len(state["f_ext"]) == 6 and state["first"] != state["other"]


def test_an_unknown_cause_is_located_not_named(probe, monkeypatch):
    monkeypatch.setattr(sys.modules[diagnose.__module__], "BUDGETS", (3.0, 3.0))  # all of it would be used
    robot = probe.robot

    def odd(q, v, a):
        tau = dp.rnea(robot, q, v, a)
        tau[2] += np.sin(3 * q[0]) * v[1]
        return tau

    term = dp.judge(robot, {"rnea": odd}, 8).terms["rnea"]
    assert term.status == "differs" and {f.key for f in term.findings} <= {"partly"}
    assert "shoulder" in term.reason and "off in 1 of 6 rows" in term.reason


def test_the_table_of_keys_is_that_of_the_documentation():
    page = (ROOT / "docs/keys.md").read_text(encoding="utf-8")
    assert page.endswith(table()), "python -m dualpin.crosscheck.diagnosis.keys writes it"


@pytest.mark.parametrize(
    ("robot", "floating"),
    [(PROBE, False), ("solo12", True), ("panda", False), pytest.param("tiago_dual", False, marks=pytest.mark.campaign)],
)
def test_every_hypothesis_has_a_line_in_the_table_and_a_fix(robot, floating):
    case = Case(_silent(asked(robot, floating, 2)))
    for h in (h for rule in RULES for h in rule.propose(case)):
        assert isinstance(h, Hypothesis) and h.key in keys() and h.says and h.fix, h
        assert set(h.terms) <= set(QUESTIONS) and h.terms
    assert {k for v in MISTAKES.values() for k in v} <= set(keys()) | {"com_of_origins"}
    assert not any(re.search(r"[<>]", k) for k in keys())


def test_mistakes_of_a_floating_base_are_known():
    assert not set(FIXED) & set(FLOATING)


@pytest.mark.parametrize("term", ["gravity", "crba", "jacobian"])
def test_rows_and_columns_that_are_never_written_are_said_to_be_so(probe, term):
    """And not that forces are cut off at a bound, of 0."""
    answers = ask_here(Student(probe.text, False, ()), probe, lambda what: None)
    answers.terms[term][..., 2] = 0
    if term == "crba":
        answers.terms[term][:, 2] = 0
    (finding,) = diagnose(Case(answers)).findings
    assert (finding.key, finding.items) == ("zeros", ["elbow"])
