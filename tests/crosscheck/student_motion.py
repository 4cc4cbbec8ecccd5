"""A student's kinematics and dynamics: poses as 4x4 matrices, velocities and accelerations in the world frame."""

from __future__ import annotations

import numpy as np

from tests.crosscheck.student_reading import Link, Reading, cross, of_quaternion, rotation_about, rz


class Motion(Reading):
    """What moves how, and the forces that it takes."""

    # --- kinematics -------------------------------------------------------------------------------

    def _q(self, q):
        q = np.array(q)
        if self.has("degrees"):
            for j in self.moving:
                k = j.column + (1 if self.floating else 0)
                if j.kind != "prismatic":
                    q[k] = q[k] * np.pi / 180
        if self.has("millimetres"):
            for j in self.moving:
                if j.kind == "prismatic":
                    q[j.column + (1 if self.floating else 0)] /= 1000
        if self.has("float32_states"):
            q = q.astype(np.float32).astype(float)
        if self.has("mimic"):
            at = {j.name: j.column + (1 if self.floating else 0) for j in self.moving}
            for j in self.moving:
                if j.mimic is not None:
                    q[at[j.name]] = j.mimic[1] * q[at[j.mimic[0]]] + j.mimic[2]
        return q

    def poses(self, q):
        """(R, p) of every link, and (axis, point) of every joint, in the world."""
        q = self._q(q)
        R, p = np.eye(3, dtype=q.dtype), np.zeros(3, dtype=q.dtype)
        if self.floating:
            w, x, y, z = q[3:7]
            if self.has("quaternion_xyzw"):
                x, y, z, w = q[3:7]
            R, p = of_quaternion(w, x, y, z), q[:3]
            if self.has("base_turn_inverted"):
                R = R.T
            if self.has("base_pose_ignored"):
                R, p = np.eye(3), np.zeros(3)
        if self.has("base_offset"):
            R, p = rz(0.3) @ R, rz(0.3) @ p + [0.1, 0.2, 0.3]
        links, axes = {self.base: (R, p)}, {}
        for j in self.joints:
            R, p = links[j.parent]
            at, R0 = p + R @ j.p, R @ j.R
            if j.kind == "fixed":
                links[j.child] = R0, at
                continue
            x = q[j.column + (1 if self.floating else 0)]
            if self.has("motion_first"):
                M = rotation_about(j.axis, x) if j.kind != "prismatic" else np.eye(3)
                s = j.axis * x if j.kind == "prismatic" else 0 * j.axis
                axes[j.name] = R @ j.axis, p
                links[j.child] = R @ M @ j.R, p + R @ (s + M @ j.p)
                continue
            z = R0 @ j.axis
            axes[j.name] = z, at
            links[j.child] = (R0, at + z * x) if j.kind == "prismatic" else (R0 @ rotation_about(j.axis, x), at)
        return links, axes

    def _chain(self, link):
        by_child = {j.child: j for j in self.joints}
        while link in by_child:
            yield by_child[link]
            link = by_child[link].parent

    def point_jacobian(self, links, axes, link, point):
        """Jv, Jw of a point of a link, in the world frame."""
        Jv, Jw = np.zeros((3, self.nv), point.dtype), np.zeros((3, self.nv), point.dtype)
        if self.floating:
            R, p = links[self.base]
            Jw[:, :3], Jv[:, 3:6] = R, R
            for k in range(3):
                Jv[:, k] = cross(R[:, k], point - p)
        for j in self._chain(link):
            if j.kind == "fixed":
                continue
            z, at = axes[j.name]
            if j.kind == "prismatic":
                Jv[:, j.column] = z
            else:
                Jw[:, j.column], Jv[:, j.column] = z, cross(z, point - at)
        return Jv, Jw

    # --- dynamics: velocities and accelerations from joint to joint -------------------------------

    def motions(self, q, v, a):
        """w, alpha, a of every link's origin in the world."""
        links, axes = self.poses(q)
        zero = np.zeros(3)
        w, al, ac = {self.base: zero}, {self.base: zero}, {self.base: zero}
        if self.floating:
            R, _ = links[self.base]
            w[self.base], al[self.base] = R @ v[:3], R @ a[:3]
            ac[self.base] = R @ (a[3:6] + np.cross(v[:3], v[3:6]))
        for j in self.joints:
            p, c = j.parent, j.child
            r = links[c][1] - links[p][1]
            if self.has("motion_first") and j.kind in ("revolute", "continuous"):
                # the child's origin moves with the joint itself
                z, xd, xdd = axes[j.name][0], v[j.column], a[j.column]
                w[c], al[c] = w[p] + z * xd, al[p] + z * xdd + np.cross(w[p], z * xd)
                ac[c] = ac[p] + np.cross(al[c], r) + np.cross(w[c], np.cross(w[c], r))
                continue
            tangential = 0 if self.has("no_tangential") else np.cross(al[p], r)
            centripetal = 0 if self.has("no_centripetal", "no_centripetal_link") else np.cross(w[p], np.cross(w[p], r))
            ac[c], w[c], al[c] = ac[p] + tangential + centripetal, w[p], al[p]
            if j.kind == "fixed":
                continue
            z, xd, xdd = axes[j.name][0], v[j.column], a[j.column]
            if j.kind == "prismatic":
                times = 0 if self.has("no_slide_coriolis") else 1 if self.has("half_slide_coriolis") else 2
                ac[c] = ac[c] + z * xdd + times * np.cross(w[p], z * xd)
            else:
                rate = 0 if self.has("no_axis_rate") else np.cross(w[p], z * xd)
                w[c], al[c] = w[p] + z * xd, al[p] + z * xdd + rate
        return links, axes, w, al, ac

    def world_inertia(self, k: Link, R):
        J = k.R @ k.I @ k.R.T
        if self.has("inertia_not_turned"):
            return J
        return R.T @ J @ R if self.has("inertia_turned_back") else R @ J @ R.T

    def inverse_dynamics(self, q, v, a, g):
        links, axes, w, al, ac = self.motions(q, v, a)
        tau = np.zeros(self.nv)
        for k in self.links.values():
            if k.mass == 0 or (k.name == self.base and not self.floating):
                continue
            R, p = links[k.name]
            r = R @ k.com
            a_c = ac[k.name] + np.cross(al[k.name], r)
            if not self.has("no_centripetal", "no_centripetal_com"):
                a_c = a_c + np.cross(w[k.name], np.cross(w[k.name], r))
            I = self.world_inertia(k, R)
            spin = np.cross(w[k.name], I @ w[k.name])
            spin = 0 * spin if self.has("no_gyroscopic") else -spin if self.has("gyroscopic_sign") else spin
            at = p if self.has("no_moment_arm") else p + r
            Jv, Jw = self.point_jacobian(links, axes, k.name, at)
            low = self.point_jacobian(links, axes, k.name, p)[0] if self.has("gravity_at_origin") else Jv
            down = links[self.base][0] @ g if self.has("gravity_in_base") else g
            tau += Jv.T @ (k.mass * a_c) - low.T @ (k.mass * down) + Jw.T @ (I @ al[k.name] + spin)
        return tau

    def mass_matrix(self, q):
        """Sum of m Jv^T Jv + Jw^T I Jw; over complex numbers too."""
        links, axes = self.poses(q)
        M = np.zeros((self.nv, self.nv), np.asarray(q).dtype)
        for k in self.links.values():
            if k.mass == 0 or (k.name == self.base and not self.floating):
                continue
            R, p = links[k.name]
            at = p if self.has("no_moment_arm") else p + R @ k.com
            Jv, Jw = self.point_jacobian(links, axes, k.name, at)
            M = M + k.mass * Jv.T @ Jv + Jw.T @ self.world_inertia(k, R) @ Jw
        return M

    def extra(self, v, a):
        """Forces at the joints besides."""
        out = np.zeros(self.nv)
        for j in self.moving:
            x = v[j.column]
            if self.has("damping"):
                out[j.column] += j.damping * x
            if self.has("damping_sign"):
                out[j.column] -= j.damping * x
            if self.has("friction"):
                out[j.column] += j.friction * np.sign(x)
            if self.has("friction_as_damping"):
                out[j.column] += j.friction * x
            if self.has("viscous"):
                out[j.column] += 0.37 * x
            if self.has("rotor"):
                out[j.column] += (0.11 + 0.01 * j.column) * a[j.column]
        return out

    def _v(self, v):
        if not self.floating:
            return np.array(v, float)
        v = np.array(v, float)
        if self.has("base_linear_first"):
            v[:6] = np.r_[v[3:6], v[:3]]
        return v

    def _seen(self, q, v, a=None):
        """Velocities and accelerations as this code takes them, in its own body columns."""
        v, a = self._v(v), None if a is None else self._v(a)
        R, p = self.poses(q)[0][self.base]
        G, D = np.eye(self.nv), np.zeros((self.nv, self.nv))
        S = lambda u: np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])  # noqa: E731
        if self.has("angular_world"):
            G[:3, :3] = R
        if self.has("linear_world"):
            G[3:6, 3:6] = R
        if self.has("linear_origin"):
            G[3:6, 3:6], G[3:6, :3] = R, S(p) @ R
        w = np.linalg.solve(G, v)
        if self.has("angular_world"):
            D[:3, :3] = R @ S(w[:3])
        if self.has("linear_world"):
            D[3:6, 3:6] = R @ S(w[:3])
        if self.has("linear_origin"):
            D[3:6, 3:6], D[3:6, :3] = R @ S(w[:3]), S(p) @ R @ S(w[:3]) + S(R @ w[3:6]) @ R
        return G, D, w, None if a is None else np.linalg.solve(G, a - D @ w)

    def _turns(self) -> bool:
        return self.floating and self.has("angular_world", "linear_world", "linear_origin", "base_linear_first")

    def _out(self, x):
        """Forces or columns of the base in this code's order."""
        if self.floating and self.has("base_linear_first"):
            x = np.array(x)
            x[..., :6] = np.concatenate([x[..., 3:6], x[..., :3]], -1)
        return x
