"""Parameters from measured torques: weighted least squares, and physical consistency."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import flag, numbers, real
from ...delegates import home
from ...errors import ArgumentError, ShapeError
from ...model.robot import Robot
from .base import TOLERANCE, BaseParameters, grouped
from .bodies import robot_of
from .consistency import nearest_bodies
from .parameters import Parameters

FLOOR = 1e-6
"""Lower bound of a joint's noise, relative to its torques, which bounds the scaling of the solver."""
BLOCK = 2_000_000
"""Numbers of a regressor that are held at once."""


@dataclass(frozen=True, eq=False)
class Identification:
    """Identified parameters of a robot; made by `dualpin.identify`.

    Attributes
    ----------
    base : BaseParameters
        The parameters that the motion determines.
    values : ndarray, shape (len(base),)
        Their estimate; with ``physical=True`` a physically consistent one.
    least_squares : ndarray, shape (len(base),)
        The estimate by least squares alone.
    covariance : ndarray, shape (len(base), len(base))
        Covariance of `least_squares`, (Y^T W Y)^-1.
    parameters : ndarray, shape (len(base.parameters),)
        All parameters that give `values`: the nearest to the description.
    noise : ndarray, shape (nv,)
        Standard deviation of each torque [N m, N]; nan where none was measured.
    residuals : ndarray, shape (n, nv)
        Measured less predicted torques; nan where none was measured.
    condition : float
        Of the weighted regressor with columns of unit length.
    physical : bool
    measured : ndarray, shape (n, nv)
    """

    base: BaseParameters
    values: np.ndarray
    least_squares: np.ndarray
    covariance: np.ndarray
    parameters: np.ndarray
    noise: np.ndarray
    residuals: np.ndarray
    condition: float
    physical: bool
    measured: np.ndarray

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviation of each base parameter, shape (len(base),)."""
        return np.sqrt(np.diag(self.covariance))

    @cached_property
    def robot(self) -> Robot:
        """The robot with the identified parameters: for `rnea` and all else, and `to_urdf`."""
        return robot_of(self.base.parameters, self.parameters)

    def predict(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> np.ndarray:
        """Torques of another motion, friction included, shape (..., nv)."""
        return self.base.parameters.regressor(q, v, a) @ self.parameters

    def table(self) -> list[dict[str, Any]]:
        """One record a base parameter: its name, the estimate, its deviation, the description's value."""
        rows = zip(self.base.names, self.values, self.deviation, self.base.values(), strict=True)
        return [
            {"parameter": name, "value": float(x), "deviation": float(s), "described": float(d)}
            for name, x, s, d in rows
        ]

    def plot(self, path: Any = None) -> Any:
        """Plot measured torques and residuals; see `plots.residuals`."""
        return home("Identification.plot")(self, path)

    def __repr__(self) -> str:
        noise = ", ".join(f"{x:.2g}" for x in self.noise[:8]) + (", ..." if len(self.noise) > 8 else "")
        how = "physical" if self.physical else "least squares"
        return f"<{len(self.base)} base parameters of {self.base.robot.name!r}, {how}: noise {noise}>"


def identify(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    tau: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    physical: bool = True,
    rotors: bool = False,
    friction: bool | str | tuple[str, ...] = False,
    tolerance: float = TOLERANCE,
) -> Identification:
    """Dynamic parameters from measured motion and torques.

        minimise  sum W (tau - Y_b b)^2      over b = G p, p of bodies that can exist

    Parameters
    ----------
    robot : Robot
        The description: its kinematics, and values of parameters that torques do not determine.
    q, v, a : array_like, shapes (n, nq), (n, nv), (n, nv)
        Measured, filtered and differentiated; their noise is not modelled.
    tau : array_like, shape (n, nv)
        Torques and forces of the joints [N m, N]; nan where there is no measurement.
    weights : array_like, shape (nv,) or (n, nv), optional
        1 / variance of each torque.  By default each joint's variance is estimated from the residuals of a first fit.
    physical : bool
        Bodies of positive density only (pseudo-inertia matrices positive semidefinite), rotors and friction not
        negative; needs ``pip install 'dualpin[identify]'``.
    rotors, friction, tolerance
        As in `dualpin.base_parameters`.

    Returns
    -------
    Identification
        With `.values`, `.deviation`, `.covariance`, `.parameters`, `.robot`, `.residuals`, `.plot()`.

    Raises
    ------
    ArgumentError, ShapeError
    DualpinError
        If CVXPY is missing, or its solver fails.

    References
    ----------
    Gautier & Poignet (2001) for weighted least squares; Wensing, Kim & Slotine (2018) for the constraints.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.load("ur5")
    >>> q, v, a = arm.sample(200, seed=0)
    >>> tau = dp.rnea(arm, q, v, a) + 0.1 * np.random.default_rng(0).standard_normal(v.shape)
    >>> found = dp.identify(arm, q, v, a, tau, physical=False)
    >>> len(found.base), bool((abs(found.values - found.base.values()) < 5 * found.deviation).all())
    (36, True)
    """
    parameters = Parameters.of("identify", robot, rotors, friction)
    physical = flag("identify: physical", physical)
    tolerance = real("identify: tolerance", tolerance, above=0)
    q, v, a, tau = _arrays(robot, q, v, a, tau)
    given = _weights(weights, tau)
    joints = _triangles(parameters, q, v, a, tau, given)
    base = grouped(parameters, np.vstack([A[:, :-1] for A in joints]), tolerance)
    k, count = len(base), int((np.isfinite(tau) & (True if given is None else given > 0)).sum())
    if count <= k:
        raise ArgumentError(f"identify: {k} base parameters, and only {count} torques measured")
    seen = [A[:, [*base.columns, -1]] for A in joints]
    R, z = _together(seen, np.ones(robot.nv))
    if given is None:
        first = np.append(_solved(R, z), -1.0)
        R, z = _together(seen, _noise(np.array([np.sum((A @ first) ** 2) for A in seen]), tau, k))
    b, p = _solved(R, z), parameters.nominal
    if physical:
        signs = [i for i, (model, *_) in enumerate(parameters.of_joints, parameters.inertial) if model != "offset"]
        p = nearest_bodies(base.grouping, R, b, p, len(robot), signs)
        values = base.grouping @ p
    else:
        values = b
        p = p + np.linalg.pinv(base.grouping) @ (b - base.values())
    residuals = tau - np.concatenate(
        [base.regressor(q[at], v[at], a[at]) @ values for at in _blocks(parameters, len(q))]
    )
    noise = _noise(np.nansum(residuals**2, axis=0), tau, k)
    inverse = np.linalg.inv(R)
    condition = float(np.linalg.cond(R / np.linalg.norm(R, axis=0)))
    return Identification(base, values, b, inverse @ inverse.T, p, noise, residuals, condition, physical, tau)


