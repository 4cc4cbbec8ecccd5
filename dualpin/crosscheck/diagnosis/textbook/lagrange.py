"""Lagrange's equations: the mass matrix from Jacobians, C from Christoffel's symbols, gravity from a potential.

    M = sum m Jv^T Jv + Jw^T R I R^T Jw      columns of a turning joint:  Jv = z x (c - p), Jw = z;  sliding:  Jv = z
    C_ij = (1/2) sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) v_k
    g = - sum m Jv^T g                       tau = M a + C v + g

References: Siciliano et al., Robotics (2009), equations 7.32, 7.39 and 7.45; Murray, Li and Sastry (1994), 4.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from ..case import View
from .assembly import MOST_STEPS, Dynamics, by_coordinates, of_symbols
from .steps import EVERYWHERE, Steps, cross
from .tree import Link, Tree, tree_of

FAR = "z x r, from the link's origin to the centre of mass,"


def jacobians(steps: Steps, tree: Tree, q: np.ndarray, k: Link) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Jv of the centre of mass and Jw (runs, samples, nv, 3), and the centre."""
    poses, chain = tree.poses(q), tree.joints_of(k)
    pose = poses[k.number]
    local = steps.components("the centre of mass of a body, in its link's axes,", k.c)
    r = steps.turn("the arm to the centre of mass", pose.R0, local)
    c = pose.p0 + r
    zero = np.zeros((*q.shape[:-1], 3), q.dtype)
    linear, angular = {}, {}
    for i, j in enumerate(chain):
        at = poses[j.number]
        z = steps.turn(f"the joint's axis: of {'sliding' if j.slides else 'turning'} links", at.R0, j.z)
        if j.slides:
            nothing = {"z, as of turning joints": z}
            angular[j.column] = steps.pick("Jw of a sliding joint", zero, **nothing) + zero
            x = z
        else:
            others = {
                "that to the link's origin": cross(z, pose.p0 - at.p0), "that from the world's origin": cross(z, c),
                "that from the parent's joint": cross(z, c - poses[j.parent].p0),
            }  # fmt: skip
            terms = {"z x (p - p_j)": cross(z, pose.p0 - at.p0), FAR: cross(z, r)}
            x = steps.add("Jv of a turning joint", **terms)
            x = steps.pick("the arm in Jv of a turning joint", x, **others)
            x = steps.add("Jv of turning joints", **{"z x r, as a whole,": x})
            angular[j.column] = steps.part("the columns of Jw", z + zero, i, len(chain))
        linear[j.column] = steps.part("the columns of Jv", x + zero, i, len(chain))
    if tree.floating:
        R = poses[0].R0
        turning = -cross_matrix(c - poses[0].p0) @ R
        for i in range(3):
            linear[i], linear[3 + i], angular[i] = turning[..., i], R[..., i], R[..., i]
    return _stacked(linear, tree.nv, zero), _stacked(angular, tree.nv, zero), c


def _stacked(columns: dict[int, np.ndarray], nv: int, zero: np.ndarray) -> np.ndarray:
    lead = np.broadcast_shapes(zero.shape, *(x.shape for x in columns.values()))
    return np.stack([np.broadcast_to(columns.get(i, zero), lead) for i in range(nv)], axis=-2)


def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
    """M (runs, samples, nv, nv)."""
    M: np.ndarray = np.zeros((1, 1, tree.nv, tree.nv))
    poses = tree.poses(q)
    for i, k in enumerate(tree.carried):
        Jv, Jw, _ = jacobians(steps, tree, q, k)
        given = steps.pick(
            "the inertia about the centre of mass", k.tensor(steps), **{"that about the origin": k.about_origin}
        )
        I = steps.congruent("the inertia of a body", poses[k.number].R0, given)
        m = k.mass + np.zeros((1, 1, 1, 1))
        m = steps.pick("the mass in m Jv^T Jv", m, **tree.masses(k, m))
        terms = {"m Jv^T Jv": m * (Jv @ transposed(Jv)), "Jw^T I Jw": Jw @ (I @ transposed(Jw))}
        of_body = steps.add("the mass matrix of a body", **terms)
        M = M + steps.part("the bodies of the mass matrix", of_body, i, len(tree.carried), alone=True)
    return M


