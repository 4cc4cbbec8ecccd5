"""Serial chains in dual matrices: every joint a dual angle, every link a dual twist."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..algebra.arguments import dual_array
from ..algebra.displacements import stacked
from ..algebra.motors import Motor
from ..algorithms import kinematics
from ..algorithms.rnea import joint_wrenches, rnea
from ..arguments import entries
from ..dual import Dual, stack
from ..errors import ArgumentError, ShapeError
from ..model import Builder, cylindrical
from ..model.robot import STANDARD_GRAVITY, Robot, gravity_vector
from ..parts import array, joined
from ..scalars import exact
from ..spatial import UX, UZ, Inertia, Matrix3, Pose, Rotation, Vector3


def body(mass: Any, com: ArrayLike, inertia: ArrayLike) -> Inertia:
    """A rigid body by its mass, centre of mass, and inertia (3, 3) about the centre of mass; numbers or symbols.

    Parameters
    ----------
    mass : scalar
        [kg]
    com : array_like, shape (3,)
        Centre of mass in the frame of the body [m].
    inertia : array_like, shape (3, 3)
        About the centre of mass, in the axes of that frame [kg m^2].

    Returns
    -------
    Inertia
        About the origin of the frame, as robots have it.

    Raises
    ------
    ShapeError, ArgumentError
        For other shapes, or what is neither number nor symbol.

    References
    ----------
    Featherstone (2008), 2.13.

    Examples
    --------
    >>> import dualpin as dp
    >>> rod = dp.mechanisms.body(2.0, [0, 0, 0.5], [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    >>> rod.rotational.array.diagonal().round(12).tolist()
    [0.6, 0.6, 0.1]
    """
    parts = []
    for what, x, shape in (("mass", mass, ()), ("com", com, (3,)), ("inertia", inertia, (3, 3))):
        given = entries(f"body: {what}", x)
        if given.shape != shape:
            raise ShapeError(f"body: {what} of shape {shape} expected, got {given.shape}")
        parts.append(given.tolist())
    return Inertia.of(*parts)


class DualChain:
    """A serial chain of joints about z-axes, in Denavit-Hartenberg's dual matrices.

        M_i = Z(theta_i + eps d_i) X(alpha_i + eps a_i)        frame i - 1 to frame i, standard (distal)

    Every joint is driven by a dual number q_i: its real part turns, its dual part slides.  A revolute joint keeps
    its slide constant, a prismatic one its angle: the same program serves all.

    Parameters
    ----------
    alpha : Dual or array_like (n,)
        alpha_i + eps a_i of the links.  Here and below, numbers or SymPy's symbols, also functions of time.
    bodies : sequence of Inertia, optional
        The links' inertia in their distal frames, see `body`; needed for forces only.
    gravity : array_like (3,)
    name : str
        Of the robot.

    Attributes
    ----------
    robot : Robot
        The same chain with cylindrical joints C1, C2, ..., q = (angle, slide, angle, slide, ...), and the links'
        distal frames link1_end, ..., tip.

    References
    ----------
    Tapia Herrera et al., kinematics and dynamics by dual numbers; Fischer (1999), *Dual-Number Methods*.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.mechanisms.DualChain(dp.Dual([np.pi / 2, 0.0], [100.5, 70.0]))
    >>> arm.position(dp.Dual([0.5, -0.8], [20.0, 15.0])).round(4).tolist()
    [138.1877, 58.3999, -30.2149]
    """

    def __init__(
        self, alpha: Any, bodies: Sequence[Inertia] | None = None, gravity: Sequence[float] = STANDARD_GRAVITY,
        name: str = "chain",
    ) -> None:  # fmt: skip
        a, b = dual_array("DualChain: alpha", alpha, 1, symbols=True)
        if a.ndim != 1:
            raise ShapeError(f"DualChain: alpha of shape (n,) expected, got {a.shape}")
        self.alpha = Dual(a, b)
        self.gravity = gravity_vector(gravity)
        if bodies is not None and len(bodies) != len(a):
            raise ShapeError(f"DualChain: one body for each of {len(a)} links expected, got {len(bodies)}")
        self.bodies = bodies
        self._ends = [f"link{i + 1}_end" for i in range(len(a) - 1)] + ["tip"] * (len(a) > 0)
        self._links = [Pose.about(UX, Dual(x, y)).snapped for x, y in zip(a.tolist(), b.tolist(), strict=True)]
        self.robot = self._robot(name)

    def __len__(self) -> int:
        return len(self._links)

    def _columns(self, what: str, x: Any) -> list[Dual]:
        a, b = dual_array(what, x, 1, symbols=True)
        if a.shape[-1] != len(self):
            raise ShapeError(f"{what} of shape (..., {len(self)}) expected, got {a.shape}")
        columns = ((a[..., i][()], b[..., i][()]) for i in range(len(self)))
        symbols = object in (a.dtype, b.dtype)  # 0 and 1 as integers: formulas then contain no factor 1.0
        return [Dual(exact(x), exact(y)) if symbols else Dual(x, y) for x, y in columns]

    def steps(self, q: Any) -> list[Rotation]:
        """M_i of each joint, as dual rotations."""
        return [Rotation.about(UZ, t) @ X.dual_matrix for t, X in zip(self._columns("q", q), self._links, strict=True)]

    def matrices(self, q: Any) -> list[Dual]:
        """M_i of each joint, dual arrays (..., 3, 3)."""
        return [stacked(M) for M in self.steps(q)]

    def pose(self, q: Any) -> Dual:
        """The product of all M_i: R + eps [p] R of the last frame in the base, shape (..., 3, 3).

        Parameters
        ----------
        q : Dual, shape (..., n)
        """
        return stacked(_product(self.steps(q)))

    def position(self, q: Any) -> np.ndarray:
        """p of the pose, [p] = dual part times R^T, shape (..., 3)."""
        M = self.pose(q)
        S = M.dual @ M.real.swapaxes(-1, -2)
        return np.stack([S[..., 2, 1], S[..., 0, 2], S[..., 1, 0]], axis=-1)

    # velocities

    def generalized_jacobian(self, q: Any) -> Dual:
        """[nM_0 ... nM_{n-1}]: from the stacked joint motors to the motor of the last frame, (..., 3, 3 n).

        nM_{i-1} is the transpose of M_i ... M_n.
        """
        blocks, outward = [], None
        for M in reversed(self.steps(q)):
            outward = M if outward is None else M @ outward
            blocks.append(stacked(outward.T))
        return joined(np.concatenate, Dual, blocks[::-1], axis=-1)

    def jacobian(self, q: Any) -> np.ndarray:
        """The ordinary one: twist [w; v] of the last frame in its own axes, from (rates, slides), (..., 6, 2 n).

        Third columns k of the generalised Jacobian's blocks: [Re k; Du k] for a rate, [0; Re k] for a slide.
        """
        J = self.generalized_jacobian(q)[..., 2::3]
        angular = np.concatenate((J.real, np.zeros_like(J.real)), axis=-1)
        return np.concatenate((angular, np.concatenate((J.dual, J.real), axis=-1)), axis=-2)

    def velocity(self, q: Any, v: Any) -> Motor:
        """Twist of the last frame, w + eps (velocity of its origin), in the base's axes.

            R_n sum of nM_{i-1} z v_i

        Parameters
        ----------
        q, v : Dual, shape (..., n)
        """
        V = self.velocities(q, v)[-1]
        R = Matrix3(*(row.real for row in _product(self.steps(q)).rows))
        V = R @ V
        return Motor(*(np.stack([np.asarray(getattr(x, part)) for x in V], axis=-1) for part in ("real", "dual")))

    def velocities(self, q: Any, v: Any) -> list[Vector3]:
        """The twist of each link in its own distal frame: V_i = M_i^T (V_{i-1} + z v_i), the dual velocity theorem."""
        X, V = kinematics.joint_poses(self.robot, self._coordinates("q", q)), self._coordinates("v", v)
        twists = kinematics.body_twists(self.robot, X, V)
        return [f.placement.pull(twists[f.joint]) for f in map(self.robot.frame, self._ends)]

    # forces

    def forces(self, q: Any, v: Any, a: Any) -> Dual:
        """Joint forces and torques:  force + eps torque, shape (..., n).

        The recursion of dual momenta is that of `dualpin.rnea` on cylindrical joints, whose every step is dual:

            V_i = M_i^T (V_{i-1} + z v_i)                     outwards
            V'_i = M_i^T (V'_{i-1} + z a_i + V_{i-1} x z v_i)
            f_i = dH_i/dt + V_i x H_i                         with the momentum H = p + eps l = I V
            F_{i-1} = M_i (F_i + f_i)                         inwards; z component

        The base accelerates upwards instead of gravity pulling down.

        Parameters
        ----------
        q, v, a : Dual, shape (..., n)

        Raises
        ------
        ArgumentError
            Without bodies.
        """
        tau = np.broadcast_arrays(*map(array, rnea(self.robot, *self._state("forces", q, v, a))))
        return Dual(np.stack(tau[1::2], axis=-1), np.stack(tau[0::2], axis=-1))

    def joint_wrenches(self, q: Any, v: Any, a: Any) -> Dual:
        """The wrench that each joint transmits, force + eps moment of three components each, shape (..., n, 3).

            F_{i-1} = M_i (F_i + f_i)                         f_i as in `forces`, F_n = 0

        the wrench on link i from the link before, in frame i - 1 and about its origin.  The z component of F_{i-1} is
        what the joint's motors have to supply, see `forces`; the bearings carry the others.

        Parameters
        ----------
        q, v, a : Dual, shape (..., n)

        Raises
        ------
        ArgumentError
            Without bodies.

        References
        ----------
        Tapia Herrera et al. (2012), eqs 26-28 and the recursion of sec. 6.1.

        Examples
        --------
        A body of one kilogram held still at the end of a link of one metre, gravity along -y:

        >>> import numpy as np, dualpin as dp
        >>> body = dp.mechanisms.body(1.0, [0, 0, 0], np.zeros((3, 3)))
        >>> arm = dp.mechanisms.DualChain(dp.Dual([0.0], [1.0]), [body], gravity=(0, -9.81, 0))
        >>> F = arm.joint_wrenches(dp.Dual([0.0], 0.0), dp.Dual([0.0], 0.0), dp.Dual([0.0], 0.0))
        >>> F.real.tolist(), F.dual.tolist()
        ([[0.0, 9.81, 0.0]], [[0.0, 0.0, 9.81]])
        """
        state = self._state("joint_wrenches", q, v, a)
        held = zip(self._columns("q", q), joint_wrenches(self.robot, *state), strict=True)
        # the robot's joint wrenches are in the frame that has turned with the joint
        whole = [stack([Dual(*x.arrays) for x in Rotation.about(UZ, t) @ F], axis=-1) for t, F in held]
        real, dual = (np.broadcast_arrays(*(getattr(F, part) for F in whole)) for part in ("real", "dual"))
        return Dual(np.stack(real, axis=-2) + 0.0, np.stack(dual, axis=-2) + 0.0)

    def _state(self, who: str, q: Any, v: Any, a: Any) -> tuple[list[Any], list[Any], list[Any]]:
        if self.bodies is None:
            raise ArgumentError(f"DualChain.{who}: the bodies of the links are needed, see dualpin.mechanisms.body")
        return self._coordinates("q", q), self._coordinates("v", v), self._coordinates("a", a)

    def _coordinates(self, what: str, x: Any) -> list[np.ndarray]:
        """Angle and slide of each joint in turn."""
        return [part[()] for column in self._columns(what, x) for part in column.arrays]

    def _robot(self, name: str) -> Robot:
        b, on = Builder(name), None
        b.gravity = self.gravity
        for i, end in enumerate(self._ends):
            joint = f"C{i + 1}"
            b.joint(joint, cylindrical(), on=on)
            b.fixed(end, on=joint, placement=self._links[i], inertia=None if self.bodies is None else self.bodies[i])
            on = end
        return b.robot()


def _product(steps: Sequence[Rotation]) -> Rotation:
    total = steps[0]
    for M in steps[1:]:
        total = total @ M
    return total
