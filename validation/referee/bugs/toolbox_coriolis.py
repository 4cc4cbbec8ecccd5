"""Robotics Toolbox 1.5.0: `coriolis` of a robot read from URDF raises."""

import sys

import numpy as np
from _toolbox import joint, mass, read

robot = read([("w", ""), ("a", mass(1, 0.1))], [joint("j", "w", "a", axis="0 0 1")])
try:
    print("got", robot.coriolis(np.zeros(1), np.ones(1)))
except ValueError as e:
    print(f"expected a matrix, got {type(e).__name__}: {str(e)[:80]}")
    sys.exit(1)
