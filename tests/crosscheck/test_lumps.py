"""Bodies of several links: right without a slip, and each slip is told by the answers that it makes."""

from __future__ import annotations

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import RULES, Case, diagnose
from dualpin.crosscheck.diagnosis.description import merged
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.rules.lumping import WAYS
from dualpin.crosscheck.diagnosis.rules.register import differ
from dualpin.crosscheck.diagnosis.textbook.lumps import pieces
from dualpin.crosscheck.diagnosis.textbook.steps import Steps
from dualpin.crosscheck.diagnosis.textbook.tree import tree_of
from tests.crosscheck.test_textbook import PROBE, answering, asked

TERMS = ("gravity", "crba", "com", "bias")


@pytest.fixture(scope="module")
def right() -> Case:
    return answering(asked(PROBE, samples=3))


def proposed(case: Case, words: str) -> list[Hypothesis]:
    return [h for rule in RULES if rule.late for h in rule.propose(case) if words in str(h)]


@pytest.mark.parametrize("way", WAYS)
def test_merging_is_right_without_a_slip(right, way):
    whole = merged(right.description)
    bodies = {whole.root: whole.base} | {p.link: p.body for p in whole.parts}
    made = {link: WAYS[way](Steps(), group) for link, group in pieces(right.description).items()}
    assert len(made) == 7 and any(len(g) > 2 for g in pieces(right.description).values())
    for link, b in made.items():
        assert np.abs(b.parameters - bodies[link].parameters).max() < 1e-15


def test_tensors_of_trees_are_read_as_the_file_says(right):
    for fused in (False, True):
        for k in tree_of(right.view(()), fused).links:
            assert np.abs(k.tensor(Steps()) - k.I).max() < 1e-16


@pytest.mark.parametrize(
    "words",
    [
        "-m d d^T is left out of Steiner's term of merging",
        *(
            pytest.param(words, marks=pytest.mark.campaign)
            for words in (
                "is the mean of the links' centres", "replaces it", "the axes are transposed",
                "its upper triangle alone: the lower triangle is read", "3, 2, 1 of the ascending ones",
            )
        ),
    ],
)  # fmt: skip
def test_a_slip_names_itself(right, words):
    terms = {t: np.zeros(0) for t in TERMS}
    h = proposed(right, words)[0]
    x = {t: right.predict(t, (h,) if t in h.terms else ()) for t in terms}
    found = diagnose(answering(asked(PROBE, samples=3), x))
    assert not found.located and words in found.findings[0].says and len(found.findings) == 1


def test_only_slips_that_change_a_body_are_proposed(right):
    found, d = proposed(right, "bodies of several links"), merged(right.description)
    assert len(found) > 40
    for h in found:
        new = h.act(right.description, ())
        assert any(differ(p.body, q.body) for p, q in zip(d.parts, new.parts, strict=True)), str(h)
