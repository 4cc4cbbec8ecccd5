"""Identification of a payload from torques."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import flag, numbers
from ...errors import ArgumentError, ShapeError
from ...functions import joint_torque_regressor, rnea
from ...model.robot import Frame, Robot
from ...spatial.inertia import Inertia
from .bodies import moved
from .consistency import nearest_bodies
from .fit import _arrays, _noise, _weights
from .parameters import INERTIAL, Parameters


@dataclass(frozen=True, eq=False)
class Payload:
    """A body that a robot carries; made by `dualpin.identify_payload`.

    Attributes
    ----------
    carrier : Robot
    frame : Frame
    parameters : ndarray, shape (10,)
        m; hx hy hz; Jxx Jxy Jyy Jxz Jyz Jzz about and in the axes of the frame.
    covariance : ndarray, shape (10, 10)
        Of their estimate by least squares.
    noise : ndarray, shape (nv,)
        Standard deviation of each torque.
    residuals : ndarray, shape (n, nv)
    """

    carrier: Robot
    frame: Frame
    parameters: np.ndarray
    covariance: np.ndarray
    noise: np.ndarray
    residuals: np.ndarray

    @property
    def mass(self) -> float:
        """[kg]"""
        return float(self.parameters[0])

    @property
    def com(self) -> np.ndarray:
        """Centre of mass in the frame [m], (3,)."""
        return np.asarray(self.parameters[1:4] / self.mass) if self.mass else np.full(3, np.nan)

    @property
    def inertia(self) -> np.ndarray:
        """About the centre of mass, in the frame's axes [kg m^2], (3, 3)."""
        _, J = self.body.central
        return J.array

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviations of the ten parameters."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def com_deviation(self) -> np.ndarray:
        """Of the centre of mass [m], to first order: d c = (d h - c d m) / m."""
        A = np.column_stack([-self.com, np.eye(3)]) / (self.mass or np.nan)
        return np.sqrt(np.diag(A @ self.covariance[:4, :4] @ A.T))

    @property
    def body(self) -> Inertia:
        return Inertia.from_array(self.parameters)

    @cached_property
    def robot(self) -> Robot:
        """The robot that carries it."""
        return self.carrier.attach(self.body, on=self.frame)

    def __repr__(self) -> str:
        com = ", ".join(f"{x:.4g}" for x in self.com)
        return f"<payload of {self.mass:.4g} +- {self.deviation[0]:.2g} kg at ({com}) m in {self.frame.name!r}>"


def identify_payload(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    tau: ArrayLike,
    frame: str | int | Frame | None = None,
    *,
    unloaded: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    physical: bool = True,
) -> Payload:
    """Mass, centre of mass and inertia of a payload.

        tau - tau_unloaded = Y_frame (m, h, J)

    Parameters
    ----------
    robot : Robot
        Without the payload.
    q, v, a : array_like, shapes (n, nq), (n, nv), (n, nv)
    tau : array_like, shape (n, nv)
        Measured with the payload [N m, N]; nan where there is no measurement.
    frame : str, int or Frame, optional
        The frame that carries it; by default the last one.
    unloaded : array_like, shape (n, nv), optional
        Torques of the same motion without the payload; by default what `rnea` says of `robot`.
        Measured ones contain friction and errors of the model, which then cancel.
    weights : array_like, optional
        As in `dualpin.identify`.
    physical : bool
        Only physically consistent bodies; needs ``pip install 'dualpin[identify]'``.

    Returns
    -------
    Payload

    Raises
    ------
    ArgumentError
        If the motion does not determine all ten parameters; the message names the undetermined directions.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.load("ur5")
    >>> box = dp.mechanisms.body(2.0, [0, 0, 0.1], np.eye(3) * 0.01)
    >>> q, v, a = arm.sample(100, seed=0)
    >>> dp.identify_payload(arm, q, v, a, dp.rnea(arm.attach(box), q, v, a), physical=False)
    <payload of 2 +- ... kg at (..., 0.1) m in 'tool0'>
    """
    Parameters.of("identify_payload", robot)
    physical = flag("identify_payload: physical", physical)
    at = robot.frames[-1] if frame is None else robot.frame(frame)
    if at.joint is None:
        raise ArgumentError(
            f"identify_payload: frame {at.name!r} stands on the ground, no torque shows what it carries"
        )
    q, v, a, tau = _arrays(robot, q, v, a, tau)
    before = rnea(robot, q, v, a) if unloaded is None else numbers("identify_payload: unloaded", unloaded)
    if before.shape != tau.shape:
        raise ShapeError(f"identify_payload: unloaded of shape {tau.shape} expected, got {before.shape}")
    first = 10 * at.joint.index
    Y = joint_torque_regressor(robot, q, v, a)[..., first : first + 10] @ moved(at.placement)
    rest = tau - before
    given = _weights(weights, tau)
    known = np.isfinite(rest)
    W = np.where(known, 1.0 if given is None else given, 0.0)
    p, _ = _solved(Y, rest, W)
    if given is None:
        W = np.where(known, 1 / _noise(np.nansum((rest - Y @ p) ** 2, axis=0), rest, 10) ** 2, 0.0)
    p, R = _solved(Y, rest, W)
    if physical:
        p = nearest_bodies(np.eye(10), R, p, p, 1)
    inverse = np.linalg.inv(R)
    residuals = rest - Y @ p
    return Payload(robot, at, p, inverse @ inverse.T, _noise(np.nansum(residuals**2, axis=0), rest, 10), residuals)


def _solved(Y: np.ndarray, rest: np.ndarray, W: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weighted least squares, and the root R of its information."""
    root = np.sqrt(W).reshape(-1, 1)
    A = np.linalg.qr(np.column_stack([root * Y.reshape(-1, 10), root[:, 0] * np.nan_to_num(rest).ravel()]), mode="r")
    R, z = np.asarray(A)[:10, :10], np.asarray(A)[:10, 10]
    size = np.linalg.norm(R, axis=0)
    if len(R) == 10:
        _, singular, Vh = np.linalg.svd(R / np.where(size > 0, size, 1))
        unseen = np.abs(Vh[singular < 1e-10 * singular[0]]).max(axis=0, initial=0.0) > 0.1
    if len(R) < 10 or unseen.any():
        left = ", ".join(n for n, x in zip(INERTIAL, unseen, strict=True) if x) if len(R) == 10 else "some of all ten"
        raise ArgumentError(f"identify_payload: this motion does not show all of the body; it leaves open {left}")
    return np.linalg.solve(R / size, z) / size, R
