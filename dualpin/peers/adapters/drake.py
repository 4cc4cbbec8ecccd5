"""Drake's MultibodyPlant in double, without damping, from Python."""

from __future__ import annotations

import logging
import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("drake==1.51.1",)
MODULE = "pydrake"


def made(folder: Path) -> dict[str, Any]:
    import pydrake.all as pd

    logging.getLogger("drake").setLevel(logging.ERROR)
    p, urdf = pd.MultibodyPlant(0.0), folder / "robot.urdf"
    pd.Parser(p).AddModels(str(urdf))
    tree = ET.parse(urdf).getroot()
    children = {j.find("child").get("link") for j in tree.findall("joint")}  # type: ignore[union-attr]
    root = next(x.get("name") for x in tree.findall("link") if x.get("name") not in children)
    if root != "world":
        p.WeldFrames(p.world_frame(), p.GetFrameByName(root))
    p.mutable_gravity_field().set_gravity_vector(np.load(folder / "model.npz")["gravity"])
    for i in p.GetJointIndices():
        if p.get_joint(i).num_velocities() == 1:
            p.get_joint(i).set_default_damping(0.0)
    p.Finalize()
    c = p.CreateDefaultContext()
    axial = [p.get_joint(i) for i in p.GetJointIndices() if p.get_joint(i).num_velocities() == 1]
    forces, torques = pd.MultibodyForces(p), p.get_applied_generalized_force_input_port()
    accelerations = p.get_generalized_acceleration_output_port()

    def at(q: Any, v: Any) -> Any:
        p.SetPositions(c, q)
        p.SetVelocities(c, v)
        return c

    def rnea(q: Any, v: Any, a: Any) -> np.ndarray:
        at(q, v)
        forces.SetZero()
        p.CalcForceElementsContribution(c, forces)
        return p.CalcInverseDynamics(c, a, forces)

    def aba(q: Any, v: Any, tau: Any) -> np.ndarray:
        torques.FixValue(c, tau)
        return accelerations.Eval(at(q, v))

    return {
        "version": version("drake"), "joints": [j.name() for j in sorted(axial, key=lambda j: j.velocity_start())],
        "single": {"rnea": rnea, "aba": aba, "crba": lambda q, v, a: p.CalcMassMatrix(at(q, v))},
    }  # fmt: skip
