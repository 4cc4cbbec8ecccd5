"""iDynTree 15.1.0: `generalizedGravityForces` of a floating base depends on what was asked before.

Two bodies of 3 kg in all, turned about x: the force that holds them is (0, 0, 29.43) N in world axes, which the mixed
representation means, whatever the orientation.  The function does not bring the forward kinematics up to date after
`setRobotState`: the wrench of the base is turned by the pose for which kinematics was computed last.  So it is right
only after another question at the same state, such as `generalizedBiasForces` or `getWorldTransform`.
"""

import sys

import idyntree.bindings as idt
import numpy as np

INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
ROBOT = (
    f'<robot name="b"><link name="base"><inertial><mass value="2"/>{INERTIA}</inertial></link>'
    f'<link name="l"><inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="1"/>{INERTIA}</inertial></link>'
    '<joint name="j" type="revolute"><parent link="base"/><child link="l"/><axis xyz="1 0 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
)
loader = idt.ModelLoader()
loader.loadModelFromString(ROBOT)
k = idt.KinDynComputations()
k.loadRobotModel(loader.model())
k.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION)
n, worst = k.getNrOfDegreesOfFreedom(), 0.0


def asked(function):
    """The force on the base."""
    tau = idt.FreeFloatingGeneralizedTorques(k.model())
    function(tau)
    return tau.baseWrench().toNumPy()[:3].round(6)


for angle in (0.5, 1.0):
    H = np.eye(4)
    H[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    k.setRobotState(H, np.zeros(n), np.zeros(6), np.zeros(n), np.array([0, 0, -9.81]))
    first = asked(k.generalizedGravityForces)
    asked(k.generalizedBiasForces)
    again = asked(k.generalizedGravityForces)
    worst = max(worst, *np.abs(first - [0, 0, 29.43]), *np.abs(again - [0, 0, 29.43]))
    print(f"angle {angle}: expected (0, 0, 29.43), got {first.tolist()}, and after the bias {again.tolist()}")
sys.exit(bool(worst > 1e-6))
