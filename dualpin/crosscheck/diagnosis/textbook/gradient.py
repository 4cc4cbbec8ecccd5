"""Christoffel's symbols of a mass matrix whose derivatives are made of Jacobians, without differences.

    dw_i/dq_k = w_k x w_i     dv_i/dq_k = w_k x v_i       joint k before i, or i itself
    dw_i/dq_k = 0             dv_i/dq_k = w_i x v_k       joint k behind i
    dM_ij/dq_k = sum m (dv_i . v_j + v_i . dv_j) + dw_i . I w_j + w_i . I dw_j + w_i . ([w_k] I - I [w_k]) w_j

w_i and v_i are the columns of a body's Jacobian, v_i at its centre of mass.

References: Siciliano et al., Robotics (2009), equation 7.45; Bruyninckx and De Schutter, Symbolic differentiation of
the velocity mapping for a serial kinematic chain, Mechanism and Machine Theory 31 (1996).
"""

from __future__ import annotations

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import transposed
from .assembly import MOST_STEPS, of_symbols
from .steps import cross
from .weighted import Sums


def coriolis(sums: Sums) -> np.ndarray:
    """C (runs, samples, nv, nv), of few joints with one axis each on a fixed base."""
    steps, cols, v = sums.steps, sums.columns, sums.poses.qd
    count = len(cols.axes)
    if v is None or any(a.base or a.follows for a in cols.axes) or count > MOST_STEPS or count != v.shape[-1]:
        raise ValueError("few joints with an axis and a coordinate of their own, on a fixed base, only")
    J = transposed(sums.jacobians)  # (runs, n, bodies, axes, 6)
    w, u = J[..., :3], J[..., 3:]
    order = np.argsort([a.column for a in cols.axes])
    carries = sums.poses.carries()
    before = carries[[cols.axes[i].link for i in order]][:, order]  # [i, k]: whether joint k carries joint i
    moved = carries[sums.links][:, order].astype(float)
    both = (moved[:, :, None] * moved[:, None, :])[..., None]  # of every body

    first, second = w[..., :, None, :], u[..., :, None, :]  # of i
    w_k, u_k = w[..., None, :, :], u[..., None, :, :]
    nearer, behind = before[..., None] * both, ~before[..., None] * both
    of_w = {"w_k x w_i": nearer * cross(w_k + 0 * first, first + 0 * w_k)}
    dw = steps.add("the derivative of an angular column by q_k", **of_w)
    by_base = cross(w_k + 0 * second, second + 0 * w_k)
    of_u = {
        "w_k x v_i, of joints before it,": nearer * by_base,
        "w_i x v_k, of joints behind it,": behind * cross(first + 0 * u_k, u_k + 0 * first),
    }
    du = steps.add("the derivative of a linear column by q_k", **of_u)
    du = steps.pick(
        "the whole derivative of a linear column by q_k", du, **{"w_k x v_i for all joints": both * by_base}
    )
    I = sums.inertia
    Iw = w @ transposed(I)
    m = sums.m[..., None, None]
    parts = {
        "m dv_i . v_j": np.einsum("rnbikx,rnbjx->rnijk", *_same(du, m * u)),
        "dw_i . I w_j": np.einsum("rnbikx,rnbjx->rnijk", *_same(dw, Iw)),
    }  # fmt: skip
    half = steps.add("the derivative of the first Jacobian in M", **parts)
    W = cross_matrix(moved[..., None] * w)  # of joints that carry the body
    terms = {"[w_k] I": W @ I[..., None, :, :], "-I [w_k]": -I[..., None, :, :] @ W}
    rate = steps.add("dI/dq_k", **terms)
    turned = np.einsum("rnbix,rnbkxy,rnbjy->rnijk", *_same(w, rate, w), optimize=True)
    half_too = np.swapaxes(half, 2, 3)
    whole = {
        "the derivative of the first Jacobian": half, "that of the second": half_too,
        "w_i . dI/dq_k w_j, of the tensors that turn,": turned,
    }  # fmt: skip
    return of_symbols(steps, steps.add("dM/dq_k", **whole), v[0])


def _same(*arrays: np.ndarray) -> list[np.ndarray]:
    """With as many runs and samples each."""
    lead = np.broadcast_shapes(*(x.shape[:2] for x in arrays))
    return [np.broadcast_to(x, (*lead, *x.shape[2:])) for x in arrays]
