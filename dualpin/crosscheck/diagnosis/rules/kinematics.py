"""Slips of kinematics, of sums over bodies, and of the equations of motion by Jacobians: see the folder `textbook`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np

from ..case import Case, View
from ..textbook.answers import (
    CARRIED,
    DIFFERENTIATED,
    GRADIENTS,
    JACOBIANS,
    LARGE,
    LINKS,
    MOVED,
    MOVING,
    OF_FRAMES,
    POINTS,
    PRODUCTS,
    PROJECTED,
    RATED,
    RATED_APART,
    SECOND,
    SEEN,
    SYMBOLIC,
    Made,
)  # fmt: skip
from ..textbook.assembly import Dynamics
from ..textbook.in_place import GROWING
from ..textbook.lists import branched
from ..textbook.posed import Posed
from ..textbook.poses import stacked
from ..textbook.references import referred
from ..textbook.slipped import Run
from ..textbook.steps import Slip, Steps
from ..textbook.walks import ALL
from ..textbook.ways import WAYS
from .formulation import COST, FUSING, Terms, formulation

__all__ = ["DIFFERENTIATED", "JACOBIANS", "LINKS", "MOVING", "PROJECTED", "RATED", "SECOND", "SEEN", "SYMBOLIC", "WAYS"]


def off(*terms: str) -> Callable[[Case], bool]:
    """Whether one of these is wrong, or was not asked."""
    return lambda case: any(t not in case.observed or not case.score(t).right for t in terms)


def few(case: Case) -> bool:
    return not case.floating and case.robot.nv <= 12


EARLY = ("early", True)


@dataclass(frozen=True)
class Slipping:
    """Answers with slips in some parts: in a field of `Made`, or in one of the ways of rotations."""

    parts: frozenset[str]
    how: tuple[tuple[str, Any], ...] = ()

    def __call__(self, view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
        fields: dict[str, Any] = dict.fromkeys(self.parts - WAYS.keys(), steps)
        for way in self.parts & WAYS.keys():
            fields["ways"] = WAYS[way](steps)
        return Made(view, **fields, **dict(self.how), **how).term(term)

    def beside(self, other: object) -> Run | None:
        """With slips in the parts of both, or in poses and the recursion over them; None where no code makes both."""
        if type(other) is Dynamics:
            moves = not self.parts & {"rest", "reading"} and self.how == (("fused", True),) * other.fused
            return Posed(other, "".join(self.parts - {"poses"}), both=True) if moves and len(self.parts) == 1 else None
        if not isinstance(other, Slipping) or {*self.how, EARLY} != {*other.how, EARLY}:
            return None
        parts, how = self.parts | other.parts, max(self.how, other.how, key=len)  # axes are kept early in both
        return Slipping(parts, how) if len(parts & WAYS.keys()) < 2 else None


poses = Slipping(frozenset({"poses"}))
"""With slips in poses and velocities."""
jacobians = Slipping(frozenset({"rest"}))
"""With slips in Jacobians, sums over bodies, and what is made of them."""
reading = Slipping(frozenset({"reading"}))
"""With slips in reading tensors, which then may not be symmetric."""


def rotations(way: str) -> Slipping:
    """With slips in one of these ways."""
    return Slipping(frozenset({way}))


def velocities(view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
    """Twists of frames, from link to link."""
    tree = Made(view, poses=steps, **how).whole
    links = [tree.number[f] for f in view.frames]
    R, p, w, v = (stacked(x, links, k) for x, k in ((tree.R, 2), (tree.p, 1), (tree.w, 1), (tree.v, 1)))
    twist = np.concatenate(np.broadcast_arrays(w, v), -1)[..., None]
    return referred(steps, twist, R, p, view.layout.how.reference, "the twist")[..., 0]


def subtrees(view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
    """Of what each joint carries together."""
    made = Made(view, rest=steps, **how)
    sums = made.sums(made.whole)
    J = sums.com_jacobian_by_subtrees()
    if term == "com_jacobian":
        return J
    torques = -(J * np.array(view.description.gravity)[:, None]).sum(-2) * sums.total
    return np.asarray(steps.add("gravity's torques", **{"-M J_G^T g": torques}))


def fuses(case: Case) -> bool:
    """Whether bodies or joints hang on fixed links."""
    return any(not p.moves for p in case.description.parts)


KNOWN = {
    ("the arm to a link's origin", "without the travel of a sliding joint", "step_other"): "slide_radius",
    ("the linear part of a turning column", "", "step_swapped"): "jacobian_linear_sign",
    ("the moment of a body", "w x I w", "step_left_out"): "gyroscopic",
    ("the moment of a body", "w x I w", "step_sign"): "gyroscopic_sign",
    ("the moment of a body", "w x I w", "step_half"): "gyroscopic_half",
    ("the moment of a body", "I Jw' v", "step_left_out"): "no_angular_acceleration",
    ("the angular momentum of a body", "I w", "step_left_out"): "spin",
    ("the angular momentum of a body", "r x m v", "step_left_out"): "orbit",
    ("the angular momentum of a body", "r x m v", "step_sign"): "orbit_sign",
    ("the centre of mass of a body", "", "step_unturned"): "com_frame",
    ("the weight of a body's centre", "1", "step_other"): "com_unweighted",
    ("the axis of a column", "", "step_unturned"): "axis_frame",
    ("xyz", "by its own rpy too", "step_other_turn"): "xyz_after_rpy",
    **{
        (site, "by its own rpy too", "step_other_turn"): "xyz_after_rpy"
        for site in ("xyz: of a moving joint", "xyz on a body", "xyz on a body: of a moving joint")
    },
    ("the inertia of a body", "", "step_unturned"): "inertia_frame",
    ("the inertia of a body", "", "step_turned_back"): "inertia_frame_transposed",
    ("the inertia of a body", "", "step_from_left"): "inertia_frame_half",
}  # fmt: skip
"""Slips that have keys of their own."""
SAYS = {
    "spin": "the spin I w of bodies is left out of the momentum",
    "orbit": "m r x v of bodies is left out of the angular momentum",
    "orbit_sign": "m r x v of bodies has the other sign in the angular momentum",
    "com_frame": "centres of mass are not turned into world axes",
    "xyz_after_rpy": "xyz of joints is turned by their rpy",
    "com_unweighted": "the centre of mass is the mean of the bodies' centres, without their masses",
}


def _register(name: str, run: Run, terms: Terms, after: str = "", **how: Any) -> None:
    """A formulation, of the links as they are and of bodies merged from fixed links.

    `after` is a term in which its slips show first, if that is answered; they are looked for there.
    """
    levels, rooted = how.get("by_level", False), how.get("rooted", False)
    marks = (
        how.get("how", ""), "with axes kept early" * how.get("early", False), "level by level" * levels,
        "the root link counts" * rooted,
    )  # fmt: skip
    variant = ", ".join(x for x in marks if x)
    cost, like = COST + 0.05 * bool(variant), shown_in(run)
    slow = partial(_answers, after)
    alike, when = name if name in WAYS else "", _branches if levels else _heavy_root if rooted else _always
    listing = _in_a_list if levels else _for_all_joints if rooted else _any
    formulation(name, terms, KNOWN, variant, when, cost, SAYS, True, like, slow, alike, listing)(_of(run, **how))
    both = ", ".join(x for x in ("of bodies merged from fixed links", variant) if x)
    formulation(
        name, terms, KNOWN, both, partial(_both, when, fuses), cost + FUSING, None, True, like, slow, alike, listing
    )(_of(run, fused=True, **how))


def _branches(case: Case) -> bool:
    return branched(case.description)


def _both(a: Callable[[Case], bool], b: Callable[[Case], bool], case: Case) -> bool:
    return a(case) and b(case)


def _any(slip: Slip) -> bool:
    return True


def _in_a_list(slip: Slip) -> bool:
    return "in the list" in slip.what or slip.how in ("step_last", "step_last_alone")


def _for_all_joints(slip: Slip) -> bool:
    return slip.what == ALL


def _in_place(slip: Slip) -> bool:
    return slip.how == "step_other" and slip.what == GROWING


def _heavy_root(case: Case) -> bool:
    """Whether a link that nothing moves has a mass."""
    d = case.description
    grounded = {link for link, on in d.carriers().items() if on == d.root}
    bodies = [(d.root, d.base), *((p.link, p.body) for p in d.parts)]
    return not case.floating and any(b is not None and b.mass > 0 for link, b in bodies if link in grounded)


def _answers(after: str, case: Case) -> bool:
    return after in case.observed


def _always(case: Case) -> bool:
    return True


def shown_in(run: Run) -> Callable[[str], str]:
    """Where all slips show."""
    if run == poses:
        return lambda term: "frame_velocity" if term in (*MOVING, "coriolis") else "fk"
    if isinstance(run, Slipping) and run.parts <= WAYS.keys():
        return lambda term: "fk" if term in OF_FRAMES else "com"
    return (lambda term: "crba") if run == reading else _itself


def _itself(term: str) -> str:
    return term


@cache
def _of(run: Run, **how: Any) -> Run:
    """The same object for the same formulation: slips of one are made together."""
    return replace(run, how=tuple(how.items())) if isinstance(run, Slipping) else partial(run, **how)


def _terms(*always: str, **sometimes: Callable[[Case], bool]) -> Callable[[Case], list[str]]:
    """Terms, and groups of terms that are predicted where something holds."""
    return lambda case: [
        *dict.fromkeys([*always, *(t for group, holds in sometimes.items() if holds(case) for t in GROUPS[group])])
    ]


def not_large(case: Case) -> bool:
    return case.robot.nv <= LARGE


def symbols(case: Case) -> bool:
    """Whether Christoffel's symbols may explain C: of a wrong M."""
    return few(case) and off("crba")(case)


