"""Rigid-body dynamics of a legged robot or an arm by geometric Jacobians of all links.

q = [base x y z, quaternion x y z w, joints], v = [base linear (world), base angular (body), joints]; rows linear first.
"""

import xml.etree.ElementTree as ET

import numpy as np


def S(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rot_axis(axis, angle):
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


def rot_rpy(roll, pitch, yaw):
    cr, sr = np.cos(roll), np.sin(roll)
    cp, sp = np.cos(pitch), np.sin(pitch)
    cy, sy = np.cos(yaw), np.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rot_quat(x, y, z, w):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def homogeneous(R, p):
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = p
    return T


def read_vector(element, key, default):
    text = element.get(key) if element is not None else None
    return np.array([float(t) for t in text.split()]) if text else np.array(default, float)


def read_pose(element):
    o = element.find("origin")
    xyz = read_vector(o, "xyz", [0, 0, 0])
    rpy = read_vector(o, "rpy", [0, 0, 0])
    return homogeneous(rot_rpy(*rpy), xyz)


class Link:
    def __init__(self, element):
        self.name = element.get("name")
        self.parent = None
        self.kind = "root"
        self.axis = np.zeros(3)
        self.pose = np.eye(4)
        self.dof = None
        self.mass, self.c, self.I = 0.0, np.zeros(3), np.zeros((3, 3))
        inertial = element.find("inertial")
        if inertial is not None:
            self.mass = float(inertial.find("mass").get("value"))
            T = read_pose(inertial)
            self.c = T[:3, 3]
            t = {k: float(x) for k, x in inertial.find("inertia").attrib.items()}
            I = np.array(
                [[t["ixx"], t["ixy"], t["ixz"]], [t["ixy"], t["iyy"], t["iyz"]], [t["ixz"], t["iyz"], t["izz"]]]
            )
            self.I = T[:3, :3] @ I @ T[:3, :3].T  # about its centre of mass, in axes of the link


class Code:
    """The dynamics, as a subject that can be judged."""

    name, version = "jacobians", "1"

    def __init__(self, urdf, floating=False, gravity=(0.0, 0.0, -9.81)):
        self.g = np.array(gravity)
        self.floating = floating
        root = ET.fromstring(urdf)
        links = {e.get("name"): Link(e) for e in root.findall("link")}
        below = {}
        for j in root.findall("joint"):
            link = links[j.find("child").get("link")]
            link.parent = links[j.find("parent").get("link")]
            link.kind = j.get("type")
            link.pose = read_pose(j)
            axis = read_vector(j.find("axis"), "xyz", [1, 0, 0])
            link.axis = axis / np.linalg.norm(axis)
            link.joint = j.get("name")
            below.setdefault(link.parent.name, []).append(link)
        base = next(x for x in links.values() if x.parent is None)
        self.links = [base]
        for link in self.links:  # breadth first
            self.links += below.get(link.name, [])
        self.by_name = {x.name: x for x in self.links}
        self.qoff, self.voff = (7, 6) if floating else (0, 0)
        moving = [x for x in self.links if x.kind not in ("root", "fixed")]
        for k, x in enumerate(moving):
            x.dof = k
        self.n = len(moving)
        self.nv = self.n + self.voff
        self.heavy = [x for x in self.links if x.mass > 0 and (floating or any(self.chain(x)))]
        self.total = sum(x.mass for x in self.heavy)
        joints = tuple(x.joint for x in moving)
        self.writes = dict(
            q=(("x", "y", "z", "qx", "qy", "qz", "qw") if floating else ()) + joints,
            v=(("vx", "vy", "vz", "wx", "wy", "wz") if floating else ()) + joints,
            rows=("vx", "vy", "vz", "wx", "wy", "wz"),
            linear="world",
            angular="body",
            reference="local_world_aligned",
        )

    # kinematics -------------------------------------------------------------------------------------------------
    def poses(self, q):
        """World poses of all links."""
        T = {}
        for x in self.links:
            if x.parent is None:
                T[x.name] = homogeneous(rot_quat(*q[3:7]), q[:3]) if self.floating else np.eye(4)
                continue
            step = np.eye(4)
            if x.kind in ("revolute", "continuous"):
                step[:3, :3] = rot_axis(x.axis, q[self.qoff + x.dof])
            elif x.kind == "prismatic":
                step[:3, 3] = x.axis * q[self.qoff + x.dof]
            T[x.name] = T[x.parent.name] @ x.pose @ step
        return T

    def velocities(self, T, v):
        """Angular velocity and velocity of the origin of all links, in world axes."""
        w, u = {}, {}
        for x in self.links:
            R, p = T[x.name][:3, :3], T[x.name][:3, 3]
            if x.parent is None:
                w[x.name] = R @ v[3:6] if self.floating else np.zeros(3)
                u[x.name] = v[0:3] if self.floating else np.zeros(3)
                continue
            up = x.parent.name
            w[x.name] = w[up]
            u[x.name] = u[up] + np.cross(w[up], p - T[up][:3, 3])
            if x.kind in ("revolute", "continuous"):
                w[x.name] = w[up] + R @ x.axis * v[self.voff + x.dof]
            elif x.kind == "prismatic":
                u[x.name] = u[x.name] + R @ x.axis * v[self.voff + x.dof]
        return w, u

    def chain(self, link):
        """The link and its ancestors that move by a joint."""
        while link.parent is not None:
            if link.dof is not None:
                yield link
            link = link.parent

    def point_jacobian(self, T, link, p):
        """Linear and angular Jacobian of the point p (world) that is fixed to the link."""
        Jv, Jw = np.zeros((3, self.nv)), np.zeros((3, self.nv))
        if self.floating:
            base = T[self.links[0].name]
            Jv[:, 0:3] = np.eye(3)
            Jw[:, 3:6] = base[:3, :3]
            Jv[:, 3:6] = -S(p - base[:3, 3]) @ base[:3, :3]
        for x in self.chain(link):
            k = self.voff + x.dof
            z = T[x.name][:3, :3] @ x.axis
            if x.kind == "prismatic":
                Jv[:, k] = z
            else:
                Jv[:, k] = np.cross(z, p - T[x.name][:3, 3])
                Jw[:, k] = z
        return Jv, Jw

    def point_jacobian_dot(self, T, v, link, p):
        """Rates of the same."""
        w, u = self.velocities(T, v)
        dp = u[link.name] + np.cross(w[link.name], p - T[link.name][:3, 3])
        Jv, Jw = np.zeros((3, self.nv)), np.zeros((3, self.nv))
        if self.floating:
            name = self.links[0].name
            R, o = T[name][:3, :3], T[name][:3, 3]
            dR = S(w[name]) @ R
            Jw[:, 3:6] = dR
            Jv[:, 3:6] = -S(dp - u[name]) @ R - S(p - o) @ dR
        for x in self.chain(link):
            k = self.voff + x.dof
            z = T[x.name][:3, :3] @ x.axis
            dz = np.cross(w[x.parent.name], z)
            if x.kind == "prismatic":
                Jv[:, k] = dz
            else:
                Jv[:, k] = np.cross(dz, p - T[x.name][:3, 3]) + np.cross(z, dp - u[x.name])
                Jw[:, k] = dz
        return Jv, Jw

    def fk(self, q, frame):
        return self.poses(q)[frame]

    def jacobian(self, q, frame):
        T = self.poses(q)
        Jv, Jw = self.point_jacobian(T, self.by_name[frame], T[frame][:3, 3])
        return np.vstack([Jv, Jw])

    def frame_velocity(self, q, v, frame):
        w, u = self.velocities(self.poses(q), v)
        return np.concatenate([u[frame], w[frame]])

    def jacobian_dot(self, q, v, frame):
        T = self.poses(q)
        Jv, Jw = self.point_jacobian_dot(T, v, self.by_name[frame], T[frame][:3, 3])
        return np.vstack([Jv, Jw])

    def frame_acceleration(self, q, v, a, frame):
        return self.jacobian(q, frame) @ a + self.jacobian_dot(q, v, frame) @ v

    # dynamics ---------------------------------------------------------------------------------------------------
    def at_com(self, T, x):
        """World position of the centre of mass of a link, its inertia in world axes, and Jacobians."""
        R = T[x.name][:3, :3]
        c = T[x.name][:3, 3] + R @ x.c
        return c, R @ x.I @ R.T, *self.point_jacobian(T, x, c)

    def crba(self, q):
        T = self.poses(q)
        M = np.zeros((self.nv, self.nv))
        for x in self.heavy:
            c, I, Jv, Jw = self.at_com(T, x)
            M += x.mass * Jv.T @ Jv + Jw.T @ I @ Jw
        return M

    def gravity(self, q):
        T = self.poses(q)
        G = np.zeros(self.nv)
        for x in self.heavy:
            c, I, Jv, Jw = self.at_com(T, x)
            G -= Jv.T @ (x.mass * self.g)
        return G

    def coriolis(self, q, v):
        """C = sum J^T (I dJ + B J); B w = w x I w, and dM/dt = C + C^T."""
        T = self.poses(q)
        C = np.zeros((self.nv, self.nv))
        for x in self.heavy:
            c, I, Jv, Jw = self.at_com(T, x)
            dJv, dJw = self.point_jacobian_dot(T, v, x, c)
            w = Jw @ v
            B = 0.5 * (S(w) @ I - I @ S(w) - S(I @ w))
            C += x.mass * Jv.T @ dJv + Jw.T @ (I @ dJw + B @ Jw)
        return C

    def bias(self, q, v):
        T = self.poses(q)
        h = np.zeros(self.nv)
        for x in self.heavy:
            c, I, Jv, Jw = self.at_com(T, x)
            dJv, dJw = self.point_jacobian_dot(T, v, x, c)
            w = Jw @ v
            h += Jv.T @ (x.mass * (dJv @ v - self.g))
            h += Jw.T @ (I @ dJw @ v + np.cross(w, I @ w))
        return h

    def rnea(self, q, v, a):
        """Newton and Euler for every link, projected by its Jacobian."""
        T = self.poses(q)
        tau = np.zeros(self.nv)
        for x in self.heavy:
            c, I, Jv, Jw = self.at_com(T, x)
            dJv, dJw = self.point_jacobian_dot(T, v, x, c)
            w = Jw @ v
            acc = Jv @ a + dJv @ v
            alpha = Jw @ a + dJw @ v
            force = x.mass * (acc - self.g)
            moment = I @ alpha + np.cross(w, I @ w)
            tau += Jv.T @ force + Jw.T @ moment
        return tau

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        return self.rnea(q, v, a) - self.jacobian(q, frame).T @ f_ext

    def aba(self, q, v, tau):
        return np.linalg.solve(self.crba(q), tau - self.bias(q, v))

    def minv(self, q):
        L = np.linalg.cholesky(self.crba(q))
        Li = np.linalg.inv(L)
        return Li.T @ Li

    # momentum and energy ----------------------------------------------------------------------------------------
    def com(self, q):
        T = self.poses(q)
        c = np.zeros(3)
        for x in self.heavy:
            c += x.mass * (T[x.name][:3, 3] + T[x.name][:3, :3] @ x.c)
        return c / self.total

    def com_jacobian(self, q):
        T = self.poses(q)
        J = np.zeros((3, self.nv))
        for x in self.heavy:
            c, I, Jv, Jw = self.at_com(T, x)
            J += x.mass * Jv
        return J / self.total

    def centroidal_momentum_matrix(self, q):
        T = self.poses(q)
        com = self.com(q)
        linear, angular = np.zeros((3, self.nv)), np.zeros((3, self.nv))
        for x in self.heavy:
            c, I, Jv, Jw = self.at_com(T, x)
            linear += x.mass * Jv
            angular += I @ Jw + x.mass * S(c - com) @ Jv
        return np.vstack([linear, angular])

    def kinetic_energy(self, q, v):
        T = self.poses(q)
        w, u = self.velocities(T, v)
        E = 0.0
        for x in self.heavy:
            R = T[x.name][:3, :3]
            vc = u[x.name] + np.cross(w[x.name], R @ x.c)
            wb = R.T @ w[x.name]
            E += 0.5 * x.mass * vc @ vc + 0.5 * wb @ x.I @ wb
        return E

    def potential_energy(self, q):
        T = self.poses(q)
        U = 0.0
        for x in self.heavy:
            c = T[x.name][:3, 3] + T[x.name][:3, :3] @ x.c
            U -= x.mass * c @ self.g
        return U
