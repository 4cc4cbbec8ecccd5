"""Slips in poses, or in rotations alone, and what right recursions and transforms make of such poses.

A code that walks from link to link takes R and p of each link on its parent, and turns by R^T: where R is no rotation
any more, or where poses in the world and those from link to link disagree, its answers are its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...subjects.layout import product
from ..case import View
from . import about_centres, about_world, plucker, world_axes
from .arrays import inverse
from .articulated import Articulated
from .assembly import Dynamics, Seen
from .attitudes import PLAIN as RIGHT
from .columns import Columns
from .poses import Poses
from .steps import Steps
from .transforms import Transforms
from .tree import Pose, Tree, Twist, tree_of
from .velocities import carried
from .ways import PLAIN, WAYS
from .weighted import RIGHT as WITHOUT
from .weighted import Sums


@dataclass(frozen=True)
class Posed:
    """An algorithm on a tree with slips in its poses.

    Attributes
    ----------
    of : Dynamics, Seen, Articulated or Transforms
        The algorithm, which makes none itself.
    way : str
        The one of `WAYS` in which slips are made, or `PLAIN`; by default they are made in putting poses together.
    both : bool
        Whether the algorithm makes slips besides.
    early : bool
        Whether axes are turned into the world before their own joint turns.
    """

    of: Dynamics | Seen | Articulated | Transforms
    way: str = ""
    both: bool = False
    early: bool = False

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        """The term (runs, samples, ...)."""
        return self.of.answer(view, term, steps if self.both else Steps(), self.tree(view, steps))

    def beside(self, other: object) -> Posed | None:
        """With slips of the algorithm itself."""
        return replace(self, both=True) if other == self.of else None

    def tree(self, view: View, steps: Steps) -> Tree:
        """The tree with slips in its poses."""
        tree = tree_of(view, self.of.fused)
        ways, own = ({**PLAIN, **WAYS}[self.way](steps), Steps()) if self.way else (RIGHT, steps)

        def world(q: np.ndarray) -> Poses:
            return Poses(view.jointed, view.description, q, None, own, ways, self.of.fused, self.early)

        def made(q: np.ndarray) -> list[Pose]:
            poses = world(q[0])
            out = []
            for n in (poses.number[k.name] for k in tree.links):
                A, p = poses.on_parent(n) if n else (poses.attitudes[0], poses.p[0])
                out.append(Pose(ways.matrix(A), p, poses.R[n], poses.p[n]))
            return out

        def moved(q: np.ndarray, v: np.ndarray) -> list[Twist]:
            poses = carried(Poses(view.jointed, view.description, q[0], v[0], own, ways, self.of.fused, self.early))
            at = [poses.number[k.name] for k in tree.links]
            return [(poses.w[n], poses.v[n]) for n in at]

        apart = steps.finding or "frame_velocity" in view.case.wrong  # slips are found for all subjects at once
        twists = moved if apart and not self.way else None
        if self.both:
            tree = tree.posed(partial(_from_world, tree, world, self.early), twists)
            return _with_inertia(tree, world(view.states["q"][:1]))
        return tree.posed(made, twists)


IN_WORLD = (world_axes.forces, about_world.mass, about_centres.mass, plucker.world, plucker.world_blocks)
"""What turns axes into the world."""


def in_world(of: Dynamics | Seen | Articulated) -> bool:
    """Whether an algorithm turns axes into the world: it may do so before their own joint turns."""
    made = [f for x in vars(of).values() for f in (x, getattr(x, "keywords", {}).get("of"))]
    return any(f in IN_WORLD for f in made if callable(f))


def _with_inertia(tree: Tree, poses: Poses) -> Tree:
    """Slips in rotations by rpy are in those of <inertial> too, at all states alike; those in axes are in all uses."""
    sums, number = Sums(poses, Columns(poses, WITHOUT), WITHOUT), {k.name: k.number for k in tree.links}
    name = {n: link for link, n in poses.number.items()}
    tree.links = list(tree.links)
    for i, n in enumerate(sums.links):
        k = number[name[n]]
        tree.links[k] = replace(tree.links[k], c=sums.local[:, :, i], I=sums.tensors[:, :, i])
    for axis in (a for a in poses.axes if not a.base):
        k = number[name[axis.link]]
        tree.links[k] = replace(tree.links[k], z=axis.direction)
    return tree


def _from_world(tree: Tree, world: Callable[[np.ndarray], Poses], early: bool, q: np.ndarray) -> list[Pose]:
    """A link's pose on its parent is R0(parent)^-1 R0, also where a slip makes R0 no rotation."""
    poses, out = world(q[0]), list[Pose]()
    for k in tree.links:
        n = poses.number[k.name]
        R0, p0, before = poses.R[n], poses.p[n], poses.kept.get(n, poses.before[n])
        R, p = R0, p0
        if k.parent >= 0:
            up = out[k.parent]
            back = inverse(up.R0)
            R, p = back @ R0, product(back, p0 - up.p0)
        out.append(Pose(R, p, R0, p0, before if early else None))
    return out
