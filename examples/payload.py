"""Torques of a UR5 with and without a payload of 3 kg, and its limits."""

import numpy as np

import dualpin as dp
from dualpin.spatial import Inertia

MASS, OFFSET, SIDE = 3.0, 0.05, 0.1  # a cube of 10 cm, its centre 5 cm before the flange

arm = dp.load("ur5")
loaded = arm.attach(Inertia.of(MASS, (0, 0, OFFSET), np.eye(3) * MASS * SIDE**2 / 6), on="tool0")

q, v, _ = arm.sample(20_000, seed=0)
still = np.zeros_like(v)
bare, heavy = dp.rnea(arm, q, still, still), dp.rnea(loaded, q, still, still)
limit = np.array([j.limits.effort for j in arm])
print("joint                 bare  loaded  limit  [N m], worst of 20 000 configurations at rest")
for name, a, b, most in zip(arm.joint_names, np.abs(bare).max(0), np.abs(heavy).max(0), limit, strict=True):
    print(f"{name:20s} {a:5.1f}  {b:6.1f}  {most:5.0f}")
share = np.mean((np.abs(heavy) > limit).any(axis=1))
print(f"{100 * share:.1f} % of the configurations are beyond a limit")