def placed(case: Case) -> bool:
    """Whether slips in poses may show in gravity as the gradient of the potential energy."""
    return few(case) and off("fk")(case)


def fixed(case: Case) -> bool:
    return not case.floating and not_large(case)


RATES = ("jacobian_dot", "frame_acceleration")
TENSORS = ("centroidal_momentum_matrix", "kinetic_energy", "crba", "minv", "bias", "rnea", "aba", "coriolis")
GROUPS = {
    "moved": MOVED, "of_velocity": ("bias", "rnea", "aba", "coriolis"), "matrix": ("coriolis",),
    "second": (*RATES, "bias", "rnea", "aba", "coriolis"), "posed": ("fk",), "turned": (*SEEN[1:], *MOVED),
    "rate": ("jacobian_dot",), "rates": RATES, "projected": ("bias", "rnea", "aba"), "tensors": TENSORS,
    "heights": ("gravity",),
    "products": (*RATES, "coriolis"), "sums": ("com_jacobian", "centroidal_momentum_matrix", "kinetic_energy"),
}  # fmt: skip
_register(
    "forward kinematics", poses, _terms(*SEEN, moved=off("fk"), of_velocity=off("frame_velocity", "jacobian_dot"))
)
_register("forward kinematics", poses, _terms(posed=off("fk")), early=True)
_register("forward kinematics", poses, _terms(*SEEN[1:], moved=off("fk")), after="fk", early=True)
_register("forward kinematics", poses, _terms(*RATES, "kinetic_energy", of_velocity=not_large), how=JACOBIANS)
_register("forward kinematics", poses, _terms(rates=off("fk")), how=DIFFERENTIATED)
IN_PLACE = "arrays changed in place"
for _rooted in (False, True):  # a root that turns with all others has an energy too
    formulation(
        "forward kinematics", ("kinetic_energy",), variant=IN_PLACE + ", the root link counts" * _rooted,
        when=_heavy_root if _rooted else _always, like=shown_in(poses), batched=True, only=_in_place,
    )(_of(poses, rooted=_rooted))  # fmt: skip
