"""Mitsubishi PA-10, seven revolute joints: writes pa10.urdf beside this file.  See PROVENANCE.md."""

from math import pi, radians
from pathlib import Path

import dualpin as dp

ALPHA = (-pi / 2, pi / 2, -pi / 2, pi / 2, -pi / 2, pi / 2, 0.0)
D = (0.317, 0.0, 0.450, 0.0, 0.480, 0.0, 0.070)
LIMITS = (177, 90, 174, 137, 255, 165, 255)  # degrees, either way
# made up: solid cylinders about the links' long axes (kg; centre and half length along the arm, radius in m)
MASS = (9.0, 8.0, 5.0, 4.0, 3.0, 2.0, 0.5)
RADIUS = (0.10, 0.09, 0.08, 0.07, 0.06, 0.05, 0.04)
LENGTH = (0.20, 0.225, 0.225, 0.24, 0.24, 0.10, 0.05)

ROWS = [(0.0, d, 0.0, alpha) for d, alpha in zip(D, ALPHA, strict=True)]


def cylinder(i: int) -> dict:
    """A cylinder along the arm: in odd links below the distal frame (its y axis), in even ones above (its z axis)."""
    m, r, h = MASS[i], RADIUS[i], LENGTH[i]
    along, across = m * r**2 / 2, m * (3 * r**2 + h**2) / 12
    if i == 6:  # the flange: along z, behind the last frame
        return {"mass": m, "com": (0, 0, -h / 2), "inertia": [[across, 0, 0], [0, across, 0], [0, 0, along]]}
    if i % 2 == 0:  # links 1, 3, 5: the distal frame's y axis points along the proximal joint axis, up or down
        down = 1 if ALPHA[i] < 0 else -1
        return {"mass": m, "com": (0, down * h / 2, 0), "inertia": [[across, 0, 0], [0, along, 0], [0, 0, across]]}
    return {"mass": m, "com": (0, 0, h / 2), "inertia": [[across, 0, 0], [0, across, 0], [0, 0, along]]}


def robot() -> dp.Robot:
    limits = [(-radians(x), radians(x)) for x in LIMITS]
    return dp.from_dh(ROWS, "RRRRRRR", "standard", inertias=[cylinder(i) for i in range(7)], limits=limits, name="pa10")


if __name__ == "__main__":
    robot().to_urdf(Path(__file__).with_name("pa10.urdf"))
