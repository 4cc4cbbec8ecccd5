"""Momentum and energies by six-vectors.

    h_p += X^T h      h = I v      T = sum v . I v / 2      U = -sum m g . c

References: Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.13; Orin, Goswami and Lee, Centroidal
Dynamics of a Humanoid Robot (2013).
"""

from __future__ import annotations

import numpy as np

from ...subjects.layout import product
from .plucker import Coordinates, links, to_parent
from .products import wedge
from .spatial import gravity, velocities
from .steps import HAVE, Steps
from .tree import Tree


def momentum(steps: Steps, tree: Tree, q: np.ndarray, com: np.ndarray, of: Coordinates = links) -> np.ndarray:
    """The momentum about the centre of mass, in world axes, of unit velocities: (runs, samples, 6, nv)."""
    tiled, _, unit = tree.unit(q)
    m = of(steps, tree, tiled)
    vs = velocities(steps, tree, m, unit, np.zeros((*tiled.shape[:-1], 6)))
    h = [product(I, v) for I, v in zip(m.I, vs, strict=True)]
    for k in reversed(tree.links[1:]):
        handed = to_parent(steps, "the momentum that is handed on, X^T h,", m.X[k.number], h[k.number])
        h[k.parent] = steps.add(
            "the momentum of what a joint moves", **{HAVE: h[k.parent], "the child's X^T h": handed}
        )
    whole = to_parent(steps, "the momentum, in the base's axes,", m.X[0], h[0])
    n, p = whole[..., :3], whole[..., 3:]
    G = np.repeat(com, tree.nv, axis=1)
    n = steps.add(
        "the momentum about the centre of mass", **{"that about the origin": n, "-c x p": -wedge(steps, G + 0 * p, p)}
    )
    return tree.columns(np.concatenate(np.broadcast_arrays(n, p), -1))


def energy(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, of: Coordinates = links) -> np.ndarray:
    """T = sum v . I v / 2."""
    m = of(steps, tree, q)
    vs, total = velocities(steps, tree, m, v, np.zeros((*q.shape[:-1], 6))), np.zeros((1, 1))
    for i, k in enumerate(tree.carried):
        of_k = 0.5 * (vs[k.number] * product(m.I[k.number], vs[k.number])).sum(-1)
        total = total + steps.part("the bodies whose energy counts", of_k, i, len(tree.carried), alone=True)
    return total


def potential(steps: Steps, tree: Tree, q: np.ndarray, g: np.ndarray) -> np.ndarray:
    """-sum m g . c, g being the linear part of a six-vector."""
    down, poses = gravity(steps, g)[..., 3:], tree.poses(q)
    h = sum(k.mass * (poses[k.number].p0 + product(poses[k.number].R0, k.c)) for k in tree.carried)
    return np.asarray(-(down * h).sum(-1))
