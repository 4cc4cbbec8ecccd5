"""Textbook formulations: right without a slip, and each of their slips is told by the answers that it makes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import RULES, Case, diagnose
from dualpin.crosscheck.diagnosis.catalogue import Catalogue
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.rules import kinematics
from dualpin.crosscheck.diagnosis.rules.dynamics import Seen
from dualpin.crosscheck.diagnosis.rules.formulation import possible
from dualpin.crosscheck.diagnosis.textbook import (
    about_centres,
    answers,
    articulated,
    body_coriolis,
    body_form,
    body_twists,
    composite,
    exponentials,
    habits,
    link_axes,
    plucker,
    spatial,
    spatial_sums,
    sums,
    transforms,
    world_axes,
    world_motions,
)
from dualpin.crosscheck.diagnosis.textbook.assembly import Dynamics, InOrder, by_columns
from dualpin.crosscheck.diagnosis.textbook.body_twists import Frames
from dualpin.crosscheck.diagnosis.textbook.slipped import Slipped, alike, predicted
from dualpin.crosscheck.diagnosis.textbook.steps import Steps
from dualpin.crosscheck.subjects import QUESTIONS, Answers, Asking, Convention, asking
from dualpin.crosscheck.subjects.layout import Layout
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.planted_passes import PASSES, wrong

PROBE = str(Path(__file__).parents[2] / "urdf/probe/probe.urdf")
MERGED = plucker.merged_links
PASSES_OF = (spatial.forces, spatial.mass, body_coriolis.matrix)
RUNS = {
    "world": Dynamics(world_axes.forces, by_columns(world_axes.forces)),
    "link": Dynamics(link_axes.forces, by_columns(link_axes.forces)),
    "spatial": Dynamics(spatial.forces, by_columns(spatial.forces)),
    "composite": Dynamics(spatial.forces, spatial.mass),
    "lumps": Dynamics(spatial.forces, composite.mass),
    "composites about centres": Dynamics(spatial.forces, about_centres.mass),
    "energy": composite.Energy(),
    "seen in world axes": Seen(world_motions.accelerations),
    "seen in link axes": Seen(link_axes.accelerations, True),
    "seen in six-vectors": Seen(spatial.seen, both=True),
    "pushed in six-vectors": Dynamics(spatial.forces, spatial.mass, pushed=spatial.pushed),
    "pushed in world axes": Dynamics(world_axes.forces, spatial.mass, pushed=world_axes.pushed, fused=True),
    "pushed in link axes": Dynamics(link_axes.forces, spatial.mass, pushed=link_axes.pushed),
    "transforms": transforms.Transforms(),
    "transforms by chains": transforms.Transforms(True, True, plucker.merged_links),
    "seen by transforms": Seen(partial(spatial.seen, by_transforms=True), True, True),
    "energy in six-vectors": composite.Energy(True, spatial_sums.energy),
    **{
        f"{kind} {name}": run
        for name, of in (
            ("about centres", plucker.centres),
            ("in the world", plucker.world),
            ("merged", MERGED),
            ("of blocks in the world", plucker.world_blocks),
        )
        for kind, run in (
            ("six-vectors", Dynamics(*(partial(f, of=of) for f in PASSES_OF), fused=of is MERGED)),
            ("energy", composite.Energy(of is MERGED, partial(spatial_sums.energy, of=of))),
            ("articulated", articulated.Articulated(of is MERGED, of)),
            ("pushed", Dynamics(spatial.forces, spatial.mass, pushed=partial(spatial.pushed, of=of))),
        )
    },
    "articulated": articulated.Articulated(),
    "articulated, in the order of a stack": InOrder(articulated.Articulated(), "as a stack gives them"),
    "world, level by level": InOrder(Dynamics(world_axes.forces, by_columns(world_axes.forces)), "breadth first"),
    "link, in the order of a stack": InOrder(
        Dynamics(link_axes.forces, spatial.mass, fused=True), "as a stack gives them"
    ),
    "lagrange": partial(kinematics.jacobians, how=answers.LAGRANGE),
    "lagrange, with M by its factor": partial(kinematics.jacobians, how=answers.LAGRANGE, factored=True, fused=True),
    "habits": Dynamics(world_axes.forces, habits.mass),
    "sums": sums.run,
    "body coriolis": Dynamics(spatial.forces, spatial.mass, body_coriolis.matrix),
    "jacobians": kinematics.jacobians,
    "jacobians, symbolic": partial(kinematics.jacobians, how=kinematics.SYMBOLIC),
    "jacobians, symbolic by rates": partial(kinematics.jacobians, how=kinematics.RATED),
    "jacobians, symbolic, of the second": partial(kinematics.jacobians, how=kinematics.TRANSPOSED),
    "exponentials": exponentials.run,
    "exponentials of merged bodies": partial(exponentials.run, fused=True, frames=Frames.AT_CENTRES),
    "exponentials of bodies in the base's axes": partial(exponentials.run, frames=Frames.IN_BASE),
    "exponentials in the body's form": body_form.run,
    **{
        f"{kind} of body twists, {frames.value}": run
        for frames in Frames
        for of in (partial(body_twists.bodies, frames=frames),)
        for kind, run in (
            ("recursion", Dynamics(partial(spatial.forces, of=of), partial(spatial.mass, of=of))),
            ("energy", composite.Energy(by=partial(spatial_sums.energy, of=of))),
            ("pushed", Dynamics(spatial.forces, spatial.mass, pushed=partial(spatial.pushed, of=of))),
        )
    },
    "jacobians, velocities too": partial(kinematics.jacobians, how=kinematics.JACOBIANS),
}

PREDICTS = {
    "exponentials of": exponentials.IN_BODIES, "exponentials in": body_form.TERMS, "exponentials": exponentials.TERMS,
    "transforms by chains": (*transforms.OF_FRAMES, *transforms.OF_BODIES),
    "transforms": ("fk", *transforms.OF_FRAMES, *transforms.OF_RATES, *transforms.OF_BODIES),
    "sums": sums.TERMS, "energy": ("kinetic_energy",), "seen in six-vectors": ("frame_velocity", "frame_acceleration"),
    "seen by transforms": ("frame_velocity", "frame_acceleration"),
    "recursion of body twists": ("gravity", "rnea", "crba", "coriolis"),
    "seen": ("frame_acceleration",), "pushed": ("rnea_f_ext", "aba_f_ext"), "jacobians, symbolic": ("coriolis",),
    "jacobians": (*kinematics.SEEN, *kinematics.MOVED, "rnea_f_ext", "aba_f_ext"),
    "lagrange": (*kinematics.SEEN, *kinematics.MOVED, "rnea_f_ext", "aba_f_ext"),
}  # fmt: skip
"""The terms of those that begin so, if not all."""
FIXED = (
    "jacobians, symbolic", "exponentials", "recursion of body twists", "energy of body", "pushed of body", "lagrange",
)  # fmt: skip
"""Of fixed bases only."""


def asked(robot: str, floating: bool = False, samples: int = 2, seed: int = 0) -> Asking:
    return asking(robot, samples, seed, tuple(QUESTIONS), floating=floating)


def answering(ask: Asking, terms: dict[str, np.ndarray] | None = None, **how: str) -> Case:
    how = replace(Convention.of(ask.robot), **how)
    return Case(Answers("somebody", "", how, ask, Layout(ask.robot, how).states(ask.states), terms or {}))


LONGER = [pytest.param(*x, marks=pytest.mark.campaign) for x in (("panda", False), ("solo12", True), ("kinova", False))]


@pytest.mark.parametrize(("robot", "floating"), [(PROBE, False), (PROBE, True), *LONGER])
@pytest.mark.parametrize("run", RUNS)
def test_without_a_slip_every_term_is_that_of_dualpin(robot, floating, run):
    view, compared = answering(asked(robot, floating)).view(()), 0
    size = 1e-10 if floating else 1e-11  # what inverting M leaves: its condition is 1e4 to 1e6
    terms = next((terms for name, terms in PREDICTS.items() if run.startswith(name)), tuple(QUESTIONS))
    if run.startswith(FIXED) and floating:
        return
    for term in terms:
        x = RUNS[run](view, term, Steps())
        if x is not None:
            y = view.compute(term, view.layout.how.reference)
            assert np.abs(x[0] - y).max() < size * max(1, np.abs(y).max()), term
            compared += 1
    assert compared >= (3 if run.startswith("articulated") else min(5, len(terms)))


@pytest.mark.parametrize("reference", ["world", "local"])
def test_exponentials_and_wrenches_in_body_twists_have_every_reference(reference):
    view = answering(asked(PROBE), reference=reference).view(())
    pushed = [run for name, run in RUNS.items() if name.startswith("pushed") and "world" not in name]
    for term, runs in {**dict.fromkeys(exponentials.OF_FRAMES, (exponentials.run,)), "rnea_f_ext": pushed}.items():
        for run in runs:
            x, y = run(view, term, Steps()), view.compute(term, reference)
            assert np.abs(x[0] - y).max() < 1e-11 * max(1, np.abs(y).max()), term
    for term in exponentials.OF_FRAMES:
        x = body_form.run(view, term, Steps())
        assert (x is None) if reference == "world" else np.abs(x[0] - view.compute(term, reference)).max() < 1e-11


def test_rotors_count_in_every_formulation(tmp_path):
    path = tmp_path / "arm.xml"
    geom = '<geom type="capsule" size=".05" fromto="0 0 0 .3 .1 0" mass="2"/>'
    path.write_text(
        f"""<mujoco><worldbody><body name="a"><joint name="p" axis="0 1 0" armature=".3"/>{geom}
        <body name="b" pos=".3 .1 0"><joint name="q" axis="0 0 1" armature=".2"/>{geom}</body></body></worldbody>
        </mujoco>"""
    )
    ask = asked(str(path))
    view = answering(ask).view(())
    assert [float(x) for j in ask.robot for x in j.armature] == [0.3, 0.2]
    for name in ("world", "link", "composite", "articulated", "lagrange"):
        for term in ("rnea", "crba", "aba", "minv"):
            x = RUNS[name](view, term, Steps())
            assert x is None or np.abs(x[0] - view.compute(term)).max() < 1e-12, (name, term)


def hypotheses(case: Case) -> list[Hypothesis]:
    return [h for rule in RULES if rule.late for h in rule.propose(case) if isinstance(h.act, Slipped)]


@pytest.mark.parametrize("term", ["rnea", "minv", "coriolis"])
def test_many_slips_in_one_run_predict_the_same_as_each_alone(term):
    ask = asked(PROBE)
    case = answering(ask, {term: np.zeros((2, *[ask.robot.nv] * (1 + (term != "rnea"))))})
    view = case.view(())
    found = [h for h in hypotheses(case) if term in h.terms and h.act.batched][:: 61 if term != "coriolis" else 191]
    acts = [h.act for h in found]
    with np.errstate(all="ignore"):  # as in a diagnosis: a slip may leave no inertia to divide by
        together = {tuple(at): predicted([acts[i] for i in at], view, term) for at in alike(acts, [view] * len(acts))}
        single = [act(view, term) for act in acts]
    for at, found_x in together.items():
        for k, x in zip(at, found_x, strict=True):
            alone = single[k]
            near = np.isclose(
                x, alone, rtol=1e-10, atol=1e-10 * max(1, np.nanmax(np.abs(alone), initial=0)), equal_nan=True
            )
            assert near.all(), found[k]


def test_a_formulation_that_does_not_cover_a_joint_proposes_nothing(tmp_path):
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    joint = '<joint name="j" type="planar"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
    path = tmp_path / "planar.urdf"
    path.write_text(f'<robot name="r"><link name="a"/><link name="b">{body}</link>{joint}</robot>')
    ask = asked(str(path))
    assert possible(RUNS["link"], answering(ask), "rnea") == []
    proposed = hypotheses(answering(ask, {"gravity": np.zeros((2, ask.robot.nv))}))
    assert not any("Newton-Euler" in h.says for h in proposed)  # others cover every joint


def named_by_itself(ask: Asking, h: Hypothesis, term: str) -> bool | None:
    """Whether answers made by a slip are explained by it or by what predicts the same; None where none shows."""
    right = answering(ask)
    x, plain = right.predict(term, (h,)), right.predict(term)
    if x is None or not np.isfinite(x).all() or np.abs(x - plain).max() < 1e-7:
        return None
    case = answering(ask, {term: x})
    found = diagnose(case, 20.0)
    return bool(found.findings) and all(f.key != "partly" and f.after < 1e-9 for f in found.findings)


def test_a_slip_is_found_among_all_by_its_answers():
    ask = asked(PROBE, samples=3)
    found = [h for h in hypotheses(answering(ask, {"bias": np.zeros((3, ask.robot.nv))})) if not h.variant]
    h = next(h for h in found if "w x (w x r) has the other sign" in h.says)
    x = answering(ask).predict("bias", (h,))
    stories = Catalogue(answering(ask, {"bias": x})).slips("bias", float("inf"))
    assert any(h.identity == s[0].identity for s in stories) and len(stories) < 20


@pytest.mark.campaign
@pytest.mark.parametrize("term", ["gravity", "bias", "rnea", "crba", "minv", "aba", "coriolis", "rnea_derivatives"])
def test_a_hundred_slips_name_themselves(term):
    ask = asked(PROBE, samples=6)
    shape = {"crba": 2, "minv": 2, "coriolis": 2, "rnea_derivatives": 3}.get(term, 1)
    n = ask.robot.nv
    case = answering(ask, {term: np.zeros((6, *(n,) * shape) if shape < 3 else (6, 3, n, n))})
    rng = np.random.default_rng(7)
    found = [h for h in hypotheses(case) if term in h.terms]
    results = {str(h): named_by_itself(ask, h, term) for h in (found[i] for i in rng.permutation(len(found))[:100])}
    missed = [h for h, named in results.items() if named is False]
    assert not missed and sum(named is True for named in results.values()) > 20, missed


def told(ask: Asking, name: str) -> bool:
    """Whether a slip planted in code of another kind is told in the words of its step, and explains everything."""
    found = diagnose(Case(ask_here(wrong(name)(ask.text, ask.floating), ask, lambda what: None)))
    words = [" ".join([f.says, *f.alternatives]) for f in found.findings]
    return not found.located and all(any(w in x for x in words) for w in PASSES[name][0])


@pytest.mark.parametrize("name", ["force_in_arm_unturned", "felt_along_z"])
def test_a_slip_in_another_code_is_told(name):
    assert told(asking(PROBE, 4, 0, ("gravity",)), name)


@pytest.mark.campaign
@pytest.mark.parametrize("name", PASSES)
def test_slips_in_another_code_are_told(name):
    assert told(asking(PROBE, 8, 0, tuple(QUESTIONS)), name)


def test_two_slips_of_one_formulation_are_made_together():
    ask = asked(PROBE)
    case = answering(ask, {"bias": np.zeros((2, ask.robot.nv))})
    found = [h for h in hypotheses(case) if h.says.startswith("Newton-Euler in link axes") and not h.variant]
    one, two = (next(h for h in found if w in h.says) for w in ("w x I w has the other sign", "w x z qd is left out"))
    both = RUNS["link"](case.view(()), "bias", Steps(*one.act.slips, *two.act.slips))[0]
    assert np.abs(case.predict("bias", (one, two)) - both).max() < 1e-13
    apart = [np.abs(case.predict("bias", (h,)) - both).max() for h in (one, two)]
    assert min(apart) > 1e-3
