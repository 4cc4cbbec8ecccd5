"""Input and results of a loop: its joints and dual angles, checked; its positions and motions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..algebra.arguments import dual_array, finite
from ..arguments import entries, numbers, real
from ..dual import Dual
from ..errors import ArgumentError, ShapeError

UNITS = {"R": ((1.0, 0.0),), "P": ((0.0, 1.0),), "C": ((1.0, 0.0), (0.0, 1.0))}
"""(turn, slide) that a unit of each coordinate adds to the joint's dual angle."""


@dataclass(frozen=True)
class LoopPosition:
    """One way in which a loop closes; dual angles in rad and m."""

    theta: tuple[Dual, ...]
    """theta_i + eps s_i of each joint."""
    closure: float
    """max |A1 ... An - 1| over both parts."""


@dataclass(frozen=True)
class LoopMotion:
    """A loop followed along its input.

    Attributes
    ----------
    q : ndarray, shape (n, nq)
        Coordinates, continuous: whole turns are counted.
    theta : Dual, shape (n, joints)
        Dual angles of the joints.
    closure : ndarray, shape (n,)
        max |A1 ... An - 1| over both parts.
    """

    q: np.ndarray
    theta: Dual
    closure: np.ndarray


def kinds(who: str, joints: Any) -> list[tuple[str, float]]:
    if not isinstance(joints, (str, list, tuple)) or len(joints) < 2:
        raise ArgumentError(f"{who}: joints: letters of R P C H expected, two or more, got {joints!r}")
    found = []
    for i, entry in enumerate(joints, 1):
        letter, pitch = entry if isinstance(entry, (list, tuple)) and len(entry) == 2 else (entry, None)
        if letter == "H" and pitch is not None:
            found.append((letter, real(f"{who}: pitch of joint {i}", pitch, "m/rad")))
        elif letter in UNITS and pitch is None:
            found.append((letter, 0.0))
        else:
            raise ArgumentError(f"{who}: joint {i} is {entry!r}; one of R, P, C, ('H', pitch) expected")
    return found


def dual_angles(what: str, value: Any, n: int, *, symbols: bool = False) -> Dual:
    """n dual angles: a Dual array, dual numbers, or pairs of real and dual part; with `symbols` also of formulas."""
    duals = isinstance(value, Dual) or (isinstance(value, (list, tuple)) and any(isinstance(x, Dual) for x in value))
    if not duals and np.ndim(value) == 2 and np.shape(value)[1] == 2:
        value = Dual(*(entries(what, value) if symbols else numbers(what, value)).T)
    a, b = dual_array(what, value, 1, symbols=symbols)
    if a.shape != (n,):
        raise ShapeError(f"{what}: {n} dual angles expected, one for each joint, got shape {a.shape}")
    if a.dtype != object:
        finite(what, a)
        finite(f"{what}, dual part", b)
    return Dual(a, b)
