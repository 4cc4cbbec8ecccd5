"""Comparing runs finds what got worse, and nothing else."""

import pytest

from dualpin.crosscheck.results import Refusal
from dualpin.errors import ArgumentError
from dualpin.report import compare, study

from . import samples


def whats(found):
    return [(c.what, c.worse) for c in found.changes]


def test_a_result_equals_itself():
    found = compare(samples.failed(), samples.failed())
    assert found.passed
    assert found.changes == []
    assert found.compared == 2 * len(samples.TERMS)


def test_a_changed_verdict_and_a_worse_error_are_worse():
    found = compare(samples.report(samples.robot("ur5")), samples.report(samples.robot("ur5", rnea=1e-3)))
    assert not found.passed
    assert set(whats(found)) == {("verdict", True), ("error", True)}


def test_the_other_way_round_is_better_and_passes():
    found = compare(samples.report(samples.robot("ur5", rnea=1e-3)), samples.report(samples.robot("ur5")))
    assert found.passed
    assert set(whats(found)) == {("verdict", False), ("error", False)}


def test_last_digits_say_nothing():
    found = compare(samples.report(samples.robot("ur5", fk=1e-18)), samples.report(samples.robot("ur5", fk=9e-15)))
    assert found.changes == []


def test_the_threshold_is_a_factor():
    old, new = (samples.report(samples.robot("ur5", fk=e)) for e in (2e-14, 9e-14))
    assert compare(old, new).passed
    assert not compare(old, new, error_factor=4).passed


def test_a_robot_or_term_that_is_gone_is_worse():
    gone = samples.report(samples.robot("panda"))
    del gone.robots[0].terms["fk"]
    found = compare(samples.report(samples.robot("panda"), samples.robot("ur5")), gone)
    assert sorted(c.where for c in found.worse) == ["panda fk", "ur5"]


def test_a_new_refusal_is_worse():
    found = compare(samples.report(), samples.report(refused=[Refusal("x", "no name", True)]))
    assert [c.where for c in found.worse] == ["x"]


def test_slower_is_worse_and_faster_is_better():
    old, slow = study(samples.speed(), "old"), study(samples.speed(1.5), "new")
    assert {(c.what, c.worse) for c in compare(old, slow).changes} == {("speed", True)}
    assert compare(slow, old).passed
    assert compare(old, slow, speed_factor=2).changes == []


def test_another_machine_does_not_count_where_pinocchio_ran_beside():
    fast = samples.speed()
    for row in fast["rows"]:
        row["us_per_sample"] /= 3
        row["pinocchio_us_per_sample"] /= 3
    assert compare(study(samples.speed(), "old"), study(fast, "new")).changes == []


def test_kinds_do_not_mix():
    with pytest.raises(ArgumentError, match="validation result, new a speed"):
        compare(samples.report(), study(samples.speed(), "new"))
    with pytest.raises(ArgumentError, match="not compared"):
        compare(study([{"a": 1}]), study([{"a": 1}]))


def test_changed_versions_are_listed():
    new = samples.report()
    new.versions["pinocchio"] = "5.0"
    assert compare(samples.report(), new).versions == [("pinocchio", "4.1.0", "5.0")]
