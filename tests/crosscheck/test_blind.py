"""Mistakes in code of another kind, listed before the hypotheses were read, are named."""

from __future__ import annotations

from pathlib import Path

import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.subjects import QUESTIONS, Asking, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.planted_blind import BESIDES, MISTAKES, PAIRS, wrong
from tests.crosscheck.recursive import Recursive

PROBE = str(Path(__file__).parents[2] / "urdf/probe/probe.urdf")


def asked(robot: str, floating: bool = False, terms: tuple[str, ...] = tuple(QUESTIONS)) -> Asking:
    return asking(robot, 8, 0, terms, floating=floating)


def named(ask: Asking, names: tuple[str, ...]) -> bool:
    """Whether each mistake is named, and nothing else but what follows from it."""
    found = diagnose(Case(ask_here(wrong(*names)(ask.text, ask.floating), ask, lambda what: None)))
    told, keys = {f.key for f in found.findings}, [set(MISTAKES[n][0].split()) for n in names]
    return all(told & k for k in keys) and told <= BESIDES.union(*keys)


@pytest.mark.parametrize(("robot", "floating"), [(PROBE, False), (PROBE, True)])
def test_the_code_without_mistakes_is_right(robot, floating):
    ask = asked(robot, floating)
    case = Case(ask_here(Recursive(ask.text, floating), ask, lambda what: None))
    assert {t: s.error for t in case.observed if not (s := case.score(t)).right} == {}
    assert diagnose(case).findings == []


@pytest.mark.parametrize(
    ("mistake", "terms"),
    [
        ("no_arm_of_joint", ("gravity",)),
        ("accelerometer", ("frame_acceleration",)),
        ("z_forgotten", ("fk", "jacobian")),
    ],
)
def test_mistakes_are_named(mistake, terms):
    assert named(asked(PROBE, terms=terms), (mistake,))


@pytest.mark.campaign
@pytest.mark.parametrize("names", [*((m,) for m in MISTAKES), *PAIRS], ids="+".join)
def test_all_are_named_on_the_probe(names):
    assert named(asked(PROBE), names)
