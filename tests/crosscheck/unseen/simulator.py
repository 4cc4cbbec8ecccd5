"""A simulator's core: bodies with principal axes at their centres of mass, quaternions, reduced by Jacobians."""

import xml.etree.ElementTree as ET

import numpy as np

from dualpin import Convention


def qmul(a, b):
    """Hamilton's product, (x, y, z, w)."""
    return np.r_[a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3]]


def qrot(q, v):
    t = 2 * np.cross(q[:3], v)
    return v + q[3] * t + np.cross(q[:3], t)


def qmat(q):
    return np.column_stack([qrot(q, e) for e in np.eye(3)])


def qaxis(axis, angle):
    return np.r_[np.sin(angle / 2) * np.asarray(axis), np.cos(angle / 2)]


def qrpy(r, p, y):
    return qmul(qaxis((0, 0, 1), y), qmul(qaxis((0, 1, 0), p), qaxis((1, 0, 0), r)))


def qfrom(R):
    """Of a rotation matrix, by the largest of four."""
    w2 = np.array(
        [
            1 + R[0, 0] - R[1, 1] - R[2, 2],
            1 - R[0, 0] + R[1, 1] - R[2, 2],
            1 - R[0, 0] - R[1, 1] + R[2, 2],
            1 + np.trace(R),
        ]
    )
    k = int(np.argmax(w2))
    s = 2 * np.sqrt(w2[k])
    if k == 3:
        return np.r_[R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], s * s / 4] / s
    i, j, m = k, (k + 1) % 3, (k + 2) % 3
    q = np.zeros(4)
    q[i], q[j], q[m], q[3] = s / 4, (R[i, j] + R[j, i]) / s, (R[i, m] + R[m, i]) / s, (R[m, j] - R[j, m]) / s
    return q


def floats(el, name, default):
    return np.array(list(map(float, (el.get(name) if el is not None and el.get(name) else default).split())))


class Frame:
    """A pose: quaternion and position."""

    def __init__(self, q=(0, 0, 0, 1), p=(0, 0, 0)):
        self.q, self.p = np.asarray(q, float), np.asarray(p, float)

    def __mul__(self, other):
        return Frame(qmul(self.q, other.q), self.p + qrot(self.q, other.p))

    @staticmethod
    def of(el):
        o = el.find("origin") if el is not None else None
        return Frame(qrpy(*floats(o, "rpy", "0 0 0")), floats(o, "xyz", "0 0 0"))


