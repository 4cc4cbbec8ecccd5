"""Unimation PUMA 560, six revolute joints: writes puma560.urdf beside this file.  See PROVENANCE.md."""

from math import pi
from pathlib import Path

import numpy as np

import dualpin as dp

A2, A3, D2, D3, D4 = 0.4318, -0.0203, 0.2435, -0.0934, 0.4331
# theta, d, a, alpha; a and alpha before the joint (Craig)
ROWS = [
    (0, 0, 0, 0),
    (0, D2, 0, -pi / 2),
    (0, D3, A2, 0),
    (0, D4, A3, pi / 2),
    (0, 0, 0, -pi / 2),
    (0, 0, 0, pi / 2),
]
# mass, centre of mass, principal inertias about it; in the modified DH frames
BODIES = [
    (1.0, (0, 0, 0), (0.35, 0.35, 0.35)),
    (17.4, (0.068, 0.006, -0.016), (0.130, 0.524, 0.539)),
    (4.8, (0, -0.070, 0.014), (0.066, 0.0125, 0.086)),
    (0.82, (0, 0, -0.019), (1.8e-3, 1.8e-3, 1.3e-3)),
    (0.34, (0, 0, 0), (0.3e-3, 0.3e-3, 0.4e-3)),
    (0.09, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
]


def robot() -> dp.Robot:
    inertias = [{"mass": m, "com": c, "inertia": np.diag(J)} for m, c, J in BODIES]
    return dp.from_dh(ROWS, "RRRRRR", "modified", inertias=inertias, name="puma560")


if __name__ == "__main__":
    robot().to_urdf(Path(__file__).with_name("puma560.urdf"))
