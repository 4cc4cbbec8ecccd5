"""Poses and Jacobians of frames, momentum and the centre of mass, by Plücker transforms.

    X_0k = X_k X_0p = [E 0; -E [r x]  E]        R = E^T,  [r x] = -E^T times the block below; or from R and p
    J_j = X_kj S_j, of all joints j on the path, in the frame's axes; both halves times R in those of the world
    A_j = X^T I^c_j S_j, of composite bodies, X to the link from the centre of mass, in world axes
    A = sum X_0k^T I_k J_k,  about the centre of mass:  n - c x p
    m [c x] is the upper right block of sum X_0k^T I_k X_0k, and m the last one

References: Featherstone, Rigid Body Dynamics Algorithms (2008), sections 2.8, 4.1 and 5.3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .arrays import cross
from .body_coriolis import rate
from .plucker import Coordinates, Model, brought, links, to_parent, transform
from .products import vector
from .spatial import composites, of_composite, velocities
from .steps import Steps
from .tree import Pose, Tree, tree_of

OF_FRAMES = ("jacobian", "frame_velocity")
OF_RATES = ("jacobian_dot",)
"""Of a base that rests, by transforms alone."""
OF_BODIES = ("com", "com_jacobian", "centroidal_momentum_matrix")


@dataclass(frozen=True)
class Transforms:
    """Makes these terms.

    Attributes
    ----------
    fused : bool
        As of `Tree`.
    chained : bool
        Whether poses in the world are a chain of R and p, from which sums of bodies are made too, not of transforms.
    """

    fused: bool = False
    chained: bool = False
    of: Coordinates = links
    """Those of links in their own axes; the inertias of bodies may be merged in six-vectors."""

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        return self.answer(view, term, steps, tree_of(view, self.fused))

    def answer(self, view: View, term: str, steps: Steps, tree: Tree) -> np.ndarray | None:
        """The term (runs, samples, ...), of this tree."""
        if view.layout.how.reference != "local_world_aligned" and term in OF_FRAMES + OF_RATES:
            return None
        if term in OF_RATES and (self.chained or tree.floating):
            return None
        poses = tree.poses(view.states["q"][None])
        m = self.of(steps, tree, view.states["q"][None])
        whole = [] if self.chained else _from_the_world(steps, tree, m)
        if term in OF_BODIES:
            com = _centre(steps, tree, m, poses) if self.chained else _com(steps, tree, m, whole)
            if term == "com":
                return com
            A = _by_composites(steps, tree, m, poses, com) if self.chained else _momentum(steps, tree, m, whole, com)
            return A if term == "centroidal_momentum_matrix" else A[..., 3:, :] / sum(k.mass for k in tree.carried)
        stands = [tree.stands[frame] for frame in view.frames]
        if term == "fk":
            return None if self.fused else stacked([_pose(steps, whole[k]) for k, _ in stands])
        R = [x.R0 for x in poses] if self.chained else [transposed(x[..., :3, :3]) for x in whole]
        v = view.states["v"][None]
        if term == "jacobian_dot":
            rates = _rates(steps, tree, m, v)
            return stacked([_moving(steps, tree, m, R[k], k, H, rates, v) for k, H in stands])
        J = stacked([_in_world(steps, R[k], _jacobian(steps, tree, m, k, H, m.S), H) for k, H in stands])
        return J if term == "jacobian" else product(J, v[:, :, None])


def _from_the_world(steps: Steps, tree: Tree, m: Model) -> list[np.ndarray]:
    whole, site = [_own(m, 0)], "the transform of a link from the world, its own times the parent's,"
    for k in tree.links[1:]:
        up, X = whole[k.parent], _own(m, k.number)
        whole.append(steps.pick(site, X @ up, **{"the parent's times its own": up @ X}))
    return whole


def _own(m: Model, number: int) -> np.ndarray:
    X = m.X[number]
    assert X is not None, "of links in their own axes"
    return X


def _pose(steps: Steps, X: np.ndarray) -> np.ndarray:
    E = X[..., :3, :3]
    read = -transposed(E) @ X[..., 3:, :3]
    others = {
        "-E [r x] itself": X[..., 3:, :3],
        "[r x] with the other sign": -read,
        "E^T [r x], with E left there": transposed(E) @ read,
    }
    r = vector(steps.pick("the block from which a position is read", read, **others))
    R = steps.transpose("E, the rotation of a pose,", E)
    lead = np.broadcast_shapes(R.shape[:-2], r.shape[:-1])
    T = np.zeros((*lead, 4, 4))
    T[..., :3, :3], T[..., :3, 3], T[..., 3, 3] = R, r, 1.0
    return T


def _jacobian(
    steps: Steps, tree: Tree, m: Model, number: int, H: np.ndarray, S: Mapping[int, np.ndarray]
) -> np.ndarray:  # fmt: skip
    """Of a frame that stands at H on a link, in its axes."""
    J = _in_link(steps, tree, m, number, S)
    return J if np.array_equal(H, np.eye(4)) else transform(steps, H[None, None, :3, :3], H[None, None, :3, 3]) @ J


def _rates(steps: Steps, tree: Tree, m: Model, v: np.ndarray) -> dict[int, np.ndarray]:
    """dS/dt = v x S, of links that move."""
    vs = velocities(steps, tree, m, v, np.zeros((*v.shape[:-1], 6)))
    return {number: rate(steps, vs[number], S + 0 * vs[number]) for number, S in m.S.items()}


def _moving(
    steps: Steps, tree: Tree, m: Model, R: np.ndarray, number: int, H: np.ndarray, rates: Mapping[int, np.ndarray],
    v: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """The rate of the Jacobian of a frame, at its origin, in world axes."""
    J, D = (transposed(_jacobian(steps, tree, m, number, H, S)) for S in (m.S, rates))
    w, speed = J[..., :3], product(transposed(J[..., 3:]), v)
    parts = {
        "that of a point at rest": D[..., 3:],
        "w x the velocity of the frame": cross(w, speed[..., None, :] + 0 * w),
    }
    linear = steps.add("the rate of the linear part, of a frame that moves,", **parts)
    return _in_world(steps, R, transposed(np.concatenate(np.broadcast_arrays(D[..., :3], linear), -1)), H)


def _in_world(steps: Steps, R: np.ndarray, J: np.ndarray, H: np.ndarray) -> np.ndarray:
    """In world axes; those of the link that carries the frame are R."""
    R, rows = (R @ H[:3, :3])[..., None, :, :], transposed(J)
    site = "a column, in the frame's axes"
    w = steps.turn(f"{site}: its angular part", R, rows[..., :3])
    v = steps.turn(f"{site}: its linear part", R, rows[..., 3:])
    return transposed(np.concatenate(np.broadcast_arrays(w, v), -1))


def _in_link(
    steps: Steps, tree: Tree, m: Model, number: int, S: Mapping[int, np.ndarray] | None = None
) -> np.ndarray:  # fmt: skip
    """The Jacobian of a link in its own axes (runs, samples, 6, nv); S by default those of the joints."""
    S = m.S if S is None else S
    A: np.ndarray = np.eye(6)[None, None]
    columns: dict[int, np.ndarray] = {}
    k = tree.links[number]
    while k.parent >= 0:
        if k.moves:
            columns[k.column] = brought(steps, "S of a column of the Jacobian", A, S[k.number] + 0 * A[..., 0])
        X = _own(m, k.number)
        others = {"in the other order": X @ A, "that of the last step alone": X + 0 * A}
        A = steps.pick("the transform from a joint to the frame", A @ X, **others)
        k = tree.links[k.parent]
    if tree.floating:
        columns |= {i: A[..., i] for i in range(6)}
    lead = np.broadcast_shapes(A.shape[:-2], *(x.shape[:-1] for x in columns.values()))
    return np.stack([np.broadcast_to(columns.get(i, np.zeros(6)), (*lead, 6)) for i in range(tree.nv)], -1)


def _by_composites(
    steps: Steps, tree: Tree, m: Model, poses: list[Pose], com: np.ndarray
) -> np.ndarray:  # fmt: skip
    """The same, column by column, of what each joint carries."""
    own = [I + np.zeros((*poses[0].p0.shape[:-1], 6, 6)) for I in m.I]
    I = composites(steps, tree, m, own)
    site, columns = "the momentum of what a joint carries, X^T I^c S,", dict[int, np.ndarray]()
    for k in (k for k in tree.links if k.moves or (tree.floating and k.parent < 0)):
        at = poses[k.number]
        to_link = transform(steps, at.R0, at.p0 - com)
        if k.moves:
            columns[k.column] = to_parent(steps, site, to_link, of_composite(steps, k, m, I, own))
        else:
            h = to_parent(steps, site, to_link[..., None, :, :], transposed(I[k.number]))
            columns |= {i: h[..., i, :] for i in range(6)}
    lead = np.broadcast_shapes(*(x.shape for x in columns.values()))
    return np.stack([np.broadcast_to(columns[i], lead) for i in range(tree.nv)], -1)


def _centre(steps: Steps, tree: Tree, m: Model, poses: list[Pose]) -> np.ndarray:
    """sum (m p + R m c) / sum m, with m c from the bodies' inertias."""
    total: np.ndarray = np.zeros(3)
    for k in tree.carried:
        I, at = m.I[k.number], poses[k.number]
        c = steps.turn("the first moment of a body", at.R0, vector(I[..., :3, 3:]) + 0 * at.p0)
        total = total + steps.add("the moment of a body's mass", **{"m p": k.mass * at.p0, "R m c": c})
    return np.asarray(total / sum(k.mass for k in tree.carried))


