"""Inverse dynamics as a function of inertial parameters, and the contribution of each link."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..algorithms import regressor
from ..call import evaluator
from ..call.arguments import check_robot
from ..call.public import ask, public
from ..model.robot import Robot
from ..terms import JOINT_TORQUE_REGRESSOR, LINK_TERMS


@public
def joint_torque_regressor(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Y with rnea = Y p, shape (..., nv, 10 njoints); with armature, one more column for each of its entries.

    The parameters p of each body: m; m cx, m cy, m cz; Jxx Jxy Jyy Jxz Jyz Jzz about the joint
    frame's origin, as `inertial_parameters` returns them; then, if any joint has armature, the
    entries of all joints', in the joints' order.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., nv, 10 njoints), or (..., nv, 10 njoints + entries of the armature)

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Atkeson, An & Hollerbach (1986).
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> Y = dp.joint_torque_regressor(robot, q, v, a)
    >>> bool(np.allclose(Y @ dp.inertial_parameters(robot), dp.rnea(robot, q, v, a)))
    True
    """
    return ask(JOINT_TORQUE_REGRESSOR, q, v, a)


def inertial_parameters(robot: Robot) -> np.ndarray:
    """The ten inertial parameters of each moving body and the armature, in the order of `joint_torque_regressor`.

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    ndarray, shape (10 njoints,), or with the armature as many more as it has entries
        m [kg]; m c [kg m]; J about the joint frame's origin [kg m^2].

    Raises
    ------
    ArgumentError
        If it is not a robot, or its constants are symbols.

    References
    ----------
    Atkeson, An & Hollerbach (1986).
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.inertial_parameters(dp.load("ur5")).shape
    (60,)
    """
    check_robot(robot, "inertial_parameters")
    return np.array([float(x) for x in regressor.inertial_parameters(robot)])


@dataclass(frozen=True)
class LinkTerm:
    """The contribution of one link: M (..., nv, nv), C (..., nv, nv), g (..., nv), padded with zeros."""

    name: str
    M: np.ndarray
    C: np.ndarray
    g: np.ndarray


class LinkTerms(Sequence[LinkTerm]):
    """One `LinkTerm` for each moving body, in the order of ``robot.joint_names``."""

    def __init__(self, names: Sequence[str], packed: np.ndarray) -> None:
        nv = packed.shape[-2]
        self._terms = [
            LinkTerm(name, packed[..., i, :, :nv], packed[..., i, :, nv : 2 * nv], packed[..., i, :, 2 * nv])
            for i, name in enumerate(names)
        ]

    def __len__(self) -> int:
        return len(self._terms)

    def __getitem__(self, i):  # type: ignore[no-untyped-def]
        return self._terms[i]

    def __iter__(self) -> Iterator[LinkTerm]:
        return iter(self._terms)


def link_terms(
    robot: Robot, q: ArrayLike, v: ArrayLike, *, dtype: DTypeLike = "float64", engine: str = "auto"
) -> LinkTerms:
    """Progressive dynamics: M_i, C_i, g_i of each link, whose sums are M, C and g.

        M_i = J_i^T I_i J_i,   C_i = J_i^T (I_i dJ_i/dt + B_i J_i),   g_i = -J_i^T I_i (gravity)

    A new link adds its own term and changes no other.  In trees, each term has entries for the joints
    on the path from the ground to the link.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v : array_like, shape (..., nv)
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    LinkTerms
        A sequence of objects with ``.name``, ``.M``, ``.C`` (..., nv, nv), ``.g`` (..., nv).

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Laus, Simoni & Martins, progressive dynamics by screws; here for any tree.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, _ = robot.sample(seed=0)
    >>> bool(np.allclose(sum(t.M for t in dp.link_terms(robot, q, v)), dp.crba(robot, q)))
    True
    """
    return LinkTerms(robot.joint_names, evaluator(robot, LINK_TERMS, engine, dtype)(q, v))
