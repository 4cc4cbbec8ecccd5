"""Textbook formulations of dynamics: which terms each of them predicts, and the keys of its slips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from ..case import Case
from ..textbook import (
    about_centres,
    about_world,
    body_jacobians,
    composite,
    factors,
    habits,
    link_axes,
    regressors,
    spatial,
    sums,
    world_axes,
    world_motions,
)
from ..textbook.articulated import Articulated
from ..textbook.assembly import Dynamics, Seen, Symbols, by_columns, right, symbols
from ..textbook.lumps import OF_LINKS
from ..textbook.steiner import MERGING, OUTER
from ..textbook.steps import EVERYWHERE, Slip
from .formulation import COST, FUSING, formulation

SAYS = {
    "gyroscopic": "w x I w is left out",
    "gyroscopic_sign": "w x I w has the other sign",
    "gyroscopic_half": "w x I w is counted half",
    "inertia_frame": "inertia is not turned into world axes (R I R^T is missing)",
    "inertia_frame_half": "inertia is turned into world axes from one side alone (R I in place of R I R^T)",
    "inertia_frame_transposed": "inertia is turned the wrong way into world axes (R^T I R)",
    "centripetal": "w x (w x r) is left out",
    "centripetal_com": "w x (w x r) is left out from a link's origin to its centre of mass",
    "centripetal_link": "w x (w x r) is left out from joint to joint",
    "centripetal_sign": "w x (w x r) has the other sign",
    "centripetal_com_sign": "w x (w x r) has the other sign from a link's origin to its centre of mass",
    "centripetal_link_sign": "w x (w x r) has the other sign from joint to joint",
    "tangential": "alpha x r is left out",
    "tangential_com": "alpha x r is left out from a link's origin to its centre of mass",
    "tangential_link": "alpha x r is left out from joint to joint",
    "tangential_sign": "alpha x r (in Jacobians: axis x arm) has the other sign",
    "tangential_com_sign": "alpha x r has the other sign from a link's origin to its centre of mass",
    "tangential_link_sign": "alpha x r has the other sign from joint to joint",
    "axis_rate": "w x z v, the turning of a joint's axis, is left out of angular accelerations",
    "axis_rate_sign": "w x z v has the other sign in angular accelerations",
    "axis_rate_twice": "w x z v is counted twice in angular accelerations",
    "slide_acceleration": "z a of sliding joints is left out of accelerations",
    "slide_moment": "sliding joints feel the moment along their axis, not the force",
    "slide_coriolis": "2 w x z v of sliding joints is left out",
    "slide_coriolis_half": "w x z v of sliding joints is counted once, not twice",
    "slide_coriolis_sign": "2 w x z v of sliding joints has the other sign",
    "com_frame": "centres of mass are not turned into world axes",
    "slide_radius": "the position of sliding joints is left out of the lever arms",
    "axis_frame": "axes of joints are not turned into world axes",
    "slide_axis_frame": "axes of sliding joints are not turned into world axes",
    "moment_arm": "forces act at links' origins, not at their centres of mass",
    "moment_arm_sign": "the moment of a body's force about its link's origin has the other sign",
    "force_moment": "the moment of forces about the joints is left out",
    "force_moment_link": "the moment r x f of a force that is handed on from joint to joint is left out",
    "force_moment_link_sign": "the moment r x f of a force that is handed on from joint to joint has the other sign",
    "no_translational": "m a is left out",
    "no_angular_acceleration": "I alpha is left out",
    "not_handed_on": "forces and moments are not handed on: each joint feels its own link alone",
    "moment_not_handed_on": "moments are not handed on from joint to joint, forces are",
    "gravity_at_origin": "gravity acts at links' origins, not at their centres of mass",
    "gravity_in_base": "gravity turns with the base",
    "gravity_each_link": "gravity is added at every link, not at the base alone",
}
"""The keys of slips that have one of their own, whatever the formulation."""

TERMS_OF_SUMS = {
    ("the moment about the centre of mass", "w x I w"): "gyroscopic",
    ("the moment about the centre of mass", "I alpha"): "no_angular_acceleration",
    ("the acceleration of the centre of mass", "w x (w x r)"): "centripetal_com",
    ("the acceleration of a link's origin", "w x (w x r)"): "centripetal_link",
    (EVERYWHERE, "w x (w x r)"): "centripetal",
    ("the acceleration of the centre of mass", "alpha x r"): "tangential_com",
    ("the acceleration of a link's origin", "alpha x r"): "tangential_link",
    (EVERYWHERE, "alpha x r"): "tangential",
    ("the angular acceleration of a turning link", "w x z qd"): "axis_rate",
    ("the acceleration of a sliding link", "2 w x z qd"): "slide_coriolis",
    ("the acceleration of a sliding link", "z qdd"): "slide_acceleration",
    ("a body's moment about the link's origin", "r x f"): "moment_arm",
    ("the moment at a joint", "r x f"): "force_moment_link",
    (EVERYWHERE, "r x f"): "force_moment",
    ("the moment at a joint", "the child's n"): "moment_not_handed_on",
    ("the moment at a joint", "R n"): "moment_not_handed_on",
    ("the force at a joint", "the child's X^T f"): "not_handed_on",
    ("the force of a body", "m a"): "no_translational",
}
HOW = {"step_left_out": "", "step_sign": "_sign", "step_half": "_half", "step_twice": "_twice"}
KNOWN = {
    (site, what, how): key + end
    for (site, what), key in TERMS_OF_SUMS.items() for how, end in HOW.items() if key + end in SAYS
} | {
    ("what a sliding joint feels", "the moment along its axis", "step_other"): "slide_moment",
    ("what a link hands on", "nothing", "step_other"): "not_handed_on",
    ("the inertia of a body", "", "step_unturned"): "inertia_frame",
    ("the inertia of a body", "", "step_turned_back"): "inertia_frame_transposed",
    ("the inertia of a body", "", "step_from_left"): "inertia_frame_half",
    ("the centre of mass of a body", "", "step_unturned"): "com_frame",
    ("the joint's axis", "", "step_unturned"): "axis_frame",
    ("the joint's axis: of sliding links", "", "step_unturned"): "slide_axis_frame",
    ("the arm to a sliding link", "without its travel", "step_other"): "slide_radius",
    ("the point at which weight acts", "the link's origin", "step_other"): "gravity_at_origin",
    ("gravity", "added at every link", "step_other"): "gravity_each_link",
    ("gravity", "turned with the base", "step_other"): "gravity_in_base",
}  # fmt: skip
FORCES = ("gravity", "bias", "rnea", "rnea_f_ext")
MASSES = ("crba", "minv", "kinetic_energy", "coriolis")
PUSHED = ("rnea_f_ext", "aba_f_ext")
FORWARD = ("aba", "aba_f_ext", "aba_derivatives")
ALL = (*FORCES, "rnea_derivatives", *MASSES, *FORWARD)
FUSED = "of bodies merged from fixed links"
WORLD, SPATIAL, SUMS = "Newton-Euler in world axes", "spatial vectors", "sums of parts"
FACTORS = "the factors of M"
REGRESSOR = "joint_torque_regressor"
COLUMNS, SYMBOLS = "M by columns", "C from Christoffel's symbols"


def merges(case: Case) -> bool:
    return any(not p.moves for p in case.description.parts)


def later(case: Case) -> bool:
    """Whether slips of a recursion with wrenches in it are looked for without wrenches first."""
    return "rnea" in case.observed


def of_mass(case: Case) -> bool:
    """Whether slips of M are looked for in M first."""
    return "crba" in case.observed


def _shown(run: object, terms: Sequence[str], case: Case) -> Sequence[str]:
    """The terms that slips can change: C from Christoffel's symbols of M is wrong only where M is."""
    by_mass = isinstance(run, Dynamics) and isinstance(run.matrix, Symbols)
    right = of_mass(case) and case.score("crba").right
    return [t for t in terms if t != "coriolis"] if by_mass and right else terms


