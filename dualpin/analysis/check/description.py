"""The data that rules examine: links and joints with their numbers, lines and shapes, for all formats."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import inf, isfinite
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ArgumentError, UrdfError
from ...io.catalogue import find
from ...io.document import Document
from ...io.expand import is_xacro
from ...io.meshes import Shape, shape_of
from ...io.mjcf import is_mjcf
from ...io.shapes import fixed_axes
from ...io.urdf import build, load
from ...io.xml import parse
from ...model.robot import Joint, Robot
from ...spatial.pose import Pose
from .findings import Edit

MICROMETRE = 1e-6  # m
TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass
class Body:
    """A link: mass [kg], centre of mass and tensor about it in the link's axes.

    Attributes
    ----------
    written : ndarray (3, 3)
        The tensor as the file states it, in the axes of the inertial frame.
    rotation : ndarray (3, 3)
        Orientation of the inertial frame in the link's.
    printed : float
        Bound of the rounding in the file: half a unit of the last digit of the tensor's entries, added up.
    carrier : Joint or None
        The joint that moves it; `placement` is its frame in the joint's.
    """

    name: str
    mass: float
    com: np.ndarray
    tensor: np.ndarray
    written: np.ndarray
    rotation: np.ndarray
    carrier: Joint | None
    placement: np.ndarray
    given: bool = True
    printed: float = 0.0
    line: int | None = None
    element: Any = field(default=None, repr=False)

    @cached_property
    def moments(self) -> np.ndarray:
        """Principal moments, ascending."""
        return np.linalg.eigvalsh(self.tensor)

    @property
    def point(self) -> bool:
        """Whether it is a point mass: its radius of gyration is below a micrometre."""
        return self.mass > 0 and float(np.abs(self.written).max()) <= self.mass * MICROMETRE**2

    @property
    def item(self) -> str:
        return f"link {self.name!r}"


@dataclass
class Hinge:
    """A joint of any kind, fixed ones too, with the numbers of the file."""

    name: str
    type: str
    parent: str
    child: str
    xyz: np.ndarray
    rpy: np.ndarray
    lower: float = -inf
    upper: float = inf
    velocity: float = inf
    effort: float = inf
    damping: float = 0.0
    friction: float = 0.0
    mimic: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0
    joint: Joint | None = None
    line: int | None = None
    element: Any = field(default=None, repr=False)

    @property
    def item(self) -> str:
        return f"joint {self.name!r}"


class Description:
    """A description to check.

    Attributes
    ----------
    robot : Robot
        On a fixed base, without mimic.
    """

    def __init__(self, name: str, robot: Robot, document: Document | None = None, path: Path | None = None) -> None:
        self.name, self.robot, self.document, self.path = name, robot, document, path
        self.file = str(path) if path else name
        self.text: str | None = None
        """The original text, if its elements can be edited individually."""
        whole = document.whole if document else None
        self._order: dict[Any, int] = {} if whole is None else {e: i for i, e in enumerate(whole.iter())}
        self.bodies = list(_bodies(robot, document))
        self.hinges = list(_hinges(robot, document))

    @property
    def editable(self) -> bool:
        """Whether the file's elements are those that were read."""
        return self.document is not None and self.document.whole is not None and not self.document.mended

    def edit(self, element: Any, attribute: str, value: str) -> tuple[Edit, ...]:
        """The change of an attribute of the file, if there is a file."""
        return (Edit(self._order[element], attribute, value),) if self.editable and element in self._order else ()

    def floating(self) -> Robot | None:
        """The robot on a floating base, if it comes from a file."""
        if self.document is None:
            return None
        try:
            return build(self.document, True, False, None)
        except UrdfError:
            return None

    @cached_property
    def shapes(self) -> dict[str, list[Shape]]:
        """Of each link, its visual shapes, or its collision shapes if it has no others; only if all of them are found.

        Collision shapes are often simplified, so they say less about the mass.
        """
        found: dict[str, list[Shape]] = {}
        for b in self.bodies:
            for tag in ("visual", "collision"):
                elements = [] if b.element is None else b.element.findall(tag)
                elements = [e for e in elements if e.find("geometry") is not None]
                if not elements:
                    continue
                read = [shape_of(b.name, e, self.path or Path()) for e in elements]
                kept = [s for s in read if s is not None]
                if len(kept) == len(elements):
                    found[b.name] = kept
                break
        return found

    @cached_property
    def children(self) -> dict[str, list[Hinge]]:
        """Link -> joints on it."""
        found: dict[str, list[Hinge]] = {}
        for h in self.hinges:
            found.setdefault(h.parent, []).append(h)
        return found


