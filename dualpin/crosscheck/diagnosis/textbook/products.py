"""Cross products of six-vectors, [angular; linear].

References: Featherstone, Rigid Body Dynamics Algorithms (2008), equations 2.31 and 2.32.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .steps import Steps, cross

LINEAR = "the product of the linear velocity"


def crm(steps: Steps, site: str, v: np.ndarray, m: np.ndarray) -> np.ndarray:
    """v x m of motions."""
    w, u, a, b = v[..., :3], v[..., 3:], m[..., :3], m[..., 3:]
    parts = {"w x the linear part": cross(w, b), LINEAR: cross(u, a)}
    linear = steps.add(f"the linear part of v x: in {site}", **parts)
    angular = steps.add(f"the angular part of v x: in {site}", **{"w x the angular part": cross(w, a)})
    x = np.concatenate(np.broadcast_arrays(angular, linear), -1)
    others: dict[str, Any] = {
        "with the other sign": -x, "that of forces, v x*": lambda: crf(Steps(), "", v, m),
        "its transpose, v x^T": lambda: -crf(Steps(), "", v, m),
    }  # fmt: skip
    return np.asarray(steps.pick(f"the cross product of motions, v x: in {site}", x, **others))


def crf(steps: Steps, site: str, v: np.ndarray, f: np.ndarray) -> np.ndarray:
    """v x* f of forces."""
    w, u, n, b = v[..., :3], v[..., 3:], f[..., :3], f[..., 3:]
    parts = {"w x the moment": cross(w, n), LINEAR: cross(u, b)}
    angular = steps.add(f"the angular part of v x*: in {site}", **parts)
    linear = steps.add(f"the linear part of v x*: in {site}", **{"w x the force": cross(w, b)})
    x = np.concatenate(np.broadcast_arrays(angular, linear), -1)
    others: dict[str, Any] = {
        "with the other sign": -x, "that of motions, v x": lambda: crm(Steps(), "", v, f),
        "its transpose, v x*^T": lambda: -crm(Steps(), "", v, f),
    }  # fmt: skip
    return np.asarray(steps.pick(f"the cross product of forces, v x*: in {site}", x, **others))
