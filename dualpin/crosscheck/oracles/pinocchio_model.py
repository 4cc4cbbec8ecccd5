"""Pinocchio's models: read from a URDF file, or put together from a robot's own joints."""

from __future__ import annotations

import os
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ...model.joints import Axial
from ...model.robot import Joint, Robot
from ...spatial.inertia import steiner
from ...spatial.pose import Pose
from ..reading import Body, Description
from .oracle import OracleError

T = TypeVar("T")
ANGULAR_FIRST = [3, 4, 5, 0, 1, 2]
_console = threading.Lock()


def import_pinocchio() -> Any:
    try:
        import pinocchio
    except ImportError as e:
        raise OracleError(f"validation needs Pinocchio (pip install pin): {e}") from None
    return pinocchio


def _heard(make: Callable[[], T]) -> tuple[T | Exception, list[str]]:
    """What `make` returns or throws, and what urdfdom wrote meanwhile to the process's own stderr."""
    with _console, tempfile.TemporaryFile() as record:
        sys.stderr.flush()
        saved = os.dup(2)
        os.dup2(record.fileno(), 2)
        found: T | Exception
        try:
            found = make()
        except Exception as e:  # whatever the binding throws is its refusal
            found = e
        finally:
            os.dup2(saved, 2)
            os.close(saved)
        record.seek(0)
        lines = record.read().decode(errors="replace").splitlines()
    return found, [x.split(":", 1)[1].strip() for x in lines if x.startswith(("Error:", "Warning:"))]


def read(path: str, floating: bool, mimic: bool) -> tuple[Any, tuple[str, ...]]:
    """Pinocchio's own model of a URDF file and what urdfdom complained of, or an `OracleError` with the reason."""
    pin = import_pinocchio()
    root = (pin.JointModelFreeFlyer(),) if floating else ()
    found, complaints = _heard(lambda: pin.buildModelFromUrdf(path, *root, mimic=mimic))
    if isinstance(found, Exception):
        reason = "; ".join([str(found).strip().splitlines()[0], *complaints[:2]])
        raise OracleError(f"Pinocchio refuses {Path(path).name}: {reason}") from None
    return found, tuple(complaints)


def build(path: str, floating: bool, mimic: bool) -> Any:
    """Pinocchio's own model of a URDF file, or an `OracleError` with its reason."""
    return read(path, floating, mimic)[0]


def assembled(robot: Robot) -> Any:
    """A Pinocchio model of the same joints, bodies, frames, rotors and gravity.

    For robots that were changed or built in code, so that no file holds them.  Joints that follow
    another are ordinary ones here.
    """
    pin = import_pinocchio()
    model = pin.Model()
    model.name = robot.name
    index: dict[Joint | None, int] = {None: 0}
    rotors = np.zeros(0)
    for j in robot:
        index[j] = model.addJoint(index[j.parent], _joint(pin, j), _placement(pin, j.placement), j.name)
        model.appendBodyToJoint(index[j], _inertia(pin, j), pin.SE3.Identity())
        armature = np.array([float(x) for x in j.armature] or [0.0] * j.model.nv)
        rotors = np.concatenate([rotors, armature[ANGULAR_FIRST] if len(armature) == 6 else armature])
    model.armature = rotors
    model.gravity.linear = robot.gravity.array
    kinds = {"joint": pin.JOINT, "fixed_joint": pin.FIXED_JOINT, "link": pin.BODY}
    for f in robot.frames[1:]:
        kind = kinds.get(f.role, pin.OP_FRAME)
        model.addFrame(pin.Frame(f.name, index[f.joint], 0, _placement(pin, f.placement), kind))
    return model


def _placement(pin: Any, X: Pose) -> Any:
    return pin.SE3(X.array)


def _inertia(pin: Any, joint: Joint) -> Any:
    """About the centre of mass; a body without mass keeps its tensor about the joint's frame."""
    mass, h = float(joint.inertia.mass), joint.inertia.moment.array
    J = joint.inertia.rotational.array
    c = h / mass if mass else 0 * h
    try:
        return pin.Inertia(mass, c, J - steiner(mass, c))
    except RuntimeError as e:  # of a tensor or mass that no body has
        raise OracleError(f"Pinocchio refuses the inertia of {joint.name}: {e}") from None


def _joint(pin: Any, joint: Joint) -> Any:
    """Of the same motions; coordinates may differ."""
    model = joint.model.free
    if isinstance(model, Axial):
        axis = model.axis.array
        axis /= np.linalg.norm(axis)
        parts = [_axial(pin, axis, float(u.real), float(u.dual)) for u in model.units]
        if len(parts) == 1:
            return parts[0]
        composite = pin.JointModelComposite()
        for part in parts:
            composite.addJoint(part)
        return composite
    by_coordinates = {
        ("length",) * 3 + ("quaternion",) * 4: pin.JointModelFreeFlyer,
        ("length", "length", "angle"): pin.JointModelPlanar,
        ("quaternion",) * 4: pin.JointModelSpherical,
    }
    made = by_coordinates.get(tuple(model.coordinates))
    if made is None:
        raise OracleError(f"Pinocchio has no joint like {joint.name} ({model.kind})")
    return made()


def _axial(pin: Any, axis: np.ndarray, turn: float, slide: float) -> Any:
    """A joint of the screw (turn + eps slide) axis."""
    if slide == 0 and turn == 1:
        return pin.JointModelRevoluteUnaligned(axis)
    if turn == 0 and slide == 1:
        return pin.JointModelPrismaticUnaligned(axis)
    if turn == 1:
        return pin.JointModelHelicalUnaligned(axis, slide)
    raise OracleError(f"Pinocchio has no joint of the screw {turn:g} + eps {slide:g}")


def described(model: Any, complaints: tuple[str, ...]) -> Description:
    """Its bodies in dualpin's conventions."""
    pin = import_pinocchio()
    bodies = []
    neutral = pin.neutral(model)
    for i in range(1, model.njoints):
        joint, Y, X = model.joints[i], model.inertias[i], model.jointPlacements[i]
        m, c = Y.mass, Y.lever
        J = Y.inertia + steiner(m, c)
        tensor = [J[0, 0], J[0, 1], J[1, 1], J[0, 2], J[1, 2], J[2, 2]]
        data = joint.createData()
        joint.calc(data, neutral)
        S = np.reshape(data.S, (6, -1))[ANGULAR_FIRST]
        rotors = model.armature[joint.idx_v : joint.idx_v + joint.nv]
        if joint.nv == 6:
            S, rotors = S[:, ANGULAR_FIRST], rotors[ANGULAR_FIRST]
        parent = model.names[model.parents[i]] if model.parents[i] else ""
        bodies.append(Body(model.names[i], parent, X.homogeneous, np.array([m, *(m * c), *tensor]), S.T, rotors))
    return Description(tuple(bodies), model.gravity.linear.copy(), complaints)
