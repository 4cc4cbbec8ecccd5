"""Forces, accelerations and matrices that libraries differentiate."""

from __future__ import annotations

from typing import Any

from ..model.robot import Robot
from .caller import Caller


class Dynamics(Caller):
    """Forces, accelerations and matrices, by one library."""

    def rnea(self, robot: Robot, q: Any, v: Any, a: Any, f_ext: Any = None) -> Any:
        """Inverse dynamics; see `dualpin.rnea`.  Differentiable twice.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        v, a : array, shape (..., nv)
        f_ext : array, shape (..., njoints, 6), optional
            As in `dualpin.rnea`.

        Returns
        -------
        array, shape (..., nv)
            Joint torques [N m] and forces [N].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 5.3; Griewank & Walther (2008), 3.2, for its gradient.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.rnea(robot, q, v, a).shape
        (3, 6)
        """
        return self._term(robot, "rnea", q, v, a, f_ext=f_ext)

    def aba(self, robot: Robot, q: Any, v: Any, tau: Any, f_ext: Any = None) -> Any:
        """Forward dynamics; see `dualpin.aba`.  Differentiable twice.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        v : array, shape (..., nv)
        tau : array, shape (..., nv)
            Joint torques [N m] and forces [N].
        f_ext : array, shape (..., njoints, 6), optional
            As in `dualpin.rnea`.

        Returns
        -------
        array, shape (..., nv)
            Accelerations of the joints [rad/s^2, m/s^2].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 7.3; Carpentier & Mansard (2018) for its gradient.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.aba(robot, q, v, a).shape
        (3, 6)
        """
        return self._term(robot, "aba", q, v, tau, f_ext=f_ext)

    def bias(self, robot: Robot, q: Any, v: Any) -> Any:
        """Nonlinear effects C(q, v) v + g(q); see `dualpin.bias`.  Differentiable twice.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        v : array, shape (..., nv)

        Returns
        -------
        array, shape (..., nv)
            [N m] and [N].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 5.3.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.bias(robot, q, v).shape
        (3, 6)
        """
        return self._term(robot, "bias", q, v)

    def gravity(self, robot: Robot, q: Any) -> Any:
        """Generalised gravity g(q); see `dualpin.gravity`.  Differentiable twice.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)

        Returns
        -------
        array, shape (..., nv)
            [N m] and [N].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 5.3.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.gravity(robot, q).shape
        (3, 6)
        """
        return self._term(robot, "gravity", q)

    def crba(self, robot: Robot, q: Any) -> Any:
        """The inertia matrix; see `dualpin.crba`.  Differentiable twice, for nv times the cost.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)

        Returns
        -------
        array, shape (..., nv, nv)

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 6.2.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.crba(robot, q).shape
        (3, 6, 6)
        """
        return self._term(robot, "crba", q)

    def coriolis(self, robot: Robot, q: Any, v: Any) -> Any:
        """The Coriolis matrix; see `dualpin.coriolis`.  Differentiable twice, as `crba`.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        v : array, shape (..., nv)

        Returns
        -------
        array, shape (..., nv, nv)

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Echeandia & Wensing (2021).
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.coriolis(robot, q, v).shape
        (3, 6, 6)
        """
        return self._term(robot, "coriolis", q, v)

    def minv(self, robot: Robot, q: Any) -> Any:
        """The inverse of the inertia matrix; see `dualpin.minv`.  Differentiable twice, as `crba`.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)

        Returns
        -------
        array, shape (..., nv, nv)

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 6.5.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.minv(robot, q).shape
        (3, 6, 6)
        """
        return self._term(robot, "minv", q)

    def rnea_jvp(self, robot: Robot, q: Any, v: Any, a: Any, dq: Any, dv: Any, da: Any, f_ext: Any = None) -> Any:
        """The derivative of `rnea` along a direction; see `dualpin.rnea_jvp`.  Differentiable once.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        v, a, dq, dv, da : array, shape (..., nv)
        f_ext : array, shape (..., njoints, 6), optional
            As in `dualpin.rnea`.

        Returns
        -------
        array, shape (..., nv)

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Griewank & Walther (2008), 3.1, the tangent mode.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.rnea_jvp(robot, q, v, a, v, a, a).shape
        (3, 6)
        """
        return self._term(robot, "rnea_jvp", q, v, a, dq, dv, da, f_ext=f_ext)
