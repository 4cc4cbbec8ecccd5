"""PyBullet, as loadURDF's defaults give it; the option "file" takes inertia from the file.

dualpin subjects install examples/subjects/pybullet.py
dualpin judge panda examples/subjects/pybullet.py:Subject
"""

from importlib.metadata import version

import numpy as np

REQUIRES = ("pybullet==3.2.7", "numpy")
BASE_Q, LINEAR_FIRST = ("x", "y", "z", "qx", "qy", "qz", "qw"), ("vx", "vy", "vz", "wx", "wy", "wz")


class Subject:
    name = "pybullet"

    def __init__(self, urdf, floating, gravity, option=""):
        import pybullet as pb

        self.pb, self.version, self.floating = pb, version("pybullet"), floating
        pb.connect(pb.DIRECT)
        flags = pb.URDF_USE_INERTIA_FROM_FILE if option == "file" else 0
        self.body = pb.loadURDF(str(urdf), useFixedBase=not floating, flags=flags)
        pb.setGravity(*gravity)
        info = [pb.getJointInfo(self.body, k) for k in range(pb.getNumJoints(self.body))]
        self.moving = [k[0] for k in info if k[2] != pb.JOINT_FIXED]
        names = [info[k][1].decode() for k in self.moving]
        self.links = {k[12].decode(): k[0] for k in info}
        self.writes = {
            "q": [*(BASE_Q if floating else ()), *names], "v": [*(LINEAR_FIRST if floating else ()), *names],
            "rows": LINEAR_FIRST, "angular": "world", "linear": "world",
        }  # fmt: skip

    def _set(self, q):
        q = [float(x) for x in q]
        if self.floating:  # what is set is the pose of the base's centre of mass
            local = self.pb.getDynamicsInfo(self.body, -1)[3:5]
            self.pb.resetBasePositionAndOrientation(self.body, *self.pb.multiplyTransforms(q[:3], q[3:7], *local))
            q = q[7:]
        for joint, x in zip(self.moving, q, strict=True):
            self.pb.resetJointState(self.body, joint, x)
        return q

    def fk(self, q, frame):
        self._set(q)
        state = self.pb.getLinkState(self.body, self.links[frame], computeForwardKinematics=1)
        x, y, z, w = state[5]
        return [*state[4], w, x, y, z]

    def jacobian(self, q, frame):
        q, zeros = self._set(q), [0.0] * len(self.moving)
        return np.vstack(self.pb.calculateJacobian(self.body, self.links[frame], [0, 0, 0], q, zeros, zeros))

    def rnea(self, q, v, a):
        self._set(q)
        given = [[float(x) for x in y] for y in (q, v, a)]
        tau = self.pb.calculateInverseDynamics(self.body, *given, *([1] if self.floating else []))
        if len(tau) != len(v):
            raise RuntimeError(f"{len(tau)} numbers for {len(v)} velocities")
        return tau

    def bias(self, q, v):
        return self.rnea(q, v, np.zeros_like(v))

    def gravity(self, q):
        still = np.zeros(len(self.writes["v"]))
        return self.rnea(q, still, still)

    def crba(self, q):
        return self.pb.calculateMassMatrix(self.body, self._set(q))
