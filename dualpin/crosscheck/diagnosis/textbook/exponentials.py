"""Poses and Jacobians by products of exponentials of screws, in the space frame.

    T_k = T_p exp(S_k q_k)      pose of link k = T_k M_k,  M_k its pose at home
    J_k = Ad(T_p) S_k,   dJ_k/dt = V_p x J_k       V_p of the joints before
    J_f = Ad(T_f^-1) J,  in the axes of a frame
    dM/dq_l = sum dJ_b^T G_b J_b + J_b^T G_b dJ_b,   dJ_j/dq_l = J_j x J_l of the joints l behind j
    M = sum J_b^T G_b J_b,   J_b = Ad(T_b^-1) J of a body's frame, at its centre of mass
    A = sum Ad(T_b^-1 T_c)^T G_b J_b,   the momentum about the centre of mass, of unit velocities

Six-vectors are [angular; linear] of the point at the world's origin.  Arrays have the axes (runs, samples, ...).

References: Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation (1994), sections 3.2 and 3.4;
Lynch and Park, Modern Robotics (2017), sections 4.1 and 5.1.
"""

from __future__ import annotations

from functools import cached_property, partial

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .arrays import cross
from .assembly import of_symbols
from .attitudes import PLAIN
from .body_twists import Frames, frame_at_home, spatial_inertia
from .plucker import to_parent
from .products import crm
from .screws import adjoint, at_home, before, exponentials, inverted, products, screw, standing
from .steps import Steps
from .transforms import stacked
from .tree import Link, Tree, tree_of
from .turns import ONE
from .wholes import Pose, multiplied, times

OF_BODIES = ("gravity", "crba", "kinetic_energy")
OF_FRAMES = ("jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration")
OF_MOTION, OF_MASS = ("fk", *OF_FRAMES), ("com", "com_jacobian", "potential_energy", *OF_BODIES)
TERMS = OF_MOTION + OF_MASS
IN_BODIES = (*OF_BODIES, "com_jacobian", "centroidal_momentum_matrix", "coriolis")
"""Terms of Jacobians in bodies' frames."""


def run(
    view: View, term: str, steps: Steps, fused: bool = False, frames: Frames | None = None
) -> np.ndarray | None:  # fmt: skip
    """The term (runs, samples, ...); `fused` as of `Tree`; `frames` of bodies, in which M is made of Jacobians."""
    tree = tree_of(view, fused)
    return None if tree.floating else Exponentials(view, tree, steps, frames).term(term)


