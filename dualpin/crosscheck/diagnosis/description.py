"""A robot as its file describes it: links and joints as plain numbers, for hypotheses to edit.

Many descriptions of one structure are built into one `Robot` whose constants are arrays, a number for
each: the algorithms then predict what all of them would give in one pass.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ...dual import Dual
from ...model.builder import Builder
from ...model.joints import Axial, Floating, Planar
from ...model.robot import Joint, Mimic, Robot
from ...scalars import Scalar, exact
from ...spatial.inertia import Inertia, steiner
from ...spatial.pose import Pose
from ...spatial.rotation import Rotation
from ...spatial.vector import ZERO_VECTOR, Matrix3, Vector3
from ..subjects.convention import base_of

NO_MOTION = np.eye(4)
ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True, eq=False)
class Body:
    """An <inertial>: mass, centre of mass and inertia about it, in axes that are turned by `rotation`."""

    mass: float
    com: np.ndarray
    rpy: np.ndarray
    rotation: np.ndarray
    inertia: np.ndarray

    @property
    def in_link(self) -> np.ndarray:
        """The inertia about the centre of mass in the link's axes."""
        return np.asarray(self.rotation @ self.inertia @ self.rotation.T)

    def turned(self, inertia: np.ndarray) -> Body:
        """The same body with this inertia, given in the link's axes."""
        return replace(self, rotation=np.eye(3), inertia=inertia)

    @property
    def parameters(self) -> np.ndarray:
        """Mass, first moment, and inertia about the centre in the link's axes: what tells two bodies apart."""
        return np.concatenate([[self.mass], self.mass * self.com, self.in_link.ravel()])


@dataclass(frozen=True, eq=False)
class Part:
    """A joint, and the link that it carries."""

    joint: str
    type: str
    """As the file says it: revolute, continuous, prismatic, fixed, planar or floating."""
    parent: str
    link: str
    position: np.ndarray
    rpy: np.ndarray
    rotation: np.ndarray
    axis: np.ndarray | None
    body: Body | None
    damping: float = 0.0
    friction: float = 0.0
    mimic: Mimic | None = None
    armature: tuple[float, ...] = ()
    rate: float = 1.0
    """How far it turns or slides where its coordinate is 1; 0 where it does not move."""
    after: np.ndarray = field(default_factory=lambda: NO_MOTION)
    """Where the link stands on what the joint moves."""
    more: np.ndarray = field(default_factory=lambda: np.zeros(10))
    """Inertial parameters to add, about the joint's moving frame, in the order of `Inertia.parameters`."""

    @property
    def moves(self) -> bool:
        return self.type != "fixed"

    @property
    def turns(self) -> bool:
        return self.type in ("revolute", "continuous")

    @property
    def slides(self) -> bool:
        return self.type == "prismatic"

    @property
    def axial(self) -> bool:
        """Whether it moves about or along one axis."""
        return self.turns or self.slides

    @property
    def pose(self) -> np.ndarray:
        return homogeneous(self.rotation, self.position)

    def placed(self, H: np.ndarray) -> Part:
        """The same joint with its origin there."""
        return replace(self, rotation=H[:3, :3], position=H[:3, 3])

    @property
    def unit_axis(self) -> np.ndarray:
        axis = np.array([1.0, 0.0, 0.0]) if self.axis is None else self.axis
        return np.asarray(axis / np.linalg.norm(axis))

    @property
    def numbers(self) -> np.ndarray:
        """Everything an edit can change of the joint."""
        unit = [0.0, self.rate] if self.slides else [self.rate, 0.0]
        axis = self.unit_axis if self.axial else np.zeros(3)
        follows = [] if self.mimic is None else [self.mimic.multiplier, self.mimic.offset]
        return np.concatenate([self.pose.ravel(), self.after.ravel(), axis, unit, self.armature, self.more, follows])