def _arrays(robot: Robot, *given: ArrayLike) -> tuple[np.ndarray, ...]:
    """q, v, a, tau as (n, size), equally long; only torques may be nan."""
    arrays, sizes = [], (robot.nq, robot.nv, robot.nv, robot.nv)
    for name, value, size in zip(("q", "v", "a", "tau"), given, sizes, strict=True):
        x = numbers(f"identify: {name}", value)
        if x.ndim != 2 or x.shape[1] != size:
            raise ShapeError(f"identify: {name} of shape (n, {size}) expected, got {x.shape}")
        if not np.isfinite(x).all() and name != "tau":
            raise ArgumentError(f"identify: {name} is not finite in row {np.argwhere(~np.isfinite(x))[0, 0]}")
        arrays.append(x)
    if len({len(x) for x in arrays}) != 1:
        raise ShapeError(f"identify: q, v, a, tau of {', '.join(str(len(x)) for x in arrays)} rows; as many expected")
    if np.isinf(arrays[3]).any():
        raise ArgumentError("identify: tau is infinite; nan stands for what was not measured")
    return tuple(arrays)


def _weights(weights: ArrayLike | None, tau: np.ndarray) -> np.ndarray | None:
    if weights is None:
        return None
    W = numbers("identify: weights", weights)
    if W.shape not in (tau.shape, tau.shape[1:]):
        raise ShapeError(f"identify: weights of shape {tau.shape[1:]} or {tau.shape} expected, got {W.shape}")
    if not (np.isfinite(W) & (W >= 0)).all():
        raise ArgumentError("identify: weights are 1 / variance: finite numbers of 0 or more expected")
    return np.broadcast_to(W, tau.shape)


def _blocks(parameters: Parameters, n: int) -> list[slice]:
    step = max(1, BLOCK // max(1, parameters.robot.nv * len(parameters)))
    return [slice(i, min(n, i + step)) for i in range(0, n, step)]


def _triangles(
    parameters: Parameters, q: np.ndarray, v: np.ndarray, a: np.ndarray, tau: np.ndarray, W: np.ndarray | None
) -> list[np.ndarray]:
    """The triangular factor of each joint's [Y tau], all that is needed of its data; unmeasured torques are no rows."""
    found = [np.zeros((0, len(parameters) + 1)) for _ in range(parameters.robot.nv)]
    for at in _blocks(parameters, len(q)):
        A = np.concatenate([parameters.regressor(q[at], v[at], a[at]), tau[at][..., None]], axis=-1)
        if W is not None:
            A = A * np.sqrt(W[at])[..., None]
        for k, known in enumerate(np.isfinite(tau[at]).T):
            found[k] = np.asarray(np.linalg.qr(np.vstack([found[k], A[known, k]]), mode="r"))
    return found


def _together(joints: list[np.ndarray], noise: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """R and z with |R b - z|^2 the sum of all joints' squared errors, each over its noise, but for a constant."""
    k = joints[0].shape[1] - 1
    A = np.linalg.qr(np.vstack([A / s for A, s in zip(joints, noise, strict=True) if np.isfinite(s)]), mode="r")
    return np.asarray(A)[:k, :k], np.asarray(A)[:k, k]


def _solved(R: np.ndarray, z: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(R, axis=0)
    return np.linalg.solve(R / size, z) / size


def _noise(squares: np.ndarray, tau: np.ndarray, k: int) -> np.ndarray:
    """Standard deviation of each joint's torque from its sum of squares; its share of k parameters is off the count."""
    count = np.isfinite(tau).sum(axis=0)
    free = np.maximum(count * (1 - k / max(count.sum(), 1)), 1e-3)
    least = FLOOR * np.sqrt(np.nansum(tau**2, axis=0) / np.maximum(count, 1))
    return np.where(count > 0, np.maximum(np.sqrt(squares / free), np.maximum(least, 1e-12)), np.nan)
