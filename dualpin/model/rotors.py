"""Motors: geared rotors, carried by the preceding link."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..errors import ArgumentError
from ..scalars import Scalar
from .builder import Builder
from .robot import Robot
from .tree import Rotor


def with_rotors(robot: Robot, rotors: Mapping[str, Rotor | Scalar]) -> Robot:
    """The same robot with motors on some joints.

    A rotor with the inertia I about its own axis that turns `ratio` times as fast as its joint adds the
    reflected inertia ratio^2 I to the joint's coordinate: the joint's armature, which every term contains.
    Its mass, if given, is a body on the preceding link.  The coupling of the rotor's rotation with that of
    the carrying link, ratio I w_link . axis v, is neglected, as in Pinocchio.

    Parameters
    ----------
    rotors : mapping
        Joint name -> `Rotor`, or its inertia [kg m^2] alone: then the ratio is the one that the
        description's <transmission> states, or 1.

    Returns
    -------
    Robot
        With `Joint.rotor` and `Joint.armature` set; an earlier armature is replaced.

    Raises
    ------
    FrameNotFoundError
        If there is no such joint.
    ArgumentError
        If a joint has several coordinates, or an inertia is negative or a ratio is zero.

    References
    ----------
    Siciliano, Sciavicco, Villani & Oriolo (2009), 7.1; Featherstone (2008), 9.6.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.load("ur5")
    >>> geared = arm.with_rotors({"elbow_joint": dp.model.Rotor(inertia=1e-4, ratio=101.0)})
    >>> more = dp.crba(geared, np.zeros(6)) - dp.crba(arm, np.zeros(6))
    >>> round(float(more[2, 2]), 6), int(np.count_nonzero(more.round(12)))
    (1.0201, 1)
    """
    if not isinstance(rotors, Mapping):
        raise ArgumentError(f"with_rotors: a mapping of joint names to rotors expected, got {type(rotors).__name__}")
    b = Builder.of(robot)
    for name, given in rotors.items():
        b.motor(robot.joint(name).name, _rotor(robot, name, given))
    return b.robot()


def _rotor(robot: Robot, name: str, given: Any) -> Rotor:
    if isinstance(given, Rotor):
        return given
    known = robot.joint(name).rotor
    return replace(known, inertia=given) if known is not None else Rotor(given)
