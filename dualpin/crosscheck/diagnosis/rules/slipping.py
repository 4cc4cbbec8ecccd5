"""Answers by poses, Jacobians and sums over bodies with slips in some of their parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..case import View
from ..textbook import world_axes
from ..textbook.answers import CARRIED_TOGETHER, FROM_LINKS, JACOBIANS, OF_SYMBOLS, PROJECTED, Made
from ..textbook.articulated import Articulated
from ..textbook.assembly import Dynamics, Seen
from ..textbook.kane import Kane
from ..textbook.posed import Posed, in_world
from ..textbook.regressed import Regressed
from ..textbook.slipped import Run
from ..textbook.steps import Steps
from ..textbook.ways import WAYS

FUSED = (("fused", True),)
EARLY, VELOCITIES = ("early", True), ("how", JACOBIANS)
SUBTREES, TWISTS = ("how", CARRIED_TOGETHER), ("how", FROM_LINKS)
OF_REST = ("by_level", "rooted", "bare", "factored")
"""What says in which order, and of which bodies, sums are made: whatever poses are."""


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
        if dict(self.how).get("how") == PROJECTED and isinstance(other, Dynamics):
            fused = ("fused", True) in self.how
            return Kane(fused) if other.forces is world_axes.forces and other.fused == fused else None
        if self.parts == {"rest"} and isinstance(other, Dynamics) and other.regressor:
            return Regressed(self.how, other) if (FUSED[0] in self.how) == other.fused else None
        if isinstance(other, Dynamics | Seen | Articulated):
            early = EARLY in self.how
            moves = not self.parts & {"rest", "reading"} and {*self.how} - {EARLY} == {*FUSED * other.fused}
            if not moves or len(self.parts) != 1 or (early and not in_world(other)):
                return None
            return Posed(other, "".join(self.parts - {"poses"}), both=True, early=early)
        if not isinstance(other, Slipping):
            return None
        symbols = [s for s in (self, other) if dict(s.how).get("how") in OF_SYMBOLS]
        free = [s for s in (self, other) if "rest" not in s.parts and set(dict(s.how)) <= {"fused", "early"}]
        mine, theirs = dict(self.how), dict(other.how)
        if symbols and free and mine.get("fused") == theirs.get("fused"):  # whatever poses are, C is made of M
            parts, how = self.parts | other.parts, tuple(sorted({**mine, **theirs}.items()))
            return Slipping(parts, how) if len(parts & WAYS.keys()) < 2 else None
        if self._with(other) != other._with(self):
            return None
        parts, how = self.parts | other.parts, tuple(sorted({**mine, **theirs}.items()))
        return Slipping(parts, how) if len(parts & WAYS.keys()) < 2 else None

    def _with(self, other: Slipping) -> set[tuple[str, Any]]:
        """How it is made beside another: whatever poses are, velocities of links are the same by Jacobians."""
        free = [x for x in other.how if x in (VELOCITIES, SUBTREES, TWISTS) or x[0] in OF_REST]
        return {*self.how, EARLY, *(free if "rest" not in self.parts else ())}


poses = Slipping(frozenset({"poses"}))
"""With slips in poses and velocities."""
jacobians = Slipping(frozenset({"rest"}))
"""With slips in Jacobians, sums over bodies, and what is made of them."""
both = Slipping(frozenset({"poses", "rest"}))
"""With slips in both."""
reading = Slipping(frozenset({"reading"}))
"""With slips in reading tensors, which then may not be symmetric."""


def rotations(way: str) -> Slipping:
    """With slips in one of these ways."""
    return Slipping(frozenset({way}))
