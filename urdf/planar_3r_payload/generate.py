"""A planar arm with two joints and a payload on a third, passive one.

Writes planar_3r_payload.urdf beside this file.  See PROVENANCE.md.
"""

from math import pi
from pathlib import Path

import numpy as np

import dualpin as dp

LENGTH, CENTRE, MASS, INERTIA = (0.5, 0.4, 0.3), (0.25, 0.18, 0.12), (2.5, 1.5, 0.8), (0.06, 0.03, 0.01)
UPRIGHT = dp.forms.DHStep(dp.Dual(0.0, 0.0), dp.Dual(pi / 2, 0.0))  # the arm's y axis is the world's z axis


def link(a: float, l: float, m: float, J: float) -> dict:
    """Centre of mass at l from the joint; a slender body: next to nothing about its own axis."""
    return {"mass": m, "com": (l - a, 0, 0), "inertia": np.diag([J / 100, J, J])}


def robot() -> dp.Robot:
    rows = [(0, 0, a, 0) for a in LENGTH]
    inertias = [link(*four) for four in zip(LENGTH, CENTRE, MASS, INERTIA, strict=True)]
    return dp.from_dh(rows, "RRR", "standard", base=UPRIGHT, inertias=inertias, name="planar_3r_payload")


if __name__ == "__main__":
    robot().to_urdf(Path(__file__).with_name("planar_3r_payload.urdf"))
