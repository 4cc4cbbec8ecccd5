"""Codes of other people's kinds agree without their mistakes, and with them are named as `unseen.md` says."""

from __future__ import annotations

import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.findings import Finding
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.unseen_codes import CODES, FLOATING, MISTAKES, READ, SENTENCES, changed, written
from validation.referee.unseen import GOES_WITH, PROBE, judged, kept, outcome


@pytest.mark.parametrize("code", CODES)
def test_without_mistakes_they_are_right(code):
    ask = asking(PROBE, 2, 0, ("fk", "jacobian", "gravity", "crba"), floating=code in FLOATING)
    case = Case(ask_here(written(code)(ask.text, ask.floating), ask, lambda what: None))
    assert {t: s.error for t in case.observed if not (s := case.score(t)).right} == {}
    assert len(case.observed) == 4
    assert diagnose(case).findings == []


def test_each_mistake_changes_its_code():
    for name, mistake in MISTAKES.items():
        assert written(mistake.code, *name.split("+")) is not None  # raises where the place is not there, or twice


def test_each_mistake_of_which_a_sentence_tells_has_its_place():
    for name, mistake in SENTENCES.items():
        parts = [SENTENCES[n] for n in name.split("+")]
        assert mistake.counts == tuple(c for p in parts for c in p.counts)
        changes = [c for p in parts for c in p.changes]
        assert changes and changed(mistake.code, *changes) != changed(mistake.code), name


def test_verdicts_are_those_of_what_was_said():
    for found in kept().values():
        for name, x in found.items():
            said = [Finding(*one.split(": ", 1), terms=["explained"]) for one in x["said"]]
            wrong = [] if x["verdict"] == "invisible" else ["explained", *x["open"]]
            assert judged(name, wrong, said)["verdict"] == x["verdict"], name
            if MISTAKES[name].code in READ:
                assert x["read"] in GOES_WITH[x["verdict"]], name


@pytest.mark.parametrize(
    ("name", "term"),
    [("n_inertial_rotation_back", "crba"), ("c_inertial_transposed", "crba"), ("x_inertial_rpy", "crba")],
)
def test_one_mistake_of_each_code_that_was_read_is_named(name, term):
    ask = asking(PROBE, 4, 0, (term,))
    found = diagnose(Case(ask_here(written(MISTAKES[name].code, name)(ask.text), ask, lambda what: None))).findings
    assert judged(name, [term], found)["verdict"] == "named", found


@pytest.mark.campaign
@pytest.mark.parametrize("name", kept().get("probe", {}))
def test_no_less_is_named_than_was(name):
    ranks = ["other", "unnamed", "in part", "named"]
    before, now = kept()["probe"][name]["verdict"], outcome(name)["verdict"]
    assert before == now or ranks.index(now) >= ranks.index(before)
