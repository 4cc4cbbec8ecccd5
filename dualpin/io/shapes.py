"""The shapes a URDF gives its links, for drawing: read by the same rules as everything else of the file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree

from ..errors import UrdfError
from ..spatial.pose import Pose
from ..spatial.rotation import Rotation
from ..spatial.vector import UX, UY, UZ, Vector3
from .document import Document, Owner
from .mjcf import is_mjcf
from .xml import read

ROLES = ("visual", "collision")
SIZES = {"box": (("size", 3),), "sphere": (("radius", 1),), "cylinder": (("radius", 1), ("length", 1)),
         "capsule": (("radius", 1), ("length", 1))}  # fmt: skip


@dataclass(frozen=True)
class Described:
    """A shape as a file describes it.

    Attributes
    ----------
    link : str
    role : "visual" or "collision"
    form : "box", "sphere", "cylinder", "capsule" or "mesh"
    placement : ndarray, shape (4, 4)
        In the frame of the link.
    sizes : tuple of float
        The sides of a box; radius and length [m]; the scales of a mesh.
    file : str
        What the description calls the file of a mesh.
    """

    link: str
    role: str
    form: str
    placement: np.ndarray
    sizes: tuple[float, ...]
    file: str = ""


def described_shapes(path: str | Path) -> tuple[list[Described], list[str]]:
    """The shapes of all links, and what is wrong with others.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.io.shapes import described_shapes
    >>> found, wrong = described_shapes(dp.load("ur5").source)
    >>> sorted({s.role for s in found}), wrong
    (['collision', 'visual'], [])
    """
    path = Path(path)
    if is_mjcf(path):
        return [], ["shapes of MJCF files are not drawn"]
    root = read(path).whole
    found: list[Described] = []
    wrong: list[str] = []
    for link in root.findall("link") if root is not None else ():
        for role in ROLES:
            for element in link.findall(role):
                try:
                    found.extend(described(element, link.get("name", ""), path.name))
                except UrdfError as e:
                    wrong.append(str(e))
    return found, wrong


def described(element: etree._Element, link: str, source: str) -> Iterator[Described]:
    """The shapes of a <visual> or <collision>; an error names what is wrong with a number."""
    document, role = Document(element, source), str(element.tag)
    owner = Owner("link", link, f", {role}")
    geometry = element.find("geometry")
    placement = _placement(document, element.find("origin"), owner)
    for shape in geometry if geometry is not None else ():
        if shape.tag == "mesh":
            sizes = document.numbers(shape, "scale", 3, owner, "1 1 1")
            yield Described(link, role, "mesh", placement, tuple(sizes), shape.get("filename", ""))
        elif shape.tag in SIZES:
            numbers = [x for name, n in SIZES[shape.tag] for x in document.numbers(shape, name, n, owner)]
            yield Described(link, role, str(shape.tag), placement, tuple(numbers))
        else:
            document.fail(shape, f"{owner}: <{shape.tag}> is no shape that is drawn")


def _placement(document: Document, origin: etree._Element | None, owner: Owner) -> np.ndarray:
    if origin is None:
        return np.eye(4)
    turn = fixed_axes(*document.numbers(origin, "rpy", 3, owner, "0 0 0"))
    position = Vector3(*document.numbers(origin, "xyz", 3, owner, "0 0 0"))
    return Pose(turn, position).array


def fixed_axes(roll: float, pitch: float, yaw: float) -> Rotation:
    """Rz(yaw) Ry(pitch) Rx(roll)"""
    return Rotation(*(Rotation.about(UZ, yaw) @ Rotation.about(UY, pitch) @ Rotation.about(UX, roll)).rows)
