"""Two mistakes of one code: in poses, in poses and a recursion, in one recursion; what follows from a wrong centre."""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial
from xml.etree import ElementTree

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.catalogue import Catalogue
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis, identity, ordered
from dualpin.crosscheck.diagnosis.rules import RULES
from dualpin.crosscheck.diagnosis.rules.momentum import about_own_centre
from dualpin.crosscheck.diagnosis.rules.slipping import jacobians, poses
from dualpin.crosscheck.diagnosis.schedule import outdone
from dualpin.crosscheck.diagnosis.stories import in_every_way, minimal, nearness
from dualpin.crosscheck.diagnosis.textbook import about_centres, about_world, link_axes, plucker, spatial, world_axes
from dualpin.crosscheck.diagnosis.textbook.articulated import Articulated
from dualpin.crosscheck.diagnosis.textbook.assembly import Dynamics, by_columns, right
from dualpin.crosscheck.diagnosis.textbook.posed import Posed
from dualpin.crosscheck.diagnosis.textbook.slipped import Slipped
from dualpin.crosscheck.diagnosis.textbook.steps import HAVE, Slip, Steps
from dualpin.crosscheck.diagnosis.together import Together
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.unseen_codes import rewritten
from validation.referee.unseen import PROBE

LONG = 25.0
"""Seconds: whether a pair is found, not how soon on a machine that others use."""
TERMS = ("fk", "jacobian", "frame_velocity", "com", "crba", "bias", "rnea")


class Answers:
    """One answer to a term, for all states at once."""

    name, batched = "answers", True

    def __init__(self, ask, **terms):
        self.writes = dict.fromkeys("qv", tuple(j.name for j in ask.robot))
        for term, x in terms.items():
            setattr(self, term, x if callable(x) else lambda *given, x=x: x)


def case_of(subject, ask) -> Case:
    return Case(ask_here(subject, ask, lambda what: None))


def silent(samples=3, terms=TERMS):
    ask = asking(PROBE, samples, 0, terms)
    return ask, case_of(Answers(ask), ask).view(())


# --- without a slip -------------------------------------------------------------------------------

IN_WORLD = {
    "crba": [
        Dynamics(right(spatial.forces), about_world.mass), Dynamics(right(spatial.forces), about_centres.mass),
        Dynamics(right(spatial.forces), partial(spatial.mass, of=plucker.world)),
    ],
    "rnea": [Dynamics(world_axes.forces, by_columns(world_axes.forces))],
    "aba": [Articulated(of=plucker.world), Articulated(True, plucker.world_blocks)],
}  # fmt: skip


@pytest.mark.parametrize(("term", "of"), [(term, of) for term, some in IN_WORLD.items() for of in some])
def test_axes_that_are_kept_early_are_the_same_of_right_poses(term, of):
    _, view = silent(terms=(*TERMS, "aba"))
    expected = view.compute(term)
    for early in (False, True):
        found = Posed(of, both=True, early=early)(view, term, Steps())[0]
        assert np.abs(found - expected).max() < 1e-9 * max(1.0, np.abs(expected).max())


def test_no_algorithm_in_links_axes_keeps_axes_early():
    early = Slipped(partial(poses, early=True), ()).run.func
    in_links = Dynamics(spatial.forces, spatial.mass)
    kept = type(early)(early.parts, (("early", True),))
    assert kept.beside(in_links) is None
    assert kept.beside(IN_WORLD["crba"][0]).early
    assert not early.beside(in_links).early


# --- two mistakes ---------------------------------------------------------------------------------

LEFT = ("R @ axis_angle(joint.axis, qk)", "axis_angle(joint.axis, qk) @ R")
LOST = ("moment[k] + np.cross(s.p[k] - s.p[i], force[k])", "moment[k]")


def test_axes_kept_before_a_wrong_turn_and_a_slip_of_the_recursion():
    """Each alone explains none of the torques; both do where axes are turned before their joints turn, as here."""
    ask = asking(PROBE, 3, 0, ("fk", "rnea"))
    case = case_of(rewritten("newton", LEFT, LOST)(ask.text), ask)
    site, left = "the rotation of a link", "that with the joint's turn multiplied from the left"
    turned = Slip(site, left, "step_other")
    recursion = Dynamics(world_axes.forces, by_columns(world_axes.forces), fused=True)
    lost = Slipped(recursion, (Slip("the moment at a joint", "r x f", "step_left_out"),), True)
    right_so = {}
    for how in ((("fused", True),), (("early", True), ("fused", True))):
        both = Slipped(replace(poses, how=how), (turned,), True).joined(lost)
        h = Hypothesis("both", str(how), ("rnea",), "formula", both)
        right_so[len(how)] = case.score("rnea", (h,)).right
    assert right_so == {1: False, 2: True}


