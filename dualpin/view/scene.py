"""The geometry drawn of a robot, as arrays, independent of any viewer."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, pi

import numpy as np

from ..model.robot import Joint, Link, Robot
from ..spatial.pose import Pose

STILL = 1e-12  # a pitch below this is that of a revolute joint


@dataclass(frozen=True)
class Axis:
    """The screw of one freedom of a joint, in the joint's moving frame.

    Attributes
    ----------
    joint : Joint
    point, direction : ndarray, shape (3,)
        A point of the axis nearest to the frame's origin [m], and its unit direction.
    pitch : float
        [m/rad]; 0 of a rotation, inf of a translation.
    """

    joint: Joint
    point: np.ndarray
    direction: np.ndarray
    pitch: float


def axes(robot: Robot) -> list[Axis]:
    """The screws of all freedoms, of joints that follow others too; a floating base has none worth drawing.

    Of a twist w + eps v:  direction w / |w|,  point w x v / |w|^2,  pitch w . v / |w|^2
    (Ball 1900); where w = 0 a translation along v.

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    list of Axis
        One for each screw of each joint, in the order of the velocities of the joints.

    References
    ----------
    Ball (1900), ch. I.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.view import axes
    >>> [(a.joint.name, a.direction.tolist(), a.pitch) for a in axes(dp.load("ur5"))][0]
    ('shoulder_pan_joint', [0.0, 0.0, 1.0], 0.0)
    """
    found = []
    for joint in robot:
        for screw in joint.model.free.drawn:
            w, v = (screw.real.array, screw.dual.array)
            size = float(w @ w)
            if size == 0.0:
                found.append(Axis(joint, np.zeros(3), v / np.linalg.norm(v), inf))
            else:
                pitch = float(w @ v) / size
                found.append(Axis(joint, np.cross(w, v) / size, w / size**0.5, pitch if abs(pitch) > STILL else 0.0))
    return found


def helix(axis: Axis, length: float, radius: float, turns: float = 4.0, points: int = 160) -> np.ndarray:
    """A polyline along an axis, shape (n, 3): a line if the pitch is 0 or infinite, else a helix of that pitch.

    A helix that would be longer than `length` is cut; one that would be shorter has its full `turns`.

    Parameters
    ----------
    axis : Axis
    length, radius : float
        [m]
    turns : float
    points : int

    Returns
    -------
    ndarray, shape (points, 3)

    References
    ----------
    Ball (1900), ch. I.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.view import axes, helix
    >>> helix(axes(dp.load("ur5"))[0], length=0.2, radius=0.02).tolist()
    [[0.0, 0.0, -0.1], [0.0, 0.0, 0.1]]
    """
    half = axis.direction * length / 2
    if axis.pitch == 0.0 or not isfinite(axis.pitch):
        return np.array([axis.point - half, axis.point + half])
    angle = np.linspace(-0.5, 0.5, points) * min(2 * pi * turns, length / abs(axis.pitch))
    aside = np.cross(axis.direction, np.eye(3)[np.argmin(np.abs(axis.direction))])
    aside /= np.linalg.norm(aside)
    around = np.cos(angle)[:, None] * aside + np.sin(angle)[:, None] * np.cross(axis.direction, aside)
    return np.asarray(axis.point + radius * around + np.outer(axis.pitch * angle, axis.direction))


def bones(robot: Robot) -> list[tuple[Joint | None, np.ndarray]]:
    """Lines from each body's frame to the places of what it carries: (the joint that moves it, (2, 3)).

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    list of (Joint or None, ndarray of shape (2, 3))
        Both ends in the moving frame of the joint; None is the base.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.view import bones
    >>> joint, line = bones(dp.load("ur5"))[1]
    >>> joint.name, line.round(5).tolist()
    ('shoulder_pan_joint', [[0.0, 0.0, 0.0], [0.0, 0.13585, 0.0]])
    """
    found = [(j.parent, matrix(j.placement)[:3, 3]) for j in robot]
    found += [(link.joint, matrix(link.placement)[:3, 3]) for link in robot.links]
    return [(joint, np.array([np.zeros(3), end])) for joint, end in found if np.linalg.norm(end) > 0]


def size(robot: Robot) -> float:
    """A length to scale drawings with: how far the robot reaches from its first frame at rest [m]."""
    from ..functions import fk

    if not robot.joints:
        return 1.0
    places = fk(robot, robot.neutral, engine="numpy")[:, :3, 3]
    return float(max(np.linalg.norm(places - places[0], axis=1).max(), 0.1))


def matrix(pose: Pose) -> np.ndarray:
    """The homogeneous matrix in floats, (4, 4)."""
    return pose.array


@dataclass(frozen=True)
class Body:
    """Where the mass of a link is, in the link's frame.

    Attributes
    ----------
    link : Link
    com : ndarray, shape (3,)
        [m]
    turn : ndarray, shape (3, 3)
        Principal axes as columns.
    radii : ndarray, shape (3,)
        Half axes of the homogeneous ellipsoid of the same mass and inertia [m]; 0 where there is none (moments that
        no body has).
    """

    link: Link
    com: np.ndarray
    turn: np.ndarray
    radii: np.ndarray


def bodies(robot: Robot) -> list[Body]:
    """Centres of mass and ellipsoids of inertia of all links with mass.

    An ellipsoid with half axes a, b, c has the moments m (b^2 + c^2) / 5, m (c^2 + a^2) / 5, m (a^2 + b^2) / 5, so that
    a^2 = 5 (J_b + J_c - J_a) / (2 m).

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.view.scene import bodies
    >>> [b.link.name for b in bodies(dp.load("ur5"))][:2]
    ['base_link', 'shoulder_link']
    """
    found = []
    for link in robot.links:
        mass = float(link.inertia.mass)
        if not mass > 0.0:
            continue
        com, J = link.inertia.central
        moments, turn = np.linalg.eigh(J.array)
        squares = 5 * (moments.sum() / 2 - moments) / mass
        radii = np.sqrt(squares) if np.all(squares >= -1e-12) else np.zeros(3)
        found.append(Body(link, com.array, turn * np.sign(np.linalg.det(turn)), np.nan_to_num(radii)))
    return found


def extent(robot: Robot, q: np.ndarray) -> tuple[np.ndarray, float]:
    """The middle and the radius of a ball around the robot: its joints and links at q."""
    from ..functions import fk

    places = [np.zeros(3)]
    for frame in robot.frames:
        places.append(fk(robot, q, frame, engine="numpy")[:3, 3])
    low, high = np.min(places, axis=0), np.max(places, axis=0)
    return (low + high) / 2, float(max(np.linalg.norm(high - low) / 2, 0.05))
