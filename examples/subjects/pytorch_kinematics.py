"""pytorch_kinematics: forward kinematics and Jacobians, on a fixed base.

dualpin judge panda examples/subjects/pytorch_kinematics.py:Subject --python PATH_OF_ITS_PYTHON
"""

from importlib.metadata import version
from pathlib import Path

import numpy as np

REQUIRES = ("torch", "pytorch_kinematics==0.10.0")


class Subject:
    name = "pytorch_kinematics"

    def __init__(self, urdf, floating):
        import pytorch_kinematics as pk
        import torch

        if floating:
            raise NotImplementedError("no floating base")
        torch.set_default_dtype(torch.float64)
        self.pk, self.torch, self.version = pk, torch, version("pytorch-kinematics")
        self.text = Path(urdf).read_bytes()
        self.chain = pk.build_chain_from_urdf(self.text).to(dtype=torch.float64)
        self.names = list(self.chain.get_joint_parameter_names())
        self.writes = {"q": self.names, "v": self.names, "rows": ("vx", "vy", "vz", "wx", "wy", "wz")}

    def fk(self, q, frame):
        return self.chain.forward_kinematics(self.torch.as_tensor(q)[None])[frame].get_matrix()[0].numpy()

    def jacobian(self, q, frame):
        serial = self.pk.build_serial_chain_from_urdf(self.text, frame).to(dtype=self.torch.float64)
        at = [self.names.index(n) for n in serial.get_joint_parameter_names()]
        J = np.zeros((6, len(self.names)))
        J[:, at] = serial.jacobian(self.torch.as_tensor(q[at])[None])[0].numpy()
        return J
