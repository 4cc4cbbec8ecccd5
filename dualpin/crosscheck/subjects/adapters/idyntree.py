"""iDynTree: KinDynComputations in the mixed representation, of the file's moving joints."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy as np
from _urdf import LINEAR_FIRST, homogeneous, joint_part, moving, rotation

REQUIRES = ("idyntree==15.1.0",)
BASE_Q = ("x", "y", "z", "qw", "qx", "qy", "qz")
PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")
CALLS = {
    "": "import idyntree.bindings as idt\nl = idt.ModelLoader(); l.loadModelFromFile('robot.urdf')\n"
    "k = idt.KinDynComputations(); k.loadRobotModel(l.model()); n = len(q)\n"
    "t, g = idt.FreeFloatingGeneralizedTorques(k.model()), np.array([0, 0, -9.81])  # on a fixed base",
    "fk": "k.setRobotState(q, 0 * q, g); print(k.getWorldTransform(frame))",
    "gravity": "k.setRobotState(q, 0 * q, g); k.generalizedGravityForces(t); print(t.jointTorques().toNumPy())",
    "bias": "k.setRobotState(q, v, g); k.generalizedBiasForces(t); print(t.jointTorques().toNumPy())",
    "crba": "k.setRobotState(q, 0 * q, g); M = idt.MatrixDynSize(n + 6, n + 6)\n"
    "k.getFreeFloatingMassMatrix(M); print(M)",
    "com": "k.setRobotState(q, 0 * q, g); print(k.getCenterOfMassPosition())",
    "jacobian": "k.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION); k.setRobotState(q, 0 * q, g)\n"
    "J = idt.MatrixDynSize(6, n + 6); k.getFrameFreeFloatingJacobian(frame, J); print(J.toNumPy()[:, 6:])",
    "com_jacobian": "k.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION); k.setRobotState(q, 0 * q, g)\n"
    "J = idt.MatrixDynSize(3, n + 6); k.getCenterOfMassJacobian(J); print(J.toNumPy()[:, 6:])",
    "centroidal_momentum_matrix": "k.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION)\n"
    "k.setRobotState(q, 0 * q, g); J = idt.MatrixDynSize(6, n + 6); k.getCentroidalTotalMomentumJacobian(J)\n"
    "print(J.toNumPy()[:, 6:])",
    "rnea": "k.setRobotState(q, v, g); w = idt.LinkWrenches(k.model()); w.zero()\n"
    "k.inverseDynamics(np.zeros(6), a, w, t); print(t.jointTorques().toNumPy())",
    "rnea_f_ext": "k.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION); k.setRobotState(q, v, g)\n"
    "w = idt.LinkWrenches(k.model()); w.zero(); b = k.model().getLinkIndex(frame)\n"
    "[w(b).setVal(i, x) for i, x in enumerate(f_ext.tolist())]\n"
    "k.inverseDynamics(np.zeros(6), a, w, t); print(t.jointTorques().toNumPy())",
    "coriolis": "k.setRobotState(q, v, g); C, M, D = (idt.MatrixDynSize(n + 6, n + 6) for _ in range(3))\n"
    "k.getCoriolisAndMassMatrices(C, M, D); print(C.toNumPy()[6:, 6:])",
    "joint_torque_regressor": "k.setRobotState(q, v, g); Y = idt.MatrixDynSize(n + 6, 10 * k.model().getNrOfLinks())\n"
    "k.inverseDynamicsInertialParametersRegressor(np.zeros(6), a, Y); print(Y.toNumPy()[6:])",
}
"""The same in the library's own words, for reports."""


