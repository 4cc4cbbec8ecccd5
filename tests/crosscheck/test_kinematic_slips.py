"""Textbook kinematics and sums over bodies: right without a slip, and their slips are named."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import RULES, Case, diagnose
from dualpin.crosscheck.diagnosis.rules import kinematics, rates
from dualpin.crosscheck.diagnosis.textbook.answers import CARRIED_TOGETHER, FROM_LINKS
from dualpin.crosscheck.diagnosis.textbook.steps import Steps
from dualpin.crosscheck.subjects import QUESTIONS, Answers, Asking, Convention, asking
from dualpin.crosscheck.subjects.layout import Layout, rotations
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.kinematic import SLIPS, Kinematic
from tests.crosscheck.test_blind import PROBE
from tests.random_robots import random_urdf

RUNS = {
    "poses": kinematics.poses, "jacobians": kinematics.jacobians,
    **{way: kinematics.rotations(way) for way in kinematics.WAYS},
}  # fmt: skip
HOW = (kinematics.LINKS, kinematics.JACOBIANS, kinematics.DIFFERENTIATED)


def silent(ask: Asking, **words: str) -> Answers:
    """Nobody's answers, in dualpin's columns."""
    how = replace(Convention.of(ask.robot), **words)
    return Answers("nobody", "", how, ask, Layout(ask.robot, how).states(ask.states))


def apart(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.abs(x - y).max() / max(1.0, np.abs(y).max()))


@pytest.fixture(scope="module")
def trees(tmp_path_factory) -> list[Asking]:
    """Random trees with every kind of joint, fixed links, joints that follow others, and floating bases; the probe."""
    found = [asking(PROBE, 2, 0, tuple(QUESTIONS))]
    for seed in (3, 4, 5):
        path = tmp_path_factory.mktemp("trees") / f"tree{seed}.urdf"
        path.write_text(random_urdf(seed, 8, mimic=True))
        found.append(asking(str(path), 2, seed, tuple(QUESTIONS), floating=seed % 2 == 0, mimic=seed > 4))
    return found


@pytest.mark.parametrize("fused", [False, True])
def test_without_a_slip_every_formulation_is_right(trees, fused):
    for ask in trees:
        view = Case(silent(ask)).view(())
        singular = np.linalg.cond(view.compute("crba")).max() > 1e8  # of links without mass
        for run in RUNS.values():
            terms = (*kinematics.SEEN, *kinematics.MOVED) if run is kinematics.jacobians else ("fk", "com")
            for term in terms:
                if term not in ("minv", "aba") or not singular:
                    assert apart(run(view, term, Steps(), fused=fused)[0], view.compute(term)) < 1e-10, (ask.name, term)
        for term in ("com_jacobian", "gravity"):
            x = kinematics.jacobians(view, term, Steps(), fused=fused, how=CARRIED_TOGETHER)[0]
            assert apart(x, view.compute(term)) < 1e-11


@pytest.mark.parametrize("reference", ["local_world_aligned", "local", "world"])
def test_without_a_slip_every_reference_is_right(trees, reference):
    for ask in trees:
        view = Case(silent(ask, reference=reference)).view(())
        made = {how: partial(kinematics.jacobians, how=how) for how in HOW}
        twists = (made[""], partial(kinematics.both, how=FROM_LINKS))
        rates = [("jacobian_dot", run) for run in made.values()]
        for term, run in [("jacobian", made[""]), *rates, *(("frame_velocity", run) for run in twists)]:
            assert apart(run(view, term, Steps())[0], view.compute(term, reference)) < 1e-11, (ask.name, term)


def test_many_slips_in_one_run_are_those_of_each(trees):
    """And each says in words of its own what it does."""
    for ask in trees[:2]:
        view = Case(silent(ask)).view(())
        for run, term in ((kinematics.poses, "jacobian_dot"), (kinematics.jacobians, "centroidal_momentum_matrix")):
            steps = Steps()
            right = run(view, term, steps)[0]
            slips = list(steps.found)[::7]
            with np.errstate(invalid="ignore", divide="ignore"):  # a slip may leave no mass to divide by
                together = run(view, term, Steps.together([(s,) for s in slips]))
                each = [run(view, term, Steps(s))[0] for s in slips]
            assert len({s.says for s in slips}) == len(slips) > 5
            changed = 0
            rows = np.broadcast_to(together, (len(slips), *right.shape))
            for slip, x, alone in zip(slips, rows, each, strict=True):
                assert np.array_equal(np.isnan(x), np.isnan(np.broadcast_to(alone, x.shape))), slip
                assert apart(np.nan_to_num(x), np.nan_to_num(alone)) < 1e-13, slip
                changed += not apart(x, right) <= 1e-9
            assert changed > len(slips) / 2


def test_angles_and_their_rates():
    """R = R_a R_b R_c, and w = E (rates), against a small turn."""
    rng = np.random.default_rng(0)
    q = rng.standard_normal((20, 4))
    R, w, h = rotations(q / np.linalg.norm(q, axis=-1, keepdims=True)), np.array([0.3, -0.2, 0.5]), 1e-6
    turned = rotations(np.array([1.0, *(h * w / 2)]) / np.hypot(1, np.linalg.norm(h * w / 2))) @ R
    for order in ("zyx", "xyz", "zyz", "yxz", "xyx"):
        angles, later = (rates._angles(order, x) for x in (R, turned))
        product = np.eye(3)
        for k, axis in enumerate(order):
            product = product @ rates._turned("xyz".index(axis), angles[:, k])
        assert np.abs(product - R).max() < 1e-12
        E = rates.euler_matrix(order, R)
        smooth = np.abs(later - angles).max(-1) < 1e-3  # but where an angle wraps or the middle one is singular
        moved = np.einsum("nij,nj->ni", E, (later - angles) / h)[smooth]
        assert smooth.sum() > 15 and np.abs(moved - w).max() < 1e-3
    assert np.abs(rates.rotation_vector(np.eye(3)[None]) - np.eye(3)).max() < 1e-6


def test_a_matrix_with_the_same_product_is_told_with_its_symmetric_part():
    """A skew part that v does not feel leaves dM/dt = C + C^T as it is; another part does not."""
    ask = asking(PROBE, 4, 0, ("coriolis",))
    C, v = Case(silent(ask)).predict("coriolis"), ask.states["v"]
    unfelt = np.eye(C.shape[-1]) - v[:, :, None] * v[:, None] / (v**2).sum(-1)[:, None, None]
    A = np.random.default_rng(0).standard_normal(C.shape)
    for extra, words in ((unfelt @ (A - np.swapaxes(A, 1, 2)) @ unfelt, "holds"), (A @ unfelt, "does not hold")):
        (finding,) = diagnose(Case(replace(silent(ask), terms={"coriolis": C + extra}))).findings
        assert finding.key == "same_cv" and f"dM/dt = C + C^T {words}" in finding.says


# --- slips are named -----------------------------------------------------------------------------


def told(slip: str, floating: bool) -> bool | None:
    """Whether the independent code's slip is named, and nothing else; None where nothing shows."""
    change, words = SLIPS[slip]
    ask = asking(PROBE, 8, 0, kinematics.SEEN, floating=floating)
    code = type("Wrong", (Kinematic,), change)(ask.text, floating)
    case = Case(ask_here(code, ask, lambda what: None))
    if all(case.score(t).right for t in case.observed):
        return None
    found = diagnose(case)
    named = [f for f in found.findings if f.key != "follows"]
    return bool(named) and not found.located and all(words in " ".join([f.says, *f.alternatives]) for f in named)


