"""Kinematics by quaternions (w x y z) with analytic first and second partial derivatives; energies and M from these."""

import numpy as np

from dualpin import Convention
from tests.crosscheck.unseen.parts import read


def mul(a, b):
    return np.r_[a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])]


def conj(a):
    return a * [1, -1, -1, -1]


def turn(a, v):
    return mul(mul(a, np.r_[0, v]), conj(a))[1:]


def quaternion(R):
    w = np.sqrt(max(0, 1 + R[0, 0] + R[1, 1] + R[2, 2])) / 2
    x = np.sqrt(max(0, 1 + R[0, 0] - R[1, 1] - R[2, 2])) / 2
    y = np.sqrt(max(0, 1 - R[0, 0] + R[1, 1] - R[2, 2])) / 2
    z = np.sqrt(max(0, 1 - R[0, 0] - R[1, 1] + R[2, 2])) / 2
    k = int(np.argmax([w, x, y, z]))
    if k == 0:
        return np.array(
            [w, (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)]
        )
    if k == 1:
        return np.array(
            [(R[2, 1] - R[1, 2]) / (4 * x), x, (R[0, 1] + R[1, 0]) / (4 * x), (R[0, 2] + R[2, 0]) / (4 * x)]
        )
    if k == 2:
        return np.array(
            [(R[0, 2] - R[2, 0]) / (4 * y), (R[0, 1] + R[1, 0]) / (4 * y), y, (R[1, 2] + R[2, 1]) / (4 * y)]
        )
    return np.array([(R[1, 0] - R[0, 1]) / (4 * z), (R[0, 2] + R[2, 0]) / (4 * z), (R[1, 2] + R[2, 1]) / (4 * z), z])


class Code:
    version = "1"

    def __init__(self, urdf, floating=False):
        self.bodies, self.frames = read(urdf)
        self.n = len(self.bodies) - 1
        self.Q0 = [None] + [quaternion(b.R) for b in self.bodies[1:]]
        names = tuple(b.joint for b in self.bodies[1:])
        self.name = "quat"
        self.g = 9.81
        self.writes = Convention(q=names, v=names)

    def poses(self, q):
        Q, p = [np.array([1.0, 0, 0, 0])], [np.zeros(3)]
        for i in range(1, self.n + 1):
            b = self.bodies[i]
            Qj = mul(Q[b.parent], self.Q0[i])
            pj = p[b.parent] + turn(Q[b.parent], b.p)
            if b.slides:
                Q.append(Qj)
                p.append(pj + turn(Qj, b.axis) * q[i - 1])
            else:
                half = q[i - 1] / 2
                Q.append(mul(Qj, np.r_[np.cos(half), np.sin(half) * b.axis]))
                p.append(pj)
        return Q, p

    def above(self, i):
        out = []
        while i > 0:
            out.insert(0, i)
            i = self.bodies[i].parent
        return out

    def derivatives(self, q, i, local):
        """First and second derivatives of a point's position (3, n), (3, n, n), and of axes: dp, ddp, w, dw."""
        Q, p = self.poses(q)
        x = p[i] + turn(Q[i], local)
        n = self.n
        path = self.above(i)
        axis = {k: turn(Q[k], self.bodies[k].axis) for k in path}
        turns = {k: not self.bodies[k].slides for k in path}
        dp, w = np.zeros((3, n)), np.zeros((3, n))
        for k in path:
            dp[:, k - 1] = np.cross(axis[k], x - p[k]) if turns[k] else axis[k]
            w[:, k - 1] = axis[k] if turns[k] else 0
        ddp, dw = np.zeros((3, n, n)), np.zeros((3, n, n))
        for k in path:
            for m in path:
                first, last = (k, m) if path.index(k) <= path.index(m) else (m, k)
                if turns[first]:
                    ddp[:, k - 1, m - 1] = np.cross(axis[first], dp[:, last - 1])
                if turns[m] and turns[k] and path.index(m) < path.index(k):
                    dw[:, k - 1, m - 1] = np.cross(axis[m], axis[k])
        return x, dp, ddp, w, dw

    def link(self, q, frame):
        i, R, p = self.frames[frame]
        return (i, R, *self.derivatives(q, i, p))

    def fk(self, q, frame):
        i, R, p = self.frames[frame]
        Q, o = self.poses(q)
        return np.r_[o[i] + turn(Q[i], p), mul(Q[i], quaternion(R))]

    def jacobian(self, q, frame):
        i, R, x, dp, ddp, w, dw = self.link(q, frame)
        return np.r_[w, dp]

    def jacobian_dot(self, q, v, frame):
        i, R, x, dp, ddp, w, dw = self.link(q, frame)
        return np.r_[dw @ v, ddp @ v]

    def frame_velocity(self, q, v, frame):
        i, R, x, dp, ddp, w, dw = self.link(q, frame)
        return np.r_[w @ v, dp @ v]

    def frame_acceleration(self, q, v, a, frame):
        i, R, x, dp, ddp, w, dw = self.link(q, frame)
        return np.r_[w @ a + dw @ v @ v, dp @ a + ddp @ v @ v]

    def all_bodies(self, q):
        Q, p = self.poses(q)
        for i in range(1, self.n + 1):
            b = self.bodies[i]
            R = np.array([turn(Q[i], e) for e in np.eye(3)]).T
            yield (b.mass, R @ b.inertia @ R.T, *self.derivatives(q, i, b.com))

    def crba(self, q):
        return sum(m * dp.T @ dp + w.T @ I @ w for m, I, x, dp, ddp, w, dw in self.all_bodies(q))

    def gravity(self, q):
        return sum(m * self.g * dp[2] for m, I, x, dp, ddp, w, dw in self.all_bodies(q))

    def bias(self, q, v):
        h = self.gravity(q)
        for m, I, x, dp, ddp, w, dw in self.all_bodies(q):
            W = w @ v
            h = h + m * dp.T @ (ddp @ v @ v) + w.T @ (I @ (dw @ v @ v) + np.cross(W, I @ W))
        return h

    def rnea(self, q, v, a):
        return self.crba(q) @ a + self.bias(q, v)

    def aba(self, q, v, tau):
        return np.linalg.inv(self.crba(q)) @ (tau - self.bias(q, v))

    def kinetic_energy(self, q, v):
        return sum(
            m * (dp @ v) @ (dp @ v) / 2 + (w @ v) @ I @ (w @ v) / 2 for m, I, x, dp, ddp, w, dw in self.all_bodies(q)
        )

    def potential_energy(self, q):
        return sum(m * self.g * x[2] for m, I, x, dp, ddp, w, dw in self.all_bodies(q))

    def com(self, q):
        B = list(self.all_bodies(q))
        return sum(b[0] * b[2] for b in B) / sum(b[0] for b in B)

    def com_jacobian(self, q):
        B = list(self.all_bodies(q))
        return sum(b[0] * b[3] for b in B) / sum(b[0] for b in B)
