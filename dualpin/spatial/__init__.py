"""Spatial algebra: vectors, rotations, quaternions, poses, inertias over any scalar; motions as arrays."""

from ..renamed import renamed_names
from .adjoint import adjoint, coadjoint
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
from .inertia import ZERO_INERTIA, Articulated, Connection, Inertia
from .pose import IDENTITY_POSE, Pose
from .quaternion import Quaternion, displaced
from .rotation import IDENTITY, Rotation, dh_rotation, diagonal, skew
from .sandwich import (
    matrix_to_quaternion,
    quaternion_to_matrix,
    transform_lines,
    transform_planes,
    transform_points,
)
from .vector import AXES, UX, UY, UZ, ZERO_MOTOR, ZERO_VECTOR, Matrix3, Momentum, Twist, Vector3, Wrench, motor, power

__all__ = [
    "AXES", "IDENTITY", "IDENTITY_POSE", "UX", "UY", "UZ", "ZERO_INERTIA", "ZERO_MOTOR", "ZERO_VECTOR", "Articulated",
    "Connection", "Inertia", "Matrix3", "Momentum", "Pose", "Quaternion", "Rotation", "ScrewParameters", "Twist",
    "Vector3", "Wrench", "adjoint", "coadjoint", "compose", "dh_rotation", "diagonal", "displaced", "exp",
    "from_matrix", "inverse", "log", "matrix_to_quaternion", "motor", "power", "quaternion_to_matrix", "sclerp",
    "screw_parameters", "skew", "to_matrix", "transform_lines", "transform_planes", "transform_points",
]  # fmt: skip

__getattr__ = renamed_names(__name__, NOUGHT="ZERO_VECTOR", REST="ZERO_MOTOR", GROUND="IDENTITY_POSE")
