"""The robotics toolbox: its recursive Newton-Euler, from Python.

Of a robot without fixed links: `rne` places several fixed links of one body one after another, and does not place a
joint that is on a fixed link.  It also adds the friction of <dynamics>, which is no part of the equations of motion.
"""

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

    urdf = folder / "merged.urdf"
    r = rtb.Robot.URDF(str(urdf))
    r.gravity = np.load(folder / "model.npz")["gravity"]
    joints = ET.parse(urdf).getroot().findall("joint")
    moves = {j.find("child").get("link"): j.get("name") for j in joints}  # type: ignore[union-attr]
    links = sorted((link for link in r.links if link.isjoint), key=lambda link: link.jindex)
    for link in links:
        if link.isflip:
            raise ValueError(f"{moves[link.name]}: axes along negative coordinates have torques of the wrong sign")
        link.B, link.Tc = 0.0, [0.0, 0.0]
    single = {"rnea": lambda q, v, a: r.rne(q, v, a), "crba": lambda q, v, a: r.inertia(q)}
    return {
        "version": version("roboticstoolbox-python"),
        "joints": [moves[link.name] for link in links],
        "single": single,
    }
