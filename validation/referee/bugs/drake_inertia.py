"""Drake 1.51.1: a link that has an `<inertia>` and mass 0 becomes a ball of 1 kg; nothing but the log says so.

The parser puts a solid ball of 1000 kg/m^3 in the place of an inertia that no body can have, of the file's mass, and of
1 kg where that is 0.  On a robot whose feet are written so (bolt: 5.7e-7 kg m^2, no mass) two kilograms appear:
gravity, mass matrix and every force change.  Expected: an error, or the file's mass with the tensor dropped.
"""

import sys

import pydrake.all as pd

ROBOT = """<robot name="r"><link name="a"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="foot"><inertial><mass value="0"/>
<inertia ixx="5.7e-7" iyy="8.4e-7" izz="5.3e-7" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="foot"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
plant = pd.MultibodyPlant(0.0)
pd.Parser(plant).AddModelsFromString(ROBOT, "urdf")
plant.Finalize()
mass = plant.CalcTotalMass(plant.CreateDefaultContext())
print(f"total mass: expected 2, got {mass:.6g}")
sys.exit(bool(abs(mass - 2) > 1e-9))
