"""dynibo (Rust), from Python."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("dynibo==0.5.2", "numpy")
MODULE = "dynibo"


def breadth_first(urdf: Path) -> list[str]:
    """Its order of joints, which it does not tell."""
    joints = ET.parse(urdf).getroot().findall("joint")
    ends = [(j, j.find("parent").get("link"), j.find("child").get("link")) for j in joints]  # type: ignore[union-attr]
    links = [parent for _, parent, _ in ends if parent not in {child for *_, child in ends}][:1]
    found = []
    for link in links:  # which grows
        for j, parent, child in ends:
            if parent == link:
                links.append(child)
                found += [j.get("name", "")] if j.get("type") != "fixed" else []
    return found


def made(folder: Path) -> dict[str, Any]:
    import dynibo

    urdf = folder / "robot.urdf"
    r = dynibo.Robot.from_urdf(str(urdf))
    single = {
        "rnea": lambda q, v, a: r.inverse_dynamics(q, v, a), "aba": lambda q, v, tau: r.forward_dynamics(q, v, tau),
        "crba": lambda q, v, a: np.reshape(r.mass_matrix(q), (len(q), len(q))),
    }  # fmt: skip
    gravity = [0.0, 0.0, -9.80665]  # its own, which nothing changes
    return {"version": version("dynibo"), "joints": breadth_first(urdf), "single": single, "gravity": gravity}
