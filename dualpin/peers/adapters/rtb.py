"""The robotics toolbox: its recursive Newton-Euler, from Python."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("roboticstoolbox-python==1.5.0",)
MODULE = "roboticstoolbox"


def made(folder: Path) -> dict[str, Any]:
    import roboticstoolbox as rtb

    r = rtb.Robot.URDF(str(folder / "robot.urdf"))
    r.gravity = np.load(folder / "model.npz")["gravity"]
    joints = ET.parse(folder / "robot.urdf").getroot().findall("joint")
    moves = {j.find("child").get("link"): j.get("name") for j in joints}  # type: ignore[union-attr]
    links = sorted((link for link in r.links if link.isjoint), key=lambda link: link.jindex)
    single = {"rnea": lambda q, v, a: r.rne(q, v, a), "crba": lambda q, v, a: r.inertia(q)}
    return {
        "version": version("roboticstoolbox-python"),
        "joints": [moves[link.name] for link in links],
        "single": single,
    }
