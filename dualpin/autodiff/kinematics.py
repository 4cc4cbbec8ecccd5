"""Poses, centres of mass and energies that libraries differentiate."""

from __future__ import annotations

from typing import Any

from ..model.robot import Frame, Robot
from .caller import Caller
from .operation import Operation


class Kinematics(Caller):
    """Poses, centres of mass and energies, by one library."""

    def fk(self, robot: Robot, q: Any, frame: str | int | Frame | None = None) -> Any:
        """Poses of all joints, or of a frame; see `dualpin.fk`.  Differentiable twice.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        frame : str, int or Frame, optional

        Returns
        -------
        array, shape (..., njoints, 4, 4) or (..., 4, 4)
            Joint or frame -> world.

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 4.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.fk(robot, q, frame="tool0").shape
        (3, 4, 4)
        """
        if frame is None:
            return self._term(robot, "fk", q)
        return self._term(robot, "frame_pose", q, frame=frame)

    def jacobian(self, robot: Robot, q: Any, frame: str | int | Frame, reference: str = "world") -> Any:
        """The Jacobian of a frame; see `dualpin.jacobian`.  Differentiable twice, for nv times the cost.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        frame : str, int or Frame
        reference : "world", "local" or "local_world_aligned"

        Returns
        -------
        array, shape (..., 6, nv)
            Rows [w; v].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Lynch & Park (2017), 5.1; Featherstone (2008), 4.4.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.jacobian(robot, q, "tool0").shape
        (3, 6, 6)
        """
        return self._term(robot, "jacobian", q, frame=frame, reference=reference)

    def com(self, robot: Robot, q: Any) -> Any:
        """The centre of mass; see `dualpin.com`.  Differentiable three times.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)

        Returns
        -------
        array, shape (..., 3)
            In the world frame [m].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 2.13, first moments of mass.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.com(robot, q).shape
        (3, 3)
        """
        return self._term(robot, "com", q)

    def com_jacobian(self, robot: Robot, q: Any) -> Any:
        """The Jacobian of the centre of mass; see `dualpin.com_jacobian`.  Differentiable twice.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)

        Returns
        -------
        array, shape (..., 3, nv)

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Orin & Goswami (2008).
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.com_jacobian(robot, q).shape
        (3, 3, 6)
        """
        return self._term(robot, "com_jacobian", q)

    def integrate(self, robot: Robot, q: Any, v: Any) -> Any:
        """The configuration after a step along v; see `dualpin.integrate`.  Differentiable at will.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        v : array, shape (..., nv)

        Returns
        -------
        array, shape (..., nq)

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Munthe-Kaas (1998); Lynch & Park (2017), 3.3.3.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.integrate(robot, q, v).shape
        (3, 6)
        """
        return Operation.of(robot, "integrate").by_library(self._library(), q, v)

    def kinetic_energy(self, robot: Robot, q: Any, v: Any) -> Any:
        """v . M v / 2; see `dualpin.kinetic_energy`.  Differentiable twice.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)
        v : array, shape (..., nv)

        Returns
        -------
        array, shape (...)
            [J].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Featherstone (2008), 2.13; Lynch & Park (2017), 8.1.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.kinetic_energy(robot, q, v).shape
        (3,)
        """
        return self._term(robot, "kinetic_energy", q, v)

    def potential_energy(self, robot: Robot, q: Any) -> Any:
        """The potential energy U(q); see `dualpin.potential_energy`.  Differentiable three times.

        Parameters
        ----------
        robot : Robot
        q : array, shape (..., nq)

        Returns
        -------
        array, shape (...)
            [J].

        Raises
        ------
        ShapeError, ArgumentError
            If an argument is not as described above.

        References
        ----------
        Lynch & Park (2017), 8.1.
        Six-vectors, quaternions and the order of joints: docs/conventions.md.

        Examples
        --------
        >>> import dualpin as dp, dualpin.jax as dj
        >>> robot = dp.load("ur5")
        >>> q, v, a = robot.sample(3, seed=0)
        >>> dj.potential_energy(robot, q).shape
        (3,)
        """
        return self._term(robot, "potential_energy", q)