def described(target: str | Path | Robot) -> Description:
    """The description of a file, with its lines, or of a robot in memory, without them.

    Raises
    ------
    UrdfError
        If the file cannot be read.
    """
    if isinstance(target, Robot):
        return Description(target.name, target)
    if not isinstance(target, (str, os.PathLike)):
        raise ArgumentError(f"check: a name, a path or a Robot expected, got {type(target).__name__}")
    path = find(target)
    if is_mjcf(path):
        return Description(str(target), load(path), path=path)
    data = path.read_bytes()
    document = parse(data, path.name)
    about = Description(str(target), build(document, False, False, str(path)), document, path)
    about.file = str(target) if is_xacro(Path(str(target))) else str(path)
    if about.editable:
        try:
            about.text = data.decode("utf-8")
        except UnicodeDecodeError:
            about.text = None
    return about


def _bodies(robot: Robot, document: Document | None) -> Iterator[Body]:
    elements = {} if document is None or document.whole is None else _named(document, "link")
    for link in robot.links:
        ten = [float(x) for x in link.inertia.parameters]
        com, J = link.inertia.central
        tensor = J.array
        checked = None if document is None else document.links.get(link.name)
        inertial = None if checked is None else checked.find("inertial")
        written, R, printed = tensor, np.eye(3), 0.0
        if inertial is not None:
            written, R = _tensor(inertial), fixed_axes(*_numbers(inertial.find("origin"), "rpy").tolist()).array
            tensor = R @ written @ R.T
            printed = _printed(elements.get(link.name))
        at = None if checked is None else (inertial if inertial is not None else checked).sourceline
        given = any(ten) if document is None else inertial is not None
        yield Body(
            link.name, ten[0], com.array, tensor, written, R, link.joint, link.placement.array, given, printed, at,
            elements.get(link.name),
        )  # fmt: skip


def _hinges(robot: Robot, document: Document | None) -> Iterator[Hinge]:
    if document is None:
        links = {k.joint: k.name for k in reversed(robot.links)}
        for j in robot:
            x, single = j.limits, j.model.nq == 1
            lower, upper = (v[0] if v and single else d for v, d in ((x.lower, -inf), (x.upper, inf)))
            yield Hinge(
                j.name, j.kind, "", links.get(j, ""), j.placement.position.array, np.zeros(3), lower, upper,
                x.velocity, x.effort, x.damping, x.friction, joint=j,
            )  # fmt: skip
        return
    moving = {j.name: j for j in robot}
    elements = _named(document, "joint")
    for name, e in document.joints.items():
        limit, mimic, kind, origin = e.find("limit"), e.find("mimic"), e.get("type"), e.find("origin")
        span = limit if kind in ("revolute", "prismatic") else None
        dynamics = e.find("dynamics")
        yield Hinge(
            name, kind, e.find("parent").get("link"), e.find("child").get("link"),
            _numbers(origin, "xyz"), _numbers(origin, "rpy"), _number(span, "lower", -inf), _number(span, "upper", inf),
            _number(limit, "velocity", inf, inf), _number(limit, "effort", inf, inf),
            _number(dynamics, "damping"), _number(dynamics, "friction"), None if mimic is None else mimic.get("joint"),
            _number(mimic, "multiplier", 1.0, 1.0), _number(mimic, "offset"),
            moving.get(name), e.sourceline, elements.get(name),
        )  # fmt: skip


def _number(e: Any, attribute: str, without: float = 0.0, unsaid: float = 0.0) -> float:
    """The value of an attribute, where there is no element, or no such attribute of it."""
    return without if e is None else float(e.get(attribute) or unsaid)


def _named(document: Document, tag: str) -> dict[str, Any]:
    """The elements of the whole file by name."""
    assert document.whole is not None
    children = [e for e in document.whole if isinstance(e.tag, str) and e.prefix is None and e.tag.endswith(tag)]
    return {e.get("name", ""): e for e in children}


def _numbers(e: Any, attribute: str) -> np.ndarray:
    text = None if e is None else e.get(attribute)
    return np.zeros(3) if text is None else np.array([float(x) for x in text.split()])


def _tensor(inertial: Any) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (_number(inertial.find("inertia"), k) for k in TENSOR)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _printed(link: Any) -> float:
    """Half a unit of the last digit of the entries ixx, iyy, izz, added up."""
    e = None if link is None else link.find("inertial/inertia")
    return 0.0 if e is None else sum(half_digit(e.get(k, "")) for k in ("ixx", "iyy", "izz"))


def half_digit(text: str) -> float:
    """Half a unit of the last digit of a written number: 0.12 -> 0.005."""
    mantissa, _, exponent = text.strip().lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    try:
        return 0.5 * 10.0 ** (int(exponent or 0) - decimals)
    except (ValueError, OverflowError):
        return 0.0


def placed(X: np.ndarray) -> Pose:
    return Pose.from_matrix(X)


def finite(*values: float) -> bool:
    return all(map(isfinite, values))
