"""A URDF as plain arrays: moving bodies with fixed links lumped into them, in document order."""

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import numpy as np


def cross_matrix(a):
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def turn(axis, angle):
    """Rodrigues' formula; the axis is a unit vector."""
    K = cross_matrix(axis)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


def homogeneous(R, p):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


@dataclass
class Body:
    """What moves with one joint; its frame is that of the joint's child link."""

    name: str
    parent: int
    kind: str
    placement: np.ndarray
    axis: np.ndarray
    columns: list = field(default_factory=list)
    mass: float = 0.0
    com: np.ndarray = field(default_factory=lambda: np.zeros(3))
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    lumps: list = field(default_factory=list)


class Reader:
    """Reads links and joints, and lumps what does not move."""

    def __init__(self, text, mistakes=frozenset()):
        self.mistakes = mistakes
        root = ET.fromstring(text)
        self.links = {e.get("name"): e for e in root.findall("link")}
        self.joints = root.findall("joint")
        children = {j.find("child").get("link") for j in self.joints}
        self.root = next(name for name in self.links if name not in children)

    def vector(self, element, name, default="0 0 0"):
        text = default if element is None else element.get(name, default)
        return np.array([float(x) for x in text.split()])

    def rpy(self, r, p, y):
        if "quarter_turns_snapped" in self.mistakes:
            whole = np.round(np.array([r, p, y]) / (np.pi / 2)) * (np.pi / 2)
            r, p, y = np.where(np.abs(whole - [r, p, y]) < 1e-3, whole, [r, p, y])
        X, Y, Z = turn([1.0, 0, 0], r), turn([0, 1.0, 0], p), turn([0, 0, 1.0], y)
        if "rpy_other_order" in self.mistakes:
            return X @ Y @ Z
        return Z @ Y @ X

    def origin(self, element):
        tag = element.find("origin")
        return self.rpy(*self.vector(tag, "rpy")), self.vector(tag, "xyz")

    def tensor(self, tag):
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        xx, xy, xz, yy, yz, zz = (float(tag.get(n, 0.0)) for n in names)
        if "tensor_entries_misread" in self.mistakes:
            yy, xz = xz, yy
        if "products_negated" in self.mistakes:
            xy, xz, yz = -xy, -xz, -yz
        if "tensor_upper_only" in self.mistakes:
            return np.array([[xx, xy, xz], [0.0, yy, yz], [0.0, 0.0, zz]])
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def inertial(self, link):
        """Mass, centre of mass and tensor about it, in the link's axes."""
        tag = self.links[link].find("inertial")
        if tag is None:
            return 0.0, np.zeros(3), np.zeros((3, 3))
        m, I = float(tag.find("mass").get("value")), self.tensor(tag.find("inertia"))
        R, c = self.origin(tag)
        if "com_in_inertial_axes" in self.mistakes:
            c = R @ c
        if "inertial_rpy_forgotten" in self.mistakes:
            R = np.eye(3)
        I = R.T @ I @ R if "inertia_turned_backwards" in self.mistakes else R @ I @ R.T
        if "tensor_taken_about_origin" in self.mistakes:
            I = I - m * (c @ c * np.eye(3) - np.outer(c, c))
        return m, c, I

    def joint(self, j, to_parent_body):
        """Placement in the parent body, the axis in the joint's frame, and what kind it is."""
        kind = {"revolute": "turns", "continuous": "turns", "prismatic": "slides"}.get(j.get("type"))
        if kind is None:
            raise NotImplementedError(f"joint type {j.get('type')}")
        if "continuous_does_not_move" in self.mistakes and j.get("type") == "continuous":
            kind = "stays"
        default = "0 0 1" if "axis_default_is_z" in self.mistakes else "1 0 0"
        axis = self.vector(j.find("axis"), "xyz", default)
        if "axis_length_kept" not in self.mistakes:
            axis = axis / np.linalg.norm(axis)
        R, p = self.origin(j)
        if "axis_in_parent_axes" in self.mistakes:
            axis = R.T @ axis
        return kind, to_parent_body @ homogeneous(R, p), axis

    def lump(self, body):
        """One rigid body of the link and all that is fixed to it."""
        m = sum(part[0] for part in body.lumps)
        if m == 0.0:
            return
        c = sum(part[0] * part[1] for part in body.lumps) / m
        if "lumped_com_is_links" in self.mistakes and body.lumps[0][0] > 0:
            c = body.lumps[0][1]
        I = np.zeros((3, 3))
        for mk, ck, Ik in body.lumps:
            d = ck - c
            I = I + Ik
            if "lumped_without_parallel_axis" not in self.mistakes:
                I = I + mk * (d @ d * np.eye(3) - np.outer(d, d))
        body.mass, body.com, body.inertia = m, c, I

    def read(self, floating):
        """Bodies, the root first, and of each link its body and its pose in it."""
        bodies = [Body(self.root, -1, "floats" if floating else "stays", np.eye(4), np.zeros(3))]
        frames = {self.root: (0, np.eye(4))}
        waiting = [self.root]
        bodies[0].lumps.append(self.inertial(self.root))
        while waiting:
            parent = waiting.pop(0)
            at, T = frames[parent]
            for j in self.joints:
                if j.find("parent").get("link") != parent:
                    continue
                child = j.find("child").get("link")
                if j.get("type") == "fixed":
                    R, p = self.origin(j)
                    if "fixed_rpy_forgotten" in self.mistakes:
                        R = np.eye(3)
                    X = T @ homogeneous(R, p)
                    m, c, I = self.inertial(child)
                    if "fixed_links_dropped" not in self.mistakes:
                        bodies[at].lumps.append((m, X[:3, :3] @ c + X[:3, 3], X[:3, :3] @ I @ X[:3, :3].T))
                    frames[child] = (at, X)
                else:
                    kind, placement, axis = self.joint(j, T)
                    bodies.append(Body(j.get("name"), at, kind, placement, axis))
                    bodies[-1].lumps.append(self.inertial(child))
                    frames[child] = (len(bodies) - 1, np.eye(4))
                waiting.append(child)
        for body in bodies:
            self.lump(body)
        return bodies, frames
