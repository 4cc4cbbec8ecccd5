"""dynibo (Rust), from Python."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("dynibo==0.5.2", "numpy")
MODULE = "dynibo"


def made(folder: Path) -> dict[str, Any]:
    import dynibo

    urdf = folder / "robot.urdf"
    r = dynibo.Robot.from_urdf(str(urdf))
    names = [j.get("name", "") for j in ET.parse(urdf).getroot().findall("joint") if j.get("type") != "fixed"]
    single = {
        "rnea": lambda q, v, a: r.inverse_dynamics(q, v, a), "aba": lambda q, v, tau: r.forward_dynamics(q, v, tau),
        "crba": lambda q, v, a: np.reshape(r.mass_matrix(q), (len(q), len(q))),
    }  # fmt: skip
    gravity = [0.0, 0.0, -9.80665]  # its own, which nothing changes
    return {"version": version("dynibo"), "joints": names, "single": single, "gravity": gravity}
