"""Forward dynamics: the articulated-body algorithm, and the factorised inertia matrix."""

from __future__ import annotations

from collections.abc import Sequence

from ..model.robot import Joint, Robot
from ..scalars import ONE, ZERO, Scalar, exact
from ..spatial.inertia import Articulated
from ..spatial.vector import ZERO_MOTOR, Twist, Wrench, power
from .crba import Matrix, crba
from .kinematics import joint_poses
from .rnea import bias, carried, ride


def aba(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    tau: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> list[Scalar]:
    """Forward dynamics, the acceleration.  (Featherstone 1983; 2008, 7.3)

    A joint of several screws is eliminated one screw at a time, so that no linear system is solved:

        U = I s,  d = s . U,  u = tau - s . P          then   I <- I - U U^T / d,   P <- P + U u / d
        a = (u - U . A) / d                            then   A <- A + s a

    Joints that share a coordinate (mimic) cannot be eliminated one by one; `solve_inertia` is used for them.
    """
    if robot.coupled:
        h = bias(robot, q, v, f_ext)
        return solve_inertia(crba(robot, q), [t - b for t, b in zip(tau, h, strict=True)])
    X = joint_poses(robot, q)
    I: dict[Joint | None, Articulated] = {}
    V: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    P: dict[Joint | None, Wrench] = {None: ZERO_MOTOR}
    c: dict[Joint, Twist] = {}
    for b in robot:
        Sv = b.model.twist(v[b.v])
        W, e = carried(X[b], V[b.parent], ZERO_MOTOR)
        V[b], c[b] = ride(W + Sv, e + W.cross(Sv))
        I[b], P[b] = Articulated.of(b.inertia), V[b].cross(b.inertia(V[b]))
        if f_ext is not None:
            P[b] = P[b] - f_ext[b.index]
    released: dict[int, tuple[Wrench, Scalar, Scalar]] = {}
    for b in reversed(robot):
        for k, s, rotor in reversed(b.driven):
            U = I[b](s)
            d, u = exact(power(s, U) + rotor), tau[k] - power(s, P[b])  # an exact zero d: no exception
            I[b], P[b] = I[b].released(U, d), P[b] + U * (u / d)
            released[k] = U, d, u
        if b.parent:
            I[b.parent] = I[b.parent] + X[b] @ I[b]
            P[b.parent] = P[b.parent] + X[b] @ (P[b] + I[b](c[b]))
    A: dict[Joint | None, Twist] = {None: robot.at_rest}
    a: list[Scalar] = [ZERO] * robot.nv
    for b in robot:
        A[b] = X[b].pull(A[b.parent]) + c[b]
        for k, s in b.dofs:
            U, d, u = released[k]
            a[k] = (u - power(A[b], U)) / d
            A[b] = A[b] + s * a[k]
    return a


def factorised(M: Matrix) -> tuple[Matrix, list[Scalar]]:
    """M = L^T D L with L unit lower triangular.  (Featherstone 2008, 6.5)

    Computed from the last row up there is no fill-in: where two joints are on different branches, M has an
    exact zero, and so has L.
    """
    n = len(M)
    L, D = [row[: i + 1] for i, row in enumerate(M)], [ZERO] * n
    for k in reversed(range(n)):
        D[k] = exact(L[k][k])
        ratios = [x / D[k] for x in L[k][:k]]
        for i in range(k):
            for j in range(i + 1):
                L[i][j] = L[i][j] - ratios[i] * L[k][j]
        L[k] = [*ratios, ONE]
    return L, D


def solve_factorised(L: Matrix, D: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    """x with L^T D L x = b."""
    n, x = len(b), list(b)
    for k in reversed(range(n)):
        for j in range(k):
            x[j] = x[j] - L[k][j] * x[k]
    x = [y / d for y, d in zip(x, D, strict=True)]
    for k in range(n):
        for j in range(k):
            x[k] = x[k] - L[k][j] * x[j]
    return x


def solve_inertia(M: Matrix, b: Sequence[Scalar]) -> list[Scalar]:
    """M^-1 b."""
    return solve_factorised(*factorised(M), b)


def inverse(L: Matrix, D: Sequence[Scalar]) -> Matrix:
    """M^-1 = W D^-1 W^T with W = L^-1: each entry is a sum over common ancestors; exactly symmetric."""
    n = len(D)
    W: Matrix = [[ZERO] * n for _ in range(n)]
    inv: Matrix = [[ZERO] * n for _ in range(n)]
    for k in range(n):
        W[k][k] = ONE
        for j in range(k):
            for i in range(j, k):
                W[k][j] = W[k][j] - L[k][i] * W[i][j]
    scaled = [[x / d for x, d in zip(row, D, strict=True)] for row in W]
    for i in range(n):
        for j in range(i + 1):
            for k in range(j + 1):
                inv[i][j] = inv[i][j] + scaled[i][k] * W[j][k]
            inv[j][i] = inv[i][j]
    return inv


def minv(robot: Robot, q: Sequence[Scalar]) -> Matrix:
    """The inverse of the joint-space inertia matrix, by its sparse factors."""
    return inverse(*factorised(crba(robot, q)))
