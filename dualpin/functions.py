"""The public functions: arrays in, arrays out.

Shapes: q (..., nq), v, a, tau (..., nv); leading axes are batch axes and broadcast.
Units: SI, radians.  World z up.  Six-vectors are angular first: twists [w; v], wrenches [n; f].
Every function takes ``engine=``: "auto", "compiled", or "numpy" to run the source uncompiled; and
those that return one array take ``out=``, a float64 array of just the result's shape.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .algorithms import regressor
from .boundary import call, check_out, check_robot, choice, prepared
from .model.robot import Frame, Robot

FrameLike = str | int | Frame


def fk(
    robot: Robot,
    q: ArrayLike,
    frame: FrameLike | None = None,
    *,
    as_: str = "matrix",
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> np.ndarray:
    """Forward kinematics: poses in the world.

        X_b = X_parent placement motion(q)

    Parameters
    ----------
    q : array_like, shape (..., nq)
    frame : str, int or Frame, optional
        A link or joint name; without it, all joint frames in the order of ``robot.joint_names``.
    as_ : "matrix" or "dual_quaternion"

    Returns
    -------
    ndarray
        Homogeneous matrices frame -> world, shape (..., 4, 4), or (..., njoints, 4, 4) of all
        joints; as dual quaternions (..., 8): w x y z of the real part, then of the dual part, w >= 0.

    Raises
    ------
    FrameNotFoundError, ShapeError, ArgumentError

    References
    ----------
    Study (1903) for dual quaternions; Featherstone (2008), 4.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> dp.fk(robot, np.zeros(6), frame="tool0")[:3, 3].round(5).tolist()
    [0.81725, 0.19145, -0.00549]
    """
    if as_ == "matrix":
        if frame is None:
            return prepared(robot, "fk", engine)(q, out)
        return prepared(robot, ("frame_pose", frame), engine, ("frame",))(q, out)
    choice("fk: as_", as_, ("matrix", "dual_quaternion"))
    if frame is None:
        from .spatial import from_matrix

        x = from_matrix(call(robot, "fk", {"q": q}, engine=engine))
    else:
        x = prepared(robot, ("frame_quaternion", frame), engine, ("frame",))(q, None)
        x = np.where(x[..., :1] < 0, -x, x)
    if out is None:
        return x
    check_out("fk", out, x.shape, x.dtype)
    out[...] = x
    return out


def jacobian(
    robot: Robot,
    q: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> np.ndarray:
    """Geometric Jacobian of a frame, twist = J v.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    frame : str, int or Frame
    reference : "world", "local" or "local_world_aligned"
        Twist about the world's origin; about the frame's origin in its own axes; about the frame's
        origin in world axes.

    Returns
    -------
    ndarray, shape (..., 6, nv)
        Rows [w; v], angular first.

    References
    ----------
    Lynch & Park (2017), 5.1; Featherstone (2008), 4.4.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.jacobian(dp.load("ur5"), np.zeros(6), "tool0").shape
    (6, 6)
    """
    return prepared(robot, ("jacobian", frame, reference), engine, ("frame", "reference"))(q, out)


def jacobian_dot(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> np.ndarray:
    """Time derivative of the Jacobian, dJ/dt = X_f^-1 ((V_k - V_f) x s_k) by columns.

    V_f is the velocity of the reference: none, the frame's twist, or the translation with its origin.

    Returns
    -------
    ndarray, shape (..., 6, nv), rows [w; v].

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> float(abs(dp.jacobian_dot(robot, np.zeros(6), np.zeros(6), "tool0")).max())
    0.0
    """
    return prepared(robot, ("jacobian_dot", frame, reference), engine, ("frame", "reference"))(q, v, out)


def frame_velocity(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> np.ndarray:
    """Twist of a frame, J v.

    Returns
    -------
    ndarray, shape (..., 6)
        [w; v] in rad/s and m/s, about the origin and in the axes of the reference (see `jacobian`).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.frame_velocity(dp.load("ur5"), np.zeros(6), np.zeros(6), "tool0").tolist()
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    return prepared(robot, ("frame_velocity", frame, reference), engine, ("frame", "reference"))(q, v, out)


