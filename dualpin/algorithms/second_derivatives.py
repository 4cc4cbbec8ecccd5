"""The second derivatives of inverse dynamics, as tensors and weighted by a vector.  (Singh, Russell, Wensing 2022)

The notation is that of `responses`.  For x_j one of q_j, v_j, a_j with its response (alpha, beta), and
k beyond j, a second change reaches the bodies beyond k as a response of its own,

    of x_j and q_k: (alpha x s_k, beta x s_k + alpha x P_k)        of x_j and v_k: (0, alpha x s_k)

and the second derivative of the wrench of a body is

    I beta' + 2 B alpha' + alpha_j x I alpha_k + alpha_k x I alpha_j        (alpha', beta' the response to both)

Weighted by a motion U of the bodies (U_b = s_i of those beyond i: then it is tau_i; or the sum of
s_i w_i: then it is w . tau) and summed over the subtree of k, all this is linear in alpha_j and beta_j:

    K = sum I U,   L = sum 2 B^T U,   D(x) = 2 (x x K - sum B(U) x),   u: U of the parent

    d2 / dx_j dq_k = beta_j . (s_k x K + I (u x s_k)) + alpha_j . (D(P_k) + s_k x L + 2 B^T (u x s_k))
    d2 / dx_j dv_k = alpha_j . D(s_k)

where x_j = q_j, the turning of k's wrench G with j comes in addition, (u_j x s_j) . G_k.

The order of two displacements matters within one joint (floating, planar, spherical), as rotations do
not commute: [j][k] is the derivative along k of the derivative along j,

    T[j][k] - T[k][j] = d tau / dq . [s_k, s_j]

and the second derivative of tau(integrate(q, x)) by x, at x = 0, is the mean of T and its transpose.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ..model.robot import Joint, Robot
from ..scalars import ZERO, Scalar
from ..spatial.inertia import Connection, Inertia
from ..spatial.pose import Pose
from ..spatial.vector import ZERO_MOTOR, Twist, Wrench, power
from .crba import Matrix, square
from .responses import Response, Sweep, sweep

Vector = list[Scalar]
Tensor = list[Matrix]


class Seen(NamedTuple):
    """The quantities of a degree of freedom j in the frame of a body beyond it."""

    joint: Joint
    j: int
    response: Response
    turning: Twist
    """u x s, with u the motion U of the parent: its change relative to the displaced subtree."""

    def pulled(self, X: Pose) -> Seen:
        turning = self.turning if self.turning is ZERO_MOTOR else X.pull(self.turning)
        return Seen(self.joint, self.j, Response(*map(X.pull, self.response)), turning)


class Weight(NamedTuple):
    """Sums for a motion U of the bodies of a subtree, in the frame of the subtree's root."""

    K: Wrench
    L: Wrench
    C: Connection
    """The sum of the connections of I and U."""

    @classmethod
    def rigid(cls, U: Twist, I: Inertia, B: Connection) -> Weight:
        """All bodies of the subtree move as one."""
        return cls(I(U), B.transposed(U) * 2, Connection.of(I, U))

    def __add__(self, b: Weight) -> Weight:  # type: ignore[override]
        return Weight(self.K + b.K, self.L + b.L, self.C + b.C)

    def moved(self, X: Pose) -> Weight:
        return Weight(X @ self.K, X @ self.L, X @ self.C)

    def D(self, x: Twist) -> Wrench:
        return (x.cross(self.K) - self.C(x)) * 2


class Effect(NamedTuple):
    """The factors of alpha_j and beta_j, for all j before k and one U."""

    beta: Wrench
    alpha: Wrench
    """For a displacement along k: both factors."""
    rate: Wrench
    """For a velocity along k: the factor of alpha_j."""
    own: Wrench
    """The same if j belongs to the same joint, whose screws do not move each other."""

    @classmethod
    def of(cls, k: Response, turning: Twist, weight: Weight, I: Inertia, B: Connection) -> Effect:
        s, K = k.screw, weight.K
        beta, alpha, rate = s.cross(K), weight.D(k.velocity) + s.cross(weight.L), weight.D(s)
        own = rate - beta
        if turning is not ZERO_MOTOR:
            beta, alpha = beta + I(turning), alpha + B.transposed(turning) * 2
        return cls(beta, alpha, rate, own)


class Wrenches(NamedTuple):
    """The wrenches G that a displacement, a velocity and an acceleration along k cause in its subtree."""

    q: Wrench
    v: Wrench
    a: Wrench

    @classmethod
    def of(cls, k: Response, I: Inertia, B: Connection, F: Wrench) -> Wrenches:
        by_position = I(k.acceleration) + B(k.velocity) * 2 + k.screw.cross(F)
        return cls(by_position, I(k.rate) + B(k.screw) * 2, I(k.screw))


class Hessian(NamedTuple):
    """Of one scalar: d2 / dq dq, d2 / dq dv, d2 / dv dv and d2 / da dq, the variable named first by rows."""

    qq: Matrix
    qv: Matrix
    vv: Matrix
    aq: Matrix

    @classmethod
    def empty(cls, robot: Robot) -> Hessian:
        return cls(square(robot), square(robot), square(robot), square(robot))

    def add(self, j: Seen, k: int, effect: Effect, *, same: bool) -> None:
        """Add the part of j and k that is common to all bodies beyond k."""
        s, P, R, Q = j.response
        qq = power(R, effect.beta) + power(P, effect.alpha)
        qv = power(P, effect.rate)
        _plus(self.qq, k, j.j, qq)
        _plus(self.qv, j.j, k, qv)
        if same:
            _plus(self.vv, j.j, k, power(s, effect.own))
            return
        vv = power(s, effect.rate)
        _plus(self.qq, j.j, k, qq)
        _plus(self.qv, k, j.j, power(Q, effect.beta) + power(s, effect.alpha))
        _plus(self.vv, j.j, k, vv)
        _plus(self.vv, k, j.j, vv)
        _plus(self.aq, j.j, k, power(s, effect.beta))

    def turn(self, j: int, turning: Twist, k: int, G: Wrenches, *, same: bool) -> None:
        """Add the part of the rotation of k's wrenches with j."""
        qq = power(turning, G.q)
        _plus(self.qq, k, j, qq)
        if not same:
            _plus(self.qq, j, k, qq)
        _plus(self.qv, j, k, power(turning, G.v))
        _plus(self.aq, k, j, power(turning, G.a))