def test_twists_of_links_that_a_recursion_takes_as_they_are():
    """Where velocities of frames are wrong, articulated bodies take those that the links have."""
    ask, view = silent(3, ("frame_velocity", "aba"))
    wrong = 2 * view.compute("frame_velocity")
    case = case_of(Answers(ask, frame_velocity=lambda q, v, frame: wrong[:, case_frames(ask).index(frame)]), ask)
    expected = view.compute("aba")
    for of in IN_WORLD["aba"]:
        found = Posed(of)(case.view(()), "aba", Steps())[0]
        assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


def case_frames(ask):
    return list(ask.frames)


def test_two_ways_of_misreading_placements():
    """Rotations are a product, so that neither mistake alone comes near."""
    ask = asking(PROBE, 3, 0, ("fk",))
    case = case_of(Misread(ask.text), ask)
    search = Together(case, "fk", Catalogue(case), time.thread_time() + LONG)
    keys = ("rpy_part", "rpy_transposed")
    whole = [h for h in search.catalogue.of("fk", False, search.before.error) if h.key in keys]
    search.consider([(h,) for h in whole])
    assert not search.held
    search._two_readings(whole)
    assert {frozenset(h.key for h in s) for s in search.held} == {frozenset(keys)}


class Misread:
    """Poses, with rotations of origins transposed, and without their yaw."""

    name = "misread"

    def __init__(self, text):
        root = ElementTree.fromstring(text)
        self.joints = {j.find("child").get("link"): j for j in root.iter("joint")}
        self.names = [j.get("name") for j in root.iter("joint") if j.get("type") != "fixed"]
        self.writes = {"q": tuple(self.names), "v": tuple(self.names)}

    def fk(self, q, frame):
        joint = self.joints.get(frame)
        if joint is None:
            return np.eye(4)
        origin, axis = joint.find("origin"), joint.find("axis")
        xyz, rpy = ([float(x) for x in origin.get(k, "0 0 0").split()] for k in ("xyz", "rpy"))
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = (about((0, 1, 0), rpy[1]) @ about((1, 0, 0), rpy[0])).T, xyz
        if joint.get("type") != "fixed":
            a = np.array([1.0, 0, 0] if axis is None else [float(x) for x in axis.get("xyz").split()])
            a, x = a / np.linalg.norm(a), q[self.names.index(joint.get("name"))]
            move = np.eye(4)
            move[:3, 3] = a * x * (joint.get("type") == "prismatic")
            move[:3, :3] = about(a, x * (joint.get("type") != "prismatic"))
            T = T @ move
        return self.fk(q, joint.find("parent").get("link")) @ T


def about(a, angle):
    K = np.cross(np.eye(3), np.asarray(a, float))
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def test_two_slips_of_one_recursion_beside_the_one_that_leaves_least():
    ask, view = silent(4, ("crba", "bias", "aba"))
    slips = (
        Slip("the articulated bias force p^A of a parent", HAVE, "step_left_out"),
        Slip("D of articulated bodies", "with 0.01 added", "step_other"),
    )
    case = case_of(Answers(ask, aba=Slipped(Articulated(), slips, True)(view, "aba")), ask)
    search = Together(case, "aba", Catalogue(case), time.thread_time() + LONG)
    search.near = [nearness((h,), case.score("aba", (h,))) for h in single(case, slips[0].site)]
    search.two_slips()
    said = {h.says.partition(": ")[2] for s in search.held for h in s}
    assert any(slips[0].site in x for x in said)
    assert any("0.01" in x for x in said)


def single(case, site):
    """Slips of articulated bodies at one step."""
    rules = (r for r in RULES if r.of_term and "aba" in case.observed)
    return [h for r in rules for h in r.of_term(case, "aba") if site in h.says and "articulated" in h.variant]


def test_a_momentum_about_a_centre_that_is_wrong_itself():
    ask, view = silent(3, ("com", "centroidal_momentum_matrix"))
    G, A = view.compute("com"), view.compute("centroidal_momentum_matrix").copy()
    P = G + 0.1 * np.sin(ask.states["q"][:, :3])
    A[:, :3] += np.cross((G - P)[:, None], np.swapaxes(A[:, 3:], 1, 2)).swapaxes(1, 2)
    case = case_of(Answers(ask, com=P, centroidal_momentum_matrix=A), ask)
    (h,) = about_own_centre(case, "centroidal_momentum_matrix", ())
    assert h.key == "follows"
    assert h.made_of == ("com",)
    assert case.score("centroidal_momentum_matrix", (h,)).right


# --- each beside others ---------------------------------------------------------------------------


