"""A serial chain cut out of a robot: its axes as lines at home, and where the tip then is.

Every form of a chain (product of exponentials, Denavit-Hartenberg) starts from the same data: the
dual vectors of the axes at q = 0 in the base frame, and the pose of the tip.  A joint that is
passed from its child to its parent is the same joint about the reversed line, since
exp(-q L) = exp(q (-L)).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..algorithms.kinematics import path
from ..arguments import numbers
from ..dual import EPS, Dual
from ..errors import ArgumentError, ShapeError
from ..functions import fk
from ..model.joints import Axial, Floating, Planar
from ..model.robot import Frame, Joint, Robot, expect_numbers
from ..scalars import ONE, ZERO, Scalar
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.vector import UX, UY, UZ, ZERO_VECTOR, Vector3, motor

KINDS = {"R": "revolute", "P": "prismatic", "C": "cylindrical", "H": "helical", "F": "fixed"}
MOST = 40  # leaves that an error message lists


@dataclass(frozen=True, eq=False)
class Axis:
    """One moving axis: a unit line, and the dual units that the coordinates multiply.

    The displacement is exp(line (u_1 q_1 + ...)); a follower's multiplier is part of its unit.
    """

    joint: Joint
    line: Vector3
    units: tuple[Dual, ...]
    q: tuple[int, ...]

    @property
    def letter(self) -> str:
        """R, P, C or H, as the units have it."""
        if len(self.units) == 2:
            return "C"
        (unit,) = self.units
        turn, slide = float(unit.real), float(unit.dual)
        return ("H" if slide else "R") if turn else "P"

    @property
    def factors(self) -> tuple[float, ...]:
        """What each coordinate is multiplied with: 1, or a follower's multiplier."""
        if len(self.units) == 2:
            return (1.0, 1.0)
        (unit,) = self.units
        return (float(unit.real) or float(unit.dual),)

    @property
    def pitch(self) -> float:
        """Of a helical axis [m/rad]; zero for all others."""
        (unit, *_) = self.units
        return float(unit.dual) / float(unit.real) if self.letter == "H" else 0.0


