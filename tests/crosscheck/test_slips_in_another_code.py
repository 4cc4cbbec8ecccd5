"""Slips of textbook algorithms predict what a code of another author answers that makes the same mistake."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest

from dualpin.crosscheck.diagnosis import RULES, Case
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.rules import kinematics
from dualpin.crosscheck.diagnosis.scores import FAR, scored
from dualpin.crosscheck.diagnosis.textbook import (
    about_centres,
    in_place,
    link_axes,
    plucker,
    spatial,
    walks,
    world_axes,
    world_motions,
)
from dualpin.crosscheck.diagnosis.textbook.answers import FROM_LINKS
from dualpin.crosscheck.diagnosis.textbook.articulated import Articulated
from dualpin.crosscheck.diagnosis.textbook.assembly import Dynamics, InOrder, Seen, by_columns
from dualpin.crosscheck.diagnosis.textbook.columns import MOVING as MOVING_AXES
from dualpin.crosscheck.diagnosis.textbook.slipped import Run, Slipped
from dualpin.crosscheck.diagnosis.textbook.steps import Slip
from dualpin.crosscheck.diagnosis.textbook.tree import tree_of
from dualpin.crosscheck.subjects import Asking, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.test_textbook import PROBE, answering
from tests.crosscheck.unseen_codes import source

OTHER = "step_other"
BLOCKS = {"aba": Articulated(of=plucker.world_blocks)}
WORLD = {"aba": Articulated(of=plucker.world)}
COMPOSITES = {t: Dynamics(spatial.forces, about_centres.mass) for t in ("crba", "minv")}
MOVING = {
    "frame_velocity": partial(kinematics.both, how=FROM_LINKS), "jacobian_dot": kinematics.poses,
    "kinetic_energy": partial(kinematics.poses, rooted=True),
}  # fmt: skip
NEWTON = {
    "bias": Dynamics(world_axes.forces, by_columns(world_axes.forces)),
    "frame_acceleration": Seen(world_motions.accelerations),
}
SPIN = ("wk = wk + z[k] * v[b.dof]", "wk += z[k] * v[b.dof]")
IN_THE_LOOP, UP = "                up = up + ", "                up += "
AT_JOINT = '            if b.kind == "revolute":\n                tau[b.dof]'
ONE_ARRAY = "        tau, kept = np.zeros(self.n), np.zeros((3, self.n))\n"
WALK = """        while k > 0:
            if self.bodies[k].kind != "fixed":
                yield k
            k = self.bodies[k].parent
"""
CHAINS = [
    f"for i in {of}:\n                if self.bodies[i].kind"
    for of in (
        "[x for x in self.chain(k) if x != k]",
        "[x for x in range(1, k + 1) if self.bodies[x].kind != 'fixed']",
    )
]
NEXT = 'j = next(x for x in todo if x.find("parent").get("link") in index)'
LEVELS = """known = [x for x in todo if x.find("parent").get("link") in index]
            j = min(known, key=lambda x: index[x.find("parent").get("link")])"""
STACK = """        stack, i = [0], -1
        while i != k:
            i = stack.pop()
            stack += [j for j, b in enumerate(self.bodies) if b.parent == i]
            if self.bodies[i].kind != "fixed":
                yield i
"""
LEFT = """            of = [self.bodies[i].dof for i in self.chain(k)]
            kept[:, of] = Jv[:, of]
