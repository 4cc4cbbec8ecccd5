"""Build a robot joint by joint, parents first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import inf

from ..errors import ArgumentError, FrameNotFoundError, nearest
from ..scalars import ZERO, Scalar, exact
from ..spatial.inertia import ZERO_INERTIA, Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from .joints import Axial, JointModel
from .limits import remarks
from .robot import STANDARD_GRAVITY, Frame, Joint, Limits, Link, Mimic, Robot, Rotor, expect_robot, gravity_vector


@dataclass
class _Part:
    """A joint under construction."""

    name: str
    model: JointModel
    parent: str | None
    placement: Pose
    inertia: Inertia
    limits: Limits
    mimic: Mimic | None
    armature: tuple[Scalar, ...]
    rotor: Rotor | None = None
    passive: bool = False


@dataclass
class _Place:
    """Where a link, a joint or a frame is fixed: on which joint's body, and how."""

    joint: str | None
    placement: Pose
    frame: int = field(default=0)


class Builder:
    """Collects joints, links and frames; `robot()` turns them into an immutable `Robot`.

    Things are fixed to a named *link* or *joint*, or to the ground (None).  A joint carries the
    link of `link=` (by default one of the joint's own name) at its moving frame.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.model import Builder, revolute
    >>> from dualpin.spatial import Pose, Vector3
    >>> b = Builder("pendulum")
    >>> b.joint("hinge", revolute())
    >>> b.frame("tip", on="hinge", placement=Pose(position=Vector3(1.0, 0.0, 0.0)))
    >>> b.robot().nv
    1
    """

    def __init__(self, name: str, gravity: Sequence[float] = STANDARD_GRAVITY) -> None:
        self.name = name
        self.gravity = gravity_vector(gravity)
        self.notes: list[str] = []
        self.source: str | None = None
        self._parts: dict[str, _Part] = {}
        # a link and a joint may share a name; things are then fixed to the link
        self._link_places: dict[str, _Place] = {}
        self._places: dict[str, _Place] = {"universe": _Place(None, IDENTITY_POSE)}
        self._frames: list[tuple[str, str, str | None, Pose, int]] = [("universe", "universe", None, IDENTITY_POSE, 0)]
        self._links: list[tuple[str, Inertia, str | None, Pose]] = []

    @classmethod
    def of(cls, robot: Robot) -> Builder:
        """A builder that already holds all of a robot, to add to it."""
        expect_robot("Builder.of", robot)
        b = cls(robot.name)
        b.gravity, b.notes, b.source = robot.gravity, list(robot.notes), robot.source
        b.include(robot)
        return b

    def include(
        self, robot: Robot, on: str | Frame | None = None, placement: Pose = IDENTITY_POSE, *, prefix: str = ""
    ) -> None:
        """Add all of another robot, its ground fixed in the frame `on`; `prefix` is added before each of its names."""
        expect_robot("include", robot)
        _check_types(robot.name, placement, None)
        self._check_new_names(robot, prefix)
        at, first = self._place(on), len(self._frames) - 1
        ground = at.placement @ placement

        def named(joint: Joint | None) -> str | None:
            return at.joint if joint is None else prefix + joint.name

        def placed(joint: Joint | None, X: Pose) -> Pose:
            return ground @ X if joint is None else X

        for j in robot:
            name, mimic = prefix + j.name, j.mimic and replace(j.mimic, joint=prefix + j.mimic.joint)
            self._parts[name] = _Part(
                name, j.model.free, named(j.parent), placed(j.parent, j.placement), j.inertia, j.limits, mimic,
                j.armature, j.rotor, j.passive,
            )  # fmt: skip
        for f in robot.frames[1:]:
            X, parent = placed(f.joint, f.placement), first + f.parent if f.parent else at.frame
            self._frames.append((prefix + f.name, f.role, named(f.joint), X, parent))
            places = self._link_places if f.role == "link" else self._places
            places[prefix + f.name] = _Place(named(f.joint), X, len(self._frames) - 1)
        for k in robot.links:
            X = placed(k.joint, k.placement)
            self._links.append((prefix + k.name, k.inertia, named(k.joint), X))
            if k.joint is None and at.joint is not None:  # frames on its ground now move with the carrying body
                self._parts[at.joint].inertia = self._parts[at.joint].inertia + X @ k.inertia

    def _check_new_names(self, robot: Robot, prefix: str) -> None:
        links = [k.name for k in robot.links if prefix + k.name in self._link_places]
        others = [f.name for f in robot.frames[1:] if f.role != "link" and prefix + f.name in self._places]
        if links or others:
            both = ", ".join(map(repr, dict.fromkeys([*others, *links])))
            raise ArgumentError(
                f"{robot.name} and {self.name} both have the names {both}; prefix='...' sets other names apart"
            )

    def joint(
        self,
        name: str,
        model: JointModel,
        on: str | Frame | None = None,
        placement: Pose = IDENTITY_POSE,
        inertia: Inertia | None = None,
        *,
        link: str | None = None,
        limits: Limits | None = None,
        mimic: Mimic | None = None,
        armature: Sequence[Scalar] = (),
        rotor: Rotor | None = None,
        passive: bool = False,
    ) -> None:
        """A joint whose fixed side has the pose `placement` in the frame `on`, and the link it moves.

        A `rotor` adds its reflected inertia to the armature, and its body to the link `on`.
        `passive` says that there is no motor.
        """
        self._unused(name)
        _check_types(name, placement, inertia, model)
        _check_counts(name, model, limits, armature)
        at = self._place(on)
        X = at.placement @ placement
        self._parts[name] = _Part(
            name, model, at.joint, X, ZERO_INERTIA, limits or Limits(), mimic,
            tuple(map(exact, armature)) or (ZERO,) * model.nv, None, passive,
        )  # fmt: skip
        if rotor is not None:
            self._motor(name, rotor, _Place(at.joint, X, at.frame))
        self._frames.append((name, "joint", name, IDENTITY_POSE, at.frame))
        place = _Place(name, IDENTITY_POSE, len(self._frames) - 1)
        self._places[name] = place
        self._link(link or name, inertia, place)

    def motor(self, joint: str, rotor: Rotor) -> None:
        """Set or replace the motor of an existing joint; its reflected inertia becomes the joint's armature."""
        part = self._parts[joint]
        carried = part.rotor.body if part.rotor else None
        if carried is not None and rotor.body is not carried:
            raise ArgumentError(f"joint {joint!r} has a rotor with a body already; another has to have the same")
        part.armature = (ZERO,) * part.model.nv
        _, _, _, _, described_in = self._frames[self._places[joint].frame]
        new = replace(rotor, body=None) if carried is not None else rotor  # its body was added before
        self._motor(joint, new, _Place(part.parent, part.placement, described_in))
        part.rotor = rotor

    def _motor(self, name: str, rotor: Rotor, at: _Place) -> None:
        part = self._parts[name]
        if part.model.nv != 1:
            raise ArgumentError(
                f"joint {name!r}: a rotor belongs to a joint of one coordinate, not to a {part.model.kind} one"
            )
        for what, x, wrong in (("inertia", rotor.inertia, _negative), ("ratio", rotor.ratio, _nought)):
            if wrong(x):
                raise ArgumentError(f"joint {name!r}: {what} of its rotor is {x}")
        part.rotor = rotor
        part.armature = (exact(part.armature[0] + rotor.reflected),)
        if rotor.body is not None:
            self._link(f"{name}_rotor", rotor.body, at)

    def fixed(
        self,
        name: str,
        on: str | Frame | None = None,
        placement: Pose = IDENTITY_POSE,
        inertia: Inertia | None = None,
        *,
        link: str | None = None,
    ) -> None:
        """A fixed joint: its link's inertia joins the body that carries it.

        It may have the name of a floating base's joint; frames are then distinguished by their role, as in Pinocchio.
        """
        if not (name in self._parts and self._parts[name].model.kind == "floating"):
            self._unused(name)
        _check_types(name, placement, inertia)
        at = self._place(on)
        X = at.placement @ placement
        self._frames.append((name, "fixed_joint", at.joint, X, at.frame))
        place = _Place(at.joint, X, len(self._frames) - 1)
        self._places.setdefault(name, place)
        self._link(link or name, inertia, place)

    def base(self, name: str, inertia: Inertia | None = None) -> None:
        """The root link of a robot whose base is fixed to the ground."""
        self._link(name, inertia, _Place(None, IDENTITY_POSE))

    def frame(self, name: str, on: str | Frame | None = None, placement: Pose = IDENTITY_POSE) -> None:
        """A named frame without a body."""
        self._unused(name)
        _check_types(name, placement, None)
        at = self._place(on)
        X = at.placement @ placement
        self._frames.append((name, "frame", at.joint, X, at.frame))
        self._places[name] = _Place(at.joint, X, len(self._frames) - 1)

    def _link(self, name: str, inertia: Inertia | None, at: _Place) -> None:
        if name in self._link_places:
            raise ArgumentError(f"link {name!r} of {self.name} is defined twice; links: {', '.join(self._link_places)}")
        body = ZERO_INERTIA if inertia is None else inertia
        if inertia is not None and at.joint is not None:
            part = self._parts[at.joint]
            part.inertia = part.inertia + at.placement @ body
        self._links.append((name, body, at.joint, at.placement))
        self._frames.append((name, "link", at.joint, at.placement, at.frame))
        self._link_places[name] = _Place(at.joint, at.placement, len(self._frames) - 1)

    def _unused(self, name: str) -> None:
        """Refuse a name that another joint or frame has; a link may have the same name."""
        if name in self._places:
            raise ArgumentError(f"joint or frame {name!r} of {self.name} is defined twice")

    def _place(self, on: str | Frame | None) -> _Place:
        if on is None:
            return _Place(None, IDENTITY_POSE)
        if isinstance(on, Frame):  # of the robot that this builder holds
            index = self._places.get(on.name) if on.role != "link" else self._link_places.get(on.name)
            return _Place(on.joint.name if on.joint else None, on.placement, index.frame if index else on.parent)
        place = self._link_places.get(on) or self._places.get(on)
        if place is None:
            names = [*self._link_places, *self._places]
            raise FrameNotFoundError(f"{on!r} is not in {self.name} yet; {nearest(on, names, 'frames')}")
        return place

    def robot(self) -> Robot:
        """The finished robot.  Raises `ArgumentError` for a mimic joint without a valid leader."""
        where: dict[str, tuple[slice, slice]] = {}
        nq = nv = 0
        for part in self._parts.values():
            if part.mimic is None:
                model = part.model
                where[part.name] = slice(nq, nq + model.nq), slice(nv, nv + model.nv)
                nq, nv = nq + model.nq, nv + model.nv
        joints: dict[str | None, Joint | None] = {None: None}
        for index, part in enumerate(self._parts.values()):
            source, model = part.name, part.model
            if part.mimic is not None:
                source, multiplier, offset = self._followed(part)
                model = model.following(multiplier, offset)
            q, v = where[source]
            joints[part.name] = Joint(
                part.name, model, joints[part.parent], part.placement, part.inertia, q, v, index,
                part.limits, part.mimic, part.armature, part.rotor, part.passive,
            )  # fmt: skip
        robot = Robot(
            self.name,
            tuple(j for j in joints.values() if j is not None),
            tuple(Frame(n, kind, joints[j], X, parent) for n, kind, j, X, parent in self._frames),
            tuple(Link(n, body, joints[j], X) for n, body, j, X in self._links),
            self.gravity,
            tuple(self.notes),
            self.source,
        )
        # a robot built on another one already has its notes
        return replace(robot, notes=tuple(dict.fromkeys([*self.notes, *remarks(robot)])))

    def _followed(self, part: _Part) -> tuple[str, float, float]:
        """The last leader of a chain of mimic joints, with the multiplier and offset of the whole chain."""
        multiplier, offset = 1.0, 0.0
        seen: list[str] = []
        while part.mimic is not None:
            here = f"joint {part.name!r} mimics {part.mimic.joint!r}"
            if not isinstance(part.model, Axial) or part.model.nq != 1:
                raise ArgumentError(f"{here}, but a {part.model.kind} joint cannot follow another")
            seen.append(part.name)
            if part.mimic.joint in seen:
                raise ArgumentError(f"{here}: a circle of joints that follow each other ({' -> '.join(seen)})")
            offset += multiplier * part.mimic.offset
            multiplier *= part.mimic.multiplier
            target = self._parts.get(part.mimic.joint)
            if target is None:
                raise ArgumentError(f"{here}, which does not move; {nearest(part.mimic.joint, self._parts, 'joints')}")
            part = target
        if part.model.nq != 1 or part.model.nv != 1:
            raise ArgumentError(
                f"joint {seen[-1]!r} mimics {part.name!r}, whose {part.model.kind} kind has no single angle"
            )
        return part.name, multiplier, offset