@dataclass(frozen=True, eq=False)
class Description:
    """The root link and the parts, parents first, in the order of the robot's frames."""

    root: str
    base: Body | None
    parts: tuple[Part, ...]
    gravity: tuple[float, float, float]
    listed: tuple[str, ...] = ()
    """The joints as the file lists them."""
    links: tuple[str, ...] = ()
    """The links as the file lists them."""
    mimics: dict[str, tuple[str, float, float]] = field(default_factory=dict)
    """Of each joint with <mimic>: its leader, multiplier and offset."""

    def part_of_link(self, link: str) -> Part | None:
        return next((p for p in self.parts if p.link == link), None)

    @cached_property
    def home(self) -> dict[str, np.ndarray]:
        """The pose of every link where all coordinates are zero, in the root's frame."""
        found = {self.root: np.eye(4)}
        for p in self.parts:
            found[p.link] = found[p.parent] @ p.pose @ p.after
        return found

    def carriers(self) -> dict[str, str]:
        """For every link: the link that it is fixed to and that a joint moves (or the root)."""
        return {link: carrier for link, (carrier, _) in self.carried().items()}

    def carried(self) -> dict[str, tuple[str, np.ndarray]]:
        """For every link: the link that it is fixed to and that a joint moves (or the root), and its pose there."""
        found = {self.root: (self.root, np.eye(4))}
        for p in self.parts:
            carrier, H = found[p.parent]
            found[p.link] = (p.link, np.eye(4)) if p.moves else (carrier, H @ p.pose)
        return found

    def with_bodies(self, f: Callable[[Body], Body | None], items: Sequence[str] = ()) -> Description:
        """f of every link's body, or of those in `items`."""

        def edited(link: str, body: Body | None) -> Body | None:
            return body if body is None or (items and link not in items) else f(body)

        parts = tuple(replace(p, body=new) if (new := edited(p.link, p.body)) is not p.body else p for p in self.parts)
        return replace(self, base=edited(self.root, self.base), parts=parts)

    def with_parts(self, f: Callable[[Part, Description], Part], items: Sequence[str] = ()) -> Description:
        """f of every joint, or of those in `items`."""
        return replace(self, parts=tuple(f(p, self) if not items or p.joint in items else p for p in self.parts))

    def with_tree(self, parts: Sequence[Part]) -> Description:
        """With these parts, whose parents may be others, parents first.  Raises ValueError for a circle."""
        order, known, left = list[Part](), {self.root}, list(parts)
        while left:
            if (ready := next((p for p in left if p.parent in known), None)) is None:
                raise ValueError(f"a circle of links: {', '.join(p.link for p in left)}")
            order.append(ready)
            known.add(ready.link)
            left.remove(ready)
        return replace(self, parts=tuple(order))

    @cached_property
    def nests(self) -> bool:
        """Whether a fixed link carries another one."""
        fixed = [p for p in self.parts if not p.moves]
        return bool({p.parent for p in fixed} & {p.link for p in fixed})

    @cached_property
    def tree(self) -> tuple[tuple[str, str], ...]:
        """Which links hang on which: descriptions are built together where it is the same."""
        return tuple((p.link, p.parent) for p in self.parts)

    @cached_property
    def joints(self) -> tuple[tuple[Any, ...], ...]:
        """What coordinates belong to: robots have the same ones where it is equal."""
        return tuple((p.joint, p.type, p.parent, p.link, p.mimic) for p in self.parts)


def merged(d: Description) -> Description:
    """The same robot with the inertia of fixed links carried over to the links that joints move."""
    where = d.carried()
    pieces: dict[str, list[tuple[float, np.ndarray, np.ndarray]]] = {}
    for link, body in [(d.root, d.base), *((p.link, p.body) for p in d.parts)]:
        carrier, H = where[link]
        if body is not None:
            R, c = H[:3, :3], (H @ np.append(body.com, 1.0))[:3]
            pieces.setdefault(carrier, []).append((body.mass, c, R @ body.in_link @ R.T))
    if all(p.moves or p.body is None for p in d.parts):
        return d
    bodies = {link: lump(group) for link, group in pieces.items()}
    parts = tuple(replace(p, body=bodies.get(p.link)) for p in d.parts)
    return replace(d, base=bodies.get(d.root), parts=parts)


def lump(group: Sequence[tuple[float, np.ndarray, np.ndarray]]) -> Body:
    """One body of several: masses, centres and inertias about these in common axes."""
    mass = sum(m for m, _, _ in group)
    com = sum((m * c for m, c, _ in group), np.zeros(3)) / (mass or 1.0)
    inertia = sum((I + steiner(m, c - com) for m, c, I in group), np.zeros((3, 3)))
    return Body(mass, com, np.zeros(3), np.eye(3), inertia)


def homogeneous(R: np.ndarray, p: np.ndarray) -> np.ndarray:
    H = np.eye(4)
    H[:3, :3], H[:3, 3] = R, p
    return H


def turn(axis: int, angle: float) -> np.ndarray:
    """Rotation about a coordinate axis."""
    c, s, R = np.cos(angle), np.sin(angle), np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[i, i] = R[j, j] = c
    R[j, i], R[i, j] = s, -s
    return R


def fixed_axes(rpy: Sequence[float] | np.ndarray) -> np.ndarray:
    """Rz(yaw) Ry(pitch) Rx(roll), zeros and ones exact."""
    roll, pitch, yaw = rpy
    R = turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
    near = np.round(R)
    return np.where(np.abs(R - near) <= 1e-15, near, R)


# --- building ------------------------------------------------------------------------------------


def built(descriptions: Sequence[Description], like: Robot) -> Robot:
    """One robot of all descriptions: a constant that differs among them is an array (n, 1)."""
    b, first = Builder(like.name), descriptions[0]
    base = _inertia([d.base for d in descriptions])
    if (free := base_of(like)) is not None:
        b.joint(free.name, Floating(), inertia=base, link=first.root)
    else:
        b.base(first.root, base)
    for same in zip(*(d.parts for d in descriptions), strict=True):
        _add(b, _few(same))
    robot = replace(b.robot(), gravity=_vector(np.array([d.gravity for d in descriptions])))
    return robot if [j.name for j in robot] == [j.name for j in like] else _numbered(robot, like)


