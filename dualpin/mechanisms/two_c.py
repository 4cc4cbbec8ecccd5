"""The arm with two cylindrical joints, and with it the nine arms of two C, R or P joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..algebra.displacements import dual_matrix
from ..dual import Dual, atan2
from ..errors import ArgumentError, DualDivisionError
from ..model.robot import STANDARD_GRAVITY, expect_numbers
from ..spatial import UX, Inertia, Rotation, Vector3
from .chain import DualChain
from .locked import Locked

KINDS = {"C": (0, 1), "R": (0,), "P": (1,)}  # the coordinates (angle, slide) that move
TOPOLOGIES = tuple(a + b for a in KINDS for b in KINDS)


class TwoC:
    """Two cylindrical joints: q = (theta1, d1, theta2, d2),  A_i = Z(theta_i + eps d_i) X(alpha_i + eps l_i).

    Parameters
    ----------
    l1, l2, alpha1, alpha2 : float
        Lengths [m] and twists [rad] of the links.
    bodies : pair of Inertia, optional
        In the links' distal frames, see `dualpin.mechanisms.body`.
    gravity : sequence of float

    References
    ----------
    Tapia Herrera et al., sec. 6: C, R, P joints as one dual angle with constant parts.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.mechanisms.TwoC(0.1005, 0.07)
    >>> q = [0.3, 0.2, -0.7, 0.15]
    >>> bool(np.allclose(arm.inverse_kinematics(dp.fk(arm.robot, q, "tip")), q, atol=1e-15))
    True
    """

    def __init__(
        self,
        l1: float,
        l2: float,
        alpha1: float = np.pi / 2,
        alpha2: float = 0.0,
        bodies: Sequence[Inertia] | None = None,
        gravity: Sequence[float] = STANDARD_GRAVITY,
    ) -> None:
        self.alpha = Dual([alpha1, alpha2], [l1, l2])
        self.chain = DualChain(self.alpha, bodies, gravity, name="2C arm")
        self.robot = self.chain.robot

    def inverse_kinematics(self, T: ArrayLike, tol: float = 1e-9) -> np.ndarray:
        """q = (theta1, d1, theta2, d2) of a pose of the tip, shape (..., 4).

        With N = M X(alpha2)^T = Z(q1) X(alpha1) Z(q2) in dual numbers, angles and slides together:

            q1 = atan2(N13, -N23),   q2 = atan2(N31, N32)        (sin(alpha1) > 0)

        Four coordinates reach a pose with one fixed direction cosine and one fixed length; the second
        solution (sin(alpha1) < 0) needs another arm.

        Parameters
        ----------
        T : array_like
            Homogeneous matrices (..., 4, 4), or Dual matrices (..., 3, 3).

        Raises
        ------
        ArgumentError
            If the pose is out of reach by more than tol.
        DualDivisionError
            If the joint axes are parallel.
        """
        expect_numbers("TwoC.inverse_kinematics", self.robot)
        M = T if isinstance(T, Dual) else dual_matrix(T)
        alpha1, alpha2 = self.alpha
        side = float(np.sign(np.sin(alpha1.real)))
        if abs(np.sin(alpha1.real)) < 1e-12:
            raise DualDivisionError("TwoC.inverse_kinematics: the joint axes are parallel (sin(alpha1) = 0)")
        X2 = Rotation.about(UX, Dual(float(alpha2.real), float(alpha2.dual)))
        rows = [Vector3(*(M[..., i, j] for j in range(3))) for i in range(3)]
        N = (Rotation(*rows) @ X2.T).rows
        q1 = atan2(N[0].z * side, -N[1].z * side)
        q2 = atan2(N[2].x * side, N[2].y * side)
        q = Dual(*(np.stack([getattr(t, part) for t in (q1, q2)], axis=-1) for part in ("real", "dual")))
        off = self.chain.pose(q) - M
        worst = float(max(np.abs(off.real).max(initial=0.0), np.abs(off.dual).max(initial=0.0)))
        if worst > tol * max(1.0, float(np.abs(M.dual).max(initial=0.0))):
            raise ArgumentError(
                f"TwoC.inverse_kinematics: the pose is out of reach by {worst:.3g}: two C joints have four freedoms"
            )
        return np.stack([q.real, q.dual], axis=-1).reshape(*q.shape[:-1], 4)

    def topology(self, name: str, at: ArrayLike = (0.0, 0.0, 0.0, 0.0)) -> Locked:
        """The arm with joints of these kinds, "CC", "CR", ... "PP": the other coordinates held at `at`."""
        if name not in TOPOLOGIES:
            raise ArgumentError(f"topology {name!r} is not one of {', '.join(TOPOLOGIES)}")
        free = [2 * i + k for i, kind in enumerate(name) for k in KINDS[kind]]
        return Locked(self.robot, free, at)

    def dual_coordinates(self, q: Any) -> Dual:
        """(theta1, d1, theta2, d2) as two dual numbers, shape (..., 2)."""
        q = np.asarray(q, dtype=float)
        return Dual(q[..., 0::2], q[..., 1::2])
