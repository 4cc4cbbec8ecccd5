"""DQ Robotics: kinematics in dual quaternions.

It has no reader of URDF.  A joint is a manipulator of one DH row that turns about z (or slides along it), placed by its
reference frame; the path to a link is a `DQ_SerialWholeBody` of such manipulators.
"""

import xml.etree.ElementTree as ET
from importlib.metadata import version

import numpy as np

REQUIRES = ("dqrobotics==26.4.0a7", "numpy")


def numbers(element, key, default):
    return np.array([float(x) for x in (default if element is None else element.get(key, default)).split()])


class Subject:
    name = "dqrobotics"

    def __init__(self, urdf, floating):
        if floating:
            raise NotImplementedError("no floating base")
        import dqrobotics as dq
        from dqrobotics import robot_modeling

        self.dq, self.modeling, self.version = dq, robot_modeling, version("dqrobotics")
        self.above = {j.find("child").get("link"): j for j in ET.parse(urdf).getroot().findall("joint")}
        moving = [j for j in self.above.values() if j.get("type") != "fixed"]
        kinds = {j.get("type") for j in moving} - {"revolute", "continuous", "prismatic"}
        if kinds:
            raise NotImplementedError(f"joints of type {', '.join(sorted(kinds))}")
        self.names = [j.get("name") for j in moving]
        self.writes = {"q": self.names, "v": self.names, "reference": "world"}
        self.chains = {}

    def _turned(self, axis, angle):
        axis = self.dq.DQ([0.0, *axis])
        return np.cos(angle / 2) + axis * np.sin(angle / 2)

    def _placed(self, joint):
        """Where a joint stands on its parent."""
        origin = joint.find("origin")
        roll, pitch, yaw = numbers(origin, "rpy", "0 0 0")
        turns = self._turned((0, 0, 1), yaw) * self._turned((0, 1, 0), pitch) * self._turned((1, 0, 0), roll)
        return turns + self.dq.E_ * 0.5 * self.dq.DQ([0.0, *numbers(origin, "xyz", "0 0 0")]) * turns

    def _chain(self, frame):
        """The manipulators from the root to a link, their columns, and what is fixed behind the last."""
        path = []
        while frame in self.above:
            path.insert(0, self.above[frame])
            frame = path[0].find("parent").get("link")
        body, columns, held = None, [], self.dq.DQ([1.0])
        for joint in path:
            held = held * self._placed(joint)
            if joint.get("type") == "fixed":
                continue
            axis = numbers(joint.find("axis"), "xyz", "1 0 0")
            x, y, z = axis / np.linalg.norm(axis)
            across = np.array([-y, x, 0.0]) if np.hypot(x, y) > 0 else np.array([1.0, 0.0, 0.0])
            toward = self._turned(across / np.linalg.norm(across), np.arctan2(np.hypot(x, y), z))  # turns z to the axis
            slides = float(joint.get("type") == "prismatic")
            arm = self.modeling.DQ_SerialManipulatorDH(np.array([[0.0], [0.0], [0.0], [0.0], [slides]]))
            arm.set_reference_frame(held * toward)
            held = self.dq.conj(toward)
            columns.append(self.names.index(joint.get("name")))
            if body is None:
                body = self.modeling.DQ_SerialWholeBody(arm)
            else:
                body.add(arm)
        return body, columns, held

    def _at(self, frame):
        if frame not in self.chains:
            self.chains[frame] = self._chain(frame)
        return self.chains[frame]

    def fk(self, q, frame):
        body, columns, held = self._at(frame)
        x = held if body is None else body.fkm(q[columns]) * held
        return [*self.dq.vec3(self.dq.translation(x)), *self.dq.vec4(self.dq.rotation(x))]

    def jacobian(self, q, frame):
        J = np.zeros((6, len(self.names)))
        body, columns, _ = self._at(frame)
        if body is not None:
            x = body.fkm(q[columns])
            twists = 2 * self.dq.haminus8(self.dq.conj(x)) @ body.pose_jacobian(q[columns])  # 2 x' x*
            J[:, columns] = twists[[1, 2, 3, 5, 6, 7]]
        return J
