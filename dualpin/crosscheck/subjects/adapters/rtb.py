"""Robotics Toolbox for Python: Robot.URDF, on a fixed base."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
from _urdf import LINEAR_FIRST, joints

REQUIRES = ("roboticstoolbox-python==1.5.0",)
CALLS = {
    "": "import os\nfrom roboticstoolbox import Robot\n"
    "r = Robot.URDF(os.path.abspath('robot.urdf')); r.gravity = [0, 0, -9.81]",
    "fk": "print(r.fkine(q, end=frame))",
    "jacobian": "print(r.jacob0(q, end=frame))",
    "gravity": "print(r.gravload(q))",
    "bias": "print(r.rne(q, v, 0 * v))",
    "rnea": "print(r.rne(q, v, a))",
    "crba": "print(r.inertia(q))",
    "coriolis": "print(r.coriolis(q, v))",
    "aba": "print(r.accel(q, v, tau))",
}
"""The same in the library's own words, for reports."""


class Subject:
    """One robot in the toolbox: linear first."""

    name = "rtb"
    calls = CALLS

    def __init__(self, urdf: str, floating: bool, gravity: Any) -> None:
        from roboticstoolbox import Robot

        if floating:
            raise NotImplementedError("no floating base")
        self.version = version("roboticstoolbox-python")
        self.r = Robot.URDF(str(urdf))
        self.r.gravity = np.asarray(gravity, float)
        joint_of = {child: name for name, _, child in joints(urdf)}
        driven = sorted((link for link in self.r.links if link.isjoint), key=lambda link: link.jindex)
        names = [joint_of[link.name] for link in driven]
        self.writes = {"q": names, "v": names, "rows": LINEAR_FIRST}
        self.links = {link.name for link in self.r.links}

    def fk(self, q: np.ndarray, frame: str) -> np.ndarray:
        if frame not in self.links:
            raise KeyError(frame)
        return np.asarray(self.r.fkine(q, end=frame).A)

    def jacobian(self, q: np.ndarray, frame: str) -> np.ndarray:
        J = np.zeros((6, self.r.n))
        J[:, [link.jindex for link in self.r.ets(end=frame).joints()]] = self.r.jacob0(q, end=frame)
        return J

    def rnea(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        return self.r.rne(q, v, a)

    def crba(self, q: np.ndarray) -> np.ndarray:
        return self.r.inertia(q)

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return self.r.rne(q, v, np.zeros_like(v))

    def coriolis(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return self.r.coriolis(q, v)

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return self.r.gravload(q)

    def aba(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        return self.r.accel(q, v, tau)
