"""Screws of a robot: instantaneous screw axes, principal screws of inertia."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .. import functions
from ..algebra.motors import Motor
from ..arguments import is_symbol
from ..errors import ArgumentError
from ..model.robot import Frame, Robot
from ..spatial import Inertia


def instantaneous_screw(robot: Robot, q: ArrayLike, v: ArrayLike, frame: str | int | Frame) -> Motor:
    """The twist w + eps v of a frame about the world's origin: ``.axis`` is its instantaneous screw axis.

    Parameters
    ----------
    robot : Robot
    q : array_like (..., nq)
    v : array_like (..., nv)
    frame : str, int or Frame

    Returns
    -------
    Motor
        ``.axis``, ``.point``, ``.pitch``, ``.kind``; a resting frame is of kind "zero".

    Raises
    ------
    FrameNotFoundError, ShapeError, ArgumentError

    References
    ----------
    Ball (1900), ch. I; Lynch & Park (2017), 3.3.2.

    Examples
    --------
    >>> import dualpin as dp
    >>> arm = dp.mechanisms.TwoC(0.1, 0.07)
    >>> m = dp.mechanisms.instantaneous_screw(arm.robot, [0, 0, 0, 0], [2.0, 0.5, 0, 0], "tip")
    >>> float(m.pitch), m.kind.item()
    (0.25, 'screw')
    """
    twist = functions.frame_velocity(robot, q, v, frame)
    return Motor(twist[..., :3], twist[..., 3:])


@dataclass(frozen=True)
class PrincipalScrews:
    """The six screws on which a body's inertia is diagonal.

    An impulsive wrench on a principal screw starts the body moving on the same screw.  They lie in pairs on the
    principal axes through the centre of mass, with pitches plus and minus the radius of gyration.
    """

    mass: float
    center: np.ndarray
    axes: np.ndarray
    """Columns: right-handed principal axes in the link's frame."""
    radii: np.ndarray
    """Radii of gyration about them, ascending [m]."""

    @property
    def pitches(self) -> np.ndarray:
        """(a, -a, b, -b, c, -c)."""
        return np.repeat(self.radii, 2) * [1, -1, 1, -1, 1, -1]

    @property
    def principal(self) -> np.ndarray:
        """Rows [v; w] = (+-a, 0, 0; 1, 0, 0) ... in principal axes: the screws of the paper, (6, 6).

        S^T S = 2 diag(a^2, b^2, c^2, 1, 1, 1) with the angular part taken as a, b, c times the axes.
        """
        eye = np.eye(3)
        return np.array([np.concatenate((s * r * eye[i], eye[i])) for i, r in enumerate(self.radii) for s in (1, -1)])

    @property
    def screws(self) -> list[Motor]:
        """The same as motors u + eps (c x u + pitch u) in the link's frame."""
        pairs = zip(self.pitches, np.repeat(self.axes.T, 2, axis=0), strict=True)
        return [Motor(u, np.cross(self.center, u) + h * u) for h, u in pairs]

    @property
    def matrix(self) -> np.ndarray:
        """(m / 2) T S^T S T^T: the inertia about the centre of mass in link axes, diag(J_c, m 1), (6, 6)."""
        S = self.principal
        T = np.kron(np.eye(2), self.axes)
        return self.mass / 2 * T @ S.T @ S @ T.T


def principal_screws(body: Inertia | Robot, link: str | None = None) -> PrincipalScrews:
    """The principal screws of inertia of a body, or of a robot's link in the link's frame.

    Parameters
    ----------
    body : Inertia or Robot
    link : str, optional
        The link's name, for a robot.

    Returns
    -------
    PrincipalScrews

    Raises
    ------
    ArgumentError
        Of a body without mass, or whose inertia is not positive.

    References
    ----------
    Ball (1900), ch. VIII; Laus, Simoni & Martins, eqs 2-11.

    Examples
    --------
    >>> import dualpin as dp
    >>> rod = dp.mechanisms.body(2.0, [0, 0, 1.0], [[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.08]])
    >>> dp.mechanisms.principal_screws(rod).radii.round(12).tolist()
    [0.2, 0.5, 0.5]
    """
    if isinstance(body, Robot):
        named = [k for k in body.links if k.name == link]
        if not named:
            body.frame(link if link is not None else "")  # raises, with the nearest names
            raise ArgumentError(f"principal_screws: {link!r} is a frame of {body.name} without a link")
        body = named[0].inertia
    if any(map(is_symbol, body.parameters)):
        raise ArgumentError("principal_screws: a body of numbers is needed; its axes solve an eigenvalue problem")
    m = float(body.mass)
    if not m > 0:
        raise ArgumentError(f"principal_screws: a body with mass is needed, got {m} kg")
    com, central = body.central
    c = com.array
    moments, axes = np.linalg.eigh(central.array)
    if moments[0] < -1e-12 * moments[-1]:
        raise ArgumentError(f"principal_screws: the inertia about the centre of mass is not positive: {moments}")
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return PrincipalScrews(m, c, axes, np.sqrt(np.maximum(moments, 0.0) / m))
