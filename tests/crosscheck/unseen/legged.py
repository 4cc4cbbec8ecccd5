"""A legged robot: quaternion x y z w, velocities in world axes, linear first; sums over bodies of J and dJ/dt."""

import numpy as np

from dualpin import Convention
from tests.crosscheck.unseen.parts import about, read, skew

X = np.cross


class Code:
    version = "1"

    def __init__(self, urdf, floating=True):
        self.bodies, self.frames = read(urdf)
        self.n = len(self.bodies) - 1
        self.nv = 6 + self.n
        self.G = 9.81
        self.name = "legged"
        n = tuple(b.joint for b in self.bodies[1:])
        self.writes = Convention(
            q=("x", "y", "z", "qx", "qy", "qz", "qw", *n),
            v=("vx", "vy", "vz", "wx", "wy", "wz", *n),
            rows=("vx", "vy", "vz", "wx", "wy", "wz"),
            angular="world",
            linear="world",
        )

    def poses(self, q):
        x, y, z, w = q[3:7]
        R0 = np.eye(3) + 2 * w * skew([x, y, z]) + 2 * skew([x, y, z]) @ skew([x, y, z])
        R, p, axis = [R0], [q[:3]], [None]
        for i in range(1, self.n + 1):
            b = self.bodies[i]
            Rp, pp = R[b.parent], p[b.parent]
            axis.append(Rp @ b.R @ b.axis)
            angle = q[6 + i]
            if b.slides:
                R.append(Rp @ b.R)
                p.append(pp + Rp @ (b.p + b.R @ b.axis * angle))
            else:
                R.append(Rp @ b.R @ about(b.axis, angle))
                p.append(pp + Rp @ b.p)
        return R, p, axis

    def chain(self, i):
        out = []
        while i > 0:
            out.append(i)
            i = self.bodies[i].parent
        return out

    def point(self, geometry, i, x):
        """6 x nv: linear and angular velocity of the point x of body i."""
        R, p, axis = geometry
        J = np.zeros((6, self.nv))
        J[:3, :3] = np.eye(3)
        J[:3, 3:6] = -skew(x - p[0])
        J[3:, 3:6] = np.eye(3)
        for k in self.chain(i):
            if self.bodies[k].slides:
                J[:3, 5 + k] = axis[k]
            else:
                J[:3, 5 + k] = X(axis[k], x - p[k])
                J[3:, 5 + k] = axis[k]
        return J

    def point_rate(self, geometry, v, i, x):
        R, p, axis = geometry
        V = self.point(geometry, i, x) @ v
        D = np.zeros((6, self.nv))
        D[:3, 3:6] = -skew(V[:3] - v[:3])
        for k in self.chain(i):
            b = self.bodies[k]
            P = self.point(geometry, b.parent, p[k]) @ v
            turning = X(P[3:], axis[k])
            if b.slides:
                D[:3, 5 + k] = turning
            else:
                origin = self.point(geometry, k, p[k]) @ v
                D[:3, 5 + k] = X(turning, x - p[k]) + X(axis[k], V[:3] - origin[:3])
                D[3:, 5 + k] = turning
        return D

    def centres(self, geometry):
        R, p, axis = geometry
        return [p[i] + R[i] @ b.com for i, b in enumerate(self.bodies)]

    def tensors(self, geometry):
        return [R @ b.inertia @ R.T for R, b in zip(geometry[0], self.bodies)]

    def crba(self, q):
        g = self.poses(q)
        M = np.zeros((self.nv, self.nv))
        for i, (c, I) in enumerate(zip(self.centres(g), self.tensors(g))):
            J = self.point(g, i, c)
            M += self.bodies[i].mass * J[:3].T @ J[:3] + J[3:].T @ I @ J[3:]
        return M

    def gravity(self, q):
        g = self.poses(q)
        h = np.zeros(self.nv)
        for i, c in enumerate(self.centres(g)):
            h += self.point(g, i, c)[2] * self.bodies[i].mass * self.G
        return h

    def coriolis(self, q, v):
        g = self.poses(q)
        C = np.zeros((self.nv, self.nv))
        for i, (c, I) in enumerate(zip(self.centres(g), self.tensors(g))):
            J, D = self.point(g, i, c), self.point_rate(g, v, i, c)
            w = J[3:] @ v
            C += self.bodies[i].mass * J[:3].T @ D[:3]
            C += J[3:].T @ (I @ D[3:] + 0.5 * (skew(w) @ I - I @ skew(w) - skew(I @ w)) @ J[3:])
        return C

    def bias(self, q, v):
        g = self.poses(q)
        h = self.gravity(q)
        for i, (c, I) in enumerate(zip(self.centres(g), self.tensors(g))):
            J, D = self.point(g, i, c), self.point_rate(g, v, i, c)
            w, b = J[3:] @ v, D @ v
            h = h + J[:3].T @ (self.bodies[i].mass * b[:3]) + J[3:].T @ (I @ b[3:] + X(w, I @ w))
        return h

    def rnea(self, q, v, a):
        return self.crba(q) @ a + self.bias(q, v)

    def aba(self, q, v, tau):
        return np.linalg.solve(self.crba(q), tau - self.bias(q, v))

    def minv(self, q):
        return np.linalg.inv(self.crba(q))

    def fk(self, q, frame):
        R, p, axis = self.poses(q)
        i, Rf, pf = self.frames[frame]
        T = np.eye(4)
        T[:3, :3] = R[i] @ Rf
        T[:3, 3] = p[i] + R[i] @ pf
        return T

    def foot(self, q, frame):
        g = self.poses(q)
        i, Rf, pf = self.frames[frame]
        return g, i, g[1][i] + g[0][i] @ pf

    def jacobian(self, q, frame):
        return self.point(*self.foot(q, frame))

    def jacobian_dot(self, q, v, frame):
        g, i, x = self.foot(q, frame)
        return self.point_rate(g, v, i, x)

    def frame_velocity(self, q, v, frame):
        return self.jacobian(q, frame) @ v

    def frame_acceleration(self, q, v, a, frame):
        return self.jacobian(q, frame) @ a + self.jacobian_dot(q, v, frame) @ v

    def com(self, q):
        c = self.centres(self.poses(q))
        m = np.array([b.mass for b in self.bodies])
        return m @ np.array(c) / m.sum()

    def com_jacobian(self, q):
        g = self.poses(q)
        m = [b.mass for b in self.bodies]
        return sum(m[i] * self.point(g, i, c)[:3] for i, c in enumerate(self.centres(g))) / sum(m)

    def centroidal_momentum_matrix(self, q):
        g, G = self.poses(q), self.com(q)
        A = np.zeros((6, self.nv))
        for i, (c, I) in enumerate(zip(self.centres(g), self.tensors(g))):
            J = self.point(g, i, c)
            A[:3] += self.bodies[i].mass * J[:3]
            A[3:] += I @ J[3:] + self.bodies[i].mass * skew(c - G) @ J[:3]
        return A

    def kinetic_energy(self, q, v):
        return 0.5 * v @ self.crba(q) @ v

    def potential_energy(self, q):
        return self.G * sum(b.mass for b in self.bodies) * self.com(q)[2]
