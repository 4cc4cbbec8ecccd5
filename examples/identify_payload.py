"""Find mass and centre of an unknown payload from noisy torques: the dynamics is linear in them."""

import numpy as np

import dualpin as dp
from dualpin.spatial import Inertia

MASS, CENTRE, NOISE = 2.5, np.array([0.02, -0.01, 0.08]), 0.1  # what is to be found; N m
arm = dp.load("ur5")
loaded = arm.attach(Inertia.of(MASS, CENTRE, np.eye(3) * 4e-3), on="wrist_3_link")

rng = np.random.default_rng(0)
q, v, a = arm.sample(500, seed=0)
tau = dp.rnea(loaded, q, v, a) + NOISE * rng.standard_normal((500, arm.nv))

Y = dp.joint_torque_regressor(arm, q, v, a)[..., -10:].reshape(-1, 10)  # of the last body, to which it is fixed
rest = (tau - dp.rnea(arm, q, v, a)).ravel()
parameters, *_ = np.linalg.lstsq(Y, rest, rcond=None)
deviation = NOISE * np.sqrt(np.diag(np.linalg.inv(Y.T @ Y)))
print(f"mass    {parameters[0]:.4f} +- {deviation[0]:.4f} kg ({MASS})")
print(f"centre  {np.round(parameters[1:4] / parameters[0], 4).tolist()} m ({CENTRE.tolist()})")
assert abs(parameters[0] - MASS) < 4 * deviation[0]
