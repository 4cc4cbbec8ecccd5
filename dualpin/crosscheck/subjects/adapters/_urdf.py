"""What adapters need to know of a URDF file and of rotations.  NumPy is all it needs: it runs beside the library."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

LINEAR_FIRST = ("vx", "vy", "vz", "wx", "wy", "wz")


def joints(path: str) -> Iterator[tuple[str, str, str]]:
    """(name, type, child link) of every joint, in the file's order."""
    for j in ET.parse(path).getroot().findall("joint"):  # the file is dualpin's own, written without entities
        child = j.find("child")
        yield j.get("name", ""), j.get("type", ""), "" if child is None else child.get("link", "")


def moving(path: str) -> list[str]:
    """Names of the joints that are not fixed."""
    return [name for name, kind, _ in joints(path) if kind != "fixed"]


def root(path: str) -> str:
    """The link that is no joint's child."""
    children = {child for *_, child in joints(path)}
    links = [link.get("name", "") for link in ET.parse(path).getroot().findall("link")]
    return next(name for name in links if name not in children)


def rotation(q: Sequence[float]) -> np.ndarray:
    """The matrix of a quaternion w x y z."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def homogeneous(R: Any, p: Any) -> np.ndarray:
    """The 4x4 matrix of a rotation and a position."""
    H = np.eye(4)
    H[:3, :3], H[:3, 3] = R, p
    return H


def joint_part(x: Any, base: bool, *axes: int) -> np.ndarray:
    """What a library with a base that always floats says of the joints; all of it where the base is meant to float."""
    x = np.asarray(x)
    for axis in () if base else axes:
        x = np.take(x, range(6, x.shape[axis]), axis)
    return x
