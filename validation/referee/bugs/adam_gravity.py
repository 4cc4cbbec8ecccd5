"""adam 0.5.0: gravity by default is 9.80665 rounded to single precision (9.806650161743164), not a double."""

import sys

from adam.numpy import KinDynComputations

UNIT = '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
INERTIAL = f'<inertial><origin xyz="0 0 0" rpy="0 0 0"/>{UNIT}</inertial>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
ROBOT = (
    f'<robot name="r"><link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link><joint name="j" type="revolute">'
    f'<parent link="a"/><child link="b"/><origin xyz="0 0 0" rpy="0 0 0"/><axis xyz="1 0 0"/>{LIMIT}</joint></robot>'
)
g = float(abs(KinDynComputations(ROBOT, ["j"]).g[2]))
print(f"expected 9.80665, got {g!r}")
sys.exit(g != 9.80665)
