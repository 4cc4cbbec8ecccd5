"""Robots and starts of these tests."""

from __future__ import annotations

from functools import cache

import numpy as np

import dualpin as dp
from dualpin.model import Builder, Robot, prismatic, revolute
from dualpin.spatial import UX, UY, Inertia, Pose, Vector3, diagonal

PA10_START = np.radians([0.0, 30.0, 0.0, 60.0, 0.0, 60.0, 0.0])


@cache
def pa10() -> Robot:
    """Mitsubishi PA-10: standard rows, alpha (-90, 90, -90, 90, -90, 90, 0) deg, a = 0, d in m."""
    d = (0.317, 0.0, 0.450, 0.0, 0.480, 0.0, 0.070)
    alpha = np.radians([-90, 90, -90, 90, -90, 90, 0])
    rows = [(0.0, d_, 0.0, alpha_) for d_, alpha_ in zip(d, alpha, strict=True)]
    return dp.from_dh(rows, joints="RRRRRRR", convention="standard")


@cache
def double_pendulum() -> Robot:
    """Two equal rods in a vertical plane."""
    rod = Inertia(1.0, Vector3(0.5, 0.0, 0.0), diagonal(1.0 / 3.0))
    b = Builder("double_pendulum")
    b.joint("upper", revolute(UY), inertia=rod)
    b.joint("lower", revolute(UY), on="upper", placement=Pose(position=Vector3(1.0, 0.0, 0.0)), inertia=rod)
    return b.robot()


@cache
def slider() -> Robot:
    """Two prismatic joints without limits: its tip moves in a plane, its reach has no bound."""
    b = Builder("slider")
    b.joint("x", prismatic(UX))
    b.joint("y", prismatic(UY), on="x")
    return b.robot()
