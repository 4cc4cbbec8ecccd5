"""A MATLAB script in Python: arrays from 1, homogeneous matrices, Newton-Euler in world axes; all links are bodies."""

import xml.etree.ElementTree as ET

import numpy as np

from dualpin import Convention


def rotx(t):
    return np.array([[1, 0, 0, 0], [0, np.cos(t), -np.sin(t), 0], [0, np.sin(t), np.cos(t), 0], [0, 0, 0, 1]])


def roty(t):
    return np.array([[np.cos(t), 0, np.sin(t), 0], [0, 1, 0, 0], [-np.sin(t), 0, np.cos(t), 0], [0, 0, 0, 1]])


def rotz(t):
    return np.array([[np.cos(t), -np.sin(t), 0, 0], [np.sin(t), np.cos(t), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def transl(p):
    T = np.eye(4)
    T[:3, 3] = p
    return T


def origin(el):
    o = None if el is None else el.find("origin")
    xyz = [float(x) for x in (o.get("xyz", "0 0 0") if o is not None else "0 0 0").split()]
    r, p, y = [float(x) for x in (o.get("rpy", "0 0 0") if o is not None else "0 0 0").split()]
    return transl(xyz) @ rotz(y) @ roty(p) @ rotx(r)


def trotk(k, t):
    K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    T = np.eye(4)
    T[:3, :3] = np.eye(3) + np.sin(t) * K + (1 - np.cos(t)) * K @ K
    return T


cross = np.cross


class Code:
    version = "1"

    def __init__(self, urdf, floating=False):
        root = ET.fromstring(urdf)
        el = {x.get("name"): x for x in root.findall("link")}
        js = root.findall("joint")
        sons = {}
        for j in js:
            sons.setdefault(j.find("parent").get("link"), []).append(j)
        base = (set(el) - {j.find("child").get("link") for j in js}).pop()
        self.name = "matlab"
        self.link, self.parent, self.Tree, self.type, self.k, self.dof = (
            ["", base],
            [0, 0],
            [0, np.eye(4)],
            ["", "B"],
            [0, 0 * np.ones(3)],
            [0, 0],
        )
        names = []
        stack = [(1, j) for j in sons.get(base, [])[::-1]]
        while stack:
            p, j = stack.pop()
            child = j.find("child").get("link")
            kind = j.get("type")
            a = j.find("axis")
            k = np.array([float(x) for x in a.get("xyz").split()] if a is not None else [1.0, 0, 0])
            self.link.append(child)
            self.parent.append(p)
            self.Tree.append(origin(j))
            self.type.append({"fixed": "F", "prismatic": "P"}.get(kind, "R"))
            self.k.append(k / np.linalg.norm(k) if kind != "fixed" else 0 * k)
            if kind != "fixed":
                names.append(j.get("name"))
            self.dof.append(len(names) if kind != "fixed" else 0)
            stack += [(len(self.link) - 1, c) for c in sons.get(child, [])[::-1]]
        self.n, self.N = len(names), len(self.link) - 1
        self.m, self.c, self.I = [0] * (self.N + 1), [0] * (self.N + 1), [0] * (self.N + 1)
        for i in range(1, self.N + 1):
            x = el[self.link[i]].find("inertial")
            T = origin(x)
            self.m[i] = float(x.find("mass").get("value")) if x is not None else 0.0
            t = {
                s: float(x.find("inertia").get(s, 0)) if x is not None else 0.0
                for s in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
            }
            Ic = np.array(
                [[t["ixx"], t["ixy"], t["ixz"]], [t["ixy"], t["iyy"], t["iyz"]], [t["ixz"], t["iyz"], t["izz"]]]
            )
            self.c[i] = T[:3, 3]
            self.I[i] = T[:3, :3] @ Ic @ T[:3, :3].T
        self.grav = np.array([0, 0, -9.81])
        self.writes = Convention(q=tuple(names), v=tuple(names))

    def fkine(self, q):
        q = np.r_[0, q]
        T, A = [0] * (self.N + 1), [0] * (self.N + 1)
        T[1] = A[1] = np.eye(4)
        for i in range(2, self.N + 1):
            p = self.parent[i]
            A[i] = T[p] @ self.Tree[i]
            d = self.dof[i]
            if self.type[i] == "R":
                T[i] = A[i] @ trotk(self.k[i], q[d])
            elif self.type[i] == "P":
                T[i] = A[i] @ transl(self.k[i] * q[d])
            else:
                T[i] = A[i]
        return T, A

    def outward(self, q, qd, qdd, a0):
        T, A = self.fkine(q)
        qd, qdd = np.r_[0, qd], np.r_[0, qdd]
        w, wd, v, a, z = ([np.zeros(3)] * (self.N + 1) for _ in range(5))
        a[1] = a0
        for i in range(2, self.N + 1):
            p, d = self.parent[i], self.dof[i]
            z[i] = A[i][:3, :3] @ self.k[i]
            r = T[i][:3, 3] - T[p][:3, 3]
            w[i], wd[i] = w[p], wd[p]
            v[i] = v[p] + cross(w[p], r)
            a[i] = a[p] + cross(wd[p], r) + cross(w[p], cross(w[p], r))
            if self.type[i] == "R":
                w[i] = w[p] + z[i] * qd[d]
                wd[i] = wd[p] + z[i] * qdd[d] + cross(w[p], z[i] * qd[d])
            elif self.type[i] == "P":
                v[i] = v[i] + z[i] * qd[d]
                a[i] = a[i] + z[i] * qdd[d] + 2 * cross(w[p], z[i] * qd[d])
        return T, A, z, w, wd, v, a

    def rne(self, q, qd, qdd, grav):
        T, A, z, w, wd, v, a = self.outward(q, qd, qdd, -grav)
        f, nn = [np.zeros(3)] * (self.N + 1), [np.zeros(3)] * (self.N + 1)
        tau = np.zeros(self.n + 1)
        for i in range(self.N, 1, -1):
            p = self.parent[i]
            R = T[i][:3, :3]
            rc = R @ self.c[i]
            ac = a[i] + cross(wd[i], rc) + cross(w[i], cross(w[i], rc))
            F = self.m[i] * ac
            I = R @ self.I[i] @ R.T
            Nm = I @ wd[i] + cross(w[i], I @ w[i])
            f[i] = f[i] + F
            nn[i] = nn[i] + Nm + cross(rc, F)
            if self.type[i] == "R":
                tau[self.dof[i]] = z[i] @ nn[i]
            elif self.type[i] == "P":
                tau[self.dof[i]] = z[i] @ f[i]
            r = T[i][:3, 3] - T[p][:3, 3]
            f[p] = f[p] + f[i]
            nn[p] = nn[p] + nn[i] + cross(r, f[i])
        return tau[1:]

    def rnea(self, q, v, a):
        return self.rne(q, v, a, self.grav)

    def bias(self, q, v):
        return self.rne(q, v, 0 * v, self.grav)

    def gravity(self, q):
        return self.rne(q, 0 * q, 0 * q, self.grav)

    def crba(self, q):
        M = np.zeros((self.n, self.n))
        for j in range(self.n):
            M[:, j] = self.rne(q, 0 * q, np.eye(self.n)[j], np.zeros(3))
        return M

    def coriolis(self, q, qd):
        n, E, no = self.n, np.eye(self.n), np.zeros(3)
        C, sq = np.zeros((n, n)), np.zeros((n, n))
        for j in range(n):
            sq[:, j] = self.rne(q, E[j], 0 * q, no)
        for j in range(n):
            for k in range(j + 1, n):
                t = self.rne(q, E[j] + E[k], 0 * q, no) - sq[:, j] - sq[:, k]
                C[:, j] += t * qd[k] / 2
                C[:, k] += t * qd[j] / 2
        return C + sq * qd

    def aba(self, q, v, tau):
        return np.linalg.solve(self.crba(q), tau - self.bias(q, v))

    def minv(self, q):
        return np.linalg.inv(self.crba(q))

    def chain(self, i):
        out = []
        while i > 1:
            if self.dof[i]:
                out.append(i)
            i = self.parent[i]
        return out

    def jac(self, q, i, p):
        T, A = self.fkine(q)
        J = np.zeros((6, self.n + 1))
        for j in self.chain(i):
            z = A[j][:3, :3] @ self.k[j]
            if self.type[j] == "R":
                J[:, self.dof[j]] = np.r_[z, cross(z, p - T[j][:3, 3])]
            else:
                J[:, self.dof[j]] = np.r_[0 * z, z]
        return J[:, 1:]

    def fk(self, q, frame):
        return self.fkine(q)[0][self.link.index(frame)]

    def jacobian(self, q, frame):
        return self.jac(q, self.link.index(frame), self.fk(q, frame)[:3, 3])

    def jacobian_dot(self, q, qd, frame):
        T, A, z, w, wd, v, a = self.outward(q, qd, 0 * qd, np.zeros(3))
        i = self.link.index(frame)
        D = np.zeros((6, self.n + 1))
        for j in self.chain(i):
            zd = cross(w[self.parent[j]], z[j])
            if self.type[j] == "R":
                r, rd = T[i][:3, 3] - T[j][:3, 3], v[i] - v[j]
                D[:, self.dof[j]] = np.r_[zd, cross(zd, r) + cross(z[j], rd)]
            else:
                D[:, self.dof[j]] = np.r_[0 * zd, zd]
        return D[:, 1:]

    def frame_velocity(self, q, qd, frame):
        T, A, z, w, wd, v, a = self.outward(q, qd, 0 * qd, np.zeros(3))
        i = self.link.index(frame)
        return np.r_[w[i], v[i]]

    def frame_acceleration(self, q, qd, qdd, frame):
        T, A, z, w, wd, v, a = self.outward(q, qd, qdd, np.zeros(3))
        i = self.link.index(frame)
        return np.r_[wd[i], a[i]]

    def moving(self):
        return [i for i in range(2, self.N + 1) if self.chain(i)]

    def com(self, q):
        T, A = self.fkine(q)
        s, M = np.zeros(3), 0
        for i in self.moving():
            s = s + self.m[i] * (T[i] @ np.r_[self.c[i], 1])[:3]
            M = M + self.m[i]
        return s / M

    def com_jacobian(self, q):
        T, A = self.fkine(q)
        s, M = 0, 0
        for i in self.moving():
            s = s + self.m[i] * self.jac(q, i, (T[i] @ np.r_[self.c[i], 1])[:3])[3:]
            M = M + self.m[i]
        return s / M

    def potential_energy(self, q):
        T, A = self.fkine(q)
        return -sum(self.m[i] * (T[i] @ np.r_[self.c[i], 1])[:3] @ self.grav for i in self.moving())

    def kinetic_energy(self, q, qd):
        T, A, z, w, wd, v, a = self.outward(q, qd, 0 * qd, np.zeros(3))
        K = 0.0
        for i in self.moving():
            R = T[i][:3, :3]
            vc = v[i] + cross(w[i], R @ self.c[i])
            wb = R.T @ w[i]
            K += 0.5 * self.m[i] * vc @ vc + 0.5 * wb @ self.I[i] @ wb
        return K
