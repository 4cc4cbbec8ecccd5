"""Regressors of a code that finds motions from link to link, and takes wrenches to the joints by Jacobians.

It may slip in its Jacobians, and in motions or in the wrenches of unit parameters besides.

References: Siciliano et al., Robotics (2009), section 7.2.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..case import View
from .answers import Made
from .assembly import Dynamics
from .regressors import in_columns
from .steps import Steps
from .tree import tree_of


@dataclass(frozen=True)
class Regressed:
    """With slips in both; `how` as of `Made`, `of` says in what else."""

    how: tuple[tuple[str, Any], ...]
    of: Dynamics

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        """The term (runs, samples, ...); of other terms, what both change adds up."""
        made = Made(view, rest=steps, **dict(self.how))
        if term != "joint_torque_regressor":
            one, other = made.term(term), self.of(view, term, steps)
            return None if other is None else one + other - view.compute(term, view.layout.how.reference)
        tree = tree_of(view, self.of.fused)
        if tree.floating or self.of.regressor is None:
            return None
        names, (q, v, a) = [k.name for k in tree.links], (view.states[k][None] for k in ("q", "v", "a"))
        return in_columns(view, self.of.regressor(steps, tree, q, v, a, made.link_jacobians(names)), names)
