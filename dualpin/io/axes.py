"""Directions of joints as numbers of a file give them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..dual import sqrt
from ..scalars import exact
from ..spatial.vector import AXES, Vector3

TOLERANCE = 1e-12  # Pinocchio's: closer than this to a coordinate axis is that axis


def unit_axis(xyz: Any) -> Vector3:
    """The unit vector of three numbers; a coordinate axis exactly where it is one to 1e-12."""
    u = np.array([1.0, 0.0, 0.0] if xyz is None else xyz, dtype=float)
    largest = float(np.abs(u).max())
    if not 1e-100 < largest < 1e100:
        u = u / largest  # squares would overflow
    for unit, exact_axis in zip(np.eye(3), AXES, strict=True):
        for sign in (1, -1):
            if np.linalg.norm(u - sign * unit) <= TOLERANCE:
                return exact_axis if sign == 1 else -exact_axis
    axis = Vector3(*map(exact, u.tolist()))
    return Vector3(*map(exact, axis / sqrt(float(u @ u))))
