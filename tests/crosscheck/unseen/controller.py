"""A controller engineer's robot dynamics: homogeneous transforms and geometric Jacobians of every link.

Fixed joints are not merged: each link has its own transform and Jacobian.  M = sum J^T M_i J, C from Christoffel's
symbols with analytic derivatives of the Jacobians, g = -sum J^T m g.  Angular rows first.
"""

import xml.etree.ElementTree as ET

import numpy as np

# --- small geometry


def skew(v):
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def cross(a, b):
    return skew(a) @ b


def rot_x(a):
    c, s = np.cos(a), np.sin(a)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def rot_y(a):
    c, s = np.cos(a), np.sin(a)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def rot_z(a):
    c, s = np.cos(a), np.sin(a)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def rpy_to_matrix(rpy):
    roll, pitch, yaw = rpy
    return rot_z(yaw) @ rot_y(pitch) @ rot_x(roll)


def axis_angle(axis, angle):
    """Rodrigues' formula."""
    K = skew(axis)
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def homogeneous(R, p):
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = p
    return T


# --- the description


def vector(element, attribute, default):
    if element is None or element.get(attribute) is None:
        return np.array(default, dtype=float)
    return np.array([float(x) for x in element.get(attribute).split()])


def origin(element):
    o = element.find("origin")
    return homogeneous(rpy_to_matrix(vector(o, "rpy", (0, 0, 0))), vector(o, "xyz", (0, 0, 0)))


class Link:
    """Mass, centre of mass and inertia about it, both in the axes of the link."""

    def __init__(self, element):
        self.name = element.get("name")
        self.mass, self.com, self.inertia = 0.0, np.zeros(3), np.zeros((3, 3))
        inertial = element.find("inertial")
        if inertial is None:
            return
        self.mass = float(inertial.find("mass").get("value"))
        T = origin(inertial)
        self.com = T[:3, 3]
        i = {k: float(x) for k, x in inertial.find("inertia").attrib.items()}
        tensor = np.array(
            [
                [i["ixx"], i["ixy"], i["ixz"]],
                [i["ixy"], i["iyy"], i["iyz"]],
                [i["ixz"], i["iyz"], i["izz"]],
            ]
        )
        R = T[:3, :3]
        self.inertia = R @ tensor @ R.T


class Joint:
    """Where it stands on its parent link, its axis, and its column in the Jacobians."""

    def __init__(self, element):
        self.name = element.get("name")
        self.kind = element.get("type")
        self.parent = element.find("parent").get("link")
        self.child = element.find("child").get("link")
        self.origin = origin(element)
        axis = vector(element.find("axis"), "xyz", (1, 0, 0))
        self.axis = axis / np.linalg.norm(axis)
        self.column = -1  # in q; a fixed joint has none

    @property
    def moves(self):
        return self.kind != "fixed"

    @property
    def slides(self):
        return self.kind == "prismatic"

    def motion(self, x):
        if self.slides:
            return homogeneous(np.eye(3), self.axis * x)
        return homogeneous(axis_angle(self.axis, x), np.zeros(3))


# --- the controller's model


