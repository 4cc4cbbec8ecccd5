"""The data sheet of a robot, on one page."""

from pathlib import Path

import dualpin as dp
from dualpin.report import robot_page

arm = dp.load("ur5")
tool = dp.mechanisms.body(0.8, [0, 0, 0.06], [[2e-3, 0, 0], [0, 2e-3, 0], [0, 0, 1e-3]])
robot = arm.attach(tool, on="tool0", name="gripper")

html = robot_page(robot, "tool0", samples=20, reach=200_000)
Path("ur5_with_gripper.html").write_text(html, encoding="utf-8")
print(f"{len(html) / 1000:.0f} kB: tree, drawing, limits, masses, DH and screws, findings, base parameters,")
print("torques under gravity, workspace, and the verdict against Pinocchio")

# what stands on it can be had as arrays too
print(f"mass {robot.mass:.2f} kg, {len(dp.base_parameters(robot))} base parameters, {len(dp.check(robot))} findings")
for part in ("Masses", "Findings", "Base parameters", "Workspace", "Validation"):
    assert f">{part}</h2>" in html
assert "gripper" in html
