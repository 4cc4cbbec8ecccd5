"""Equations of motion by Jacobians of links in their own axes, six rows each.

    J_i = [.. Ad(T_i^-1 T_k) S_k ..]  of all joints k that carry link i      Ad(T) = [R 0; [p x] R  R]
    or Ad(T_i^-1) J_s with the columns of the world, J_s = [.. Ad(T_k) S_k ..]
    M = sum J_i^T G_i J_i      g = sum J_i^T G_i [0; -R_i^T gravity]      T = sum V_i^T G_i V_i / 2,  V_i = J_i v
    A = sum Ad(T_i^-1 T_c)^T G_i J_i,  T_c a translation to the centre of mass
    C = sum J_i^T (G_i J_i' + B_i J_i)      J_i' = [.. (V_k - V_i) x Ad S_k ..]
    B = (-ad^T G + G ad - [h]) / 2          h = G V,  [h] = [[n x] [f x]; [f x] 0]

References: Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation (1994), 3.4.2 and 4.3; Lynch
and Park, Modern Robotics (2017), sections 5.1 and 8.1.
"""

from __future__ import annotations

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from ..case import View
from .arrays import cross, inverse
from .plucker import inertia, subspace
from .products import crm
from .steps import Steps
from .tree import Link, Pose, Tree, spatial, tree_of

TERMS = (
    "jacobian", "frame_velocity", "jacobian_dot", "gravity", "crba", "com_jacobian", "centroidal_momentum_matrix",
    "kinetic_energy", "coriolis",
)  # fmt: skip
OF_FRAMES = TERMS[:3]


def run(view: View, term: str, steps: Steps, fused: bool = False, by_world: bool = False) -> np.ndarray | None:
    """The term (runs, samples, ...); `fused` as of `Tree`; `by_world`, whether J_s is made first."""
    if term in OF_FRAMES and view.layout.how.reference != "local_world_aligned":
        return None
    return Jacobians(view, steps, fused, by_world).term(term)