def frame_acceleration(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    classical: bool = False,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> np.ndarray:
    """Spatial acceleration of a frame; gravity is not in it.

        J a + dJ/dt v     the spatial one with "world" and "local", the classical one with
                          "local_world_aligned", whose observer moves along with the origin

    Parameters
    ----------
    classical : bool
        Add w x v to the linear part: with "local" or "local_world_aligned" the acceleration of
        the frame's origin as a point, what an accelerometer there would see without gravity.

    Returns
    -------
    ndarray, shape (..., 6)
        [angular; linear].

    References
    ----------
    Featherstone (2008), 2.11.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.frame_acceleration(dp.load("ur5"), np.zeros(6), np.zeros(6), np.zeros(6), "tool0").shape
    (6,)
    """
    key = ("frame_acceleration", frame, reference, bool(classical))
    return prepared(robot, key, engine, ("frame", "reference", "classical"))(q, v, a, out)


def rnea(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> np.ndarray:
    """Inverse dynamics, tau = M(q) a + C(q, v) v + g(q) - J^T f_ext.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        External wrench [n; f] on each joint's body, about and in that joint's moving frame.

    Returns
    -------
    ndarray, shape (..., nv)
        Joint torques [N m] and forces [N].

    References
    ----------
    Luh, Walker & Paul (1980); Featherstone (2008), 5.3.

    Examples
    --------
    >>> import dualpin as dp
    >>> robot = dp.load("panda")
    >>> q, v, a = robot.sample(1000, seed=0)
    >>> dp.rnea(robot, q, v, a).shape
    (1000, 9)
    """
    if f_ext is None:
        return prepared(robot, "rnea", engine)(q, v, a, out)
    return prepared(robot, "rnea_f_ext", engine)(q, v, a, f_ext, out)


def bias(
    robot: Robot, q: ArrayLike, v: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """Nonlinear effects h = C(q, v) v + g(q), shape (..., nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.bias(dp.load("ur5"), np.zeros(6), np.ones(6)).shape
    (6,)
    """
    return prepared(robot, "bias", engine)(q, v, out)


def gravity(robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto") -> np.ndarray:
    """Generalised gravity g(q) = dU/dq, what holds the robot at rest, shape (..., nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.gravity(dp.load("ur5"), np.zeros(6)).shape
    (6,)
    """
    return prepared(robot, "gravity", engine)(q, out)


def crba(robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto") -> np.ndarray:
    """Joint-space inertia matrix M(q), full and symmetric, shape (..., nv, nv).

    References
    ----------
    Walker & Orin (1982); Featherstone (2008), 6.2.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> M = dp.crba(dp.load("ur5"), np.zeros(6))
    >>> bool((M == M.T).all())
    True
    """
    return prepared(robot, "crba", engine)(q, out)


def coriolis(
    robot: Robot, q: ArrayLike, v: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """Coriolis matrix C(q, v), shape (..., nv, nv): the one with dM/dt = C + C^T of Christoffel's symbols.

    Many matrices give the same C v; this one makes dM/dt - 2 C skew for every q and v.  With a
    floating base it is the matrix of the Levi-Civita connection in body velocities.

    References
    ----------
    Echeandia & Wensing (2021).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, _ = robot.sample(seed=0)
    >>> C = dp.coriolis(robot, q, v)
    >>> bool(np.allclose(C @ v + dp.gravity(robot, q), dp.bias(robot, q, v)))
    True
    """
    return prepared(robot, "coriolis", engine)(q, v, out)


def aba(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> np.ndarray:
    """Forward dynamics, a = M^-1 (tau - C v - g + J^T f_ext), shape (..., nv).

    Parameters
    ----------
    tau : array_like, shape (..., nv)
        Joint torques [N m] and forces [N].
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.

    Notes
    -----
    By the articulated-body algorithm; where joints share a coordinate (mimic), by the factorised
    inertia matrix.  Not finite where M is singular (a joint that moves no mass).

    References
    ----------
    Featherstone (1983); Featherstone (2008), 7.3 and 6.5.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> bool(np.allclose(dp.aba(robot, q, v, dp.rnea(robot, q, v, a)), a))
    True
    """
    if f_ext is None:
        return prepared(robot, "aba", engine)(q, v, tau, out)
    return prepared(robot, "aba_f_ext", engine)(q, v, tau, f_ext, out)


def rnea_derivatives(
    robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, engine: str = "auto"
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How inverse dynamics changes: d tau / dq, d tau / dv, d tau / da = M, each (..., nv, nv).

    d tau / dq is by displacements of the joints: of a floating or planar joint in its moving frame
    (the tangent space in which `integrate` steps), of all others the derivative by the coordinate.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)

    References
    ----------
    Singh, Russell & Wensing (2022), Efficient analytical derivatives of rigid-body dynamics.

    Examples
    --------
    >>> import dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> dq, dv, da = dp.rnea_derivatives(robot, q, v, a)
    >>> step = 1e-6
    >>> slope = (dp.rnea(robot, q + step * v, v, a) - dp.rnea(robot, q - step * v, v, a)) / (2 * step)
    >>> bool(abs(dq @ v - slope).max() < 1e-6)
    True
    """
    dq, dv, da = np.moveaxis(prepared(robot, "rnea_derivatives", engine)(q, v, a, None), -3, 0)
    return dq, dv, da


def aba_derivatives(
    robot: Robot, q: ArrayLike, v: ArrayLike, tau: ArrayLike, *, engine: str = "auto"
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How forward dynamics changes: d a / dq, d a / dv, d a / d tau = M^-1, each (..., nv, nv).

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, tau : array_like, shape (..., nv)

    Notes
    -----
    d a / dq = -M^-1 d tau / dq at a = aba(q, v, tau); displacements as in `rnea_derivatives`.

    References
    ----------
    Carpentier & Mansard (2018), Analytical derivatives of rigid body dynamics algorithms.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, tau = robot.sample(seed=0)
    >>> dq, dv, dtau = dp.aba_derivatives(robot, q, v, tau)
    >>> bool(np.allclose(dtau, dp.minv(robot, q)))
    True
    """
    dq, dv, dtau = np.moveaxis(prepared(robot, "aba_derivatives", engine)(q, v, tau, None), -3, 0)
    return dq, dv, dtau


def minv(robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto") -> np.ndarray:
    """Inverse of the joint-space inertia matrix, shape (..., nv, nv), by its branch-sparse L^T D L factors.

    References
    ----------
    Featherstone (2008), 6.5.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q = np.zeros(6)
    >>> bool(np.allclose(dp.minv(robot, q) @ dp.crba(robot, q), np.eye(6)))
    True
    """
    return prepared(robot, "minv", engine)(q, out)


def kinetic_energy(
    robot: Robot, q: ArrayLike, v: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """T = v^T M v / 2 [J], shape (...,).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> float(dp.kinetic_energy(dp.load("ur5"), np.zeros(6), np.zeros(6)))
    0.0
    """
    return prepared(robot, "kinetic_energy", engine)(q, v, out)


def potential_energy(robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto") -> np.ndarray:
    """U = -sum m g . c [J], zero with all mass at the world's origin, shape (...,).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.potential_energy(dp.load("ur5"), np.zeros((3, 6))).shape
    (3,)
    """
    return prepared(robot, "potential_energy", engine)(q, out)


def com(robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto") -> np.ndarray:
    """Centre of mass of the moving bodies in the world [m], shape (..., 3).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.com(dp.load("ur5"), np.zeros(6)).shape
    (3,)
    """
    return prepared(robot, "com", engine)(q, out)


def com_jacobian(robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto") -> np.ndarray:
    """Jacobian of the centre of mass, dc/dt = J v, world axes, shape (..., 3, nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.com_jacobian(dp.load("ur5"), np.zeros(6)).shape
    (3, 6)
    """
    return prepared(robot, "com_jacobian", engine)(q, out)


def centroidal_momentum_matrix(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """A(q) with momentum about the centre of mass = A v, world axes, shape (..., 6, nv).

    Rows [l; p], angular first.

    References
    ----------
    Orin & Goswami (2008).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.centroidal_momentum_matrix(dp.load("ur5"), np.zeros(6)).shape
    (6, 6)
    """
    return prepared(robot, "centroidal_momentum_matrix", engine)(q, out)


def joint_torque_regressor(
    robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """Y with rnea = Y p, shape (..., nv, 10 njoints), with armature as many columns more as it has entries.

    The parameters p of each body: m; m cx, m cy, m cz; Jxx Jxy Jyy Jxz Jyz Jzz about the joint
    frame's origin, as `inertial_parameters` returns them; then, if any joint has armature, the
    entries of all joints', in the joints' order.

    References
    ----------
    Atkeson, An & Hollerbach (1986).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> Y = dp.joint_torque_regressor(robot, q, v, a)
    >>> bool(np.allclose(Y @ dp.inertial_parameters(robot), dp.rnea(robot, q, v, a)))
    True
    """
    return prepared(robot, "joint_torque_regressor", engine)(q, v, a, out)


def inertial_parameters(robot: Robot) -> np.ndarray:
    """The ten inertial parameters of each moving body and the armature, in the order of `joint_torque_regressor`.

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
    """What one link adds: M (..., nv, nv), C (..., nv, nv), g (..., nv), padded with zeros."""

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


def link_terms(robot: Robot, q: ArrayLike, v: ArrayLike, *, engine: str = "auto") -> LinkTerms:
    """Progressive dynamics: M_i, C_i, g_i of each link, whose sums are M, C and g.

        M_i = J_i^T I_i J_i,   C_i = J_i^T (I_i dJ_i/dt + B_i J_i),   g_i = -J_i^T I_i (gravity)

    A new link adds its own term and changes no other.  Trees too: each term is scattered to the
    joints on the link's path.

    Returns
    -------
    LinkTerms
        A sequence of objects with ``.name``, ``.M``, ``.C`` (..., nv, nv), ``.g`` (..., nv).

    References
    ----------
    Laus, Simoni & Martins, progressive dynamics by screws; here for any tree.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, _ = robot.sample(seed=0)
    >>> bool(np.allclose(sum(t.M for t in dp.link_terms(robot, q, v)), dp.crba(robot, q)))
    True
    """
    return LinkTerms(robot.joint_names, call(robot, "link_terms", {"q": q, "v": v}, engine=engine))


def integrate(
    robot: Robot, q: ArrayLike, v: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """The configuration reached from q by moving with v for one unit of time, shape (..., nq).

    On the group: a floating base moves along the screw of its twist, q * exp(v).

    Examples
    --------
    >>> import dualpin as dp
    >>> robot = dp.load("ur5", floating=True)
    >>> q, v, _ = robot.sample(seed=0)
    >>> bool(abs(dp.difference(robot, q, dp.integrate(robot, q, 0.1 * v)) - 0.1 * v).max() < 1e-14)
    True
    """
    return prepared(robot, "integrate", engine)(q, v, out)


def difference(
    robot: Robot, q0: ArrayLike, q1: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """The v with integrate(q0, v) = q1, shape (..., nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.difference(dp.load("ur5"), np.zeros(6), np.ones(6)).tolist()
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    return prepared(robot, "difference", engine)(q0, q1, out)