_register("forward kinematics", poses, _terms(*SEEN, moved=off("fk")), by_level=True)
_register("geometric Jacobians", jacobians, _terms(*SEEN, moved=not_large))
_register("geometric Jacobians", jacobians, _terms(*SEEN, moved=not_large), by_level=True)
_register("geometric Jacobians", jacobians, _terms(*RATES, "kinetic_energy", of_velocity=not_large), how=JACOBIANS)
_register("geometric Jacobians", jacobians, _terms(rates=off("jacobian")), how=DIFFERENTIATED)
for _name, _run in (("forward kinematics", poses), ("geometric Jacobians", jacobians)):
    _register(_name, _run, RATES, how=POINTS)
_register("geometric Jacobians", jacobians, _terms(second=fixed), how=SECOND)
for _how in (PRODUCTS, GRADIENTS):
    _register("geometric Jacobians", jacobians, _terms(products=fixed), how=_how)
_register("geometric Jacobians", jacobians, _terms(projected=not_large), how=PROJECTED)
_register("forward kinematics", poses, _terms(heights=placed), how=DIFFERENTIATED)
_register("geometric Jacobians", jacobians, _terms(heights=few), how=DIFFERENTIATED)
for _name, _run in (("forward kinematics", poses), ("geometric Jacobians", jacobians), ("bodies", reading)):
    _register(_name, _run, _terms(matrix=symbols), after="coriolis", how=DIFFERENTIATED)
for _name, _run in (("geometric Jacobians", jacobians), ("bodies", reading)):
    _register(_name, _run, _terms(matrix=few), how=SYMBOLIC)
_register("geometric Jacobians", jacobians, _terms(matrix=few), how=RATED)
for _how in (CARRIED, RATED_APART):
    _register("geometric Jacobians", jacobians, _terms(matrix=few), how=_how)
_register("geometric Jacobians", jacobians, _terms(sums=not_large, moved=not_large), rooted=True)
_register("geometric Jacobians", jacobians, _terms(projected=not_large), how=PROJECTED, rooted=True)
for _how in (PRODUCTS, SYMBOLIC, RATED, RATED_APART):
    _register("geometric Jacobians", jacobians, _terms(matrix=few), how=_how, rooted=True)
_register("bodies", reading, _terms(tensors=not_large))
_register("velocities from link to link", velocities, ("frame_velocity",))
_register("velocities from link to link", velocities, ("frame_velocity",), by_level=True)
_register("composite bodies", subtrees, ("com_jacobian", "gravity"))
for _name in WAYS:
    _run = rotations(_name)
    _register(_name, _run, _terms(posed=off("fk")))
    _register(_name, _run, _terms(turned=off("fk")), after="fk")
    _register(_name, _run, _terms(turned=off("fk")), after="fk", early=True)
    _register(_name, _run, _terms(rate=off("fk"), matrix=symbols), after="fk", how=DIFFERENTIATED)
