"""Computed torque control of a UR5 with an unmodelled payload of 1 kg: the tracking error."""

import numpy as np

import dualpin as dp
from dualpin.spatial import Inertia

KP, KD, WIDTH, RATE = 100.0, 20.0, 0.4, 2.0
arm = dp.load("ur5")
loaded = arm.attach(Inertia.of(1.0, (0, 0, 0.05), np.eye(3) * 1e-3), on="tool0")
middle = np.array([0.0, -1.2, 1.4, -0.3, 0.5, 0.0])
inverse_dynamics = arm.kernel("rnea")  # the shortest way to one configuration


def wanted(t):
    """The motion: a sine of every joint, with its rates."""
    return middle + WIDTH * np.sin(RATE * t), WIDTH * RATE * np.cos(RATE * t), -WIDTH * RATE**2 * np.sin(RATE * t)


def controller(t, q, v):
    """tau = RNEA(q, v, a_d + Kd e' + Kp e)"""
    q_d, v_d, a_d = wanted(t)
    return inverse_dynamics(q, v, np.asarray(a_d + KD * (v_d - v) + KP * (q_d - q)))


q0, v0, _ = wanted(0.0)
for name, plant in (("known", arm), ("unknown", loaded)):
    run = dp.simulate(plant, q0, np.full(6, v0), controller, dt=0.002, t_end=1.0, hold=True)
    error = np.abs(run.q - np.stack([wanted(t)[0] for t in run.t])).max()
    print(f"payload {name}: largest error {np.rad2deg(error):.4f} degrees")
