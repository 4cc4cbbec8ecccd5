"""`Robot` to MJCF: a tree of bodies for MuJoCo, which compiles it to the same mechanics.

A moving frame is a body, with the joint at its origin; what is fixed to it is a body without a joint.  Numbers are
written in full, tensors as principal moments and a quaternion, since MuJoCo's own decomposition stops at 1e-12.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from math import inf
from typing import Any

import numpy as np
from lxml import etree

from ..dual import Dual
from ..errors import ArgumentError
from ..model.joints import Axial
from ..model.robot import Frame, Joint, Robot
from ..scalars import ZERO
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from .document import unused
from .write import delivered, named, numbers, rounded

WORLD = "world"  # MuJoCo's name for the ground
LEAST = 1e-15  # mjMINVAL: a moving body needs more mass, and larger moments, than this
ROUNDING = 1e-9  # of a triangle inequality that holds with equality, as for a plate


_named = partial(named, what="to_mjcf", of="an MJCF")


def to_mjcf(robot: Robot, path: str | os.PathLike[str] | None = None) -> str:
    """Write the robot as an MJCF file, and return its text.

    Parameters
    ----------
    path : str or path, optional
        Where to write; nothing is written without it.

    Returns
    -------
    str
        MuJoCo's q and v have the same columns in the same order (of a floating base MuJoCo's v is linear
        first, in the axes of the world).

    Raises
    ------
    ArgumentError
        For what MuJoCo does not take: helical joints, planar ones (their velocities are the body's), floating
        ones within the tree, moving bodies without mass, tensors that no body has.

    Warns
    -----
    DualpinWarning
        Velocity limits are not in the file; a joint that follows another is coupled by an equality, which
        MuJoCo holds softly.

    Examples
    --------
    >>> import dualpin as dp
    >>> text = dp.load("ur5").to_mjcf()
    >>> '<joint name="elbow_joint"' in text
    True
    >>> dp.loads(text).joint_names == dp.load("ur5").joint_names
    True
    """
    writer = _Writer(robot)
    return delivered(robot, writer.text(), writer.notes, path)


class _Writer:
    """Builds the XML tree: frames in their order, so parents come first."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.notes: list[str] = []
        self.root = etree.Element("mujoco", model=_named(robot.name))
        # nothing is to be guessed, filled in or merged
        etree.SubElement(
            self.root, "compiler", angle="radian", autolimits="true", fusestatic="false", balanceinertia="false",
            boundmass="0", boundinertia="0", inertiafromgeom="false",
        )  # fmt: skip
        etree.SubElement(self.root, "option", gravity=numbers(robot.gravity))
        self.world = etree.SubElement(self.root, "worldbody")
        self.equalities: list[Any] = []
        self.bodies = {k.name: k.inertia for k in robot.links}
        self.element: dict[int, Any] = {0: self.world}
        """Frame -> the element that what is described in it goes into."""
        self.names: set[str] = {k.name for k in robot.links} | {WORLD}

    def text(self) -> str:
        if self.robot.numbers == "symbolic":
            raise ArgumentError(f"to_mjcf: the constants of {self.robot.name} are symbols")
        moved = {j.index: self._link_of(j) for j in self.robot}
        for i, frame in enumerate(self.robot.frames[1:], 1):
            if frame.role == "joint" and frame.joint is not None:
                self._moving(i, frame, moved[frame.joint.index])
            elif i not in self.element:
                self._still(i, frame)
        self._refuse_the_weightless()
        if any(j.limits.velocity < inf for j in self.robot):
            self.notes.append("velocity limits are not in the file: MJCF has none")
        if self.equalities:
            self.root.append(e := etree.Element("equality"))
            e.extend(self.equalities)
        etree.indent(self.root)
        return str(etree.tostring(self.root, encoding="unicode")) + "\n"

    # bodies

    def _link_of(self, joint: Joint) -> tuple[int, Frame] | None:
        """The link whose frame is the joint's moving frame."""
        frames = self.robot.frames
        for i, f in enumerate(frames):
            if f.role == "link" and f.joint is joint and frames[f.parent].role == "joint" and _is_identity(f.placement):
                return i, f
        return None

    def _moving(self, i: int, frame: Frame, link: tuple[int, Frame] | None) -> None:
        joint = frame.joint
        assert joint is not None
        above = self.robot.frames[frame.parent]
        X = above.placement.inverse @ joint.placement
        on = self.element[frame.parent]
        if joint.model.coordinates == FLOATING:
            if on is not self.world:
                raise ArgumentError(
                    f"to_mjcf: joint {joint.name!r} floats within the tree; MuJoCo has that in the world"
                )
            X = IDENTITY_POSE  # the coordinates of a free body are its pose in the world
            if not _is_identity(joint.placement):
                raise ArgumentError(f"to_mjcf: joint {joint.name!r} floats in another frame than the world's")
        name = link[1].name if link else unused(joint.name, self.names)
        offset = getattr(joint.model.free, "offset", None)
        if offset is not None and isinstance(joint.model, Axial):
            X = X @ Pose.about(joint.model.axis, Dual(float(offset.real) or ZERO, float(offset.dual) or ZERO))
        body = self._body(on, name, X, self.bodies.get(name) if link else None)
        self.element[i] = body
        if link:
            self.element[link[0]] = body
        for e in self._joints(joint):
            body.insert(0 if e.tag == "freejoint" else len(body), e)

    def _still(self, i: int, frame: Frame) -> None:
        """A link or a frame that is fixed in another: a body without a joint, or a site."""
        above = self.robot.frames[frame.parent]
        same = (above.placement.array == frame.placement.array).all()
        X = IDENTITY_POSE if same else above.placement.inverse @ frame.placement
        on = self.element[frame.parent]
        if frame.role == "link":
            if on is self.world and frame.name == WORLD and _is_identity(X) and self.bodies[frame.name].massless:
                self.element[i] = on
                return
            if on.get("name") is None and _is_identity(X) and on is not self.world:
                on.set("name", frame.name)  # the body of the fixed joint that carries it
                self._inertial(on, frame.name, self.bodies[frame.name])
                self.element[i] = on
                return
            self.element[i] = self._body(on, frame.name, X, self.bodies[frame.name])
        elif frame.role == "fixed_joint":
            self.element[i] = self._body(on, None, X, None)
        else:
            self.element[i] = on
            etree.SubElement(on, "site", name=_named(frame.name), **_pose(X))

    def _body(self, on: Any, name: str | None, X: Pose, inertia: Inertia | None) -> Any:
        named = {} if name is None else {"name": _named(name)}
        body = etree.SubElement(on, "body", **named, **_pose(X))
        if inertia is not None:
            self._inertial(body, name or "", inertia)
        return body

    def _inertial(self, body: Any, name: str, inertia: Inertia) -> None:
        ten = inertia.array
        if not ten.any():
            return
        com, J = inertia.central
        central = rounded(J.array, float(np.abs(ten[4:]).max()))
        moments, axes = np.linalg.eigh(central)
        size = float(np.abs(moments).max())
        if moments[0] < -ROUNDING * size or moments[0] + moments[1] < moments[2] * (1 - ROUNDING):
            raise ArgumentError(
                f"to_mjcf: link {name!r} has the principal moments {', '.join(f'{x:.3g}' for x in moments)} kg m^2, "
                "which no body has, and MuJoCo refuses; `dualpin check` says what may be wrong"
            )
        if ten[0] <= 0:
            raise ArgumentError(f"to_mjcf: link {name!r} has a rotational inertia but no mass; MuJoCo wants both")
        if np.linalg.det(axes) < 0:
            axes[:, 0] = -axes[:, 0]
        if not (central - np.diag(np.diag(central))).any():
            moments, axes = np.diag(central), np.eye(3)
        X = np.eye(4)
        X[:3, :3] = axes
        body.insert(0, etree.Element(
            "inertial", pos=numbers(com), quat=_quaternion(Pose.from_matrix(X)), mass=numbers([ten[0]]),
            diaginertia=numbers(np.maximum(moments, 0.0)),
        ))  # fmt: skip

    # joints

    def _joints(self, joint: Joint) -> Iterator[Any]:
        model, limits = joint.model.free, joint.limits
        if model.coordinates == FLOATING:
            armature = self._one(joint)
            yield etree.Element("joint", name=_named(joint.name), type="free", **armature)
            return
        if model.coordinates == BALL:
            yield etree.Element(
                "joint", name=_named(joint.name), type="ball", **self._one(joint), **self._passive(joint)
            )
            return
        if not isinstance(model, Axial):
            raise ArgumentError(
                f"to_mjcf: joint {joint.name!r} is {model.kind}, and MuJoCo has no such joint; two slides and a hinge "
                "move alike, but have other velocities"
            )
        axis = [float(x) for x in model.axis]
        for k, unit in enumerate(model.units):
            turn, slide = float(unit.real), float(unit.dual)
            if (turn and slide) or abs(abs(turn + slide) - 1) > LEAST:
                raise ArgumentError(f"to_mjcf: joint {joint.name!r} is {model.kind}, and MuJoCo has no such joint")
            sign = turn + slide
            name = joint.name if k == 0 else f"{joint.name}_slide"
            e = etree.Element(
                "joint", name=_named(name), type="slide" if slide else "hinge",
                axis=numbers([sign * x for x in axis]), **self._passive(joint),
            )  # fmt: skip
            if joint.armature and float(joint.armature[k]):
                e.set("armature", numbers([joint.armature[k]]))
            bounds = (limits.lower or (-inf,) * model.nq)[k], (limits.upper or (inf,) * model.nq)[k]
            if bounds[0] < bounds[1] and bounds != (-inf, inf):
                e.set("range", numbers(np.clip(bounds, -1e9, 1e9)))
            elif bounds[0] >= bounds[1]:
                self.notes.append(f"the limits of joint {joint.name!r} leave no range, none is written")
            if 0 < limits.effort < inf:
                e.set("actuatorfrcrange", numbers([-limits.effort, limits.effort]))
            yield e
        if joint.mimic is not None:
            self._coupled(joint)

    def _coupled(self, joint: Joint) -> None:
        leader = next(j.name for j in self.robot if j.mimic is None and j.q == joint.q)
        multiplier, offset = map(float, joint.coupling)
        self.notes.append(f"joint {joint.name!r} follows {leader!r} by an equality, which MuJoCo holds softly")
        self.equalities.append(
            etree.Element("joint", name=_named(f"{joint.name}_follows"), joint1=joint.name, joint2=leader,
                          polycoef=numbers([offset, multiplier, 0, 0, 0]))
        )  # fmt: skip

    def _one(self, joint: Joint) -> dict[str, str]:
        """The armature of a joint whose freedoms share one in MJCF."""
        values = {float(x) for x in joint.armature} or {0.0}
        if len(values) > 1:
            raise ArgumentError(f"to_mjcf: joint {joint.name!r} has {len(values)} armatures; MuJoCo has one for all")
        (value,) = values
        return {"armature": numbers([value])} if value else {}

    def _passive(self, joint: Joint) -> dict[str, str]:
        found = {"damping": joint.damping, "frictionloss": joint.friction}
        return {key: numbers([x]) for key, x in found.items() if x}

    def _refuse_the_weightless(self) -> None:
        """MuJoCo takes a moving body only if it, or what is fixed to it, has mass and inertia."""
        for body in self.world.iter("body"):
            if body.find("joint") is not None and not _weighs(body):
                joint = body.find("joint").get("name")
                raise ArgumentError(
                    f"to_mjcf: body {body.get('name')!r} moves on joint {joint!r} and has no mass and inertia, which "
                    "MuJoCo refuses; give its link an inertial"
                )


FLOATING = ("length",) * 3 + ("quaternion",) * 4
BALL = ("quaternion",) * 4


def _weighs(body: Any) -> bool:
    inertial = body.find("inertial")
    if inertial is not None:
        moments = [float(x) for x in inertial.get("diaginertia").split()]
        if float(inertial.get("mass")) > LEAST and all(x > LEAST for x in moments):
            return True
    return any(_weighs(child) for child in body.findall("body") if child.find("joint") is None)


def _is_identity(X: Pose) -> bool:
    return bool((X.array == np.eye(4)).all())


def _pose(X: Pose) -> dict[str, str]:
    """Without the entries that are zero."""
    found = {}
    if any(float(x) for x in X.position):
        found["pos"] = numbers(X.position)
    if not (X.rotation.array == np.eye(3)).all():
        found["quat"] = _quaternion(X)
    return found


def _quaternion(X: Pose) -> str:
    r = X.quaternion.real
    return numbers([r.w, *r.v])
