"""A quadruped floating in space moves its legs: the base turns, the momentum does not change."""

import numpy as np

import dualpin as dp

robot = dp.load("solo12", floating=True).with_gravity((0, 0, 0))
q, v = robot.neutral, np.zeros(robot.nv)


def legs(t, q, v):
    """Torques of the joints alone, about a millinewton metre."""
    tau = np.zeros(robot.nv)
    tau[6:] = 1e-3 * np.sin(5 * t + np.arange(robot.nv - 6))
    return tau


run = dp.simulate(robot, q, v, legs, dt=0.005, t_end=1.0)
h = np.einsum("nij,nj->ni", dp.centroidal_momentum_matrix(robot, run.q), run.v)
turned = 2 * np.rad2deg(np.arccos(min(1.0, abs(run.q[-1, 3]))))
print(f"the base turned by {turned:.3f} degrees; the momentum stayed below {np.abs(h).max():.1e}")
assert np.abs(h).max() < 1e-8 < turned
