"""Rigid-body dynamics as a robotics engineer writes it by hand: NumPy, world axes, no spatial algebra.

Torques by recursive Newton-Euler, the mass matrix from the bodies' Jacobians, the Coriolis matrix from Christoffel's
symbols.  A mistake is switched on by its name in `mistakes`.
"""

from types import SimpleNamespace

import numpy as np

from tests.crosscheck.unseen.worldframe_reading import Reader, cross_matrix, turn

GRAVITY = np.array([0.0, 0.0, -9.81])


class Code:
    """A robot of revolute, continuous and prismatic joints, on a fixed or floating base."""

    name, version = "worldframe", "1"
    mistakes = frozenset()

    def __init__(self, urdf, floating=False):
        self.floating = floating
        self.bodies, self.frames = Reader(urdf, self.mistakes).read(floating)
        moving = [b for b in self.bodies if b.parent >= 0]
        q, v = [b.name for b in moving], [b.name for b in moving]
        if "joints_sorted_by_name" in self.mistakes:
            moving = sorted(moving, key=lambda b: b.name)
        self.base = 6 if floating else 0
        for k, b in enumerate(moving):
            b.columns = [self.base + k]
        if floating:
            self.bodies[0].columns = list(range(6))
            q = ["x", "y", "z", "qw", "qx", "qy", "qz", *q]
            v = ["wx", "wy", "wz", "vx", "vy", "vz", *v]
        self.nv = len(v)
        self.writes = {"q": q, "v": v}
        self.path = {i: [] for i in range(len(self.bodies))}  # the moving bodies from the base to each body
        for i, b in enumerate(self.bodies):
            self.path[i] = [*(self.path[b.parent] if b.parent >= 0 else []), *([i] if b.columns else [])]
        first = 0 if floating else 1  # the fixed root counts nowhere
        self.counted = range(first, len(self.bodies))

    # --- kinematics ------------------------------------------------------------------------------

    def positions(self, q):
        """Rotation R, origin p, joint axis z, arm and centre c of every body, in the world."""
        s = SimpleNamespace(R=[], p=[], z=[], c=[])
        for i, b in enumerate(self.bodies):
            R, p, z = np.eye(3), np.zeros(3), np.zeros(3)
            if b.kind == "floats":
                p = np.array(q[:3], dtype=float)
                w, x, y, zz = q[3:7]
                if "base_quaternion_xyzw" in self.mistakes:
                    x, y, zz, w = q[3:7]
                K = cross_matrix([x, y, zz])
                R = np.eye(3) + 2.0 * w * K + 2.0 * K @ K
            elif b.parent >= 0:
                angle = q[b.columns[0] + (1 if self.floating else 0)]
                Rp, pp, place = s.R[b.parent], s.p[b.parent], b.placement
                R, p = Rp @ place[:3, :3], pp + Rp @ place[:3, 3]
                z = R @ b.axis
                if b.kind == "turns":
                    length = np.linalg.norm(b.axis)
                    R = R @ turn(b.axis / length, angle * length)
                elif b.kind == "slides":
                    p = p + (Rp @ b.axis if "slides_in_parent_axes" in self.mistakes else z) * angle
                else:
                    z = np.zeros(3)
            s.R.append(R), s.p.append(p), s.z.append(z), s.c.append(p + R @ b.com)
        return s

    def motion(self, s, v, a, base_acceleration=(0.0, 0.0, 0.0)):
        """Angular velocity w and acceleration wd, and those of the origin, u and ud, of every body."""
        s.w, s.u, s.wd, s.ud = [], [], [], []
        for i, b in enumerate(self.bodies):
            if b.parent < 0:
                w, u, wd, ud = np.zeros(3), np.zeros(3), np.zeros(3), np.array(base_acceleration, dtype=float)
                if b.kind == "floats":
                    R = s.R[0]
                    w, u, wd = R @ v[:3], R @ v[3:6], R @ a[:3]
                    if "base_velocity_in_world_axes" in self.mistakes:
                        u = np.array(v[3:6], dtype=float)
                    ud = ud + R @ a[3:6] + np.cross(w, u)
                    if "base_acceleration_of_point" in self.mistakes:
                        ud = ud - np.cross(w, u)
            else:
                w, u, wd, ud = s.w[b.parent], s.u[b.parent], s.wd[b.parent], s.ud[b.parent]
                r, z, k = s.p[i] - s.p[b.parent], s.z[i], b.columns[0]
                u = u + np.cross(w, r)
                if "no_tangential_acceleration" not in self.mistakes:
                    ud = ud + np.cross(wd, r)
                ud = ud + np.cross(w, np.cross(w, r))
                if b.kind == "turns":
                    wd = wd + z * a[k] + np.cross(w, z * v[k])
                    w = w + z * v[k]
                elif b.kind == "slides":
                    ud = ud + z * a[k]
                    if "no_coriolis_of_slide" not in self.mistakes:
                        ud = ud + 2.0 * np.cross(w, z * v[k])
                    u = u + z * v[k]
            s.w.append(w), s.u.append(u), s.wd.append(wd), s.ud.append(ud)
        return s

    def columns(self, s, i, point):
        """Jacobians of body i's angular velocity and of the velocity of a point fixed to it."""
        Jw, Jv = np.zeros((3, self.nv)), np.zeros((3, self.nv))
        path = self.path[i]
        if "jacobian_of_all_joints" in self.mistakes:
            path = [j for j, b in enumerate(self.bodies) if b.columns]
        for j in path:
            b = self.bodies[j]
            if b.kind == "floats":
                Jw[:, :3] = s.R[0]
                Jv[:, :3] = -cross_matrix(point - s.p[0]) @ s.R[0]
                Jv[:, 3:6] = s.R[0]
                continue
            k, z = b.columns[0], s.z[j]
            if b.kind == "turns":
                Jw[:, k] = z
                arm = point - (s.p[b.parent] if "jacobian_arm_of_parent" in self.mistakes else s.p[j])
                Jv[:, k] = np.cross(arm, z) if "jacobian_cross_reversed" in self.mistakes else np.cross(z, arm)
            elif b.kind == "slides":
                Jv[:, k] = z
                if "jacobian_slide_turns" in self.mistakes:
                    Jw[:, k] = z
        return Jw, Jv

    def place(self, s, frame):
        """Body, rotation and origin of a link."""
        i, T = self.frames[frame]
        return i, s.R[i] @ T[:3, :3], s.p[i] + s.R[i] @ T[:3, 3]

    def fk(self, q, frame):
        s = self.positions(q)
        i, R, p = self.place(s, frame)
        if "fk_inverse" in self.mistakes:
            R, p = R.T, -R.T @ p
        if "fk_of_joint" in self.mistakes:
            R, p = s.R[i], s.p[i]
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, p
        return T

    def jacobian(self, q, frame):
        s = self.positions(q)
        i, R, p = self.place(s, frame)
        Jw, Jv = self.columns(s, i, p)
        if "jacobian_in_frame_axes" in self.mistakes:
            Jw, Jv = R.T @ Jw, R.T @ Jv
        if "jacobian_rows_linear_first" in self.mistakes:
            Jw, Jv = Jv, Jw
        return np.vstack([Jw, Jv])

    def jacobian_dot(self, q, v, frame):
        s = self.motion(self.positions(q), v, np.zeros(self.nv))
        i, _, p = self.place(s, frame)
        if "jdot_forward_difference" in self.mistakes and not self.floating:
            step = 1e-4
            return (self.jacobian(q + step * v, frame) - self.jacobian(q, frame)) / step
        u = s.u[i] + np.cross(s.w[i], p - s.p[i])
        Jd = np.zeros((6, self.nv))
        for j in self.path[i]:
            b = self.bodies[j]
            axes = s.R[0] if b.kind == "floats" else s.z[j][:, None]
            for n, z in enumerate(axes.T):
                k = b.columns[n]
                zd = np.cross(s.w[j], z)
                if b.kind != "slides":
                    Jd[:3, k] = zd
                    Jd[3:, k] = np.cross(zd, p - s.p[j])
                    if "jdot_of_axes_only" not in self.mistakes:
                        Jd[3:, k] += np.cross(z, (u if "jdot_velocity_not_relative" in self.mistakes else u - s.u[j]))
                if b.kind in ("slides", "floats"):
                    Jd[3:, k if b.kind == "slides" else 3 + n] = zd
        return Jd

    def frame_velocity(self, q, v, frame):
        s = self.motion(self.positions(q), v, np.zeros(self.nv))
        i, _, p = self.place(s, frame)
        return np.concatenate([s.w[i], s.u[i] + np.cross(s.w[i], p - s.p[i])])

    def frame_acceleration(self, q, v, a, frame):
        if "acceleration_without_jdot" in self.mistakes:
            return self.jacobian(q, frame) @ a
        s = self.motion(self.positions(q), v, a)
        i, _, p = self.place(s, frame)
        w, wd, r = s.w[i], s.wd[i], p - s.p[i]
        return np.concatenate([wd, s.ud[i] + np.cross(wd, r) + np.cross(w, np.cross(w, r))])

    # --- forces ----------------------------------------------------------------------------------

    def rnea(self, q, v, a):
        up = GRAVITY if "rnea_gravity_upwards" in self.mistakes else -GRAVITY
        s = self.motion(self.positions(q), v, a, up)
        F, N = [np.zeros(3) for _ in self.bodies], [np.zeros(3) for _ in self.bodies]
        tau = np.zeros(self.nv)
        for i in reversed(self.counted):
            b, R = self.bodies[i], s.R[i]
            w, wd, r = s.w[i], s.wd[i], s.c[i] - s.p[i]
            I = b.inertia if "euler_in_body_inertia" in self.mistakes else R @ b.inertia @ R.T
            cdd = s.ud[i] + np.cross(wd, r)
            if "com_without_centripetal" not in self.mistakes:
                cdd = cdd + np.cross(w, np.cross(w, r))
            force, moment = b.mass * cdd, I @ wd
            if "no_gyroscopic_moment" not in self.mistakes:
                moment = moment + np.cross(w, I @ w)
            if "force_arm_in_body_axes" in self.mistakes:
                r = b.com
            F[i] = F[i] + force
            N[i] = N[i] + moment + np.cross(r, force)
            if b.kind == "turns":
                axis = R[:, 2] if "torque_about_z" in self.mistakes else s.z[i]
                tau[b.columns[0]] = axis @ N[i]
            elif b.kind == "slides":
                tau[b.columns[0]] = s.z[i] @ (N[i] if "slide_takes_moment" in self.mistakes else F[i])
            elif b.kind == "floats":
                tau[:6] = np.concatenate([R.T @ N[i], R.T @ F[i]])
                if "base_wrench_in_world_axes" in self.mistakes:
                    tau[:6] = np.concatenate([N[i], F[i]])
            if b.parent >= 0:
                carried = np.cross(s.p[i] - s.p[b.parent], F[i])
                if "child_force_without_arm" in self.mistakes:
                    carried = np.zeros(3)
                if "branches_overwrite" in self.mistakes:
                    F[b.parent], N[b.parent] = F[i], N[i] + carried
                else:
                    F[b.parent], N[b.parent] = F[b.parent] + F[i], N[b.parent] + N[i] + carried
        if "coulomb_friction_added" in self.mistakes:
            tau[self.base :] += 0.1 * np.sign(v[self.base :])
        if "gravity_twice" in self.mistakes:
            tau = tau + self.gravity(q)
        return tau

    def bias(self, q, v):
        return self.rnea(q, v, np.zeros(self.nv))

    def gravity(self, q):
        """The gradient of the potential energy."""
        s, g = self.positions(q), np.zeros(self.nv)
        for i in self.counted:
            Jv = self.columns(s, i, s.c[i])[1]
            share = -self.bodies[i].mass * (Jv.T @ GRAVITY)
            if "gravity_of_own_link_only" in self.mistakes:
                share = np.array([share[k] if k in self.bodies[i].columns else 0.0 for k in range(self.nv)])
            g = g + share
        if "gravity_not_on_slides" in self.mistakes:
            g[[b.columns[0] for b in self.bodies if b.kind == "slides"]] = 0.0
        return g

    def rnea_f_ext(self, q, v, a, f_ext, frame):
        """Under a wrench [n; f] on a link, at its origin, in world axes."""
        tau = self.jacobian(q, frame).T @ f_ext
        if "external_force_sign" in self.mistakes:
            tau = -tau
        return self.rnea(q, v, a) - tau

    # --- matrices --------------------------------------------------------------------------------

    def crba(self, q):
        s, M = self.positions(q), np.zeros((self.nv, self.nv))
        counted = self.counted[:-1] if "mass_matrix_lacks_last_body" in self.mistakes else self.counted
        for i in counted:
            b, R = self.bodies[i], s.R[i]
            Jw, Jv = self.columns(s, i, s.p[i] if "mass_matrix_at_link_origin" in self.mistakes else s.c[i])
            M = M + b.mass * Jv.T @ Jv
            if "mass_matrix_of_points" not in self.mistakes:
                M = M + Jw.T @ R @ b.inertia @ R.T @ Jw
        if "motor_inertia_added" in self.mistakes:
            M[self.base :, self.base :] += 0.05 * np.eye(self.nv - self.base)
        return np.triu(M) if "mass_matrix_upper_only" in self.mistakes else M

    def mass_matrix_gradient(self, q):
        """dM/dq, its last index that of the derivative; M does not depend on the pose of the base."""
        s, D = self.positions(q), np.zeros((self.nv, self.nv, self.nv))
        for i in self.counted:
            b, R = self.bodies[i], s.R[i]
            I = R @ b.inertia @ R.T
            Jw, Jv = self.columns(s, i, s.c[i])
            owner = {k: j for j in self.path[i] for k in self.bodies[j].columns}
            for k in owner:
                if k < self.base:
                    continue
                dw, dv = np.zeros_like(Jw), np.zeros_like(Jv)
                for j in owner:
                    if owner[j] >= owner[k]:  # the axis of j turns with joint k
                        dw[:, j], dv[:, j] = np.cross(Jw[:, k], Jw[:, j]), np.cross(Jw[:, k], Jv[:, j])
                    else:
                        dv[:, j] = np.cross(Jw[:, j], Jv[:, k])
                W = cross_matrix(Jw[:, k])
                dI = np.zeros((3, 3)) if "tensor_rate_forgotten" in self.mistakes else W @ I - I @ W
                half = b.mass * dv.T @ Jv + dw.T @ I @ Jw
                D[:, :, k] += half + half.T + Jw.T @ dI @ Jw
        return D

    def coriolis(self, q, v):
        """C of Christoffel's symbols; of a floating base with the structure constants of its velocities."""
        if "coriolis_forward_difference" in self.mistakes and not self.floating:
            step, M = 1e-6, self.crba(q)
            D = np.stack([(self.crba(q + step * e) - M) / step for e in np.eye(self.nv)], axis=-1)
        else:
            D = self.mass_matrix_gradient(q)
        if "coriolis_other_split" in self.mistakes and not self.floating:
            return D @ v - 0.5 * np.einsum("jki,k->ij", D, v)
        if "coriolis_index_slip" in self.mistakes:
            return 0.5 * (np.einsum("ijk,j->ij", D, v) + np.einsum("ikj,j->ij", D, v) - np.einsum("jki,j->ij", D, v))
        last = -1.0 if "coriolis_last_symbol_added" in self.mistakes else 1.0
        C = D @ v + np.einsum("ikj,k->ij", D, v) - last * np.einsum("jki,k->ij", D, v)
        if self.floating:
            C = C + self.quasi(self.crba(q), v)
        return C if "coriolis_without_half" in self.mistakes else 0.5 * C

    def quasi(self, M, v):
        """The brackets [e_k, e_j] of the base's body twists in Koszul's formula."""
        c = np.zeros((self.nv, self.nv, self.nv))  # [e_k, e_j] = c[:, k, j]
        for k in range(3):
            for j in range(3):
                c[:3, k, j] = c[3:6, k, 3 + j] = np.cross(np.eye(3)[k], np.eye(3)[j])
                c[3:6, 3 + k, j] = c[3:6, k, 3 + j]
        first = np.einsum("lkj,li->ikj", c, M)
        return (first - np.einsum("lki,lj->ikj", c, M) - np.einsum("lji,lk->ikj", c, M)).transpose(0, 2, 1) @ v

    def aba(self, q, v, tau):
        M, h = self.crba(q), self.bias(q, v)
        if "aba_without_coriolis" in self.mistakes:
            h = self.gravity(q)
        if "aba_damped_inverse" in self.mistakes:
            M = M + 1e-4 * np.eye(self.nv)
        if "aba_diagonal" in self.mistakes:
            return (tau - h) / np.diag(M)
        return np.linalg.solve(M, tau - h)

    def minv(self, q):
        return np.linalg.inv(self.crba(q))

    # --- the whole robot -------------------------------------------------------------------------

    @property
    def mass(self):
        return sum(self.bodies[i].mass for i in self.counted)

    def com(self, q):
        s = self.positions(q)
        if "com_mean_of_links" in self.mistakes:
            return np.mean([s.c[i] for i in self.counted], axis=0)
        if "com_of_link_origins" in self.mistakes:
            return sum(self.bodies[i].mass * s.p[i] for i in self.counted) / self.mass
        total = self.mass
        if "com_divides_by_mass_with_base" in self.mistakes:
            total = sum(b.mass for b in self.bodies)
        return sum(self.bodies[i].mass * s.c[i] for i in self.counted) / total

    def com_jacobian(self, q):
        s = self.positions(q)
        J = sum(self.bodies[i].mass * self.columns(s, i, s.c[i])[1] for i in self.counted)
        return J if "com_jacobian_not_divided" in self.mistakes else J / self.mass

    def centroidal_momentum_matrix(self, q):
        s, A = self.positions(q), np.zeros((6, self.nv))
        center = np.zeros(3) if "momentum_about_world" in self.mistakes else self.com(q)
        for i in self.counted:
            b, R = self.bodies[i], s.R[i]
            Jw, Jv = self.columns(s, i, s.c[i])
            A[3:] += b.mass * Jv
            A[:3] += b.mass * cross_matrix(s.c[i] - center) @ Jv
            if "momentum_without_spin" not in self.mistakes:
                A[:3] += R @ b.inertia @ R.T @ Jw
        return A

    def kinetic_energy(self, q, v):
        s, E = self.motion(self.positions(q), v, np.zeros(self.nv)), 0.0
        for i in self.counted:
            b, R, w = self.bodies[i], s.R[i], s.w[i]
            u = s.u[i] + np.cross(w, s.c[i] - s.p[i])
            wb = w if "energy_in_world_axes" in self.mistakes else R.T @ w
            E += b.mass * u @ u + wb @ b.inertia @ wb
        return E if "energy_without_half" in self.mistakes else 0.5 * E

    def potential_energy(self, q):
        s = self.positions(q)
        at = s.p if "potential_of_link_origins" in self.mistakes else s.c
        return -sum(self.bodies[i].mass * (GRAVITY @ at[i]) for i in self.counted)
