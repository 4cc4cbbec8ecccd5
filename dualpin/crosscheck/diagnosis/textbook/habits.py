"""The mass matrix from Jacobians, by someone who makes the slips of Newton's and Euler's equations in these too.

alpha x r, from joint to joint and to centres of mass      z x r in the columns of Jacobians
m a,  I alpha                                              m Jv^T Jv,  Jw^T I Jw
"""

from __future__ import annotations

import numpy as np

from .columns import ACROSS, LEVER, TO_CENTRE, TO_LINK, Columns
from .equations import Equations
from .poses import Poses
from .steps import EVERYWHERE, Steps
from .tree import Tree
from .weighted import RIGHT

IN_JACOBIANS = {
    ("the acceleration of the centre of mass", "alpha x r"): [(LEVER, TO_CENTRE)],
    ("a body's moment about the link's origin", "r x f"): [(LEVER, TO_CENTRE)],
    ("the acceleration of a link's origin", "alpha x r"): [(LEVER, TO_LINK)],
    (EVERYWHERE, "alpha x r"): [("the linear part of a turning column", ACROSS)],
    ("the force of a body", "m a"): [("the mass matrix", "m Jv^T Jv")],
    ("the moment about the centre of mass", "I alpha"): [("the mass matrix", "Jw^T I Jw")],
}
"""What these slips are in Jacobians."""


def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
    """M (runs, samples, nv, nv), without rotors."""

    def made(there: Steps) -> np.ndarray:
        poses = Poses(tree.robot, tree.description, q[0], None, RIGHT, fused=tree.fused)
        return Equations(poses, Columns(poses, there), there).of_bodies

    return steps.through(IN_JACOBIANS, made)
