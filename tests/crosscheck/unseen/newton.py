"""Dynamics of a tree of rigid bodies in world axes, in NumPy.

Newton-Euler runs in world axes.  The mass matrix, the Coriolis matrix, gravity and the centroidal quantities come from
Jacobians of the centres of mass; so forces by recursion and forces by Jacobians check each other.

Six-vectors are angular first.  A floating base has q = (x, y, z, qw, qx, qy, qz, joints) and v = (w, v, joint rates),
the twist of the base in its own axes.
"""

import numpy as np

from tests.crosscheck.unseen.newton_reading import Model, axis_angle, quaternion_matrix, skew


class State:
    """Poses, velocities and accelerations of all bodies in world axes; of the origins of their frames."""

    def __init__(self, n):
        self.R, self.p = np.zeros((n, 3, 3)), np.zeros((n, 3))
        self.w, self.v = np.zeros((n, 3)), np.zeros((n, 3))
        self.dw, self.dv = np.zeros((n, 3)), np.zeros((n, 3))
        self.axis = {}


class Code:
    """The dynamics, as a subject that can be judged."""

    name, version = "newton", "1"

    def __init__(self, urdf, floating=False, gravity=(0.0, 0.0, -9.81)):
        self.model = Model(urdf, floating)
        self.floating, self.nv = floating, self.model.nv
        self.g = np.array(gravity, dtype=float)
        names = [j.name for j in self.model.joints]
        base_q = ["x", "y", "z", "qw", "qx", "qy", "qz"] if floating else []
        base_v = ["wx", "wy", "wz", "vx", "vy", "vz"] if floating else []
        self.writes = {"q": tuple(base_q + names), "v": tuple(base_v + names)}
        # the bodies that can move: mass that cannot is left out of everything
        self.moving = range(0 if floating else 1, len(self.model.bodies))
        # joints on the way from the base to each body
        self.path = [[] for _ in self.model.bodies]
        for j in self.model.joints:
            self.path[j.child] = self.path[j.parent] + [j]

    # motion
    def motion(self, q, v=None, a=None):
        """Forward recursion from the base to the tips."""
        q = np.asarray(q, dtype=float)
        v = np.zeros(self.nv) if v is None else np.asarray(v, dtype=float)
        a = np.zeros(self.nv) if a is None else np.asarray(a, dtype=float)
        s = State(len(self.model.bodies))
        s.R[0] = np.eye(3)
        offset = 0
        if self.floating:
            offset = 1  # q has one entry more than v
            s.p[0] = q[:3]
            s.R[0] = R = quaternion_matrix(*q[3:7])
            s.w[0], s.v[0] = R @ v[:3], R @ v[3:6]
            s.dw[0] = R @ a[:3]
            s.dv[0] = R @ (a[3:6] + np.cross(v[:3], v[3:6]))
        for joint in self.model.joints:
            i, k = joint.parent, joint.child
            qk, vk, ak = q[joint.dof + offset], v[joint.dof], a[joint.dof]
            origin = s.p[i] + s.R[i] @ joint.p
            R = s.R[i] @ joint.R
            z = s.axis[joint.name] = R @ joint.axis
            if joint.kind == "turn":
                s.R[k] = R @ axis_angle(joint.axis, qk)
                s.p[k] = origin
                s.w[k] = s.w[i] + z * vk
                s.dw[k] = s.dw[i] + z * ak + np.cross(s.w[i], z * vk)
            else:
                s.R[k] = R
                s.p[k] = origin + z * qk
                s.w[k] = s.w[i]
                s.dw[k] = s.dw[i]
            r = s.p[k] - s.p[i]
            s.v[k] = s.v[i] + np.cross(s.w[i], r)
            s.dv[k] = s.dv[i] + np.cross(s.dw[i], r) + np.cross(s.w[i], np.cross(s.w[i], r))
            if joint.kind == "slide":
                s.v[k] += z * vk
                s.dv[k] += z * ak + 2.0 * np.cross(s.w[i], z * vk)
        return s

    def place(self, s, frame):
        """Body, rotation and position of a link's frame in the world."""
        i, R, p = self.model.frames[frame]
        return i, s.R[i] @ R, s.p[i] + s.R[i] @ p

    def centre(self, s, i):
        return s.p[i] + s.R[i] @ self.model.bodies[i].com

    def tensor(self, s, i):
        """Inertia about the centre of mass, in world axes."""
        return s.R[i] @ self.model.bodies[i].inertia @ s.R[i].T

    # Jacobians
    def point_jacobian(self, s, i, point):
        """Angular and linear Jacobian (3, nv) of a point on body i, world axes."""
        Jw, Jv = np.zeros((3, self.nv)), np.zeros((3, self.nv))
        if self.floating:
            R = s.R[0]
            Jw[:, :3] = R
            Jv[:, :3] = -skew(point - s.p[0]) @ R
            Jv[:, 3:6] = R
        for joint in self.path[i]:
            z = s.axis[joint.name]
            if joint.kind == "turn":
                Jw[:, joint.dof] = z
                Jv[:, joint.dof] = np.cross(z, point - s.p[joint.child])
            else:
                Jv[:, joint.dof] = z
        return Jw, Jv

    def point_jacobian_rate(self, s, i, point):
        """Time derivative of `point_jacobian` of a point that is fixed on body i."""
        dJw, dJv = np.zeros((3, self.nv)), np.zeros((3, self.nv))
        point_rate = s.v[i] + np.cross(s.w[i], point - s.p[i])
        if self.floating:
            R, dR = s.R[0], skew(s.w[0]) @ s.R[0]
            dJw[:, :3] = dR
            dJv[:, :3] = -skew(point_rate - s.v[0]) @ R - skew(point - s.p[0]) @ dR
            dJv[:, 3:6] = dR
        for joint in self.path[i]:
            z = s.axis[joint.name]
            dz = np.cross(s.w[joint.parent], z)
            if joint.kind == "turn":
                k = joint.child
                dJw[:, joint.dof] = dz
                dJv[:, joint.dof] = np.cross(dz, point - s.p[k]) + np.cross(z, point_rate - s.v[k])
            else:
                dJv[:, joint.dof] = dz
        return dJw, dJv

    # frames
    def fk(self, q, frame):
        _, R, p = self.place(self.motion(q), frame)
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, p
        return T

    def jacobian(self, q, frame):
        s = self.motion(q)
        i, _, p = self.place(s, frame)
        return np.vstack(self.point_jacobian(s, i, p))

    def jacobian_dot(self, q, v, frame):
        s = self.motion(q, v)
        i, _, p = self.place(s, frame)
        return np.vstack(self.point_jacobian_rate(s, i, p))

    def frame_velocity(self, q, v, frame):
        s = self.motion(q, v)
        i, _, p = self.place(s, frame)
        return np.concatenate([s.w[i], s.v[i] + np.cross(s.w[i], p - s.p[i])])

    def frame_acceleration(self, q, v, a, frame):
        s = self.motion(q, v, a)
        i, _, p = self.place(s, frame)
        r = p - s.p[i]
        linear = s.dv[i] + np.cross(s.dw[i], r) + np.cross(s.w[i], np.cross(s.w[i], r))
        return np.concatenate([s.dw[i], linear])

    # forces by recursion
    def newton_euler(self, q, v, a, pushes=()):
        """Joint forces; `pushes` are (body, point, moment, force) in world axes that act on the robot."""
        s = self.motion(q, v, a)
        force, moment = np.zeros_like(s.p), np.zeros_like(s.p)  # on each body, moment about its frame's origin
        for i in self.moving:
            arm = s.R[i] @ self.model.bodies[i].com
            acc = s.dv[i] + np.cross(s.dw[i], arm) + np.cross(s.w[i], np.cross(s.w[i], arm))
            F = self.model.bodies[i].mass * (acc - self.g)
            I = self.tensor(s, i)
            N = I @ s.dw[i] + np.cross(s.w[i], I @ s.w[i])
            force[i] = F
            moment[i] = N + np.cross(arm, F)
        for i, point, n, f in pushes:
            force[i] -= f
            moment[i] -= n + np.cross(point - s.p[i], f)
        tau = np.zeros(self.nv)
        for joint in reversed(self.model.joints):
            i, k = joint.parent, joint.child
            z = s.axis[joint.name]
            tau[joint.dof] = z @ (moment[k] if joint.kind == "turn" else force[k])
            force[i] += force[k]
            moment[i] += moment[k] + np.cross(s.p[k] - s.p[i], force[k])
        if self.floating:
            tau[:3], tau[3:6] = s.R[0].T @ moment[0], s.R[0].T @ force[0]
        return tau

    def rnea(self, q, v, a):
        return self.newton_euler(q, v, a)

    def bias(self, q, v):
        return self.newton_euler(q, v, np.zeros(self.nv))

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        i, _, p = self.place(self.motion(q), frame)
        return self.newton_euler(q, v, a, [(i, p, f_ext[:3], f_ext[3:])])

    # forces by Jacobians
    def gravity(self, q):
        s = self.motion(q)
        tau = np.zeros(self.nv)
        for i in self.moving:
            _, Jv = self.point_jacobian(s, i, self.centre(s, i))
            tau -= Jv.T @ (self.model.bodies[i].mass * self.g)
        return tau

    def crba(self, q):
        s = self.motion(q)
        M = np.zeros((self.nv, self.nv))
        for i in self.moving:
            Jw, Jv = self.point_jacobian(s, i, self.centre(s, i))
            M += self.model.bodies[i].mass * Jv.T @ Jv + Jw.T @ self.tensor(s, i) @ Jw
        return M

    def coriolis(self, q, v):
        """C with C v the velocity forces and dM/dt = C + C^T; for turning bodies see B below."""
        s = self.motion(q, v)
        C = np.zeros((self.nv, self.nv))
        for i in self.moving:
            c = self.centre(s, i)
            Jw, Jv = self.point_jacobian(s, i, c)
            dJw, dJv = self.point_jacobian_rate(s, i, c)
            I, S = self.tensor(s, i), skew(s.w[i])
            B = 0.5 * (S @ I - I @ S - skew(I @ s.w[i]))
            C += self.model.bodies[i].mass * Jv.T @ dJv + Jw.T @ (I @ dJw + B @ Jw)
        return C

    def aba(self, q, v, tau):
        return np.linalg.solve(self.crba(q), np.asarray(tau) - self.bias(q, v))

    def minv(self, q):
        return np.linalg.inv(self.crba(q))

    def aba_f_ext(self, q, v, tau, f_ext, frame):
        J = self.jacobian(q, frame)
        return np.linalg.solve(self.crba(q), np.asarray(tau) + J.T @ f_ext - self.bias(q, v))

    # the whole robot
    def kinetic_energy(self, q, v):
        s = self.motion(q, v)
        energy = 0.0
        for i in self.moving:
            vc = s.v[i] + np.cross(s.w[i], self.centre(s, i) - s.p[i])
            energy += 0.5 * self.model.bodies[i].mass * vc @ vc + 0.5 * s.w[i] @ self.tensor(s, i) @ s.w[i]
        return energy

    def potential_energy(self, q):
        s = self.motion(q)
        return -sum(self.model.bodies[i].mass * self.g @ self.centre(s, i) for i in self.moving)

    def total_mass(self):
        return sum(self.model.bodies[i].mass for i in self.moving)

    def com(self, q):
        s = self.motion(q)
        return sum(self.model.bodies[i].mass * self.centre(s, i) for i in self.moving) / self.total_mass()

    def com_jacobian(self, q):
        s = self.motion(q)
        J = np.zeros((3, self.nv))
        for i in self.moving:
            J += self.model.bodies[i].mass * self.point_jacobian(s, i, self.centre(s, i))[1]
        return J / self.total_mass()

    def centroidal_momentum_matrix(self, q):
        """Rows: angular momentum about the robot's centre of mass, then linear momentum."""
        s = self.motion(q)
        whole = self.com(q)
        A = np.zeros((6, self.nv))
        for i in self.moving:
            c = self.centre(s, i)
            Jw, Jv = self.point_jacobian(s, i, c)
            linear = self.model.bodies[i].mass * Jv
            A[:3] += self.tensor(s, i) @ Jw + np.cross(c - whole, linear, axisb=0, axisc=0)
            A[3:] += linear
        return A
