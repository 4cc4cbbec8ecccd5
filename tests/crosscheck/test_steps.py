"""Steps of textbook algorithms: right without a slip, and wrong in the way that their slips say."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis.textbook import words
from dualpin.crosscheck.diagnosis.textbook.steps import Slip, Steps
from dualpin.crosscheck.diagnosis.textbook.words import KINDS, RIGHT, plural, rows

FOLDER = Path(words.__file__).parent
ROTATION = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3
TENSOR = np.diag([1.0, 2.0, 3.0]) + 0.1
A, B = np.array([[1.0, 2.0, 3.0]]), np.array([[0.5, -1.0, 4.0]])


def algorithm(steps: Steps) -> np.ndarray:
    """A bit of everything."""
    total = steps.add("the sum", a=A, **{"b x a": np.cross(B, A)})
    total = steps.turn("the vector", ROTATION, total, **{"by twice the matrix": lambda: 2 * ROTATION})
    total = total @ steps.congruent("the tensor", ROTATION, TENSOR)
    total = total + steps.cross("the moment", A, B) @ steps.transpose("the matrix", ROTATION)
    for x in steps.each("the bodies", [A, 2 * B, A + B]):
        total = total + x
    for k, x in enumerate((B, 2 * A, 5 * B)):
        total = total + steps.part("the joints", x, k, 3, alone=True)
    total = total + steps.summed("what a child hands on", 4 * A, **{"the last one's is left": 0 * A})
    total = total + steps.components("the place", A + 4 * B)
    total = total + steps.mistaken("the force", A, **{"the moment": B})
    return total * steps.pick("the factor", 2.0, half=1.0, none=lambda: 0.0)


def test_without_a_slip_steps_are_right():
    total = (A + np.cross(B, A)) @ ROTATION.T @ (ROTATION @ TENSOR @ ROTATION.T)
    expected = 2 * (total + np.cross(A, B) @ ROTATION.T + 10 * A + 13 * B)
    assert np.abs(algorithm(Steps()) - expected).max() < 1e-14


def test_every_slip_changes_the_answer_in_a_way_of_its_own():
    steps = Steps()
    right = algorithm(steps)
    answers = [algorithm(Steps(slip)) for slip in steps.found]
    assert len(answers) == 45 and {s.how for s in steps.found} == set(KINDS) == set(rows())
    for k, x in enumerate(answers):
        assert np.abs(x - right).max() > 1e-3
        assert all(np.abs(x - y).max() > 1e-3 for y in answers[:k])
    assert len({slip.says for slip in steps.found}) == 45 and all(slip.fix for slip in steps.found)


def test_two_slips_at_once():
    one, two = Slip("the sum", "a", "step_left_out"), Slip("the factor", "half", "step_other")
    expected = np.cross(B, A) @ ROTATION.T @ (ROTATION @ TENSOR @ ROTATION.T)
    expected = expected + np.cross(A, B) @ ROTATION.T + 10 * A + 13 * B
    assert np.abs(algorithm(Steps(one, two)) - expected).max() < 1e-14


@pytest.mark.parametrize("slip", [Slip("elsewhere", "a", "step_sign"), Slip("the sum", "c", "step_sign")])
def test_a_slip_that_no_step_has_changes_nothing(slip):
    assert (algorithm(Steps(slip)) == algorithm(Steps())).all()


def test_another_matrix_that_a_place_does_not_have_is_not_taken_there():
    slip = Slip("the vector", "by twice the matrix", "step_other_turn")
    assert (Steps(slip).turn("the vector", ROTATION, A) == A @ ROTATION.T).all()


@pytest.mark.parametrize(
    ("slip", "says", "fix"),
    [
        (Slip("the force that children hand on", "that of the last one is left", "step_overwritten"),
         "the force that children hand on is overwritten where a link has several children: "
         "that of the last one is left",
         "add the force that children hand on to what is there, do not replace it"),
        (Slip("the arm in r x f", "in the child's axes", "step_other"), "the arm in r x f is in the child's axes",
         "the arm in r x f must be the vector from the link's origin to its child's, in the axes of f"),
        (Slip("alpha in I alpha", "w", "step_mistaken"), "w is taken for alpha in I alpha",
         "take alpha in I alpha, not w"),
        (Slip("the inertia of a body: in I alpha", "", "step_unturned"),
         "the inertia of a body, in I alpha, is not transformed into the axes in which it is used",
         "transform the inertia of a body, in I alpha, into the axes of what it is added to or multiplied by"),
        (Slip("the force that is handed on, X^T f,", "by the inverse", "step_other_turn"),
         "the force that is handed on, X^T f, is transformed by the inverse",
         "transform the force that is handed on, X^T f, by the matrix of this step, not by the inverse"),
        (Slip("the forces of bodies", "", "step_last"), "the loop over the forces of bodies leaves out the last",
         "end the loop over the forces of bodies with the last"),
        (Slip("the rate of a column", "(w x z) x r, the turning of the axis,", "step_left_out"),
         "(w x z) x r, the turning of the axis, is left out of the rate of a column",
         "add (w x z) x r, the turning of the axis, to the rate of a column"),
        (Slip("the gain", "one", "step_other"), "the gain is one", "correct the gain: here it is one"),
    ],
)  # fmt: skip
def test_what_is_said_of_a_slip_is_a_sentence(slip, says, fix):
    assert (slip.says, slip.fix) == (says, fix)


def test_what_is_plural():
    many = ["the axes that have a column", "the sine and cosine of an angle", "the torques of gravity", "their forces"]
    one = [
        "the mass of bodies",
        "the axis of joints",
        "the bias",
        "what joints feel",
        "S of joints",
        "the body's place",
    ]
    assert all(map(plural, many))
    assert not any(map(plural, one))


def test_what_belongs_in_a_place_is_told_of_places_that_there_are():
    texts = [p.read_text(encoding="utf-8") for p in sorted(FOLDER.glob("*.py")) if p.name != "words.py"]
    nodes = [node for text in texts for node in ast.walk(ast.parse(text))]
    plain = {n.value for n in nodes if isinstance(n, ast.Constant) and isinstance(n.value, str)}
    made = [re.compile(_pattern(n)) for n in nodes if isinstance(n, ast.JoinedStr)]
    heads = {site.rstrip(",") for site in RIGHT}
    known = {h for h in heads if any(x.startswith(h) for x in plain) or any(p.fullmatch(h) for p in made)}
    assert heads - known == set()


def _pattern(node: ast.JoinedStr) -> str:
    """Whatever stands in braces between the words of an f-string, which are to begin it."""
    first, *more = node.values
    rest = "".join(re.escape(v.value) if isinstance(v, ast.Constant) else ".+" for v in more)
    return re.escape(first.value) + rest if isinstance(first, ast.Constant) else r"(?!)"


def test_slips_made_together_are_those_made_one_by_one():
    rng = np.random.default_rng(5)
    x, y, R = rng.normal(size=(1, 2, 3)), rng.normal(size=(1, 2, 4, 3)), rng.normal(size=(1, 2, 3, 3))

    def algorithm(steps: Steps) -> np.ndarray:
        """Arrays of several numbers of axes at one site, and alternatives of which each is made in few runs alone."""
        a, b = steps.components("a vector", x), steps.components("a vector", y)
        c = steps.turn("a turn", R, a, **{"by the inverse": lambda: np.linalg.inv(steps.few(R))})
        c = steps.pick("a choice", c, twice=lambda: 2 * steps.few(c), another=x, none=0 * c)
        d = steps.add("a sum", **{"b": b, "c": c[..., None, :], "1": 1.0})
        return steps.tabled(
            "a matrix", d, {"that of another": R[0, 0]}, lambda M: (M @ steps.few(d)[..., None])[..., 0]
        )

    steps = Steps()
    right, slips = algorithm(steps), [(), *((s,) for s in steps.found)]
    assert len(slips) > 25
    together = algorithm(Steps.together(slips))
    for slip, made in zip(slips, together, strict=True):
        alone = algorithm(Steps(*slip)) if slip else right
        assert np.abs(made - alone[0]).max() < 1e-14, slip
        assert not slip or np.abs(made - right[0]).max() > 1e-3, slip
