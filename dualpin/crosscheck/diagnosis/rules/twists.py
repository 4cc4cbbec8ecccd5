"""Products of exponentials: poses, Jacobians of both forms, recursions in body twists.  See the folder `textbook`.

Most slips of a recursion are the same in body twists as in six-vectors of links or about centres of mass, and those in
screws and their exponentials show in poses first: these are tried where the same mistake explains another term.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..case import Case
from ..textbook import body_form, body_twists, composite, exponentials, products, spatial, spatial_sums
from ..textbook.assembly import Dynamics, by_columns, right, symbols
from ..textbook.body_twists import Frames
from ..textbook.steps import Slip
from .dynamics import FUSED, PUSHED, SYMBOLS, later, merges, of_mass, register
from .formulation import COST, FUSING, formulation
from .kinematics import KNOWN, fixed
from .six_vectors import ALIKE, elsewhere, outside

NAME = "products of exponentials"
FORCES = ("gravity", "bias", "rnea", "rnea_f_ext", "crba")
OF_SCREWS = (
    "the rotation of a joint", "K in", "K^2 in", "the factor", "the 1 of", "the angle of", "the sine and cosine of",
    "G of an exponential", "[w]^2 in G", "q 1 in G", "v of a screw", "the position of a", "the axis of a screw",
    "the screw of a turning joint", "the screw of a sliding joint", "the exponential of a",
    "the pose of a link at home", products.SKEW,
)  # fmt: skip
"""Sites of screws at home and their exponentials."""
OF_ADJOINTS = ("Ad(T)", "the block [p x] R of Ad", "R^T of the inverse", "-R^T p of the inverse")
OF_TRANSFORMS = (
    *OF_ADJOINTS, "the screw of a joint, in", "the pose of the parent's frame", "-q in exp(-A q)",
    "the motion that a link starts from", "the axis of a joint, in", "the pose of a body in the frame of",
)  # fmt: skip
"""Sites at which body twists are made of screws."""
IN_AXES = (
    "the parent's velocity", "the parent's acceleration", "the force that is handed on", "the velocity in v x",
    "a link's tensor", "the inertia about the centre of mass", "d.d 1 in Steiner's term, in",
    "d d^T in Steiner's term, in",
)  # fmt: skip
"""Sites at which it matters in which axes a body's frame stands."""
OF_BODIES = (
    "the space Jacobian, brought", "the momentum of a body", "the pose of the centre of mass", "the velocity of a body",
    "gravity, in the axes",
)  # fmt: skip
"""Sites at which Jacobians are brought to bodies."""
OF_BRACKETS = (
    "the joints by which a column has a derivative", "the derivative of a body's mass matrix",
    "the cross product of motions, v x: in J_j x J_l",
)  # fmt: skip
"""Sites of C by brackets of Jacobians."""
OF_LISTS = ("the product of the exponentials before", "the pose of a link at home")
"""Sites at which it matters in poses whether fixed links are merged."""
LIKE = {
    "frame_velocity": "jacobian", "frame_acceleration": "jacobian_dot", "potential_energy": "com",
    "kinetic_energy": "crba",
}  # fmt: skip
"""Terms that are made of others, by the same steps."""
Which = Callable[[Slip], bool]


def _at(sites: tuple[str, ...]) -> Which:
    return lambda slip: slip.site.startswith(sites)


_of_screws = _at(OF_SCREWS)


def _read(slip: Slip) -> bool:
    """Not in reading tensors."""
    return not slip.site.startswith(ALIKE)


def _never(case: Case) -> bool:
    return False


def _like(term: str) -> str:
    return LIKE.get(term, term)


def _always(case: Case) -> bool:
    return True


def _posed(case: Case) -> bool:
    """Whether slips in screws and their exponentials are looked for in poses, where they show first."""
    return "fk" in case.observed


def _unmerged(case: Case) -> bool:
    """Bodies are merged from fixed links where there are any."""
    return not merges(case)


