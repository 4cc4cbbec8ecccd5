"""Products of exponentials: poses, Jacobians of both forms, recursions in body twists.  See the folder `textbook`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ..case import Case
from ..textbook import body_form, body_twists, composite, exponentials, products, spatial
from ..textbook.assembly import Dynamics, by_columns, right, symbols
from ..textbook.body_twists import Frames
from ..textbook.steps import Slip
from .dynamics import FUSED, PUSHED, SYMBOLS, later, merges, of_mass, register
from .formulation import COST, FUSING, formulation
from .kinematics import KNOWN, fixed
from .six_vectors import elsewhere, outside

NAME = "products of exponentials"
TERMS = ("gravity", "bias", "rnea", "rnea_f_ext", "crba")
OF_SCREWS = (
    "the rotation of a joint", "K in", "K^2 in", "the factor of", "the 1 of", "the angle of", "the sine and cosine of",
    "G of an exponential", "[w]^2 in G", "q 1 in G", "v of a screw", "the position of a", "the axis of a screw",
    "the screw of a turning joint", "the screw of a sliding joint", "the pose of a link at home", products.SKEW,
)  # fmt: skip
"""Sites of screws at home and their exponentials."""


def _of_screws(slip: Slip) -> bool:
    return slip.site.startswith(OF_SCREWS)


def _not_of_screws(slip: Slip) -> bool:
    return not _of_screws(slip)


def _of_recursion(slip: Slip) -> bool:
    return elsewhere(slip) and not _of_screws(slip)


def _posed(case: Case) -> bool:
    """Whether slips in screws and their exponentials are looked for in poses, where they show first."""
    return "fk" in case.observed


def _unmerged(case: Case) -> bool:
    """Bodies are merged from fixed links where there are any."""
    return not merges(case)


def _jacobians(
    run: Callable[..., np.ndarray | None], terms: tuple[str, ...], values: str, frames: Frames | None,
    as_they_are: Callable[[Case], bool] = _unmerged,
) -> None:  # fmt: skip
    """Poses, and what is made of Jacobians."""
    for fused, holds in ((False, as_they_are), (True, merges)):
        variant = ", ".join(x for x in (FUSED * fused, values) if x)
        when = partial(_on_fixed_base, holds)
        made = partial(formulation, NAME, terms, KNOWN, variant, when, COST + FUSING * fused, batched=True)
        of = partial(run, fused=fused, **({"frames": frames} if frames else {}))
        if not frames:
            made()(of)
            continue
        made(only=_not_of_screws)(of)
        made(only=_of_screws, afterwards=_posed)(of)


def _on_fixed_base(holds: Callable[[Case], bool], case: Case) -> bool:
    return fixed(case) and holds(case)


def _in(frames: Frames) -> None:
    of, variant = partial(body_twists.bodies, frames=frames), f"body twists in {frames.value}"
    forces, pushed, energy = (partial(f, of=of) for f in (spatial.forces, spatial.pushed, spatial.energy))
    mass = by_columns(forces)
    by = partial(register, NAME, as_they_are=_unmerged, when=fixed)
    inside = Dynamics(forces, right(spatial.mass), pushed=pushed)

    def every(only: Callable[[Slip], bool], after: Callable[[Case], bool]) -> None:
        by(Dynamics(forces, mass), TERMS, variant, after=after, only=only)
        by(Dynamics(forces, mass, symbols(mass)), ("coriolis",), f"{variant}, {SYMBOLS}", after=of_mass, only=only)
        by(composite.Energy(by=energy), ("kinetic_energy",), f"{variant}, energies of bodies", after=after, only=only)
        values = f"{variant}, the wrench in the recursion"
        by(inside, PUSHED, values, lambda term: "rnea", lambda case: later(case) or after(case), only)

    every(_of_recursion, lambda case: False)
    every(_of_screws, _posed)
    outside(NAME, pushed, variant, as_they_are=_unmerged, when=fixed)


_jacobians(exponentials.run, exponentials.TERMS, "", None, lambda case: True)
_jacobians(body_form.run, body_form.TERMS, "in the body's form", Frames.AT_CENTRES)
for _frames in (Frames.AT_CENTRES, Frames.IN_BASE):
    _jacobians(exponentials.run, exponentials.IN_BODIES, f"by Jacobians in {_frames.value}", _frames)
for _frames in Frames:
    _in(_frames)
