"""Drake: MultibodyPlant, with its force elements (the file's joint damping) in inverse and forward dynamics.

The option "clean" sets the damping to zero.
"""

from __future__ import annotations

import logging
from importlib.metadata import version
from typing import Any

import numpy as np
from _urdf import root

REQUIRES = ("drake==1.51.1",)
BASE_Q, BASE_V = ("qw", "qx", "qy", "qz", "x", "y", "z"), ("wx", "wy", "wz", "vx", "vy", "vz")
CALLS = {
    "": "import pydrake.all as pd\np = pd.MultibodyPlant(0.0)\npd.Parser(p).AddModels('robot.urdf')\n"
    "p.Finalize(); c = p.CreateDefaultContext(); f = pd.MultibodyForces(p)  # weld a root that is not the world",
    "fk": "p.SetPositions(c, q); print(p.EvalBodyPoseInWorld(c, p.GetBodyByName(frame)).GetAsMatrix4())",
    "gravity": "p.SetPositions(c, q); print(-p.CalcGravityGeneralizedForces(c))",
    "bias": "p.SetPositions(c, q); p.SetVelocities(c, v); print(p.CalcBiasTerm(c) - p.CalcGravityGeneralizedForces(c))",
    "rnea": "p.SetPositions(c, q); p.SetVelocities(c, v); p.CalcForceElementsContribution(c, f)\n"
    "print(p.CalcInverseDynamics(c, a, f))",
    "crba": "p.SetPositions(c, q); print(p.CalcMassMatrix(c))",
    "com": "p.SetPositions(c, q); print(p.CalcCenterOfMassPositionInWorld(c))",
    "jacobian": "p.SetPositions(c, q); w, o = p.world_frame(), np.zeros(3); b = p.GetFrameByName(frame)\n"
    "print(p.CalcJacobianSpatialVelocity(c, pd.JacobianWrtVariable.kV, b, o, w, w))",
    "frame_velocity": "p.SetPositions(c, q); p.SetVelocities(c, v)\n"
    "print(p.EvalBodySpatialVelocityInWorld(c, p.GetBodyByName(frame)).get_coeffs())",
    "com_jacobian": "p.SetPositions(c, q); w = p.world_frame()\n"
    "print(p.CalcJacobianCenterOfMassTranslationalVelocity(c, pd.JacobianWrtVariable.kV, w, w))",
    "centroidal_momentum_matrix": "p.SetPositions(c, q); o, A = p.CalcCenterOfMassPositionInWorld(c), []\n"
    "for e in np.eye(len(q)):\n    p.SetVelocities(c, e)\n"
    "    A.append(p.CalcSpatialMomentumInWorldAboutPoint(c, o).get_coeffs())\nprint(np.transpose(A))",
    "kinetic_energy": "p.SetPositions(c, q); p.SetVelocities(c, v); print(p.CalcKineticEnergy(c))",
    "potential_energy": "p.SetPositions(c, q); print(p.CalcPotentialEnergy(c))",
    "aba": "p.SetPositions(c, q); p.SetVelocities(c, v)\n"
    "p.get_applied_generalized_force_input_port().FixValue(c, tau)\n"
    "print(p.get_generalized_acceleration_output_port().Eval(c))",
    "rnea_f_ext": "p.SetPositions(c, q); p.SetVelocities(c, v); p.CalcForceElementsContribution(c, f)\n"
    "w = pd.SpatialForce(f_ext[:3], f_ext[3:]); p.GetBodyByName(frame).AddInForceInWorld(c, w, f)\n"
    "print(p.CalcInverseDynamics(c, a, f))",
    "rnea_derivatives": "p, n = p.ToAutoDiffXd(), len(q); x = pd.InitializeAutoDiff(np.r_[q, v, a])[:, 0]\n"
    "c, f = p.CreateDefaultContext(), pd.MultibodyForces_[pd.AutoDiffXd](p)\n"
    "p.SetPositions(c, x[:n]); p.SetVelocities(c, x[n : 2 * n]); p.CalcForceElementsContribution(c, f)\n"
    "print(pd.ExtractGradient(p.CalcInverseDynamics(c, x[2 * n :], f)))  # by q, by v, by a",
}
"""The same in the library's own words, for reports."""


