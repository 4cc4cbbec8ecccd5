"""A tree of rigid bodies from a URDF file: fixed links are merged into the body that carries them."""

import xml.etree.ElementTree as ET

import numpy as np


def skew(a):
    """The matrix S with S b = a x b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def rpy_matrix(roll, pitch, yaw):
    """Rotation of fixed-axis angles: Rz(yaw) Ry(pitch) Rx(roll)."""
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


def axis_angle(axis, angle):
    """Rodrigues' formula, for a unit axis."""
    S = skew(axis)
    return np.eye(3) + np.sin(angle) * S + (1.0 - np.cos(angle)) * S @ S


def quaternion_matrix(w, x, y, z):
    """Rotation of a unit quaternion."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class Body:
    """A link and all links that are fixed to it: mass, centre, and tensor about the centre in the body's axes."""

    def __init__(self, name):
        self.name, self.mass, self.com, self.inertia = name, 0.0, np.zeros(3), np.zeros((3, 3))

    def add(self, mass, com, inertia):
        """Join another rigid part, given in this body's frame."""
        total = self.mass + mass
        if total == 0.0:
            return
        centre = (self.mass * self.com + mass * com) / total
        shifted = np.zeros((3, 3))
        for m, c, I in ((self.mass, self.com, self.inertia), (mass, com, inertia)):
            d = c - centre
            shifted += I + m * (d @ d * np.eye(3) - np.outer(d, d))
        self.mass, self.com, self.inertia = total, centre, shifted


class Joint:
    """A moving joint: places body `child` on body `parent`."""

    def __init__(self, name, kind, parent, child, R, p, axis, dof):
        self.name, self.kind, self.parent, self.child = name, kind, parent, child
        self.R, self.p, self.axis, self.dof = R, p, axis, dof


def numbers(text, default):
    return np.array([float(x) for x in (text if text is not None else default).split()])


def read_origin(element):
    """Rotation and position of an <origin>, which may be absent."""
    origin = element.find("origin") if element is not None else None
    if origin is None:
        return np.eye(3), np.zeros(3)
    return rpy_matrix(*numbers(origin.get("rpy"), "0 0 0")), numbers(origin.get("xyz"), "0 0 0")


def read_inertial(link):
    """Mass, centre and tensor about the centre, in the link's axes."""
    inertial = link.find("inertial")
    if inertial is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    mass = float(inertial.find("mass").get("value"))
    R, com = read_origin(inertial)
    entries = inertial.find("inertia")
    ixx, ixy, ixz, iyy, iyz, izz = (float(entries.get(k, 0.0)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    tensor = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    return mass, com, R @ tensor @ R.T


def read_axis(joint):
    axis = joint.find("axis")
    xyz = numbers(axis.get("xyz") if axis is not None else None, "1 0 0")
    return xyz / np.linalg.norm(xyz)


class Model:
    """The tree: bodies, the joints between them in depth-first order, and where each link's frame is on its body."""

    def __init__(self, text, floating):
        root = ET.fromstring(text)
        self.links = {link.get("name"): link for link in root.findall("link")}
        self.below = {name: [] for name in self.links}
        children = set()
        for joint in root.findall("joint"):
            self.below[joint.find("parent").get("link")].append(joint)
            children.add(joint.find("child").get("link"))
        base = next(name for name in self.links if name not in children)
        self.floating = floating
        self.nv = 6 if floating else 0
        self.bodies, self.joints, self.frames = [], [], {}
        self._new_body(base)

    def _new_body(self, name):
        body = Body(name)
        self.bodies.append(body)
        self._attach(body, len(self.bodies) - 1, name, np.eye(3), np.zeros(3))

    def _attach(self, body, index, name, R, p):
        """Put link `name` on a body, at (R, p) in the body's frame, and follow the joints below it."""
        self.frames[name] = (index, R, p)
        mass, com, inertia = read_inertial(self.links[name])
        body.add(mass, p + R @ com, R @ inertia @ R.T)
        for joint in self.below[name]:
            Rj, pj = read_origin(joint)
            child = joint.find("child").get("link")
            R_here, p_here = R @ Rj, p + R @ pj
            if joint.get("type") == "fixed":
                self._attach(body, index, child, R_here, p_here)
                continue
            kind = {"continuous": "turn", "revolute": "turn", "prismatic": "slide"}[joint.get("type")]
            next_body = len(self.bodies)
            where = (index, next_body, R_here, p_here)
            self.joints.append(Joint(joint.get("name"), kind, *where, read_axis(joint), self.nv))
            self.nv += 1
            self._new_body(child)