def _register(add: Callable[[Which, Callable[[Case], bool]], None], held: Which, searched: Which) -> None:
    """Those `held`, in parts: they are searched, or tried where the same mistake explains another term."""
    add(lambda slip: held(slip) and searched(slip) and not _of_screws(slip), _never)
    add(lambda slip: held(slip) and _of_screws(slip), _posed)
    add(lambda slip: held(slip) and not searched(slip) and not _of_screws(slip), _always)


def _jacobians(
    run: Callable[..., np.ndarray | None], terms: tuple[str, ...], frames: Frames, searched: Which, form: str
) -> None:  # fmt: skip
    """What is made of Jacobians in bodies' frames."""
    for fused, holds in ((False, _unmerged), (True, merges)):
        variant = ", ".join(x for x in (FUSED * fused, form, f"Jacobians of {frames.value}") if x)
        of, when = partial(run, fused=fused, frames=frames), partial(_on_fixed_base, holds)
        matrix = ("coriolis",)
        for some, sites in ((tuple(t for t in terms if t not in matrix), searched), (matrix, _at(OF_BRACKETS))):
            made = partial(formulation, NAME, some, KNOWN, variant, when, COST + FUSING * fused, batched=True)

            def add(only: Which, after: Callable[[Case], bool], made: Any = made, of: Any = of) -> None:
                made(only=only, afterwards=after, like=_like)(of)

            _register(add, _read, sites)


def _poses() -> None:
    """Poses, Jacobians about the world's origin, and sums over bodies."""
    for fused, terms, only in (
        (False, exponentials.TERMS, lambda slip: True),
        (True, exponentials.OF_MASS, lambda slip: True),
        (True, exponentials.OF_MOTION, _at(OF_LISTS)),
    ):
        when = partial(_on_fixed_base, merges if fused else _always)
        made = formulation(
            NAME, terms, KNOWN, FUSED * fused, when, COST + FUSING * fused, batched=True, only=only, like=_like
        )  # fmt: skip
        made(partial(exponentials.run, fused=fused))


def _on_fixed_base(holds: Callable[[Case], bool], case: Case) -> bool:
    return fixed(case) and holds(case)


def _recursion(frames: Frames) -> None:
    of, variant = partial(body_twists.bodies, frames=frames), f"body twists in {frames.value}"
    forces, pushed, energy = (partial(f, of=of) for f in (spatial.forces, spatial.pushed, spatial_sums.energy))
    mass = by_columns(forces)
    by = partial(register, NAME, as_they_are=_unmerged, when=fixed)
    inside = Dynamics(forces, right(spatial.mass), pushed=pushed)

    def every(only: Which, after: Callable[[Case], bool]) -> None:
        by(Dynamics(forces, mass), FORCES, variant, after=after, only=only)
        by(Dynamics(forces, mass, symbols(mass)), ("coriolis",), f"{variant}, {SYMBOLS}", after=of_mass, only=only)
        by(composite.Energy(by=energy), ("kinetic_energy",), f"{variant}, energies of bodies", after=after, only=only)
        values = f"{variant}, the wrench in the recursion"
        by(inside, PUSHED, values, lambda term: "rnea", lambda case: later(case) or after(case), only)

    sites = OF_TRANSFORMS + IN_AXES if frames is Frames.IN_BASE else OF_TRANSFORMS
    _register(every, elsewhere, _at(sites))
    outside(NAME, pushed, variant, as_they_are=_unmerged, when=fixed)


_poses()
_jacobians(body_form.run, body_form.TERMS, Frames.AT_CENTRES, lambda slip: True, "in the body's form")
_jacobians(exponentials.run, exponentials.IN_BODIES, Frames.AT_CENTRES, lambda slip: True, "")
_jacobians(exponentials.run, exponentials.IN_BODIES, Frames.IN_BASE, _at(OF_ADJOINTS + OF_BODIES + IN_AXES), "")
for _frames in Frames:
    _recursion(_frames)
