"""Cross products of vectors as matrices, and of six-vectors, [angular; linear].

References: Featherstone, Rigid Body Dynamics Algorithms (2008), equations 2.23, 2.31 and 2.32.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product
from .steps import Steps, cross

LINEAR = "the product of the linear velocity"
SKEW = "[r x], the matrix of a cross product,"


def _flipped(i: int, j: int) -> np.ndarray:
    weights = np.ones((3, 3))
    weights[i, j] = -1.0
    return weights


_SKEWED = {
    f"that with its entry in row {i + 1}, column {j + 1} of the other sign": _flipped(i, j)
    for i in range(3) for j in range(3) if i != j
} | {"its transpose": -np.ones((3, 3))}  # fmt: skip


def skew(steps: Steps, r: np.ndarray) -> np.ndarray:
    """[r x]."""
    K = cross_matrix(r)
    return np.asarray(steps.pick(SKEW, K, **{what: (lambda w=w: w * K) for what, w in _SKEWED.items()}))


def vector(K: np.ndarray) -> np.ndarray:
    """r of [r x]."""
    return np.stack([K[..., 2, 1], K[..., 0, 2], K[..., 1, 0]], -1)


def wedge(steps: Steps, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """[a x] b."""
    others = {what: (lambda w=w: product(w * cross_matrix(a), b)) for what, w in _SKEWED.items()}
    return np.asarray(steps.pick(SKEW, cross(a, b), **others))


def crm(steps: Steps, site: str, v: np.ndarray, m: np.ndarray) -> np.ndarray:
    """v x m of motions."""
    w, u, a, b = v[..., :3], v[..., 3:], m[..., :3], m[..., 3:]
    parts = {"w x the linear part": wedge(steps, w, b), LINEAR: wedge(steps, u, a)}
    linear = steps.add(f"the linear part of v x: in {site}", **parts)
    angular = steps.add(f"the angular part of v x: in {site}", **{"w x the angular part": wedge(steps, w, a)})
    x = np.concatenate(np.broadcast_arrays(angular, linear), -1)
    others: dict[str, Any] = {
        "with the other sign": -x, "that of forces, v x*": lambda: crf(Steps(), "", v, m),
        "its transpose, v x^T": lambda: -crf(Steps(), "", v, m),
    }  # fmt: skip
    return np.asarray(steps.pick(f"the cross product of motions, v x: in {site}", x, **others))


def crf(steps: Steps, site: str, v: np.ndarray, f: np.ndarray) -> np.ndarray:
    """v x* f of forces."""
    w, u, n, b = v[..., :3], v[..., 3:], f[..., :3], f[..., 3:]
    parts = {"w x the moment": wedge(steps, w, n), LINEAR: wedge(steps, u, b)}
    angular = steps.add(f"the angular part of v x*: in {site}", **parts)
    linear = steps.add(f"the linear part of v x*: in {site}", **{"w x the force": wedge(steps, w, b)})
    x = np.concatenate(np.broadcast_arrays(angular, linear), -1)
    others: dict[str, Any] = {
        "with the other sign": -x, "that of motions, v x": lambda: crm(Steps(), "", v, f),
        "its transpose, v x*^T": lambda: -crm(Steps(), "", v, f),
    }  # fmt: skip
    return np.asarray(steps.pick(f"the cross product of forces, v x*: in {site}", x, **others))
