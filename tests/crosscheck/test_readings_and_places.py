"""Kinds of mistakes in merging, in gravity, and in tensors; what is told of histories and places."""

from __future__ import annotations

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.locate import located
from dualpin.crosscheck.diagnosis.stories import Explanation
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.recursive import Recursive
from tests.crosscheck.test_textbook import PROBE, answering, asked


class Copied(Recursive):
    """iyy of every link is filled with ixx."""

    def tensor(self, e):
        I = super().tensor(e)
        I[1, 1] = I[0, 0]
        return I


class Unturned(Recursive):
    """Gravity is given to the first links in the axes of the world."""

    def outward(self, q, v, a, g):
        out, up = super().outward(q, v, a, 0 * g), [np.zeros(3)]
        for j, (R, _) in zip(self.joints, self.steps(q), strict=True):
            up.append(R.T @ up[j.parent] if j.parent else -g)
        return [(w, alpha, acc + e) for (w, alpha, acc), e in zip(out, up, strict=True)]


class Transposed(Recursive):
    """Centres and tensors of fixed links are turned back."""

    def carried(self, m, c, I, R, p):
        return m, p + R.T @ c, R.T @ I @ R


class ByElements(Recursive):
    """d * d in Steiner's term of merging, in the place of the outer product."""

    def merged(self, group):
        m, c, I = super().merged(group)
        for x, y, _ in group:
            d = y - c
            I = I + x * (np.outer(d, d) - d * d)
        return m, c, I


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (Copied, "ixx stands for iyy"),
        *(
            pytest.param(code, words, marks=pytest.mark.campaign)
            for code, words in (
                (Unturned, "gravity at the first link that moves is in the world's axes"),
                (Transposed, "by which a fixed link is merged is that with its rotation transposed"),
                (ByElements, "is the product d d by elements, in each row"),
            )
        ),
    ],
)  # fmt: skip
def test_a_mistake_is_named_in_all_terms(code, words):
    given = asked(PROBE, samples=6)
    case = Case(ask_here(code(given.text), given, lambda what: None))
    found = diagnose(case)
    assert not found.located and {words in f.says for f in found.findings} == {True}


def test_a_history_is_one_finding_of_all_its_terms():
    case = answering(asked(PROBE, samples=3))
    case.answers.history |= {"bias": 1e-3, "rnea": 1e-4}
    (found,) = diagnose(case).findings
    assert found.key == "history" and found.terms == ["bias", "rnea"] and found.before == 1e-3


def test_frames_that_are_right_are_not_off_whatever_a_story_makes_of_them():
    given = asked(PROBE, samples=3)
    x = np.array(answering(given).predict("frame_acceleration"))
    x[:, 2] += 1e-3
    case = answering(given, {"frame_acceleration": x})

    def spoiled(view, term, y):
        return y * np.where(np.arange(y.shape[1]) == 4, 2.0, 1.0)[:, None]

    h = Hypothesis("spoiled", "another frame is off too", ("frame_acceleration",), "answer", spoiled)
    before, left = case.score("frame_acceleration"), case.score("frame_acceleration", (h,))
    where = located(case, "frame_acceleration", Explanation("frame_acceleration", before, [], (h,), left))
    assert where == f"off for 1 of {len(case.frames)} frames ({case.frames[2]})"