def gravity(steps: Steps, tree: Tree, q: np.ndarray, g: np.ndarray) -> np.ndarray:
    out: np.ndarray = np.zeros((1, 1, tree.nv))
    for i, k in enumerate(tree.carried):
        Jv, _, _ = jacobians(steps, tree, q, k)
        m = k.mass + np.zeros((1, 1, 1))
        m = steps.pick("the mass in m Jv^T g", m, **tree.masses(k, m))
        down = product(Jv, g + np.zeros((*q.shape[:-1], 3)))
        term = steps.add("the gravity of a body", **{"-m Jv^T g": -m * down})
        out = out + steps.part("the bodies whose gravity counts", term, i, len(tree.carried), alone=True)
    return out


def potential(steps: Steps, tree: Tree, q: np.ndarray, g: np.ndarray) -> np.ndarray:
    out: np.ndarray = np.zeros((1, 1))
    poses = tree.poses(q)
    for i, k in enumerate(tree.carried):
        pose = poses[k.number]
        local = steps.components("the centre of mass of a body, in its link's axes,", k.c)
        at = pose.p0 + steps.turn("the arm to the centre of mass", pose.R0, local)
        at = steps.pick("the height of a body", at, **{"that of the link's origin": pose.p0 + 0 * at})
        m = k.mass + np.zeros((1, 1))
        m = steps.pick("the mass in -m g . c", m, **tree.masses(k, m))
        term = -m * (g * at).sum(-1)
        out = out + steps.part("the bodies whose height counts", term, i, len(tree.carried), alone=True)
    return out


def coriolis(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """C from Christoffel's symbols of the mass matrix that the same steps make."""
    columns = [k.column for k in tree.links if k.moves]
    return of_symbols(steps, by_coordinates(lambda x: mass(steps, tree, x), q), v[0], columns)


AS_NEWTON_EULER = {
    ("the acceleration of the centre of mass", "alpha x r"): [("Jv of a turning joint", FAR)],
    ("a body's moment about the link's origin", "r x f"): [("Jv of a turning joint", FAR)],
    ("the acceleration of a link's origin", "alpha x r"): [("Jv of a turning joint", "z x (p - p_j)")],
    (EVERYWHERE, "alpha x r"): [("Jv of turning joints", "z x r, as a whole,")],
    ("the force of a body", "m a"): [("the mass matrix of a body", "m Jv^T Jv")],
    ("the moment about the centre of mass", "I alpha"): [("the mass matrix of a body", "Jw^T I Jw")],
}
"""Slips of Newton's and Euler's equations, as the same habit shows in Jacobians."""


def mass_of_habits(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
    """M from Jacobians by someone who makes the slips of Newton's and Euler's equations in them too."""
    return steps.through(AS_NEWTON_EULER, lambda there: mass(there, tree, q))


@dataclass(frozen=True)
class Lagrange(Dynamics):
    """All terms from M, C and g; C by differentiating M, of few joints on a fixed base."""

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        tree = tree_of(view, self.fused)
        without = term not in ("gravity", "potential_energy", "crba", "minv", "kinetic_energy")
        return None if without and (tree.floating or tree.nv > MOST_STEPS) else super().__call__(view, term, steps)

    def _sum(
        self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray | None, g: np.ndarray
    ) -> np.ndarray:
        terms = {"C v": product(coriolis(steps, tree, q, v), v), "g": gravity(steps, tree, q, g)}
        if a is not None:
            terms["M a"] = product(self.M(steps, tree, q), a)
        return np.asarray(steps.add("the forces M a + C v + g", **terms))

    def _h(self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return self._sum(steps, tree, q, v, None, tree.gravity)

    def _gravity(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return gravity(steps, tree, s["q"], tree.gravity)

    def _rnea(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self._sum(steps, tree, s["q"], s["v"], s["a"], tree.gravity)

    def _coriolis(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return coriolis(steps, tree, s["q"], s["v"])

    def _potential_energy(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return potential(steps, tree, s["q"], tree.gravity)

    def _rnea_derivatives(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> None:
        return None

    def _aba_derivatives(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> None:
        return None
