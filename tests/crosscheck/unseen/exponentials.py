"""Rigid-body dynamics by products of exponentials, as in Lynch & Park: space screws, body twists at centres of mass."""

import xml.etree.ElementTree as ET

import numpy as np


def skew(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def trans(R, p):
    T = np.zeros((4, 4), dtype=np.result_type(R, p))
    T[:3, :3] = R
    T[:3, 3] = p
    T[3, 3] = 1
    return T


def trans_inv(T):
    R, p = T[:3, :3], T[:3, 3]
    return trans(R.T, -R.T @ p)


def adjoint(T):
    R, p = T[:3, :3], T[:3, 3]
    X = np.zeros((6, 6), dtype=T.dtype)
    X[:3, :3] = R
    X[3:, :3] = skew(p) @ R
    X[3:, 3:] = R
    return X


def small_ad(V):
    X = np.zeros((6, 6), dtype=V.dtype)
    X[:3, :3] = skew(V[:3])
    X[3:, :3] = skew(V[3:])
    X[3:, 3:] = skew(V[:3])
    return X


def exp3(w, th):
    W = skew(w)
    return np.eye(3) + np.sin(th) * W + (1 - np.cos(th)) * W @ W


def exp6(S, th):
    w, v = S[:3], S[3:]
    if np.linalg.norm(w.real) < 1e-9:
        return trans(np.eye(3), v * th)
    W = skew(w)
    G = th * np.eye(3) + (1 - np.cos(th)) * W + (th - np.sin(th)) * W @ W
    return trans(exp3(w, th), G @ v)


def numbers(text):
    return np.array([float(x) for x in text.split()])


def rpy_to_rot(rpy):
    r, p, y = rpy
    return exp3([0, 0, 1], y) @ exp3([0, 1, 0], p) @ exp3([1, 0, 0], r)


def origin(element):
    o = element.find("origin") if element is not None else None
    if o is None:
        return np.eye(4)
    xyz = numbers(o.get("xyz", "0 0 0"))
    rpy = numbers(o.get("rpy", "0 0 0"))
    return trans(rpy_to_rot(rpy), xyz)


class Body:
    """A moving body: the link behind a joint with all that is fixed to it."""

    def __init__(self, name, parent):
        self.name = name
        self.parent = parent
        self.parts = []  # (mass, home pose of the part's centre of mass, inertia there)


class Code:
    """The dynamics, as a subject that can be judged."""

    name, version = "exponentials", "1"

    def __init__(self, urdf, floating=False, gravity=(0, 0, -9.81)):
        self.g = np.array(gravity, dtype=float)
        root = ET.fromstring(urdf)
        self.links = {x.get("name"): x for x in root.findall("link")}
        children = {}
        moved = set()
        for j in root.findall("joint"):
            children.setdefault(j.find("parent").get("link"), []).append(j)
            moved.add(j.find("child").get("link"))
        base = [x for x in self.links if x not in moved][0]
        self.bodies, self.S, self.frames = [], [], {}
        self.walk(base, np.eye(4), -1, children)
        self.n = len(self.bodies)
        self.parent = [b.parent for b in self.bodies]
        self.joint_names = [b.name for b in self.bodies]
        self.lump()
        self.writes = dict(q=tuple(self.joint_names), v=tuple(self.joint_names), reference="world")

    def walk(self, link, M, body, children):
        """Home pose M of the link, which belongs to the body."""
        self.frames[link] = (body, M)
        if body >= 0:
            self.add_mass(link, M, body)
        for j in children.get(link, []):
            H = M @ origin(j)
            child = j.find("child").get("link")
            if j.get("type") == "fixed":
                self.walk(child, H, body, children)
                continue
            axis = j.find("axis")
            a = numbers(axis.get("xyz")) if axis is not None else np.array([1.0, 0, 0])
            a = a / np.linalg.norm(a)
            w = H[:3, :3] @ a
            p = H[:3, 3]
            if j.get("type") == "prismatic":
                S = np.concatenate([np.zeros(3), w])
            else:
                S = np.concatenate([w, -np.cross(w, p)])
            self.bodies.append(Body(j.get("name"), body))
            self.S.append(S)
            self.walk(child, H, len(self.bodies) - 1, children)

    def add_mass(self, link, M, body):
        inertial = self.links[link].find("inertial")
        if inertial is None:
            return
        m = float(inertial.find("mass").get("value"))
        e = inertial.find("inertia")
        ixx, ixy, ixz, iyy, iyz, izz = (float(e.get(k)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
        inertia = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
        self.bodies[body].parts.append((m, M @ origin(inertial), inertia))

    def lump(self):
        """Mass, home frame at the centre of mass (axes of the space frame) and spatial inertia of each body."""
        self.m, self.M, self.G, self.A = [], [], [], []
        for S, b in zip(self.S, self.bodies):
            m = sum(x[0] for x in b.parts)
            c = sum(x[0] * x[1][:3, 3] for x in b.parts) / m if m > 0 else np.zeros(3)
            inertia = np.zeros((3, 3))
            for mass, T, I in b.parts:
                R, d = T[:3, :3], T[:3, 3] - c
                inertia += R @ I @ R.T
                inertia += mass * (d @ d * np.eye(3) - np.outer(d, d))
            G = np.zeros((6, 6))
            G[:3, :3] = inertia
            G[3:, 3:] = m * np.eye(3)
            M = trans(np.eye(3), c)
            self.m.append(m)
            self.M.append(M)
            self.G.append(G)
            self.A.append(adjoint(trans_inv(M)) @ S)

    # kinematics -------------------------------------------------------------------------------------------------
    def exponentials(self, q):
        """Products of exponentials up to each joint."""
        E = []
        for i in range(self.n):
            before = E[self.parent[i]] if self.parent[i] >= 0 else np.eye(4)
            E.append(before @ exp6(self.S[i], q[i]))
        return E

    def path(self, body):
        """Joints from the base to the body."""
        found = []
        while body >= 0:
            found.append(body)
            body = self.parent[body]
        return found[::-1]

    def fk(self, q, frame):
        body, M = self.frames[frame]
        return self.exponentials(q)[body] @ M if body >= 0 else M

    def space_jacobian(self, q, body):
        E = self.exponentials(q)
        J = np.zeros((6, self.n), dtype=np.result_type(q, float))
        for i in self.path(body):
            before = E[self.parent[i]] if self.parent[i] >= 0 else np.eye(4)
            J[:, i] = adjoint(before) @ self.S[i]
        return J

    def jacobian(self, q, frame):
        return self.space_jacobian(q, self.frames[frame][0])

    def frame_velocity(self, q, v, frame):
        return self.jacobian(q, frame) @ v

    def jacobian_dot(self, q, v, frame):
        J = self.jacobian(q, frame)
        Jd = np.zeros_like(J)
        V = np.zeros(6)
        for i in self.path(self.frames[frame][0]):
            Jd[:, i] = small_ad(V) @ J[:, i]
            V = V + J[:, i] * v[i]
        return Jd

    def frame_acceleration(self, q, v, a, frame):
        return self.jacobian(q, frame) @ a + self.jacobian_dot(q, v, frame) @ v

    # dynamics ---------------------------------------------------------------------------------------------------
    def inverse_dynamics(self, q, v, a, g, Ftip=None):
        n = self.n
        dtype = np.result_type(q, float)
        V, Vd, Ad = [None] * n, [None] * n, [None] * n
        for i in range(n):
            p = self.parent[i]
            A = self.A[i]
            Mp = self.M[p] if p >= 0 else np.eye(4)
            Mi = trans_inv(self.M[i]) @ Mp
            Ad[i] = adjoint(exp6(A, -q[i]) @ Mi)
            Vp = V[p] if p >= 0 else np.zeros(6)
            Vdp = Vd[p] if p >= 0 else np.concatenate([np.zeros(3), -np.asarray(g)])
            V[i] = Ad[i] @ Vp + A * v[i]
            Vd[i] = Ad[i] @ Vdp + small_ad(V[i]) @ A * v[i] + A * a[i]
        F = [np.zeros(6, dtype=dtype) for _ in range(n)]
        tau = np.zeros(n, dtype=dtype)
        for i in reversed(range(n)):
            G = self.G[i]
            F[i] = F[i] + G @ Vd[i] - small_ad(V[i]).T @ (G @ V[i])
            if Ftip is not None and Ftip[0] == i:
                F[i] = F[i] - Ftip[1]
            tau[i] = F[i] @ self.A[i]
            p = self.parent[i]
            if p >= 0:
                F[p] = F[p] + Ad[i].T @ F[i]
        return tau

    def rnea(self, q, v, a):
        return self.inverse_dynamics(q, v, a, self.g)

    def gravity(self, q):
        zero = np.zeros(self.n)
        return self.inverse_dynamics(q, zero, zero, self.g)

    def quadratic(self, q, v):
        return self.inverse_dynamics(q, v, np.zeros(self.n), np.zeros(3))

    def bias(self, q, v):
        return self.quadratic(q, v) + self.gravity(q)

    def crba(self, q):
        zero = np.zeros(self.n)
        columns = [self.inverse_dynamics(q, zero, e, np.zeros(3)) for e in np.eye(self.n)]
        return np.array(columns).T

    def coriolis(self, q, v):
        n, h = self.n, 1e-30
        dM = np.zeros((n, n, n))
        for k in range(n):
            step = np.zeros(n, dtype=complex)
            step[k] = 1j * h
            dM[:, :, k] = self.crba(q + step).imag / h
        C = np.zeros((n, n))
        for i in range(n):
            for j in range(n):
                for k in range(n):
                    C[i, j] += 0.5 * (dM[i, j, k] + dM[i, k, j] - dM[j, k, i]) * v[k]
        return C

    def aba(self, q, v, tau):
        rest = tau - self.quadratic(q, v) - self.gravity(q)
        return np.linalg.solve(self.crba(q), rest)

    def minv(self, q):
        return np.linalg.inv(self.crba(q))

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        body = self.frames[frame][0]
        if body < 0:
            return self.rnea(q, v, a)
        T = self.exponentials(q)[body] @ self.M[body]
        return self.inverse_dynamics(q, v, a, self.g, (body, adjoint(T).T @ f_ext))

    # momentum and energy ----------------------------------------------------------------------------------------
    def com_frames(self, q):
        E = self.exponentials(q)
        return [E[i] @ self.M[i] for i in range(self.n)]

    def com(self, q):
        T = self.com_frames(q)
        return sum(m * x[:3, 3] for m, x in zip(self.m, T)) / sum(self.m)

    def com_jacobian(self, q):
        T = self.com_frames(q)
        J = np.zeros((3, self.n))
        for i in range(self.n):
            Js = self.space_jacobian(q, i)
            J += self.m[i] * (Js[3:] - skew(T[i][:3, 3]) @ Js[:3])
        return J / sum(self.m)

    def centroidal_momentum_matrix(self, q):
        T = self.com_frames(q)
        centre = trans(np.eye(3), self.com(q))
        A = np.zeros((6, self.n))
        for i in range(self.n):
            Jb = adjoint(trans_inv(T[i])) @ self.space_jacobian(q, i)
            A += adjoint(trans_inv(T[i]) @ centre).T @ self.G[i] @ Jb
        return A

    def kinetic_energy(self, q, v):
        T = self.com_frames(q)
        K = 0.0
        for i in range(self.n):
            Vb = adjoint(trans_inv(T[i])) @ self.space_jacobian(q, i) @ v
            K += 0.5 * Vb @ self.G[i] @ Vb
        return K

    def potential_energy(self, q):
        T = self.com_frames(q)
        U = 0.0
        for m, x in zip(self.m, T):
            U -= m * self.g @ x[:3, 3]
        return U
