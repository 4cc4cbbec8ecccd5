"""Pinocchio, as its Python binding writes: linear first, quaternions x y z w, the base's twist in its own axes."""

from __future__ import annotations

from typing import Any

import numpy as np

REQUIRES = ("pin==4.1.0",)
BASE_Q = ("x", "y", "z", "qx", "qy", "qz", "qw")
BASE_V = ("vx", "vy", "vz", "wx", "wy", "wz")
PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
CALLS = {
    "": "import pinocchio as pin\nm = pin.buildModelFromUrdf('robot.urdf'); d = m.createData()",
    "fk": "pin.framesForwardKinematics(m, d, q); print(d.oMf[m.getBodyId(frame)])",
    "gravity": "print(pin.computeGeneralizedGravity(m, d, q))",
    "bias": "print(pin.nonLinearEffects(m, d, q, v))",
    "rnea": "print(pin.rnea(m, d, q, v, a))",
    "aba": "print(pin.aba(m, d, q, v, tau))",
    "crba": "print(pin.crba(m, d, q))",
    "coriolis": "print(pin.computeCoriolisMatrix(m, d, q, v))",
    "com": "print(pin.centerOfMass(m, d, q))",
    "jacobian": "print(pin.computeFrameJacobian(m, d, q, m.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED))",
    "jacobian_dot": "pin.computeJointJacobiansTimeVariation(m, d, q, v); pin.updateFramePlacements(m, d)\n"
    "print(pin.getFrameJacobianTimeVariation(m, d, m.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED))",
    "frame_velocity": "pin.forwardKinematics(m, d, q, v)\n"
    "print(pin.getFrameVelocity(m, d, m.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED))",
    "frame_acceleration": "pin.forwardKinematics(m, d, q, v, a)\n"
    "print(pin.getFrameClassicalAcceleration(m, d, m.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED))",
    "com_jacobian": "print(pin.jacobianCenterOfMass(m, d, q))",
    "centroidal_momentum_matrix": "print(pin.computeCentroidalMap(m, d, q))",
    "kinetic_energy": "print(pin.computeKineticEnergy(m, d, q, v))",
    "potential_energy": "print(pin.computePotentialEnergy(m, d, q))",
    "minv": "print(pin.computeMinverse(m, d, q))",
    "rnea_f_ext": "J = pin.computeFrameJacobian(m, d, q, m.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED)\n"
    "print(pin.rnea(m, d, q, v, a) - J.T @ f_ext)",
    "aba_f_ext": "J = pin.computeFrameJacobian(m, d, q, m.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED)\n"
    "print(pin.aba(m, d, q, v, tau + J.T @ f_ext))",
    "joint_torque_regressor": "print(pin.computeJointTorqueRegressor(m, d, q, v, a))",
    "rnea_derivatives": "print(*pin.computeRNEADerivatives(m, d, q, v, a)[:3])",
    "aba_derivatives": "print(*pin.computeABADerivatives(m, d, q, v, tau)[:3])",
}
"""The same in the library's own words, for reports."""


