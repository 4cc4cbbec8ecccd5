"""Small robots for the Robotics Toolbox: point masses, written to a file and read by Robot.URDF."""

import tempfile
import warnings
from pathlib import Path

import numpy as np

warnings.simplefilter("ignore")
ZERO = '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'
LIMIT = '<limit lower="-3" upper="3" effort="9" velocity="9"/>'


def mass(m, x=0.0):
    """A point mass at x along the link's x axis."""
    return f'<inertial><origin xyz="{x} 0 0" rpy="0 0 0"/><mass value="{m}"/>{ZERO}</inertial>'


def joint(name, parent, child, x=0.0, axis=None, more=""):
    """A joint at x along its parent's x axis: fixed without an axis."""
    kind, rest = ("fixed", "") if axis is None else ("revolute", f'<axis xyz="{axis}"/>{LIMIT}')
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{x} 0 0" rpy="0 0 0"/>{rest}{more}</joint>'
    )


def read(links, joints):
    """The toolbox's robot of these links (name, inertial) and joints, with gravity 9.81."""
    from roboticstoolbox import Robot

    text = "".join(f'<link name="{name}">{inertial}</link>' for name, inertial in links) + "".join(joints)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.urdf"
        path.write_text(f'<robot name="r">{text}</robot>')
        robot = Robot.URDF(str(path))
    robot.gravity = [0, 0, -9.81]
    return robot


def compare(what, got, expected):
    """Prints both; whether they differ."""
    print(f"{what}: expected {np.round(expected, 6).tolist()}, got {np.round(got, 6).tolist()}")
    return bool(np.abs(np.asarray(got) - expected).max() > 1e-9)
