"""`Robot` to URDF; reading the file again gives the same robot."""

from __future__ import annotations

import os
import re
import warnings
from math import atan2, copysign, cos, hypot, inf, isinf, sin
from sys import float_info
from typing import Any

import numpy as np
from lxml import etree

from ..errors import ArgumentError, DualpinWarning, UrdfError
from ..files import write_text, writing
from ..model.joints import Written
from ..model.robot import STANDARD_GRAVITY, Frame, Joint, Robot, expect_numbers
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from .document import depth_first, unused
from .transmissions import REDUCTION

UNBOUNDED = 1e9  # URDF has no infinity: effort and velocity without limit
TRAVEL = 1.0  # m; URDF demands limits of every prismatic joint, see `to_urdf`
_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def to_urdf(robot: Robot, path: str | os.PathLike[str] | None = None) -> str:
    """Write the robot as a URDF file, and return its text.

    Numbers are written in full: reading the file again gives the same robot to the last digits
    (rotations pass through roll, pitch and yaw).

    Parameters
    ----------
    path : str or path, optional
        Where to write; nothing is written without it.

    Raises
    ------
    ArgumentError
        For what URDF cannot hold: helical and spherical joints, symbols, names with characters that XML cannot hold.

    Warns
    -----
    DualpinWarning
        Cylindrical joints are split into a continuous and a prismatic one with a massless link
        between; a prismatic joint without limits gets -1 m ... 1 m; a negative effort or velocity
        limit loses its sign; gravity, armature and a
        floating base (read it back with ``floating=True``) are not in the file.

    Examples
    --------
    >>> import dualpin as dp
    >>> arm = dp.from_dh([(0, 0, 0.5, 0)], joints="R", name="arm")
    >>> arm.to_urdf().splitlines()[1]
    '<robot name="arm">'
    """
    expect_numbers("to_urdf", robot)
    writer = _Writer(robot)
    return delivered(robot, writer.text(), writer.notes, path)


def delivered(robot: Robot, text: str, notes: list[str], path: str | os.PathLike[str] | None) -> str:
    """The text of a description, which is also written where a path is given; notes of what is not in it are said."""
    if notes:
        warnings.warn(f"{robot.name}: " + "; ".join(notes), DualpinWarning, stacklevel=4)
    if path is not None:
        with writing(f"{path}: cannot be written", UrdfError):
            write_text(path, text)
    return text


def roll_pitch_yaw(R: np.ndarray) -> tuple[float, float, float]:
    """The angles with R = Rz(yaw) Ry(pitch) Rx(roll), exact to rounding also where pitch is +-90 degrees.

    Each angle is read off what is left after undoing the ones before, so errors do not add up.
    """
    yaw = atan2(R[1, 0], R[0, 0]) if hypot(R[1, 0], R[0, 0]) > 4 * float_info.epsilon else 0.0
    c, s = cos(yaw), sin(yaw)
    R = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ R
    pitch = atan2(-R[2, 0], R[0, 0])
    c, s = cos(pitch), sin(pitch)
    R = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]) @ R
    return atan2(R[2, 1], R[1, 1]), pitch, yaw


def numbers(values: Any) -> str:
    """As both formats write them: all digits, and no -0."""
    return " ".join(repr(float(x) + 0.0) for x in values)


