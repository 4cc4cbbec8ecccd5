"""Slips of kinematics, of sums over bodies, and of the equations of motion by Jacobians: see the folder `textbook`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any

from ..case import Case
from ..textbook.answers import (
    ABOUT,
    BOTH,
    BY_AXES,
    BY_ORIGINS,
    BY_PARENTS,
    CARRIED,
    CARRIED_TOGETHER,
    DIFFERENTIATED,
    FROM_LINKS,
    GRADIENTS,
    IN_LINKS,
    INSIDE_BY_PARENTS,
    JACOBIANS,
    KINDS,
    LAGRANGE,
    LARGE,
    LINKS,
    MASS,
    MIRRORED,
    MIRRORED_SECOND,
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
    SPUN,
    SPUN_BY_PARENTS,
    SPUN_INSIDE,
    SYMBOLIC,
    TRANSPOSED,
    TURNED_LAST,
    TURNED_SECOND,
)  # fmt: skip
from ..textbook.assembly import SYMBOLS
from ..textbook.columns import ACROSS
from ..textbook.lists import branched
from ..textbook.slipped import Run
from ..textbook.steps import Slip
from ..textbook.ways import WAYS
from . import which
from .formulation import COST, FUSING, Terms, formulation
from .slipping import Slipping, both, jacobians, poses, reading, rotations

__all__ = [
    "DIFFERENTIATED", "JACOBIANS", "LINKS", "MOVING", "PROJECTED", "RATED", "SECOND", "SEEN", "SYMBOLIC", "TRANSPOSED",
    "WAYS", "jacobians", "poses", "rotations",
]  # fmt: skip


FUSED = "of bodies merged from fixed links"


def off(*terms: str) -> Callable[[Case], bool]:
    """Whether one of these is wrong, or was not asked."""
    return lambda case: any(t not in case.observed or not case.score(t).right for t in terms)


def few(case: Case) -> bool:
    return not case.floating and case.robot.nv <= 12


def fuses(case: Case) -> bool:
    """Whether bodies or joints hang on fixed links."""
    return any(not p.moves for p in case.description.parts)


KNOWN = {
    ("the arm to a link's origin", "without the travel of a sliding joint", "step_other"): "slide_radius",
    ("the linear part of a turning column", ACROSS, "step_sign"): "jacobian_linear_sign",
    ("the moment of a body", "w x I w", "step_left_out"): "gyroscopic",
    ("the moment of a body", "w x I w", "step_sign"): "gyroscopic_sign",
    ("the moment of a body", "w x I w", "step_half"): "gyroscopic_half",
    ("the moment of a body", "I Jw' v", "step_left_out"): "no_angular_acceleration",
    ("the angular momentum of a body", "I w", "step_left_out"): "spin",
    ("the angular momentum of a body", "r x m v", "step_left_out"): "orbit",
    ("the angular momentum of a body", "r x m v", "step_sign"): "orbit_sign",
    ("the centre of mass of a body", "", "step_unturned"): "com_frame",
    ("the weight of a body's centre", "1", "step_other"): "com_unweighted",
    **{
        ("gravity, in the weight of a body", f"along {axis}, for z", "step_other"): "gravity" for axis in ("x", "y")
    },
    ("the axis of a column", "", "step_unturned"): "axis_frame",
    ("the axis z in z qd", "", "step_unturned"): "axis_frame",
    ("xyz", "by its own rpy too", "step_other_turn"): "xyz_after_rpy",
    **{
        (site, "by its own rpy too", "step_other_turn"): "xyz_after_rpy"
        for site in ("xyz: of a moving joint", "xyz on a body", "xyz on a body: of a moving joint")
    },
    ("the inertia of a body", "", "step_unturned"): "inertia_frame",
    ("the inertia of a body", "", "step_turned_back"): "inertia_frame_transposed",
    ("the inertia of a body", "", "step_from_left"): "inertia_frame_half",
    **{
        ("Christoffel's symbols", what, how): "coriolis_symbols"
        for what in SYMBOLS for how in ("step_left_out", "step_sign", "step_half", "step_twice")
    },
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


def _register(
    name: str, run: Run, terms: Terms, after: str = "", only: Callable[[Slip], bool] | None = None, **how: Any
) -> None:
    """A formulation, of the links as they are and of bodies merged from fixed links.

    `after` is a term in which its slips show first, if that is answered; they are looked for there.  `only` says which
    of its slips are no twins of those of other formulations.
    """
    levels, rooted, bare, factored = (how.get(name, False) for name in ("by_level", "rooted", "bare", "factored"))
    marks = (
        how.get("how", ""), "with axes kept early" * how.get("early", False), "level by level" * levels,
        "the root link counts" * rooted, "links without mass count" * bare, "M by its Cholesky factor" * factored,
    )  # fmt: skip
    variant = ", ".join(x for x in marks if x)
    cost, like = COST + 0.05 * bool(variant), _in_mass if how.get("how") == MASS or factored else shown_in(run)
    slow = partial(_answers, after)
    robots = ((levels, _branches), (rooted, _heavy_root), (bare, _bare))
    alike, when = name if name in WAYS else "", next((covers for holds, covers in robots if holds), _always)
    twins = [
        (levels, which.in_a_list),
        (rooted, which.for_all_joints),
        (bare, which.of_weights),
        (factored, which.askew),
        (how, which.both_ways),
    ]
    listing = only or next((f for holds, f in twins if holds), which.every)
    formulation(name, terms, KNOWN, variant, when, cost, SAYS, True, like, slow, alike, listing)(_of(run, **how))
    fused = ", ".join(x for x in ("of bodies merged from fixed links", variant) if x)
    formulation(
        name, partial(_merged, terms, how.get("how", "")), KNOWN, fused, partial(_both, when, fuses), cost + FUSING,
        None, True, like, slow, alike, listing,
    )(_of(run, fused=True, **how))  # fmt: skip


def _merged(terms: Terms, how: str, case: Case) -> list[str]:
    """Rates of frames are the same whatever is merged, but for the places of frames on bodies."""
    found = terms(case) if callable(terms) else terms
    return [t for t in found if t not in RATES or how not in (JACOBIANS, *KINDS)]


def _branches(case: Case) -> bool:
    return branched(case.description)


def _both(a: Callable[[Case], bool], b: Callable[[Case], bool], case: Case) -> bool:
    return a(case) and b(case)


def _in_mass(term: str) -> str:
    return "crba"


def _heavy_root(case: Case) -> bool:
    """Whether a link that nothing moves has a mass."""
    d = case.description
    grounded = {link for link, on in d.carriers().items() if on == d.root}
    bodies = [(d.root, d.base), *((p.link, p.body) for p in d.parts)]
    return not case.floating and any(b is not None and b.mass > 0 for link, b in bodies if link in grounded)


def _answers(after: str, case: Case) -> bool:
    return after in case.observed


def _bare(case: Case) -> bool:
    """Whether a link that joints move has no mass."""
    d = case.description
    return any(p.body is None or not p.body.mass > 0 for p in d.parts)


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


def lowered(case: Case) -> bool:
    """Whether slips in the heights of bodies may show in gravity as the gradient of the potential energy."""
    return few(case) and off("potential_energy")(case)


def fixed(case: Case) -> bool:
    return not case.floating and not_large(case)


def untreed(case: Case) -> bool:
    """Whether no algorithm on `Tree`, where slips in reading tensors are the same, covers all joints."""
    return not_large(case) and any(j.mimic is not None or (k and j.model.nv > 1) for k, j in enumerate(case.robot))


RATES = ("jacobian_dot", "frame_acceleration")
TENSORS = ("centroidal_momentum_matrix", "kinetic_energy", "crba", "minv", "bias", "rnea", "aba", "coriolis")


def lagrangian(case: Case) -> bool:
    """Whether forces may be M a + C v + g with a C that was not asked."""
    return few(case) and "coriolis" not in case.observed


def alone(case: Case) -> bool:
    """Whether accelerations show M and C that were not asked."""
    return lagrangian(case) and "crba" not in case.observed


def massive(case: Case) -> bool:
    """Whether accelerations may have a wrong M of their own."""
    return not_large(case) and "crba" not in case.wrong


BY_PARAMETERS = ("joint_torque_regressor",)
GROUPS = {
    "lagrange": ("bias", "rnea", "aba"), "forward": ("aba", "aba_f_ext"), "inverted": ("minv", "aba"),
    "pushed": ("rnea_f_ext", "aba_f_ext"), "regressor": BY_PARAMETERS,
    "moved": MOVED, "of_velocity": ("bias", "rnea", "aba", "coriolis"), "matrix": ("coriolis",),
    "second": (*RATES, "bias", "rnea", "aba", "coriolis"), "posed": ("fk",),
    "turned": (*SEEN[1:], *MOVED, "rnea_f_ext", "aba_f_ext", *BY_PARAMETERS),
    "rate": ("jacobian_dot",), "rates": RATES, "projected": ("bias", "rnea", "aba"), "tensors": TENSORS,
    "heights": ("gravity",),
    "products": (*RATES, "coriolis"), "sums": ("com_jacobian", "centroidal_momentum_matrix", "kinetic_energy"),
}  # fmt: skip
_register(
    "forward kinematics", poses,
    _terms(
        *SEEN, moved=off("fk"), of_velocity=off("frame_velocity", "jacobian_dot"), pushed=off("fk", "jacobian_dot"),
        regressor=off("fk"),
    ),
)  # fmt: skip
_register("forward kinematics", poses, _terms(posed=off("fk")), only=which.kept_early, early=True)
_everywhere = _terms(*SEEN[1:], moved=off("fk"), pushed=off("fk"), regressor=off("fk"))
_register("forward kinematics", poses, _everywhere, after="fk", early=True)
_register("forward kinematics", poses, _terms(rates=off("fk")), how=DIFFERENTIATED)
_register("forward kinematics", poses, _terms(regressor=off("fk")), how=IN_LINKS)
IN_PLACE = "arrays changed in place"
for _rooted in (False, True):  # a root that turns with all others has an energy too
    formulation(
        "forward kinematics", ("kinetic_energy",), variant=IN_PLACE + ", the root link counts" * _rooted,
        when=_heavy_root if _rooted else _always, like=shown_in(poses), batched=True, only=which.in_place,
    )(_of(poses, rooted=_rooted))  # fmt: skip
_register("forward kinematics", poses, _terms(*SEEN, moved=off("fk")), by_level=True)
_register("geometric Jacobians", jacobians, _terms(*SEEN, moved=not_large, pushed=not_large, regressor=not_large))
_register("geometric Jacobians", jacobians, _terms(*SEEN, moved=not_large), by_level=True)
_register("geometric Jacobians", jacobians, _terms(*RATES, "kinetic_energy", of_velocity=not_large), how=JACOBIANS)
_register("geometric Jacobians", jacobians, _terms(rates=off("jacobian")), how=DIFFERENTIATED)
for _name, _run in (("forward kinematics", poses), ("geometric Jacobians", jacobians)):
    _register(_name, _run, RATES, how=POINTS)
_spun_second = _terms(second=off("frame_velocity"))
_spun = _terms(of_velocity=off("frame_velocity", "jacobian_dot"))
for _how in (SPUN, SPUN_INSIDE):
    _register("forward kinematics", poses, _spun, only=which.of_spins, how=_how)
    _register("geometric Jacobians", jacobians, _terms(of_velocity=not_large), only=which.of_axes, how=_how)
    _register(
        "geometric Jacobians", jacobians, _terms(of_velocity=not_large), after="crba", only=which.but_axes, how=_how
    )
for _how, _group in ((BY_PARENTS, "second"), (SPUN_BY_PARENTS, "of_velocity"), (INSIDE_BY_PARENTS, "of_velocity")):
    _register("forward kinematics", poses, _terms(**{_group: off("frame_velocity")}), only=which.of_spins, how=_how)
_register("forward kinematics", poses, _spun_second, only=which.of_velocities, how=BY_ORIGINS)
_register("geometric Jacobians", jacobians, _terms(second=fixed), only=which.of_origins, how=BY_ORIGINS)
for _how in (LINKS, JACOBIANS, BY_PARENTS):
    _register("geometric Jacobians", both, _terms(*SEEN[1:], moved=not_large), only=which.of_cross_products, how=_how)
_register("geometric Jacobians", jacobians, ("centroidal_momentum_matrix",), only=which.of_centres, how=ABOUT)
_register("geometric Jacobians", jacobians, _terms(second=fixed), how=SECOND)
_register("geometric Jacobians", jacobians, _terms(rates=fixed), how=PRODUCTS)
_register("geometric Jacobians", jacobians, _terms(matrix=fixed), only=which.of_products, how=PRODUCTS)
_register("geometric Jacobians", jacobians, _terms(products=fixed), how=GRADIENTS)
_register("geometric Jacobians", jacobians, _terms(projected=not_large), how=PROJECTED)
for _name, _run in (("geometric Jacobians", jacobians), ("bodies", reading)):
    _register(_name, _run, _terms(lagrange=lagrangian), how=LAGRANGE)
    _register(_name, _run, _terms(forward=massive), how=MASS)
    _register(_name, _run, _terms(inverted=not_large), factored=True)
    _register(_name, _run, _terms(forward=alone), how=LAGRANGE, factored=True)
_register("forward kinematics", poses, _terms(heights=placed), how=DIFFERENTIATED)
_register("geometric Jacobians", jacobians, _terms(heights=lowered), how=DIFFERENTIATED)
_register("forward kinematics", poses, _terms(matrix=symbols), after="coriolis", how=DIFFERENTIATED)
for _name, _run in (("geometric Jacobians", jacobians), ("bodies", reading)):
    _register(_name, _run, _terms(matrix=symbols), after="crba", how=DIFFERENTIATED)
for _name, _run in (("geometric Jacobians", jacobians), ("bodies", reading)):
    _register(_name, _run, _terms(matrix=few), how=SYMBOLIC)
    for _how in (TRANSPOSED, BOTH, MIRRORED, MIRRORED_SECOND, TURNED_LAST, TURNED_SECOND):
        _register(_name, _run, _terms(matrix=few), only=which.askew, how=_how)
_register("geometric Jacobians", jacobians, _terms(matrix=few), only=which.but_symbols, how=RATED)
_register("geometric Jacobians", jacobians, _terms(matrix=few), only=which.of_walks, how=CARRIED)
_register("geometric Jacobians", jacobians, _terms(matrix=few), only=which.of_axes, how=BY_AXES)
_register("geometric Jacobians", jacobians, _terms(matrix=few), only=which.but_symbols, how=RATED_APART)
_register("geometric Jacobians", jacobians, _terms(sums=not_large, moved=not_large), rooted=True)
_register("geometric Jacobians", jacobians, _terms(projected=not_large), how=PROJECTED, rooted=True)
_register("geometric Jacobians", jacobians, _terms(sums=not_large, moved=not_large), bare=True)
for _how in (PRODUCTS, SYMBOLIC, RATED, RATED_APART):
    _register("geometric Jacobians", jacobians, _terms(matrix=few), how=_how, rooted=True)
_register("bodies", reading, _terms(tensors=untreed))
_register("velocities from link to link", both, ("frame_velocity",), only=which.every, how=FROM_LINKS)
_register("velocities from link to link", both, ("frame_velocity",), how=FROM_LINKS, by_level=True)
_register("composite bodies", jacobians, ("com_jacobian", "gravity"), only=which.every, how=CARRIED_TOGETHER)
_register("composite bodies", jacobians, ("com_jacobian", "gravity"), how=CARRIED_TOGETHER, by_level=True)
for _name in WAYS:
    _run = rotations(_name)
    _register(_name, _run, _terms(posed=off("fk")))
    _register(_name, _run, _terms(turned=off("fk")), after="fk")
    _register(_name, _run, _terms(turned=off("fk")), after="fk", early=True)
    _register(_name, _run, _terms(rate=off("fk"), matrix=symbols), after="fk", how=DIFFERENTIATED)
    for _early in (False, True):
        _register(_name, _run, _terms(regressor=off("fk")), after="fk", early=_early, how=IN_LINKS)
