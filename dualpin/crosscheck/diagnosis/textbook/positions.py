"""Rates of positions, of which some are quaternions."""

from __future__ import annotations

import numpy as np

from ....model.robot import Robot
from ...subjects.layout import product, rotations
from .arrays import cross


def position_rates(robot: Robot, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """dq/dt (n, nq): of positions in the parent's axes, and of quaternions by q (0, w) / 2."""
    out = np.zeros_like(q)
    for j in robot:
        if j.mimic is not None:
            continue
        if j.model.additive:
            out[:, j.q] = v[:, j.v]
            continue
        x, u = q[:, j.q], v[:, j.v]
        if x.shape[1] == 7:
            w, r = x[:, 3:4], x[:, 4:]
            R = rotations(x[:, 3:])
            vector = w * u[:, :3] + cross(r, u[:, :3])
            scalar = -(r * u[:, :3]).sum(-1, keepdims=True)
            out[:, j.q] = np.concatenate([product(R, u[:, 3:]), scalar / 2, vector / 2], -1)
        else:  # planar
            s, c = np.sin(x[:, 2]), np.cos(x[:, 2])
            out[:, j.q] = np.stack([c * u[:, 0] - s * u[:, 1], s * u[:, 0] + c * u[:, 1], u[:, 2]], -1)
    return out
