"""Base parameters: the identifiable combinations of dynamic parameters.

Many of the parameters p in tau = Y p have the same effect in every motion, or none.  A column of Y that is a linear
combination of the columns before it is redundant:

    Y_d = Y_b K        tau = Y_b (p_b + K p_d)

so the columns Y_b and the base parameters p_b + K p_d describe all torques.  The columns are processed from the ground
to the tips, so that indistinguishable parameters are assigned to the body nearer to the ground, as in the literature.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, pi, prod

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import numbers, real
from ...errors import ArgumentError
from ...model.limits import FREE
from ...model.robot import Robot
from .parameters import INERTIAL, Parameters

TOLERANCE = 1e-9
"""A unit column nearer than this to the others is one of their combinations.

The distance of an exact combination is 1e-15 to 1e-13 (rounding), that of an independent column 0.1
and more on the robots of the catalogue.  Rounded decimals of a description lie between (1.5708 for a
right angle leaves 4e-6): such a column counts as independent, and `Margin.doubtful` reports it.
"""
DOUBTFUL = 1e-4
"""A base column nearer than this to the others is probably caused by rounded decimals of the description."""
ORDER = ("Jxx", "Jxy", "Jxz", "Jyy", "Jyz", "Jzz", "hx", "hy", "hz", "m")
"""Order of a body's columns: the first independent ones are kept, as in Gautier and Khalil (1990)."""
NOISE = 1e-12
"""A factor of K this much smaller than the largest of its column is the rounding of an exact zero."""
SHOWN = 1e-9
"""A factor this near to one is written as none."""
SAMPLES = 4
"""Random states, times columns over rows: many more rows than columns."""
BLOCK = 2_000_000
"""Numbers of a regressor that are held at once; longer motions are triangularised block by block."""


@dataclass(frozen=True)
class Margin:
    """The certainty of the count: distances of unit columns from the span of the columns before them.

    Attributes
    ----------
    kept : float
        The least of the columns that were kept.
    dropped : float
        The largest of those that were left out.
    tolerance : float
        The threshold between them.
    doubtful : tuple of str
        The kept parameters below 1e-4: due to rounded decimals, or hardly excited by the motion.
    """

    kept: float
    dropped: float
    tolerance: float
    doubtful: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class BaseParameters:
    """The minimal parameters of a robot; made by `dualpin.base_parameters`.

    Attributes
    ----------
    parameters : Parameters
        All of them, with their names and the whole regressor.
    columns : ndarray of int, shape (len,)
        Which of them are the base.
    grouping : ndarray, shape (len, len(parameters))
        The map from all parameters to base parameters: the identity in `columns`, and K.
    margin : Margin
        How certain `len` is.
    """

    parameters: Parameters
    columns: np.ndarray
    grouping: np.ndarray
    margin: Margin

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def robot(self) -> Robot:
        return self.parameters.robot

    @cached_property
    def names(self) -> list[str]:
        """Names, such as "Jzz[b] + 0.25 m[c]"."""
        return [_sum(row, self.parameters.names, first) for row, first in zip(self.grouping, self.columns, strict=True)]

    @cached_property
    def identifiable(self) -> dict[str, str]:
        """For each parameter: "alone", "regrouped" (only together with others), or "unseen" (no effect)."""
        seen, shared = self.grouping != 0, (self.grouping != 0).sum(axis=1) > 1
        regrouped = np.where((seen & shared[:, None]).any(axis=0), "regrouped", "alone")
        return dict(zip(self.parameters.names, np.where(seen.any(axis=0), regrouped, "unseen").tolist(), strict=True))

    def values(self, parameters: ArrayLike | None = None) -> np.ndarray:
        """The base parameters of given ones, shape (..., len); by default of the robot as it is described.

        Parameters
        ----------
        parameters : array_like, shape (..., len(.parameters)) or (..., 10 njoints), optional
            As `dualpin.inertial_parameters` gives them, or one for each of `.parameters.names`.
        """
        return self.parameters.vector("values", parameters) @ self.grouping.T

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, engine: str = "auto") -> np.ndarray:
        """Y_b of shape (..., nv, len), with tau = Y_b values."""
        return self.parameters.regressor(q, v, a, engine)[..., self.columns]

    def __repr__(self) -> str:
        margin = f"kept {self.margin.kept:.1e}, dropped {self.margin.dropped:.1e}"
        return f"<{len(self)} base parameters, of {len(self.parameters)}, of {self.robot.name!r}: {margin}>"


def base_parameters(
    robot: Robot,
    motion: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
    *,
    rotors: bool = False,
    friction: bool | str | tuple[str, ...] = False,
    tolerance: float = TOLERANCE,
) -> BaseParameters:
    """The minimal set of dynamic parameters that determines the torques.

        tau = Y p = Y_b (p_b + K p_d)

    Parameters
    ----------
    robot : Robot
    motion : (q, v, a), optional
        Arrays (n, nq), (n, nv), (n, nv): the parameters that this motion determines.  By default those of any
        motion, from random states without limits.
    rotors : bool
        Give every driven joint a rotor inertia; without it those joints have one whose armature is
        known, if any.
    friction : bool, str or tuple of str
        Give every driven joint friction: "viscous", "coulomb", "offset"; True means the first two.
    tolerance : float
        A unit column nearer than this to the span of the others is left out.

    Returns
    -------
    BaseParameters
        With `len()`, `.names`, `.values(parameters)`, `.regressor(q, v, a)`, `.grouping`, `.margin`.

    Raises
    ------
    ArgumentError, ShapeError

    References
    ----------
    Gautier & Khalil (1990), direct calculation of minimum inertial parameters of serial robots;
    Gautier (1991), numerical calculation of the base inertial parameters of robots, by QR;
    Mayeda, Yoshida & Osuka (1990) for the counts.

    Examples
    --------
    >>> import dualpin as dp
    >>> base = dp.base_parameters(dp.load("ur10"))
    >>> len(base), base.names[1:3]
    (36, ['hx[shoulder_lift_joint]', 'hz[shoulder_lift_joint] + 0.612 m[elbow_joint] + 0.612 m[wrist_1_joint] + ...'])
    """
    parameters = Parameters.of("base_parameters", robot, rotors, friction)
    tolerance = real("base_parameters: tolerance", tolerance, above=0)
    R = _triangle(parameters, _states(parameters) if motion is None else _given(motion))
    return grouped(parameters, R, tolerance)