def _plus(M: Matrix, i: int, j: int, x: Scalar) -> None:
    M[i][j] = M[i][j] + x


def _before(c: Joint, b: Joint) -> bool:
    """Whether c is on the way from b to the ground, and not b."""
    return c is not b and c in b.chain


def rnea_hessian(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    w: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> Hessian:
    """The second derivatives of w . tau, as differential dynamic programming needs them, in O(n depth)."""
    swept = sweep(robot, q, v, a, f_ext)
    X, I, B, F, _, own = swept
    U: dict[Joint | None, Twist] = {None: ZERO_MOTOR}
    turning: dict[Joint, list[Twist]] = {}
    weights: dict[Joint, Weight] = {}
    for b in robot:
        u = X[b].pull(U[b.parent])
        turning[b] = [u.cross(s) for s in b.model.screws] if b.parent else [ZERO_MOTOR] * len(b.model.screws)
        U[b] = u + b.model.twist(w[b.v])
        weights[b] = Weight.rigid(U[b], b.inertia, own[b])
    for b in reversed(robot):
        if b.parent:
            weights[b.parent] = weights[b.parent] + weights[b].moved(X[b])
    H = Hessian.empty(robot)
    for b, seen in _views(robot, swept, turning):
        for k in (x for x in seen if x.joint is b):
            effect = Effect.of(k.response, k.turning, weights[b], I[b], B[b])
            G = Wrenches.of(k.response, I[b], B[b], F[b])
            for j in seen:
                H.add(j, k.j, effect, same=j.joint is b)
                H.turn(j.j, j.turning, k.j, G, same=j.joint is b)
    return H


def rnea_second_derivatives(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """d2 tau / dq dq, d2 tau / dq dv, d2 tau / dv dv and dM / dq, each [i][j][k]: the Hessians of all tau_i.

    An entry is not zero only if i, j, k are on one path to the ground; it is computed in the frame of the
    joint farthest from the ground.
    """
    swept = sweep(robot, q, v, a, f_ext)
    _, I, B, F, _, _ = swept
    tensors = [Hessian.empty(robot) for _ in range(robot.nv)]
    nothing = {b: [ZERO_MOTOR] * len(b.model.screws) for b in robot}
    for b, seen in _views(robot, swept, nothing):
        mine = [x for x in seen if x.joint is b]
        G = [Wrenches.of(k.response, I[b], B[b], F[b]) for k in mine]
        for i in seen:
            H, s_i = tensors[i.j], i.response.screw
            weight = Weight.rigid(s_i, I[b], B[b])
            for k in seen if i.joint is b else mine:
                turning = s_i.cross(k.response.screw) if _before(i.joint, k.joint) else ZERO_MOTOR
                effect = Effect.of(k.response, turning, weight, I[b], B[b])
                for j in seen:
                    if j.joint is k.joint or _before(j.joint, k.joint):
                        H.add(j, k.j, effect, same=j.joint is k.joint)
            for j in seen:
                if _before(i.joint, j.joint):
                    turning = s_i.cross(j.response.screw)
                    for k, wrenches in zip(mine, G, strict=True):
                        H.turn(j.j, turning, k.j, wrenches, same=j.joint is b)
    qq, qv, vv, aq = ([H[x] for H in tensors] for x in range(4))
    return qq, qv, vv, aq


def rnea_hvp(
    robot: Robot,
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    w: Sequence[Scalar],
    dq: Sequence[Scalar],
    dv: Sequence[Scalar],
    da: Sequence[Scalar],
    f_ext: Sequence[Wrench] | None = None,
) -> tuple[Vector, Vector, Vector]:
    """The Hessian of w . tau times a vector: the gradient of  w . (d tau / dq dq + d tau / dv dv + M da)."""
    qq, qv, vv, aq = rnea_hessian(robot, q, v, a, w, f_ext)
    by_q, by_v, by_a = [ZERO] * robot.nv, [ZERO] * robot.nv, [ZERO] * robot.nv
    for j in range(robot.nv):
        for k in range(robot.nv):
            by_q[k] = by_q[k] + qq[j][k] * dq[j] + qv[k][j] * dv[j] + aq[j][k] * da[j]
            by_v[k] = by_v[k] + qv[j][k] * dq[j] + vv[j][k] * dv[j]
            by_a[k] = by_a[k] + aq[k][j] * dq[j]
    return by_q, by_v, by_a


def _views(robot: Robot, swept: Sweep, turning: dict[Joint, list[Twist]]) -> Iterator[tuple[Joint, list[Seen]]]:
    """Each joint with all degrees of freedom on the path to it, its own last, in its moving frame."""
    views: dict[Joint | None, list[Seen]] = {None: []}
    for b in robot:
        own = [Seen(b, k, r, t) for (k, _), r, t in zip(b.dofs, swept.responses[b], turning[b], strict=True)]
        views[b] = [x.pulled(swept.X[b]) for x in views[b.parent]] + own
        yield b, views[b]
