"""iDynTree's KinDynComputations from Python."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("idyntree==15.1.0",)
MODULE = "idyntree"


def made(folder: Path) -> dict[str, Any]:
    import idyntree.bindings as idt

    urdf = folder / "robot.urdf"
    moving = [j.get("name", "") for j in ET.parse(urdf).getroot().findall("joint") if j.get("type") != "fixed"]
    loader = idt.ModelLoader()
    if not loader.loadReducedModelFromFile(str(urdf), moving):
        raise RuntimeError("loadReducedModelFromFile returned false")
    k = idt.KinDynComputations()
    k.loadRobotModel(loader.model())
    k.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION)
    m = k.model()
    names = [m.getJointName(j) for j in range(m.getNrOfJoints()) if m.getJoint(j).getNrOfDOFs() == 1]
    n, base, still, g = len(names), np.eye(4), np.zeros(6), np.load(folder / "model.npz")["gravity"]
    acceleration, outer = idt.Vector6(), idt.LinkWrenches(m)
    acceleration.zero()
    torques, joints, M = idt.FreeFloatingGeneralizedTorques(m), idt.VectorDynSize(n), idt.MatrixDynSize(n + 6, n + 6)
    outer.zero()

    def rnea(q: Any, v: Any, a: Any) -> np.ndarray:
        k.setRobotState(base, q, still, v, g)
        for i, x in enumerate(a):
            joints.setVal(i, float(x))
        k.inverseDynamics(acceleration, joints, outer, torques)
        return torques.jointTorques().toNumPy()

    def crba(q: Any, v: Any, a: Any) -> np.ndarray:
        k.setRobotState(base, q, still, v, g)
        k.getFreeFloatingMassMatrix(M)
        return M.toNumPy()[6:, 6:]

    return {"version": version("idyntree"), "joints": names, "single": {"rnea": rnea, "crba": crba}}
