"""Christoffel's symbols of a mass matrix whose derivatives are made of Jacobians, without differences.

    dw_i/dq_k = w_k x w_i     dv_i/dq_k = w_k x v_i       joint k before i, or i itself
    dw_i/dq_k = 0             dv_i/dq_k = w_i x v_k       joint k behind i
    dM_ij/dq_k = sum m (dv_i . v_j + v_i . dv_j) + dw_i . I w_j + w_i . I dw_j + w_i . ([w_k] I - I [w_k]) w_j

w_i and v_i are the columns of a body's Jacobian, v_i at its centre of mass.

References: Siciliano et al., Robotics (2009), equation 7.45; Bruyninckx and De Schutter, Symbolic differentiation of
the velocity mapping for a serial kinematic chain, Mechanism and Machine Theory 31 (1996).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ...subjects.layout import transposed
from . import one_joint
from .assembly import MOST_STEPS, of_symbols
from .columns import CENTRE
from .equations import Equations, other_products
from .products import skew
from .second import by_products, same
from .steps import UncoveredError

TURNING = "the axes that turn columns"
SECOND, EACH = "of the second Jacobian", "of both Jacobians"


def coriolis(
    sums: Equations, by_rates: bool = False, apart: bool = False, carried: bool = False, tensors: str = "",
    mirrored: bool = False, turned: bool = False,
) -> np.ndarray:  # fmt: skip
    """C (runs, samples, nv, nv), of few joints with one axis each on a fixed base.

    `by_rates`: derivatives of Jacobians are their rates where one joint moves alone.
    `apart`: what joints do to axes and origins of others is not found by Jacobians.
    `carried`: a body's columns are derived by, and of, the joints that carry it, whichever columns it has.
    `tensors`: J_i . M dJ_j is made and transposed (SECOND), not dJ_i . M J_j, or each is made by itself (EACH), which
    tensors that are not symmetric tell apart.
    `mirrored`: of dI/dq_k only [w_k] I is made, and its transpose is added.
    `turned`: as in `of_symbols`.
    """
    steps, cols, v = sums.steps, sums.columns, sums.poses.qd
    count = len(cols.axes)
    if v is None or any(a.base or a.follows for a in cols.axes) or count > MOST_STEPS or count != v.shape[-1]:
        raise UncoveredError("few joints with an axis and a coordinate of their own, on a fixed base, only")
    order = [int(i) for i in np.argsort([a.column for a in cols.axes])]
    J = transposed(sums.jacobians)  # (runs, n, bodies, joints, 6)
    w, u = J[..., :3], J[..., 3:]
    which = sums.poses.carries()[sums.links][None, None] if carried else cols.moving(sums.links)[..., 0, :]
    moved = which[..., order].astype(float)
    z = cols.z[..., None, order, :]
    own = cols.turns[order, None] * z
    all_turn = {"those of sliding joints too": z}
    before, behind = (
        steps.pick(f"{TURNING}: {whose}", own, **all_turn) if apart else w for whose in ("those behind it", "its own")
    )
    of_axes = partial(by_products, cols, w, u, moved, order, before, behind)
    dw, du = _by_rates(sums, order, apart) if by_rates else of_axes()
    last = moved * (np.cumsum(moved[..., ::-1, :], -2)[..., ::-1, :] == 1)
    counted = steps.pick(
        "the bodies in dM/dq_k", np.ones_like(moved), **{"the last one that joint k moves alone": last}
    )
    dw, du = (x * counted[..., None, :, None] for x in same(dw, du))
    I, m = sums.inertia, sums.masses("the mass in dM/dq_k")
    site = "the bodies of dM/dq_k"
    m = m * sums.every(f"{site}: m Jv^T Jv")
    spin, turning = (sums.every(f"{site}: {of}")[..., None, None] for of in ("Jw^T I Jw", "dI/dq_k"))
    T = spin * steps.pick("the inertia in dw_i . I w_j", I, **_turned_wrongly(sums))

    def of_one(T: np.ndarray) -> np.ndarray:
        parts = {
            "m dv_i . v_j": np.einsum("rnbikx,rnbjx->rnijk", *same(du, m[..., None, None] * u)),
            "dw_i . I w_j": np.einsum("rnbikx,rnbjx->rnijk", *same(dw, w @ transposed(T))),
        }  # fmt: skip
        return np.asarray(steps.add("the derivative of the first Jacobian in M", **parts))

    half = of_one(transposed(T) if tensors == SECOND else T)
    other = np.swapaxes(of_one(transposed(T)) if tensors == EACH else half, 2, 3)
    axes = w
    if apart:
        axes = steps.pick("the axes that turn tensors", own, **all_turn)
    I = steps.pick("the inertia in dI/dq_k", I, **_turned_wrongly(sums))
    W, T = skew(steps, moved[..., None] * axes), I[..., None, :, :]  # of joints that carry the body
    terms = {
        "[w_k] I": steps.pick("[w_k] I in dI/dq_k", W @ T, **other_products(W, T)),
        "-I [w_k]": -steps.pick("I [w_k] in dI/dq_k", T @ W, **other_products(T, W)),
    }  # fmt: skip
    if mirrored:
        terms["-I [w_k]"] = transposed(W @ T)
    rate = (turning * counted[..., None])[..., None] * steps.add("dI/dq_k", **terms)
    both = {
        "the derivative of the first Jacobian":
            steps.pick("dJ_i . M J_j in dM/dq_k", half, **{"J_i . M dJ_j, which comes twice": other}),
        "that of the second":
            steps.pick("J_i . M dJ_j in dM/dq_k", other, **{"dJ_i . M J_j, which comes twice": half}),
    }  # fmt: skip
    whole = {
        "dJ_i . M J_j + J_i . M dJ_j": steps.add("dJ_i . M J_j + J_i . M dJ_j in dM/dq_k", **both),
        "w_i . dI/dq_k w_j, of the tensors that turn,":
            np.einsum("rnbix,rnbkxy,rnbjy->rnijk", *same(w, rate, w), optimize=True),
    }  # fmt: skip
    dM = steps.add("dM/dq_k", **whole)
    if mirrored:
        one = half + np.einsum("rnbix,rnbkxy,rnbjy->rnijk", *same(w, W @ T, w), optimize=True)
        dM = steps.pick("dM/dq_k, of one half and its transpose,", dM, **{"twice the half": 2 * one, "half": one})
    columns = sorted(range(count), key=order.__getitem__)
    return of_symbols(steps, dM, v[0], columns, turned)


def _turned_wrongly(sums: Equations) -> dict[str, Callable[[], np.ndarray]]:
    back = transposed(sums.R)
    return {
        "that in its link's axes, not turned into the world's": lambda: sums.tensors + 0 * sums.R,
        "turned by the transposed matrix, R^T I R": lambda: back @ sums.tensors @ sums.R,
    }


def _by_rates(sums: Equations, order: list[int], apart: bool) -> tuple[np.ndarray, np.ndarray]:
    """The same, as rates."""
    rates = one_joint.rates(sums.columns, sums.c, sums.links, CENTRE, apart)
    D = np.moveaxis(np.stack(same(*(rates[k][..., order] for k in order)), -1), 3, -1)
    return D[..., :3], D[..., 3:]
