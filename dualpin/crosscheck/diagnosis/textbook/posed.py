"""Slips in poses, or in rotations alone, and what right recursions and transforms make of such poses.

A code that walks from link to link takes R and p of each link on its parent, and turns by R^T: where R is no rotation
any more, or where poses in the world and those from link to link disagree, its answers are its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..case import View
from .assembly import Dynamics, Seen
from .attitudes import PLAIN as RIGHT
from .poses import Poses
from .steps import Steps
from .transforms import Transforms
from .tree import Pose, tree_of
from .ways import PLAIN, WAYS


@dataclass(frozen=True)
class Posed:
    """An algorithm on a tree with slips in its poses.

    Attributes
    ----------
    of : Dynamics, Seen or Transforms
        The algorithm, which makes none itself.
    way : str
        The one of `WAYS` in which slips are made, or `PLAIN`; by default they are made in putting poses together.
    """

    of: Dynamics | Seen | Transforms
    way: str = ""

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        """The term (runs, samples, ...)."""
        tree = tree_of(view, self.of.fused)
        ways, own = ({**PLAIN, **WAYS}[self.way](steps), Steps()) if self.way else (RIGHT, steps)

        def made(q: np.ndarray) -> list[Pose]:
            poses = Poses(view.robot, view.description, q[0], None, own, ways, self.of.fused)
            out = []
            for n in (poses.number[k.name] for k in tree.links):
                A, p = poses.on_parent(n) if n else (poses.attitudes[0], poses.p[0])
                out.append(Pose(ways.matrix(A), p, poses.R[n], poses.p[n]))
            return out

        return self.of.answer(view, term, Steps(), tree.posed(made))
