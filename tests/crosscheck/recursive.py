"""Newton-Euler passes in the links' own axes, composite bodies, and a reader of its own: code of another kind to judge.

It shares nothing with dualpin but NumPy.  Every step in which engineers go wrong is a method of its own, so that a
mistake is another function in its place (see `planted_blind`).

References: Craig, Introduction to Robotics (2005), section 6.5; Featherstone, Rigid Body Dynamics Algorithms (2008),
section 6.2, in 3D vectors.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import Any

import numpy as np

import dualpin as dp

Array = np.ndarray
cross = np.cross
BASE_Q, BASE_V = ("x", "y", "z", "qw", "qx", "qy", "qz"), ("wx", "wy", "wz", "vx", "vy", "vz")


def skew(a: Array) -> Array:
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def about(axis: Array, angle: float) -> Array:
    K = skew(axis)
    return np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K


def far(m: float, c: Array) -> Array:
    """Steiner's term."""
    return m * (c @ c * np.eye(3) - np.outer(c, c))


Piece = tuple[float, Array, Array]
"""Mass, centre of mass, inertia about it."""


@dataclass
class Joint:
    """A joint that moves: where it stands on the body before it, and what is fixed to the link it carries."""

    name: str
    slides: bool
    parent: int
    R: Array
    p: Array
    axis: Array