@pytest.mark.parametrize("words", ["that of the last one is left", "that of the first one is left"])
def test_moments_that_children_overwrite_are_the_same_in_both_axes(words):
    ask, view = silent(3)
    slip = Slip("the moment that children hand on, with r x f,", words, "step_overwritten")
    by_axes = [Dynamics(of.forces, by_columns(of.forces)) for of in (world_axes, link_axes)]
    one, other = (Slipped(of, (slip,), True)(view, "rnea") for of in by_axes)
    scale = np.abs(one).max()
    assert np.abs(one - other).max() < 1e-12 * scale
    assert np.abs(one - view.compute("rnea")).max() > 1e-3 * scale
    (finding,) = diagnose(case_of(Answers(ask, rnea=one), ask), budget=LONG).findings
    assert finding.key == "step_overwritten" and "moment that children hand on" in finding.says


def test_rows_of_a_jacobian_that_are_exchanged_are_one_mistake():
    ask = asking(PROBE, 3, 0, ("bias", "kinetic_energy"))
    view = case_of(Answers(ask), ask).view(())
    exchanged = Slip(
        "the rows of a body's Jacobian in J^T f", "linear rows first, taken for angular ones", "step_other"
    )
    case = case_of(Answers(ask, bias=Slipped(jacobians, (exchanged,), True)(view, "bias")), ask)
    (finding,) = diagnose(case, budget=LONG).findings
    assert exchanged.site in finding.says and finding.terms == ["bias"]


def test_what_explains_two_terms_stays_although_a_part_of_it_explains_others():
    """A slip in one function beside a wrong pose: other functions have the wrong pose alone."""
    pose, slip, other = (
        Hypothesis(key, key, TERMS, "formula", lambda *given: None) for key in ("pose", "slip", "other")
    )
    both, apart = ordered((pose, slip)), ordered((other, slip))

    class Term:
        open = False
        seen = {identity(s) for s in ((pose,), both, apart)}

        def __init__(self, *good):
            self.good = {identity(s): s for s in good}

    terms = [Term((pose,)), Term((pose,)), Term((pose,)), Term(both, apart)]
    assert not outdone(both, terms)
    assert outdone(apart, terms)


def test_few_terms_are_each_looked_at_alone_before_one_of_them_is_at_length():
    """M has two mistakes, which take long to tell apart; that of the accelerations is found before these are."""
    ask, view = silent(3, ("crba", "aba"))
    two = (
        Slip("the inertia of a composite", "the link's Steiner term", "step_left_out"),
        Slip("the arm in Steiner's term: of the child", "that between both centres", "step_other"),
    )
    M = Slipped(Dynamics(right(spatial.forces), about_centres.mass), two, True)(view, "crba")
    one = (Slip("D of articulated bodies", "with 0.01 added", "step_other"),)
    case = case_of(Answers(ask, crba=M, aba=Slipped(Articulated(), one, True)(view, "aba")), ask)
    order: list[str] = []
    found = diagnose(case, LONG, order.append)
    assert any("0.01" in f.says and f.terms == ["aba"] for f in found.findings)
    assert sum("Steiner" in f.says and f.terms == ["crba"] for f in found.findings) == 2
    assert order.index("aba: single causes") < max(k for k, what in enumerate(order) if what.startswith("crba: slips"))


LOOPS = {
    "the joints whose unit accelerations make M": (Dynamics(right(spatial.forces), about_world.mass), "crba"),
    "the joints whose rates move links": (poses, "kinetic_energy"),
}


@pytest.mark.parametrize(("site", "how"), [(site, how) for site in LOOPS for how in ("step_first", "step_last")])
def test_a_loop_that_leaves_out_a_joint(site, how):
    run, term = LOOPS[site]
    ask, view = silent(3, (term,))
    x = Slipped(run, (Slip(site, "", how),), True)(view, term)
    assert np.abs(x - view.compute(term)).max() > 1e-6 * np.abs(x).max()
    if term == "crba":  # all that the joint's acceleration makes is zero
        assert sum(not np.diagonal(x, 0, 1, 2)[:, k].any() for k in range(x.shape[-1])) == 1
    found = diagnose(case_of(Answers(ask, **{term: x}), ask), LONG).findings
    assert {f.key for f in found} <= {
        how,
        "joint_unread",
        "joint_still",
        "zeros",
    } and found  # of one joint it is the same


def test_a_cause_that_alone_explains_it_needs_no_other():
    one, other = (Hypothesis(key, key, TERMS, "formula", lambda *given: None) for key in ("one", "other"))
    assert minimal([(one,), ordered((one, other))]) == [(one,)]
    assert minimal([ordered((one, other))]) == [ordered((one, other))]


def test_stories_of_several_causes_are_made_by_one_algorithm():
    mass, joint = (Dynamics(right(spatial.forces), of.mass) for of in (about_world, about_centres))
    slips = [
        Hypothesis(str(k), str(k), TERMS, "formula", Slipped(run, ())) for k, run in enumerate((mass, mass, joint))
    ]
    first, second, third = ((h,) for h in slips)
    assert in_every_way([[first], [second, third]]) == [ordered((*first, *second))]
    assert in_every_way([[first], []]) == [first]
