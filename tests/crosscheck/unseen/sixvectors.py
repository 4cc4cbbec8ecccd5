"""A simulator's robot dynamics with spatial vectors in link coordinates, as in Featherstone's book (2008).

Links on fixed joints are merged into bodies.  Newton-Euler (table 5.1), composite bodies (6.2), articulated bodies
(7.1).  Motion vectors are [angular; linear]; a floating base is a joint with six freedoms and S = 1.
"""

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import numpy as np

# --- spatial algebra


def tilde(r):
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]], dtype=float)


def xform(E, r):
    """Motion transform from A to B: E turns A's coordinates into B's, r is B's origin in A."""
    X = np.zeros((6, 6))
    X[:3, :3] = X[3:, 3:] = E
    X[3:, :3] = -E @ tilde(r)
    return X


def crm(v):
    """v x (motion)."""
    X = np.zeros((6, 6))
    X[:3, :3] = X[3:, 3:] = tilde(v[:3])
    X[3:, :3] = tilde(v[3:])
    return X


def crf(v):
    """v x* (force)."""
    return -crm(v).T


def spatial_inertia(m, c, I):
    """Of a mass m with centre c and inertia I about the centre."""
    C = tilde(c)
    return np.block([[I + m * C @ C.T, m * C], [m * C.T, m * np.eye(3)]])


def rpy(r, p, y):
    cr, sr, cp, sp, cy, sy = np.cos(r), np.sin(r), np.cos(p), np.sin(p), np.cos(y), np.sin(y)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def about(axis, angle):
    x, y, z = axis
    c, s = np.cos(angle), np.sin(angle)
    t = 1 - c
    return np.array(
        [
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
        ]
    )


def of_quaternion(w, x, y, z):
    n = 2 / (w * w + x * x + y * y + z * z)
    return np.array(
        [
            [1 - n * (y * y + z * z), n * (x * y - w * z), n * (x * z + w * y)],
            [n * (x * y + w * z), 1 - n * (x * x + z * z), n * (y * z - w * x)],
            [n * (x * z - w * y), n * (y * z + w * x), 1 - n * (x * x + y * y)],
        ]
    )


# --- the model


@dataclass
class Body:
    """A body and the joint that places it on its parent; I is its spatial inertia about its own origin."""

    joint: str
    kind: str
    parent: int
    R: np.ndarray  # placement of the joint in the parent body
    p: np.ndarray
    axis: np.ndarray
    q: slice
    v: slice
    S: np.ndarray
    I: np.ndarray = field(default_factory=lambda: np.zeros((6, 6)))


def read_floats(element, key, default):
    text = None if element is None else element.get(key)
    return np.array([float(x) for x in (default if text is None else text).split()])


def read_pose(element):
    origin = element.find("origin")
    return rpy(*read_floats(origin, "rpy", "0 0 0")), read_floats(origin, "xyz", "0 0 0")


