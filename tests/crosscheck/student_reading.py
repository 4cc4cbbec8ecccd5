"""A student's reading of a URDF file, right until a mistake is switched on."""

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


class Reading:
    """The robot of a file; `wrong` holds the names of the mistakes that are switched on."""

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
        if self.has("order"):  # it computes in the file's order and does not say so
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