class Exponentials:
    """A tree at many states."""

    def __init__(self, view: View, tree: Tree, steps: Steps, frames: Frames | None) -> None:
        self.in_bodies, self.frames = frames is not None, frames or Frames.AT_CENTRES
        self.view, self.tree, self.steps, self.q = view, tree, steps, view.states["q"][None]
        self.home = at_home(steps, tree)
        self.screws = {k.number: screw(steps, k, self.home) for k in tree.links if k.moves}

    @cached_property
    def exponentials(self) -> dict[int, Pose]:
        """Of the joints that move links."""
        return exponentials(self.steps, self.tree, self.screws, self.q)

    @cached_property
    def products(self) -> list[Pose]:
        """Up to every link, of which poses are made."""
        return products(self.steps, self.tree, self.exponentials, "in poses")

    def at_home(self, name: str) -> tuple[int, Pose]:
        """On which link a frame stands, and its pose at home."""
        number, H = self.tree.stands[name]
        return number, times(PLAIN, self.home[number], (H[None, None, :3, :3], H[None, None, :3, 3]))

    def frame(self, name: str) -> Pose:
        number, M = self.at_home(name)
        return standing(self.steps, self.tree, number, self.products, M, "of frames")

    @cached_property
    def bodies(self) -> dict[int, Pose]:
        """The poses of bodies' frames, at their centres of mass."""
        at = {k.number: frame_at_home(self.steps, k, self.home[k.number], self.frames) for k in self.tree.carried}
        return {
            number: standing(self.steps, self.tree, number, self.products, M, "of bodies") for number, M in at.items()
        }

    @cached_property
    def columns(self) -> dict[int, np.ndarray]:
        """Of every link that moves: Ad(T) S."""
        steps, out = self.steps, {}
        made = products(steps, self.tree, self.exponentials, "in columns")
        for k in (k for k in self.tree.links if k.moves):
            up = self.tree.links[k.parent]
            T, S = made[k.parent], self.screws[k.number]
            others = {
                "without that of the joint before": made[max(0, up.parent)],
                "that of the last link, where it should be none": T if k.parent else made[-1],
            }  # fmt: skip
            R, p = before(steps, self.tree, k, made, "in Ad of a column", **others)
            S = S + np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 6))
            back = {"by the inverse": partial(_of_inverse, (R, p))}
            out[k.number] = steps.turn("S in a column of the space Jacobian, Ad S,", adjoint(steps, R, p), S, **back)
        return out

    def jacobian(self, number: int) -> np.ndarray:
        """(runs, n, nv, 6) of a link, about the world's origin."""
        path = self.tree.joints_of(self.tree.links[number])
        return self.filled({k.column: self.columns[k.number] for k in path})

    def rate(self, number: int) -> np.ndarray:
        """Of the Jacobian."""
        v, steps, path = self.view.states["v"][None], self.steps, self.tree.joints_of(self.tree.links[number])
        V: np.ndarray = np.zeros((*self.q.shape[:-1], 6))
        whole = V + sum(self.columns[k.number] * v[..., k.column, None] for k in path)
        of, U = dict[int, np.ndarray](), 0 * V
        for k in path:
            J, rate = self.columns[k.number], v[..., k.column, None]
            up = steps.pick("the velocity in V x J", V + 0 * J, **other_velocities(V, whole, U, J, rate))
            of[k.column] = crm(steps, "dJ/dt = V x J", up, J)
            U, V = U + J, steps.add("the velocity of the joints before", **{"the sum so far": V, "J qd": J * rate})
        return self.filled(of)

    def filled(self, columns: dict[int, np.ndarray]) -> np.ndarray:
        zero = np.zeros((*self.q.shape[:-1], 6))
        lead = np.broadcast_shapes(zero.shape, *(x.shape for x in columns.values()))
        return np.stack([np.broadcast_to(columns.get(i, zero), lead) for i in range(self.tree.nv)], -2)

    def _at(self, J: np.ndarray, p: np.ndarray, what: str) -> np.ndarray:
        """Of a point at p."""
        w, u = J[..., :3], J[..., 3:]
        arm = cross(p[..., None, :] + 0 * w, w)
        linear = self.steps.add(f"the linear part of {what}", **{"that at the world's origin": u, "-p x w": -arm})
        return np.concatenate(np.broadcast_arrays(w, linear), -1)

    def _brought(self, T: Pose, J: np.ndarray, to: str) -> np.ndarray:
        """Ad(T^-1) J."""
        A = adjoint(self.steps, *inverted(self.steps, T))[..., None, :, :]
        others = {
            "by Ad(T), not of the inverse": lambda: adjoint(Steps(), *T)[..., None, :, :],
            "as forces, by Ad(T)^T": lambda: transposed(adjoint(Steps(), *T))[..., None, :, :],
        }  # fmt: skip
        return np.asarray(self.steps.turn(f"the space Jacobian, brought to {to},", A, J, **others))

    def of_frame(self, name: str, term: str) -> np.ndarray:
        """A Jacobian (runs, n, 6, nv), or its rate."""
        number, reference = self.tree.stands[name][0], self.view.layout.how.reference
        J, v = self.jacobian(number), self.view.states["v"][None]
        if reference == "world":
            return transposed(J if term == "jacobian" else self.rate(number))
        T = self.frame(name)
        if reference == "local":
            V = product(transposed(J), v)[..., None, :]
            D = J if term == "jacobian" else self.rate(number) - crm(self.steps, "the turning of a frame", V + 0 * J, J)
            return transposed(self._brought(T, D, "a frame"))
        p = T[1]
        here = self._at(J, p, "the Jacobian of a frame")
        if term == "jacobian":
            return transposed(here)
        D = self._at(self.rate(number), p, "the rate of the Jacobian of a frame")
        speed, w = product(transposed(here[..., 3:]), v), J[..., :3]
        terms = {"that of a point at rest": D[..., 3:], "-dp/dt x w": -cross(speed[..., None, :] + 0 * w, w)}
        linear = self.steps.add("the rate of the linear part, of a frame that moves,", **terms)
        return transposed(np.concatenate(np.broadcast_arrays(D[..., :3], linear), -1))

    def _frames(self, term: str) -> np.ndarray:
        return stacked([self.of_frame(name, term) for name in self.view.frames])

    def term(self, term: str) -> np.ndarray | None:
        states, bodies = self.view.states, self.tree.carried
        if term == "fk":
            return self._fk()
        if term == "frame_acceleration":
            v, a = (states[x][None, :, None] for x in ("v", "a"))
            parts = {"J a": product(self._frames("jacobian"), a), "dJ/dt v": product(self._frames("jacobian_dot"), v)}
            return np.asarray(self.steps.add("the acceleration of a frame", **parts))
        if term == "coriolis":
            dM = np.asarray(sum(self._derivative(k) for k in bodies))
            return of_symbols(Steps(), dM, states["v"])
        if term in OF_FRAMES:
            x = self._frames("jacobian" if term == "frame_velocity" else term)
            return product(x, states["v"][None, :, None]) if term == "frame_velocity" else x
        total = sum(k.mass for k in bodies)
        if term == "com":
            return self.com
        if term == "potential_energy":
            return np.asarray(-total * (self.tree.gravity * self.com).sum(-1))
        if term == "com_jacobian":
            J = np.asarray(sum(k.mass * self._in_world(k) for k in bodies))
            return transposed(J) / total
        of_body = {"gravity": self._pull, "centroidal_momentum_matrix": self._momentum}.get(term, self._mass)
        x = np.asarray(sum(of_body(k) for k in bodies))
        return (
            np.asarray(0.5 * (states["v"] * product(x, states["v"][None])).sum(-1)) if term == "kinetic_energy" else x
        )

    def _fk(self) -> np.ndarray:
        out = []
        for R, p in map(self.frame, self.view.frames):
            T = np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 4, 4))
            T[..., :3, :3], T[..., :3, 3], T[..., 3, 3] = R, p, 1.0
            out.append(T)
        return stacked(out)

    @cached_property
    def com(self) -> np.ndarray:
        bodies = self.tree.carried
        return np.asarray(sum(k.mass * self.bodies[k.number][1] for k in bodies) / sum(k.mass for k in bodies))

    def body(self, k: Link) -> np.ndarray:
        """(runs, n, nv, 6) of the centre of mass, in world axes, or about it in the axes of the body's frame."""
        J, T = self.jacobian(k.number), self.bodies[k.number]
        return self._brought(T, J, "a body") if self.in_bodies else self._at(J, T[1], "the Jacobian of a body")

    def _in_world(self, k: Link) -> np.ndarray:
        """The velocity of a centre of mass."""
        v = self.body(k)[..., 3:]
        R = self.bodies[k.number][0][..., None, :, :]
        return self.steps.turn("the velocity of a body's centre, in world axes,", R, v) if self.in_bodies else v

    def _pull(self, k: Link) -> np.ndarray:
        """Of gravity on the columns of a body (runs, n, nv)."""
        g, R = self.tree.gravity + np.zeros(3), self.bodies[k.number][0]
        if self.in_bodies:
            g = self.steps.turn("gravity, in the axes of a body,", transposed(R), g + 0 * R[..., 0])
        return -k.mass * product(self.body(k)[..., 3:], g)

    def _mass(self, k: Link) -> np.ndarray:
        J, R = self.body(k), self.bodies[k.number][0]
        if self.in_bodies:
            return np.asarray(J @ spatial_inertia(self.steps, k, self.home[k.number], self.frames) @ transposed(J))
        w, u, I = J[..., :3], J[..., 3:], R @ k.I @ transposed(R)
        terms = {"m Jv^T Jv": k.mass * u @ transposed(u), "Jw^T I Jw": w @ I @ transposed(w)}
        return np.asarray(self.steps.add("the mass matrix of a body", **terms))

    def _derivative(self, k: Link) -> np.ndarray:
        """dM_ij/dq_l of a body (runs, n, i, j, l), dJ_j/dq_l = J_j x J_l of the joints l behind j."""
        steps, J, nv = self.steps, self.body(k), self.tree.nv
        path = [link.column for link in self.tree.joints_of(k)]
        behind = np.zeros((nv, nv))
        for place, column in enumerate(path):
            behind[column, path[place + 1 :]] = 1.0
        others = {"before it": behind.T[None, None], "of all its path": (behind + behind.T)[None, None]}
        behind = steps.pick("the joints by which a column has a derivative, those", behind[None, None], **others)
        dJ = crm(steps, "J_j x J_l of body Jacobians", J[..., :, None, :], J[..., None, :, :]) * behind[..., None]
        G = spatial_inertia(steps, k, self.home[k.number], self.frames)
        one = np.einsum("...ilx,...jx->...ijl", dJ, J @ G)
        terms = {"dJ^T G J": one, "J^T G dJ": np.swapaxes(one, -3, -2)}
        return np.asarray(steps.add("the derivative of a body's mass matrix", **terms))

    def _momentum(self, k: Link) -> np.ndarray:
        """About the centre of mass, in world axes (runs, n, 6, nv)."""
        G = spatial_inertia(self.steps, k, self.home[k.number], self.frames)
        back, centre = inverted(self.steps, self.bodies[k.number]), (ONE[None, None], self.com)
        site = "the pose of the centre of mass, in a body's frame,"
        made = times(PLAIN, back, centre)
        T = multiplied(self.steps, PLAIN, site, ("T_b^-1", back), ("T_c", lambda: centre), made)
        X = adjoint(self.steps, *T)[..., None, :, :]
        return transposed(to_parent(self.steps, "the momentum of a body, Ad^T G J,", X, self.body(k) @ transposed(G)))


def other_velocities(
    V: np.ndarray, whole: np.ndarray, U: np.ndarray, J: np.ndarray, rate: np.ndarray
) -> dict[str, np.ndarray]:  # fmt: skip
    """What stands in the place of V, of the joints before or behind: U is the sum of their columns."""
    return {
        "that of the link itself, in every column": whole + 0 * J, "without the rates of joints": U + 0 * J,
        "made with the rate of the column's own joint": U * rate,
        "that of the joints on the other side": whole - V - J * rate,
    }  # fmt: skip


def _of_inverse(T: Pose) -> np.ndarray:
    return adjoint(Steps(), *inverted(Steps(), T))