def _itself(term: str) -> str:
    return term


def but_tensors(slip: Slip) -> bool:
    """Whether it is none of reading and merging tensors."""
    return slip.site not in OF_LINKS and slip.site != OUTER + MERGING


def register(
    name: str, run: Dynamics | Articulated | composite.Energy | Seen, terms: tuple[str, ...], variant: str = "",
    like: Callable[[str], str] = _itself, after: Callable[[Case], bool] = lambda case: False,
    only: Callable[[Slip], bool] = lambda slip: True, as_they_are: Callable[[Case], bool] = lambda case: True,
    when: Callable[[Case], bool] = lambda case: True, tensors: bool = False,
) -> None:  # fmt: skip
    """A formulation, of the links `as_they_are` and of bodies merged from fixed links.

    Slips in reading `tensors` are the same in all formulations; they are those of the plain ones.
    """
    cost, tensors = COST + 0.05 * bool(variant), tensors or not variant
    made = partial(
        formulation, name, partial(_shown, run, terms), KNOWN, says=SAYS, batched=True, like=like, afterwards=after,
        only=lambda slip: only(slip) and (tensors or but_tensors(slip)),
    )  # fmt: skip
    made(variant, lambda case: when(case) and as_they_are(case), cost)(run)
    values = ", ".join(x for x in (FUSED, variant) if x)
    made(values, lambda case: when(case) and merges(case), cost + FUSING)(replace(run, fused=True))


