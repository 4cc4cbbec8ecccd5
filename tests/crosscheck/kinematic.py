"""Kinematics and sums over bodies in plain loops, one state at a time: code of another kind, with mistakes to name.

It takes its reading and its poses from `Recursive` and shares nothing with the textbook formulations but NumPy.  A
mistake is another method in the place of a right one.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.crosscheck.recursive import Recursive, about, cross, skew

Array = np.ndarray


class Kinematic(Recursive):
    """Every term of kinematics and momentum, column by column."""

    name = "kinematic"

    # what may go wrong, each in a method

    def turn(self, axis: Array, angle: float) -> Array:
        return about(axis, angle)

    def to_matrix(self, w: float, x: Array) -> Array:
        return np.asarray((w * w - x @ x) * np.eye(3) + 2 * np.outer(x, x) + 2 * w * skew(x))

    def slide(self, R: Array, axis: Array) -> Array:
        return R @ axis

    def arm(self, point: Array, o: Array, i: int, poses: Any) -> Array:
        return point - o

    def sliding_column(self, z: Array, r: Array) -> Array:
        return np.r_[0 * z, z]

    def chain(self, k: int) -> list[int]:
        """The joints below body k, their numbers from 1."""
        out = []
        while k > 0:
            out.append(k)
            k = self.joints[k - 1].parent
        return out

    def axis_rate(self, w: Array, z: Array) -> Array:
        return cross(w, z)

    def arm_rate(self, zd: Array, z: Array, r: Array, rd: Array) -> Array:
        return cross(zd, r) + cross(z, rd)

    def carried_velocity(self, v: Array, w: Array, r: Array, own: Array) -> Array:
        return v + cross(w, r)

    def point_of(self, k: int, poses: Any) -> Array:
        return poses[k][1] + poses[k][0] @ self.bodies[k][1]

    def divisor(self) -> float:
        return sum(m for m, _, _ in self.moving())

    def spin(self, W: Array, I: Array) -> Array:
        return W @ I @ W.T

    def orbit(self, c: Array, G: Array, poses: Any) -> Array:
        return c - G

    def energy(self, m: float, v: Array, w: Array, I: Array, W: Array) -> float:
        return float(m * v @ v / 2 + w @ W @ I @ W.T @ w / 2)

    # the terms

    def moving(self) -> list[Any]:
        return self.bodies[0 if self.floating else 1 :]

    def numbers_of_moving(self) -> range:
        return range(0 if self.floating else 1, len(self.bodies))

    def base(self, q: Array) -> tuple[Array, Array]:
        return (self.to_matrix(q[3], q[4:7]), q[:3]) if self.floating else (np.eye(3), np.zeros(3))

    def steps(self, q: Array) -> list[tuple[Array, Array]]:
        out = []
        for j, x in zip(self.joints, q[len(q) - self.n :], strict=True):
            out.append((j.R, j.p + self.slide(j.R, j.axis) * x) if j.slides else (j.R @ self.turn(j.axis, x), j.p))
        return out

    def columns(self, q: Array, k: int, point: Array) -> Array:
        poses, J, b = self.poses(q), np.zeros((6, self.nv)), self.nv - self.n
        for i in self.chain(k):
            j, (W, o) = self.joints[i - 1], poses[i]
            z, r = W @ j.axis, self.arm(point, o, i, poses)
            J[:, b + i - 1] = self.sliding_column(z, r) if j.slides else np.r_[z, cross(z, r)]
        if self.floating:
            W, o = poses[0]
            J[:3, :3] = J[3:, 3:6] = W
            J[3:, :3] = -skew(point - o) @ W
        return J

    def twists(self, q: Array, v: Array) -> list[tuple[Array, Array]]:
        """Angular velocity, and velocity of the origin, of all bodies, in world axes."""
        poses, b = self.poses(q), self.nv - self.n
        W = poses[0][0]
        out = [(W @ v[:3], W @ v[3:6])] if self.floating else [(np.zeros(3), np.zeros(3))]
        for i, j in enumerate(self.joints, 1):
            w, u = out[j.parent]
            zv = poses[i][0] @ j.axis * v[b + i - 1]
            own = w if j.slides else w + zv
            u = self.carried_velocity(u, w, poses[i][1] - poses[j.parent][1], own)
            out.append((own, u + zv) if j.slides else (own, u))
        return out

    def rate(self, q: Array, v: Array, k: int, point: Array, velocity: Array) -> Array:
        poses, twists, b = self.poses(q), self.twists(q, v), self.nv - self.n
        D = np.zeros((6, self.nv))
        for i in self.chain(k):
            j, (W, o), (w, u) = self.joints[i - 1], poses[i], twists[i]
            z = W @ j.axis
            zd = self.axis_rate(w, z)
            D[:, b + i - 1] = np.r_[0 * z, zd] if j.slides else np.r_[zd, self.arm_rate(zd, z, point - o, velocity - u)]
        if self.floating:
            (W, o), (w, u) = poses[0], twists[0]
            Wd = skew(w) @ W
            D[:3, :3] = D[3:, 3:6] = Wd
            D[3:, :3] = -skew(velocity - u) @ W - skew(point - o) @ Wd
        return D

    def frame_velocity(self, q: Array, v: Array, frame: str) -> Array:
        return np.asarray(self.jacobian(q, frame) @ v)

    def jacobian_dot(self, q: Array, v: Array, frame: str) -> Array:
        return self.rate(q, v, self.at[frame][0], self.fk(q, frame)[:3, 3], self.frame_velocity(q, v, frame)[3:])

    def frame_acceleration(self, q: Array, v: Array, a: Array, frame: str) -> Array:
        return np.asarray(self.jacobian(q, frame) @ a + self.jacobian_dot(q, v, frame) @ v)

    def com(self, q: Array) -> Array:
        poses = self.poses(q)
        total = sum((self.bodies[k][0] * self.point_of(k, poses) for k in self.numbers_of_moving()), np.zeros(3))
        return np.asarray(total / self.divisor())

    def com_jacobian(self, q: Array) -> Array:
        poses, J = self.poses(q), np.zeros((3, self.nv))
        for k in self.numbers_of_moving():
            J += self.bodies[k][0] * self.columns(q, k, self.point_of(k, poses))[3:]
        return J / self.divisor()

    def centroidal_momentum_matrix(self, q: Array) -> Array:
        poses, A, G = self.poses(q), np.zeros((6, self.nv)), self.com(q)
        for k in self.numbers_of_moving():
            m, _, I = self.bodies[k]
            c = self.point_of(k, poses)
            J = self.columns(q, k, c)
            A[:3] += self.spin(poses[k][0], I) @ J[:3] + skew(self.orbit(c, G, poses)) @ (m * J[3:])
            A[3:] += m * J[3:]
        return A

    def kinetic_energy(self, q: Array, v: Array) -> float:
        poses, twists, total = self.poses(q), self.twists(q, v), 0.0
        for k in self.numbers_of_moving():
            (m, c, I), (W, _), (w, u) = self.bodies[k], poses[k], twists[k]
            total += self.energy(m, u + cross(w, W @ c), w, I, W)
        return total

    def potential_energy(self, q: Array) -> float:
        poses = self.poses(q)
        return -sum(float(self.bodies[k][0] * self.point_of(k, poses) @ self.g) for k in self.numbers_of_moving())


def _seen(s: Kinematic) -> list[int]:
    """The bodies that move, as a chain tells it."""
    return [k for k in range(len(s.bodies)) if s.floating or s.chain(k)]


def _half_angle(s: Kinematic, axis: Array, x: float) -> Array:
    return about(axis, x / 2)


def _rodrigues(f: Any, g: Any) -> Any:
    return lambda s, axis, x: np.eye(3) + f(x) * skew(axis) + g(x) * skew(axis) @ skew(axis)


def _by_quaternion(s: Kinematic, axis: Array, x: float) -> Array:
    return Kinematic.to_matrix(s, math.sin(x / 2), math.cos(x / 2) * axis)


SLIPS: dict[str, tuple[dict[str, Any], str]] = {
    "half_angle": ({"turn": _half_angle}, "1/2"),
    "cos_for_sin": ({"turn": _rodrigues(math.cos, lambda x: 1 - math.cos(x))}, "cos q"),
    "no_square": ({"turn": _rodrigues(math.sin, lambda x: 0.0)}, "K^2 is left out"),
    "cos_for_one_minus_cos": ({"turn": _rodrigues(math.sin, math.cos)}, "factor of K^2"),
    "small_angle": ({"turn": _rodrigues(lambda x: x, lambda x: 0.0)}, ""),
    "quaternion_exchanged": ({"turn": _by_quaternion}, "exchanged"),
    "slide_in_parent": ({"slide": lambda s, R, axis: axis}, "sliding joint"),
    "arm_from_origin": ({"arm": lambda s, p, o, i, poses: p}, "world's origin"),
    "arm_from_parent": ({"arm": lambda s, p, o, i, poses: p - poses[s.joints[i - 1].parent][1]}, "parent link"),
    "slide_as_turning": ({"sliding_column": lambda s, z, r: np.r_[z, cross(z, r)]}, "as of a turning one"),
    "slide_with_moment": ({"sliding_column": lambda s, z, r: np.r_[z, z]}, "[z; z]"),
    "all_joints": ({"chain": lambda s, k: list(range(1, s.n + 1))}, "also of those that do not move it"),
    "short_walk": (
        {"chain": lambda s, k: Kinematic.chain(s, k)[:-1], "moving": lambda s: [s.bodies[k] for k in _seen(s)],
         "numbers_of_moving": lambda s: _seen(s)},
        "all but that of the first joint",
    ),
    "no_own_joint": ({"chain": lambda s, k: Kinematic.chain(s, k)[1:]}, "all but"),
    "axis_rate_sign": ({"axis_rate": lambda s, w, z: cross(z, w)}, "w x z has the other sign"),
    "no_axis_rate": ({"axis_rate": lambda s, w, z: 0 * z}, "w x z is left out"),
    "no_arm_rate": ({"arm_rate": lambda s, zd, z, r, rd: cross(zd, r)}, "z x dr/dt is left out"),
    "arm_rate_twice": (
        {"arm_rate": lambda s, zd, z, r, rd: cross(zd, r) + 2 * cross(z, rd)}, "z x dr/dt is counted twice"
    ),
    "own_w": ({"carried_velocity": lambda s, v, w, r, own: v + cross(own, r)}, ""),
    "com_not_turned": ({"point_of": lambda s, k, poses: poses[k][1] + s.bodies[k][1]}, "the centre of mass of a body"),
    "com_of_number": ({"divisor": lambda s: float(len(s.moving()))}, "number of bodies"),
    "spin_one_side": ({"spin": lambda s, W, I: W @ I}, "left alone"),
    "orbit_from_origin": ({"orbit": lambda s, c, G, poses: c}, ""),
    "orbit_sign": ({"orbit": lambda s, c, G, poses: G - c}, "other sign"),
    "energy_without_turning": ({"energy": lambda s, m, v, w, I, W: float(m * v @ v / 2)}, "point masses"),
    "energy_twice": ({"energy": lambda s, m, v, w, I, W: float(m * v @ v + w @ W @ I @ W.T @ w / 2)}, "twice"),
    "energy_unturned": ({"energy": lambda s, m, v, w, I, W: float(m * v @ v / 2 + w @ I @ w / 2)}, "not transformed"),
}  # fmt: skip
"""Slips, and what a finding that names them rightly says; anything at all where that is the word of an older rule."""
