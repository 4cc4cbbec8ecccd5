"""Design an exciting motion, measure along it, and find masses, inertias and friction that can exist."""

import numpy as np

import dualpin as dp

arm = dp.load("ur5")
motion = dp.excite(arm, {"velocity": 2.0, "acceleration": 6.0}, iterations=3, starts=30)
print(motion)
left = {name: round(float(x.min()), 3) for name, x in motion.margins().items()}
print("what the whole period leaves of each limit:", left)
assert min(left.values()) >= 0

# the robot that is measured: heavier than its description, with friction, and with noise
real = arm.attach(dp.mechanisms.body(1.5, [0, 0, 0.05], np.eye(3) * 2e-3), on="forearm_link")
rng, damping, dry, noise = np.random.default_rng(0), 4.0, 2.5, 0.5
_, q, v, a = motion.sample(rate=100.0)
tau = dp.rnea(real, q, v, a) + damping * v + dry * np.sign(v) + noise * rng.standard_normal(v.shape)

found = dp.identify(arm, q, v, a, tau, friction=True)
print(found)
print(f"mass {found.robot.mass:.2f} kg, described {arm.mass:.2f}, true {real.mass:.2f}")
for row in found.table()[-3:]:
    print(f"  {row['parameter']:32s} {row['value']:.3f} +- {row['deviation']:.3f}")

# torques of another motion
q, v, a = arm.sample(500, seed=7)
truth = dp.rnea(real, q, v, a) + damping * v + dry * np.sign(v)
before, after = (np.sqrt(np.mean((x - truth) ** 2)) for x in (dp.rnea(arm, q, v, a), found.predict(q, v, a)))
print(f"torque error rms: {before:.2f} N m by the description, {after:.2f} N m identified")
assert after < 0.1 * before
