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

from dataclasses import dataclass

import numpy as np

from ...model.robot import Joint, Robot
from ..subjects.convention import base_of
from ..subjects.layout import cross_matrix, product, rotations, transposed
from .description import Description, Part

SLIPS = {
    "gyroscopic": "w x I w is left out",
    "gyroscopic_sign": "w x I w has the other sign",
    "inertia_frame": "inertia is not turned into world axes (R I R^T is missing)",
    "inertia_frame_transposed": "inertia is turned the wrong way into world axes (R^T I R)",
    "centripetal": "w x (w x r) is left out",
    "centripetal_com": "w x (w x r) is left out from a link's origin to its centre of mass",
    "centripetal_link": "w x (w x r) is left out from joint to joint",
    "tangential": "alpha x r is left out",
    "tangential_com": "alpha x r is left out from a link's origin to its centre of mass",
    "tangential_link": "alpha x r is left out from joint to joint",
    "axis_rate": "w x z v, the turning of a joint's axis, is left out of angular accelerations",
    "axis_rate_sign": "w x z v has the other sign in angular accelerations",
    "slide_coriolis": "2 w x z v of sliding joints is left out",
    "slide_coriolis_half": "w x z v of sliding joints is counted once, not twice",
    "slide_radius": "the position of sliding joints is left out of the lever arms",
    "axis_frame": "axes of joints are not turned into world axes",
    "slide_axis_frame": "axes of sliding joints are not turned into world axes",
    "moment_arm": "forces act at links' origins, not at their centres of mass",
    "force_moment": "the moment of forces about the joints is left out",
    "no_translational": "m a is left out",
    "no_angular_acceleration": "I alpha is left out",
    "gravity_at_origin": "gravity acts at links' origins, not at their centres of mass",
    "gravity_in_base": "gravity turns with the base",
}
"""What may be forgotten, by key."""


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
        self.robot, self.d, self.slip, self.merged = robot, d, slip, merged
        self.gravity = np.array(d.gravity)
        self.floating = base_of(robot) is not None

    def without(self, *slips: str) -> bool:
        return self.slip in slips

    def forces(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
        """tau (n, nv) for the velocities and accelerations, under the gravity g."""
        links = self._motions(q, v, a)
        out = np.zeros((len(q), self.robot.nv), q.dtype)
        R0 = links[0].R
        for lump in self._lumps():
            k = links[lump.link]
            r = product(k.R, lump.com)
            a_c = k.a.copy()
            if not self.without("tangential", "tangential_com"):
                a_c += cross(k.alpha, r)
            if not self.without("centripetal", "centripetal_com"):
                a_c += cross(k.w, cross(k.w, r))
            weight = -lump.mass * (product(R0, g) if self.without("gravity_in_base") else g)
            push = np.zeros_like(a_c) if self.without("no_translational") else lump.mass * a_c
            n = self._moment(k, lump)
            at = k.p if self.without("moment_arm") else k.p + r
            low = k.p if self.without("gravity_at_origin", "moment_arm") else k.p + r
            self._into(out, links, lump.link, push, n, at, np.broadcast_to(weight, push.shape), low)
        return out

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
            arm = 0 * r if self.without("moment_arm", "tangential", "tangential_com") else cross(k.alpha, r)
            Jv, Jw = (k.a + arm).reshape(shape), k.alpha.reshape(shape)
            IJw = product(self._inertia(k, lump), k.alpha).reshape(shape)
            M += lump.mass * np.einsum("ind,jnd->nij", Jv, Jv) + np.einsum("ind,jnd->nij", Jw, IJw)
        return M

    def _unit(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Every state at rest under every unit acceleration."""
        n, nv = len(q), self.robot.nv
        return np.tile(q, (nv, 1)), np.zeros((nv * n, nv)), np.repeat(np.eye(nv), n, axis=0)

    def _inertia(self, k: _Link, lump: Lump) -> np.ndarray:
        """About the centre of mass, in world axes."""
        if self.without("inertia_frame"):
            return np.broadcast_to(lump.inertia, k.R.shape)
        if self.without("inertia_frame_transposed"):
            return transposed(k.R) @ lump.inertia @ k.R
        return k.R @ lump.inertia @ transposed(k.R)

    def _moment(self, k: _Link, lump: Lump) -> np.ndarray:
        """I alpha + w x I w about the centre of mass."""
        I = self._inertia(k, lump)
        spin = cross(k.w, product(I, k.w))
        spin = -spin if self.without("gyroscopic_sign") else 0 * spin if self.without("gyroscopic") else spin
        return spin if self.without("no_angular_acceleration") else product(I, k.alpha) + spin

    def _into(
        self, out: np.ndarray, links: list[_Link], i: int, push: np.ndarray, n: np.ndarray, at: np.ndarray,
        weight: np.ndarray, low: np.ndarray,
    ) -> None:  # fmt: skip
        """What the joints below a link feel of its forces and moment."""
        while i >= 0:
            k = links[i]
            if k.column >= 0 and i > 0:
                if k.slides:
                    out[:, k.column] += (k.z * (push + weight)).sum(-1)
                else:
                    moment = n.copy()
                    if not self.without("force_moment"):
                        moment += cross(at - k.at, push) + cross(low - k.at, weight)
                    out[:, k.column] += (k.z * moment).sum(-1)
            elif i == 0 and self.floating:
                back = transposed(k.R)
                arm = 0 if self.without("force_moment") else cross(at - k.p, push) + cross(low - k.p, weight)
                out[:, :3] += product(back, n + arm)
                out[:, 3:6] += product(back, push + weight)
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
            twice = 0.0 if self.without("slide_coriolis") else 1.0 if self.without("slide_coriolis_half") else 2.0
            acc = self._carried(up, arm) + z * xdd + twice * cross(w, z * xd)
        else:
            p, acc = at, self._carried(up, at - up.p)
            turning = cross(w, z * xd)
            turning = (
                -turning if self.without("axis_rate_sign") else 0 * turning if self.without("axis_rate") else turning
            )
            w, alpha = w + z * xd, alpha + z * xdd + turning
            K = cross_matrix(axis)
            R = R @ (np.eye(3) + np.sin(x)[..., None] * K + (1 - np.cos(x))[..., None] * (K @ K))
        if np.abs(part.after - np.eye(4)).max() > 0 or part.more.any():
            raise ValueError("a link that stands where its joint moves it")
        return _Link(R, p, w, alpha, acc, z, at, slides, column, parent)

    def _carried(self, up: _Link, r: np.ndarray) -> np.ndarray:
        """The acceleration of a point of the parent."""
        a = up.a.copy()
        if not self.without("tangential", "tangential_link"):
            a += cross(up.alpha, r)
        if not self.without("centripetal", "centripetal_link"):
            a += cross(up.w, cross(up.w, r))
        return a

    def _lumps(self) -> list[Lump]:
        """Bodies: links by themselves, or merged with what is fixed to them."""
        number = {self.d.root: 0} | {p.link: k + 1 for k, p in enumerate(self.d.parts)}
        where: dict[str, tuple[str, np.ndarray]] = {self.d.root: (self.d.root, np.eye(4))}
        for p in self.d.parts:
            carrier, H = where[p.parent]
            where[p.link] = (p.link, np.eye(4)) if p.moves or not self.merged else (carrier, H @ p.pose)
        pieces: dict[str, list[tuple[float, np.ndarray, np.ndarray]]] = {}
        for link, body in [(self.d.root, self.d.base), *((p.link, p.body) for p in self.d.parts)]:
            if body is not None and body.mass > 0:
                carrier, H = where[link]
                c, R = (H @ np.append(body.com, 1.0))[:3], H[:3, :3]
                pieces.setdefault(carrier, []).append((body.mass, c, R @ body.in_link @ R.T))
        return [_lump(number[link], group) for link, group in pieces.items()]


def _lump(link: int, group: list[tuple[float, np.ndarray, np.ndarray]]) -> Lump:
    mass = sum(m for m, _, _ in group)
    com = sum((m * c for m, c, _ in group), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for m, c, I in group:
        r = c - com
        inertia = inertia + I + m * (r @ r * np.eye(3) - np.outer(r, r))
    return Lump(link, mass, com, inertia)
