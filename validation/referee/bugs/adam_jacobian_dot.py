"""adam 0.5.0: `jacobian_dot` is not the rate of `jacobian`; its product with the velocity is right.

The rate is taken by central differences of the library's own Jacobian along the motion.
"""

import sys

import numpy as np
from adam import Representations
from adam.numpy import KinDynComputations

UNIT = '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
INERTIAL = f'<inertial><origin xyz="0 0 0" rpy="0 0 0"/>{UNIT}</inertial>'
JOINT = (
    '<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{k}"/>'
    '<origin xyz="0.1 0.2 0.3" rpy="0.4 0 0"/><axis xyz="{axis}"/>'
    '<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>'
)
LINKS = "".join(f'<link name="l{i}">{INERTIAL}</link>' for i in range(4))
JOINTS = "".join(JOINT.format(i=i, k=i + 1, axis=axis) for i, axis in enumerate(("1 0 0", "0 1 0", "0 0 1")))
robot = KinDynComputations(f'<robot name="r">{LINKS}{JOINTS}</robot>', ["j0", "j1", "j2"])
robot.set_frame_velocity_representation(Representations.MIXED_REPRESENTATION)
rng = np.random.default_rng(0)
s, v, base, still, h = rng.normal(size=3), rng.normal(size=3), np.eye(4), np.zeros(6), 1e-6
rate = (robot.jacobian("l3", base, s + h * v) - robot.jacobian("l3", base, s - h * v)) / (2 * h)
off = (robot.jacobian_dot("l3", base, s, still, v) - rate)[:, 6:]
worst, product = np.abs(off).max(), np.abs(off @ v).max()
print(f"columns of the joints are off by {worst:.2g}, their product with the velocity by {product:.2g}")
sys.exit(bool(worst > 1e-6))
