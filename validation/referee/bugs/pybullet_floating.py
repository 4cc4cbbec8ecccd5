"""PyBullet 3.2.7: `calculateInverseDynamics` of a floating base (flags=1) answers 7 + n numbers for 6 + n velocities.

The quick start guide asks for 6 + n velocities and accelerations; one number of the answer belongs to none of them.
"""

import sys
import tempfile
from pathlib import Path

import pybullet as pb

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
ROBOT = (
    f'<robot name="r"><link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link><joint name="j" type="revolute">'
    '<parent link="a"/><child link="b"/><origin xyz="0 0 0.1"/><axis xyz="1 0 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
)
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "robot.urdf"
    path.write_text(ROBOT)
    pb.connect(pb.DIRECT)
    body = pb.loadURDF(str(path), useFixedBase=False, flags=pb.URDF_USE_INERTIA_FROM_FILE)
pb.setGravity(0, 0, -9.81)
tau = pb.calculateInverseDynamics(body, [0, 0, 0, 0, 0, 0, 1, 0.1], [0.0] * 7, [0.0] * 7, 1)
print(f"expected 7 numbers, got {len(tau)}")
sys.exit(len(tau) != 7)
