"""A slip in a function that a code calls in many places: cross products, Steiner's term; inverses without a number."""

from __future__ import annotations

import time

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.catalogue import Catalogue
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.rules.kinematics import jacobians
from dualpin.crosscheck.diagnosis.scores import HUGE, scored
from dualpin.crosscheck.diagnosis.textbook import plucker, steiner
from dualpin.crosscheck.diagnosis.textbook.articulated import Articulated
from dualpin.crosscheck.diagnosis.textbook.factors import Factors
from dualpin.crosscheck.diagnosis.textbook.products import AS_MATRIX, IN_AD, OF_TWO, SKEW, crf, crm
from dualpin.crosscheck.diagnosis.textbook.slipped import Slipped
from dualpin.crosscheck.diagnosis.textbook.steps import Slip, Steps
from dualpin.crosscheck.diagnosis.together import Together
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.test_pairs import LONG, Answers, case_of, silent
from tests.crosscheck.unseen_codes import source
from validation.referee.unseen import PROBE

OTHER = "step_other"
TYPO = """

def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[0] * b[2] - a[2] * b[0], a[0] * b[1] - a[1] * b[0]])


class Code:"""


def code_case(text, terms, samples=4) -> Case:
    ask, names = asking(PROBE, samples, 0, terms), {"__name__": __name__}
    exec(compile(text, "code", "exec"), names)
    return Case(ask_here(names["Code"](ask.text), ask, lambda what: None))


def test_a_wrong_cross_product_is_one_mistake_in_all_that_it_makes_wrong():
    terms = ("jacobian", "frame_velocity", "crba", "rnea", "aba")
    case = code_case(source("composites").replace("\n\nclass Code:", TYPO), terms)
    assert case.wrong == set(terms)
    (found,) = diagnose(case, LONG).findings
    assert sorted(found.terms) == sorted(terms)
    assert SKEW in found.says and "row 2 of the other sign" in found.says


WRONG = "that with its entry in row 2, column 3 of the other sign"
_W = np.array(
    [[0.0, -0.3, 0.2], [0.3, 0.0, 0.1], [-0.2, 0.1, 0.0]]
)  # of (0.1, 0.2, 0.3), with entry 23 of the other sign


@pytest.mark.parametrize("site", [AS_MATRIX, IN_AD])
def test_the_matrix_of_v_x_made_of_a_wrong_one_is_transposed_for_forces(site):
    v, m = np.array([0.1, 0.2, 0.3, 0.0, 0.0, 0.0]), np.arange(1.0, 7.0)
    steps, whole = Steps(Slip(site, WRONG, OTHER)), np.kron(np.eye(2), _W)
    assert np.allclose(crm(steps, "a step", v[None, None], m[None, None])[0, 0], whole @ m)
    assert np.allclose(crf(steps, "a step", v[None, None], m[None, None])[0, 0], -whole.T @ m)


def test_a_wrong_function_of_two_vectors_makes_no_matrix():
    v, m = np.array([0.1, 0.2, 0.3, 0.0, 0.0, 0.0]), np.arange(1.0, 7.0)
    for site in (OF_TWO, SKEW):
        steps, whole = Steps(Slip(site, WRONG, OTHER)), np.kron(np.eye(2), _W)
        assert np.allclose(crf(steps, "a step", v[None, None], m[None, None])[0, 0], whole @ m)


def test_a_slip_of_one_step_stands_for_that_of_its_group():
    run = Articulated(of=plucker.world)
    one, other = (Slipped(run, (Slip(site, WRONG, OTHER),), True) for site in (SKEW, OF_TWO))
    assert one.joined(other).slips == other.joined(one).slips == other.slips
    elsewhere = Slipped(run, (Slip(AS_MATRIX, "its transpose", OTHER),), True)
    assert len(one.joined(elsewhere).slips) == 2


def test_steiner_s_term_that_is_wrong_in_merging_and_in_composites():
    """Neither alone explains M, and no other term tells one of them."""
    ask, view = silent(3, ("crba",))
    every = Catalogue(case_of(Answers(ask, crba=np.zeros_like(view.compute("crba"))), ask)).helpers("crba")
    length = [s for s in every if all("|d| 1" in h.says for h in s) and s[0].variant == "about the body's origin"]
    assert length and all({h.mistake for h in s} == {(steiner.SQUARE, "|d| 1", OTHER)} for s in length)
    case = case_of(Answers(ask, crba=view.case.predict("crba", length[0])), ask)
    assert not any(case.score("crba", (h,)).right for h in length[0])
    (found,) = diagnose(case, LONG).findings
    assert found.key == OTHER and "d.d 1 in Steiner's term" in found.says and "|d| 1" in found.says


def test_entries_of_l_that_are_not_divided():
    ask, view = silent(2, ("minv", "crba"))
    found = Factors()(view, "minv", Steps(Slip("an entry of L", "H_ki, not divided by the pivot", OTHER)))[0]
    M, n = view.compute("crba"), ask.robot.nv
    for H, right in zip(M.copy(), found, strict=True):
        for k in reversed(range(n)):
            for i in reversed(range(k)):
                H[i, : i + 1] -= H[k, i] / H[k, k] * H[k, : i + 1]
        X = np.linalg.inv(np.tril(H, -1) + np.eye(n))
        assert np.allclose(X @ np.diag(1 / np.diag(H)) @ X.T, right)


def test_screws_of_forward_dynamics_alone():
    """Velocities are those from link to link, whatever the screws are."""
    _, view = silent(2, ("aba",))
    slip = Slip("S of a turning joint", "[z; 0], without p x z", OTHER)
    of_screws, told = (Articulated(of=plucker.world, told=told) for told in (False, True))
    assert np.allclose(told(view, "aba", Steps())[0], view.compute("aba"))
    assert not np.allclose(told(view, "aba", Steps(slip)), of_screws(view, "aba", Steps(slip)))


def test_no_number_is_as_good_as_none():
    x = np.full((2, 3, 3), np.inf)
    none, some, huge = np.full_like(x, np.nan), np.ones_like(x), np.full_like(x, 10 * HUGE)
    half = np.where(np.arange(2)[:, None, None] == 0, np.nan, 1.0) + 0 * some
    right = [s.right for s in scored(x, [none, some, huge, half], np.full(4, 1e-9))]
    assert right == [True, False, True, False]
    assert not any(s.right for s in scored(some, [none, huge], np.full(2, 1e-9)))
    some[:, 0] = np.nan  # of one frame there is no answer
    assert [s.right for s in scored(some, [none, np.ones_like(x)], np.full(2, 1e-9))] == [False, True]


def test_an_inverse_of_a_singular_matrix_follows_from_a_cause_that_other_terms_tell():
    ask, view = silent(2, ("jacobian", "minv"))
    slip = Slip("the column of a sliding axis", "zero", OTHER)
    cause = Hypothesis(OTHER, slip.says, ask.terms, "formula", Slipped(jacobians, (slip,), True))
    case = case_of(Answers(ask, minv=np.full_like(view.compute("minv"), np.inf)), ask)
    for told in ({}, {"jacobian": [(cause,)]}):
        search = Together(case, "minv", Catalogue(case), time.thread_time() + LONG)
        case.told = told
        search.consider([(cause,)])
        assert list(search.good.values()) == [(cause,)] * len(told)
