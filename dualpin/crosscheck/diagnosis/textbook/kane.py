"""Inverse dynamics by Kane's equations: what bodies need for their motions, taken to the joints by Jacobians.

    tau = sum J_v^T m (a_c - g) + J_w^T (I alpha + w x I w)

Motions are found from link to link, columns of Jacobians from axes and arms: a code may slip in both at once.

References: Kane and Levinson, The Use of Kane's Dynamical Equations in Robotics, IJRR 2 (1983).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .answers import Made
from .arrays import cross
from .poses import stacked
from .products import rows_of
from .steps import Steps
from .tree import tree_of
from .world_axes import needed
from .world_motions import motions

TERMS = ("bias", "rnea")


@dataclass(frozen=True)
class Kane:
    """With slips in both; `fused` as of `Tree`."""

    fused: bool = False

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        """The term (runs, samples, nv), on a fixed base."""
        tree, made = tree_of(view, self.fused), Made(view, rest=steps, fused=self.fused)
        if tree.floating or term not in TERMS:
            return None
        q, v, a = (view.states[k][None] for k in ("q", "v", "a"))
        poses, moving = tree.poses(q), motions(steps, tree, q, v, a if term == "rnea" else 0 * v)
        forces, moments = needed(steps, tree, poses, moving, tree.gravity)
        sums = made.sums(made.whole)
        name, number = {n: link for link, n in sums.poses.number.items()}, {k.name: k.number for k in tree.links}
        bodies = [number[name[n]] for n in sums.links]
        F, n = (stacked([x[k] for k in bodies], list(range(len(bodies))), 1) for x in (forces, moments))
        c = stacked([product(poses[k].R0, tree.links[k].c) for k in bodies], list(range(len(bodies))), 1)
        J = transposed(rows_of(steps, "J^T f", sums.jacobians))
        N = n - cross(c + 0 * F, F)
        return np.asarray((product(J[..., :3], N) + product(J[..., 3:], F)).sum(-2))
