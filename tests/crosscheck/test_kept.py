"""Slips of algorithms that are kept between runs: the same as those that are found."""

from __future__ import annotations

import re

import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case, diagnose, shared
from dualpin.crosscheck.diagnosis.kept import Kept
from dualpin.crosscheck.diagnosis.rules import SHIPPED, formulation
from dualpin.crosscheck.diagnosis.textbook.steps import Slip
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from dualpin.engine.jit import cache
from tests.crosscheck.unseen_codes import written
from validation.referee.unseen import PROBE

SLIPS = [Slip("the force of a body", "m a", "step_sign"), Slip("the arm", "", "step_other")]


@pytest.fixture(autouse=True)
def place(monkeypatch, tmp_path):
    monkeypatch.setenv("DUALPIN_CACHE_DIR", str(tmp_path))
    cache._announce.cache_clear()
    return tmp_path / "slips"


def found_anew():
    raise AssertionError("they are known")


def test_what_was_saved_is_not_looked_for_again(place):
    first = Kept("robot")
    assert first.of(3, "rnea", lambda: SLIPS) == SLIPS
    assert first.of(4, "rnea", list) == []
    assert not place.exists()
    first.save(shipped=10)
    again = Kept("robot")
    assert again.of(3, "rnea", found_anew) == SLIPS
    assert again.of(4, "rnea", found_anew) == []
    for robot, rule, term in (("another", 3, "rnea"), ("robot", 5, "rnea"), ("robot", 3, "crba")):
        assert Kept(robot).of(rule, term, lambda: SLIPS[:1]) == SLIPS[:1]


def test_rules_that_others_add_are_not_saved():
    """Their sources are not known: they may be other rules in the next run."""
    kept = Kept("robot")
    for rule in (3, 10):
        kept.of(rule, "rnea", lambda: SLIPS)
    kept.save(shipped=10)
    assert Kept("robot").of(3, "rnea", found_anew) == SLIPS
    assert Kept("robot").of(10, "rnea", list) == []


def test_a_damaged_file_is_made_anew(place):
    kept = Kept("robot")
    kept.of(3, "rnea", lambda: SLIPS)
    kept.save(shipped=10)
    (file,) = place.iterdir()
    file.write_bytes(file.read_bytes()[:-3])
    with pytest.warns(dp.DualpinWarning, match=re.escape("slip cache: ") + ".* is damaged"):
        assert Kept("robot").of(3, "rnea", lambda: SLIPS) == SLIPS


def test_it_is_cleared_with_the_kernels(place):
    kept = Kept("robot")
    kept.of(3, "rnea", lambda: SLIPS)
    kept.save(shipped=10)
    cache.clear()
    assert not list(place.iterdir())


def test_a_second_run_finds_the_same_without_running_the_algorithms(monkeypatch):
    ask = asking(PROBE, 2, 0, ("crba",))

    def findings():
        monkeypatch.setattr(shared, "_ROBOTS", type(shared._ROBOTS)())
        case = Case(ask_here(written("sixvectors", "x_inertia_accumulates")(ask.text), ask, lambda what: None))
        return [(f.key, f.says) for f in diagnose(case, budget=60.0).findings]

    first = findings()
    assert first
    monkeypatch.setattr(formulation, "possible", lambda *given: found_anew())
    assert findings() == first
    assert len(formulation.RULES) == SHIPPED
