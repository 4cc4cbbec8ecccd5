"""Links and joints of a URDF in a list, links on fixed joints added to the bodies that carry them."""

import xml.etree.ElementTree as ET
from types import SimpleNamespace as Part

import numpy as np


def skew(a):
    x, y, z = a
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def from_rpy(rpy):
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def numbers(el, name, default):
    return np.array([float(x) for x in (el.get(name, default) if el is not None else default).split()])


def parallel(m, d):
    return m * (d @ d * np.eye(3) - np.outer(d, d))


def read(urdf):
    """(bodies, frames): body 0 is the base; a frame is (number of the body, R, p)."""
    root = ET.fromstring(urdf)
    inertials = {x.get("name"): x.find("inertial") for x in root.findall("link")}
    joints = root.findall("joint")
    base = (set(inertials) - {j.find("child").get("link") for j in joints}).pop()
    bodies = [Part(parent=-1, joint=None, mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))]
    frames = {}

    def add(b, link, R, p):
        frames[link] = (b, R, p)
        x = inertials[link]
        if x is not None:
            o = x.find("origin")
            c, Q = numbers(o, "xyz", "0 0 0"), from_rpy(numbers(o, "rpy", "0 0 0"))
            m = float(x.find("mass").get("value"))
            xx, xy, xz, yy, yz, zz = (
                float(x.find("inertia").get(k, 0)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
            )
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            tensor = Q @ tensor @ Q.T
            c, tensor = p + R @ c, R @ tensor @ R.T
            B = bodies[b]
            total = B.mass + m
            both = (B.mass * B.com + m * c) / total if total else B.com
            B.inertia = B.inertia + parallel(B.mass, B.com - both) + tensor + parallel(m, c - both)
            B.mass, B.com = total, both
        for j in joints:
            if j.find("parent").get("link") != link:
                continue
            o = j.find("origin")
            Rj, pj = from_rpy(numbers(o, "rpy", "0 0 0")), numbers(o, "xyz", "0 0 0")
            child, kind = j.find("child").get("link"), j.get("type")
            if kind == "fixed":
                add(b, child, R @ Rj, p + R @ pj)
            else:
                axis = numbers(j.find("axis"), "xyz", "1 0 0")
                new = Part(parent=b, joint=j.get("name"), slides=kind == "prismatic", R=R @ Rj, p=p + R @ pj)
                new.axis = axis / np.linalg.norm(axis)
                new.mass, new.com, new.inertia = 0.0, np.zeros(3), np.zeros((3, 3))
                bodies.append(new)
                add(len(bodies) - 1, child, np.eye(3), np.zeros(3))

    add(0, base, np.eye(3), np.zeros(3))
    return bodies, frames


def about(axis, angle):
    K = skew(axis)
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
