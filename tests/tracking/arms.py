"""Robots of these tests."""

from __future__ import annotations

from functools import cache

import numpy as np

from dualpin.model import Robot


@cache
def pa10() -> Robot:
    """Mitsubishi PA-10, seven revolute joints: standard rows alpha (-90, 90, ...), a = 0, d in metres."""
    from dualpin.dual import Dual
    from dualpin.model import Builder, revolute
    from dualpin.spatial import Pose
    from dualpin.scalars import ONE, ZERO, exact
    from dualpin.spatial import Rotation, Vector3

    b = Builder("pa10")
    T, on = Pose(), None
    for i, (d, alpha) in enumerate(zip((0.317, 0, 0.45, 0, 0.48, 0, 0.07), (-1, 1, -1, 1, -1, 1, 0), strict=True)):
        b.joint(f"j{i+1}", revolute(), on=on, placement=T)
        R = Rotation(Vector3(ONE, ZERO, ZERO), Vector3(ZERO, exact(1 - abs(alpha)), exact(-alpha)), Vector3(ZERO, exact(alpha), exact(1 - abs(alpha))))
        T, on = Pose(R, Vector3(ZERO, ZERO, exact(d))), f"j{i+1}"
    b.frame("tip", on=on, placement=T)
    return b.robot()
