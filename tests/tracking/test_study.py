"""The comparison any robot can be put through, and the committed study."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.tracking.study import comfortable, measured_stability_limit, pa10, run, seven_joint_arm, table

from .arms import PA10_START

STUDY = Path(__file__).parents[2] / "validation" / "integrators"


def test_rows_say_what_was_run_and_how_well():
    rows = run(pa10(), q0=PA10_START, radius=0.1, steps=[0.1], gains=[0.0, 1.0], turns=1)
    assert [(r.gain, r.method) for r in rows] == [
        (g, m) for g in (0.0, 1.0) for m in ("euler", "trapezoidal", "abm4", "rk4")
    ]
    assert rows[3].position_peak == pytest.approx(1.486e-9, rel=0.01)
    assert rows[3].evaluations == 400 and rows[3].robot == "pa10"
    json.dumps([r.as_dict() for r in rows])
    lines = table(rows).splitlines()
    assert lines[0] == "| loop | dt [s] | euler | trapezoidal | abm4 | rk4 |" and len(lines) == 4


@pytest.mark.parametrize(("name", "frame"), [("panda", "panda_hand"), ("ur5", "tool0")])
def test_a_good_start_is_found(name, frame):
    robot = dp.load(name)
    q = comfortable(robot, robot.frame(frame))
    s = np.linalg.svd(dp.jacobian(robot, q, frame, "local_world_aligned"), compute_uv=False)
    assert s[-1] / s[0] > 0.1
    assert (q >= robot.lower).all() and (q <= robot.upper).all()


def test_an_unreachable_circle_is_refused():
    with pytest.raises(dp.ArgumentError, match="leaves the workspace"):
        run(pa10(), q0=PA10_START, radius=0.5)


def test_turns_are_counted():
    with pytest.raises(dp.ArgumentError, match="turns = 0"):
        run(pa10(), turns=0)


@pytest.mark.parametrize("method", ["euler", "trapezoidal", "abm4", "rk4"])
def test_the_bisected_limit_is_within_one_percent(method):
    arm = seven_joint_arm()
    measured = measured_stability_limit(arm, np.radians([0, 30, 0, -70, 0, 60, 0]), None, method)
    assert measured == pytest.approx(dp.integrators.stability_limit(method), rel=0.01)


def test_the_committed_study_passed():
    results = json.loads((STUDY / "results.json").read_text())
    assert results["passed"]
    assert results["drift"]["turns"] == 1000 and results["energy"]["steps"] == 1_000_000
    energy = results["energy"]
    assert energy["variational"]["last_tenth"] < 2 * energy["variational"]["first_tenth"]
    assert energy["rk4"]["last_tenth"] > 5 * energy["rk4"]["first_tenth"]


def test_the_page_is_that_of_the_results():
    from validation.integrators import page

    assert (STUDY / "README.md").read_text() == page.markdown(json.loads((STUDY / "results.json").read_text()))
