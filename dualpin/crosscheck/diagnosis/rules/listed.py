"""Slips of codes that list links level by level, or as a stack gives them: what stands before a link is another one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from ..case import Case
from ..textbook import about_world, link_axes, plucker, spatial, world_axes, world_motions
from ..textbook.articulated import Articulated
from ..textbook.assembly import Dynamics, InOrder, Seen, by_columns, right
from ..textbook.in_place import GROWING, SO_FAR
from ..textbook.lists import LISTED, ORDERS, branched
from ..textbook.steps import Slip
from .dynamics import FUSED, KNOWN, SPATIAL, merges
from .formulation import COST, FUSING, formulation
from .six_vectors import WORLD

CHAIN = "as in a chain"
ENDS = ("step_first", "step_last")
"""Slips that leave out an end of a list."""
FORCES = ("gravity", "bias", "rnea", "crba")


def _algorithms() -> Iterator[tuple[str, Any, tuple[str, ...]]]:
    for name, of in (("Newton-Euler in world axes", world_axes), ("Newton-Euler in link axes", link_axes)):
        yield name, Dynamics(of.forces, by_columns(of.forces)), FORCES
        yield name, Dynamics(of.forces, right(spatial.mass), pushed=of.pushed), ("rnea_f_ext",)
    yield "Newton-Euler in world axes", Seen(world_motions.accelerations), ("frame_acceleration",)
    yield SPATIAL, Seen(spatial.seen, both=True), ("frame_velocity", "frame_acceleration")
    yield SPATIAL, Dynamics(spatial.forces, spatial.mass), FORCES
    yield "composite bodies about the world's origin", Dynamics(right(spatial.forces), about_world.mass), ("crba",)
    yield SPATIAL, Articulated(), ("aba", "minv")
    yield WORLD, Articulated(of=plucker.world), ("aba", "minv")


def _before(order: str, slip: Slip) -> bool:
    """Slips of a list, where they are those of this one."""
    beside = "in the list" in slip.what and slip.what.endswith((LISTED[order], CHAIN))
    return beside or slip.how in ENDS or slip.what in (GROWING, SO_FAR)


def _listed(fused: bool, case: Case) -> bool:
    return branched(case.description) and (not fused or merges(case))


for _order in ORDERS:
    for _name, _run, _terms in _algorithms():
        for _fused in (False, True):
            formulation(
                _name, _terms, KNOWN, ", ".join([FUSED] * _fused + [f"links {_order}"]), partial(_listed, _fused),
                COST + 0.05 + FUSING * _fused, batched=True, only=partial(_before, _order),
            )(InOrder(replace(_run, fused=_fused), _order))  # fmt: skip
