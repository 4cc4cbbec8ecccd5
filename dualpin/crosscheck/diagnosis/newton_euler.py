"""Newton's and Euler's equations link by link in the world frame, as textbooks write them, with slips.

Hypotheses of *what was left out* need an algorithm in which the terms that can be forgotten stand one by
one; dualpin's own has none of them, since a dual cross product holds them all.  So this module predicts
wrong answers; right ones it only reproduces (the tests check that it does).

    w_i = w_p + z v                     alpha_i = alpha_p + z a + w_p x z v                 (turning)
    a_i = a_p + alpha x r + w x (w x r) + z a + 2 w_p x z v                                 (sliding)
    f_i = m (a_c - g)                   n_i = I alpha + w x I w

References: Craig, Introduction to Robotics (2005), section 6.5; Siciliano et al., Robotics (2009), section 7.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...model.robot import Joint, Robot
from ...spatial.adjoint import cross_matrix
from ..subjects.convention import base_of
from ..subjects.layout import product, rotations, transposed
from .description import Description, Part
from .description import merged as merged_bodies

SLIPS = {
    "gyroscopic": "w x I w is left out",
    "gyroscopic_sign": "w x I w has the other sign",
    "gyroscopic_half": "w x I w is counted half",
    "inertia_frame_half": "inertia is turned into world axes from one side alone (R I in place of R I R^T)",
    "inertia_frame": "inertia is not turned into world axes (R I R^T is missing)",
    "inertia_frame_transposed": "inertia is turned the wrong way into world axes (R^T I R)",
    "centripetal": "w x (w x r) is left out",
    "centripetal_com": "w x (w x r) is left out from a link's origin to its centre of mass",
    "centripetal_link": "w x (w x r) is left out from joint to joint",
    "centripetal_sign": "w x (w x r) has the other sign",
    "centripetal_com_sign": "w x (w x r) has the other sign from a link's origin to its centre of mass",
    "centripetal_link_sign": "w x (w x r) has the other sign from joint to joint",
    "tangential": "alpha x r is left out",
    "tangential_com": "alpha x r is left out from a link's origin to its centre of mass",
    "tangential_link": "alpha x r is left out from joint to joint",
    "tangential_sign": "alpha x r (in Jacobians: axis x arm) has the other sign",
    "tangential_com_sign": "alpha x r has the other sign from a link's origin to its centre of mass",
    "tangential_link_sign": "alpha x r has the other sign from joint to joint",
    "axis_rate": "w x z v, the turning of a joint's axis, is left out of angular accelerations",
    "axis_rate_sign": "w x z v has the other sign in angular accelerations",
    "axis_rate_twice": "w x z v is counted twice in angular accelerations",
    "slide_acceleration": "z a of sliding joints is left out of accelerations",
    "slide_moment": "sliding joints feel the moment along their axis, not the force",
    "slide_coriolis": "2 w x z v of sliding joints is left out",
    "slide_coriolis_half": "w x z v of sliding joints is counted once, not twice",
    "slide_coriolis_sign": "2 w x z v of sliding joints has the other sign",
    "slide_radius": "the position of sliding joints is left out of the lever arms",
    "axis_frame": "axes of joints are not turned into world axes",
    "slide_axis_frame": "axes of sliding joints are not turned into world axes",
    "moment_arm": "forces act at links' origins, not at their centres of mass",
    "moment_arm_sign": "the moment of a body's force about its link's origin has the other sign",
    "force_moment": "the moment of forces about the joints is left out",
    "force_moment_link": "the moment r x f of a force that is handed on from joint to joint is left out",
    "force_moment_link_sign": "the moment r x f of a force that is handed on from joint to joint has the other sign",
    "no_translational": "m a is left out",
    "no_angular_acceleration": "I alpha is left out",
    "not_handed_on": "forces and moments are not handed on: each joint feels its own link alone",
    "moment_not_handed_on": "moments are not handed on from joint to joint, forces are",
    "gravity_at_origin": "gravity acts at links' origins, not at their centres of mass",
    "gravity_in_base": "gravity turns with the base",
    "gravity_each_link": "gravity is added at every link, not at the base alone",
}
"""Terms that may be missing, by key."""


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of the last axis; quicker than NumPy's for short arrays."""
    return a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT]


