"""Checks and losses of a simulation: whether the mass matrix can be inverted; damping and dry friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..algorithms.aba import factorised
from ..errors import ArgumentError
from ..functions import crba
from ..model.robot import Robot
from .rates import SLOW, drag

LOST = 16  # roundings, times the number of joints, that elimination leaves of a pivot that is zero


def check_inertia(what: str, robot: Robot, q: np.ndarray, engine: str = "auto") -> None:
    """Refuse configurations (B, nq) in which a joint moves no inertia: there no acceleration is determined.

    M = L^T D L from the tips inwards: D_k is the inertia that joint k moves while all joints beyond it are
    free.  Where it vanishes beside M_kk, joint k (or a motion of it with those beyond) moves nothing.

    Raises
    ------
    ArgumentError
        That names the joints.
    """
    if not len(q) or not robot.nv:
        return
    M = crba(robot, q, engine=engine)
    n = robot.nv
    with np.errstate(all="ignore"):
        _, pivots = factorised([[M[:, i, j] for j in range(n)] for i in range(n)])
    D = np.stack([np.broadcast_to(np.asarray(d, dtype=float), len(q)) for d in pivots], axis=-1)
    wrong = ~(LOST * n * np.finfo(float).eps * np.diagonal(M, axis1=-2, axis2=-1) < D)
    if not wrong.any():
        return
    member = int(np.argmax(wrong.any(axis=-1)))
    # after a zero pivot the remaining ones are not finite: the outermost is the cause
    k = int(np.flatnonzero(wrong[member])[-1])
    moved = [j for j in robot if j.mimic is None and j.v.start <= k < j.v.stop]
    name = moved[0].name if moved else f"v[{k}]"
    if robot.mass == 0:
        reason = f"{robot.name} has no mass"
    elif not M[member, k, k] > 0:
        reason = f"joint {name!r} moves no mass"
    else:
        reason = f"joint {name!r} and those beyond it can move together without moving any mass"
    where = f" (member {member} of the batch)" if len(q) > 1 else ""
    raise ArgumentError(
        f"{what}: the mass matrix is singular{where}: {reason}, so its acceleration is not determined; give its links "
        "an inertia, or the joint an armature"
    )


@dataclass(frozen=True)
class Losses:
    """Damping and dry friction of each velocity, (nv,) each."""

    viscous: np.ndarray
    dry: np.ndarray
    notes: tuple[str, ...]

    def torque(self, v: np.ndarray) -> np.ndarray:
        """Against the motion, (..., nv)."""
        found: np.ndarray = drag(v, self.viscous, self.dry)
        return found

    def energy(self, t: np.ndarray, v: np.ndarray) -> np.ndarray:
        """What was lost by the times t (n,), (..., n) [J]: the power by the trapezoidal rule, for v (..., n, nv)."""
        power = (v * self.torque(v)).sum(axis=-1)
        steps = np.diff(t) * (power[..., 1:] + power[..., :-1]) / 2
        return np.concatenate([np.zeros((*power.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)


def file_losses(robot: Robot) -> Losses:
    """Damping and friction as the description states them; those of followers by the square of their multiplier.

    A follower turns m times as fast: its damping d takes the power d (m v)^2, its friction f |m v|.
    """
    viscous, dry = np.zeros(robot.nv), np.zeros(robot.nv)
    damped, rubbing = [], []
    for j in robot:
        m = 1.0 if j.mimic is None else abs(float(j.coupling[0]))
        viscous[j.v] += m * m * j.damping
        dry[j.v] += m * j.friction
        damped += [j.name] if j.damping else []
        rubbing += [j.name] if j.friction else []
    for name, x in (("damping", viscous), ("friction", dry)):
        if (x < 0).any() or not np.isfinite(x).all():
            raise ArgumentError(f"simulate: dissipation='file': {name} of {robot.name} is negative or not finite: {x}")
    notes = []
    if damped:
        notes.append(f"dissipation: damping of {', '.join(damped)}, as the file says")
    if rubbing:
        notes.append(f"dissipation: dry friction of {', '.join(rubbing)}, as the file says; it fades below {SLOW:g}/s")
    if not notes:
        notes.append(f"dissipation: the description of {robot.name} states neither damping nor friction")
    return Losses(viscous, dry, tuple(notes))