class Code:
    version = "1"

    def __init__(self, urdf, floating=False):
        xml = ET.fromstring(urdf)
        self.name = "simulator"
        self.gravity_vector = np.array([0.0, 0.0, -9.81])
        links = {x.get("name"): x for x in xml.findall("link")}
        joints = xml.findall("joint")
        base = next(iter(set(links) - {j.find("child").get("link") for j in joints}))
        self.parent, self.axis, self.slide, self.pose0, names = [-1], [None], [False], [Frame()], []
        self.lumps = [[(base, Frame())]]
        self.where = {base: (0, Frame())}
        todo = [base]
        while todo:
            link = todo.pop(0)
            body, local = self.where[link]
            for j in [j for j in joints if j.find("parent").get("link") == link]:
                child = j.find("child").get("link")
                if j.get("type") == "fixed":
                    self.where[child] = (body, local * Frame.of(j))
                    self.lumps[body].append((child, local * Frame.of(j)))
                else:
                    a = floats(j.find("axis"), "xyz", "1 0 0")
                    names.append(j.get("name"))
                    self.parent.append(body)
                    self.axis.append(a / np.sqrt(a @ a))
                    self.slide.append(j.get("type") == "prismatic")
                    self.pose0.append(local * Frame.of(j))
                    self.where[child] = (len(names), Frame())
                    self.lumps.append([(child, Frame())])
                todo.append(child)
        self.n = len(names)
        self.mass, self.inertial, self.diag = [], [], []
        for lump in self.lumps:
            parts = []
            for link, local in lump:
                x = links[link].find("inertial")
                if x is None:
                    continue
                T = local * Frame.of(x)
                i = {k: float(x.find("inertia").get(k, 0)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
                D = np.diag([i["ixx"], i["iyy"], i["izz"]])
                U = np.array([[0, i["ixy"], i["ixz"]], [0, 0, i["iyz"]], [0, 0, 0]])
                I = D + U + U.T
                R = qmat(T.q)
                parts.append((float(x.find("mass").get("value")), T.p, R @ I @ R.T))
            m = sum(p[0] for p in parts)
            c = sum(p[0] * p[1] for p in parts) / m if m else np.zeros(3)
            I = np.zeros((3, 3))
            for mi, ci, Ii in parts:
                d = ci - c
                I += Ii + mi * (d @ d * np.eye(3) - np.outer(d, d))
            values, vectors = np.linalg.eigh(I)
            if np.linalg.det(vectors) < 0:
                vectors[:, 0] *= -1
            self.mass.append(m)
            self.inertial.append(Frame(qfrom(vectors), c))
            self.diag.append(values)
        self.writes = Convention(q=tuple(names), v=tuple(names))

    def forward(self, q):
        X = [Frame()]
        for i in range(1, self.n + 1):
            x = q[i - 1]
            move = Frame(p=self.axis[i] * x) if self.slide[i] else Frame(q=qaxis(self.axis[i], x))
            X.append(X[self.parent[i]] * self.pose0[i] * move)
        return X

    def bodies(self, q):
        """Centres, world inertia and Jacobians (linear first) of all bodies."""
        X = self.forward(q)
        out = []
        for i in range(1, self.n + 1):
            B = X[i] * self.inertial[i]
            R = qmat(B.q)
            J = self.columns(X, i, B.p)
            out.append((self.mass[i], B.p, R @ np.diag(self.diag[i]) @ R.T, J))
        return out

    def columns(self, X, i, point):
        J = np.zeros((6, self.n))
        while i > 0:
            z = qrot(X[i].q, self.axis[i])
            if self.slide[i]:
                J[:3, i - 1] = z
            else:
                J[:3, i - 1] = np.cross(z, point - X[i].p)
                J[3:, i - 1] = z
            i = self.parent[i]
        return J

    def velocity_accelerations(self, q, v):
        """Of each body: angular velocity, and both accelerations while joints do not accelerate."""
        X = self.forward(q)
        w, al, ac = [np.zeros(3)], [np.zeros(3)], [np.zeros(3)]
        for i in range(1, self.n + 1):
            p = self.parent[i]
            z = qrot(X[i].q, self.axis[i])
            r = X[i].p - X[p].p
            a = ac[p] + np.cross(al[p], r) + np.cross(w[p], np.cross(w[p], r))
            if self.slide[i]:
                w.append(w[p])
                al.append(al[p])
                ac.append(a + 2 * np.cross(w[p], z) * v[i - 1])
            else:
                w.append(w[p] + z * v[i - 1])
                al.append(al[p] + np.cross(w[p], z) * v[i - 1])
                ac.append(a)
        return X, w, al, ac

    def crba(self, q):
        M = np.zeros((self.n, self.n))
        for m, c, I, J in self.bodies(q):
            M += m * J[:3].T @ J[:3] + J[3:].T @ I @ J[3:]
        return M

    def gravity(self, q):
        return -sum(J[:3].T @ (m * self.gravity_vector) for m, c, I, J in self.bodies(q))

    def bias(self, q, v):
        X, w, al, ac = self.velocity_accelerations(q, v)
        h = np.zeros(self.n)
        for i, (m, c, I, J) in enumerate(self.bodies(q), 1):
            r = c - X[i].p
            a = ac[i] + np.cross(al[i], r) + np.cross(w[i], np.cross(w[i], r))
            h += J[:3].T @ (m * (a - self.gravity_vector))
            h += J[3:].T @ (I @ al[i] + np.cross(w[i], I @ w[i]))
        return h

    def rnea(self, q, v, a):
        return self.crba(q) @ a + self.bias(q, v)

    def aba(self, q, v, tau):
        return np.linalg.solve(self.crba(q), tau - self.bias(q, v))

    def minv(self, q):
        return np.linalg.inv(self.crba(q))

    def com(self, q):
        B = self.bodies(q)
        return sum(m * c for m, c, I, J in B) / sum(m for m, c, I, J in B)

    def com_jacobian(self, q):
        B = self.bodies(q)
        return sum(m * J[:3] for m, c, I, J in B) / sum(m for m, c, I, J in B)

    def centroidal_momentum_matrix(self, q):
        B, G = self.bodies(q), self.com(q)
        linear = sum(m * J[:3] for m, c, I, J in B)
        angular = 0
        for m, c, I, J in B:
            d = c - G
            angular = angular + I @ J[3:] + m * np.cross(d, J[:3], axisb=0, axisc=0)
        return np.vstack([angular, linear])

    def kinetic_energy(self, q, v):
        return sum(
            0.5 * m * (J[:3] @ v) @ (J[:3] @ v) + 0.5 * (J[3:] @ v) @ I @ (J[3:] @ v) for m, c, I, J in self.bodies(q)
        )

    def potential_energy(self, q):
        return -sum(m * self.gravity_vector @ c for m, c, I, J in self.bodies(q))

    def fk(self, q, frame):
        i, local = self.where[frame]
        X = self.forward(q)[i] * local
        return np.r_[X.p, X.q[3], X.q[:3]]

    def jacobian(self, q, frame):
        X = self.forward(q)
        i, local = self.where[frame]
        J = self.columns(X, i, (X[i] * local).p)
        return np.vstack([J[3:], J[:3]])

    def frame_velocity(self, q, v, frame):
        return self.jacobian(q, frame) @ v

    def frame_acceleration(self, q, v, a, frame):
        X, w, al, ac = self.velocity_accelerations(q, v)
        i, local = self.where[frame]
        r = (X[i] * local).p - X[i].p
        bias = np.r_[al[i], ac[i] + np.cross(al[i], r) + np.cross(w[i], np.cross(w[i], r))]
        return self.jacobian(q, frame) @ a + bias
