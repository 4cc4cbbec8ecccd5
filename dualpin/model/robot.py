"""The robot: a tree of joints, each moving a rigid body, with named frames.  It is immutable."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np

from ..arguments import entries, is_symbol
from ..delegates import home
from ..errors import ArgumentError, FrameNotFoundError, nearest
from ..scalars import Exact, Scalar, exact
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.vector import ZERO_VECTOR, Vector3, motor
from .joints import JointModel
from .tree import Frame, Joint, Limits, Link, Mimic, Rotor

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
BASE = "root_joint"
"""Name of the joint of a floating base, as in Pinocchio."""
_serials = itertools.count()


@dataclass(frozen=True, eq=False)
class Robot:
    """A tree of joints, parents first.  Made by `dualpin.load`, `dualpin.from_dh`, `Builder`, ..."""

    name: str
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...]
    links: tuple[Link, ...] = ()
    gravity: Vector3 = field(default_factory=lambda: Vector3(*map(exact, STANDARD_GRAVITY)))
    notes: tuple[str, ...] = ()
    """Assumptions and remarks of the reader."""
    source: str | None = None
    """The file it was read from."""
    serial: int = field(init=False, repr=False, default_factory=_serials.__next__)
    """Unique in the process; the key of the robot's caches (`model.memory`)."""

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in fields(self) if f.init}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, serial=next(_serials))  # an equal robot, but not the same one

    # the tree, as the algorithms walk it

    def __iter__(self) -> Iterator[Joint]:
        return iter(self.joints)

    def __reversed__(self) -> Iterator[Joint]:
        return reversed(self.joints)

    def __len__(self) -> int:
        return len(self.joints)

    @cached_property
    def nq(self) -> int:
        return max((j.q.stop for j in self.joints), default=0)

    @cached_property
    def nv(self) -> int:
        return max((j.v.stop for j in self.joints), default=0)

    @property
    def floating(self) -> bool:
        """Whether its base was made floating: ``load(..., floating=True)``."""
        return bool(self.joints) and self.joints[0].name == BASE and self.joints[0].kind == "floating"

    @property
    def at_rest(self) -> Vector3:
        """The upward acceleration of the base that is equivalent to gravity."""
        return motor(ZERO_VECTOR, -self.gravity)

    @property
    def coupled(self) -> bool:
        """Whether joints share coordinates (mimic)."""
        return any(j.mimic for j in self.joints)

    @cached_property
    def numbers(self) -> str:
        """The type of its constants: "double", "other" (scalars of more digits, after `lift`), or "symbolic"."""
        values = list(constants(self))
        if all(isinstance(x, (int, float, Exact)) for x in values):
            return "double"
        try:
            for x in values:
                float(x)
        except (TypeError, ValueError):
            return "symbolic"
        return "other"

    # names

    @cached_property
    def joint_names(self) -> list[str]:
        return [j.name for j in self.joints]

    @cached_property
    def frame_names(self) -> list[str]:
        return [f.name for f in self.frames]

    @cached_property
    def link_names(self) -> list[str]:
        return [link.name for link in self.links]

    def joint(self, name: str) -> Joint:
        """The joint of that name, or a `FrameNotFoundError` with the nearest names."""
        for j in self.joints:
            if j.name == name:
                return j
        fixed = any(f.role == "fixed_joint" and f.name == name for f in self.frames)
        why = "is fixed, it has no coordinates;" if fixed else "is not a joint of"
        raise FrameNotFoundError(f"joint {name!r} {why} {self.name}; {nearest(name, self.joint_names, 'joints')}")

    def frame(self, name: str | int | Frame) -> Frame:
        """The frame of that name (a link's before a joint's, "com:LINK" at a link's centre of mass) or index."""
        return home("Robot.frame")(self, name)

    # limits and configurations

    @cached_property
    def neutral(self) -> np.ndarray:
        """The configuration with every joint at its zero, shape (nq,)."""
        out = np.zeros(self.nq)
        for j in self.joints:
            if j.mimic is None:
                out[j.q] = j.model.neutral
        return out

    @cached_property
    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return home("Robot._bounds")(self)

    @property
    def lower(self) -> np.ndarray:
        """Lower position limits, those of followers (mimic) included, shape (nq,); -inf where there is none."""
        return self._bounds[0]

    @property
    def upper(self) -> np.ndarray:
        """Upper position limits, shape (nq,); inf where there is none."""
        return self._bounds[1]

    @cached_property
    def velocity_limit(self) -> np.ndarray:
        """Shape (nv,); inf where there is none."""
        return home("Robot.velocity_limit")(self)

    def sample(self, n: int | None = None, seed: int | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Random states q, v, a within the limits, shapes (n, nq), (n, nv), (n, nv); see `dualpin.model.sampling`."""
        return home("Robot.sample")(self, n, seed)

    # variants

    def with_gravity(self, gravity: Sequence[float]) -> Robot:
        """The same robot with another gravity, a vector in the world frame [m/s^2]."""
        return replace(self, gravity=gravity_vector(gravity))

    def attach(
        self,
        other: Robot | Inertia,
        on: str | Frame | None = None,
        placement: Pose | None = None,
        *,
        passive: bool = False,
        joint: JointModel | None = None,
        name: str | None = None,
        prefix: str = "",
    ) -> Robot:
        """A new robot that carries a body or another robot on the frame `on`; see `dualpin.model.attach`."""
        how = {"passive": passive, "joint": joint, "name": name, "prefix": prefix}
        return home("Robot.attach")(self, other, on, IDENTITY_POSE if placement is None else placement, **how)

    def with_rotors(self, rotors: Mapping[str, Rotor | Scalar]) -> Robot:
        """The same robot with motors on some joints; see `dualpin.model.rotors`."""
        return home("Robot.with_rotors")(self, rotors)

    def lift(self, scalar: Callable[[Any], Scalar]) -> Robot:
        """The same robot with every constant x replaced by scalar(x); see `dualpin.model.lift`."""
        return home("Robot.lift")(self, scalar)

    # delegates to other rooms, see delegates.py

    def kernel(self, name: str, dtype: Any = np.float64, **options: Any) -> Callable[..., np.ndarray]:
        """One term as a callable for loops, (*arrays, out=None) -> array; see `dualpin.call.kernel`."""
        return home("Robot.kernel")(self, name, dtype, **options)

    def to_urdf(self, path: Any = None) -> str:
        """Write the robot as a URDF file, and return its text; see `dualpin.io.write.to_urdf`."""
        return home("Robot.to_urdf")(self, path)

    def to_mjcf(self, path: Any = None) -> str:
        """Write the robot as an MJCF file, and return its text; see `dualpin.io.write_mjcf.to_mjcf`."""
        return home("Robot.to_mjcf")(self, path)

    def summary(self, degrees: bool = False) -> str:
        """The tree, the order of q and v, limits (of angles in rad, or degrees), and what was assumed, as text."""
        return home("Robot.summary")(self, degrees)

    def _repr_html_(self) -> str:
        return home("Robot._repr_html_")(self)

    # description

    @property
    def mass(self) -> float:
        """Total moving mass [kg]."""
        if self.numbers == "symbolic":
            raise ArgumentError(f"{self.name}: its constants are symbols, so its mass is no number")
        return float(sum(float(j.inertia.mass) for j in self.joints))

    def __repr__(self) -> str:
        weight = "" if self.numbers == "symbolic" else f", {self.mass:.6g} kg"
        return f"<Robot {self.name!r}: {len(self.joints)} joints, nq={self.nq}, nv={self.nv}{weight}>"


def expect_robot(what: str, robot: object) -> None:
    """Raise if it is not a robot; for a name or a path the message names `dualpin.load`."""
    if not isinstance(robot, Robot):
        hint = f"; dualpin.load({robot!r}) reads one" if isinstance(robot, str) else ""
        raise ArgumentError(f"{what}: a Robot expected, got {type(robot).__name__}{hint}")


def expect_numbers(what: str, robot: Robot) -> None:
    """Raise if it is not a robot, or its constants are symbols."""
    expect_robot(what, robot)
    if robot.numbers == "symbolic":
        raise ArgumentError(
            f"{what}: the constants of {robot.name} are symbols; arrays of numbers need numbers. "
            "dualpin.symbolic and the functions of dualpin.algorithms take symbols; Robot.lift puts numbers in"
        )


def constants(robot: Robot) -> Iterator[Scalar]:
    """All numbers on which a result can depend."""
    yield from robot.gravity
    yield from (x for f in robot.frames for row in f.placement.rows for x in row)
    for j in robot:
        yield from j.inertia.parameters
        yield from j.armature
        yield from (x for row in j.placement.rows for x in row)
        yield from (x for s in j.model.screws for c in s for x in (c.real, c.dual))
        offset = getattr(j.model, "offset", None)
        yield from () if offset is None else (offset.real, offset.dual)


def gravity_vector(gravity: Sequence[float]) -> Vector3:
    """Three finite numbers as a vector, zeros exact."""
    try:
        g = entries("gravity", gravity)
    except ArgumentError:
        g = np.empty(0)
    if g.shape != (3,) or not all(is_symbol(x) or isfinite(x) for x in g):
        raise ArgumentError(f"gravity: three finite numbers (x, y, z) in m/s^2 expected, or symbols, got {gravity!r}")
    return Vector3(*map(exact, g.tolist()))


__all__ = [
    "BASE", "STANDARD_GRAVITY", "Frame", "Joint", "Limits", "Link", "Mimic", "Robot", "Rotor", "constants",
    "expect_numbers", "expect_robot", "gravity_vector",
]  # fmt: skip
