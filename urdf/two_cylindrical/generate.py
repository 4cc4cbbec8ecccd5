"""Two cylindrical joints in a row, as pairs of a revolute and a prismatic one: writes two_cylindrical.urdf."""

import warnings
from math import pi
from pathlib import Path

import dualpin as dp

L1, L2 = 0.1005, 0.07
ROWS = [(0, 0, L1, pi / 2), (0, 0, L2, 0)]
INERTIAS = [
    {
        "mass": 1.3,
        "com": (-0.05, 0.01, 0.02),
        "inertia": [[0.004, 0.0001, -0.0002], [0.0001, 0.006, 0.0003], [-0.0002, 0.0003, 0.005]],
    },
    {
        "mass": 0.9,
        "com": (-0.03, -0.02, 0.025),
        "inertia": [[0.002, 0.00005, 0], [0.00005, 0.003, -0.0001], [0, -0.0001, 0.0025]],
    },
]


def robot() -> dp.Robot:
    return dp.from_dh(ROWS, "CC", "standard", inertias=INERTIAS, name="two_cylindrical")


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", dp.DualpinWarning)  # the split is intended
        robot().to_urdf(Path(__file__).with_name("two_cylindrical.urdf"))
