"""The shapes a URDF gives its links, where their files are found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree


@dataclass(frozen=True)
class Shape:
    """A shape in the frame of its link.

    Attributes
    ----------
    link : str
    placement : ndarray, shape (4, 4)
        Of the shape in the link's frame.
    mesh : trimesh.Trimesh
    """

    link: str
    placement: np.ndarray
    mesh: Any


def shapes(path: str | Path) -> Iterator[Shape]:
    """The visual shapes of a URDF; those whose mesh cannot be found or read are left out.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.view.meshes import shapes
    >>> {s.link for s in shapes(dp.load("double_pendulum").source)} <= set(dp.load("double_pendulum").link_names)
    True
    """
    import trimesh

    path = Path(path)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, recover=True)
    for link in etree.parse(str(path), parser).getroot().iter("link"):
        for visual in link.iter("visual"):
            mesh = _mesh(trimesh, path, visual.find("geometry"))
            if mesh is not None:
                yield Shape(link.get("name", ""), _placement(trimesh, visual.find("origin")), mesh)


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
    """The file a mesh's name means: "package://..." is looked for in the folders above the URDF."""
    inside = name.removeprefix("file://")
    if not inside.startswith("package://"):
        file = Path(inside) if Path(inside).is_absolute() else urdf.parent / inside
        return file if file.is_file() else None
    inside = inside.removeprefix("package://")
    package, _, rest = inside.partition("/")
    for folder in urdf.resolve().parents:
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
