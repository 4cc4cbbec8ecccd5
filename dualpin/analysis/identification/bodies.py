"""Inertial parameters as bodies: physical consistency, and robots from parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...model.robot import Joint, Link, Robot
from ...spatial.inertia import ZERO_INERTIA, Inertia
from ...spatial.pose import Pose
from .parameters import Parameters


def moved(placement: Pose) -> np.ndarray:
    """The matrix (10, 10) that transforms a body's parameters to another frame."""
    return np.array([[float(x) for x in body.moved(placement).parameters] for body in Inertia.basis()]).T


def pseudo_inertias() -> np.ndarray:
    """The ten matrices E_i, shape (10, 4, 4), with  P = sum p_i E_i = [Sigma, h; h^T, m],  Sigma = tr(J) / 2 - J.

    A body of positive density has a positive definite P, and each such P is of a body (Wensing, Kim & Slotine 2018).
    """
    E = np.zeros((10, 4, 4))
    for i, body in enumerate(Inertia.basis()):
        J = body.rotational.array
        E[i, :3, :3] = np.trace(J) / 2 * np.eye(3) - J
        E[i, :3, 3] = E[i, 3, :3] = [float(x) for x in body.moment]
        E[i, 3, 3] = float(body.mass)
    return E


def violation(ten: np.ndarray) -> np.ndarray:
    """How far bodies (..., 10) are from possible ones: minus the least eigenvalue of P over the largest, or 0."""
    values = np.linalg.eigvalsh(np.einsum("...i,ijk->...jk", ten, pseudo_inertias()))
    return np.maximum(0.0, -values[..., 0]) / np.maximum(np.abs(values).max(axis=-1), np.finfo(float).tiny)


def robot_of(parameters: Parameters, p: np.ndarray) -> Robot:
    """The robot with these parameters: the same tree, each body's inertia on the first of its links."""
    robot = parameters.robot
    ten = p[: parameters.inertial].reshape(-1, 10)
    of_joints: dict[str, dict[str, list[float]]] = {}
    for (model, b, _), x in zip(parameters.of_joints, p[parameters.inertial :], strict=True):
        of_joints.setdefault(b.name, {}).setdefault(model, []).append(float(x))
    new: dict[Joint | None, Joint | None] = {None: None}
    for j in robot:
        said = of_joints.get(j.name, {})
        armature = tuple(said["rotor"]) if any(said.get("rotor", ())) else j.armature if "rotor" not in said else ()
        limits = j.limits
        if "viscous" in said:
            limits = replace(limits, damping=max(0.0, said["viscous"][0]))
        if "coulomb" in said:
            limits = replace(limits, friction=max(0.0, said["coulomb"][0]))
        new[j] = replace(
            j, parent=new[j.parent], inertia=Inertia.from_array(ten[j.index]), limits=limits,
            armature=armature or tuple(0.0 for _ in j.armature), rotor=None if armature != j.armature else j.rotor,
        )  # fmt: skip
    links, seen = [], set()
    for link in robot.links:
        first = link.joint is not None and link.joint not in seen
        seen.add(link.joint)
        body = ZERO_INERTIA
        if first and link.joint:
            body = Inertia.from_array(ten[link.joint.index]).moved(link.placement.inverse)
        links.append(Link(link.name, link.inertia if link.joint is None else body, new[link.joint], link.placement))
    frames = tuple(replace(f, joint=new[f.joint]) for f in robot.frames)
    joints = tuple(j for j in new.values() if j is not None)
    return replace(robot, joints=joints, frames=frames, links=tuple(links))
