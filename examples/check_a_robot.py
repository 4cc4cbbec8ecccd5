"""Find what is wrong with a robot description before it is simulated: here a URDF with four planted faults."""

import tempfile
from pathlib import Path

import dualpin as dp
from dualpin.analysis.check import diff, fixed

ARM = """<robot name="arm">
  <link name="base"/>
  <link name="left_arm">
    <inertial><origin xyz="0 0.2 0"/><mass value="1.5"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.02"/></inertial>
  </link>
  <link name="right_arm">  <!-- copied, and the sign of y was kept -->
    <inertial><origin xyz="0 0.2 0"/><mass value="1.5"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.02"/></inertial>
  </link>
  <link name="head">  <!-- no body has these moments -->
    <inertial><origin xyz="0.1 0 0.1"/><mass value="2"/>
      <inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.02"/></inertial>
  </link>
  <joint name="left" type="continuous"><origin xyz="0 0.1 0"/>
    <parent link="base"/><child link="left_arm"/><axis xyz="1 0 0"/></joint>
  <joint name="right" type="continuous"><origin xyz="0 -0.1 0"/>
    <parent link="base"/><child link="right_arm"/><axis xyz="1 0 0"/></joint>
  <joint name="neck" type="revolute"><origin xyz="0 0 0.3" rpy="1.5708 0 0"/>
    <parent link="base"/><child link="head"/><axis xyz="0 1 0"/>
    <limit lower="-60" upper="60" effort="5" velocity="1"/></joint>
</robot>
"""

file = Path(tempfile.mkdtemp()) / "arm.urdf"
file.write_text(ARM, encoding="utf-8")
found = dp.check(file)
for f in found:
    print(f"line {f.line}: {f.rule} of {f.item}: {f.says}\n    {f.why}")
assert {f.rule for f in found} == {"not-mirrored", "triangle-inequality", "near-right-angle", "degrees"}

# what is certain is corrected in the file's own text; the rest is for its author
print(diff(found, "arm.urdf", fixed(found)))
