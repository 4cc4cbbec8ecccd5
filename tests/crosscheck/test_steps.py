"""Steps of textbook algorithms: right without a slip, and wrong in the way that their slips say."""

from __future__ import annotations

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis.textbook.steps import KINDS, Slip, Steps, rows

ROTATION = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3
TENSOR = np.diag([1.0, 2.0, 3.0]) + 0.1
A, B = np.array([[1.0, 2.0, 3.0]]), np.array([[0.5, -1.0, 4.0]])


def algorithm(steps: Steps) -> np.ndarray:
    """A bit of everything."""
    total = steps.add("the sum", a=A, **{"b x a": np.cross(B, A)})
    total = steps.turn("the vector", ROTATION, total, **{"by twice the matrix": lambda: 2 * ROTATION})
    total = total @ steps.congruent("the tensor", ROTATION, TENSOR)
    total = total + steps.cross("the moment", A, B) @ steps.transpose("the matrix", ROTATION)
    for x in steps.each("the bodies", [A, B, A + B]):
        total = total + x
    return total * steps.pick("the factor", 2.0, half=1.0, none=lambda: 0.0)


def test_without_a_slip_steps_are_right():
    total = (A + np.cross(B, A)) @ ROTATION.T @ (ROTATION @ TENSOR @ ROTATION.T)
    expected = 2 * (total + np.cross(A, B) @ ROTATION.T + 2 * (A + B))
    assert np.abs(algorithm(Steps()) - expected).max() < 1e-14


def test_every_slip_changes_the_answer_in_a_way_of_its_own():
    steps = Steps()
    right = algorithm(steps)
    answers = [algorithm(Steps(slip)) for slip in steps.found]
    assert len(answers) == 21 and {s.how for s in steps.found} == set(KINDS) == set(rows())
    for k, x in enumerate(answers):
        assert np.abs(x - right).max() > 1e-3
        assert all(np.abs(x - y).max() > 1e-3 for y in answers[:k])
    assert len({slip.says for slip in steps.found}) == 21 and all(slip.fix for slip in steps.found)


def test_two_slips_at_once():
    one, two = Slip("the sum", "a", "step_left_out"), Slip("the factor", "half", "step_other")
    expected = np.cross(B, A) @ ROTATION.T @ (ROTATION @ TENSOR @ ROTATION.T)
    expected = expected + np.cross(A, B) @ ROTATION.T + 2 * (A + B)
    assert np.abs(algorithm(Steps(one, two)) - expected).max() < 1e-14


@pytest.mark.parametrize("slip", [Slip("elsewhere", "a", "step_sign"), Slip("the sum", "c", "step_sign")])
def test_a_slip_that_no_step_has_changes_nothing(slip):
    assert (algorithm(Steps(slip)) == algorithm(Steps())).all()


def test_another_matrix_that_a_place_does_not_have_is_not_taken_there():
    slip = Slip("the vector", "by twice the matrix", "step_other_turn")
    assert (Steps(slip).turn("the vector", ROTATION, A) == A @ ROTATION.T).all()
