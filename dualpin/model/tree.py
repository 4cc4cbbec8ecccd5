"""The parts of a robot: joints with the bodies they move, frames, links."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import inf

from ..renamed import Renamed
from ..scalars import Scalar
from ..spatial.inertia import Inertia
from ..spatial.pose import Pose
from ..spatial.vector import Vector3
from .joints import JointModel


@dataclass(frozen=True)
class Limits:
    """Bounds as the description states them; `lower` and `upper` have one entry a coordinate."""

    lower: tuple[float, ...] = ()
    upper: tuple[float, ...] = ()
    velocity: float = inf
    effort: float = inf
    damping: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class Mimic:
    """A joint whose coordinate is  multiplier * (coordinate of `joint`) + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Rotor:
    """The motor of a joint with one coordinate.

    Attributes
    ----------
    inertia : scalar
        Inertia of the rotating parts about the motor's axis [kg m^2].
    ratio : scalar
        Gear ratio: speed of the motor by speed of the joint; in rad/m for a prismatic joint.
    body : Inertia, optional
        The motor as a body on the preceding link, in the frame of the joint's fixed side.
    """

    inertia: Scalar = 0.0
    ratio: Scalar = 1.0
    body: Inertia | None = None

    @property
    def reflected(self) -> Scalar:
        """The reflected inertia, ratio^2 inertia."""
        return self.inertia * self.ratio * self.ratio


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint and the body it moves.

    Attributes
    ----------
    placement : Pose
        Pose of the joint's fixed side in the parent's moving frame.
    inertia : Inertia
        Inertia of all that is rigidly attached, about this joint's moving frame.
    q, v : slice
        The indices of its coordinates and velocities in those of the robot.
    """

    name: str
    model: JointModel
    parent: Joint | None
    placement: Pose
    inertia: Inertia
    q: slice
    v: slice
    index: int
    limits: Limits = field(default_factory=Limits)
    mimic: Mimic | None = None
    armature: tuple[Scalar, ...] = ()
    """Reflected inertias of its rotors, at the joint's own coordinates [kg m^2, or kg for a prismatic one]."""
    rotor: Rotor | None = None
    """Its motor, if known; `armature` contains its reflected inertia."""
    passive: bool = False
    """True if it has no motor; `dualpin.simulate` gives it no torque."""

    def __repr__(self) -> str:
        return f"<Joint {self.name!r}: {self.kind}, q{_span(self.q)}, v{_span(self.v)}>"

    @property
    def kind(self) -> str:
        return self.model.kind

    @property
    def damping(self) -> float:
        """Viscous friction of the description [N m s/rad or N s/m]; no term contains it."""
        return self.limits.damping

    @property
    def friction(self) -> float:
        """Dry friction of the description [N m or N]; no term contains it."""
        return self.limits.friction

    @cached_property
    def dofs(self) -> list[tuple[int, Vector3]]:
        """(index in v, screw) of each degree of freedom."""
        return list(zip(range(self.v.start, self.v.stop), self.model.screws, strict=True))

    @property
    def coupling(self) -> tuple[Scalar, Scalar]:
        """(multiplier, offset): its own coordinate is  multiplier * q + offset  of the q it may share with others."""
        return self.model.coupling

    @cached_property
    def driven(self) -> list[tuple[int, Vector3, Scalar]]:
        """(index in v, screw, rotor inertia felt there) of each degree of freedom.

        A rotor turns `multiplier` times as fast as the shared coordinate, so its energy grows with
        the square of the multiplier.
        """
        multiplier, _ = self.coupling
        return [(k, s, r * multiplier * multiplier) for (k, s), r in zip(self.dofs, self.armature, strict=True)]

    @property
    def quaternions(self) -> list[slice]:
        """Where its unit quaternions, scalar first, lie in q."""
        return [slice(self.q.start + i, self.q.start + i + 4) for i in self.model.quaternions]

    @property
    def chain(self) -> Iterator[Joint]:
        """This joint, its parent, ... up to the root."""
        joint: Joint | None = self
        while joint is not None:
            yield joint
            joint = joint.parent


@dataclass(frozen=True, eq=False)
class Frame:
    """A named frame, fixed to the body that `joint` moves (None: the ground)."""

    name: str
    role: str
    """ "universe", "joint", "fixed_joint", "link" or "frame"; "com" of one that `frames.find` made."""
    joint: Joint | None
    placement: Pose
    parent: int = 0
    """Index of the frame it was described in."""
    kind = Renamed("role")


@dataclass(frozen=True, eq=False)
class Link:
    """A link as it was described: its own inertia in its own frame, and where that frame is fixed."""

    name: str
    inertia: Inertia
    joint: Joint | None
    placement: Pose


def _span(s: slice) -> str:
    return f"[{s.start}]" if s.stop == s.start + 1 else f"[{s.start}:{s.stop}]"
