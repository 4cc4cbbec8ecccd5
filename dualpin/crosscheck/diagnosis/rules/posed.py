"""Slips in rotations and poses, as six-vectors and recursions in link axes show them."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from ..case import Case
from ..textbook import body_coriolis, link_axes, plucker, spatial, transforms
from ..textbook.articulated import Articulated
from ..textbook.assembly import Dynamics, Seen, by_columns
from ..textbook.posed import Posed
from ..textbook.ways import PLAIN, WAYS
from .dynamics import FUSED, MASSES, merges
from .formulation import COST, FUSING, formulation
from .kinematics import KNOWN, rotations, shown_in

FORCES = ("gravity", "bias", "rnea", "aba")
FRAMES = ("frame_velocity", "frame_acceleration")
OF_POSES = (*transforms.OF_FRAMES, *transforms.OF_BODIES)
Algorithms = dict[str, tuple[Any, tuple[str, ...]]]
FK = ("fk",)
FIRST: Algorithms = {"transforms": (transforms.Transforms(), FK)}
"""Where slips in rotations show first, if poses are products of transforms."""
LINKS: Algorithms = {
    "transforms": (transforms.Transforms(), OF_POSES),
    "six-vectors": (
        Dynamics(spatial.forces, spatial.mass, body_coriolis.matrix), (*FORCES, *MASSES, "potential_energy")
    ),
    "link axes": (Dynamics(link_axes.forces, by_columns(link_axes.forces)), (*FORCES, *MASSES)),
}  # fmt: skip
"""Algorithms from link to link, and what they make of slips in rotations."""
WORLD: Algorithms = {
    "transforms, poses by chains": (transforms.Transforms(chained=True), OF_POSES),
    "motions in link axes": (Seen(spatial.seen, both=True), FRAMES),
    "motions brought to frames": (Seen(partial(spatial.seen, by_transforms=True), both=True), FRAMES),
}
"""Algorithms that take both poses in the world and those from link to link."""
MOVED = ("aba", "aba_f_ext")
TWISTS: Algorithms = {
    "articulated bodies": (Articulated(of=plucker.world), MOVED),
    "articulated bodies, the wrench in their bias forces": (Articulated(of=plucker.world, inside=True), MOVED[1:]),
}
"""Algorithms that take the twists of links, in which slips show whatever poses are."""


def _known(terms: tuple[str, ...], case: Case) -> tuple[str, ...]:
    moved = "aba_f_ext" in terms and "frame_velocity" in case.wrong
    return terms if "fk" in case.wrong or terms == FK or moved else ()


def _asked(terms: tuple[str, ...], case: Case) -> bool:
    """Whether slips in poses are looked for in poses first."""
    return "fk" in case.observed and "fk" not in terms


def _register(name: str, of: Any, terms: tuple[str, ...], variant: str, way: str, alike: str = "") -> None:
    like = shown_in(rotations(way)) if alike else (lambda term: terms[0])
    for fused in (False, True)[: 1 + (terms != FK)]:  # poses are the same, whatever is merged
        values, when = (f"{variant}, {FUSED}", merges) if fused else (variant, lambda case: True)
        cost, later = COST + 0.05 + FUSING * fused, partial(_asked, terms)
        add = formulation(name, partial(_known, terms), KNOWN, values, when, cost, None, True, like, later, alike)
        add(Posed(replace(of, fused=fused), way))


BY_PRODUCTS = frozenset(way for way in WAYS if "vectors by products" in way)
for _variant, (_of, _terms) in {**WORLD, **TWISTS}.items():
    _register("forward kinematics", _of, _terms, _variant, "")
for _way in (*PLAIN, *WAYS):
    for _algorithms in (FIRST, LINKS, WORLD)[_way in BY_PRODUCTS :]:  # no transform turns vectors by quaternions
        for _variant, (_of, _terms) in _algorithms.items():
            _register(_way, _of, _terms, _variant, _way, _way if _way in WAYS else "")