def read_inertia(link):
    """Spatial inertia of a link about its own origin."""
    e = link.find("inertial")
    if e is None:
        return np.zeros((6, 6))
    R, c = read_pose(e)
    m = float(e.find("mass").get("value"))
    t = e.find("inertia")
    ixx, ixy, ixz, iyy, iyz, izz = (float(t.get(k)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    I = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    return spatial_inertia(m, c, R @ I @ R.T)


class Code:
    """Bodies in the order in which they are met from the root, with the algorithms over them."""

    name, version = "sixvectors", "1"

    def __init__(self, urdf, floating=False, gravity=(0.0, 0.0, -9.81)):
        robot = ET.fromstring(urdf)
        self.elements = {e.get("name"): e for e in robot.iter("link")}
        self.outgoing = {}
        for j in robot.findall("joint"):
            self.outgoing.setdefault(j.find("parent").get("link"), []).append(j)
        inner = {j.find("child").get("link") for j in robot.findall("joint")}
        root = next(n for n in self.elements if n not in inner)
        self.bodies, self.frames = [], {}  # frames: link -> (body, R, p)
        self.nq = self.nv = 0
        self.q_names, self.v_names = [], []
        self.gravity_vector = np.array(gravity, dtype=float)
        if floating:
            self.bodies.append(
                Body("root", "free", -1, np.eye(3), np.zeros(3), np.zeros(3), slice(0, 7), slice(0, 6), np.eye(6))
            )
            self.nq, self.nv = 7, 6
            self.q_names = ["x", "y", "z", "qw", "qx", "qy", "qz"]
            self.v_names = ["wx", "wy", "wz", "vx", "vy", "vz"]
        self.grow(root, len(self.bodies) - 1, np.eye(3), np.zeros(3))
        self.writes = {"q": self.q_names, "v": self.v_names}

    def grow(self, link, body, R, p):
        """Add a link that stands at R, p on a body, and all behind it."""
        self.frames[link] = (body, R, p)
        if body >= 0:
            X = xform(R.T, p)
            self.bodies[body].I += X.T @ read_inertia(self.elements[link]) @ X
        for j in self.outgoing.get(link, []):
            child = j.find("child").get("link")
            Rj, pj = read_pose(j)
            Rj, pj = R @ Rj, p + R @ pj
            if j.get("type") == "fixed":
                self.grow(child, body, Rj, pj)
            else:
                self.add(j, body, Rj, pj)
                self.grow(child, len(self.bodies) - 1, np.eye(3), np.zeros(3))

    def add(self, j, parent, R, p):
        axis = read_floats(j.find("axis"), "xyz", "1 0 0")
        axis = axis / np.linalg.norm(axis)
        kind = "slide" if j.get("type") == "prismatic" else "hinge"
        S = np.zeros((6, 1))
        if kind == "slide":
            S[3:, 0] = axis
        else:
            S[:3, 0] = axis
        q, v = slice(self.nq, self.nq + 1), slice(self.nv, self.nv + 1)
        self.bodies.append(Body(j.get("name"), kind, parent, R, p, axis, q, v, S))
        self.nq, self.nv = self.nq + 1, self.nv + 1
        self.q_names.append(j.get("name"))
        self.v_names.append(j.get("name"))

    # kinematics

    def local_pose(self, b, q):
        """R, p of a body in its parent."""
        x = q[b.q]
        if b.kind == "free":
            return of_quaternion(*x[3:]), x[:3]
        if b.kind == "slide":
            return b.R, b.p + b.R @ b.axis * x[0]
        return b.R @ about(b.axis, x[0]), b.p

    def transforms(self, q):
        """Of each body: the transform from its parent's coordinates; R, p in the world."""
        Xup, R, p = [], [], []
        for b in self.bodies:
            Ri, pi = self.local_pose(b, q)
            Xup.append(xform(Ri.T, pi))
            if b.parent < 0:
                R.append(Ri)
                p.append(pi)
            else:
                R.append(R[b.parent] @ Ri)
                p.append(p[b.parent] + R[b.parent] @ pi)
        return Xup, R, p

    def pose(self, q, frame):
        body, R, p = self.frames[frame]
        if body < 0:
            return R, p
        _, Rb, pb = self.transforms(q)
        return Rb[body] @ R, pb[body] + Rb[body] @ p

    def to_frame(self, q, frame):
        """From the coordinates of the frame's body to the frame's origin in world axes."""
        _, R, p = self.frames[frame]
        Rw, _ = self.pose(q, frame)
        turn = np.kron(np.eye(2), Rw)
        return turn @ xform(R.T, p)

    def motion(self, q, v, a, a0):
        """Velocities and accelerations of the bodies in their own coordinates."""
        Xup, _, _ = self.transforms(q)
        V, A = [], []
        for b, X in zip(self.bodies, Xup):
            vJ = b.S @ v[b.v]
            if b.parent < 0:
                Vi = vJ
                Ai = X @ a0 + b.S @ a[b.v]
            else:
                Vi = X @ V[b.parent] + vJ
                Ai = X @ A[b.parent] + b.S @ a[b.v] + crm(Vi) @ vJ
            V.append(Vi)
            A.append(Ai)
        return Xup, V, A

    def fk(self, q, frame):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = self.pose(q, frame)
        return T

    def jacobian(self, q, frame):
        J = np.zeros((6, self.nv))
        Xup, _, _ = self.transforms(q)
        X = self.to_frame(q, frame)
        i = self.frames[frame][0]
        while i >= 0:
            b = self.bodies[i]
            J[:, b.v] = X @ b.S
            X = X @ Xup[i]
            i = b.parent
        return J

    def frame_velocity(self, q, v, frame):
        _, V, _ = self.motion(q, v, 0 * v, np.zeros(6))
        return self.to_frame(q, frame) @ V[self.frames[frame][0]]

    def frame_acceleration(self, q, v, a, frame):
        """Of the frame's origin, in world axes."""
        _, V, A = self.motion(q, v, a, np.zeros(6))
        i, X = self.frames[frame][0], self.to_frame(q, frame)
        u, s = X @ V[i], X @ A[i]
        s[3:] += np.cross(u[:3], u[3:])
        return s

    # mass

    def total_mass(self):
        return sum(b.I[5, 5] for b in self.bodies)

    def com(self, q):
        _, R, p = self.transforms(q)
        moment = np.zeros(3)
        for b, Ri, pi in zip(self.bodies, R, p):
            m = b.I[5, 5]
            mc = np.array([b.I[2, 4], b.I[0, 5], b.I[1, 3]])
            moment += m * pi + Ri @ mc
        return moment / self.total_mass()

    def composite(self, Xup):
        Ic = [b.I.copy() for b in self.bodies]
        for i in reversed(range(len(self.bodies))):
            k = self.bodies[i].parent
            if k >= 0:
                Ic[k] += Xup[i].T @ Ic[i] @ Xup[i]
        return Ic

    def centroidal_momentum_matrix(self, q):
        Xup, R, p = self.transforms(q)
        G, Ic = self.com(q), self.composite(Xup)
        A = np.zeros((6, self.nv))
        for i, b in enumerate(self.bodies):
            X = xform(R[i].T, p[i] - G)
            A[:, b.v] = X.T @ Ic[i] @ b.S
        return A

    def com_jacobian(self, q):
        return self.centroidal_momentum_matrix(q)[3:] / self.total_mass()

    def kinetic_energy(self, q, v):
        _, V, _ = self.motion(q, v, 0 * v, np.zeros(6))
        return 0.5 * sum(Vi @ b.I @ Vi for b, Vi in zip(self.bodies, V))

    def potential_energy(self, q):
        return -self.total_mass() * self.gravity_vector @ self.com(q)

    # dynamics

    def newton_euler(self, q, v, a, g, frame=None, wrench=None):
        a0 = np.concatenate([np.zeros(3), -g])
        Xup, V, A = self.motion(q, v, a, a0)
        F = [b.I @ Ai + crf(Vi) @ b.I @ Vi for b, Vi, Ai in zip(self.bodies, V, A)]
        if frame is not None:
            F[self.frames[frame][0]] = F[self.frames[frame][0]] - self.to_frame(q, frame).T @ wrench
        tau = np.zeros(self.nv)
        for i in reversed(range(len(self.bodies))):
            b = self.bodies[i]
            tau[b.v] = b.S.T @ F[i]
            if b.parent >= 0:
                F[b.parent] = F[b.parent] + Xup[i].T @ F[i]
        return tau

    def rnea(self, q, v, a):
        return self.newton_euler(q, v, a, self.gravity_vector)

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        return self.newton_euler(q, v, a, self.gravity_vector, frame, f_ext)

    def bias(self, q, v):
        return self.newton_euler(q, v, np.zeros(self.nv), self.gravity_vector)

    def gravity(self, q):
        zero = np.zeros(self.nv)
        return self.newton_euler(q, zero, zero, self.gravity_vector)

    def crba(self, q):
        Xup, _, _ = self.transforms(q)
        Ic = self.composite(Xup)
        H = np.zeros((self.nv, self.nv))
        for i, b in enumerate(self.bodies):
            F = Ic[i] @ b.S
            H[b.v, b.v] = b.S.T @ F
            k = i
            while self.bodies[k].parent >= 0:
                F = Xup[k].T @ F
                k = self.bodies[k].parent
                H[b.v, self.bodies[k].v] = F.T @ self.bodies[k].S
                H[self.bodies[k].v, b.v] = H[b.v, self.bodies[k].v].T
        return H

    def aba(self, q, v, tau):
        return self.articulated(q, v, tau, self.gravity_vector)

    def minv(self, q):
        zero, none = np.zeros(self.nv), np.zeros(3)
        return np.stack([self.articulated(q, zero, e, none) for e in np.eye(self.nv)], axis=1)

    def articulated(self, q, v, tau, g):
        Xup, _, _ = self.transforms(q)
        V, c, IA, pA = [], [], [], []
        for b, X in zip(self.bodies, Xup):
            vJ = b.S @ v[b.v]
            if b.parent < 0:
                V.append(vJ)
                c.append(np.zeros(6))
            else:
                V.append(X @ V[b.parent] + vJ)
                c.append(crm(V[-1]) @ vJ)
            IA.append(b.I.copy())
            pA.append(crf(V[-1]) @ b.I @ V[-1])
        U, D, u = [None] * len(V), [None] * len(V), [None] * len(V)
        for i in reversed(range(len(V))):
            b = self.bodies[i]
            U[i] = IA[i] @ b.S
            D[i] = b.S.T @ U[i]
            u[i] = tau[b.v] - b.S.T @ pA[i]
            if b.parent >= 0:
                Ia = IA[i] - U[i] @ np.linalg.solve(D[i], U[i].T)
                pa = pA[i] + Ia @ c[i] + U[i] @ np.linalg.solve(D[i], u[i])
                IA[b.parent] = IA[b.parent] + Xup[i].T @ Ia @ Xup[i]
                pA[b.parent] = pA[b.parent] + Xup[i].T @ pa
        qdd, A = np.zeros(self.nv), []
        for i, b in enumerate(self.bodies):
            before = A[b.parent] if b.parent >= 0 else np.concatenate([np.zeros(3), -g])
            Ai = Xup[i] @ before + c[i]
            qdd[b.v] = np.linalg.solve(D[i], u[i] - U[i].T @ Ai)
            A.append(Ai + b.S @ qdd[b.v])
        return qdd
