"""Robotics Toolbox 1.5.0: `rne` of a robot read from URDF puts fixed links in the wrong places.

1. Two fixed siblings on an arm that turns about y, 1 kg at 0.1 m and 1 kg at 0.2 m: the second is put behind the first.
2. A fixed link of 0.5 m before a joint is lost: 1 kg at 0.1 m on the second joint.
"""

import sys

import numpy as np
from _toolbox import compare, joint, mass, read

g, still = 9.81, np.zeros
siblings = read(
    [("w", ""), ("a", ""), ("s1", mass(1)), ("s2", mass(1))],
    [joint("j", "w", "a", axis="0 1 0"), joint("f1", "a", "s1", 0.1), joint("f2", "a", "s2", 0.2)],
)
wrong = compare("siblings", siblings.rne(still(1), still(1), still(1)), [-g * 0.3])
behind = read(
    [("w", ""), ("a", ""), ("s", ""), ("b", mass(1, 0.1))],
    [joint("j1", "w", "a", axis="0 1 0"), joint("f", "a", "s", 0.5), joint("j2", "s", "b", axis="0 1 0")],
)
wrong |= compare("a joint on a fixed link", behind.rne(still(2), still(2), still(2)), [-g * 0.6, -g * 0.1])
sys.exit(wrong)
