"""How long a diagnosis takes, planted mistakes on an arm and on a humanoid: on a quiet machine,

python -m pytest -m campaign -s tests/crosscheck/test_diagnosis_time.py
"""

from __future__ import annotations

import time

import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.subjects import QUESTIONS, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.planted import FIXED, MISTAKES
from tests.crosscheck.planted_more import MORE, Written
from tests.crosscheck.student import Student

SEVERAL = (
    "inertial_rpy_ignored", "one_com", "one_inertia", "g_9.8", "damping", "rotor", "no_gyroscopic", "float32_states",
    "axis_sign", "coriolis_other", "jacobian_world", "order_alphabetical", "linear_world", "quaternion_xyzw",
)  # fmt: skip
"""Of each kind one, for robots on which all would take an hour."""


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("robot", "floating", "mistakes", "limit"),
    [
        ("ur5", False, (*FIXED, *MORE), 10.0), ("panda", False, (*FIXED, *MORE), 10.0),
        ("talos", True, SEVERAL, 60.0), ("g1", True, SEVERAL, 60.0),
    ],
)  # fmt: skip
def test_a_diagnosis_takes_seconds(robot, floating, mistakes, limit):
    ask, took = asking(robot, 16, 0, tuple(QUESTIONS), floating=floating), {}
    for m in mistakes:
        assert m in MISTAKES or m in MORE
        subject = Written(ask.text, floating, m) if m in MORE else Student(ask.text, floating, (m,))
        answers = ask_here(subject, ask, lambda what: None)
        start = time.perf_counter(), time.process_time()
        found = diagnose(Case(answers))
        took[m] = time.perf_counter() - start[0], time.process_time() - start[1]
        print(f"{robot} {m}: {took[m][0]:.2f} s, {found.predictions} predicted", {f.key for f in found.findings})
    slowest = sorted(took, key=lambda m: -took[m][0])[:3]
    print(robot, "slowest:", ", ".join(f"{m} {took[m][0]:.1f} s ({took[m][1]:.1f} s of processor)" for m in slowest))
    assert max(seconds for seconds, _ in took.values()) < limit
