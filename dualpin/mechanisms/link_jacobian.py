"""Jacobians of links at their centres of mass, by the three routes of progressive dynamics."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import choice
from ..functions import fk, jacobian
from ..model.frames import COM
from ..model.robot import Robot
from ..spatial.adjoint import adjoint, inverted


def _transformed(robot: Robot, q: ArrayLike, link: str) -> np.ndarray:
    """T J, the Jacobian about the base's origin moved to the centre of mass.  (eqs 22-27)"""
    T = fk(robot, q, COM + link)
    return np.asarray(adjoint(inverted(T)) @ jacobian(robot, q, COM + link, "world"))


def _direct(robot: Robot, q: ArrayLike, link: str) -> np.ndarray:
    """Each joint's screw described in the link's axes at once.  (eq 28)"""
    return jacobian(robot, q, COM + link, "local")


def _rotated(robot: Robot, q: ArrayLike, link: str) -> np.ndarray:
    """The Jacobian of the centre of mass in the base's axes, turned into the link's.  (eqs 29-31)"""
    R = fk(robot, q, COM + link)[..., None, :3, :3]
    J = jacobian(robot, q, COM + link, "local_world_aligned")
    halves = J.reshape(*J.shape[:-2], 2, 3, J.shape[-1])
    turned: np.ndarray = (np.swapaxes(R, -1, -2) @ halves).reshape(J.shape)
    return turned


ROUTES: dict[str, Callable[[Robot, ArrayLike, str], np.ndarray]] = {
    "transformed": _transformed, "direct": _direct, "rotated": _rotated,
}  # fmt: skip


def link_jacobian(robot: Robot, q: ArrayLike, link: str, route: str = "direct") -> np.ndarray:
    """J of a link: from the velocities to the twist of its centre of mass, in the link's axes, shape (..., 6, nv).

        M_link = J^T diag(inertia about the centre, m 1) J

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    link : str
        A link with mass.
    route : "direct", "transformed" or "rotated"
        How it is computed; the result is the same.

    Returns
    -------
    ndarray, shape (..., 6, nv)
        Angular part first; the columns of joints that do not carry the link are zero.

    Raises
    ------
    FrameNotFoundError, ArgumentError

    References
    ----------
    Laus, Simoni & Martins, sec. 2.2, eqs 22-31.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot, q = dp.load("ur5"), np.ones(6)
    >>> J = dp.mechanisms.link_jacobian(robot, q, "forearm_link")
    >>> bool(np.allclose(J, dp.mechanisms.link_jacobian(robot, q, "forearm_link", "transformed")))
    True
    """
    return ROUTES[choice("link_jacobian: route", route, tuple(ROUTES))](robot, q, link)
