"""The vocabulary: vectors, rotations, quaternions, poses, inertias over any scalar; motions as arrays."""

from .arrays import (
    ScrewParameters,
    compose,
    exp,
    from_matrix,
    inverse,
    log,
    sclerp,
    screw_parameters,
    to_matrix,
)
from .inertia import Articulated, Connection, Inertia
from .pose import GROUND, Pose
from .quaternion import Quaternion, displaced
from .rotation import IDENTITY, Matrix3, Rotation, dh_rotation, diagonal, skew
from .vector import AXES, NOUGHT, REST, UX, UY, UZ, Vector3, motor, power

__all__ = [
    "AXES", "GROUND", "IDENTITY", "NOUGHT", "REST", "UX", "UY", "UZ", "Articulated", "Connection", "Inertia",
    "Matrix3", "Pose", "Quaternion", "Rotation", "ScrewParameters", "Vector3", "compose", "dh_rotation", "diagonal",
    "displaced", "exp", "from_matrix", "inverse", "log", "motor", "power", "sclerp", "screw_parameters", "skew",
    "to_matrix",
]  # fmt: skip
