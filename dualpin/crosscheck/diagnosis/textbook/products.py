"""Cross products of vectors as matrices, and of six-vectors, [angular; linear].

References: Featherstone, Rigid Body Dynamics Algorithms (2008), equations 2.23, 2.31 and 2.32.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from .arrays import cross
from .steps import Steps

LINEAR = "the product of the linear velocity"
SKEW = "[r x], the matrix of a cross product,"
AS_MATRIX, OF_TWO, IN_MOMENTUM = (f"{SKEW}: {where}" for where in ("by itself", "times a vector", "in a momentum"))
"""A code may have a function of two vectors, and one that makes the matrix."""
IN_AD = f"{AS_MATRIX}: in v x and its transpose"
AD = "the matrix of v x"
"""Codes often make it once, and take its transpose with the other sign for forces."""


EPSILON = np.stack([cross_matrix(e) for e in np.eye(3)], -1)
"""[r x] = EPSILON r: the last index is that of r."""


def _skewed() -> dict[str, np.ndarray]:
    """What may stand in the place of `EPSILON`."""
    found = {}
    for i, j in ((i, j) for i in range(3) for j in range(3) if i != j):
        where, own = f"row {i + 1}, column {j + 1}", 3 - i - j
        for k in range(3):
            x = EPSILON.copy()
            x[i, j] = np.eye(3)[k] * EPSILON[i, j, own] * (-1.0 if k == own else 1.0)
            what = "of the other sign" if k == own else f"of {'xyz'[k]}, not {'xyz'[own]}"
            found[f"that with its entry in {where} {what}"] = x
        for k in (k for k in range(3) if k != j):
            x = EPSILON.copy()
            x[i, k] += x[i, j]
            x[i, j] = 0.0
            found[f"that with its entry in {where} in column {k + 1}"] = x
    for i in range(3):
        signs = np.where(np.arange(3) == i, -1.0, 1.0)
        found[f"that with row {i + 1} of the other sign"] = signs[:, None, None] * EPSILON
    return {**found, "its transpose": -EPSILON}


_SKEWED = _skewed()


def skew(steps: Steps, r: np.ndarray) -> np.ndarray:
    """[r x]."""
    return np.asarray(
        steps.tabled(AS_MATRIX, cross_matrix(r), _SKEWED, lambda E: (E * steps.few(r)[..., None, None, :]).sum(-1), 2)
    )


def vector(K: np.ndarray) -> np.ndarray:
    """r of [r x]."""
    return np.stack([K[..., 2, 1], K[..., 0, 2], K[..., 1, 0]], -1)


def wedge(steps: Steps, a: np.ndarray, b: np.ndarray, site: str = OF_TWO) -> np.ndarray:
    """[a x] b."""
    few = steps.few

    def wrong(E: np.ndarray) -> np.ndarray:
        return product((E * few(a)[..., None, None, :]).sum(-1), few(b))

    return np.asarray(steps.tabled(site, cross(a, b), _SKEWED, wrong))


def crm(steps: Steps, site: str, v: np.ndarray, m: np.ndarray) -> np.ndarray:
    """v x m of motions."""
    few = steps.few
    w, u, a, b = v[..., :3], v[..., 3:], m[..., :3], m[..., 3:]
    parts = {"w x the linear part": wedge(steps, w, b), LINEAR: wedge(steps, u, a)}
    linear = steps.add(f"the linear part of v x: in {site}", **parts)
    angular = steps.add(f"the angular part of v x: in {site}", **{"w x the angular part": wedge(steps, w, a)})
    x = np.concatenate(np.broadcast_arrays(angular, linear), -1)
    others: dict[str, Any] = {
        "with the other sign": lambda: -few(x), "that of forces, v x*": lambda: crf(Steps(), "", few(v), few(m)),
        "its transpose, v x^T": lambda: -crf(Steps(), "", few(v), few(m)),
    }  # fmt: skip
    x = steps.pick(f"the cross product of motions, v x: in {site}", x, **others)
    x = _of_matrices(steps, x, v, m)
    return np.asarray(steps.pick(AD, x, **_of_blocks(steps, v, m, False)))


def crf(steps: Steps, site: str, v: np.ndarray, f: np.ndarray) -> np.ndarray:
    """v x* f of forces."""
    few = steps.few
    w, u, n, b = v[..., :3], v[..., 3:], f[..., :3], f[..., 3:]
    parts = {"w x the moment": wedge(steps, w, n), LINEAR: wedge(steps, u, b)}
    angular = steps.add(f"the angular part of v x*: in {site}", **parts)
    linear = steps.add(f"the linear part of v x*: in {site}", **{"w x the force": wedge(steps, w, b)})
    x = np.concatenate(np.broadcast_arrays(angular, linear), -1)
    others: dict[str, Any] = {
        "with the other sign": lambda: -few(x), "that of motions, v x": lambda: crm(Steps(), "", few(v), few(f)),
        "its transpose, v x*^T": lambda: -crm(Steps(), "", few(v), few(f)),
    }  # fmt: skip
    x = steps.pick(f"the cross product of forces, v x*: in {site}", x, **others)
    x = _of_matrices(steps, x, v, f, True)
    return np.asarray(steps.pick(AD, x, **_of_blocks(steps, v, f, True)))


def applied(steps: Steps, site: str, I: np.ndarray, v: np.ndarray) -> np.ndarray:
    """I v, half by half: [J w + m c x u; m u - m c x w]."""
    w, u = v[..., :3], v[..., 3:]
    parts = {"J w": product(I[..., :3, :3], w), "m c x u": product(I[..., :3, 3:], u)}
    angular = steps.add(f"{site}: its angular part", **parts)
    parts = {"-m c x w": product(I[..., 3:, :3], w), "m u": product(I[..., 3:, 3:], u)}
    return np.concatenate(np.broadcast_arrays(angular, steps.add(f"{site}: its linear part", **parts)), -1)


def _of_matrices(steps: Steps, x: np.ndarray, v: np.ndarray, m: np.ndarray, transpose: bool = False) -> np.ndarray:
    """v x m made by [w x 0; u x w x], where these are wrong; v x* m by its transpose."""

    def wrong(E: np.ndarray) -> np.ndarray:
        w, u, a, b = (part for y in (steps.few(v), steps.few(m)) for part in (y[..., :3], y[..., 3:]))
        W, U = ((E * y[..., None, None, :]).sum(-1) for y in (w, u))
        if transpose:
            W, U = -transposed(W), -transposed(U)
            halves = product(W, a) + product(U, b), product(W, b)
        else:
            halves = product(W, a), product(U, a) + product(W, b)
        return np.concatenate(np.broadcast_arrays(*halves), -1)

    return np.asarray(steps.tabled(IN_AD, x, _SKEWED, wrong, within=AS_MATRIX))


def _of_blocks(steps: Steps, v: np.ndarray, m: np.ndarray, transpose: bool) -> dict[str, Callable[[], np.ndarray]]:
    """What wrong blocks of [w x 0; u x w x] make of v x m, or of v x* m = -(v x)^T m."""

    def made(of_w: np.ndarray, of_u: np.ndarray) -> np.ndarray:
        w, u, a, b = (part for x in (steps.few(v), steps.few(m)) for part in (x[..., :3], x[..., 3:]))
        blocks = of_w[..., None] * w[..., None, None, :] + of_u[..., None] * u[..., None, None, :]
        if transpose:
            blocks = np.swapaxes(blocks, -3, -2)
        (p, q), (r, s) = (tuple(np.moveaxis(row, -2, 0)) for row in np.moveaxis(blocks, -3, 0))
        halves = cross(p, a) + cross(q, b), cross(r, a) + cross(s, b)
        return np.concatenate(np.broadcast_arrays(*halves), -1)

    return {what: partial(made, *(np.array(x) for x in of)) for what, of in _BLOCKS.items()}


_W, _U, _NONE = [[1, 0], [0, 1]], [[0, 0], [1, 0]], [[0, 0], [0, 0]]
_BLOCKS = {
    "that with u x in the upper right": (_W, [[0, 1], [0, 0]]),
    "that without w x in the upper left": ([[0, 0], [0, 1]], _U),
    "that without w x in the lower right": ([[1, 0], [0, 0]], _U),
    "that with the other sign of w x in the upper left": ([[-1, 0], [0, 1]], _U),
    "that with the other sign of w x in the lower right": ([[1, 0], [0, -1]], _U),
    "that with w x in the place of u x": ([[1, 0], [1, 1]], _NONE),
    "that with u x in the upper left": ([[0, 0], [0, 1]], [[1, 0], [1, 0]]),
    "that with u x in the lower right": ([[1, 0], [0, 0]], [[0, 0], [1, 1]]),
    "its transpose": ([[-1, 0], [0, -1]], [[0, -1], [0, 0]]),
    "of the other sign": ([[-1, 0], [0, -1]], [[0, 0], [-1, 0]]),
}  # fmt: skip
"""Where w x stands, and u x, with their factors."""


def rows_of(steps: Steps, where: str, J: np.ndarray) -> np.ndarray:
    """A body's Jacobian as it is used: forces belong to linear rows, moments to angular ones."""
    exchanged = {"linear rows first, taken for angular ones": lambda: J[..., [3, 4, 5, 0, 1, 2], :]}
    return np.asarray(steps.pick(f"the rows of a body's Jacobian in {where}", J, **exchanged))
