"""A robot built in code, built in code with Pinocchio too: joint by joint, with its own joint models."""

from __future__ import annotations

from typing import Any

import numpy as np

from dualpin.crosscheck.oracles.pinocchio import Layout
from dualpin.model import Robot
from dualpin.spatial import Inertia, Pose


def floats(x: Any) -> np.ndarray:
    return np.array([[float(c) for c in row] for row in getattr(x, "rows", x)])


def placed(pin: Any, X: Pose) -> Any:
    return pin.SE3(floats(X.rotation), np.array([float(c) for c in X.position]))


def body(pin: Any, I: Inertia) -> Any:
    m, h, J = float(I.mass), np.array([float(c) for c in I.moment]), floats(I.rotational)
    if m == 0:
        return pin.Inertia.Zero()
    c = h / m
    return pin.Inertia(m, c, J - m * (c @ c * np.eye(3) - np.outer(c, c)))


def joint_model(pin: Any, j: Any) -> Any:
    model = j.model.free
    simple = {"spherical": pin.JointModelSpherical, "floating": pin.JointModelFreeFlyer, "planar": pin.JointModelPlanar}
    if j.kind in simple:
        return simple[j.kind]()
    axis = np.array([float(c) for c in model.axis])
    if j.kind == "helical":
        return pin.JointModelHelicalUnaligned(axis, float(model.units[0].dual))
    unaligned = {
        "revolute": pin.JointModelRevoluteUnaligned, "continuous": pin.JointModelRevoluteUnaligned,
        "prismatic": pin.JointModelPrismaticUnaligned,
    }  # fmt: skip
    return unaligned[j.kind](axis)


def model_of(robot: Robot, pin: Any) -> Any:
    """A `pinocchio.Model` of the robot with its joints free (mimic undone), armature and gravity set."""
    m = pin.Model()
    m.name = robot.name
    m.gravity.linear = np.array([float(g) for g in robot.gravity])
    armature = np.zeros(0)
    for j in robot:
        parent = 0 if j.parent is None else j.parent.index + 1
        i = m.addJoint(parent, joint_model(pin, j), placed(pin, j.placement), j.name)
        m.addJointFrame(i)
        m.appendBodyToJoint(i, body(pin, j.inertia), pin.SE3.Identity())
        rotors = np.array([float(x) for x in j.armature])
        armature = np.r_[armature, np.r_[rotors[3:], rotors[:3]] if j.kind == "floating" else rotors]
    for f in robot.frames[1:]:
        if f.role in ("frame", "link", "fixed_joint"):
            i = 0 if f.joint is None else f.joint.index + 1
            kind = {"link": pin.BODY, "fixed_joint": pin.FIXED_JOINT, "frame": pin.OP_FRAME}[f.role]
            m.addFrame(pin.Frame(f.name, i, placed(pin, f.placement), kind), False)
    m.armature = armature
    return m


def layout_of(robot: Robot, pin: Any) -> Layout:
    return Layout(robot, model_of(robot, pin))
