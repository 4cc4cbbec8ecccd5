"""Featherstone's algorithms: 6x6 Pluecker matrices, angular part first; a floating base is body 0 with six freedoms."""

import numpy as np

from dualpin import Convention
from tests.crosscheck.unseen.parts import about, read, skew


def plux(E, r):
    """From a frame's motion vectors to those of a frame at r; E turns coordinates of the first into the second."""
    X = np.zeros((6, 6))
    X[:3, :3] = E
    X[3:, 3:] = E
    X[3:, :3] = -E @ skew(r)
    return X


def crm(v):
    X = np.zeros((6, 6))
    X[:3, :3] = skew(v[:3])
    X[3:, :3] = skew(v[3:])
    X[3:, 3:] = skew(v[:3])
    return X


def crf(v):
    return -crm(v).T


def mcI(m, c, I):
    C = skew(c)
    return np.block([[I + m * C @ C.T, m * C], [m * C.T, m * np.eye(3)]])


def bar(h):
    """The matrix with bar(h) v = crf(v) h."""
    return np.block([[-skew(h[:3]), -skew(h[3:])], [-skew(h[3:]), np.zeros((3, 3))]])


class Code:
    version = "1"

    def __init__(self, urdf, floating=False):
        self.bodies, self.frames = read(urdf)
        self.floating = floating
        self.name = "spatial"
        self.NB = len(self.bodies)
        self.parent = [b.parent for b in self.bodies]
        self.Xtree = [None] + [plux(b.R.T, b.p) for b in self.bodies[1:]]
        self.I = [mcI(b.mass, b.com, b.inertia) for b in self.bodies]
        self.S = [np.eye(6) if floating else np.zeros((6, 0))]
        for b in self.bodies[1:]:
            s = np.r_[np.zeros(3), b.axis] if b.slides else np.r_[b.axis, np.zeros(3)]
            self.S.append(s[:, None])
        k = 6 if floating else 0
        self.nv = k + self.NB - 1
        self.at = [slice(0, k)] + [slice(k + i, k + i + 1) for i in range(self.NB - 1)]
        self.a_grav = np.array([0, 0, 0, 0, 0, -9.81])
        n = tuple(b.joint for b in self.bodies[1:])
        six = ("x", "y", "z", "qw", "qx", "qy", "qz"), ("wx", "wy", "wz", "vx", "vy", "vz")
        self.writes = Convention(q=six[0] + n if floating else n, v=six[1] + n if floating else n)

    def placed(self, q):
        """Xup of all bodies; of body 0 from the world."""
        if self.floating:
            w, x, y, z = q[3:7]
            R = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
                ]
            )
            X, q = [plux(R.T, q[:3])], q[7:]
        else:
            X = [np.eye(6)]
        for i in range(1, self.NB):
            b = self.bodies[i]
            XJ = plux(np.eye(3), b.axis * q[i - 1]) if b.slides else plux(about(b.axis, q[i - 1]).T, np.zeros(3))
            X.append(XJ @ self.Xtree[i])
        return X

    def velocities(self, X, qd):
        v = [self.S[0] @ qd[self.at[0]]]
        for i in range(1, self.NB):
            v.append(X[i] @ v[self.parent[i]] + self.S[i] @ qd[self.at[i]])
        return v

    def ID(self, q, qd, qdd):
        X = self.placed(q)
        v, a, f = [None] * self.NB, [None] * self.NB, [None] * self.NB
        v[0] = self.S[0] @ qd[self.at[0]]
        a[0] = self.S[0] @ qdd[self.at[0]] - X[0] @ self.a_grav
        for i in range(self.NB):
            if i > 0:
                p = self.parent[i]
                vJ = self.S[i] @ qd[self.at[i]]
                v[i] = X[i] @ v[p] + vJ
                a[i] = X[i] @ a[p] + self.S[i] @ qdd[self.at[i]] + crm(v[i]) @ vJ
            f[i] = self.I[i] @ a[i] + crf(v[i]) @ self.I[i] @ v[i]
        tau = np.zeros(self.nv)
        for i in range(self.NB - 1, -1, -1):
            tau[self.at[i]] = self.S[i].T @ f[i]
            if i > 0:
                f[self.parent[i]] = f[self.parent[i]] + X[i].T @ f[i]
        return tau

    def rnea(self, q, v, a):
        return self.ID(q, v, a)

    def bias(self, q, v):
        return self.ID(q, v, 0 * v)

    def gravity(self, q):
        return self.ID(q, np.zeros(self.nv), np.zeros(self.nv))

    def composite(self, X):
        IC = [I.copy() for I in self.I]
        for i in range(self.NB - 1, 0, -1):
            IC[self.parent[i]] = IC[self.parent[i]] + X[i].T @ IC[i] @ X[i]
        return IC

    def crba(self, q):
        X = self.placed(q)
        IC = self.composite(X)
        H = np.zeros((self.nv, self.nv))
        for i in range(self.NB):
            fh = IC[i] @ self.S[i]
            H[self.at[i], self.at[i]] = self.S[i].T @ fh
            j = i
            while j > 0:
                fh = X[j].T @ fh
                j = self.parent[j]
                H[self.at[i], self.at[j]] = fh.T @ self.S[j]
                H[self.at[j], self.at[i]] = self.S[j].T @ fh
        return H

    def coriolis(self, q, qd):
        X = self.placed(q)
        v = self.velocities(X, qd)
        IC = [I.copy() for I in self.I]
        B = [0.5 * (crf(v[i]) @ I + bar(I @ v[i]) - I @ crm(v[i])) for i, I in enumerate(self.I)]
        C = np.zeros((self.nv, self.nv))
        Sd = [crm(v[i]) @ S for i, S in enumerate(self.S)]
        for i in range(self.NB - 1, -1, -1):
            f1 = IC[i] @ Sd[i] + B[i] @ self.S[i]
            f2 = IC[i] @ self.S[i]
            f3 = B[i].T @ self.S[i]
            C[self.at[i], self.at[i]] = self.S[i].T @ f1
            j = i
            while j > 0:
                f1, f2, f3 = X[j].T @ f1, X[j].T @ f2, X[j].T @ f3
                j = self.parent[j]
                C[self.at[j], self.at[i]] = self.S[j].T @ f1
                C[self.at[i], self.at[j]] = (Sd[j].T @ f2 + self.S[j].T @ f3).T
            if i > 0:
                p = self.parent[i]
                IC[p] = IC[p] + X[i].T @ IC[i] @ X[i]
                B[p] = B[p] + X[i].T @ B[i] @ X[i]
        return C

    def aba(self, q, qd, tau):
        X = self.placed(q)
        v = self.velocities(X, qd)
        NB, S = self.NB, self.S
        c = [np.zeros(6)] + [crm(v[i]) @ S[i] @ qd[self.at[i]] for i in range(1, NB)]
        IA = [I.copy() for I in self.I]
        pA = [crf(v[i]) @ I @ v[i] for i, I in enumerate(self.I)]
        U, D, u = [None] * NB, [None] * NB, [None] * NB
        for i in range(NB - 1, -1, -1):
            U[i] = IA[i] @ S[i]
            D[i] = S[i].T @ U[i]
            u[i] = tau[self.at[i]] - S[i].T @ pA[i]
            if i > 0:
                Ia = IA[i] - U[i] @ U[i].T / D[i]
                pa = pA[i] + Ia @ c[i] + U[i] @ u[i] / D[i][0]
                p = self.parent[i]
                IA[p] = IA[p] + X[i].T @ Ia @ X[i]
                pA[p] = pA[p] + X[i].T @ pa
        a = [-X[0] @ self.a_grav]
        qdd = np.zeros(self.nv)
        for i in range(NB):
            if i > 0:
                a.append(X[i] @ a[self.parent[i]] + c[i])
            if S[i].shape[1]:
                x = np.linalg.solve(D[i], u[i] - U[i].T @ a[i])
                qdd[self.at[i]] = x
                a[i] = a[i] + S[i] @ x
        return qdd

    def minv(self, q):
        return np.linalg.inv(self.crba(q))

    def world(self, q):
        """X0 of all bodies: from world to body coordinates."""
        X = self.placed(q)
        X0 = [X[0]]
        for i in range(1, self.NB):
            X0.append(X[i] @ X0[self.parent[i]])
        return X, X0

    def body_jacobian(self, X, i):
        J = np.zeros((6, self.nv))
        A = np.eye(6)
        while i > 0:
            J[:, self.at[i]] = A @ self.S[i]
            A = A @ X[i]
            i = self.parent[i]
        J[:, self.at[0]] = A @ self.S[0]
        return J

    def fk(self, q, frame):
        X, X0 = self.world(q)
        i, R, p = self.frames[frame]
        Y = plux(R.T, p) @ X0[i]
        E = Y[:3, :3]
        r = -E.T @ Y[3:, :3]
        T = np.eye(4)
        T[:3, :3] = E.T
        T[:3, 3] = [r[2, 1], r[0, 2], r[1, 0]]
        return T

    def jacobian(self, q, frame):
        X, X0 = self.world(q)
        i, R, p = self.frames[frame]
        E = (R.T @ X0[i][:3, :3]).T
        turn = np.block([[E, np.zeros((3, 3))], [np.zeros((3, 3)), E]])
        return turn @ plux(R.T, p) @ self.body_jacobian(X, i)

    def frame_velocity(self, q, qd, frame):
        return self.jacobian(q, frame) @ qd

    def centroidal_momentum_matrix(self, q):
        X, X0 = self.world(q)
        c = self.com(q)
        A = np.zeros((6, self.nv))
        for i in range(0 if self.floating else 1, self.NB):
            A = A + X0[i].T @ self.I[i] @ self.body_jacobian(X, i)
        return np.r_[A[:3] - skew(c) @ A[3:], A[3:]]

    def com(self, q):
        X, X0 = self.world(q)
        k = 0 if self.floating else 1
        I = sum(X0[i].T @ self.I[i] @ X0[i] for i in range(k, self.NB))
        h = I[:3, 3:] / I[3, 3]
        return np.array([h[2, 1], h[0, 2], h[1, 0]])

    def kinetic_energy(self, q, qd):
        v = self.velocities(self.placed(q), qd)
        return sum(0.5 * v[i] @ self.I[i] @ v[i] for i in range(self.NB))

    def potential_energy(self, q):
        k = 0 if self.floating else 1
        return -sum(b.mass for b in self.bodies[k:]) * self.com(q) @ self.a_grav[3:]
