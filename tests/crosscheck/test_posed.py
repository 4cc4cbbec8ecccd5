"""Slips in poses and rotations, as codes that walk from link to link carry them into all terms."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.rules.posed import FIRST, LINKS, WORLD
from dualpin.crosscheck.diagnosis.textbook.posed import Posed
from dualpin.crosscheck.diagnosis.textbook.slipped import Slipped
from dualpin.crosscheck.diagnosis.textbook.steps import Slip
from dualpin.crosscheck.subjects import QUESTIONS, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.test_blind import PROBE
from tests.crosscheck.unseen_codes import rewritten

ENTRIES, QUATERNIONS = "rotations by axis and angle, entry by entry", "quaternions to matrices"
ENTRY = "entry 32 of the rotation by axis and angle"
ORIENTATION, PLACE = "the orientation of a link: of further links", "the position of a link: of further links"
RIGHT = "its own multiplied by the parent's from the right"
UNTURNED = "the parent's plus its place there, not turned"
BASE = "entry 21 of the rotation of the base"
TURNED, SUMMED = "R.append(R[b.parent] @ Ri)", "p.append(p[b.parent] + R[b.parent] @ pi)"
MISTAKES: dict[str, tuple[str, bool, tuple[str, str], str, Slip]] = {
    "one entry of joints' rotations": (
        "sixvectors", False, ("t * y * z + s * x", "t * y * z - s * x"), ENTRIES, Slip(ENTRY, "s x", "step_sign")
    ),
    "one entry of the base's rotation": (
        "sixvectors", True, ("n * (x * y + w * z)", "n * (x * y - w * z)"), QUATERNIONS, Slip(BASE, "2 wz", "step_sign")
    ),
    "a product of rotations in the other order": (
        "sixvectors", False, (TURNED, "R.append(Ri @ R[b.parent])"), "", Slip(ORIENTATION, RIGHT, "step_other")
    ),
    "positions that are not turned": (
        "sixvectors", False, (SUMMED, "p.append(p[b.parent] + pi)"), "", Slip(PLACE, UNTURNED, "step_other")
    ),
    "one entry of the base's rotation, by transforms": (
        "spatial", True, ("2 * (x * y + w * z)", "2 * (x * y - w * z)"), QUATERNIONS, Slip(BASE, "2 wz", "step_sign")
    ),
}  # fmt: skip
"""The code, whether its base floats, what it has in the place of what, and the slip in a way to make poses."""
TERMS = ("fk", "jacobian", "frame_acceleration", "com", "com_jacobian", "centroidal_momentum_matrix", "crba", "bias")


def case_of(name: str, terms: tuple[str, ...], samples: int = 2) -> Case:
    code, floating, change, *_ = MISTAKES[name]
    ask = asking(PROBE, samples, 0, terms, floating=floating)
    return Case(ask_here(rewritten(code, change)(ask.text, floating=floating), ask, lambda what: None))


@pytest.mark.parametrize("name", MISTAKES)
def test_right_algorithms_on_slipped_poses_answer_as_the_code_does(name):
    code, *_, way, slip = MISTAKES[name]
    case = case_of(name, TERMS)
    by_chains = {"fk", "com"} if code == "sixvectors" else set()  # which other formulations predict
    off = [t for t in case.observed if not case.score(t).right]
    runs = [
        (replace(of, fused=f), terms) for g in (FIRST, LINKS, WORLD) for of, terms in g.values() for f in (False, True)
    ]
    made = [
        Hypothesis("", f"{k}", terms, "formula", Slipped(Posed(of, way), (slip,), True))
        for k, (of, terms) in enumerate(runs)
    ]
    assert len(off) > 1
    for term in (t for t in off if t not in by_chains):
        assert any(case.score(term, (h,)).right for h in made if term in h.terms), term


@pytest.mark.campaign
@pytest.mark.parametrize("name", MISTAKES)
def test_all_terms_are_explained_by_one_slip(name):
    *_, slip = MISTAKES[name]
    case = case_of(name, tuple(QUESTIONS), 8)
    found = diagnose(case)
    explained = {t for f in found.findings for t in f.terms}
    assert explained == {t for t in case.observed if not case.score(t).right}
    assert {f.key for f in found.findings} - {"follows"} == {slip.how}
