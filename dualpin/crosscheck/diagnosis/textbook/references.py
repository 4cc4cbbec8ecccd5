"""Jacobians, twists and their rates at a frame in world axes, brought to other references."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arrays import cross
from .steps import Steps


def referred(
    steps: Steps, J: np.ndarray, R: np.ndarray, p: np.ndarray, reference: str, what: str = "the Jacobian"
) -> np.ndarray:  # fmt: skip
    """From the frame in world axes to a reference; J (..., 6, k), R (..., 3, 3), p (..., 3)."""
    rows = np.swapaxes(J, -1, -2)
    w, v = rows[..., :3], rows[..., 3:]
    if reference == "local":
        back = np.swapaxes(R, -1, -2)[..., None, :, :]
        w = steps.turn(f"{what}, in world axes: its angular part", back, w)
        v = steps.turn(f"{what}, in world axes: its linear part", back, v)
    elif reference == "world":
        terms = {"v": v, "p x w": cross(p[..., None, :] + 0 * w, w)}
        v = steps.add(f"the linear part of {what}, of the point at the world's origin", **terms)
    return np.swapaxes(six(w, v), -1, -2)


def referred_rate(
    steps: Steps, D: np.ndarray, J: np.ndarray, frame: Sequence[np.ndarray], reference: str
) -> np.ndarray:  # fmt: skip
    """The rate of `referred`, where D is that of J; `frame` is R, p, w, v of the frames."""
    R, p, w, v = frame
    if reference == "local":  # d/dt (R^T J) = R^T (D - w x J)
        rows = np.swapaxes(J, -1, -2)
        turning = six(*(cross(w[..., None, :] + 0 * x, x) for x in (rows[..., :3], rows[..., 3:])))
        terms = {"dJ/dt": D, "w x J, the turning of the frame": -np.swapaxes(turning, -1, -2)}
        D = steps.add("the rate of the local Jacobian", **terms)
    D = referred(steps, D, R, p, reference, "the rate of the Jacobian")
    if reference == "world":  # d/dt (v + p x w) = vd + p x wd + pd x w
        angular = np.swapaxes(J, -1, -2)[..., :3]
        rows = np.swapaxes(D, -1, -2)
        terms = {"that about a fixed point": rows[..., 3:], "dp/dt x w": cross(v[..., None, :] + 0 * angular, angular)}
        linear = steps.add("the rate of the world's Jacobian", **terms)
        D = np.swapaxes(six(rows[..., :3] + 0 * linear, linear), -1, -2)
    return D


def six(w: np.ndarray, v: np.ndarray) -> np.ndarray:
    """[w; v], of the last axis."""
    return joined([w, v], -1)


def joined(parts: Sequence[np.ndarray], axis: int) -> np.ndarray:
    """Concatenated, where some have fewer runs."""
    leads = {x.shape[:2] for x in parts}
    if len(leads) > 1:
        lead = np.broadcast_shapes(*leads)
        parts = [np.broadcast_to(x, (*lead, *x.shape[2:])) for x in parts]
    return np.concatenate(parts, axis)