_NEXT, _LAST = [1, 2, 0], [2, 0, 1]


@dataclass
class _Link:
    """A link in the world: pose, axis of its joint, velocities and accelerations; arrays over the samples."""

    R: np.ndarray
    p: np.ndarray
    w: np.ndarray
    alpha: np.ndarray
    a: np.ndarray
    z: np.ndarray
    at: np.ndarray  # a point of the joint's axis
    slides: bool
    column: int  # in v; -1 for a link that is fixed to its parent
    parent: int


@dataclass(frozen=True)
class Lump:
    """What is taken for one body: mass, centre and inertia about it, on link number `link`."""

    link: int
    mass: float
    com: np.ndarray
    inertia: np.ndarray


class NewtonEuler:
    """The tree of one description.

    Parameters
    ----------
    merged : bool
        Fixed links are merged into the bodies that carry them, as many codes do before they start.
    """

    def __init__(self, robot: Robot, d: Description, slip: str, merged: bool = False) -> None:
        self.robot, self.d, self.slip, self.merged = robot, merged_bodies(d) if merged else d, slip, merged
        self.gravity = np.array(d.gravity)
        self.floating = base_of(robot) is not None

    def without(self, *slips: str) -> bool:
        return self.slip in slips

    def share(self, *slips: str) -> float:
        """How often a term counts: 0 where it is left out, -1 where it has the other sign, ..."""
        if self.slip in slips:
            return 0.0
        base, _, how = self.slip.rpartition("_")
        return {"sign": -1.0, "half": 0.5, "twice": 2.0}.get(how, 1.0) if base in slips else 1.0

    def forces(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
        """tau (n, nv) for the velocities and accelerations, under the gravity g."""
        links = self._motions(q, v, a)
        out = np.zeros((len(q), self.robot.nv), q.dtype)
        R0 = links[0].R
        for lump in self._lumps():
            k = links[lump.link]
            r = product(k.R, lump.com)
            a_c = k.a + self.share("tangential", "tangential_com") * cross(k.alpha, r)
            a_c = a_c + self.share("centripetal", "centripetal_com") * cross(k.w, cross(k.w, r))
            weight = -lump.mass * (product(R0, g) if self.without("gravity_in_base") else g)
            if self.without("gravity_each_link"):
                weight = weight * (1 + self._depth(links, lump.link))
            push = np.zeros_like(a_c) if self.without("no_translational") else lump.mass * a_c
            n = self._moment(k, lump)
            arm = self.share("moment_arm") * r
            at, low = k.p + arm, k.p if self.without("gravity_at_origin") else k.p + arm
            self._into(out, links, lump.link, push, n, at, np.broadcast_to(weight, push.shape), low)
        return out

    def accelerations(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, frames: Sequence[str]) -> np.ndarray:
        """(n, frames, 6): alpha, and the acceleration of the frame's origin, in world axes."""
        links = self._motions(q, v, a)
        number = {self.d.root: 0} | {p.link: k + 1 for k, p in enumerate(self.d.parts)}
        seen = [links[number[f]] for f in frames]
        return np.stack([np.concatenate([k.alpha, k.a], -1) for k in seen], axis=1)

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        """Column by column: the forces of unit accelerations, at rest and without gravity."""
        columns = self.forces(*self._unit(q), np.zeros(3))
        return columns.reshape(self.robot.nv, len(q), -1).transpose(1, 2, 0)

    def energy_matrix(self, q: np.ndarray) -> np.ndarray:
        """The mass matrix as kinetic energy has it: sum m Jv^T Jv + Jw^T I Jw, with the slips of the Jacobians."""
        links, shape = self._motions(*self._unit(q)), (self.robot.nv, len(q), 3)
        M = np.zeros((len(q), self.robot.nv, self.robot.nv), q.dtype)
        for lump in self._lumps():
            k = links[lump.link]
            r = product(k.R, lump.com)
            arm = self.share("moment_arm") * self.share("tangential", "tangential_com") * cross(k.alpha, r)
            Jv, Jw = (k.a + arm).reshape(shape), k.alpha.reshape(shape)
            IJw = product(self._inertia(k, lump), k.alpha).reshape(shape)
            if not self.without("no_translational"):
                M += lump.mass * np.einsum("ind,jnd->nij", Jv, Jv)
            if not self.without("no_angular_acceleration"):
                M += np.einsum("ind,jnd->nij", Jw, IJw)
        return M

    def momentum(self, q: np.ndarray) -> np.ndarray:
        """(n, 6, nv): momentum about the centre of mass of what moves, per unit velocity."""
        links, shape = self._motions(*self._unit(q)), (self.robot.nv, len(q), 3)
        G, total = self.centre(q), np.zeros((len(q), 6, self.robot.nv), q.dtype)
        for lump in self._lumps():
            k = links[lump.link]
            r = product(k.R, lump.com)
            v = lump.mass * (k.a + cross(k.alpha, r))
            spin = self.share("spin") * product(self._inertia(k, lump), k.alpha)
            orbit = self.share("orbit") * cross(k.p + r - np.tile(G, (self.robot.nv, 1)), v)
            total += np.concatenate([spin + orbit, v], -1).reshape(*shape[:2], 6).transpose(1, 2, 0)
        return total

    def centre(self, q: np.ndarray) -> np.ndarray:
        """(n, 3): the centre of mass of what joints move."""
        links = self._motions(q, np.zeros((len(q), self.robot.nv)), np.zeros((len(q), self.robot.nv)))
        weight, moment = 0.0, np.zeros((len(q), 3))
        for lump in self._lumps():
            if self._depth(links, lump.link, joints=True) or self.floating:
                m, k = 1.0 if self.without("com_unweighted") else lump.mass, links[lump.link]
                weight += m
                moment += m * (k.p + (lump.com if self.without("com_frame") else product(k.R, lump.com)))
        return moment / weight

    def _unit(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Every state at rest under every unit acceleration."""
        n, nv = len(q), self.robot.nv
        return np.tile(q, (nv, 1)), np.zeros((nv * n, nv)), np.repeat(np.eye(nv), n, axis=0)

    def _inertia(self, k: _Link, lump: Lump) -> np.ndarray:
        """About the centre of mass, in world axes."""
        if self.without("inertia_frame"):
            return np.broadcast_to(lump.inertia, k.R.shape)
        if self.without("inertia_frame_half"):
            return k.R @ lump.inertia
        if self.without("inertia_frame_transposed"):
            return transposed(k.R) @ lump.inertia @ k.R
        return k.R @ lump.inertia @ transposed(k.R)

    def _moment(self, k: _Link, lump: Lump) -> np.ndarray:
        """I alpha + w x I w about the centre of mass."""
        I = self._inertia(k, lump)
        spin = self.share("gyroscopic") * cross(k.w, product(I, k.w))
        return spin if self.without("no_angular_acceleration") else product(I, k.alpha) + spin

    def _into(
        self, out: np.ndarray, links: list[_Link], i: int, push: np.ndarray, n: np.ndarray, at: np.ndarray,
        weight: np.ndarray, low: np.ndarray,
    ) -> None:  # fmt: skip
        """The forces at the joints below a link that its force and moment cause."""
        own, whole, handed = links[i].p, self.share("force_moment"), self.share("force_moment_link")
        first, below = i, own

        def moment(o: np.ndarray, k: int) -> np.ndarray:
            """About o, as link k feels it: from the link's origin, then from there to o."""
            on = handed * (own - o)
            if self.without("moment_not_handed_on") and k != first:
                return cross(below - o, push + weight)
            return n + whole * (cross(at - own + on, push) + cross(low - own + on, weight))

        while i >= 0 and not (self.without("not_handed_on") and i != first):
            k = links[i]
            if k.column >= 0 and i > 0:
                if k.slides and not self.without("slide_moment"):
                    out[:, k.column] += (k.z * (push + weight)).sum(-1)
                else:
                    out[:, k.column] += (k.z * moment(k.p if k.slides else k.at, i)).sum(-1)
            elif i == 0 and self.floating:
                back = transposed(k.R)
                out[:, :3] += product(back, moment(k.p, i))
                out[:, 3:6] += product(back, push + weight)
            below = k.p if k.column >= 0 or not self.merged else below
            i = k.parent

    def _motions(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> list[_Link]:
        """Poses, velocities and accelerations of all links, parents first."""
        n, zero = len(q), np.zeros((len(q), 3), q.dtype)
        p: np.ndarray = zero
        w, alpha, acc = zero, zero, zero
        R: np.ndarray = np.broadcast_to(np.eye(3), (n, 3, 3))
        if self.floating:
            R, p = rotations(q[:, 3:7]), q[:, :3]
            w, alpha = product(R, v[:, :3]), product(R, a[:, :3])
            acc = product(R, a[:, 3:6] + cross(v[:, :3], v[:, 3:6]))
        root = _Link(R, p, w, alpha, acc, zero, p, False, -1, -1)
        links, number = [root], {self.d.root: 0}
        joints = {j.name: j for j in self.robot}
        for part in self.d.parts:
            parent = links[number[part.parent]]
            joint = joints.get(part.joint)
            number[part.link] = len(links)
            links.append(self._next(parent, number[part.parent], part, joint, q, v, a))
        return links

    def _next(
        self, up: _Link, parent: int, part: Part, joint: Joint | None, q: np.ndarray, v: np.ndarray, a: np.ndarray
    ) -> _Link:
        R, at = up.R @ part.rotation, up.p + product(up.R, part.position)
        w, alpha, zero = up.w, up.alpha, np.zeros_like(up.p)
        if joint is None:
            return _Link(R, at, w, alpha, self._carried(up, at - up.p), zero, at, False, -1, parent)
        if joint.model.nv != 1 or joint.mimic is not None:
            raise ValueError("joints with one coordinate of their own only")
        x, column = q[:, joint.q.start, None], joint.v.start
        xd, xdd = v[:, column, None], a[:, column, None]
        axis = part.unit_axis
        slides, along = part.slides, product(R, axis)
        local = self.without("axis_frame") or (slides and self.without("slide_axis_frame"))
        z = np.broadcast_to(axis, along.shape) if local else along  # of velocities and forces, not of poses
        if slides:
            p, arm = at + along * x, at - up.p + (0 if self.without("slide_radius") else along * x)
            twice = 2.0 * self.share("slide_coriolis")
            acc = self._carried(up, arm) + self.share("slide_acceleration") * z * xdd + twice * cross(w, z * xd)
        else:
            p, acc = at, self._carried(up, at - up.p)
            turning = self.share("axis_rate") * cross(w, z * xd)
            w, alpha = w + z * xd, alpha + z * xdd + turning
            K = cross_matrix(axis)
            R = R @ (np.eye(3) + np.sin(x)[..., None] * K + (1 - np.cos(x))[..., None] * (K @ K))
        if np.abs(part.after - np.eye(4)).max() > 0 or part.more.any():
            raise ValueError("a link that stands where its joint moves it")
        return _Link(R, p, w, alpha, acc, z, at, slides, column, parent)

    def _carried(self, up: _Link, r: np.ndarray) -> np.ndarray:
        """The acceleration of a point of the parent."""
        a = up.a + self.share("tangential", "tangential_link") * cross(up.alpha, r)
        return np.asarray(a + self.share("centripetal", "centripetal_link") * cross(up.w, cross(up.w, r)))

    def _depth(self, links: list[_Link], i: int, joints: bool = False) -> int:
        """How many links it is from the base; of merged bodies, or if only these count, how many joints."""
        steps = 0
        while i > 0:
            steps += links[i].column >= 0 or not (self.merged or joints)
            i = links[i].parent
        return steps

    def _lumps(self) -> list[Lump]:
        """What counts as bodies: links by themselves, or merged with what is fixed to them."""
        bodies = [self.d.base, *(p.body for p in self.d.parts)]
        return [Lump(k, b.mass, b.com, b.in_link) for k, b in enumerate(bodies) if b is not None and b.mass > 0]