@pytest.mark.parametrize("floating", [False, True])
def test_the_independent_code_is_right(floating):
    ask = asking(PROBE, 3, 0, kinematics.SEEN, floating=floating)
    case = Case(ask_here(Kinematic(ask.text, floating), ask, lambda what: None))
    assert all(case.score(t).right for t in kinematics.SEEN) and diagnose(case).findings == []


@pytest.mark.parametrize("slip", ["no_arm_rate"])
def test_slips_of_an_independent_code_are_named(slip):
    assert told(slip, False)


@pytest.mark.campaign
@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("slip", SLIPS)
def test_every_slip_of_the_independent_code_is_named(slip, floating):
    assert told(slip, floating) is not False


def named_by_itself(ask: Asking, count: int, seed: int) -> tuple[int, int]:
    """Of a random sample of all slips: how many are named, and how many show."""
    plain = Case(silent(ask))
    plain.observed |= {t: plain.predict(t) for t in QUESTIONS}
    right = dict(plain.observed)
    wrong = Case(replace(silent(ask), terms={t: x + 1 for t, x in right.items()}))  # slips of right terms are none
    slips = [h for rule in RULES if rule.late for h in rule.propose(wrong) if set(h.terms) & set(kinematics.SEEN)]
    named = shown = 0
    for k in np.random.default_rng(seed).permutation(len(slips))[:count]:
        h = slips[k]
        answers = {t: x for t in h.terms if (x := plain.predict(t, (h,))) is not None and np.isfinite(x).all()}
        case = Case(replace(silent(ask), terms=right | answers))
        if all(case.score(t).right for t in answers):
            continue
        found, shown = diagnose(case), shown + 1
        named += bool(found.findings) and not found.located
    return named, shown


