"""Where can the tool be, in how many directions, how well does it move there, and what can it hold?"""

import numpy as np

import dualpin as dp

arm = dp.load("ur5")
reach = dp.reach_map(arm, "tool0", n=1_000_000)
print(reach)
print(f"{reach.samples / reach.seconds / 1e6:.1f} million configurations a second, complete to {reach.coverage:.0%}")
for x in (0.3, 0.6, 0.85):
    print(f"  {x} m in front: reached in {reach.at([x, 0, 0.3]):.0%} of the directions")

# any measure of configurations, over the same cells: the best, or the worst of each
isotropy = reach.survey(lambda q: 1 / dp.manipulability(arm, q, "tool0").condition, "max")
capacity = reach.survey(lambda q: dp.payload_capacity(arm, q, "tool0"), "min")
best = np.unravel_index(np.nanargmax(isotropy), reach.shape)
place = [float(reach.centres(k)[i].round(2)) for k, i in enumerate(best)]
print(f"most isotropic near {place} m: {np.nanmax(isotropy):.2f}; it holds {np.nanmin(capacity):.1f} kg everywhere")
assert 3 < reach.volume < 6 and np.nanmin(capacity) > 5

reach.save("reach.npz")
reach.plot("workspace.png", isotropy=isotropy, capacity=capacity)
