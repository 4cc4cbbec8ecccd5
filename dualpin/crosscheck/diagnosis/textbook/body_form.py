"""Jacobians of products of exponentials, seen from the frame that is moved.

    B_k = Ad(M^-1) S_k       M the pose of the frame at home
    J_k = Ad(exp(-B_n q_n) ... exp(-B_(k+1) q_(k+1))) B_k       in the axes of the frame, about its origin
    dJ_k/dt = -V x J_k       V of the joints behind

References: Lynch and Park, Modern Robotics (2017), sections 4.1.2 and 5.1.2.
"""

from __future__ import annotations

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .arrays import cross
from .attitudes import PLAIN
from .body_twists import Frames, frame_at_home
from .exponentials import IN_BODIES, OF_FRAMES, Exponentials, other_velocities
from .products import crm
from .screws import START, adjoint, exponential, inverted, six
from .steps import Steps
from .tree import Link, tree_of
from .wholes import Pose, itself, multiplied, times

TERMS = (*OF_FRAMES, *IN_BODIES)


def run(
    view: View, term: str, steps: Steps, fused: bool = False, frames: Frames = Frames.AT_CENTRES
) -> np.ndarray | None:
    """The term (runs, samples, ...); `fused` as of `Tree`."""
    tree = tree_of(view, fused)
    reference = view.layout.how.reference
    if tree.floating or (reference == "world" and term in OF_FRAMES):
        return None
    return BodyForm(view, tree, steps, frames).term(term)


class BodyForm(Exponentials):
    """A tree at many states."""

    def in_frame(self, number: int, M: Pose) -> dict[int, np.ndarray]:
        """The columns of what stands at M at home, on a link: those of the joints next to it first."""
        steps, columns = self.steps, dict[int, np.ndarray]()
        back, T, last = adjoint(steps, *inverted(steps, M)), START, START
        turned = {"by Ad(M), with M not inverted": lambda: adjoint(Steps(), *M)}
        for k in reversed(self.tree.joints_of(self.tree.links[number])):
            S = self.screws[k.number] + 0 * back[..., 0]
            B = steps.turn("a screw in the frame whose Jacobian it is, B = Ad(M^-1) S,", back, S, **turned)
            others = {
                "by the inverse": lambda T=T: adjoint(Steps(), *inverted(Steps(), T)),
                "without the last exponential": lambda last=last: adjoint(Steps(), *last),
            }  # fmt: skip
            A = adjoint(steps, *T)
            columns[k.column] = steps.turn("B in a column of the body Jacobian, Ad B,", A, B + 0 * A[..., 0], **others)
            q = self.q[..., k.place]
            x = steps.pick("-q in exp(-B q) of the body Jacobian", -q, **{"q, with the other sign": q})
            E, last = exponential(steps, B, x), T
            site = "the product of exponentials of the body Jacobian, those of the joints behind times a joint's own,"
            made = times(PLAIN, T, E)
            T = multiplied(steps, PLAIN, site, ("those behind", T), ("its own", itself(E)), made)
        return columns

    def of_frame(self, name: str, term: str) -> np.ndarray:
        """The Jacobian of a frame (runs, n, 6, nv), or its rate."""
        columns = self.in_frame(*self.at_home(name))
        J, aligned = self.filled(columns), self.view.layout.how.reference != "local"
        D = self.filled(self._rates(columns)) if term == "jacobian_dot" else J
        if aligned and term == "jacobian_dot":  # d/dt (R J) = R (dJ/dt + w x J)
            spin = product(transposed(J[..., :3]), self.view.states["v"][None])[..., None, :] + 0 * J[..., :3]
            turning = six([cross(spin, J[..., :3]), cross(spin, J[..., 3:])])
            parts = {"dJ/dt in its axes": D, "w x J, the turning of the frame": turning}
            D = self.steps.add("the rate of the body Jacobian, of a frame that turns,", **parts)
        w, v = D[..., :3], D[..., 3:]
        if aligned:
            R = self.frame(name)[0][..., None, :, :]
            site = "the body Jacobian, in world axes"
            w, v = self.steps.turn(f"{site}: its angular part", R, w), self.steps.turn(f"{site}: its linear part", R, v)
        return transposed(six([w, v]))

    def _rates(self, columns: dict[int, np.ndarray]) -> dict[int, np.ndarray]:
        v, steps, rates = self.view.states["v"][None], self.steps, dict[int, np.ndarray]()
        V: np.ndarray = np.zeros((*self.q.shape[:-1], 6))
        U, whole = 0 * V, V + sum(J * v[..., i, None] for i, J in columns.items())
        for i, J in columns.items():
            rate = v[..., i, None]
            behind = steps.pick("the velocity in -V x J", V + 0 * J, **other_velocities(V, whole, U, J, rate))
            rates[i] = -crm(steps, "dJ/dt = -V x J", behind, J)
            U, V = U + J, steps.add("the velocity of the joints behind", **{"the sum so far": V, "J qd": J * rate})
        return rates

    def body(self, k: Link) -> np.ndarray:
        """(runs, n, nv, 6), in the frame of a body."""
        M = frame_at_home(self.steps, k, self.home[k.number], self.frames)
        return self.filled(self.in_frame(k.number, M))
