"""The public functions: arrays in, arrays out.

Shapes: q (..., nq), v, a, tau (..., nv); leading axes are batch axes and broadcast.
Units: SI, radians.  World z up.  Six-vectors are angular first: twists [w; v], wrenches [n; f].
Every function takes ``engine=``: "auto", or "numpy" to run the source uncompiled.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .algorithms.kinematics import References
from .boundary import call, choice
from .errors import ArgumentError
from .model.robot import Frame, Robot

FrameLike = str | int | Frame


def fk(
    robot: Robot, q: ArrayLike, frame: FrameLike | None = None, *, as_: str = "matrix", engine: str = "auto"
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
    choice("fk: as_", as_, ("matrix", "dual_quaternion"))
    if frame is None:
        poses = call(robot, "fk", {"q": q}, engine=engine)
        if as_ == "matrix":
            return poses
        from .spatial import from_matrix

        return from_matrix(poses)
    target = _frame(robot, frame)
    if as_ == "matrix":
        return call(robot, "frame_pose", {"q": q}, engine=engine, frame=target)
    x = call(robot, "frame_quaternion", {"q": q}, engine=engine, frame=target)
    return np.where(x[..., :1] < 0, -x, x)


def jacobian(
    robot: Robot, q: ArrayLike, frame: FrameLike, reference: str = "world", *, engine: str = "auto"
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
    return call(robot, "jacobian", {"q": q}, engine=engine, **_seen(robot, frame, reference))


def jacobian_dot(
    robot: Robot, q: ArrayLike, v: ArrayLike, frame: FrameLike, reference: str = "world", *, engine: str = "auto"
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
    return call(robot, "jacobian_dot", {"q": q, "v": v}, engine=engine, **_seen(robot, frame, reference))


def frame_velocity(
    robot: Robot, q: ArrayLike, v: ArrayLike, frame: FrameLike, reference: str = "world", *, engine: str = "auto"
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
    return call(robot, "frame_velocity", {"q": q, "v": v}, engine=engine, **_seen(robot, frame, reference))


def frame_acceleration(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    classical: bool = False,
    engine: str = "auto",
) -> np.ndarray:
    """Spatial acceleration of a frame, J a + dJ/dt v; gravity is not in it.

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
    options = _seen(robot, frame, reference)
    return call(
        robot, "frame_acceleration", {"q": q, "v": v, "a": a}, engine=engine, classical=bool(classical), **options
    )


def rnea(
    robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike, f_ext: ArrayLike | None = None, *, engine: str = "auto"
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
        return call(robot, "rnea", {"q": q, "v": v, "a": a}, engine=engine)
    return call(robot, "rnea_f_ext", {"q": q, "v": v, "a": a, "f_ext": f_ext}, engine=engine)


def bias(robot: Robot, q: ArrayLike, v: ArrayLike, *, engine: str = "auto") -> np.ndarray:
    """Nonlinear effects h = C(q, v) v + g(q), shape (..., nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.bias(dp.load("ur5"), np.zeros(6), np.ones(6)).shape
    (6,)
    """
    return call(robot, "bias", {"q": q, "v": v}, engine=engine)


def gravity(robot: Robot, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
    """Generalised gravity g(q) = dU/dq, what holds the robot at rest, shape (..., nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.gravity(dp.load("ur5"), np.zeros(6)).shape
    (6,)
    """
    return call(robot, "gravity", {"q": q}, engine=engine)


def crba(robot: Robot, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
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
    return call(robot, "crba", {"q": q}, engine=engine)


def coriolis(robot: Robot, q: ArrayLike, v: ArrayLike, *, engine: str = "auto") -> np.ndarray:
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
    return call(robot, "coriolis", {"q": q, "v": v}, engine=engine)


def aba(
    robot: Robot, q: ArrayLike, v: ArrayLike, tau: ArrayLike, f_ext: ArrayLike | None = None, *, engine: str = "auto"
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
        return call(robot, "aba", {"q": q, "v": v, "tau": tau}, engine=engine)
    return call(robot, "aba_f_ext", {"q": q, "v": v, "tau": tau, "f_ext": f_ext}, engine=engine)


def minv(robot: Robot, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
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
    return call(robot, "minv", {"q": q}, engine=engine)


def kinetic_energy(robot: Robot, q: ArrayLike, v: ArrayLike, *, engine: str = "auto") -> np.ndarray:
    """T = v^T M v / 2 [J], shape (...,).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> float(dp.kinetic_energy(dp.load("ur5"), np.zeros(6), np.zeros(6)))
    0.0
    """
    return call(robot, "kinetic_energy", {"q": q, "v": v}, engine=engine)


def potential_energy(robot: Robot, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
    """U = -sum m g . c [J], zero with all mass at the world's origin, shape (...,).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.potential_energy(dp.load("ur5"), np.zeros((3, 6))).shape
    (3,)
    """
    return call(robot, "potential_energy", {"q": q}, engine=engine)


def com(robot: Robot, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
    """Centre of mass of the moving bodies in the world [m], shape (..., 3).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.com(dp.load("ur5"), np.zeros(6)).shape
    (3,)
    """
    return call(robot, "com", {"q": q}, engine=engine)


def com_jacobian(robot: Robot, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
    """Jacobian of the centre of mass, dc/dt = J v, world axes, shape (..., 3, nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.com_jacobian(dp.load("ur5"), np.zeros(6)).shape
    (3, 6)
    """
    return call(robot, "com_jacobian", {"q": q}, engine=engine)


def centroidal_momentum_matrix(robot: Robot, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
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
    return call(robot, "centroidal_momentum_matrix", {"q": q}, engine=engine)


def joint_torque_regressor(
    robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, engine: str = "auto"
) -> np.ndarray:
    """Y with rnea = Y p, shape (..., nv, 10 njoints).

    The parameters p of each body: m; m cx, m cy, m cz; Jxx Jxy Jyy Jxz Jyz Jzz about the joint
    frame's origin, as `inertial_parameters` returns them.

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
    return call(robot, "joint_torque_regressor", {"q": q, "v": v, "a": a}, engine=engine)


def inertial_parameters(robot: Robot) -> np.ndarray:
    """The ten inertial parameters of each moving body, in the order of `joint_torque_regressor`.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.inertial_parameters(dp.load("ur5")).shape
    (60,)
    """
    return np.array([float(x) for b in robot for x in b.inertia.parameters])


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


def integrate(robot: Robot, q: ArrayLike, v: ArrayLike, *, engine: str = "auto") -> np.ndarray:
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
    return call(robot, "integrate", {"q": q, "v": v}, engine=engine)


def difference(robot: Robot, q0: ArrayLike, q1: ArrayLike, *, engine: str = "auto") -> np.ndarray:
    """The v with integrate(q0, v) = q1, shape (..., nv).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.difference(dp.load("ur5"), np.zeros(6), np.ones(6)).tolist()
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    # `where` inside the logarithm chooses a sign: not a straight line of operations, so never compiled
    return call(robot, "difference", {"q0": q0, "q1": q1}, engine="numpy" if engine == "auto" else engine)


def _frame(robot: Robot, frame: FrameLike) -> Frame:
    if not isinstance(robot, Robot):
        raise ArgumentError(f"a Robot expected first, got {type(robot).__name__}")
    return robot.frame(frame)


def _seen(robot: Robot, frame: FrameLike, reference: str) -> dict[str, Frame | str]:
    """Checked options of everything that is seen from somewhere."""
    return {"frame": _frame(robot, frame), "reference": choice("reference", reference, References)}