@pytest.mark.campaign
@pytest.mark.parametrize(("robot", "floating"), [(PROBE, False), (PROBE, True), ("panda", False)])
def test_most_slips_name_themselves(robot, floating):
    named, shown = named_by_itself(asking(robot, 12, 0, tuple(QUESTIONS), floating=floating), 60, 2)
    assert shown and named >= 0.95 * shown


@pytest.mark.parametrize("fused", [False, True])
def test_rates_by_second_derivatives_and_forces_of_right_motions_are_right(trees, fused):
    view = Case(silent(trees[0])).view(())  # second derivatives are of fixed bases and single axes
    for term in ("jacobian_dot", "frame_acceleration", "bias", "rnea", "coriolis"):
        x = kinematics.jacobians(view, term, Steps(), how=kinematics.SECOND, fused=fused)[0]
        assert apart(x, view.compute(term)) < 1e-11, term
    for how in (kinematics.SYMBOLIC, kinematics.RATED):  # and derivatives of M by them, joint by joint
        x = kinematics.jacobians(view, "coriolis", Steps(), how=how, fused=fused)[0]
        assert apart(x, view.compute("coriolis")) < 1e-11, how
    for ask in trees:
        view = Case(silent(ask)).view(())
        for other in ({"early": True}, {"by_level": True}):  # axes kept in the world, and links in another order
            for term in ("jacobian_dot", "frame_velocity", "crba"):
                assert apart(kinematics.poses(view, term, Steps(), fused=fused, **other)[0], view.compute(term)) < 1e-11
        x = kinematics.jacobians(view, "bias", Steps(), how=kinematics.PROJECTED, fused=fused)[0]
        assert apart(x, view.compute("bias")) < 1e-11


@pytest.mark.campaign
def test_a_slip_that_two_terms_show_by_different_computations_is_told_once(trees):
    """Velocities that are right, and forces and a mass matrix by a Jacobian that is not."""
    ask = trees[0]
    view = Case(silent(ask)).view(())
    steps = Steps()
    kinematics.jacobians(view, "bias", steps)
    slip = next(s for s in steps.found if s.what == "[z; z]" and s.site == "the column of a sliding axis")
    made = {
        "crba": kinematics.jacobians(view, "crba", Steps(slip))[0],
        "bias": kinematics.jacobians(view, "bias", Steps(slip), how=kinematics.PROJECTED)[0],
    }
    silence = silent(ask)
    found = diagnose(Case(replace(silence, terms=made))).findings
    assert [(f.key, sorted(f.terms)) for f in found] == [("step_other", ["bias", "crba"])]
    assert slip.what in found[0].says


POSES_OF_BASE = {
    "base_pose: the base's position is ignored": lambda x: x * [0, 0, 0, 1, 1, 1, 1],
    "base_turn: the base's orientation is inverted": lambda x: x * [1, 1, 1, 1, -1, -1, -1],
    "base_entry: qx of the base's pose has the other sign": lambda x: x * [1, 1, 1, 1, -1, 1, 1],
}


@pytest.mark.parametrize("words", POSES_OF_BASE)
def test_a_base_that_is_taken_to_stand_elsewhere_is_named(words):
    """Whose velocity is what was sent, in the world's axes."""
    ask = asking(PROBE, 2, 0, ("fk", "jacobian", "jacobian_dot", "com", "bias"), floating=True)
    silence = silent(ask, angular="world", linear="world")
    layout = Layout(ask.robot, silence.how)
    q = ask.states["q"].copy()
    q[:, :7] = POSES_OF_BASE[words](q[:, :7])
    theirs = {**silence.sent, "q": layout.positions(q)}
    elsewhere = Case(replace(silence, asking=replace(ask, states=layout.back(theirs)), sent=theirs))
    made = {t: elsewhere.predict(t) for t in ask.terms}
    found = diagnose(Case(replace(silence, terms=made))).findings
    assert [f"{f.key}: {f.says}" for f in found] == [words]