class Jacobians:
    """Those of one state, or of many."""

    def __init__(self, view: View, steps: Steps, fused: bool, by_world: bool) -> None:
        self.view, self.steps, self.by_world = view, steps, by_world
        self.tree: Tree = tree_of(view, fused)
        self.q = view.states["q"][None]
        self.poses = self.tree.poses(self.q)
        zero = np.zeros(3)
        self.world = Pose(np.eye(3)[None, None], zero, np.eye(3)[None, None], zero[None, None])

    def term(self, term: str) -> np.ndarray:
        view, v = self.view, self.view.states.get("v")
        if term in OF_FRAMES:
            of = [self._of_frame(*self.tree.frames[frame], term) for frame in view.frames]
            lead = np.broadcast_shapes(*(x.shape for x in of))
            J = np.stack([np.broadcast_to(x, lead) for x in of], 2)
            return product(J, view.states["v"][None, :, None]) if term == "frame_velocity" else J
        if term == "com_jacobian":
            total = self._sum("centroidal_momentum_matrix")[..., 3:, :]
            mass = sum(k.mass for k in self.tree.carried) * np.ones((1, 1, 1, 1))
            return total / self.steps.pick("the mass that divides the momentum", mass, **{"1": 1 + 0 * mass})
        x = self._sum(term)
        if term == "crba":
            return x + np.diag(self.tree.rotors)
        if term == "kinetic_energy" and v is not None:
            return np.asarray(x + 0.5 * (self.tree.rotors * v * v).sum(-1))
        return x

    def _sum(self, term: str) -> np.ndarray:
        """Over the bodies that joints move."""
        of, bodies, site = getattr(self, f"_{term}"), self.tree.carried, "the bodies that are added up"
        parts = [self.steps.part(site, of(k), i, len(bodies), alone=True) for i, k in enumerate(bodies)]
        return np.asarray(sum(parts[1:], parts[0]))

    # Jacobians

    def adjoint(self, to: Pose, of: Pose) -> np.ndarray:
        """Ad(T^-1 T_k), which brings motions from the axes of one into those of the other."""
        steps, back = self.steps, transposed(to.R0)
        apart = of.p0 - to.p0
        p = product(back, apart)
        wrong = {
            "that of p_i - p_k": -p, "p_k - p_i, not turned": apart, "R_i (p_k - p_i)": product(to.R0, apart),
            "R_i^T p_k": product(back, of.p0), "-R_i^T p_i": product(back, -to.p0),
        }  # fmt: skip
        p = steps.pick("the position in T_i^-1 T_k", p, **wrong)
        R = back @ of.R0
        R = steps.pick("the rotation in T_i^-1 T_k", R, **{"its transpose": transposed(R), "R_k alone": of.R0 + 0 * R})
        lead = np.broadcast_shapes(R.shape[:-2], p.shape[:-1])
        R, K = np.broadcast_to(R, (*lead, 3, 3)), cross_matrix(np.broadcast_to(p, (*lead, 3)))
        few = steps.few
        others = {
            "with the other sign": lambda: -few(K) @ few(R), "[p x] alone": lambda: few(K),
            "R [p x]": lambda: few(R) @ few(K), "left out": lambda: 0 * few(K),
            "[p x] and R multiplied entry by entry": lambda: few(K) * few(R),
            "[p x] R^T": lambda: few(K) @ transposed(few(R)),
        }  # fmt: skip
        block = steps.pick("the block [p x] R of Ad", K @ R, **others)
        lead = block.shape[:-2]
        R = np.broadcast_to(R, (*lead, 3, 3))
        return np.asarray(
            steps.pick(
                "the adjoint map Ad",
                spatial([[R, 0 * block], [block, R]]),
                **{
                    "with [p x] R in the upper right block": lambda: spatial(
                        [[few(R), few(block)], [0 * few(block), few(R)]]
                    )
                },
            )
        )

    def columns(self, i: Link) -> dict[int, np.ndarray]:
        """Of the Jacobian of a link, by their places in v: (runs, samples, 6)."""
        steps, chain, pose = self.steps, self.tree.joints_of(i), self.poses[i.number]
        found = {}
        back = self.adjoint(pose, self.world) if self.by_world else None
        for n, k in enumerate(chain):
            Ad = self.adjoint(self.world if self.by_world else pose, self.poses[k.number])
            S = subspace(steps, k) + 0 * Ad[..., 0]
            others = {"by its inverse": lambda Ad=Ad: inverse(steps.few(Ad))}
            s = steps.turn("a column Ad S of a Jacobian", Ad, S, **others)
            if back is not None:
                s = steps.turn("the world's Jacobian", back, s, **{"by its inverse": lambda: inverse(steps.few(back))})
            found[k.column] = steps.part("the columns of a link's Jacobian", s, n, len(chain))
        if self.tree.floating:
            Ad = self.adjoint(pose, self.poses[0])
            found |= {n: Ad[..., n] for n in range(6)}
        return found

    def jacobian(self, i: Link) -> np.ndarray:
        """(runs, samples, 6, nv)."""
        return self._filled(self.columns(i))

    def _filled(self, columns: dict[int, np.ndarray]) -> np.ndarray:
        lead = np.broadcast_shapes((1, self.q.shape[1], 6), *(x.shape for x in columns.values()))
        return np.stack([np.broadcast_to(columns.get(n, np.zeros(6)), lead) for n in range(self.tree.nv)], -1)

    def velocity(self, i: Link) -> np.ndarray:
        return product(self.jacobian(i), self.view.states["v"][None])

    def rate(self, i: Link) -> np.ndarray:
        """J_i', in the axes of the link that moves (runs, samples, 6, nv)."""
        steps, pose, V = self.steps, self.poses[i.number], self.velocity(i)
        found = {}
        known = self.columns(i)
        movers = {k.column: k for k in self.tree.joints_of(i)}
        if self.tree.floating:
            movers |= dict.fromkeys(range(6), self.tree.links[0])
        for column, k in movers.items():
            own = product(self.adjoint(pose, self.poses[k.number]), self.velocity(k))
            terms = {"V_k": own, "-V_i": -V}
            relative = steps.add("the velocity in a column's rate", **terms)
            found[column] = crm(steps, "a column's rate", relative, known[column] + 0 * relative)
        return self._filled(found)

    def _of_frame(self, number: int, r: np.ndarray, term: str) -> np.ndarray:
        """Its Jacobian in world axes, at its origin, or the rate of that."""
        k, steps = self.tree.links[number], self.steps
        R, rows = self.poses[number].R0[..., None, :, :], transposed(self.jacobian(k))

        def at(rows: np.ndarray) -> np.ndarray:
            w, u = rows[..., :3], rows[..., 3:]
            terms = {"v": u, "w x r": cross(w, r[..., None, :] + 0 * w)}
            u = steps.add("the linear part of a Jacobian at a frame", **terms)
            return np.concatenate(np.broadcast_arrays(w, u), -1)

        here = at(rows)
        if term == "jacobian_dot":
            w = self.velocity(k)[..., None, :3] + 0 * here[..., :3]
            turning = np.concatenate([cross(w, here[..., :3]), cross(w, here[..., 3:])], -1)
            here = steps.add("the rate of a Jacobian", **{"J'": at(transposed(self.rate(k))), "w x J": turning})
        halves = [
            steps.turn(f"a Jacobian in its link's axes: its {which} part", R, x)
            for which, x in (("angular", here[..., :3]), ("linear", here[..., 3:]))
        ]
        return transposed(np.concatenate(np.broadcast_arrays(*halves), -1))

    # bodies

    def _to_joints(self, J: np.ndarray) -> np.ndarray:
        """J^T; of six joints J itself is of the same shape."""
        return np.asarray(self.steps.transpose("J in J^T F", J)) if self.tree.nv == 6 else transposed(J)

    def _crba(self, k: Link) -> np.ndarray:
        J = self.jacobian(k)
        return np.asarray(self._to_joints(J) @ inertia(self.steps, k) @ J)

    def _gravity(self, k: Link) -> np.ndarray:
        steps, R = self.steps, self.poses[k.number].R0
        up = steps.turn("gravity, in world axes,", transposed(R), -self.tree.gravity + 0 * R[..., 0])
        a = np.concatenate([0 * up, up], -1)
        a = steps.pick("gravity as a six-vector", a, **{"in the angular rows": np.concatenate([up, 0 * up], -1)})
        return product(self._to_joints(self.jacobian(k)), product(inertia(steps, k), a))

    def _centroidal_momentum_matrix(self, k: Link) -> np.ndarray:
        steps, one = self.steps, np.eye(3)[None, None]
        G = self.view.compute("com")[None]
        X = self.adjoint(self.poses[k.number], Pose(one, G, one, G))
        back = steps.transpose("Ad in the momentum Ad^T G J", X)
        return np.asarray(back @ inertia(steps, k) @ self.jacobian(k))

    def _kinetic_energy(self, k: Link) -> np.ndarray:
        V = self.velocity(k)
        return np.asarray(0.5 * (V * product(inertia(self.steps, k), V)).sum(-1))

    def _coriolis(self, k: Link) -> np.ndarray:
        steps, J, G, V = self.steps, self.jacobian(k), inertia(self.steps, k), self.velocity(k)
        w, u = cross_matrix(V[..., :3]), cross_matrix(V[..., 3:])
        ad = spatial([[w, 0 * w], [u, w]])
        h = product(G, V)
        n, f = cross_matrix(h[..., :3]), cross_matrix(h[..., 3:])
        terms = {"-ad^T G": -transposed(ad) @ G, "G ad": G @ ad, "-[h]": -spatial([[n, f], [f, 0 * f]])}
        twice = steps.add("B, (-ad^T G + G ad - [h]) / 2,", **terms)
        B = steps.pick("B, (-ad^T G + G ad - [h]) / 2,", 0.5 * twice, **{"not halved": twice})
        terms = {"G J'": G @ self.rate(k), "B J": B @ J}
        return np.asarray(self._to_joints(J) @ steps.add("what J^T brings to the joints in C", **terms))