def grouped(parameters: Parameters, W: np.ndarray, tolerance: float = TOLERANCE) -> BaseParameters:
    """The base among the columns of a matrix (rows, len), by a QR decomposition that skips dependent columns."""
    size = np.linalg.norm(W, axis=0)
    seen = size > tolerance * size.max(initial=0.0)
    U = W / np.where(seen, size, 1.0)
    Q, kept, distances, dropped = np.zeros((len(W), 0)), [], [], 0.0
    for i in _order(parameters):
        if not seen[i]:
            continue
        rest = U[:, i]
        for _ in range(2):  # twice is enough (Kahan; Parlett 1980)
            rest = rest - Q @ (Q.T @ rest)
        distance = float(np.linalg.norm(rest))
        if distance > tolerance and Q.shape[1] < len(W):
            Q = np.column_stack([Q, rest / distance])
            kept.append(i)
            distances.append(distance)
        else:
            dropped = max(dropped, distance)
    columns = np.array(sorted(kept), dtype=int)
    others = np.setdiff1d(np.flatnonzero(seen), columns)
    grouping = np.zeros((len(columns), len(parameters)))
    grouping[np.arange(len(columns)), columns] = 1.0
    if len(columns) and len(others):
        K = np.linalg.lstsq(U[:, columns], U[:, others], rcond=None)[0] * size[others] / size[columns][:, None]
        noise = NOISE * np.abs(K).max(axis=0, initial=0.0)
        grouping[:, others] = np.where(np.abs(K) > noise, K, 0.0)
    doubtful = tuple(parameters.names[i] for i, d in zip(kept, distances, strict=True) if d < DOUBTFUL)
    margin = Margin(min(distances, default=inf), dropped, tolerance, doubtful)
    return BaseParameters(parameters, columns, grouping, margin)


def _order(parameters: Parameters) -> list[int]:
    """The columns, each body followed by its rotor, from the ground to the tips; friction last."""
    of_joint: dict[str, list[int]] = {}
    friction: list[int] = []
    for i, (model, b, _) in enumerate(parameters.of_joints, parameters.inertial):
        (of_joint.setdefault(b.name, []) if model == "rotor" else friction).append(i)
    found: list[int] = []
    for b in parameters.robot:
        found += [10 * b.index + INERTIAL.index(symbol) for symbol in ORDER] + of_joint.get(b.name, [])
    return found + friction


def _states(parameters: Parameters) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random states without limits: angles of a turn, lengths of 2 m, with speeds at which all columns matter."""
    robot, rng = parameters.robot, np.random.default_rng(0)
    n = SAMPLES + SAMPLES * len(parameters) // max(robot.nv, 1)
    q = np.empty((n, robot.nq))
    for b in robot:
        if b.mimic is None:
            for i, what in zip(range(b.q.start, b.q.stop), b.model.coordinates, strict=True):
                q[:, i] = rng.uniform(-1, 1, n) * FREE.get(what, 1.0)
            for at in b.quaternions:
                r = rng.standard_normal((n, 4))
                q[:, at] = r / np.linalg.norm(r, axis=1, keepdims=True)
    return q, rng.uniform(-pi, pi, (n, robot.nv)), rng.uniform(-2 * pi, 2 * pi, (n, robot.nv))


def _given(motion: object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    if not isinstance(motion, (tuple, list)) or len(motion) != 3:
        raise ArgumentError("base_parameters: motion: a tuple of three arrays (q, v, a) expected")
    q, v, a = (np.atleast_2d(numbers(f"base_parameters: {k}", x)) for k, x in zip("qva", motion, strict=True))
    if not all(np.isfinite(x).all() for x in (q, v, a)):
        raise ArgumentError("base_parameters: motion: it is not finite everywhere")
    return q, v, a


def _triangle(parameters: Parameters, motion: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
    """The factor R of the stacked regressor, which has its columns' lengths and angles; block by block."""
    size = len(parameters)
    R = np.zeros((0, size))
    step = max(1, BLOCK // max(1, parameters.robot.nv * size))
    for start in range(0, len(motion[0]), step):
        q, v, a = (x[start : start + step] for x in motion)
        Y = parameters.regressor(q, v, a, "numpy")
        R = np.asarray(np.linalg.qr(np.vstack([R, Y.reshape(prod(Y.shape[:-1]), size)]), mode="r"))
    return R


def _sum(factors: np.ndarray, names: list[str], first: int) -> str:
    """A sum as it is written: its own parameter first, factors of one left out."""
    text = names[first]
    for i in np.flatnonzero(factors):
        if i != first:
            x = float(factors[i])
            size = "" if abs(abs(x) - 1) < SHOWN else f"{abs(x):.6g} "
            text += f" {'-' if x < 0 else '+'} {size}{names[i]}"
    return text
