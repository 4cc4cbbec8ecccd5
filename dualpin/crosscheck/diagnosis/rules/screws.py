"""Mistakes in the screw axes and poses at the home configuration, of codes that multiply exponentials.

    T(q) = exp([S_1] q_1) ... exp([S_n] q_n) M,     S = (w; p x w),   p a point of the axis

A wrong point or direction is another robot: the joint moves about another line, and links stand at home as before.
A wrong home pose M is one too: its link stands elsewhere on what its joint moves.

Reference: Lynch and Park, Modern Robotics (2017), sections 4.1.1 and 5.1.1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ..description import Description, Part, homogeneous
from .register import robot_rule

POINT = "S = (w; p x w): p is a point of the joint's axis at home, in the base's frame"
DIRECTION = "turn <axis> by the orientation that the joint has at home, into the base's frame"
HOME = "M is the pose of the link at home, in the base's frame"


def _at(p: Part, d: Description) -> np.ndarray:
    """The pose of a joint's frame at home, in the root's frame."""
    return np.asarray(d.home[p.parent] @ p.pose)


def _about(p: Part, d: Description, point: np.ndarray) -> Part:
    """The same joint about a parallel axis through a point, which is given in the root's frame at home."""
    if not p.turns:
        return p
    at = _at(p, d)
    arm = at[:3, :3].T @ (point - at[:3, 3])
    arm = arm - (arm @ p.unit_axis) * p.unit_axis  # only which line it is counts
    if np.abs(arm).max() < 1e-13:
        return p
    there, back = homogeneous(np.eye(3), arm), homogeneous(np.eye(3), -arm)
    return replace(p.placed(p.pose @ there), after=back @ p.after)


def _origin(p: Part, d: Description) -> np.ndarray:
    return np.asarray(_at(p, d)[:3, 3])


def _summed(p: Part, d: Description) -> np.ndarray:
    """Of all xyz up to a joint, unturned."""
    total, on = p.position, d.part_of_link(p.parent)
    while on is not None:
        total, on = total + on.position, d.part_of_link(on.parent)
    return np.asarray(total)


def _centre(p: Part, d: Description) -> np.ndarray:
    """The centre of mass of what a joint carries rigidly."""
    body = p.body
    return _origin(p, d) if body is None else (d.home[p.link] @ np.append(body.com, 1.0))[:3]


def _next(p: Part, d: Description) -> np.ndarray:
    """The origin of the first joint on a link."""
    return next((_origin(n, d) for n in d.parts if n.parent == p.link and n.moves), _origin(p, d))


def _along(p: Part, d: Description, direction: np.ndarray) -> Part:
    """The same joint along a direction of the root's axes at home."""
    if not p.axial:
        return p
    axis = _at(p, d)[:3, :3].T @ direction
    return p if np.abs(axis - p.unit_axis).max() < 1e-13 else replace(p, axis=axis)


POINTS: Mapping[str, Callable[[Part, Description], np.ndarray]] = {
    "is the joint's xyz, in the parent's frame": lambda p, d: p.position,
    "is left out (p x w is zero)": lambda p, d: np.zeros(3),
    "has the other sign (w x p)": lambda p, d: -_origin(p, d),
    "is the parent's origin": lambda p, d: d.home[p.parent][:3, 3],
    "is the sum of all xyz, unturned": _summed,
    "is in the joint's own axes": lambda p, d: _at(p, d)[:3, :3].T @ _origin(p, d),
    "is the centre of mass of the link": _centre,
    "is the origin of the next joint": _next,
}


def _through(point: Callable[[Part, Description], np.ndarray]) -> Callable[[Description], Description]:
    return lambda d: d.with_parts(lambda p, d: _about(p, d, point(p, d)))


for _words, _point in POINTS.items():
    robot_rule("screw_point", f"the point of a screw axis at home {_words}", POINT, cost=1.1)(_through(_point))


TURNS: Mapping[str, Callable[[Part, Description], np.ndarray]] = {
    "not turned into the base's frame": lambda p, d: np.eye(3),
    "turned by the joint's own rpy alone": lambda p, d: p.rotation,
    "turned by the inverse": lambda p, d: _at(p, d)[:3, :3].T,
}


def _turned(
    turn: Callable[[Part, Description], np.ndarray], some: Callable[[Part], bool]
) -> Callable[[Description], Description]:
    return lambda d: d.with_parts(lambda p, d: _along(p, d, turn(p, d) @ p.unit_axis) if some(p) else p)


for _words, _turn in TURNS.items():
    for _of, _some in {"": lambda p: True, " of sliding joints": lambda p: p.slides}.items():
        _says = f"the direction of a screw axis at home{_of} is {_words}"
        robot_rule("screw_axis", _says, DIRECTION, cost=1.1)(_turned(_turn, _some))


def standing(d: Description, elsewhere: Mapping[str, np.ndarray]) -> Description:
    """Links that stand at these poses at home, while the axes of all joints are where they were."""
    right = d.home
    moved = {link: np.linalg.inv(H) @ elsewhere.get(link, H) for link, H in right.items()}
    parts = []
    for p in d.parts:
        pose = np.linalg.inv(moved[p.parent]) @ p.pose
        parts.append(
            replace(p.placed(pose), after=p.after @ moved[p.link]) if p.moves else p.placed(pose @ moved[p.link])
        )
    return replace(d, parts=tuple(parts))


@robot_rule("home_pose", "home poses of links are not turned: M has their positions alone", HOME, cost=1.1)
def shifted(d: Description) -> Description:
    return standing(d, {p.link: homogeneous(np.eye(3), d.home[p.link][:3, 3]) for p in d.parts})


@robot_rule("home_pose", "home poses of links are those of their joints on their parents", HOME, cost=1.1)
def local(d: Description) -> Description:
    return standing(d, {p.link: p.pose for p in d.parts})


@robot_rule("home_pose", "positions in home poses of links are sums of all xyz, unturned", HOME, cost=1.1)
def summed(d: Description) -> Description:
    return standing(d, {p.link: homogeneous(d.home[p.link][:3, :3], _summed(p, d)) for p in d.parts})


@robot_rule("home_pose", "rotations in home poses of links are transposed", HOME, cost=1.1)
def transposed(d: Description) -> Description:
    return standing(d, {p.link: homogeneous(d.home[p.link][:3, :3].T, d.home[p.link][:3, 3]) for p in d.parts})
