"""A user's dynamics code, right until a mistake is switched on.

Written as a student would, and of another kind than dualpin: the file by ElementTree (`student_reading`), every link
by itself, poses as 4x4 matrices, velocities and accelerations in the world frame from joint to joint
(`student_motion`), forces through Jacobians, C from Christoffel's symbols by complex steps.  `planted.MISTAKES` says
what can go wrong, and which keys name it rightly.
"""

from __future__ import annotations

import numpy as np

from tests.crosscheck.student_motion import Motion


class Student(Motion):
    """What the code offers to others, in its own conventions."""

    name, version = "student", "1"

    def fk(self, q, frame):
        R, p = self.poses(q)[0][frame]
        if self.has("seen_from_base"):
            R0, p0 = self.poses(q)[0][self.base]
            R, p = R0.T @ R, R0.T @ (p - p0)
        if self.has("tool_offset"):
            p = p + R @ [0, 0, 0.1]
        if self.has("fk_at_com"):
            p, R = p + R @ self.links[frame].com, R @ self.links[frame].R
        if self.has("fk_rotation_transposed"):
            R = R.T
        if self.has("fk_rotation_missing"):
            R = np.eye(3)
        H = np.eye(4)
        H[:3, :3], H[:3, 3] = R, p
        H = np.linalg.inv(H) if self.has("fk_inverse") else H
        return H.astype(np.float32).astype(float) if self.has("float32_answers") else H

    def jacobian(self, q, frame):
        links, axes = self.poses(q)
        R, p = links[frame]
        at = np.zeros(3) if self.has("jacobian_world") else p
        if self.has("jacobian_at_com"):
            at = p + R @ self.links[frame].com
        Jv, Jw = self.point_jacobian(links, axes, frame, at)
        if self.has("jacobian_local"):
            Jv, Jw = R.T @ Jv, R.T @ Jw
        if self.has("jacobian_linear_sign"):
            Jv = -Jv
        J = np.vstack([Jv, Jw] if self.has("rows_linear_first") else [Jw, Jv])
        return self._columns(q, J)

    def _columns(self, q, J):
        if self._turns():
            J = J @ np.linalg.inv(self._seen(q, np.zeros(self.nv))[0])
        return self._out(J)

    def gravity(self, q):
        zero = np.zeros(self.nv)
        tau = self.inverse_dynamics(q, zero, zero, self.g)
        if self.has("history"):
            self.asked += 1
            tau = tau + 1e-3 * self.asked
        return self._forces(q, tau)

    def _forces(self, q, tau):
        if self._turns():
            tau = np.linalg.solve(self._seen(q, np.zeros(self.nv))[0].T, tau)
        tau = self._out(tau)
        if self.has("torque_sign"):
            tau = -tau
        if self.has("one_torque_sign"):
            tau = np.array(tau)
            tau[self.nb + 1] *= -1
        if self.has("newton_millimetres"):
            tau = 1000 * tau
        return tau.astype(np.float32).astype(float) if self.has("float32_answers") else tau

    def rnea(self, q, v, a):
        if self.has("a_ignored"):
            a = 0 * a
        if self.has("v_ignored"):
            v = 0 * v
        if self._turns():
            _, _, v, a = self._seen(q, v, a)
        g0 = self.inverse_dynamics(q, np.zeros(self.nv), np.zeros(self.nv), self.g)
        tau = self.inverse_dynamics(q, v, a, self.g)
        if self.has("coriolis_half", "coriolis_twice"):
            h = self.inverse_dynamics(q, v, 0 * a, self.g) - g0
            tau = tau + (1.0 if self.has("coriolis_twice") else -0.5) * h
        return self._forces(q, tau + self.extra(v, a))

    def bias(self, q, v):
        g = 0 * self.g if self.has("bias_without_gravity") else self.g
        zero = np.zeros(self.nv)
        if self.has("v_ignored"):
            v = 0 * v
        a = zero
        if self._turns():
            _, _, v, a = self._seen(q, v, zero)
        tau = self.inverse_dynamics(q, v, a, g)
        if self.has("coriolis_half", "coriolis_twice"):
            h = self.inverse_dynamics(q, v, zero, g) - self.inverse_dynamics(q, zero, zero, g)
            tau = tau + (1.0 if self.has("coriolis_twice") else -0.5) * h
        return self._forces(q, tau + self.extra(v, zero))

    def crba(self, q):
        M = self.mass_matrix(q)
        if self.has("rotor"):
            for j in self.moving:
                M[j.column, j.column] += 0.11 + 0.01 * j.column
        if self._turns():
            H = np.linalg.inv(self._seen(q, np.zeros(self.nv))[0])
            M = H.T @ M @ H
        M = self._out(self._out(M).T).T
        if self.has("crba_constant"):
            M[self.nb, self.nb + 1] += 0.05
            M[self.nb + 1, self.nb] += 0.05
        if self.has("crba_upper"):
            M = np.triu(M)
        if self.has("crba_lower"):
            M = np.tril(M)
        return np.diag(np.diag(M)) if self.has("crba_diagonal") else M

    def aba(self, q, v, tau):
        zero = np.zeros(self.nv)
        if self._turns():
            G, D, w, _ = self._seen(q, v)
            tau = G.T @ self._out(tau)
        else:
            w = np.array(v, float)
        if self.has("v_ignored"):
            w = 0 * w
        M = self.mass_matrix(q) + (np.diag(self.extra(zero, np.ones(self.nv))) if self.has("rotor") else 0)
        h = self.inverse_dynamics(q, w, zero, self.g) + self.extra(w, zero)
        if self.has("aba_without_bias"):
            h = 0 * h
        if self.has("aba_bias_sign"):
            h = -h
        a = np.linalg.solve(M, tau - h)
        if self._turns():
            a = self._out(G @ a + D @ w)
        return a

    def com(self, q):
        return self._com(q, self.has("com_of_origins"), not self.has("com_not_divided"))

    def _com(self, q, of_origins=False, divided=True):
        links, _ = self.poses(q)
        total, moment = 0.0, np.zeros(3)
        for k in self.links.values():
            if self._counts(k.name):
                R, p = links[k.name]
                total, moment = total + k.mass, moment + k.mass * (p if of_origins else p + R @ k.com)
        return moment / total if divided else moment

    def _counts(self, link):
        if self.has("base_counts") or self.floating:
            return True
        return any(j.kind != "fixed" for j in self._chain(link))

    def centroidal_momentum_matrix(self, q):
        links, axes = self.poses(q)
        c = np.zeros(3) if self.has("momentum_about_origin") else self._com(q)
        A = np.zeros((6, self.nv))
        for k in self.links.values():
            if k.mass and self._counts(k.name):
                R, p = links[k.name]
                Jv, Jw = self.point_jacobian(links, axes, k.name, p + R @ k.com)
                A[3:] += k.mass * Jv
                A[:3] += self.world_inertia(k, R) @ Jw + k.mass * np.cross((p + R @ k.com - c)[None], Jv.T).T
        A = A[[3, 4, 5, 0, 1, 2]] if self.has("rows_linear_first") else A
        return self._columns(q, A)

    def kinetic_energy(self, q, v):
        if self._turns():
            v = self._seen(q, v)[2]
        return (1.0 if self.has("energy_without_half") else 0.5) * v @ self.mass_matrix(q) @ v

    def coriolis(self, q, v):
        if self.floating or self.has("degrees", "float32_states", "millimetres"):
            raise NotImplementedError("by complex steps in q as it is given, for fixed bases only")
        n, h = self.nv, 1e-30
        dM = [np.imag(self.mass_matrix(np.array(q, complex) + 1j * h * e)) / h for e in np.eye(n)]
        rate = sum(d * x for d, x in zip(dM, v, strict=True))
        by_q = np.stack([d @ v for d in dM], axis=1)  # d(M v)/dq
        C = 0.5 * (rate + by_q - by_q.T)
        if self.has("coriolis_rate"):
            C = rate
        if self.has("coriolis_other"):
            C = rate - 0.5 * by_q.T
        return C.T if self.has("coriolis_transposed") else C

    def jacobian_dot(self, q, v, frame):
        if self.floating or self.has("degrees", "float32_states", "millimetres"):
            raise NotImplementedError("by complex steps in q as it is given, for fixed bases only")
        if self.has("jdot_zero"):
            return np.zeros((6, self.nv))
        h = 1e-30
        links, axes = self.poses(np.array(q, complex) + 1j * h * np.array(v))
        R, p = links[frame]
        at = np.zeros(3, complex) if self.has("jacobian_world") else p
        Jv, Jw = self.point_jacobian(links, axes, frame, at)
        if self.has("jacobian_local"):
            Jv, Jw = R.T @ Jv, R.T @ Jw
        J = np.vstack([Jv, Jw] if self.has("rows_linear_first") else [Jw, Jv])
        return np.imag(J) / h
