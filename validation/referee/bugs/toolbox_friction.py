"""Robotics Toolbox 1.5.0: `rne` uses <dynamics friction> as a viscous coefficient, and drops <dynamics damping>.

In URDF damping multiplies the velocity and friction is a static force; whatever a library makes of them, 2 rad/s with
friction 3 is no torque of 6 N m, while damping 3 alone gives none.
"""

import sys

import numpy as np
from _toolbox import compare, joint, mass, read

wrong = False
for damping, friction in ((3, 0), (0, 3)):
    more = f'<dynamics damping="{damping}" friction="{friction}"/>'
    robot = read([("w", ""), ("a", mass(1, 0.1))], [joint("j", "w", "a", axis="0 0 1", more=more)])
    tau = robot.rne(np.zeros(1), np.array([2.0]), np.zeros(1))
    wrong |= compare(f"damping {damping}, friction {friction}, at 2 rad/s", tau, [damping * 2.0 + friction])
sys.exit(wrong)
