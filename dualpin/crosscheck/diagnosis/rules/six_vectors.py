"""Six-vectors as codes use them: the coordinates in which they write them, and the terms that they make of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

import numpy as np

from ..case import Case
from ..textbook import body_coriolis, composite, link_axes, plucker, products, spatial, spatial_sums, transforms
from ..textbook.articulated import Articulated
from ..textbook.assembly import Dynamics, Seen, by_columns, right
from ..textbook.link_axes import FIRST
from ..textbook.steps import STANDING, Slip
from .dynamics import ALL, FORWARD, FUSED, KNOWN, PUSHED, SPATIAL, but_tensors, later, merges, register
from .formulation import formulation

MERGED = "merged in six-vectors"
MOVING = ("frame_velocity", "frame_acceleration")
MOMENTUM = ("centroidal_momentum_matrix", "com_jacobian")
SUMMED = ("step_left_out", "step_sign", "step_half", "step_twice", "step_overwritten", "step_first", "step_last")
OTHERWISE = ("gravity", "bias", "rnea", "rnea_f_ext", "crba", "coriolis")
"""In other coordinates; kinetic energies are those of bodies there, accelerations follow from these."""
PARTS = ("the linear part of", "the angular part of", "the place of")
"""Sites of sums that other coordinates split in another way."""
ALIKE = (
    "the tensor of <inertial>", "a fixed link's tensor", "d d^T in Steiner's term", "the centre of mass of a body, in",
    "the inertia about a link's origin", "the block m [c x]", "a joint's velocity", "a joint's acceleration",
    "the velocity of a joint", "the acceleration of a joint", FIRST, "the axis along which",
)  # fmt: skip
"""Sites whose slips are the same in all coordinates, or show in those of links alone."""
MERGING = (
    products.SKEW, "the block", "a fixed link's spatial inertia", "the inertia about a link's origin",
    "E of X", "the centre of mass of a body",
)  # fmt: skip
"""Sites where it matters that bodies are merged in six-vectors."""
BLOCKS = (
    "the block", "the inertia about the world's origin", "m (c.c 1 - c c^T)", "the inertia of a body",
    "the place of a body's centre", "the centre of mass of a body", STANDING,
)  # fmt: skip
"""Sites of an inertia that is put together in the world."""


def elsewhere(slip: Slip) -> bool:
    """Whether a slip is another one in other coordinates: sums of the same six-vectors are the same there."""
    same = slip.how in SUMMED or slip.site.startswith(spatial.OF_FIXED)
    return not slip.site.startswith(ALIKE) and (not same or slip.site.startswith(PARTS))


def _of_blocks(slip: Slip) -> bool:
    return slip.site.startswith(BLOCKS)


def _of_wrenches(slip: Slip) -> bool:
    return slip.site.startswith(("the wrench on a link", "what acts on a link"))


def _of_screws(slip: Slip) -> bool:
    return slip.site.startswith(("S of a", "the joint's axis"))


def _of_merging(slip: Slip) -> bool:
    return slip.site.startswith(MERGING)


register(SPATIAL, Seen(spatial.seen, both=True), MOVING)
formulation(SPATIAL, MOVING, KNOWN, f"{FUSED}, frames by transforms", merges, batched=True)(
    Seen(partial(spatial.seen, by_transforms=True), True, True)
)
_spatial = Dynamics(
    spatial.forces, spatial.mass, body_coriolis.matrix, False, spatial_sums.momentum, spatial_sums.potential
)
register(SPATIAL, _spatial, (*ALL, *MOMENTUM, "potential_energy"))
register(SPATIAL, composite.Energy(by=spatial_sums.energy), ("kinetic_energy",), "energies of bodies")
register(SPATIAL, Articulated(), (*FORWARD, "minv"), "articulated bodies", tensors=True)
INSIDE = "articulated bodies, the wrench in their bias forces"


def accelerated(case: Case) -> bool:
    """Whether slips of forward dynamics with wrenches are looked for without wrenches first."""
    return "aba" in case.observed


register(SPATIAL, Articulated(inside=True), ("aba_f_ext",), INSIDE, lambda term: "aba", accelerated)


def _poses(fused: bool, chained: bool, of: plucker.Coordinates = plucker.links) -> None:
    """Poses, Jacobians and momentum, by transforms or by chains of R and p."""
    merged = of is plucker.merged_links
    what = ("poses by chains" if chained else "poses by transforms", FUSED * fused, MERGED * merged)
    terms = ("fk",) * (not chained and not merged) + transforms.OF_FRAMES * (not merged) + transforms.OF_BODIES
    terms += transforms.OF_RATES * (not chained and not merged)
    formulation(
        SPATIAL, terms, KNOWN, ", ".join(x for x in what if x), merges if fused else lambda case: True, batched=True,
        only=_of_merging if merged else but_tensors,
    )(transforms.Transforms(fused, chained, of))  # fmt: skip


for _chained in (False, True):
    _poses(False, _chained)
    _poses(True, _chained)
    _poses(True, _chained, plucker.merged_links)


@cache
def _pushed(of: plucker.Coordinates) -> Callable[..., np.ndarray]:
    return partial(spatial.pushed, of=of)


def _always(case: Case) -> bool:
    return True


def _never(case: Case) -> bool:
    return False


def outside(
    name: str, pushed: Callable[..., np.ndarray], variant: str, as_they_are: Callable[[Case], bool] = _always,
    when: Callable[[Case], bool] = _always,
) -> None:  # fmt: skip
    """How wrenches enter a recursion."""
    run = Dynamics(right(spatial.forces), right(spatial.mass), pushed=pushed)
    register(name, run, PUSHED, f"{variant}, the wrench alone", only=_of_wrenches, as_they_are=as_they_are, when=when)


def _in(
    of: plucker.Coordinates, name: str, variant: str, only: Callable[[Slip], bool],
    as_they_are: Callable[[Case], bool] = _always,
) -> None:  # fmt: skip
    """What codes in other coordinates answer; about centres of mass M is made by columns, and accelerations of M."""
    forces, mass, matrix, energy = (
        partial(f, of=of) for f in (spatial.forces, spatial.mass, body_coriolis.matrix, spatial_sums.energy)
    )
    pushed = _pushed(of)
    by_body = of is plucker.centres
    by = partial(register, name, only=only, as_they_are=as_they_are)
    by(Dynamics(forces, by_columns(forces) if by_body else mass, matrix), OTHERWISE, variant)
    inside = Dynamics(forces, right(spatial.mass), pushed=pushed)
    by(inside, PUSHED, f"{variant}, the wrench in the recursion", lambda term: "rnea", later)
    by(composite.Energy(by=energy), ("kinetic_energy",), f"{variant}, energies of bodies")
    if not by_body:
        by(Articulated(of=of), (*FORWARD, "minv"), f"{variant}, articulated bodies")
        by(Articulated(of=of, inside=True), ("aba_f_ext",), f"{variant}, {INSIDE}", lambda term: "aba", accelerated)


def _told(run: Articulated, terms: tuple[str, ...]) -> None:
    """Screws of articulated bodies alone are wrong."""
    how = "in the world, articulated bodies, velocities from link to link"
    formulation(
        WORLD, terms, KNOWN, how + ", the wrench in their bias forces" * run.inside, batched=True, only=_of_screws
    )(run)


outside(SPATIAL, spatial.pushed, "links")
outside("Newton-Euler in link axes", link_axes.pushed, "links")
CENTRES, WORLD = "body twists about centres of mass", f"{SPATIAL} in world coordinates"
_in(plucker.merged_links, SPATIAL, MERGED, _of_merging, _never)
_in(plucker.centres, CENTRES, "about centres", elsewhere)
_in(plucker.world, WORLD, "in the world", elsewhere)
_told(Articulated(of=plucker.world, told=True), ("aba",))
_told(Articulated(of=plucker.world, inside=True, told=True), ("aba_f_ext",))
_in(plucker.world_blocks, WORLD, "inertias put together there", _of_blocks)
outside(SPATIAL, _pushed(plucker.merged_links), MERGED, _never)
outside(CENTRES, _pushed(plucker.centres), "about centres")
outside(WORLD, _pushed(plucker.world), "in the world")
