"""Put a robot together joint by joint, parents first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from ..errors import ArgumentError, FrameNotFoundError, nearest
from ..scalars import ZERO, Scalar, exact
from ..spatial.inertia import NOTHING, Inertia
from ..spatial.pose import GROUND, Pose
from .joints import Axial, JointModel
from .limits import remarks
from .robot import STANDARD_GRAVITY, Frame, Joint, Limits, Link, Mimic, Robot, gravity_vector


@dataclass
class _Part:
    """A joint still being described."""

    name: str
    model: JointModel
    parent: str | None
    placement: Pose
    inertia: Inertia
    limits: Limits
    mimic: Mimic | None
    armature: tuple[Scalar, ...]


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
        # a link and a joint may share a name; a link is what things are fixed to
        self._link_places: dict[str, _Place] = {}
        self._places: dict[str, _Place] = {"universe": _Place(None, GROUND)}
        self._frames: list[tuple[str, str, str | None, Pose, int]] = [("universe", "universe", None, GROUND, 0)]
        self._links: list[tuple[str, Inertia, str | None, Pose]] = []

    @classmethod
    def of(cls, robot: Robot) -> Builder:
        """A builder that already holds all of a robot, to add to it."""
        if not isinstance(robot, Robot):
            raise ArgumentError(f"Builder.of: a Robot expected, got {type(robot).__name__}")
        b = cls(robot.name)
        b.gravity, b.notes, b.source = robot.gravity, list(robot.notes), robot.source
        for j in robot:
            parent = j.parent.name if j.parent else None
            b._parts[j.name] = _Part(
                j.name, j.model.free, parent, j.placement, j.inertia, j.limits, j.mimic, j.armature
            )
        b._frames = [(f.name, f.role, f.joint.name if f.joint else None, f.placement, f.parent) for f in robot.frames]
        for i, (name, kind, joint, placement, _) in enumerate(b._frames):
            places = b._link_places if kind == "link" else b._places
            places[name] = _Place(joint, placement, i)
        b._links = [(k.name, k.inertia, k.joint.name if k.joint else None, k.placement) for k in robot.links]
        return b

    def joint(
        self,
        name: str,
        model: JointModel,
        on: str | None = None,
        placement: Pose = GROUND,
        inertia: Inertia | None = None,
        *,
        link: str | None = None,
        limits: Limits | None = None,
        mimic: Mimic | None = None,
        armature: Sequence[Scalar] = (),
    ) -> None:
        """A joint whose fixed side has the pose `placement` in the frame `on`, and the link it moves."""
        self._unused(name)
        _check_types(name, placement, inertia, model)
        _check_counts(name, model, limits, armature)
        at = self._place(on)
        X = at.placement @ placement
        self._parts[name] = _Part(
            name, model, at.joint, X, NOTHING, limits or Limits(), mimic,
            tuple(map(exact, armature)) or (ZERO,) * model.nv,
        )  # fmt: skip
        self._frames.append((name, "joint", name, GROUND, at.frame))
        place = _Place(name, GROUND, len(self._frames) - 1)
        self._places[name] = place
        self._link(link or name, inertia, place)

    def fixed(
        self,
        name: str,
        on: str | None = None,
        placement: Pose = GROUND,
        inertia: Inertia | None = None,
        *,
        link: str | None = None,
    ) -> None:
        """A fixed joint: its link's inertia joins the body that carries it.

        One that is called like the joint of a floating base is told apart by its kind, as in Pinocchio.
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
        """The root link of a robot whose base stands on the ground."""
        self._link(name, inertia, _Place(None, GROUND))

    def frame(self, name: str, on: str | None = None, placement: Pose = GROUND) -> None:
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
        body = NOTHING if inertia is None else inertia
        if inertia is not None and at.joint is not None:
            part = self._parts[at.joint]
            part.inertia = part.inertia + at.placement @ body
        self._links.append((name, body, at.joint, at.placement))
        self._frames.append((name, "link", at.joint, at.placement, at.frame))
        self._link_places[name] = _Place(at.joint, at.placement, len(self._frames) - 1)

    def _unused(self, name: str) -> None:
        """A joint's or a frame's name is its own; only a link may share it."""
        if name in self._places:
            raise ArgumentError(f"joint or frame {name!r} of {self.name} is defined twice")

    def _place(self, on: str | None) -> _Place:
        if on is None:
            return _Place(None, GROUND)
        place = self._link_places.get(on) or self._places.get(on)
        if place is None:
            names = [*self._link_places, *self._places]
            raise FrameNotFoundError(f"{on!r} is not in {self.name} yet; {nearest(on, names, 'frames')}")
        return place

    def robot(self) -> Robot:
        """The finished robot.  Raises `ArgumentError` for a mimic that cannot be followed."""
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
                part.limits, part.mimic, part.armature,
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
        # a robot built upon another has its notes already
        return replace(robot, notes=tuple(dict.fromkeys([*self.notes, *remarks(robot)])))

    def _followed(self, part: _Part) -> tuple[str, float, float]:
        """The joint that leads in the end, and the multiplier and offset through all that follow."""
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