"""
CHAIN = "the link before in the list, as in a chain"
BEFORE = "that of the link before in the list (depth first)"


def handed(of: str) -> Slip:
    return Slip(f"what a fixed link hands on{of}", "nothing", OTHER)


def array(of: str, what: str) -> Slip:
    return Slip(in_place.array(of), what, OTHER)


def block(of: str, what: str) -> Slip:
    return Slip(f"the block m {of} of the inertia", what, OTHER)


PLANTED: dict[str, tuple[dict[str, Run], Slip, list[tuple[str, str]]]] = {
    "sign of the parallel axes in the spatial inertia": (
        BLOCKS,
        Slip("the inertia about the world's origin", "m (c.c 1 - c c^T)", "step_sign"),
        [("C @ C.T, b.mass * C]", "C @ C, b.mass * C]")],
    ),
    "blocks of the spatial inertia exchanged": (
        BLOCKS,
        block("[c x]", "of the other sign, which is its transpose"),
        [("b.mass * C], [b.mass * C.T,", "b.mass * C.T], [b.mass * C,")],
    ),
    "lower block as the upper one": (
        BLOCKS,
        block("[c x]", "of the other sign, which is its transpose")._replace(
            site="the block m [c x] of the inertia: the lower left one"
        ),
        [("[b.mass * C.T, b.mass * np", "[b.mass * C, b.mass * np")],
    ),
    "a scalar in every entry": (
        BLOCKS,
        block("1", "m in every entry"),
        [("b.mass * np.eye(3)]", "b.mass * np.ones((3, 3))]")],
    ),
    "tensor turned on one side": (
        BLOCKS,
        Slip("the inertia of a body", "", "step_from_left"),
        [("np.block([[I[k]", "np.block([[R[k] @ b.inertia")],
    ),
    "fixed links not handed on": (WORLD, handed(""), [("A[i], P[i] = A[i] + A[k], P[i] + P[k]\n", "")]),
    "their bias forces not": (
        WORLD,
        handed(": its articulated bias force"),
        [("A[i], P[i] = A[i] + A[k], P[i] + P[k]", "A[i] = A[i] + A[k]")],
    ),
    "handed on along the list": (
        WORLD,
        Slip("the link that a link hands its inertia and bias force on to", CHAIN, OTHER),
        [
            (
                'i = b.parent\n            if b.kind == "fixed":\n                A',
                'i = k - 1\n            if b.kind == "fixed":\n                A',
            )
        ],
    ),
    "accelerations in one array": (
        WORLD,
        Slip("the motion that a link starts from: its acceleration", BEFORE, OTHER),
        [(IN_THE_LOOP + "bias", UP + "bias"), (IN_THE_LOOP + "S[k]", UP + "S[k]")],
    ),
    "velocities in one array": (
        WORLD,
        Slip("the motion that a link starts from: its velocity", BEFORE, OTHER),
        [("V[k] = V[b.parent] + S[k] * v[b.dof]", "V[k] += S[k] * v[b.dof]")],
    ),
    "velocity products summed in one array": (
        WORLD,
        array("v x S qd", in_place.ADDED),
        [("bias[k] = self.motion_cross", "bias[k] += self.motion_cross")],
    ),
    "velocity products written into one array": (
        WORLD,
        array("v x S qd", in_place.LAST),
        [("bias[k] = self.motion_cross", "bias[k][:] = self.motion_cross")],
    ),
    "c without I^a": (WORLD, Slip("the articulated inertia in I^a c", "1", OTHER), [("Aa @ bias[k]", "bias[k]")]),
    "d * d for the outer product": (
        COMPOSITES,
        Slip("d d^T in Steiner's term", "the product d d by elements, in each row", OTHER),
        [("np.outer(d, d))", "d * d)")],
    ),
    "the child's mass twice in the divisor": (
        COMPOSITES,
        Slip(
            "the divisor of a composite's centre",
            "the link's mass and twice the child's, which was added before",
            OTHER,
        ),
        [("* c[k]) / total", "* c[k]) / (m[i] + m[k] + m[k])")],
    ),
    "a sliding joint moves its own link alone": (
        COMPOSITES,
        Slip("the mass that a unit acceleration moves: of a sliding joint", "the link's own", OTHER),
        [("F, N = m[k] * z[k]", "F, N = b.mass * z[k]")],
    ),
    "entries of M by a walk without the body's own joint": (
        {"crba": COMPOSITES["crba"]},
        Slip(MOVING_AXES, walks.OWN, OTHER),
        [("for i in self.chain(k):\n                if self.bodies[i].kind", CHAINS[0])],
    ),
    "entries of M by a walk that ends at a fixed joint": (
        {"crba": COMPOSITES["crba"]},
        Slip(MOVING_AXES, walks.TO_FIXED, OTHER),
        [
            (
                WALK,
                WALK.replace("            k = self", "            else:\n                return\n            k = self"),
            )
        ],
    ),
    "entries of M for all joints of smaller numbers": (
        {"crba": COMPOSITES["crba"]},
        Slip(MOVING_AXES, walks.CHAIN, OTHER),
        [("for i in self.chain(k):\n                if self.bodies[i].kind", CHAINS[1])],
    ),
    "velocities of the link before, level by level": (
        {"aba": InOrder(WORLD["aba"], "breadth first")},
        Slip("the motion that a link starts from: its velocity", BEFORE.replace("depth", "breadth"), OTHER),
        [(NEXT, LEVELS), ("V[k] = V[b.parent]\n", "V[k] = V[k - 1]\n"), ("V[b.parent] + S", "V[k - 1] + S")],
    ),
    "columns of all that a stack gives before a link": (
        {"jacobian": kinematics.jacobians},
        Slip(MOVING_AXES, "those of all joints with a smaller number than the link, in the order of a stack", OTHER),
        [(WALK, STACK)],
    ),
    "Jacobians of all bodies in one array": (
        {"gravity": kinematics.jacobians},
        Slip("the array of a body's Jacobian", in_place.KEPT, OTHER),
        [
            ("        tau = np.zeros(self.n)\n        for k, b in enum", ONE_ARRAY + "        for k, b in enum"),
            ("            tau -= Jv.T", LEFT + "            tau -= kept.T"),
        ],
    ),
    "a block of the spatial inertia without the mass": (
        BLOCKS,
        block("[c x]", "without the mass")._replace(site="the block m [c x] of the inertia: the upper right one"),
        [("b.mass * C], [b", "C], [b")],
    ),
    "inertia about the joint, and the moment of the force too": (
        COMPOSITES,
        Slip("the inertia that a unit acceleration turns", "that about the joint's origin", OTHER),
        [("N = I[k] @ z[k]", "N = (I[k] + self.shift(m[k], c[k] - p[k])) @ z[k]")],
    ),
    "moments along the parent's axis": (
        {"bias": NEWTON["bias"]},
        Slip("the axis of force and moment: of turning links", "that of the parent", OTHER),
        [("tau[b.dof] = z[k] @ n", "tau[b.dof] = z[max(b.parent, 1)] @ n")],
    ),
    "angular velocities in one array": (MOVING, array("angular velocity", in_place.GROWING), [SPIN]),
    "linear velocities in one array": (
        MOVING,
        array("linear velocity", in_place.GROWING),
        [
            ("uk = u[i] + cross(w[i], p[k] - p[i])", "uk = u[i]; uk += cross(w[i], p[k] - p[i])"),
            ("uk = uk + z[k]", "uk += z[k]"),
        ],
    ),
    "angular velocities in one array, found behind the loop": (
        NEWTON,
        array("angular velocity", in_place.WHOLE),
        [SPIN],
    ),
    "angular accelerations in one array": (
        NEWTON,
        array("angular acceleration", in_place.GROWING),
        [("alk = alk + z[k] * a[b.dof] +", "alk += z[k] * a[b.dof] +")],
    ),
    "forces of bodies and at joints in one array": (
        {"bias": NEWTON["bias"]},
        Slip(link_axes.OWN_FORCE, link_axes.WHOLE_FORCE, OTHER),
        [
            ("n.append(N + cross(s, F))", "n.append(N)"),
            (AT_JOINT, AT_JOINT.replace("if", "n[k] = n[k] + cross(c[k] - p[k], f[k])\n            if", 1)),
        ],
    ),
    "linear accelerations in one array": (
        NEWTON,
        array("linear acceleration", in_place.GROWING),
        [
            ("ack = ac[i] + cross(al[i], r) +", "ack = ac[i]; ack += cross(al[i], r) +"),
            ("ack = ack + z[k]", "ack += z[k]"),
        ],
    ),
}


@cache
def asked() -> Asking:
    return asking(PROBE, 2, 0, tuple(dict.fromkeys(t for runs, _, _ in PLANTED.values() for t in runs)))


def answered(changes: list[tuple[str, str]]) -> Case:
    text = source("composites")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return Case(ask_here(made(text, asked()), asked(), lambda what: None))


def made(text: str, ask: Asking) -> object:
    names: dict[str, object] = {"__name__": __name__}
    exec(compile(text, "other", "exec"), names)
    return names["Code"](ask.text)


def test_without_a_change_the_other_code_is_right():
    case = answered([])
    assert case.wrong == frozenset() and set(case.observed) == set(asked().terms)


def test_a_wrong_entry_of_the_base_s_rotation_shows_in_all_terms_but_not_in_what_is_given_in_world_axes():
    terms = ("fk", "jacobian", "gravity", "crba", "coriolis", "bias", "rnea", "aba")
    ask = asking(PROBE, 2, 0, terms, floating=True)
    given = "R, p, axis = [R0],"
    assert source("legged").count(given) == 1
    text = source("legged").replace(given, f"R0[1, 1] = 1 - 2 * (x * x + y * y)\n        {given}")
    typed = Slip("zz in entry 22 of the rotation of the base", "yy", OTHER)
    run = replace(kinematics.rotations("quaternions to matrices"), how=(("fused", True),))
    planted = Hypothesis("step_other", typed.says, terms, "formula", Slipped(run, (typed,), True))
    case = Case(ask_here(made(text, ask), ask, lambda what: None))
    assert case.wrong == set(terms)
    assert [t for t in terms if not case.score(t, (planted,)).right] == []


@pytest.mark.parametrize("name", PLANTED)
def test_a_slip_predicts_what_another_code_answers(name):
    runs, slip, changes = PLANTED[name]
    case = answered(changes)
    for term, run in runs.items():
        planted = Hypothesis("step_other", slip.says, (term,), "formula", Slipped(run, (slip,), True))
        assert not case.score(term).right, term
        assert case.score(term, (planted,)).right, term


def test_a_mean_of_centres_counts_links_without_mass():
    view = answering(asking(PROBE, 2, 0, ("com",))).view(())
    tree = tree_of(view)
    poses, moved = tree.poses(view.states["q"][None]), [k for k in tree.links if tree.joints_of(k)]
    assert any(k.mass == 0 for k in moved)
    centres = [poses[k.number].p0 + (poses[k.number].R0 @ k.c[..., None])[..., 0] for k in moved]
    slip = Slip("the centre of mass", "the mean of all links that move, of those without mass too", OTHER)
    x = Slipped(kinematics.jacobians, (slip,), True)(view, "com")
    assert np.abs(x - np.mean(centres, axis=0)[0]).max() < 1e-12


def test_a_row_of_the_mass_matrix_that_is_zero_where_its_column_is_not_is_named_as_that_of_the_forces():
    right = answering(asked())
    M, tau = right.predict("crba").copy(), right.predict("bias").copy()
    M[:, 2], tau[:, 2] = 0.0, 0.0
    case = answering(asked(), {"crba": M, "bias": tau})
    (rule,) = (rule for rule in RULES if rule.key == "zeros")
    (found,) = rule.propose(case)
    assert set(found.terms) == {"crba", "bias"} and found.items == (case.how.v[2],)
    turned = answering(asked(), {"crba": np.swapaxes(M, 1, 2)})
    assert all(case.score(t, (found,)).right for t in found.terms)
    assert [turned.score("crba", (h,)).right for h in rule.propose(turned)] == [True]


@pytest.mark.parametrize(
    ("number", "what"), [("b.parent", "by X of its parent"), ("i + 1", "by X of the next link in the list")]
)
def test_forces_that_are_handed_on_by_the_matrix_of_another_link(number, what):
    ask = asking(PROBE, 2, 0, ("bias",))
    there = f"[*Xup, np.eye(6)][{number}].T @ F[i]"
    text = source("sixvectors")
    assert text.count("Xup[i].T @ F[i]") == 1
    case = Case(ask_here(made(text.replace("Xup[i].T @ F[i]", there), ask), ask, lambda what: None))
    run = Dynamics(spatial.forces, spatial.mass, fused=True)
    slip = Slip("the force that is handed on, X^T f,", what, "step_other_turn")
    planted = Hypothesis("step_other_turn", slip.says, ("bias",), "formula", Slipped(run, (slip,), True))
    assert not case.score("bias").right
    assert case.score("bias", (planted,)).right


SECOND, FIRST = "(X[i] - L[i + 1 :, i] @ X[i + 1 :])", "(X[i] - L[i, :i] @ X[:i])"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ((SECOND, "(X[i] - L[i, i + 1 :] @ X[i + 1 :])"), "second substitution reads L"),
        ((FIRST, "(X[i] - L[:i, i] @ X[:i])"), "first substitution reads L^T"),
        ((f"{SECOND} / L[i, i]", SECOND), "second substitution that does not divide"),
        ((f"{FIRST} / L[i, i]", FIRST), "first substitution that does not divide"),
    ],
)
def test_substitutions_with_a_factor_that_are_wrong(change, words):
    case = answered([change])
    (rule,) = (rule for rule in RULES if rule.key == "inverse_factors")
    told = [str(h) for h in rule.propose(case) if case.score("minv", (h,)).right]
    assert not case.score("minv").right
    assert len(told) == 1 and words in told[0]


def test_predictions_of_which_none_is_finite_are_far():
    x = np.ones((2, 3))
    assert scored(x, [np.full((2, 3), np.inf), None], np.full(2, 1e-9)) == [FAR, FAR]
    assert scored(x, [np.full((2, 3), np.nan), x], np.full(2, 1e-9))[1].right