class Subject:
    """One robot in Pinocchio."""

    name = "pinocchio"
    calls = CALLS

    def __init__(self, urdf: str, floating: bool, gravity: Any) -> None:
        import pinocchio as pin  # here, so that this file can be read without it

        self.pin, self.version = pin, pin.__version__
        root = (pin.JointModelFreeFlyer(),) if floating else ()
        self.m = pin.buildModelFromUrdf(urdf, *root)
        self.m.gravity.linear = np.asarray(gravity, float)
        self.d = self.m.createData()
        self.axial = [j for j in list(self.m.joints)[1:] if j.nv == 1]
        joints = [self.m.names[j.id] for j in self.axial]
        base_q, base_v = (BASE_Q, BASE_V) if floating else ((), ())
        self.writes = {
            "q": [*base_q, *joints], "v": [*base_v, *joints], "rows": BASE_V,
            "parameters": [f"{self._link(i)}.{p}" for i in range(1, self.m.njoints) for p in PARAMETERS],
        }  # fmt: skip
        self.base = 7 if floating else 0

    def _link(self, joint: int) -> str:
        """The link whose frame is the joint's."""
        bodies = (f for f in self.m.frames if f.type == self.pin.BODY and f.parentJoint == joint)
        return str(next((f.name for f in bodies if f.placement.isIdentity()), self.m.names[joint]))

    def _q(self, q: np.ndarray) -> np.ndarray:
        """Continuous joints are pairs (cos, sin) in Pinocchio."""
        out = np.zeros(self.m.nq)
        out[: self.base] = q[: self.base]
        for j, x in zip(self.axial, q[self.base :], strict=True):
            out[j.idx_q : j.idx_q + j.nq] = x if j.nq == 1 else (np.cos(x), np.sin(x))
        return out

    def _frame(self, frame: str) -> int:
        if not self.m.existBodyName(frame):
            raise KeyError(frame)
        return int(self.m.getBodyId(frame))

    def fk(self, q: np.ndarray, frame: str) -> np.ndarray:
        self.pin.framesForwardKinematics(self.m, self.d, self._q(q))
        return np.array(self.d.oMf[self._frame(frame)].homogeneous)

    def jacobian(self, q: np.ndarray, frame: str) -> np.ndarray:
        self.pin.computeJointJacobians(self.m, self.d, self._q(q))
        self.pin.updateFramePlacements(self.m, self.d)
        return np.array(self.pin.getFrameJacobian(self.m, self.d, self._frame(frame), self.pin.LOCAL_WORLD_ALIGNED))

    def jacobian_dot(self, q: np.ndarray, v: np.ndarray, frame: str) -> np.ndarray:
        self.pin.computeJointJacobiansTimeVariation(self.m, self.d, self._q(q), v)
        self.pin.updateFramePlacements(self.m, self.d)
        at = self.pin.LOCAL_WORLD_ALIGNED
        return np.array(self.pin.getFrameJacobianTimeVariation(self.m, self.d, self._frame(frame), at))

    def frame_velocity(self, q: np.ndarray, v: np.ndarray, frame: str) -> np.ndarray:
        self.pin.forwardKinematics(self.m, self.d, self._q(q), v)
        self.pin.updateFramePlacements(self.m, self.d)
        return np.array(
            self.pin.getFrameVelocity(self.m, self.d, self._frame(frame), self.pin.LOCAL_WORLD_ALIGNED).vector
        )

    def frame_acceleration(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, frame: str) -> np.ndarray:
        self.pin.forwardKinematics(self.m, self.d, self._q(q), v, a)
        self.pin.updateFramePlacements(self.m, self.d)
        at = self.pin.LOCAL_WORLD_ALIGNED
        return np.array(self.pin.getFrameClassicalAcceleration(self.m, self.d, self._frame(frame), at).vector)

    def rnea(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        return np.array(self.pin.rnea(self.m, self.d, self._q(q), v, a))

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array(self.pin.nonLinearEffects(self.m, self.d, self._q(q), v))

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return np.array(self.pin.computeGeneralizedGravity(self.m, self.d, self._q(q)))

    def crba(self, q: np.ndarray) -> np.ndarray:
        return self._whole(self.pin.crba(self.m, self.d, self._q(q)))

    def minv(self, q: np.ndarray) -> np.ndarray:
        return self._whole(self.pin.computeMinverse(self.m, self.d, self._q(q)))

    @staticmethod
    def _whole(x: np.ndarray) -> np.ndarray:
        """A symmetric matrix of which Pinocchio fills the upper triangle."""
        return np.array(np.triu(x) + np.triu(x, 1).T)

    def coriolis(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array(self.pin.computeCoriolisMatrix(self.m, self.d, self._q(q), v))

    def aba(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        return np.array(self.pin.aba(self.m, self.d, self._q(q), v, tau))

    def com(self, q: np.ndarray) -> np.ndarray:
        return np.array(self.pin.centerOfMass(self.m, self.d, self._q(q)))

    def com_jacobian(self, q: np.ndarray) -> np.ndarray:
        return np.array(self.pin.jacobianCenterOfMass(self.m, self.d, self._q(q)))

    def centroidal_momentum_matrix(self, q: np.ndarray) -> np.ndarray:
        return np.array(self.pin.computeCentroidalMap(self.m, self.d, self._q(q)))

    def kinetic_energy(self, q: np.ndarray, v: np.ndarray) -> float:
        return float(self.pin.computeKineticEnergy(self.m, self.d, self._q(q), v))

    def potential_energy(self, q: np.ndarray) -> float:
        return float(self.pin.computePotentialEnergy(self.m, self.d, self._q(q)))

    def _wrenches(self, q: np.ndarray, f_ext: np.ndarray, frame: str) -> Any:
        """A wrench at a frame in world axes, as one on its joint in the joint's own."""
        self.pin.framesForwardKinematics(self.m, self.d, self._q(q))
        f = self._frame(frame)
        joint, at = self.m.frames[f].parentJoint, self.pin.SE3(np.eye(3), self.d.oMf[f].translation)
        forces = [self.pin.Force.Zero() for _ in range(self.m.njoints)]
        forces[joint] = self.d.oMi[joint].actInv(at.act(self.pin.Force(f_ext)))
        return self.pin.StdVec_Force(forces)

    def rnea_f_ext(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, f_ext: np.ndarray, frame: str) -> np.ndarray:
        return np.array(self.pin.rnea(self.m, self.d, self._q(q), v, a, self._wrenches(q, f_ext, frame)))

    def aba_f_ext(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray, f_ext: np.ndarray, frame: str) -> np.ndarray:
        return np.array(self.pin.aba(self.m, self.d, self._q(q), v, tau, self._wrenches(q, f_ext, frame)))

    def joint_torque_regressor(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        return np.array(self.pin.computeJointTorqueRegressor(self.m, self.d, self._q(q), v, a)).reshape(self.m.nv, -1)

    def rnea_derivatives(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        by_q, by_v, M = self.pin.computeRNEADerivatives(self.m, self.d, self._q(q), v, a)[:3]
        return np.array([by_q, by_v, self._whole(M)])

    def aba_derivatives(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        by_q, by_v, W = self.pin.computeABADerivatives(self.m, self.d, self._q(q), v, tau)[:3]
        return np.array([by_q, by_v, self._whole(W)])