class _Writer:
    """Builds the XML tree of a robot: its frames, parents first."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.notes: list[str] = []
        self.root = etree.Element("robot", name=named(robot.name))
        self.joints: list[Any] = []
        self.links: list[Any] = []
        self.transmissions: list[Any] = []
        self.names: set[str] = {j.name for j in robot} | {f.name for f in robot.frames if f.role == "fixed_joint"}
        self.link_names: set[str] = {k.name for k in robot.links}
        self.bodies = {k.name: k.inertia for k in robot.links}

    def text(self) -> str:
        self._remarks()
        link_of: dict[int, str] = {}
        for i, frame in enumerate(self.robot.frames[1:], 1):
            if frame.role == "link":
                link_of[i] = self._link(frame.name, self.bodies.get(frame.name))
                # what is described in a joint's frame is fixed to the link that it moves
                if frame.parent and self.robot.frames[frame.parent].role != "link":
                    link_of[frame.parent] = link_of[i]
                elif not frame.parent:
                    link_of[0] = link_of[i]
        for i, frame in enumerate(self.robot.frames[1:], 1):
            self._joint_frame(i, frame, link_of)
        for element in (*self.links, *self.joints, *self.transmissions):
            self.root.append(element)
        etree.indent(self.root)
        text = etree.tostring(self.root, encoding="unicode")
        self._check_order()
        return f'<?xml version="1.0"?>\n{text}\n'

    def _remarks(self) -> None:
        g = tuple(map(float, self.robot.gravity))
        if g != STANDARD_GRAVITY:
            self.notes.append(f"gravity {g} is not in the file")
        turned = [j.name for j in self.robot if any(float(x) for x in j.armature)]
        if turned:
            self.notes.append(f"the armature of {', '.join(turned)} is not in the file")

    # links

    def _link(self, name: str, body: Inertia | None) -> str:
        link = etree.Element("link", name=named(name))
        self.links.append(link)
        self.link_names.add(name)
        if body is None:
            return name
        ten = body.array
        if not ten.any():
            return name
        m, h = ten[0], ten[1:4]
        if m == 0 and h.any():
            raise ArgumentError(f"to_urdf: link {name!r} has a first moment {h.tolist()} kg m but no mass")
        c, J = body.central
        inertia = rounded(J.array, float(np.abs(ten[4:]).max()))
        inertial = etree.SubElement(link, "inertial")
        etree.SubElement(inertial, "origin", xyz=numbers(c), rpy="0 0 0")
        etree.SubElement(inertial, "mass", value=numbers([m]))
        keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        values = inertia[np.triu_indices(3)].tolist()
        etree.SubElement(inertial, "inertia", **{k: numbers([x]) for k, x in zip(keys, values, strict=True)})
        return name

    # joints

    def _joint_frame(self, i: int, frame: Frame, link_of: dict[int, str]) -> None:
        if frame.role == "link":
            return
        joint = frame.joint if frame.role == "joint" else None
        if joint is not None and self.robot.floating and joint is self.robot.joints[0]:
            self.notes.append("the floating base is not in the file: read it with floating=True")
            return
        parent = self._parent(frame, link_of)
        above = self.robot.frames[frame.parent]
        if joint is not None:
            self._moving(joint, parent, link_of[i], above.placement.inverse @ joint.placement)
            return
        child = link_of.get(i)
        name = frame.name
        if child is None:  # a plain frame: a massless link
            child = self._link(unused(frame.name, self.link_names), None)
            name = unused(f"{frame.name}_joint", self.names)
            link_of[i] = child
        self._fixed(name, parent, child, above.placement.inverse @ frame.placement)

    def _parent(self, frame: Frame, link_of: dict[int, str]) -> str:
        if frame.parent not in link_of:
            if frame.parent == 0:  # a robot without a base link
                link_of[0] = self._link(unused("base_link", self.link_names), None)
            else:
                raise ArgumentError(
                    f"to_urdf: {frame.name!r} is fixed to {self.robot.frames[frame.parent].name!r}, which has no link"
                )
        return link_of[frame.parent]

    def _element(self, name: str, kind: str, parent: str, child: str, origin: Pose) -> Any:
        joint = etree.Element("joint", name=named(name), type=kind)
        xyz = [float(x) for x in origin.position]
        rpy = roll_pitch_yaw(origin.rotation.array)
        etree.SubElement(joint, "origin", xyz=numbers(xyz), rpy=numbers(rpy))
        etree.SubElement(joint, "parent", link=parent)
        etree.SubElement(joint, "child", link=child)
        self.joints.append(joint)
        return joint

    def _fixed(self, name: str, parent: str, child: str, origin: Pose) -> None:
        self._element(name, "fixed", parent, child, origin)

    def _moving(self, joint: Joint, parent: str, child: str, origin: Pose) -> None:
        try:
            parts = joint.model.free.written()
        except ArgumentError as e:
            raise ArgumentError(f"to_urdf: joint {joint.name!r} {e}") from None
        names = [joint.name, *(unused(f"{joint.name}{part.suffix}", self.names) for part in parts[1:])]
        if len(parts) > 1:
            into = " and ".join(
                f"{name!r} ({what})" for name, what in zip(names, joint.model.velocity_names, strict=True)
            )
            self.notes.append(f"{joint.kind} joint {joint.name!r} is split into {into}")
        if joint.rotor is not None and float(joint.rotor.ratio) != 1.0:
            self._geared(joint.name, float(joint.rotor.ratio))
        for name, part in zip(names, parts, strict=True):
            below = child if part is parts[-1] else self._link(unused(f"{child}_turned", self.link_names), None)
            self._part(joint, name, part, parent, below, origin)
            parent, origin = below, IDENTITY_POSE

    def _geared(self, name: str, ratio: float) -> None:
        e = etree.Element("transmission", name=named(f"{name}_transmission"))
        etree.SubElement(e, "type").text = "transmission_interface/SimpleTransmission"
        etree.SubElement(e, "joint", name=named(name))
        motor = etree.SubElement(e, "actuator", name=named(f"{name}_motor"))
        etree.SubElement(motor, REDUCTION).text = numbers([ratio])
        self.transmissions.append(e)

    def _part(self, joint: Joint, name: str, part: Written, parent: str, child: str, origin: Pose) -> None:
        kind, at, bounds = part.type, part.coordinate, (-inf, inf)
        if at is not None:
            free, limits = (inf,) * joint.model.nq, joint.limits
            bounds = (limits.lower or tuple(-x for x in free))[at], (limits.upper or free)[at]
        bounded = any(abs(b) < inf for b in bounds)
        if kind == "prismatic" and not bounded:
            self.notes.append(
                f"prismatic joint {name!r} has no limits, URDF demands them: -{TRAVEL:g} ... {TRAVEL:g} m written"
            )
            bounds, bounded = (-TRAVEL, TRAVEL), True
        if kind == "revolute" and not bounded:
            kind = "continuous"
        # an end without limit beside one that has some: a huge number, which counts as none
        lower, upper = (copysign(UNBOUNDED, x) if isinf(x) else x for x in bounds)
        e = self._element(name, kind, parent, child, origin)
        if part.axis is not None:
            etree.SubElement(e, "axis", xyz=numbers(part.axis))
        if at is None:
            return
        limits = joint.limits
        if bounded or limits.velocity < inf or limits.effort < inf:
            span = {"lower": numbers([lower]), "upper": numbers([upper])} if bounded else {}
            etree.SubElement(e, "limit", **span, effort=self._most(name, "effort", limits.effort),
                             velocity=self._most(name, "velocity", limits.velocity))  # fmt: skip
        if limits.damping or limits.friction:
            etree.SubElement(e, "dynamics", damping=numbers([limits.damping]), friction=numbers([limits.friction]))
        if joint.mimic is not None:
            m = joint.mimic
            etree.SubElement(
                e, "mimic", joint=m.joint, multiplier=numbers([m.multiplier]), offset=numbers([m.offset])
            )  # fmt: skip

    def _most(self, joint: str, what: str, value: float) -> str:
        """An effort or velocity limit as readers take it: not infinite, not negative."""
        if value < 0:
            self.notes.append(f"the {what} limit {value:g} of joint {joint!r} is negative: {-value:g} written")
        return numbers([min(abs(value), UNBOUNDED)])

    def _check_order(self) -> None:
        """URDF readers walk the tree depth-first, siblings by name: q may come in another order."""
        children: dict[str, list[tuple[str, str]]] = {}
        for e in self.joints:
            ends = (e.get("name"), e.find("child").get("link"))
            children.setdefault(e.find("parent").get("link"), []).append(ends)
        moved = {child for joints in children.values() for _, child in joints}
        base = next(e.get("name") for e in self.links if e.get("name") not in moved)
        wanted = [e.get("name") for e in self.joints if e.get("type") != "fixed"]
        order = [name for name in depth_first(children, base) if name in set(wanted)]
        if order != wanted:
            self.notes.append(f"readers order the joints by name: q will be {', '.join(order)}")


def rounded(J: np.ndarray, size: float) -> np.ndarray:
    """J about a centre with zeros where only the rounding of Steiner's terms, of that size, is left."""
    return np.where(np.abs(J) <= 8 * float_info.epsilon * size, 0.0, J)


def named(name: str, what: str = "to_urdf", of: str = "a URDF") -> str:
    """A name as XML can hold it."""
    if not name or _NOT_XML.search(name):
        raise ArgumentError(
            f"{what}: {name!r} is no name for {of} element: text without control characters expected, "
            "which XML cannot hold"
        )
    return name
