"""adam 0.5.0, NumPy backend: a robot with a prismatic joint fails to load; the same with a revolute one loads."""

import sys

from adam.numpy import KinDynComputations

UNIT = '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
INERTIAL = f'<inertial><origin xyz="0 0 0" rpy="0 0 0"/>{UNIT}</inertial>'
ROBOT = (
    '<robot name="r"><link name="a">{inertial}</link><link name="b">{inertial}</link><joint name="j" type="{kind}">'
    '<parent link="a"/><child link="b"/><origin xyz="0 0 0.1" rpy="0 0 0"/><axis xyz="1 0 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
)
KinDynComputations(ROBOT.format(inertial=INERTIAL, kind="revolute"), ["j"])
try:
    KinDynComputations(ROBOT.format(inertial=INERTIAL, kind="prismatic"), ["j"])
except ValueError as e:
    print(f"expected: loads; got {type(e).__name__}: {e}")
    sys.exit(1)
print("loads")
