"""The shapes a URDF gives its links as meshes, where their files are found."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import DualpinError, UrdfError
from ..extras import extra
from .shapes import Described, described, described_shapes

GREY = (170, 176, 182)


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
        Whether it is a box, a sphere, a cylinder or a capsule, and not a mesh of a file.
    role : "visual" or "collision"
    """

    link: str
    placement: np.ndarray
    mesh: Any
    solid: bool = False
    role: str = "visual"

    @property
    def colour(self) -> tuple[int, int, int]:
        """The mesh's own colour, or grey."""
        try:
            red, green, blue = self.mesh.visual.to_color().main_color[:3]
        except Exception:  # textures that are broken, or need a library that is not installed
            return GREY
        return int(red), int(green), int(blue)


@dataclass
class Shapes:
    """The shapes of a description that can be drawn, and a line for each that cannot."""

    found: list[Shape] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)


def shapes(path: str | Path) -> Shapes:
    """The visual and collision shapes of a URDF.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.io.meshes import shapes
    >>> robot = dp.load("double_pendulum")
    >>> {s.link for s in shapes(robot.source).found} <= set(robot.link_names)
    True
    """
    try:
        described, wrong = described_shapes(path)
    except DualpinError as e:  # the file was removed or changed after it was loaded
        return Shapes(missing=[str(e)])
    result = Shapes(missing=wrong)
    for one in described:
        shape, why = _shape(one, Path(path))
        if shape is None:
            result.missing.append(f"link {one.link!r}, {one.role}: {why}")
        else:
            result.found.append(shape)
    return result


def shape_of(link: str, element: Any, urdf: Path) -> Shape | None:
    """The shape of a <visual> or <collision>, or None where it has none that can be read."""
    try:
        return next((_shape(one, urdf)[0] for one in described(element, link, urdf.name)), None)
    except UrdfError:
        return None


def _shape(one: Described, urdf: Path) -> tuple[Shape | None, str]:
    """The shape with its mesh, or None and the reason."""
    mesh, why = _mesh(one, urdf)
    return (None, why) if mesh is None else (Shape(one.link, one.placement, mesh, one.form != "mesh", one.role), "")


def _mesh(shape: Described, urdf: Path) -> tuple[Any, str]:
    """The mesh of a shape, or None and the reason."""
    trimesh = extra("trimesh", "view", "view")
    if shape.form != "mesh":
        make: dict[str, Callable[..., Any]] = {
            "box": lambda *sides: trimesh.creation.box(extents=sides),
            "sphere": lambda radius: trimesh.creation.icosphere(radius=radius),
            "cylinder": lambda radius, length: trimesh.creation.cylinder(radius=radius, height=length),
            "capsule": lambda radius, length: trimesh.creation.capsule(radius=radius, height=length),
        }
        return make[shape.form](*shape.sizes), ""
    file = find(urdf, shape.file)
    if file is None:
        return None, f"{shape.file!r} is not found"
    try:
        mesh = trimesh.load(file, force="mesh")
        mesh.apply_scale(shape.sizes)
        return (mesh, "") if len(mesh.faces) else (None, f"{file.name} has no faces")
    except Exception as e:  # readers of meshes raise whatever they like
        return None, f"{file.name} cannot be read ({type(e).__name__}: {e})"


def find(urdf: Path, name: str) -> Path | None:
    """The path of a mesh's file.

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