class Code:
    """Transforms and Jacobians of all links at the last q asked for, and what is made of them; the base is fixed."""

    name, version = "controller", "1"

    def __init__(self, urdf, floating=False, gravity=(0.0, 0.0, -9.81)):
        if floating:
            raise NotImplementedError("the base is fixed")
        root = ET.fromstring(urdf)
        self.links = {e.get("name"): Link(e) for e in root.findall("link")}
        joints = [Joint(e) for e in root.findall("joint")]
        children = {j.child for j in joints}
        self.base = next(name for name in self.links if name not in children)
        self.joints = self.sorted(joints)
        self.g = np.array(gravity, dtype=float)
        names = []
        for j in self.joints:
            if j.moves:
                j.column = len(names)
                names.append(j.name)
        self.n = len(names)
        self.moving = [j for j in self.joints if j.moves]
        # path[link]: columns of the joints between the base and the link, in this order
        self.path = {self.base: []}
        for j in self.joints:
            self.path[j.child] = self.path[j.parent] + ([j.column] if j.moves else [])
        self.bodies = [x for x in self.links.values() if self.path[x.name] and x.mass > 0]
        self.mass = sum(x.mass for x in self.bodies)
        self.q = None
        self.writes = {"q": names, "v": names}

    def sorted(self, joints):
        """Parents before children."""
        done, known, left = [], {self.base}, list(joints)
        while left:
            j = next(j for j in left if j.parent in known)
            left.remove(j)
            known.add(j.child)
            done.append(j)
        return done

    # kinematics

    def update(self, q):
        """Transforms of all links, axes and points of all joints, in the world."""
        if self.q is not None and np.array_equal(q, self.q):
            return
        self.q = np.array(q)
        self.T = {self.base: np.eye(4)}
        self.z, self.o = np.zeros((self.n, 3)), np.zeros((self.n, 3))
        for j in self.joints:
            T = self.T[j.parent] @ j.origin
            if j.moves:
                T = T @ j.motion(q[j.column])
                self.z[j.column] = T[:3, :3] @ j.axis
                self.o[j.column] = T[:3, 3]
            self.T[j.child] = T

    def center(self, link):
        T = self.T[link.name]
        return T[:3, :3] @ link.com + T[:3, 3]

    def world_inertia(self, link):
        R = self.T[link.name][:3, :3]
        return R @ link.inertia @ R.T

    def point_jacobian(self, path, point):
        Jw, Jv = np.zeros((3, self.n)), np.zeros((3, self.n))
        for k in path:
            if self.moving[k].slides:
                Jv[:, k] = self.z[k]
            else:
                Jw[:, k] = self.z[k]
                Jv[:, k] = cross(self.z[k], point - self.o[k])
        return Jw, Jv

    def jacobian_gradient(self, path, point):
        """dJw[k], dJv[k]: derivatives of the Jacobian of a point by q_k."""
        dJw, dJv = np.zeros((self.n, 3, self.n)), np.zeros((self.n, 3, self.n))
        _, Jv = self.point_jacobian(path, point)
        for a, k in enumerate(path):
            for b, i in enumerate(path):
                dz, do = np.zeros(3), np.zeros(3)
                if a < b:  # joint k carries joint i
                    if self.moving[k].slides:
                        do = self.z[k]
                    else:
                        dz = cross(self.z[k], self.z[i])
                        do = cross(self.z[k], self.o[i] - self.o[k])
                if self.moving[i].slides:
                    dJv[k, :, i] = dz
                else:
                    dJw[k, :, i] = dz
                    dJv[k, :, i] = cross(dz, point - self.o[i]) + cross(self.z[i], Jv[:, k] - do)
        return dJw, dJv

    def fk(self, q, frame):
        self.update(q)
        return self.T[frame]

    def jacobian(self, q, frame):
        self.update(q)
        return np.vstack(self.point_jacobian(self.path[frame], self.T[frame][:3, 3]))

    def jacobian_dot(self, q, v, frame):
        self.update(q)
        dJw, dJv = self.jacobian_gradient(self.path[frame], self.T[frame][:3, 3])
        return np.vstack([np.tensordot(v, dJw, 1), np.tensordot(v, dJv, 1)])

    def frame_velocity(self, q, v, frame):
        return self.jacobian(q, frame) @ v

    def frame_acceleration(self, q, v, a, frame):
        return self.jacobian(q, frame) @ a + self.jacobian_dot(q, v, frame) @ v

    # mass

    def com(self, q):
        self.update(q)
        return sum(x.mass * self.center(x) for x in self.bodies) / self.mass

    def com_jacobian(self, q):
        self.update(q)
        J = np.zeros((3, self.n))
        for x in self.bodies:
            _, Jv = self.point_jacobian(self.path[x.name], self.center(x))
            J += x.mass * Jv
        return J / self.mass

    def centroidal_momentum_matrix(self, q):
        G = self.com(q)
        A = np.zeros((6, self.n))
        for x in self.bodies:
            c = self.center(x)
            Jw, Jv = self.point_jacobian(self.path[x.name], c)
            A[:3] += self.world_inertia(x) @ Jw + x.mass * skew(c - G) @ Jv
            A[3:] += x.mass * Jv
        return A

    def kinetic_energy(self, q, v):
        self.update(q)
        energy = 0.0
        for x in self.bodies:
            Jw, Jv = self.point_jacobian(self.path[x.name], self.center(x))
            w, u = Jw @ v, Jv @ v
            energy += 0.5 * x.mass * u @ u + 0.5 * w @ self.world_inertia(x) @ w
        return energy

    def potential_energy(self, q):
        self.update(q)
        return -sum(x.mass * self.g @ self.center(x) for x in self.bodies)

    # dynamics

    def crba(self, q):
        self.update(q)
        M = np.zeros((self.n, self.n))
        for x in self.bodies:
            Jw, Jv = self.point_jacobian(self.path[x.name], self.center(x))
            M += x.mass * Jv.T @ Jv + Jw.T @ self.world_inertia(x) @ Jw
        return M

    def mass_gradient(self, q):
        """dM[k] = dM/dq_k."""
        self.update(q)
        dM = np.zeros((self.n, self.n, self.n))
        for x in self.bodies:
            path, c, I = self.path[x.name], self.center(x), self.world_inertia(x)
            Jw, Jv = self.point_jacobian(path, c)
            dJw, dJv = self.jacobian_gradient(path, c)
            for k in path:
                half = x.mass * dJv[k].T @ Jv + dJw[k].T @ I @ Jw
                dM[k] += half + half.T
                if not self.moving[k].slides:  # the tensor turns with joint k
                    S = skew(self.z[k])
                    dM[k] += Jw.T @ (S @ I - I @ S) @ Jw
        return dM

    def coriolis(self, q, v):
        dM = self.mass_gradient(q)
        C = np.zeros((self.n, self.n))
        for i in range(self.n):
            for j in range(self.n):
                for k in range(self.n):
                    C[i, j] += 0.5 * (dM[k, i, j] + dM[j, i, k] - dM[i, j, k]) * v[k]
        return C

    def gravity(self, q):
        self.update(q)
        g = np.zeros(self.n)
        for x in self.bodies:
            _, Jv = self.point_jacobian(self.path[x.name], self.center(x))
            g -= Jv.T @ (x.mass * self.g)
        return g

    def bias(self, q, v):
        return self.coriolis(q, v) @ v + self.gravity(q)

    def rnea(self, q, v, a):
        return self.crba(q) @ a + self.bias(q, v)

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        return self.rnea(q, v, a) - self.jacobian(q, frame).T @ f_ext

    def aba(self, q, v, tau):
        return np.linalg.solve(self.crba(q), tau - self.bias(q, v))

    def minv(self, q):
        return np.linalg.inv(self.crba(q))
