"""Poses and Jacobians by products of exponentials of screws, in the space frame.

    T_k = T_p exp(S_k q_k)      pose of link k = T_k M_k,  M_k its pose at home
    S = [w; -w x p] of a turning joint, [0; w] of a sliding one, at home
    exp(S q) = (R, G v):   R = 1 + sin q [w] + (1 - cos q) [w]^2,   G = q 1 + (1 - cos q) [w] + (q - sin q) [w]^2
    J_k = Ad(T_p) S_k,   dJ_k/dt = V_p x J_k       V_p of the joints before
    M = sum J_b^T G_b J_b,   J_b = Ad(T_c^-1) J about the centre of mass, in the link's axes

Six-vectors are [angular; linear] of the point at the world's origin.  Arrays have the axes (runs, samples, ...).

References: Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation (1994), sections 2.3, 3.2 and
3.4; Lynch and Park, Modern Robotics (2017), sections 4.1 and 5.1.
"""

from __future__ import annotations

from functools import cached_property, partial

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from ..case import View
from .attitudes import PLAIN
from .products import crm
from .steps import Steps, cross
from .transforms import stacked
from .tree import Link, Tree, spatial, tree_of
from .turns import ONE, rodrigues
from .wholes import Pose, multiplied, times

OF_BODIES = ("gravity", "crba", "kinetic_energy")
OF_FRAMES = ("jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration")
TERMS = ("fk", *OF_FRAMES, "com", "com_jacobian", "potential_energy", *OF_BODIES)
START: Pose = (ONE[None, None], np.zeros((1, 1, 3)))


def run(view: View, term: str, steps: Steps, fused: bool = False, by_bodies: bool = False) -> np.ndarray | None:
    """The term (runs, samples, ...); `fused` as of `Tree`; `by_bodies`, if M is made of Jacobians in bodies' axes."""
    tree = tree_of(view, fused)
    if tree.floating or (term in OF_FRAMES and view.layout.how.reference != "local_world_aligned"):
        return None
    return Exponentials(view, tree, steps, by_bodies).term(term)


