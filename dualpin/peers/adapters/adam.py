"""adam with its NumPy backend, from Python: M a + h for inverse dynamics."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("adam-robotics==0.5.0",)
MODULE = "adam"


def made(folder: Path) -> dict[str, Any]:
    from adam.numpy import KinDynComputations

    urdf = folder / "robot.urdf"
    names = [j.get("name", "") for j in ET.parse(urdf).getroot().findall("joint") if j.get("type") != "fixed"]
    gravity = np.r_[np.load(folder / "model.npz")["gravity"], 0.0, 0.0, 0.0]
    k, base, still = KinDynComputations(str(urdf), names, gravity=gravity), np.eye(4), np.zeros(6)

    def crba(q: Any, v: Any, a: Any) -> np.ndarray:
        return k.mass_matrix(base, q)[6:, 6:]

    def rnea(q: Any, v: Any, a: Any) -> np.ndarray:
        return crba(q, v, a) @ a + np.ravel(k.bias_force(base, q, still, v))[6:]

    return {"version": version("adam-robotics"), "joints": names, "single": {"crba": crba, "rnea": rnea}}
