"""Rates of Jacobians by second derivatives of positions (the kinematic Hessian), joint by joint along a path.

    d z_k / d q_m = z_m x z_k            of an earlier turning joint m
    d2 p / d q_k d q_m = z_f x dp/dq_l   f the first and l the last of both along the path; 0 where f slides
    dJ/dt = sum_m (dJ / d q_m) v_m

References: Haviland and Corke, Manipulator Differential Kinematics, part 2, IEEE RAM 31 (2024), section II;
Hourtash, The Kinematic Hessian and Higher Derivatives, CIRA (2005).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from . import one_joint
from .columns import MOVING, Columns
from .products import wedge
from .steps import Steps, UncoveredError
from .walks import ALL, CHAIN

ORDER = "the order of joints along a path"
REVERSED = "reversed"


class SecondDerivatives(Columns):
    """Columns whose rates are made of second derivatives; of fixed bases, and joints of one axis each."""

    def rates(
        self, points: np.ndarray, velocities: np.ndarray, links: Sequence[int], whose: str = "a frame"
    ) -> np.ndarray:  # fmt: skip
        """(runs, n, points, 6, axes): d/dt of `at`."""
        if any(a.base for a in self.axes) or len(set(self.links)) < len(self.axes):
            raise UncoveredError("a base that moves, or joints of several axes")
        steps, few, count = self.steps, self.steps.few, len(self.axes)
        J = np.swapaxes(self.at(points, links, whose), -1, -2)  # (..., axes, 6)
        dp, z = J[..., 3:], self.z[..., None, :, :] + 0 * J[..., :3]
        carries = self.poses.carries()[self.links]  # (k, m): m is k, or before it on its path
        turns, own = self.turns > 0, np.eye(count, dtype=bool)
        earlier = np.asarray(steps.pick(ORDER, (carries & ~own)[None], **{REVERSED: (carries.T & ~own)[None]}))
        listed = np.tril(np.ones((count, count), bool), -1)[None]
        earlier = np.asarray(steps.pick(MOVING, earlier, **{ALL: listed, CHAIN: listed}))
        later = np.swapaxes(earlier, -1, -2)
        z_k, z_m = z[..., :, None, :], z[..., None, :, :]
        axis_of_m, axis_of_k = wedge(steps, z_m, dp[..., :, None, :]), wedge(steps, z_k, dp[..., None, :, :])
        of_m, of_k = turns[None, :, None] * axis_of_m, turns[:, None, None] * axis_of_k

        def where(mask: np.ndarray) -> np.ndarray:
            return mask.reshape(-1, 1, 1, count, count, 1).astype(float)

        m_turns, k_turns = turns[None, :, None], turns[:, None, None]
        site = "the second derivative of a position"
        by_earlier = steps.add(
            f"{site} by an earlier joint",
            **{"that of a column that turns": where(earlier) * k_turns * of_m,
               "that of a column that slides": where(earlier) * ~k_turns * of_m},
        )  # fmt: skip
        by_later = steps.add(
            f"{site} by a later joint",
            **{"that by a joint that turns": where(later) * m_turns * of_k,
               "that by a joint that slides": where(later) * ~m_turns * of_k},
        )  # fmt: skip
        terms = {
            "that by an earlier joint": by_earlier, "that by a later joint": by_later,
            "that by the joint itself (centrifugal)": where(own[None]) * of_k,
        }  # fmt: skip
        ddp = steps.add(site, **terms)
        both = where(earlier | later | own)
        others = {
            "z_k x dp_m whichever comes first": lambda: few(both) * few(of_k),
            "z_m x dp_k whichever comes first": lambda: few(both) * few(of_m),
            "with the axis of the later joint before the column of the earlier one": lambda: (
                where(few(earlier) | own) * few(of_k) + where(few(later)) * few(of_m)
            ),
        }  # fmt: skip
        ddp = steps.pick("the second derivative of a position, as a product,", ddp, **others)
        turning = turns[:, None, None] * turns[None, :, None] * wedge(steps, z_m, z_k)
        others = {
            "that by later joints": lambda: where(few(later)) * few(turning),
            "that by all joints of the path": lambda: few(both) * few(turning),
        }  # fmt: skip
        dz = steps.pick("the derivative of an axis by earlier joints", where(earlier) * turning, **others)
        dz = steps.add("the derivative of an angular column", **{"z_m x z_k": dz})
        qd = self.poses.qd
        assert qd is not None
        rate = np.concatenate(np.broadcast_arrays(dz, ddp), -1)  # (..., k, m, 6)
        by_axis = np.stack([a.ratio * qd[..., a.column] for a in self.axes], -1)[:, :, None, None, :, None]
        moving = self.moving(links)
        felt = np.swapaxes(moving, -1, -2)[..., None, :, :]  # a joint off the path moves nothing
        return np.swapaxes((rate * by_axis * felt).sum(-2), -1, -2) * moving


class Products(Columns):
    """Columns whose rates are made of products of columns."""

    def rates(
        self, points: np.ndarray, velocities: np.ndarray, links: Sequence[int], whose: str = "a frame"
    ) -> np.ndarray:  # fmt: skip
        """(runs, n, points, 6, axes): d/dt of `at`."""
        if any(a.base for a in self.axes) or len(set(self.links)) < len(self.axes):
            raise UncoveredError("a base that moves, or joints of several axes")
        J, qd = np.swapaxes(self.at(points, links, whose), -1, -2), self.poses.qd
        assert qd is not None
        moved = self.moving(links)[..., 0, :].astype(float)
        by_q = by_products(self, J[..., :3], J[..., 3:], moved, list(range(len(self.axes))), J[..., :3], J[..., :3])
        rate = np.stack([a.ratio * qd[..., a.column] for a in self.axes], -1)[:, :, None, None, :, None]
        dw, du = ((x * rate).sum(-2) for x in same(*by_q))
        return np.swapaxes(np.concatenate([dw, du], -1), -1, -2)


class Gradients(Columns):
    """Columns whose rates are sums of their derivatives by each joint."""

    def rates(
        self, points: np.ndarray, velocities: np.ndarray, links: Sequence[int], whose: str = "a frame"
    ) -> np.ndarray:  # fmt: skip
        """(runs, n, points, 6, axes): d/dt of `at`."""
        if any(a.base for a in self.axes):
            raise UncoveredError("a base that moves")
        qd = self.poses.qd
        assert qd is not None
        by_q = one_joint.rates(self, points, links, whose, apart=True)
        parts = [D * (a.ratio * qd[..., a.column])[..., None, None, None] for a, D in zip(self.axes, by_q, strict=True)]
        return np.asarray(sum(parts[1:], parts[0]))


def by_products(
    cols: Columns, w: np.ndarray, u: np.ndarray, moved: np.ndarray, order: list[int], axes: np.ndarray, own: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """dw_i/dq_k and dv_i/dq_k (runs, n, bodies, i, k, 3), as products of columns; `moved` says which a joint moves.

    `axes` are those about which joints turn others, `own` those about which they turn themselves: angular columns, or
    axes.
    """
    steps, count = cols.steps, len(order)
    carries = cols.poses.carries()[[cols.axes[i].link for i in order]][:, order]
    listed = np.tril(np.ones((count, count), bool))[None, None, None]
    before = steps.pick(MOVING, carries[None, None, None], **{ALL: listed, CHAIN: listed})[..., None]  # k carries i
    both = (moved[..., :, None] * moved[..., None, :])[..., None]  # of every body
    w, u, axes, own = same(w, u, axes, own)
    w_i, u_i, u_k = w[..., :, None, :], u[..., :, None, :], u[..., None, :, :]
    a_i, a_k = own[..., :, None, :], axes[..., None, :, :]
    turned = both * wedge(steps, a_k + 0 * w_i, w_i + 0 * a_k)
    right = before * turned
    wrong = {"those of joints behind it": lambda: ~before * turned, "those of all joints": turned}
    of_w = {"w_k x w_i": steps.pick("the derivatives of an angular column, by joints before it,", right, **wrong)}
    dw = steps.add("the derivative of an angular column by q_k", **of_w)
    by_axis = both * wedge(steps, a_k + 0 * u_i, u_i + 0 * a_k)
    wrong = {"w_i x v_i": lambda: wedge(Steps(), a_i + 0 * u_i, u_i + 0 * a_i)}
    behind = steps.pick("w_i x v_k, of joints k behind it,", wedge(steps, a_i + 0 * u_k, u_k + 0 * a_i), **wrong)
    terms = {
        "w_k x v_i, of joints before it,": before * by_axis,
        "w_i x v_k, of joints behind it,": ~before * both * behind,
    }  # fmt: skip
    du = steps.add("the derivative of a linear column by q_k", **terms)
    return dw, steps.pick("the whole derivative of a linear column by q_k", du, **{"w_k x v_i for all joints": by_axis})


def same(*arrays: np.ndarray) -> list[np.ndarray]:
    """With as many runs and samples each."""
    lead = np.broadcast_shapes(*(x.shape[:2] for x in arrays))
    return [np.broadcast_to(x, (*lead, *x.shape[2:])) for x in arrays]
