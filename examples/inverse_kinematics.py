"""Inverse kinematics of many poses at once, with limits, and of positions alone for an arm of four joints."""

import numpy as np

import dualpin as dp

arm = dp.load("ur5")
q, _, _ = arm.sample(200, seed=1)
targets = dp.fk(arm, q, frame="tool0")
found = dp.ik(arm, targets, "tool0")
error = np.abs(dp.fk(arm, found.q, frame="tool0") - targets).max(axis=(1, 2))
print(f"ur5: {found.success.sum()} of {len(q)} poses reached, at most {error[found.success].max():.1e} off")
assert found.success.mean() > 0.95
assert ((found.q >= arm.lower) & (found.q <= arm.upper)).all()

scara = dp.from_dh(
    [(0, 0.4, 0.3, 0), (0, 0, 0.25, np.pi), (0, 0, 0, 0), (0, 0.1, 0, 0)], joints="RRPR", convention="standard"
)
place = np.eye(4)
place[:3, 3] = 0.35, 0.2, 0.15
reached = dp.ik(scara, place, task="position")
tip = dp.fk(scara, reached.q, frame=scara.frame_names[-1])[:3, 3]
print(f"scara: {np.round(reached.q, 4).tolist()} puts the tip at {np.round(tip, 6).tolist()}")
assert np.allclose(tip, place[:3, 3], atol=1e-8)