def _check_types(name: str, placement: Pose, inertia: Inertia | None, model: JointModel | None = None) -> None:
    if model is not None and not isinstance(model, JointModel):
        raise ArgumentError(f"joint {name!r}: a joint model (revolute(), prismatic(), ...) expected, got {model!r}")
    if not isinstance(placement, Pose):
        raise ArgumentError(
            f"{name!r}: placement: a Pose expected (Pose.from_matrix makes one), got {type(placement).__name__}"
        )
    if inertia is not None and not isinstance(inertia, Inertia):
        raise ArgumentError(f"{name!r}: inertia: an Inertia expected, got {type(inertia).__name__}")


def _check_counts(name: str, model: JointModel, limits: Limits | None, armature: Sequence[Scalar]) -> None:
    if armature and len(armature) != model.nv:
        raise ArgumentError(f"joint {name!r}: {len(armature)} rotor inertias; {model.nv} expected, one a velocity")
    for bound in ("lower", "upper"):
        given = getattr(limits, bound, ())
        if given and len(given) != model.nq:
            raise ArgumentError(f"joint {name!r}: {len(given)} {bound} limits; {model.nq} expected, one a coordinate")


def _negative(x: Scalar) -> bool:
    return x is None or isinstance(x, (str, bool)) or (isinstance(x, (int, float)) and not 0 <= x < inf)


def _nought(x: Scalar) -> bool:
    return x is None or isinstance(x, (str, bool)) or (isinstance(x, (int, float)) and not 0 < abs(x) < inf)
