"""kinpy: forward kinematics and Jacobians, on a fixed base."""

from importlib.metadata import version
from pathlib import Path

import numpy as np

REQUIRES = ("kinpy==0.6.1",)


class Subject:
    name = "kinpy"

    def __init__(self, urdf, floating):
        import kinpy as kp

        if floating:
            raise NotImplementedError("no floating base")
        self.kp, self.version, self.text = kp, version("kinpy"), Path(urdf).read_text(encoding="utf-8")
        self.chain = kp.build_chain_from_urdf(self.text)
        self.names = list(self.chain.get_joint_parameter_names())
        self.writes = {"q": self.names, "v": self.names, "rows": ("vx", "vy", "vz", "wx", "wy", "wz")}

    def fk(self, q, frame):
        return self.chain.forward_kinematics(q)[frame].matrix()

    def jacobian(self, q, frame):
        serial = self.kp.build_serial_chain_from_urdf(self.text, frame)
        at = [self.names.index(n) for n in serial.get_joint_parameter_names()]
        J = np.zeros((6, len(self.names)))
        J[:, at] = serial.jacobian(q[at])
        return J
