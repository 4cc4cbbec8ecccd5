"""A user's dynamics code, right until a mistake is switched on.

Written as a student would, and of another kind than dualpin: the file by ElementTree, every link by itself, poses
as 4x4 matrices, velocities and accelerations in the world frame from joint to joint, forces through
Jacobians, C from Christoffel's symbols by complex steps.  `MISTAKES` says what can go wrong, and which
keys name it rightly.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import numpy as np

PRODUCTS = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}


def rx(a):
    return np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])


def ry(a):
    return np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])


def rz(a):
    return np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])


def rotation_about(u, a):
    K = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    return np.eye(3) + np.sin(a) * K + (1 - np.cos(a)) * K @ K


def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def of_quaternion(w, x, y, z):
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


@dataclass
class Link:
    name: str
    mass: float = 0.0
    com: np.ndarray = field(default_factory=lambda: np.zeros(3))
    R: np.ndarray = field(default_factory=lambda: np.eye(3))
    I: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass
class Joint:
    name: str
    kind: str
    parent: str
    child: str
    p: np.ndarray
    R: np.ndarray
    axis: np.ndarray
    damping: float
    friction: float
    mimic: tuple | None
    column: int = -1


class Student:
    """One robot; `wrong` holds the names of the mistakes that are switched on."""

    name, version = "student", "1"

    def __init__(self, text: str, floating: bool = False, wrong: tuple[str, ...] = (), gravity=(0, 0, -9.81)) -> None:
        self.wrong, self.floating, self.asked = set(wrong), floating, 0
        root = ET.fromstring(text)
        self.links = {k.get("name"): self._link(k) for k in root.findall("link")}
        self.joints = [self._joint(j) for j in root.findall("joint")]
        self._sort()
        self._edit()
        base = 6 if floating else 0
        moving = sorted((j for j in self.joints if j.kind != "fixed"), key=self._rank)
        for k, j in enumerate(moving):
            j.column = base + k
        self.moving, self.nv, self.nb = moving, base + len(moving), base
        self.g = self._gravity(np.array(gravity, float))
        names = [j.name for j in moving]
        if self.has("order"):  # it computes in the file's order, and says nothing of it
            names = self._order
        q, v = (["x", "y", "z", "qw", "qx", "qy", "qz"], ["wx", "wy", "wz", "vx", "vy", "vz"]) if floating else ([], [])
        self.writes = {"q": [*q, *self._declared(names)], "v": [*v, *self._declared(names)]}

    def has(self, *names: str) -> bool:
        return bool(self.wrong & set(names))

    # --- reading the file -------------------------------------------------------------------------

    def _rpy(self, rpy, what):
        r, p, y = rpy
        if self.has(f"{what}_rpy_ignored"):
            return np.eye(3)
        if self.has(f"{what}_rpy_order"):
            return rx(r) @ ry(p) @ rz(y)
        R = rz(y) @ ry(p) @ rx(r)
        return R.T if self.has(f"{what}_rpy_transposed") else R

    def _numbers(self, e, key, default):
        x = np.array([float(t) for t in (default if e is None else e.get(key, default)).split()])
        return x.astype(np.float32).astype(float) if self.has("float32_file") else x

    def _link(self, e) -> Link:
        i = e.find("inertial")
        if i is None:
            return (
                Link(e.get("name"), 1.0, np.zeros(3), np.eye(3), np.eye(3))
                if self.has("default_mass")
                else Link(e.get("name"))
            )
        o, t = i.find("origin"), i.find("inertia")
        I = np.zeros((3, 3))
        for key, (a, b) in PRODUCTS.items():
            I[a, b] = I[b, a] = self._numbers(t, key, "0")[0]
        m, c = self._numbers(i.find("mass"), "value", "0")[0], self._numbers(o, "xyz", "0 0 0")
        R = self._rpy(self._numbers(o, "rpy", "0 0 0"), "inertial")
        D = np.diag(np.diag(I))
        if self.has("products_dropped"):
            I = D
        if self.has("products_sign"):
            I = 2 * D - I
        if self.has("products_swapped"):
            I = I.copy()
            I[0, 2], I[1, 2] = I[1, 2], I[0, 2]
            I[2, 0], I[2, 1] = I[0, 2], I[1, 2]
        if self.has("inertia_order"):  # ixx ixy ixz iyy iyz izz taken for xx yy zz xy xz yz
            xx, yy, zz, xy, xz, yz = I[0, 0], I[0, 1], I[0, 2], I[1, 1], I[1, 2], I[2, 2]
            I = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if self.has("moments_swapped"):
            I = I + np.diag([I[2, 2] - I[0, 0], 0, I[0, 0] - I[2, 2]])
        if self.has("point_masses"):
            I = 0 * I
        if self.has("inertia_units"):
            I = 1000 * I
        if self.has("principal"):
            I = np.diag(np.linalg.eigvalsh(I))
        if self.has("com_ignored"):
            c = 0 * c
        if self.has("inertial_ignored"):
            c, R = 0 * c, np.eye(3)
        if self.has("com_sign"):
            c = -c
        if self.has("com_turned"):
            c = R @ c
        steiner = m * (c @ c * np.eye(3) - np.outer(c, c))
        about = {
            "about_link_origin": -steiner, "steiner_twice": steiner,
            "steiner_diagonal": np.diag(np.diag(steiner)) - steiner,
            "steiner_outer": m * np.outer(c, c) - steiner, "steiner_isotropic": m * (c @ c) * np.eye(3) - steiner,
        }  # fmt: skip
        for name, more in about.items():
            if self.has(name):
                R, I = np.eye(3), R @ I @ R.T + more
        return Link(e.get("name"), m, c, R, I)

    def _joint(self, e) -> Joint:
        o, a, d, m = e.find("origin"), e.find("axis"), e.find("dynamics"), e.find("mimic")
        p, R = self._numbers(o, "xyz", "0 0 0"), self._rpy(self._numbers(o, "rpy", "0 0 0"), "joint")
        axis = self._numbers(a, "xyz", "1 0 0")
        if (self.has("axis_default_z") and a is None) or self.has("axis_always_z"):
            axis = np.array([0.0, 0, 1])
        axis = axis / np.linalg.norm(axis) if e.get("type") != "fixed" else axis
        if self.has("axis_sign"):
            axis = np.abs(axis)
        if self.has("axis_in_parent"):
            axis = R.T @ axis
        if self.has("joint_xyz_ignored"):
            p = 0 * p
        if self.has("joint_xyz_turned"):
            p = R @ p
        if self.has("fixed_placement_ignored") and e.get("type") == "fixed":
            p, R = 0 * p, np.eye(3)
        kind = e.get("type")
        if self.has("prismatic_as_revolute") and kind == "prismatic":
            kind = "revolute"
        follows = None if m is None else (m.get("joint"), float(m.get("multiplier", 1)), float(m.get("offset", 0)))
        return Joint(
            e.get("name"), kind, e.find("parent").get("link"), e.find("child").get("link"), p, R, axis,
            *(float(d.get(k, 0)) if d is not None else 0.0 for k in ("damping", "friction")), follows,
        )  # fmt: skip

    def _sort(self) -> None:
        """Parents first."""
        self._order = [j.name for j in self.joints if j.kind != "fixed"]
        children = {j.child for j in self.joints}
        self.base = next(k for k in self.links if k not in children)
        done, todo, out = {self.base}, list(self.joints), []
        while todo:
            for j in list(todo):
                if j.parent in done:
                    out.append(j)
                    todo.remove(j)
                    done.add(j.child)
        self.joints = out

    def _rank(self, j: Joint) -> int:
        return self._order.index(j.name)

    def _declared(self, names):
        """In what order it says that its joints are."""
        if self.has("order_alphabetical"):
            return sorted(names)
        if self.has("two_joints_swapped"):
            return [names[1], names[0], *names[2:]]
        return names[::-1] if self.has("order_reversed") else list(names)

    def _edit(self) -> None:
        """Mistakes about one link or joint, and about fixed links."""
        moving = [j for j in self.joints if j.kind != "fixed"]
        heavy = [j for j in moving if self.links[j.child].mass > 0]
        third, last = heavy[min(2, len(heavy) - 1)], heavy[-1]
        one = self.links[third.child]
        if self.has("one_mass"):
            one.mass *= 1.1
        if self.has("one_com"):
            one.com = one.com + np.array([0.01, -0.02, 0.03])
        if self.has("one_inertia"):
            one.I = 1.5 * one.I
        if self.has("one_left_out"):
            one.mass, one.I = 0.0, 0 * one.I
        if self.has("one_products_sign"):
            one.I = 2 * np.diag(np.diag(one.I)) - one.I
        if self.has("payload"):
            self.links[last.child].mass += 0.5
        if self.has("one_axis_reversed"):
            third.axis = -third.axis
        if self.has("one_origin"):
            third.p = third.p + np.array([0.01, 0.02, -0.01])
        if self.has("one_zero"):
            third.R = third.R @ rotation_about(third.axis, 0.1)
        if self.has("one_rpy_ignored"):
            third.R = np.eye(3)
        if self.has("fixed_dropped"):
            for j in self.joints:
                if j.kind == "fixed":
                    self.links[j.child].mass, self.links[j.child].I = 0.0, np.zeros((3, 3))
        if self.has("fixed_unturned", "fixed_unshifted"):
            for j in self.joints:
                k = self.links[j.child]
                if j.kind == "fixed" and self.has("fixed_unturned"):
                    k.com, k.R = j.R.T @ k.com, j.R.T @ k.R
                elif j.kind == "fixed":
                    k.com = k.com - j.R.T @ j.p

    def _gravity(self, g):
        for name, other in {
            "g_9.8": [0, 0, -9.8], "g_9.80665": [0, 0, -9.80665], "g_float32": [0, 0, -float(np.float32(9.81))],
            "g_sign": [0, 0, 9.81], "g_none": [0, 0, 0], "g_along_y": [0, -9.81, 0], "g_odd": [0, 0, -9.7803],
        }.items():  # fmt: skip
            if self.has(name):
                return np.array(other, float)
        return g

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

    # --- what it offers ---------------------------------------------------------------------------

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


_FIT = ("one_link", "massless")
FIXED = {
    "inertial_rpy_ignored": ("inertial_rpy",), "inertial_rpy_transposed": ("inertial_rpy_transposed",),
    "inertial_rpy_order": ("inertial_rpy_order",), "com_ignored": ("inertial_xyz",),
    "inertial_ignored": ("inertial_origin", "inertial_xyz"), "com_sign": ("inertial_xyz_sign",),
    "com_turned": ("inertial_xyz_turned",),
    "about_link_origin": ("about_link_origin",), "steiner_twice": ("steiner_twice",),
    "steiner_diagonal": ("steiner_wrong",), "steiner_outer": ("steiner_wrong",),
    "steiner_isotropic": ("steiner_wrong",),
    "products_dropped": ("products_dropped",), "products_sign": ("products_sign",),
    "products_swapped": ("products_swapped",), "inertia_order": ("inertia_order",),
    "moments_swapped": ("moments_swapped",),
    "point_masses": ("no_rotational",), "principal": ("principal",), "default_mass": ("default_mass",),
    "fixed_dropped": ("fixed_dropped", "massless"), "fixed_unturned": ("merge_turn",),
    "fixed_unshifted": ("merge_shift",),
    "float32_file": ("single_precision",), "one_mass": _FIT, "one_com": _FIT, "one_inertia": _FIT,
    "one_left_out": ("massless", "one_link"), "one_products_sign": ("products_sign", "one_link"), "payload": _FIT,
    "one_axis_reversed": ("axis_reversed",), "one_origin": ("origin_fit",), "one_zero": ("origin_fit",),
    "one_rpy_ignored": ("rpy_ignored",), "joint_rpy_ignored": ("rpy_ignored",), "joint_rpy_order": ("rpy_order",),
    "joint_rpy_transposed": ("rpy_transposed",), "joint_xyz_ignored": ("xyz_ignored",),
    "joint_xyz_turned": ("xyz_after_rpy",), "axis_default_z": ("axis_default_z",),
    "axis_always_z": ("axis_always_z",),
    "axis_sign": ("axis_sign",), "axis_in_parent": ("axis_in_parent",), "motion_first": ("motion_first",),
    "prismatic_as_revolute": ("prismatic_as_revolute",), "fixed_placement_ignored": ("fixed_placement",),
    "mimic": ("mimic",), "g_9.8": ("gravity",), "g_9.80665": ("gravity",), "g_float32": ("gravity",),
    "g_sign": ("gravity",), "g_none": ("gravity",), "g_along_y": ("gravity",), "g_odd": ("gravity",),
    "degrees": ("degrees",), "float32_states": ("single_precision",), "float32_answers": ("single_precision",),
    "base_offset": ("base_offset",), "no_tangential": ("tangential", "tangential_link"),
    "no_centripetal": ("centripetal",), "no_centripetal_link": ("centripetal_link",),
    "no_centripetal_com": ("centripetal_com",), "no_axis_rate": ("axis_rate",),
    "no_slide_coriolis": ("slide_coriolis",), "half_slide_coriolis": ("slide_coriolis_half",),
    "inertia_not_turned": ("inertia_frame",), "inertia_turned_back": ("inertia_frame_transposed",),
    "no_gyroscopic": ("gyroscopic",), "gyroscopic_sign": ("gyroscopic_sign",), "no_moment_arm": ("moment_arm",),
    "gravity_at_origin": ("gravity_at_origin",), "damping": ("damping",), "damping_sign": ("damping_sign",),
    "friction": ("friction",), "friction_as_damping": ("friction_as_damping",), "viscous": ("damping_fit",),
    "rotor": ("rotor_fit",), "tool_offset": ("tool_offset",), "fk_at_com": ("at_com",),
    "fk_rotation_transposed": ("rotation_transposed",), "fk_inverse": ("inverse_pose",),
    "jacobian_world": ("reference_world",), "jacobian_local": ("reference_local",), "jacobian_at_com": ("at_com",),
    "jacobian_linear_sign": ("jacobian_linear_sign",), "rows_linear_first": ("rows",), "history": ("history",),
    "torque_sign": ("sign",), "newton_millimetres": ("scale",), "a_ignored": ("a_ignored",),
    "v_ignored": ("v_ignored",),
    "coriolis_half": ("velocity_scale",), "coriolis_twice": ("velocity_scale",),
    "bias_without_gravity": ("no_gravity_in_bias", "gravity"), "crba_upper": ("upper",), "crba_lower": ("lower",),
    "crba_diagonal": ("diagonal",), "aba_without_bias": ("bias_ignored",), "aba_bias_sign": ("bias_sign",),
    "com_of_origins": ("inertial_xyz", "com_of_origins"), "com_not_divided": ("scale",),
    "base_counts": ("base_counts",),
    "momentum_about_origin": ("about_origin",), "energy_without_half": ("scale",),
    "coriolis_rate": ("coriolis_rate",),
    "coriolis_other": ("coriolis_other",), "coriolis_transposed": ("transposed",), "jdot_zero": ("jdot_zero",),
    "two_joints_swapped": ("order",), "inertia_units": ("inertia_units",), "millimetres": ("millimetres",),
    "one_torque_sign": ("joint_scale",), "crba_constant": ("constant_entries",),
    "fk_rotation_missing": ("rotation_missing",), "order_alphabetical": ("order",), "order_reversed": ("order",),
}  # fmt: skip
FLOATING = {
    "quaternion_xyzw": ("quaternion",), "base_turn_inverted": ("base_turn",), "base_pose_ignored": ("base_pose",),
    "gravity_in_base": ("gravity_in_base", "base_pose"), "base_linear_first": ("base_order",),
    "angular_world": ("angular_world",),
    "linear_world": ("linear_world",), "linear_origin": ("linear_origin",), "seen_from_base": ("in_base",),
}  # fmt: skip
MISTAKES = FIXED | FLOATING
"""Each mistake, with the keys that name it rightly."""
PAIRS = (
    ("g_9.8", "inertial_rpy_ignored"), ("g_9.8", "damping"), ("com_ignored", "products_sign"),
    ("rows_linear_first", "jacobian_local"),
    ("axis_sign", "g_sign"), ("crba_upper", "fixed_dropped"), ("order_alphabetical", "g_9.80665"),
    ("damping", "friction"),
    ("joint_rpy_order", "inertial_rpy_order"), ("one_mass", "g_9.8"), ("products_dropped", "fixed_dropped"),
    ("jacobian_world", "fk_rotation_transposed"), ("no_gyroscopic", "g_9.8"), ("rotor", "damping"),
    ("coriolis_other", "torque_sign"),
    ("inertial_rpy_transposed", "products_dropped"),
)  # fmt: skip