class Recursive:
    """A subject: see the module."""

    name, version = "recursive", "1"

    def __init__(self, urdf: str, floating: bool = False) -> None:
        self.floating = floating
        root = ET.fromstring(urdf)
        links = {e.get("name"): e.find("inertial") for e in root.iter("link")}
        children: dict[Any, list[Any]] = {}
        for e in root.findall("joint"):
            children.setdefault(e.find("parent").get("link"), []).append(e)
        first = next(n for n in links if n not in {e.find("child").get("link") for e in root.findall("joint")})
        self.joints: list[Joint] = []
        self.at = {first: (0, np.eye(3), np.zeros(3))}
        pieces: list[list[Piece]] = [self.pieces(links[first], np.eye(3), np.zeros(3), fixed=False)]
        todo = [first]
        while todo:
            link = todo.pop()
            for e in children.get(link, []):
                body, R0, p0 = self.at[link]
                R, p = self.origin(e.find("origin"))
                child, kind = e.find("child").get("link"), e.get("type")
                if kind == "fixed":
                    self.at[child] = (body, R0 @ R, p0 + R0 @ p)
                    pieces[body] += self.pieces(links[child], *self.at[child][1:], fixed=True)
                else:
                    joint = Joint(e.get("name"), kind == "prismatic", body, R0 @ R, p0 + R0 @ p, self.axis(e, R))
                    self.joints.append(joint)
                    self.at[child] = (len(self.joints), np.eye(3), np.zeros(3))
                    pieces.append(self.pieces(links[child], np.eye(3), np.zeros(3), fixed=False))
                todo.append(child)
        self.bodies = [self.merged(group) for group in pieces]
        names = tuple(j.name for j in self.joints)
        self.n, self.nv = len(names), len(names) + 6 * floating
        self.writes = dp.Convention((BASE_Q if floating else ()) + names, (BASE_V if floating else ()) + names)

    # --- reading ---------------------------------------------------------------------------------

    g = np.array([0, 0, -9.81])

    def numbers(self, text: str) -> Array:
        return np.array([float(x) for x in text.split()])

    def turned(self, rpy: Array) -> Array:
        roll, pitch, yaw = rpy
        x, y, z = np.eye(3)
        return about(z, yaw) @ about(y, pitch) @ about(x, roll)

    def origin(self, e: Any) -> tuple[Array, Array]:
        if e is None:
            return np.eye(3), np.zeros(3)
        return self.turned(self.numbers(e.get("rpy", "0 0 0"))), self.numbers(e.get("xyz", "0 0 0"))

    def inertial_origin(self, e: Any) -> tuple[Array, Array]:
        return self.origin(e)

    def axis(self, e: Any, R: Array) -> Array:
        a = e.find("axis")
        a = np.array([1.0, 0, 0]) if a is None else self.numbers(a.get("xyz"))
        return a / np.linalg.norm(a)

    def tensor(self, e: Any) -> Array:
        xx, xy, xz, yy, yz, zz = (self.numbers(e.get(k, "0"))[0] for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def in_link(self, I: Array, R: Array) -> Array:
        return R @ I @ R.T

    def pieces(self, e: Any, R: Array, p: Array, fixed: bool) -> list[Piece]:
        if e is None:
            return []
        Ri, c = self.inertial_origin(e.find("origin"))
        m = self.numbers(e.find("mass").get("value"))[0]
        return [self.carried(m, c, self.in_link(self.tensor(e.find("inertia")), Ri), R, p)]

    def carried(self, m: float, c: Array, I: Array, R: Array, p: Array) -> Piece:
        """In the axes of the body that carries the link."""
        return m, p + R @ c, R @ I @ R.T

    def merged(self, group: list[Piece]) -> Piece:
        m = sum(x for x, _, _ in group)
        c = sum((x * y for x, y, _ in group), np.zeros(3)) / (m or 1.0)
        return m, c, sum((I + self.steiner(x, y - c) for x, y, I in group), np.zeros((3, 3)))

    def steiner(self, m: float, c: Array) -> Array:
        return far(m, c)

    # --- poses -----------------------------------------------------------------------------------

    def base(self, q: Array) -> tuple[Array, Array]:
        if not self.floating:
            return np.eye(3), np.zeros(3)
        w, x = q[3], q[4:7]
        return (w * w - x @ x) * np.eye(3) + 2 * np.outer(x, x) + 2 * w * skew(x), q[:3]

    def steps(self, q: Array) -> list[tuple[Array, Array]]:
        """Pose of each joint's moved frame on the body before it."""
        out = []
        for j, x in zip(self.joints, q[len(q) - self.n :], strict=True):
            out.append((j.R, j.p + j.R @ j.axis * x) if j.slides else (j.R @ about(j.axis, x), j.p))
        return out

    def poses(self, q: Array) -> list[tuple[Array, Array]]:
        out = [self.base(q)]
        for j, (R, p) in zip(self.joints, self.steps(q), strict=True):
            W, o = out[j.parent]
            out.append((W @ R, o + W @ p))
        return out

    def fk(self, q: Array, frame: str) -> Array:
        k, R, p = self.at[frame]
        W, o = self.poses(q)[k]
        H = np.eye(4)
        H[:3, :3], H[:3, 3] = W @ R, o + W @ p
        return H

    def lever(self, z: Array, r: Array) -> Array:
        return cross(z, r)

    def columns(self, q: Array, k: int, point: Array) -> Array:
        """(6, nv): the Jacobian of a point of body k, angular rows first, in world axes."""
        poses, J = self.poses(q), np.zeros((6, self.nv))
        base, i = self.nv - self.n, k
        while i > 0:
            j, (W, o) = self.joints[i - 1], poses[i]
            z = W @ j.axis
            J[:, base + i - 1] = np.r_[0 * z, z] if j.slides else np.r_[z, self.lever(z, point - o)]
            i = j.parent
        if self.floating:
            W, o = poses[0]
            J[:3, :3] = J[3:, 3:6] = W
            J[3:, :3] = -skew(point - o) @ W
        return J

    def jacobian(self, q: Array, frame: str) -> Array:
        return self.columns(q, self.at[frame][0], self.fk(q, frame)[:3, 3])

    # --- the two passes --------------------------------------------------------------------------

    def turning(self, w: Array, zv: Array) -> Array:
        return cross(w, zv)

    def sliding(self, w: Array, zv: Array) -> Array:
        return 2 * cross(w, zv)

    def tangential(self, alpha: Array, r: Array) -> Array:
        return cross(alpha, r)

    def centripetal(self, w: Array, r: Array) -> Array:
        return cross(w, cross(w, r))

    def of_centre(self, w: Array, alpha: Array, a: Array, c: Array) -> Array:
        return a + cross(alpha, c) + cross(w, cross(w, c))

    def euler(self, I: Array, w: Array, alpha: Array) -> Array:
        return I @ alpha + cross(w, I @ w)

    def moment(self, n: Array, c: Array, f: Array) -> Array:
        return n + cross(c, f)

    def handed(self, R: Array, p: Array, n: Array, f: Array) -> tuple[Array, Array]:
        """What the body before feels of moment and force of the next, which stands at R, p."""
        return R @ n + cross(p, R @ f), R @ f

    def felt(self, j: Joint, n: Array, f: Array) -> float:
        return float(j.axis @ (f if j.slides else n))

    def forces(self, q: Array, v: Array, a: Array, g: Array) -> Array:
        return self.inward(q, self.outward(q, v, a, g))

    def outward(self, q: Array, v: Array, a: Array, g: Array) -> list[tuple[Array, Array, Array]]:
        """w, alpha and the acceleration of the origin, minus g, of all bodies in their own axes."""
        W, b = self.base(q)[0], self.nv - self.n
        w, alpha, acc = np.zeros(3), np.zeros(3), -W.T @ g
        if self.floating:
            w, alpha, acc = v[:3], a[:3], acc + a[3:6] + cross(v[:3], v[3:6])
        out = [(w, alpha, acc)]
        for j, (R, p), vj, aj in zip(self.joints, self.steps(q), v[b:], a[b:], strict=True):
            w, alpha, acc = out[j.parent]
            acc = R.T @ (acc + self.tangential(alpha, p) + self.centripetal(w, p))
            w, alpha, zv, za = R.T @ w, R.T @ alpha, j.axis * vj, j.axis * aj
            if j.slides:
                out.append((w, alpha, acc + za + self.sliding(w, zv)))
            else:
                out.append((w + zv, alpha + za + self.turning(w, zv), acc))
        return out

    def inward(self, q: Array, motions: list[tuple[Array, Array, Array]]) -> Array:
        wrenches = []
        for (m, c, I), (w, alpha, acc) in zip(self.bodies, motions, strict=True):
            f = m * self.of_centre(w, alpha, acc, c)
            wrenches.append((self.moment(self.euler(I, w, alpha), c, f), f))
        tau = np.zeros(self.n)
        for i in range(self.n, 0, -1):
            j, (n, f) = self.joints[i - 1], wrenches[i]
            tau[i - 1] = self.felt(j, n, f)
            dn, df = self.handed(*self.steps(q)[i - 1], n, f)
            wrenches[j.parent] = (wrenches[j.parent][0] + dn, wrenches[j.parent][1] + df)
        return np.r_[wrenches[0][0], wrenches[0][1], tau] if self.floating else tau

    def frame_acceleration(self, q: Array, v: Array, a: Array, frame: str) -> Array:
        k, _, r = self.at[frame]
        w, alpha, acc = self.outward(q, v, a, np.zeros(3))[k]
        W = self.poses(q)[k][0]
        return np.r_[W @ alpha, W @ (acc + self.tangential(alpha, r) + self.centripetal(w, r))]

    def rnea(self, q: Array, v: Array, a: Array) -> Array:
        return self.forces(q, v, a, self.g)

    def bias(self, q: Array, v: Array) -> Array:
        return self.forces(q, v, 0 * v, self.g)

    def gravity(self, q: Array) -> Array:
        return self.forces(q, np.zeros(self.nv), np.zeros(self.nv), self.g)

    # --- composite bodies, and what follows ------------------------------------------------------

    def composite(self, q: Array) -> list[tuple[float, Array, Array]]:
        """Mass, first moment and inertia about the origin of each body with all that it carries."""
        out = [(m, m * c, I + far(m, c)) for m, c, I in self.bodies]
        for i in range(self.n, 0, -1):
            (m, h, I), (R, p), k = out[i], self.steps(q)[i - 1], self.joints[i - 1].parent
            M, H, T = out[k]
            h, I = R @ h, R @ I @ R.T
            I = I + 2 * (h @ p) * np.eye(3) - np.outer(h, p) - np.outer(p, h) + far(m, p)  # about a point -p away
            out[k] = (M + m, H + h + m * p, T + I)
        return out

    def crba(self, q: Array) -> Array:
        M, b = np.zeros((self.nv, self.nv)), self.nv - self.n
        whole = self.composite(q)
        for i in range(self.n, 0, -1):
            j, (m, h, I) = self.joints[i - 1], whole[i]
            n, f = (cross(h, j.axis), m * j.axis) if j.slides else (I @ j.axis, cross(j.axis, h))
            k = i
            while k > 0:
                M[b + i - 1, b + k - 1] = M[b + k - 1, b + i - 1] = self.felt(self.joints[k - 1], n, f)
                n, f = self.handed(*self.steps(q)[k - 1], n, f)
                k = self.joints[k - 1].parent
            if self.floating:
                M[:6, b + i - 1] = M[b + i - 1, :6] = np.r_[n, f]
        if self.floating:
            m, h, I = whole[0]
            M[:6, :6] = np.block([[I, skew(h)], [-skew(h), m * np.eye(3)]])
        return M

    def aba(self, q: Array, v: Array, tau: Array) -> Array:
        return np.linalg.solve(self.crba(q), tau - self.bias(q, v))

    def kinetic_energy(self, q: Array, v: Array) -> float:
        return float(0.5 * v @ self.crba(q) @ v)

    def com(self, q: Array) -> Array:
        moving = list(zip(self.bodies, self.poses(q), strict=True))[0 if self.floating else 1 :]
        return sum(m * self.centre(c, W, o) for (m, c, _), (W, o) in moving) / sum(m for (m, _, _), _ in moving)

    def centre(self, c: Array, W: Array, o: Array) -> Array:
        return o + W @ c

    def potential_energy(self, q: Array) -> float:
        return float(-sum(m for m, _, _ in self.bodies[0 if self.floating else 1 :]) * self.com(q) @ self.g)