class Subject:
    """One robot in Drake: angular first, the base's velocity in world axes."""

    name = "drake"
    calls = CALLS

    def __init__(self, urdf: str, floating: bool, gravity: Any, option: str = "") -> None:
        import pydrake.all as pd

        logging.getLogger("drake").setLevel(logging.ERROR)
        self.pd, self.version = pd, version("drake")
        p = self.p = pd.MultibodyPlant(0.0)
        pd.Parser(p).AddModels(urdf)
        if not floating and root(urdf) != "world":
            p.WeldFrames(p.world_frame(), p.GetFrameByName(root(urdf)))
        p.mutable_gravity_field().set_gravity_vector(np.asarray(gravity, float))
        all_joints = [p.get_joint(i) for i in p.GetJointIndices()]
        for joint in all_joints if option == "clean" else ():
            if joint.num_velocities() == 1 and hasattr(joint, "set_default_damping"):
                joint.set_default_damping(0.0)
        p.Finalize()
        self.c = p.CreateDefaultContext()
        axial = [p.get_joint(i) for i in p.GetJointIndices() if p.get_joint(i).num_velocities() == 1]
        names = [j.name() for j in sorted(axial, key=lambda j: j.velocity_start())]
        self.writes = {
            "q": [*(BASE_Q if floating else ()), *names], "v": [*(BASE_V if floating else ()), *names],
            "angular": "world", "linear": "world",
        }  # fmt: skip
        self.floating = floating
        self.auto: Any = None
        self.forces, self.world, self.wrt = pd.MultibodyForces(p), p.world_frame(), pd.JacobianWrtVariable.kV

    def _at(self, q: Any, v: Any = None) -> Any:
        self.p.SetPositions(self.c, q)
        self.p.SetVelocities(self.c, np.zeros(self.p.num_velocities()) if v is None else v)
        return self.c

    def fk(self, q: np.ndarray, frame: str) -> np.ndarray:
        return self.p.EvalBodyPoseInWorld(self._at(q), self.p.GetBodyByName(frame)).GetAsMatrix4()

    def jacobian(self, q: np.ndarray, frame: str) -> np.ndarray:
        at = self.p.GetFrameByName(frame)
        return self.p.CalcJacobianSpatialVelocity(self._at(q), self.wrt, at, np.zeros(3), self.world, self.world)

    def frame_velocity(self, q: np.ndarray, v: np.ndarray, frame: str) -> np.ndarray:
        return self.p.EvalBodySpatialVelocityInWorld(self._at(q, v), self.p.GetBodyByName(frame)).get_coeffs()

    def rnea(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        c = self._at(q, v)
        self.forces.SetZero()
        self.p.CalcForceElementsContribution(c, self.forces)
        return self.p.CalcInverseDynamics(c, a, self.forces)

    def rnea_f_ext(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, f_ext: np.ndarray, frame: str) -> np.ndarray:
        c, body, pd = self._at(q, v), self.p.GetBodyByName(frame), self.pd
        self.forces.SetZero()
        self.p.CalcForceElementsContribution(c, self.forces)
        body.AddInForceInWorld(c, pd.SpatialForce(tau=f_ext[:3], f=f_ext[3:]), self.forces)
        return self.p.CalcInverseDynamics(c, a, self.forces)

    def rnea_derivatives(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """By automatic differentiation, of a plant whose base does not float."""
        if self.floating:
            raise NotImplementedError("of a fixed base only")
        if self.auto is None:
            self.auto = self.p.ToAutoDiffXd()
        p, n = self.auto, len(v)
        x = self.pd.InitializeAutoDiff(np.r_[q, v, a])[:, 0]
        c, forces = p.CreateDefaultContext(), self.pd.MultibodyForces_[self.pd.AutoDiffXd](p)
        p.SetPositions(c, x[:n])
        p.SetVelocities(c, x[n : 2 * n])
        p.CalcForceElementsContribution(c, forces)
        tau = p.CalcInverseDynamics(c, x[2 * n :], forces)
        return self.pd.ExtractGradient(tau).reshape(n, 3, n).transpose(1, 0, 2)

    def crba(self, q: np.ndarray) -> np.ndarray:
        return self.p.CalcMassMatrix(self._at(q))

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        c = self._at(q, v)
        return self.p.CalcBiasTerm(c) - self.p.CalcGravityGeneralizedForces(c)

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return -self.p.CalcGravityGeneralizedForces(self._at(q))

    def aba(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        self.p.get_applied_generalized_force_input_port().FixValue(self.c, tau)
        return self.p.get_generalized_acceleration_output_port().Eval(self._at(q, v))

    def com(self, q: np.ndarray) -> np.ndarray:
        return self.p.CalcCenterOfMassPositionInWorld(self._at(q))

    def com_jacobian(self, q: np.ndarray) -> np.ndarray:
        return self.p.CalcJacobianCenterOfMassTranslationalVelocity(self._at(q), self.wrt, self.world, self.world)

    def centroidal_momentum_matrix(self, q: np.ndarray) -> np.ndarray:
        at, units = self.com(q), np.eye(self.p.num_velocities())
        momenta = (self.p.CalcSpatialMomentumInWorldAboutPoint(self._at(q, e), at).get_coeffs() for e in units)
        return np.stack(list(momenta), axis=1)

    def kinetic_energy(self, q: np.ndarray, v: np.ndarray) -> float:
        return float(self.p.CalcKineticEnergy(self._at(q, v)))

    def potential_energy(self, q: np.ndarray) -> float:
        return float(self.p.CalcPotentialEnergy(self._at(q)))