class Subject:
    """One robot in iDynTree, whose base always floats: on a fixed base the joints' part is answered."""

    name = "idyntree"
    calls = CALLS

    def __init__(self, urdf: str, floating: bool, gravity: Any) -> None:
        import idyntree.bindings as idt

        self.idt, self.version, self.floating = idt, version("idyntree"), floating
        self.g = np.asarray(gravity, float)
        loader = idt.ModelLoader()
        if not loader.loadReducedModelFromFile(str(urdf), moving(urdf)):
            raise RuntimeError("loadReducedModelFromFile returned false")
        self.k = idt.KinDynComputations()
        self.k.loadRobotModel(loader.model())
        self.k.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION)
        m = self.k.model()
        names = [m.getJointName(j) for j in range(m.getNrOfJoints()) if m.getJoint(j).getNrOfDOFs() == 1]
        self.n = len(names)
        base_q, base_v = (BASE_Q, LINEAR_FIRST) if floating else ((), ())
        self.writes = {
            "q": [*base_q, *names], "v": [*base_v, *names], "rows": LINEAR_FIRST, "angular": "world", "linear": "world",
            "parameters": [f"{m.getLinkName(i)}.{p}" for i in range(m.getNrOfLinks()) for p in PARAMETERS],
        }  # fmt: skip

    def _set(self, q: np.ndarray, v: np.ndarray | None = None) -> None:
        H, s = (homogeneous(rotation(q[3:7]), q[:3]), q[7:]) if self.floating else (np.eye(4), q)
        v = np.zeros(self.n + 6) if v is None else (v if self.floating else np.r_[np.zeros(6), v])
        self._said(self.k.setRobotState(H, s, v[:6], v[6:], self.g), "setRobotState")

    @staticmethod
    def _said(yes: bool, what: str) -> None:
        if not yes:
            raise RuntimeError(f"{what} returned false")

    def _joints(self, x: Any, *axes: int) -> np.ndarray:
        return joint_part(x, self.floating, *axes)

    def _matrix(self, rows: int) -> Any:
        return self.idt.MatrixDynSize(rows, self.n + 6)

    def _torques(self, f: Callable[..., Any], *given: Any) -> np.ndarray:
        t = self.idt.FreeFloatingGeneralizedTorques(self.k.model())
        f(*given, t)
        return self._joints(np.r_[t.baseWrench().toNumPy(), t.jointTorques().toNumPy()], 0)

    def fk(self, q: np.ndarray, frame: str) -> np.ndarray:
        self._set(q)
        if self.k.getFrameIndex(frame) < 0:
            raise KeyError(frame)
        return self.k.getWorldTransform(frame).asHomogeneousTransform().toNumPy()

    def jacobian(self, q: np.ndarray, frame: str) -> np.ndarray:
        self._set(q)
        J = self._matrix(6)
        self._said(self.k.getFrameFreeFloatingJacobian(frame, J), f"getFrameFreeFloatingJacobian of {frame}")
        return self._joints(J.toNumPy(), 1)

    def rnea(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        self._set(q, v)
        a = a if self.floating else np.r_[np.zeros(6), a]
        return self._torques(self.k.inverseDynamics, a[:6].copy(), a[6:].copy(), self._outside())

    def _outside(self) -> Any:
        """No wrench on any link."""
        outside = self.idt.LinkWrenches(self.k.model())
        outside.zero()
        return outside

    def rnea_f_ext(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, f_ext: np.ndarray, frame: str) -> np.ndarray:
        self._set(q, v)
        a, link = a if self.floating else np.r_[np.zeros(6), a], self.k.model().getLinkIndex(frame)
        if link < 0:
            raise KeyError(frame)
        outside = self._outside()
        for i in range(6):
            outside(link).setVal(i, float(f_ext[i]))
        return self._torques(self.k.inverseDynamics, a[:6].copy(), a[6:].copy(), outside)

    def joint_torque_regressor(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        self._set(q, v)
        a = a if self.floating else np.r_[np.zeros(6), a]
        Y = self.idt.MatrixDynSize(self.n + 6, 10 * self.k.model().getNrOfLinks())
        done = self.k.inverseDynamicsInertialParametersRegressor(a[:6].copy(), a[6:].copy(), Y)
        self._said(done, "inverseDynamicsInertialParametersRegressor")
        return self._joints(Y.toNumPy(), 0)

    def crba(self, q: np.ndarray) -> np.ndarray:
        self._set(q)
        M = self._matrix(self.n + 6)
        self._said(self.k.getFreeFloatingMassMatrix(M), "getFreeFloatingMassMatrix")
        return self._joints(M.toNumPy(), 0, 1)

    def coriolis(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        self._set(q, v)
        C, M, D = (self._matrix(self.n + 6) for _ in range(3))
        self._said(self.k.getCoriolisAndMassMatrices(C, M, D), "getCoriolisAndMassMatrices")
        return self._joints(C.toNumPy(), 0, 1)

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        self._set(q, v)
        return self._torques(self.k.generalizedBiasForces)

    def gravity(self, q: np.ndarray) -> np.ndarray:
        self._set(q)
        return self._torques(self.k.generalizedGravityForces)

    def com(self, q: np.ndarray) -> np.ndarray:
        self._set(q)
        return self.k.getCenterOfMassPosition().toNumPy()

    def com_jacobian(self, q: np.ndarray) -> np.ndarray:
        self._set(q)
        J = self._matrix(3)
        self._said(self.k.getCenterOfMassJacobian(J), "getCenterOfMassJacobian")
        return self._joints(J.toNumPy(), 1)

    def centroidal_momentum_matrix(self, q: np.ndarray) -> np.ndarray:
        self._set(q)
        J = self._matrix(6)
        self._said(self.k.getCentroidalTotalMomentumJacobian(J), "getCentroidalTotalMomentumJacobian")
        return self._joints(J.toNumPy(), 1)
