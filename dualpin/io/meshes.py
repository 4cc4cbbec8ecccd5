"""The shapes a URDF gives its links, where their files are found."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from ..extras import extra


@dataclass(frozen=True)
class Shape:
    """A shape in the frame of its link.

    Attributes
    ----------
    link : str
    placement : ndarray, shape (4, 4)
        Of the shape in the link's frame.
    mesh : trimesh.Trimesh
    solid : bool
        Whether it is a box, a sphere or a cylinder, and not a mesh of a file.
    """

    link: str
    placement: np.ndarray
    mesh: Any
    solid: bool = False


def shapes(path: str | Path) -> Iterator[Shape]:
    """The visual shapes of a URDF; those whose mesh cannot be found or read are left out.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.io.meshes import shapes
    >>> {s.link for s in shapes(dp.load("double_pendulum").source)} <= set(dp.load("double_pendulum").link_names)
    True
    """
    path = Path(path)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, recover=True)
    for link in etree.parse(str(path), parser).getroot().iter("link"):
        for visual in link.iter("visual"):
            shape = shape_of(link.get("name", ""), visual, path)
            if shape is not None:
                yield shape


def shape_of(link: str, element: Any, urdf: Path) -> Shape | None:
    """The shape of a <visual> or <collision>, or None where it has none that can be read."""
    trimesh = extra("trimesh", "view", "reading meshes")
    geometry = element.find("geometry")
    found = _mesh(trimesh, urdf, geometry)
    if found is None:
        return None
    return Shape(link, _placement(trimesh, element.find("origin")), found, geometry.find("mesh") is None)


def _mesh(trimesh: Any, urdf: Path, geometry: Any) -> Any:
    """The mesh of a <geometry>, or None."""
    for shape in geometry if geometry is not None else ():
        try:
            if shape.tag == "box":
                return trimesh.creation.box(extents=_numbers(shape, "size", "1 1 1"))
            if shape.tag == "sphere":
                return trimesh.creation.icosphere(radius=float(shape.get("radius", 1)))
            if shape.tag == "cylinder":
                return trimesh.creation.cylinder(
                    radius=float(shape.get("radius", 1)), height=float(shape.get("length", 1))
                )
            if shape.tag == "mesh":
                file = find(urdf, shape.get("filename", ""))
                if file is not None:
                    mesh = trimesh.load(file, force="mesh")
                    mesh.apply_scale(_numbers(shape, "scale", "1 1 1"))
                    return mesh
        except Exception:  # readers of meshes raise whatever they like; a link without its shape is drawn as lines
            return None
    return None


def find(urdf: Path, name: str) -> Path | None:
    """The file a mesh's name means.

    "package://..." is looked for in the folders above the URDF and in those of ROS_PACKAGE_PATH.
    """
    inside = name.removeprefix("file://")
    if not inside.startswith("package://"):
        file = Path(inside) if Path(inside).is_absolute() else urdf.parent / inside
        return file if file.is_file() else None
    inside = inside.removeprefix("package://")
    package, _, rest = inside.partition("/")
    told = [Path(x) for x in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if x]
    for folder in (*urdf.resolve().parents, *told):
        for file in (folder / inside, folder / rest if folder.name == package else folder / "share" / inside):
            if file.is_file():
                return file
    return None


def _placement(trimesh: Any, origin: Any) -> np.ndarray:
    if origin is None:
        return np.eye(4)
    X = trimesh.transformations.euler_matrix(*_numbers(origin, "rpy", "0 0 0"), axes="sxyz")
    X[:3, 3] = _numbers(origin, "xyz", "0 0 0")
    return np.asarray(X)


def _numbers(element: Any, name: str, default: str) -> list[float]:
    return [float(x) for x in element.get(name, default).split()]
