"""What changed between two versions of a robot: names, frames, masses, and what that does to the torques."""

import numpy as np

import dualpin as dp

old = dp.load("ur5")
text = old.to_urdf()

# a release that renames a joint, and makes the forearm 200 g heavier
mass = next(k.inertia.mass for k in old.links if k.name == "forearm_link")
renamed = text.replace("elbow_joint", "elbow")
new = dp.loads(renamed.replace(f'mass value="{float(mass)!r}"', f'mass value="{float(mass) + 0.2!r}"'))

found = dp.diff(old, new)
print(found)
assert found.verdict == "different" and found.joints["elbow_joint"] == "elbow"

# the worst state is part of the result
worst = found.terms["gravity"]
q = np.array(worst.state["q"])
change = dp.gravity(new, q) - dp.gravity(old, q)
print(f"at q = {q.round(2)} gravity changes by {change.round(3)} N m; largest: {worst}")
assert np.isclose(np.abs(change).max(), worst.amount)

# only renamed: the same robot
same = dp.diff(old, dp.loads(renamed))
print(same.verdict)
assert same.same and not same.identical
