"""A robot as a library read it: bodies, joints, gravity; and where two readings differ.

Before any term is compared it is known whether both libraries have the same robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from sys import float_info

import numpy as np

from ..model.robot import Joint, Robot

PER_STEP = 64 * float_info.epsilon
"""Relative rounding of one step from link to body: a rotation from roll, pitch and yaw, a product with it, a shift."""


@dataclass(frozen=True)
class Body:
    """A joint and the body it moves.

    placement (4, 4): of the joint in its parent's moving frame.  parameters (10,): mass, first moment,
    tensor xx xy yy xz yz zz about the moving frame's origin.  screws (nv, 6): [w; v] in the moving
    frame.  armature (nv,).
    """

    joint: str
    parent: str
    placement: np.ndarray
    parameters: np.ndarray
    screws: np.ndarray
    armature: np.ndarray


@dataclass(frozen=True)
class Description:
    """All bodies, gravity (3,), and what a reader complained of."""

    bodies: tuple[Body, ...]
    gravity: np.ndarray
    complaints: tuple[str, ...] = ()


@dataclass(frozen=True)
class Difference:
    """One thing that two descriptions do not share.

    Attributes
    ----------
    about : str
        "joint", "body", "armature" or "gravity".
    item : str
        The joint's name; empty for gravity.
    says : str
        What differs, with both values.
    unread : tuple of str
        The links of the body that the other reader dropped, as its complaints say.
    """

    about: str
    item: str
    says: str
    unread: tuple[str, ...] = field(default=())


def describe(robot: Robot) -> Description:
    """A robot as its numbers."""
    bodies = []
    for j in robot:
        screws = [[*map(float, s.real), *map(float, s.dual)] for s in j.model.free.screws]
        bodies.append(
            Body(
                j.name,
                j.parent.name if j.parent else "",
                j.placement.array,
                j.inertia.array,
                np.array(screws).reshape(-1, 6),
                np.array([float(x) for x in j.armature] or [0.0] * j.model.nv),
            )
        )
    return Description(tuple(bodies), robot.gravity.array)


def differences(robot: Robot, theirs: Description, whose: str) -> list[Difference]:
    """Where a description is not that of the robot, by more than rounding.

    Parameters
    ----------
    whose : str
        Whose description it is, such as "Pinocchio" or "the file".
    """
    ours = describe(robot)
    others = {b.joint: b for b in theirs.bodies}
    mine = {b.joint for b in ours.bodies}
    found = []
    for names, only in ((mine - others.keys(), f"not in {whose}"), (others.keys() - mine, f"in {whose} only")):
        if names:
            listed = ", ".join(sorted(names)[:8]) + (", ..." if len(names) > 8 else "")
            count = "joint" if len(names) == 1 else f"{len(names)} joints:"
            found.append(Difference("joint", listed, f"{count} {listed} {'is' if len(names) == 1 else 'are'} {only}"))
    if not np.allclose(ours.gravity, theirs.gravity, rtol=PER_STEP, atol=0):
        found.append(Difference("gravity", "", f"gravity is {_list(ours.gravity)}, in {whose} {_list(theirs.gravity)}"))
    for joint, body in zip(robot, ours.bodies, strict=True):
        if body.joint in others:
            found += _of_body(robot, joint, body, others[body.joint], whose, theirs.complaints)
    return found


def _of_body(
    robot: Robot, joint: Joint, ours: Body, theirs: Body, whose: str, complaints: Sequence[str]
) -> Iterable[Difference]:
    steps = PER_STEP * _steps(robot, joint)
    if ours.parent != theirs.parent:
        parents = [f"joint {p}" if p else "the ground" for p in (ours.parent, theirs.parent)]
        yield Difference("joint", ours.joint, f"joint {ours.joint} is on {parents[0]}, in {whose} on {parents[1]}")
    reach = max([1.0, *(_length(f.placement.position) for f in robot.frames if f.joint is joint.parent)])
    if not _near(ours.placement[:3, :3], theirs.placement[:3, :3], steps):
        off = np.abs(ours.placement[:3, :3] - theirs.placement[:3, :3]).max()
        yield Difference(
            "joint", ours.joint, f"joint {ours.joint} is turned otherwise in {whose} (by about {off:.2g} rad)"
        )
    if not _near(ours.placement[:3, 3], theirs.placement[:3, 3], steps * reach):
        at = [_list(b.placement[:3, 3]) for b in (ours, theirs)]
        yield Difference("joint", ours.joint, f"joint {ours.joint} stands at {at[0]} m, in {whose} at {at[1]} m")
    if ours.screws.shape != theirs.screws.shape or not _near(ours.screws, theirs.screws, PER_STEP):
        yield Difference("joint", ours.joint, f"joint {ours.joint} moves otherwise in {whose} (another type or axis)")
    if not _near(ours.armature, theirs.armature, PER_STEP * max(1.0, np.abs(ours.armature).max(initial=0.0))):
        both = [_list(b.armature) for b in (ours, theirs)]
        yield Difference("armature", ours.joint, f"armature of {ours.joint} is {both[0]}, in {whose} {both[1]} kg m^2")
    sizes, count = _sizes(robot, joint, ours.parameters)
    apart = np.abs(ours.parameters - theirs.parameters) > PER_STEP * (count + 1) * sizes
    if apart.any():
        yield _body_difference(robot, joint, ours, theirs, apart, whose, complaints)


def _body_difference(
    robot: Robot, joint: Joint, ours: Body, theirs: Body, apart: np.ndarray, whose: str, complaints: Sequence[str]
) -> Difference:
    """Name what differs, and the links that were dropped."""
    links = [k for k in robot.links if k.joint is joint]
    missing = ours.parameters - theirs.parameters
    sizes, count = _sizes(robot, joint, ours.parameters)

    def explains(link: object) -> bool:
        part = (link.placement @ link.inertia).array  # type: ignore[attr-defined]
        return bool(part.any()) and bool((np.abs(missing - part) <= PER_STEP * (count + 1) * sizes).all())

    named = [k.name for k in links if any(f"[{k.name}]" in c for c in complaints)]
    missing_links = named or [k.name for k in links if explains(k)][:1]
    if missing_links:
        says = f"the inertia of link {', '.join(missing_links)} is not in {whose}"
        return Difference("body", ours.joint, says, tuple(named))
    values = [
        f"{what} {_list(ours.parameters[part])}, in {whose} {_list(theirs.parameters[part])} {unit}"
        for what, part, unit in (
            ("mass", slice(0, 1), "kg"), ("first moment", slice(1, 4), "kg m"), ("tensor", slice(4, 10), "kg m^2"),
        )
        if apart[part].any()
    ]  # fmt: skip
    return Difference("body", ours.joint, f"body of {ours.joint}: {'; '.join(values)}")


def _sizes(robot: Robot, joint: Joint, parameters: np.ndarray) -> tuple[np.ndarray, int]:
    """How large what adds up to the ten parameters is, and of how many links: sums of m, m d and m d^2."""
    mass, moment, tensor, count = abs(parameters[0]), np.abs(parameters[1:4]).max(), np.abs(parameters[4:]).max(), 1
    for k in robot.links:
        if k.joint is joint:
            m, h = abs(float(k.inertia.mass)), _length(k.inertia.moment)
            J = max(abs(float(x)) for row in k.inertia.rotational.rows for x in row)
            d = _length(k.placement.position)
            # tensors are stated about the centre of mass, which may be far from the link's frame
            mass, moment, tensor = (
                mass + m,
                moment + h + m * d,
                tensor + J + 2 * h * d + m * d * d + (h * h / m if m else 0),
            )
            count += 1
    return np.array([mass] + [moment] * 3 + [tensor] * 6), count


def _steps(robot: Robot, joint: Joint) -> int:
    """How many fixed joints stand between a joint and its parent's, and itself."""
    index = next((i for i, f in enumerate(robot.frames) if f.role == "joint" and f.joint is joint), 0)
    count = 1
    while index and (robot.frames[index].role != "joint" or count == 1) and count < len(robot.frames):
        index, count = robot.frames[index].parent, count + 1
    return count


def _near(a: np.ndarray, b: np.ndarray, bound: float) -> bool:
    return bool((np.abs(a - b) <= bound).all())


def _length(p: Iterable[object]) -> float:
    return float(np.linalg.norm([float(x) for x in p]))  # type: ignore[arg-type]


def _list(x: np.ndarray) -> str:
    return " ".join(f"{v:.10g}" for v in np.ravel(x))
