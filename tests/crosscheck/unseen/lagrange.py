"""Lagrange's equations: M and V from Jacobians, Christoffel's symbols from differences of eighth order."""

import numpy as np

from dualpin import Convention
from tests.crosscheck.unseen.parts import about, read

STEP = 0.02
WEIGHTS = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}


def derivative(f, q, e):
    """Of f along e."""
    h = STEP / max(1.0, np.linalg.norm(e))
    return sum(w * (f(q + s * h * e) - f(q - s * h * e)) for s, w in WEIGHTS.items()) / h


class Code:
    version = "1"

    def __init__(self, urdf, floating=False):
        self.bodies, self.frames = read(urdf)
        self.moving = self.bodies[1:]
        self.n = len(self.moving)
        self.g0 = np.array([0, 0, -9.81])
        names = tuple(b.joint for b in self.moving)
        self.name = "lagrange"
        self.writes = Convention(q=names, v=names)
        self.paths, self.symbols = [], {}
        for i in range(len(self.bodies)):
            path, k = [], i
            while k > 0:
                path.append(k)
                k = self.bodies[k].parent
            self.paths.append(path)

    def positions(self, q):
        R, p, z = [np.eye(3)], [np.zeros(3)], [None]
        for i, b in enumerate(self.moving):
            Rp, pp = R[b.parent], p[b.parent]
            z.append(Rp @ b.R @ b.axis)
            if b.slides:
                R.append(Rp @ b.R)
                p.append(pp + Rp @ b.p + z[-1] * q[i])
            else:
                R.append(Rp @ b.R @ about(b.axis, q[i]))
                p.append(pp + Rp @ b.p)
        return R, p, z

    def point_jacobians(self, q, i, x):
        """Angular and linear Jacobian of the point x of body i."""
        R, p, z = self.positions(q)
        Jw, Jv = np.zeros((3, self.n)), np.zeros((3, self.n))
        for k in self.paths[i]:
            if self.bodies[k].slides:
                Jv[:, k - 1] = z[k]
            else:
                Jw[:, k - 1] = z[k]
                Jv[:, k - 1] = np.cross(z[k], x - p[k])
        return Jw, Jv

    def centre(self, q, i):
        R, p, z = self.positions(q)
        return p[i] + R[i] @ self.bodies[i].com

    def crba(self, q):
        R, p, z = self.positions(q)
        M = np.zeros((self.n, self.n))
        for i in range(1, self.n + 1):
            b = self.bodies[i]
            Jw, Jv = self.point_jacobians(q, i, self.centre(q, i))
            M += b.mass * Jv.T @ Jv + Jw.T @ R[i] @ b.inertia @ R[i].T @ Jw
        return M

    def potential_energy(self, q):
        V = 0.0
        for i in range(1, self.n + 1):
            V -= self.bodies[i].mass * self.g0 @ self.centre(q, i)
        return V

    def gravity(self, q):
        G = np.zeros(self.n)
        for i in range(1, self.n + 1):
            Jw, Jv = self.point_jacobians(q, i, self.centre(q, i))
            G -= Jv.T @ (self.bodies[i].mass * self.g0)
        return G

    def christoffel(self, q):
        n = self.n
        if q.tobytes() in self.symbols:
            return self.symbols[q.tobytes()]
        dM = np.stack([derivative(self.crba, q, e) for e in np.eye(n)], axis=2)  # dM[i, j, k] = dM_ij / dq_k
        c = np.zeros((n, n, n))
        for i in range(n):
            for j in range(n):
                for k in range(n):
                    c[i, j, k] = 0.5 * (dM[i, j, k] + dM[i, k, j] - dM[j, k, i])
        self.symbols = {**self.symbols, q.tobytes(): c}
        return c

    def coriolis(self, q, qd):
        return self.christoffel(q) @ qd

    def bias(self, q, qd):
        return self.coriolis(q, qd) @ qd + self.gravity(q)

    def rnea(self, q, qd, qdd):
        return self.crba(q) @ qdd + self.bias(q, qd)

    def aba(self, q, qd, tau):
        L = np.linalg.cholesky(self.crba(q))
        y = np.linalg.solve(L, tau - self.bias(q, qd))
        return np.linalg.solve(L.T, y)

    def minv(self, q):
        L = np.linalg.inv(np.linalg.cholesky(self.crba(q)))
        return L.T @ L

    def kinetic_energy(self, q, qd):
        return 0.5 * qd @ self.crba(q) @ qd

    def total(self):
        return sum(b.mass for b in self.moving)

    def com(self, q):
        return sum(b.mass * self.centre(q, i + 1) for i, b in enumerate(self.moving)) / self.total()

    def com_jacobian(self, q):
        J = 0
        for i, b in enumerate(self.moving, 1):
            J = J + b.mass * self.point_jacobians(q, i, self.centre(q, i))[1]
        return J / self.total()

    def pose(self, q, frame):
        R, p, z = self.positions(q)
        i, Rf, pf = self.frames[frame]
        return i, R[i] @ Rf, p[i] + R[i] @ pf

    def fk(self, q, frame):
        i, R, p = self.pose(q, frame)
        return np.block([[R, p[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])

    def jacobian(self, q, frame):
        i, R, p = self.pose(q, frame)
        Jw, Jv = self.point_jacobians(q, i, p)
        return np.vstack([Jw, Jv])

    def jacobian_dot(self, q, qd, frame):
        return derivative(lambda x: self.jacobian(x, frame), q, qd)

    def frame_acceleration(self, q, qd, qdd, frame):
        return self.jacobian(q, frame) @ qdd + self.jacobian_dot(q, qd, frame) @ qd