register("Newton-Euler in world axes", Seen(world_motions.accelerations), ("frame_acceleration",))
register("Newton-Euler in link axes", Seen(link_axes.accelerations), ("frame_acceleration",))
for _name, _forces in {
    WORLD: world_axes.forces, "Newton-Euler in link axes": link_axes.forces,
    SPATIAL: spatial.forces,
}.items():  # fmt: skip
    _regressor = regressors.Regressor(motions=True) if _forces is world_axes.forces else None
    _by_columns = Dynamics(_forces, by_columns(_forces), regressor=_regressor)
    _terms = {SPATIAL: (*MASSES, *FORWARD), WORLD: (*ALL, REGRESSOR)}
    register(_name, _by_columns, _terms.get(_name, ALL), "" if _name != SPATIAL else COLUMNS)
    register(_name, Dynamics(_forces, right(spatial.mass)), FORWARD, "M is right", tensors=_forces is world_axes.forces)
    _pushed = {
        world_axes.forces: world_axes.pushed, link_axes.forces: link_axes.pushed, spatial.forces: spatial.pushed,
    }[_forces]  # fmt: skip
    _inside = Dynamics(_forces, right(spatial.mass), pushed=_pushed)
    register(_name, _inside, PUSHED, "the wrench in the recursion", lambda term: "rnea", later)
    register(
        _name, replace(_by_columns, matrix=symbols(by_columns(_forces))), ("coriolis",), f"{COLUMNS}, {SYMBOLS}",
        after=of_mass,
    )  # fmt: skip
for _variant, _made in {"": regressors.wrenches, "in the links' axes": regressors.in_links}.items():
    register(
        "regressors",
        Dynamics(
            right(world_axes.forces), right(spatial.mass), regressor=regressors.Regressor(units=True, made=_made)
        ), (REGRESSOR,), _variant,
    )  # fmt: skip
register(
    "Newton-Euler with external wrenches",
    Dynamics(right(world_axes.forces), right(spatial.mass), pushed=world_axes.pushed), PUSHED,
)  # fmt: skip
register(
    "Newton-Euler in world axes",
    Dynamics(world_axes.forces, habits.mass, symbols(habits.mass)), (*MASSES, "aba"),
    "M from Jacobians", only=lambda slip: (slip.site, slip.what) in habits.IN_JACOBIANS,
)  # fmt: skip
_masses = Dynamics(right(spatial.forces), spatial.mass, symbols(spatial.mass))
register(SPATIAL, _masses, (*FORWARD, "coriolis"), f"M alone, {SYMBOLS}")
register(
    "composite bodies by mass, moment and inertia",
    Dynamics(right(spatial.forces), composite.mass, symbols(composite.mass)), (*MASSES, *FORWARD), only=but_tensors,
)  # fmt: skip
register(
    "composite bodies about their centres",
    Dynamics(right(spatial.forces), about_centres.mass, symbols(about_centres.mass)), (*MASSES, *FORWARD),
)  # fmt: skip
register(
    "composite bodies about the world's origin",
    Dynamics(right(spatial.forces), about_world.mass, symbols(about_world.mass)), MASSES, only=but_tensors,
    when=lambda case: not case.floating,
)  # fmt: skip
register("kinetic energy of bodies", composite.Energy(), ("kinetic_energy",), only=but_tensors)
formulation(SUMS, sums.TERMS, KNOWN, batched=True)(sums.run)
for _from_base in (False, True):
    _order = "from the base" if _from_base else ""
    formulation(FACTORS, factors.TERMS, KNOWN, _order, batched=True)(factors.Factors(_from_base))


def _small(fused: bool, case: Case) -> bool:
    return case.robot.nv <= MOST_JOINTS and (not fused or merges(case))


MOST_JOINTS = 20
"""Degrees of freedom up to which Jacobians of all links are made of all their columns."""
for _fused in (False, True):
    for _by_world in (False, True):
        _values = ", ".join([FUSED] * _fused + ["of the world's columns"] * _by_world)
        formulation(
            "body Jacobians", body_jacobians.TERMS, KNOWN, _values, partial(_small, _fused),
            COST + FUSING * _fused + 0.05 * _by_world, batched=True, only=but_tensors,
        )(partial(body_jacobians.run, fused=_fused, by_world=_by_world))  # fmt: skip