class Exponentials:
    """A tree at many states."""

    def __init__(self, view: View, tree: Tree, steps: Steps, by_bodies: bool) -> None:
        self.by_bodies = by_bodies
        self.view, self.tree, self.steps, self.q = view, tree, steps, view.states["q"][None]
        self.home, self.before, self.products = [START], [START], [START]
        self.screws: dict[int, np.ndarray] = {}
        for k in tree.links[1:]:
            self._add(k)

    def _add(self, k: Link) -> None:
        steps = self.steps
        up, on = self.home[k.parent], (k.R, k.p)
        site = "the pose of a link at home, the parent's times its own,"
        home = multiplied(steps, PLAIN, site, ("the parent's", up), ("its own", lambda: on), times(PLAIN, up, on))
        self.home.append(home)
        T = self.products[k.parent]
        self.before.append(T)
        if k.moves:
            S = self.screws[k.number] = self._screw(k, home)
            E = self._exponential(k, S, self.q[..., k.place])
            site = "the product of exponentials, those of the joints before times a joint's own,"
            made = times(PLAIN, T, E)
            T = multiplied(steps, PLAIN, site, ("those before", T), ("its own", lambda: E), made)
        self.products.append(T)

    def _screw(self, k: Link, home: Pose) -> np.ndarray:
        steps, (R, p) = self.steps, home
        others = {"by the parent's pose, without its own rpy": lambda: self.home[k.parent][0]}
        w = steps.turn("the axis of a screw, at home,", R, k.z + 0 * p, **others)
        lever, six = cross(w, p), partial(np.concatenate, axis=-1)
        turning, sliding = six([w, -lever]), six([0 * w, w])
        if k.slides:
            wrong = {"[w; 0], as of a turning one": six([w, 0 * w]), "[w; -w x p], as of a turning one": turning}
            wrong |= {"-[0; w]": -sliding, "[w; w]": six([w, w])}
            return np.asarray(steps.pick("the screw of a sliding joint", sliding, **wrong))
        wrong = {
            "[w; w x p], with the other sign": six([w, lever]), "[w; 0], without its place": six([w, 0 * w]),
            "[w; p], with its place itself": six([w, p]), "[0; w], as of a sliding one": sliding,
            "-[w; -w x p]": -turning,
            "[w; -w x p] with the parent's place": six([w, -cross(w, self.home[k.parent][1])]),
        }  # fmt: skip
        return np.asarray(steps.pick("the screw of a turning joint", turning, **wrong))

    def _exponential(self, k: Link, S: np.ndarray, q: np.ndarray) -> Pose:
        """exp(S q), by whether the joint turns."""
        w, v, x = S[..., :3], S[..., 3:], q[..., None]
        slid = v * x
        if k.slides:
            alone = {"v, without q": v + 0 * x}
            return ONE[None, None], self.steps.pick("the position of a sliding joint's exponential", slid, **alone)
        R, W = rodrigues(self.steps, w, q), cross_matrix(w)
        t = x[..., None]
        s, c, steps = np.sin(t), np.cos(t), self.steps
        first = {"1 + cos q": 1 + c, "sin q": s, "cos q": c, "1": 0 * c + 1, "-cos q": -c}
        second = {"q + sin q": t + s, "sin q": s, "q": t, "1 - cos q": 1 - c, "q - cos q": t - c, "-sin q": -s}
        f = steps.pick("the factor of [w] in G of an exponential", 1 - c, **first)
        g = steps.pick("the factor of [w]^2 in G of an exponential", t - s, **second)
        W2 = steps.pick("[w]^2 in G of an exponential", W @ W, **{"[w]": W, "w w^T": w[..., None] * w[..., None, :]})
        one = steps.pick("q 1 in G of an exponential", t * ONE, **{"1, without q": ONE + 0 * t})
        G = steps.add("G of an exponential", **{"q 1": one, "(1 - cos q) [w]": f * W, "(q - sin q) [w]^2": g * W2})
        p = steps.turn("v of a screw, in the position G v of an exponential,", G, v)
        others = {"v q, as of a sliding joint": slid, "p - R p of the joint, with the other sign": -p}
        return R, np.asarray(steps.pick("the position of an exponential", p, **others))

    def pose(self, k: int) -> Pose:
        T, M = self.products[k], self.home[k]
        site = "the pose of a link, the product of exponentials times its pose at home,"
        made = times(PLAIN, T, M)
        return multiplied(self.steps, PLAIN, site, ("the product", T), ("the pose at home", lambda: M), made)

    @cached_property
    def poses(self) -> list[Pose]:
        return [self.pose(k.number) for k in self.tree.links]

    def place(self, number: int, c: np.ndarray) -> np.ndarray:
        R, p = self.poses[number]
        return p + product(R, c + 0 * p)

    @cached_property
    def columns(self) -> dict[int, np.ndarray]:
        """Of every link that moves: Ad(T) S."""
        steps, out = self.steps, {}
        for k in (k for k in self.tree.links if k.moves):
            (R, p), S = self.before[k.number], self.screws[k.number]
            S = S + np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 6))
            out[k.number] = steps.turn("S in a column of the space Jacobian, Ad S,", adjoint(steps, R, p), S)
        return out

    def jacobian(self, number: int, rate: bool = False) -> np.ndarray:
        """(runs, n, nv, 6) of a link, or its rate."""
        v, zero = self.view.states["v"][None], np.zeros((*self.q.shape[:-1], 6))
        of: dict[int, np.ndarray] = {}
        V = zero
        for k in self.tree.joints_of(self.tree.links[number]):
            J = self.columns[k.number]
            of[k.column] = crm(self.steps, "dJ/dt = V x J", V + 0 * J, J) if rate else J
            V = self.steps.add("the velocity of the joints before", **{"theirs": V, "J qd": J * v[..., k.column, None]})
        lead = np.broadcast_shapes(zero.shape, *(x.shape for x in of.values()))
        return np.stack([np.broadcast_to(of.get(i, zero), lead) for i in range(self.tree.nv)], -2)

    def _at(self, J: np.ndarray, p: np.ndarray, what: str) -> np.ndarray:
        """Of a point at p."""
        w, u = J[..., :3], J[..., 3:]
        arm = cross(p[..., None, :] + 0 * w, w)
        linear = self.steps.add(f"the linear part of {what}", **{"that at the world's origin": u, "-p x w": -arm})
        return np.concatenate(np.broadcast_arrays(w, linear), -1)

    def _of_frame(self, number: int, r: np.ndarray, term: str) -> np.ndarray:
        """A Jacobian (runs, n, 6, nv) at a place on a link, or its rate."""
        p, J = self.place(number, r), self.jacobian(number)
        here = self._at(J, p, "the Jacobian of a frame")
        if term == "jacobian":
            return transposed(here)
        D, v = self._at(self.jacobian(number, True), p, "the rate of the Jacobian of a frame"), self.view.states["v"]
        speed = product(transposed(here[..., 3:]), v[None])
        w = J[..., :3]
        terms = {"that of a point at rest": D[..., 3:], "-dp/dt x w": -cross(speed[..., None, :] + 0 * w, w)}
        linear = self.steps.add("the rate of the linear part, of a frame that moves,", **terms)
        return transposed(np.concatenate(np.broadcast_arrays(D[..., :3], linear), -1))

    def _frames(self, term: str) -> np.ndarray:
        return stacked([self._of_frame(*self.tree.frames[frame], term) for frame in self.view.frames])

    def term(self, term: str) -> np.ndarray | None:
        states, tree = self.view.states, self.tree
        if term == "fk":
            return self._fk()
        if term == "frame_acceleration":
            v, a = (states[x][None, :, None] for x in ("v", "a"))
            parts = {"J a": product(self._frames("jacobian"), a), "dJ/dt v": product(self._frames("jacobian_dot"), v)}
            return np.asarray(self.steps.add("the acceleration of a frame", **parts))
        if term in OF_FRAMES:
            x = self._frames("jacobian" if term == "frame_velocity" else term)
            return product(x, states["v"][None, :, None]) if term == "frame_velocity" else x
        total = sum(k.mass for k in tree.carried)
        if term in ("com", "potential_energy"):
            com = sum(k.mass * self.place(k.number, k.c) for k in tree.carried) / total
            return np.asarray(com if term == "com" else -total * (tree.gravity * com).sum(-1))
        if term == "com_jacobian":
            J = np.asarray(sum(k.mass * self.body(k)[1] for k in tree.carried))
            return transposed(J) / total
        if term == "gravity":
            return np.asarray(sum(self._pull(k) for k in tree.carried))
        M = np.asarray(sum(self._mass(k) for k in tree.carried))
        return M if term == "crba" else np.asarray(0.5 * (states["v"] * product(M, states["v"][None])).sum(-1))

    def _fk(self) -> np.ndarray:
        out = []
        for number, H in (self.tree.stands[frame] for frame in self.view.frames):
            R, p = self.poses[number][0] @ H[:3, :3], self.place(number, H[None, None, :3, 3])
            T = np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 4, 4))
            T[..., :3, :3], T[..., :3, 3], T[..., 3, 3] = R, p, 1.0
            out.append(T)
        return stacked(out)

    def body(self, k: Link) -> tuple[np.ndarray, np.ndarray]:
        """Angular columns (runs, n, nv, 3), and those of the centre of mass, in world axes."""
        J = self._at(self.jacobian(k.number), self.place(k.number, k.c), "the Jacobian of a body")
        return J[..., :3], J[..., 3:]

    def body_jacobian(self, k: Link) -> np.ndarray:
        """(runs, n, nv, 6) about the centre of mass, in the link's axes."""
        back, c = inverse(self.poses[k.number][0]), self.place(k.number, k.c)
        A = adjoint(self.steps, back, -product(back, c))
        return np.asarray(
            self.steps.turn("the space Jacobian, brought to a body,", A[..., None, :, :], self.jacobian(k.number))
        )

    def _pull(self, k: Link) -> np.ndarray:
        """Of gravity on the columns of a body (runs, n, nv)."""
        g = self.tree.gravity + np.zeros(3)
        if not self.by_bodies:
            return -k.mass * product(self.body(k)[1], g)
        R = self.poses[k.number][0]
        down = self.steps.turn("gravity, in the axes of a body,", transposed(R), g + 0 * R[..., 0])
        return -k.mass * product(self.body_jacobian(k)[..., 3:], down)

    def _mass(self, k: Link) -> np.ndarray:
        if self.by_bodies:
            J = self.body_jacobian(k)
            w, u, I = J[..., :3], J[..., 3:], k.I
        else:
            (w, u), R = self.body(k), self.poses[k.number][0]
            I = R @ k.I @ transposed(R)
        terms = {"m Jv^T Jv": k.mass * u @ transposed(u), "Jw^T I Jw": w @ I @ transposed(w)}
        return np.asarray(self.steps.add("the mass matrix of a body", **terms))


def adjoint(steps: Steps, R: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Ad(T) = [R 0; [p x] R  R]."""
    P = cross_matrix(p)
    wrong = {
        "R [p x], in the other order": R @ P, "-[p x] R": -P @ R, "left out": 0 * (P @ R),
        "[p x], without R": P + 0 * R, "R, without [p x]": R + 0 * P,
    }  # fmt: skip
    lower = steps.pick("the block [p x] R of Ad", P @ R, **wrong)
    return spatial([[R, 0 * R], [lower, R]])


def inverse(R: np.ndarray) -> np.ndarray:
    """Of what may be no rotation; not-a-number where there is none."""
    a, b, c = np.moveaxis(R, -2, 0)
    columns = np.stack([cross(b, c), cross(c, a), cross(a, b)], -1)
    return np.asarray(columns / (a * cross(b, c)).sum(-1)[..., None, None])
