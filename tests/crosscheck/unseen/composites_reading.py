"""Bodies of a robot from its URDF: links with the joints that carry them."""

import numpy as np


def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def hat(a):
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def axis_angle(k, angle):
    K = hat(k)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def from_rpy(r, p, y):
    cr, sr, cp, sp, cy, sy = np.cos(r), np.sin(r), np.cos(p), np.sin(p), np.cos(y), np.sin(y)
    Rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    Ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    Rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return Rz @ Ry @ Rx


def numbers(element, key, default):
    text = default if element is None else element.get(key, default)
    return np.array([float(x) for x in text.split()])


def origin(element):
    o = element.find("origin")
    return from_rpy(*numbers(o, "rpy", "0 0 0")), numbers(o, "xyz", "0 0 0")


class Body:
    """A link with the joint that carries it."""

    def __init__(self, link):
        self.name = link.get("name")
        self.parent, self.kind, self.dof = -1, "fixed", -1
        self.R0, self.p0, self.axis = np.eye(3), np.zeros(3), np.array([1.0, 0.0, 0.0])
        self.mass, self.com, self.inertia = 0.0, np.zeros(3), np.zeros((3, 3))
        inertial = link.find("inertial")
        if inertial is not None:
            self.mass = float(inertial.find("mass").get("value"))
            R, self.com = origin(inertial)
            i = {k: float(x) for k, x in inertial.find("inertia").attrib.items()}
            tensor = np.array(
                [
                    [i["ixx"], i["ixy"], i["ixz"]],
                    [i["ixy"], i["iyy"], i["iyz"]],
                    [i["ixz"], i["iyz"], i["izz"]],
                ]
            )
            self.inertia = R @ tensor @ R.T
