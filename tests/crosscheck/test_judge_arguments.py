"""Wrong arguments of `judge` are errors that name them; odd answers are results that say what is odd."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.subjects.running import ended

ARM = dp.load("ur5")
RNEA = partial(dp.rnea, ARM)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"robot": None}, "a robot, or the name or path"),
        ({"floating": True}, "floating=True, but the robot 'ur5'"),
        ({"mimic": True}, "mimic=True, but the robot 'ur5'"),
        ({"floating": "yes"}, "judge: floating: True or False"),
        ({"diagnose": "no"}, "judge: diagnose: True or False"),
        ({"limit": -1}, "judge: limit = -1, a positive number"),
        ({"limit": "1"}, "judge: limit = '1'"),
        ({"seed": -1}, "judge: seed = -1"),
        ({"progress": 3}, "judge: progress = 3"),
        ({"terms": []}, "terms is empty"),
        ({"terms": 5}, "terms = 5, names of terms"),
        ({"subject": {"rnea": RNEA, "writes": 3}}, "`writes` must be a Convention"),
    ],
)
def test_wrong_arguments(arguments, said):
    with pytest.raises(dp.ArgumentError, match=said):
        dp.judge(**{"robot": ARM, "subject": {"rnea": RNEA}, **arguments})


def only(term, f, robot=ARM):
    return dp.judge(robot, {term: f}, samples=4, terms=[term]).terms[term]


def test_a_function_that_ends_the_program_has_not_answered():
    def ends(q, v, a):
        raise SystemExit(3)

    assert (found := only("rnea", ends)).status == "not compared"
    assert found.reason == "SystemExit: 3"


def test_what_is_no_number_is_said_to_be_none():
    signs = []

    def sometimes(q, v, a):
        signs.append(q[0] > 0)
        return RNEA(q, v, a) * (np.nan if signs[-1] else 1.0)

    found = only("rnea", sometimes)
    assert found.status == "differs"
    assert found.reason == f"cause unknown; infinite or not a number in {sum(signs[:4])} of 4 states"
    assert 0 < sum(signs[:4]) < 4


def test_a_matrix_of_another_shape_is_not_put_into_order():
    panda = dp.load("panda")
    found = only("jacobian", lambda q, frame: dp.jacobian(panda, q, frame).T, panda)
    assert (found.status, found.reason) == (
        "not compared", "shape (9, 6) for one state; (6, 9) expected; is it transposed?"
    )  # fmt: skip
    assert only("com", lambda q: dp.com(panda, q)[:, None], panda).status == "agrees"


def test_what_a_program_printed_before_it_died_is_text(tmp_path):
    log = tmp_path / "log.txt"
    log.write_bytes(b"\x1b[31mbad joint\x1b[0m\x00 name\n\xff\xfe\x00\x01\n")
    assert ended(3, log) == "ended with exit code 3: bad joint name"
    log.write_bytes(b"\xff\xfe\x00" * 99)
    assert ended(-6, log) == "crashed (SIGABRT)"


def test_a_name_that_a_module_does_not_have_is_told_beside_those_it_has(tmp_path):
    (tmp_path / "mine.py").write_text("import math\nclass Arm:\n    pass\n")
    (result,) = dp.judge("ur5", f"{tmp_path / 'mine.py'}:Amr", samples=2).robots
    assert "mine.py has no 'Amr'; it has Arm" in result.reason
    assert result.notes == []  # the file of the robot was not searched for the cause


def test_what_a_class_is_not_constructed_with_is_told_beside_what_it_is(tmp_path):
    (tmp_path / "mine.py").write_text("class Arm:\n    def __init__(self, urdf_text, floating=False): ...\n")
    (result,) = dp.judge("ur5", f"{tmp_path / 'mine.py'}:Arm", samples=2).robots
    assert "'urdf_text'; a class is constructed with those of urdf, floating, gravity, option" in result.reason
    assert result.notes == []  # it is no matter of the robot's file
