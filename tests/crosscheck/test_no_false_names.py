"""Nothing is named where no hypothesis holds: right code, disturbed at random."""

from __future__ import annotations

import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.diagnose import contradicted
from dualpin.crosscheck.diagnosis.rules import RULES
from dualpin.crosscheck.diagnosis.stories import Explanation
from dualpin.crosscheck.subjects import QUESTIONS, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.perturbed import DISTURBED, MOVED, perturbed
from tests.crosscheck.unseen_codes import BESIDES
from validation.referee.unseen import PROBE

LOCATED = {"partly", *BESIDES}
"""What may be said: what explains a part, and what follows from other terms."""


def disturbed(what: str, terms: tuple[str, ...] = tuple(QUESTIONS)) -> Case:
    ask = asking(PROBE, 8, 0, terms)
    return Case(ask_here(perturbed(ask.robot, what), ask, lambda what: None))


@pytest.mark.parametrize(
    ("what", "terms"),
    [
        ("poses twist", ("fk", "jacobian")),
        ("an entry of M breathes", ("crba", "gravity")),
        ("joints slip", ("fk", "com", "potential_energy")),
    ],
)
def test_no_cause_of_what_has_none(what, terms):
    case = disturbed(what, terms)
    found = diagnose(case, budget=0.5)
    assert {f.key for f in found.findings} <= LOCATED
    assert any(not case.score(t).right for t in terms) and found.located
    assert found.seconds < 3  # the time is a total; what is being predicted when it is over is finished


@pytest.mark.campaign
@pytest.mark.parametrize("what", [*DISTURBED, *MOVED])
def test_no_cause_of_what_has_none_however_long_it_is_looked_for(what):
    case = disturbed(what)
    wrong = {t for t in case.observed if not case.score(t).right}
    found = diagnose(case)
    assert wrong and {f.key for f in found.findings} <= LOCATED
    assert found.seconds < 10


def test_a_cause_that_wrong_answers_contradict():
    """The sign of axes, where all joints have slipped: poses are no nearer under it."""
    case = disturbed("joints slip", ("fk", "com"))
    told = {t: Explanation(t, case.score(t)) for t in case.observed}
    reading = next(h for r in RULES if r.key == "axis_reversed" for h in r.propose(case) if not h.items)
    assert contradicted(case, reading, told) == ["fk", "com"]
    told["com"].stories.append((reading,))
    assert contradicted(case, reading, told) == ["fk"]
