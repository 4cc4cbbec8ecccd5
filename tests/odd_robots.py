"""Robots that no URDF holds."""

import dualpin as dp
from dualpin.model import joints
from dualpin.spatial import Inertia, Pose, Vector3, diagonal


def every_joint():
    """Every joint that is not in a URDF, with rotors, in a field of its own."""
    b = dp.Builder("odd", gravity=(1.0, -2.0, 3.0))
    I = Pose(position=Vector3(0.1, 0.0, 0.2)) @ Inertia(2.0, Vector3(0.0, 0.0, 0.0), diagonal(0.3))
    X = Pose(position=Vector3(0.3, 0.1, 0.0))
    b.joint("planar", joints.Planar(), inertia=I, armature=(0.1, 0.2, 0.3))
    b.joint("cylinder", joints.cylindrical(Vector3(0.6, 0.0, 0.8)), "planar", X, I, armature=(0.2, 0.3))
    b.joint("screw", joints.helical(pitch=0.1), "cylinder", X, I)
    b.joint("ball", joints.Spherical(), "screw", X, I, armature=(0.1, 0.2, 0.3))
    b.joint("free", joints.Floating(), "ball", X, I)
    return b.robot()
