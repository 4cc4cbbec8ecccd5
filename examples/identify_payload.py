"""Find mass, centre and inertia of an unknown payload from noisy torques."""

import numpy as np

import dualpin as dp

MASS, CENTRE, NOISE = 2.5, np.array([0.02, -0.01, 0.08]), 0.1  # what is to be found; N m
arm = dp.load("ur5")
loaded = arm.attach(dp.mechanisms.body(MASS, CENTRE, np.eye(3) * 4e-3), on="tool0")

rng = np.random.default_rng(0)
q, v, a = arm.sample(500, seed=0)
tau = dp.rnea(loaded, q, v, a) + NOISE * rng.standard_normal((500, arm.nv))

found = dp.identify_payload(arm, q, v, a, tau, "tool0")
print(found)
print(f"mass    {found.mass:.4f} +- {found.deviation[0]:.4f} kg ({MASS})")
print(f"centre  {found.com.round(4).tolist()} +- {found.com_deviation.round(4).tolist()} m ({CENTRE.tolist()})")
print(f"noise   {found.noise.round(3).tolist()} N m ({NOISE})")
assert abs(found.mass - MASS) < 4 * found.deviation[0]
assert (abs(found.com - CENTRE) < 4 * found.com_deviation).all()
assert abs(dp.rnea(found.robot, q, v, a) - tau).max() < 6 * NOISE