def _numbered(robot: Robot, like: Robot) -> Robot:
    """With the coordinates that the joints have in another robot, where they stand in another order."""
    where, made = {j.name: j for j in like}, dict[str, Joint]()
    for j in robot:
        parent = None if j.parent is None else made[j.parent.name]
        made[j.name] = replace(j, q=where[j.name].q, v=where[j.name].v, parent=parent)

    def on_joints(some: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(x if x.joint is None else replace(x, joint=made[x.joint.name]) for x in some)

    frames, links = on_joints(robot.frames), on_joints(robot.links)
    return replace(robot, joints=tuple(made.values()), frames=frames, links=links)


def _few(parts: Sequence[Part]) -> Sequence[Part]:
    """One part where all are the same."""
    return parts[:1] if all(p is parts[0] for p in parts) else parts


def _add(b: Builder, parts: Sequence[Part]) -> None:
    p = parts[0]
    placement = _pose(np.array([x.pose for x in parts]))
    inertia = _inertia([x.body for x in parts])
    if not p.moves:
        b.fixed(p.joint, p.parent, placement, inertia, link=p.link)
        return
    after = np.array([x.after for x in parts])
    moved = (after != NO_MOTION).any()
    # a link that stands apart from what its joint moves is fixed there
    b.joint(
        p.joint, _model(parts), p.parent, placement, None if moved else inertia,
        link=f"{p.link} moved" if moved else p.link, mimic=_following(parts), armature=_armature(parts),
    )  # fmt: skip
    if moved:
        b.fixed(f"{p.joint} to {p.link}", f"{p.link} moved", _pose(after), inertia, link=p.link)
    more = np.array([x.more for x in parts])
    if more.any():
        on = f"{p.link} moved" if moved else p.link
        b.fixed(f"{p.joint} more", on, inertia=_ten(more), link=f"{p.link} more")


def _following(parts: Sequence[Part]) -> Mimic | None:
    first = parts[0].mimic
    if first is None or all(x.mimic is first for x in parts):
        return first
    of = np.array([(x.mimic.multiplier, x.mimic.offset) for x in parts if x.mimic is not None])
    return Mimic(first.joint, _scalar(of[:, 0]), _scalar(of[:, 1]))


def _armature(parts: Sequence[Part]) -> tuple[Scalar, ...]:
    values = np.array([x.armature for x in parts])
    return tuple(_scalar(values[:, i]) for i in range(values.shape[1])) if values.any() else ()


def _model(parts: Sequence[Part]) -> Any:
    first = parts[0]
    if first.type == "planar":
        return Planar()
    if first.type == "floating":
        return Floating()
    axis = np.array([x.unit_axis for x in parts])
    unit = np.array([[0.0, x.rate] if x.slides else [x.rate, 0.0] for x in parts])
    what = ("length",) if first.slides else ("angle",)
    return Axial(_vector(axis), Dual(_scalar(unit[:, 0]), _scalar(unit[:, 1])), kind=first.type, coordinates=what)


def _inertia(bodies: Sequence[Body | None]) -> Inertia | None:
    if all(x is None for x in bodies):
        return None
    if all(x is bodies[0] for x in bodies):
        bodies = bodies[:1]
    known = [x if x is not None else _NOTHING for x in bodies]
    X = _pose(np.array([homogeneous(x.rotation, x.com) for x in known]))
    I = np.array([x.inertia for x in known])
    about_com = Inertia(
        _scalar(np.array([x.mass for x in known])), ZERO_VECTOR, Matrix3(*(_vector(I[:, r]) for r in range(3)))
    )
    found: Inertia = X @ about_com
    return found


_NOTHING = Body(0.0, np.zeros(3), np.zeros(3), np.eye(3), np.zeros((3, 3)))


def _ten(parameters: np.ndarray) -> Inertia:
    m, hx, hy, hz, xx, xy, yy, xz, yz, zz = (_scalar(parameters[:, i]) for i in range(10))
    return Inertia(m, Vector3(hx, hy, hz), Matrix3(Vector3(xx, xy, xz), Vector3(xy, yy, yz), Vector3(xz, yz, zz)))


def _pose(H: np.ndarray) -> Pose:
    return Pose(Rotation(*(_vector(H[:, r, :3]) for r in range(3))), _vector(H[:, :3, 3]))


def _vector(x: np.ndarray) -> Vector3:
    return Vector3(*(_scalar(x[:, i]) for i in range(3)))


def _scalar(x: np.ndarray) -> Scalar:
    """A number where all are the same, else a column of them."""
    return exact(float(x[0])) if (x == x[0]).all() else x[:, None]