@dataclass(frozen=True, eq=False)
class Chain:
    """The way from a base frame to a tip frame of a robot."""

    robot: Robot
    base: Frame
    tip: Frame
    axes: tuple[Axis, ...]
    home: Pose
    """Of the tip in the base, every coordinate at zero."""

    @property
    def downward(self) -> bool:
        """Whether every joint is passed from its parent to its child."""
        return self.base.joint is None or self.base.joint in path(self.tip.joint)

    @cached_property
    def joint_names(self) -> list[str]:
        return list(dict.fromkeys(axis.joint.name for axis in self.axes))

    def fk(self, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
        """Pose of the tip in the base as the robot has it, shape (..., 4, 4)."""
        T = fk(self.robot, q, self.tip, engine=engine)
        if self.base.joint is None and self.base.placement is IDENTITY_POSE:
            return T
        return np.linalg.inv(fk(self.robot, q, self.base, engine=engine)) @ T

    def sample(self, n: int, seed: int = 0) -> np.ndarray:
        """Coordinates for tests, limits left aside: angles in [-pi, pi], lengths in [-1, 1] m, (n, nq)."""
        q, _, _ = self.robot.sample(n, seed)
        rng = np.random.default_rng(seed)
        for axis in self.axes:
            for i, unit in zip(axis.q, axis.units, strict=True):
                q[:, i] = rng.uniform(-np.pi, np.pi, n) if float(unit.real) else rng.uniform(-1, 1, n)
        return q


def root(robot: Robot) -> Frame:
    """The root link's frame, or the universe where there is none."""
    if robot.links:
        first = robot.frame(robot.links[0].name)
        if first.joint is None or (first.joint.parent is None and isinstance(first.joint.model, Floating)):
            return first
    return robot.frames[0]


def leaves(robot: Robot) -> list[Frame]:
    """Links (and plain frames) that carry nothing further, in the order of the robot's frames."""
    carrying = {f.parent for f in robot.frames[1:]}
    found = []
    for i, f in enumerate(robot.frames):
        if f.role not in ("link", "frame") or i in carrying:
            continue
        # things may also be fixed to the joint that moves a link
        siblings = [g for g in robot.frames[1:] if g is not f and g.parent == f.parent]
        if f.role == "link" and f.parent and siblings:
            continue
        found.append(f)
    return found


def chain(robot: Robot, base: str | Frame | None = None, tip: str | Frame | None = None, what: str = "chain") -> Chain:
    """The chain from base to tip, by default from the root to the only leaf.

    Raises
    ------
    FrameNotFoundError
        For a name the robot does not have, with the nearest ones.
    ArgumentError
        If the robot branches and no tip is given, or a floating joint lies on the way.
    """
    expect_numbers(what, robot)
    start = root(robot) if base is None else robot.frame(base)
    end = _only_leaf(robot, what) if tip is None else robot.frame(tip)
    up, down = _ways(start.joint, end.joint)
    world = homes(robot, [*path(start.joint), *path(end.joint)])
    inverse = (world[start.joint] @ start.placement).inverse
    axes: list[Axis] = []
    for joint in up:
        axes += [Axis(joint, -a.line, a.units, a.q) for a in reversed(axes_of(joint, inverse @ world[joint], what))]
    for joint in down:
        axes += axes_of(joint, inverse @ world[joint], what)
    return Chain(robot, start, end, tuple(axes), inverse @ world[end.joint] @ end.placement)


def _only_leaf(robot: Robot, what: str) -> Frame:
    ends = leaves(robot)
    if len(ends) == 1:
        return ends[0]
    names = [f.name for f in ends]
    shown = ", ".join(names[:MOST]) + (f", ... ({len(names)} in all)" if len(names) > MOST else "")
    raise ArgumentError(
        f"{what}: {robot.name} branches and ends in {len(names)} links; choose one with tip=. leaves: {shown}"
    )


def _ways(start: Joint | None, end: Joint | None) -> tuple[list[Joint], list[Joint]]:
    """The joints to leave towards the common ancestor, and those to enter from there."""
    a, b = path(start), path(end)
    n = 0
    while n < min(len(a), len(b)) and a[n] is b[n]:
        n += 1
    return a[n:][::-1], b[n:]


def homes(robot: Robot, joints: list[Joint]) -> dict[Joint | None, Pose]:
    """Poses of the joints' moving frames at zero; a floating base stands at the world's origin."""
    world: dict[Joint | None, Pose] = {None: IDENTITY_POSE}
    for b in joints:
        if b not in world:
            zero: list[Scalar] = [ZERO] * b.model.nq
            still = isinstance(b.model, Floating)
            X = b.placement if still else b.placement @ b.model.motion(zero)
            world[b] = world[b.parent] @ X
    return world


def axes_of(joint: Joint, X: Pose, what: str) -> list[Axis]:
    """The axes of a joint whose moving frame is X at home, in the order they act."""
    model, q = joint.model, joint.q
    if isinstance(model, Axial):
        return [Axis(joint, X @ motor(model.axis, ZERO_VECTOR), model.units, tuple(range(q.start, q.stop)))]
    if isinstance(model, Planar):  # slides along x and y, then turns about z
        units = EPS, EPS, Dual(ONE, ZERO)
        return [
            Axis(joint, X @ motor(direction, ZERO_VECTOR), (unit,), (q.start + i,))
            for i, (direction, unit) in enumerate(zip((UX, UY, UZ), units, strict=True))
        ]
    raise ArgumentError(
        f"{what}: joint {joint.name!r} is {joint.kind}: its {model.nv} freedoms have no axes fixed in the robot, so no "
        "product of screws about constant lines describes it; give base= a link beyond that joint"
    )


def whole_q(robot: Robot, q: ArrayLike, what: str) -> np.ndarray:
    """q as an array (..., nq) of the whole robot."""
    x = numbers(what, q)
    if x.ndim < 1 or x.shape[-1] != robot.nq:
        raise ShapeError(
            f"{what} of shape (..., {robot.nq}) expected, the coordinates of all of {robot.name}; got {x.shape}"
        )
    return x
