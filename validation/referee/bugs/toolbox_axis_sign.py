"""Robotics Toolbox 1.5.0: `rne` of a joint about -y is that of a joint about +y.

1 kg at 0.1 m on a joint about -y at rest: turning forward lifts the mass (the toolbox's own fkine agrees), so the
torque that holds it is +0.981 N m.
"""

import sys

import numpy as np
from _toolbox import compare, joint, mass, read

robot = read([("w", ""), ("a", mass(1, 0.1))], [joint("j", "w", "a", axis="0 -1 0")])
height = [(robot.fkine([x]).A @ [0.1, 0, 0, 1])[2] for x in (1e-6, -1e-6)]
expected = 9.81 * (height[0] - height[1]) / 2e-6
sys.exit(compare("torque", robot.rne(np.zeros(1), np.zeros(1), np.zeros(1)), [round(expected, 6)]))
