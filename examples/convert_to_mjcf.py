"""Take a URDF to MuJoCo and have MuJoCo say that it is the same robot, term by term."""

import tempfile
from pathlib import Path

import numpy as np

import dualpin as dp

folder = Path(tempfile.mkdtemp())
done = dp.convert("panda", folder / "panda.xml", samples=8)
for term, error in done.terms.items():
    print(f"{term:28s} {error:.1e}")
print(f"judged by {done.library}; lost: {'; '.join(done.notes)}")
assert done.passed and max(done.terms.values()) < 1e-11

# and back: a file for MuJoCo is a robot like any other
robot = dp.load(folder / "panda.xml")
q, v, a = robot.sample(100, seed=0)
difference = np.abs(dp.rnea(robot, q, v, a) - dp.rnea(dp.load("panda"), q, v, a)).max()
print(f"torques of {robot.name} read back differ by at most {difference:.1e} N m")
assert difference < 1e-12