def _momentum(
    steps: Steps, tree: Tree, m: Model, whole: list[np.ndarray], com: np.ndarray
) -> np.ndarray:  # fmt: skip
    """About the centre of mass that these steps make, in world axes: sum X_0k^T I_k J_k, moved there."""
    total: np.ndarray = np.zeros((1, 1, tree.nv, 6))
    for i, k in enumerate(tree.carried):
        h = transposed(m.I[k.number] @ _in_link(steps, tree, m, k.number))
        h = to_parent(steps, "the momentum of a body, X^T I J,", whole[k.number][..., None, :, :], h)
        total = total + steps.part("the bodies whose momentum counts", h, i, len(tree.carried), alone=True)
    n, p = total[..., :3], total[..., 3:]
    G = com[..., None, :] + 0 * p
    n = steps.add(
        "the momentum about the centre of mass", **{"that about the origin": n, "-c x p": -cross(G, p + 0 * G)}
    )
    return transposed(np.concatenate(np.broadcast_arrays(n, p), -1))


def _com(steps: Steps, tree: Tree, m: Model, whole: list[np.ndarray]) -> np.ndarray:
    total: np.ndarray = np.zeros((1, 1, 6, 6))
    for i, k in enumerate(tree.carried):
        I = steps.congruent("a body's inertia, X^T I X,", transposed(whole[k.number]), m.I[k.number])
        total = total + steps.part("the bodies whose mass counts", I, i, len(tree.carried), alone=True)
    mass = total[..., 3:, 3:][..., :1, 0]
    divisor = steps.pick("the mass that divides the first moment", mass, **{"1": 0 * mass + 1})
    return np.asarray(vector(total[..., :3, 3:]) / divisor)


def stacked(parts: list[np.ndarray]) -> np.ndarray:
    """Frame by frame, behind runs and samples."""
    shape = np.broadcast_shapes(*(x.shape for x in parts))
    return np.stack([np.broadcast_to(x, shape) for x in parts], axis=2)
