"""How near is a singularity, and which wrench do the bearings carry there without any torque?"""

import numpy as np

import dualpin as dp
from dualpin.analysis.workspace import nearest_singularity

arm = dp.load("ur5")
q = np.array([0.3, -1.0, 1.2, 0.4, 0.15, 0.7])  # the fifth joint is nearly straight
found = dp.singularity(arm, q, "tool0")
lost = found.lost
print(f"distance {found.distance:.4f}; lost: a wrench along {lost.direction.round(3).tolist()}")
print(f"through {lost.point.round(3).tolist()} m, of pitch {float(lost.pitch):.3f} m")
print("joint velocity that hardly moves the tool:", found.joints.round(3).tolist())

# at the singularity itself it is reciprocal to every joint's screw (Ball)
there, distance = nearest_singularity(arm, q, "tool0")
print(f"singular at {there.round(3).tolist()}, {distance:.3f} rad away")
screws, lost = dp.jacobian(arm, there, "tool0"), dp.singularity(arm, there, "tool0").lost
power = [float(dp.algebra.reciprocal(dp.algebra.Motor(s[:3], s[3:]), lost)) for s in screws.T]
print(f"power of joint screws on it: {max(map(abs, power)):.1e}")
assert max(map(abs, power)) < 1e-8 and distance < 0.2

# velocity, force and dynamic manipulability say the same of this direction
for kind in ("velocity", "force", "dynamic"):
    ellipsoid = dp.manipulability(arm, q, "tool0", kind)
    print(f"{kind:9s} condition {ellipsoid.condition:8.1f}, semi-axes {ellipsoid.axes.round(3).tolist()}")
