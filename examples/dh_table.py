"""The DH table of an arm that is only known as URDF, as CSV and LaTeX, and the proof that it is the same arm."""

import tempfile
from pathlib import Path

import numpy as np

import dualpin as dp

robot = dp.load("panda")
table = dp.to_dh(robot, base="panda_link0", tip="panda_link8", convention="modified")
print(table.table(degrees=True))

with tempfile.TemporaryDirectory() as folder:
    table.to_csv(Path(folder) / "panda.csv")
    table.to_latex(Path(folder) / "panda.tex")
    print((Path(folder) / "panda.csv").read_text(encoding="utf-8").splitlines()[0])

q, _, _ = robot.sample(1000, seed=0)
difference = np.abs(table.fk(q) - dp.fk(robot, q, frame="panda_link8")).max()
print(f"1000 poses of the table and of the URDF differ by at most {difference:.1e}")
assert difference < 1e-14 * len(robot) * 10
