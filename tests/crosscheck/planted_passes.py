"""Slips in the passes of the recursive code that no rule was written for: what is wrong, and words that tell it.

Each is a function in the place of another of `Recursive`, an independent code; the words are those of which each must
stand in what the diagnosis says.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.crosscheck.recursive import Recursive, cross, far


def _outward(
    turned_w=True, turned_alpha=True, own_w=False, parent_in_rate=False, arm="p", origin=True, over_slides=True
):
    def outward(s: Any, q: Any, v: Any, a: Any, g: Any) -> Any:
        W, b = s.base(q)[0], s.nv - s.n
        out = [(np.zeros(3), np.zeros(3), -W.T @ g)]
        for j, (R, p), vj, aj in zip(s.joints, s.steps(q), v[b:], a[b:], strict=True):
            w0, alpha0, acc0 = out[j.parent]
            zv, za = j.axis * vj, j.axis * aj
            w = R.T @ w0 if turned_w else w0
            alpha = R.T @ alpha0 if turned_alpha else alpha0
            rate = cross(w0 if parent_in_rate else R.T @ w0, zv)
            w1 = w if j.slides else w + zv
            r = R @ p if arm == "turned" else R.T @ p if arm == "back" else p
            carried = acc0 + cross(alpha0, r) + cross(w1 if own_w else w0, cross(w1 if own_w else w0, r))
            acc = R.T @ carried if origin else carried
            alpha1 = alpha * over_slides if j.slides else alpha + za + rate
            out.append((w1, alpha1, acc + za + 2 * cross(w1, zv) if j.slides else acc))
        return out

    return {"outward": outward}


def _inward(turned_n=True, turned_f=True, turned_in_arm=True, assigned=False, back=False, arm="p"):
    def inward(s: Any, q: Any, motions: Any) -> Any:
        wrenches = []
        for (m, c, I), (w, alpha, acc) in zip(s.bodies, motions, strict=True):
            f = m * s.of_centre(w, alpha, acc, c)
            wrenches.append((s.moment(s.euler(I, w, alpha), c, f), f))
        for k, n, f in getattr(s, "pushes", ()):
            wrenches[k] = (wrenches[k][0] - n, wrenches[k][1] - f)
        tau = np.zeros(s.n)
        for i in range(s.n, 0, -1):
            j, (n, f) = s.joints[i - 1], wrenches[i]
            tau[i - 1] = s.felt(j, n, f)
            R, p = s.steps(q)[i - 1]
            T = R.T if back else R
            r = R.T @ p if arm == "child" else p
            df = T @ f if turned_f else f
            dn = (T @ n if turned_n else n) + cross(r, (T @ f) if turned_in_arm else f)
            have = (0 * n, 0 * f) if assigned else wrenches[j.parent]
            wrenches[j.parent] = (have[0] + dn, have[1] + df)
        return tau

    return {"inward": inward}


def _pushed(s: Any, q: Any, v: Any, a: Any, f_ext: Any, frame: str) -> Any:
    """The wrench is among the forces of links, so that what is wrong with these is wrong with it."""
    k, _, r = s.at[frame]
    W = s.poses(q)[k][0]
    n, f = W.T @ f_ext[:3], W.T @ f_ext[3:]
    s.pushes = [(k, n + cross(r, f), f)]
    tau = s.rnea(q, v, a)
    s.pushes = []
    return tau


def _felt_along(axis):
    return {"felt": lambda s, j, n, f: float(axis(j) @ (f if j.slides else n))}


def _of_centre(f):
    return {"of_centre": lambda s, w, alpha, a, c: f(w, alpha, a, c)}


def _composite(turned_I=True, steiner=True, cross_terms=True, first=True, turned_h=True):
    def composite(s: Any, q: Any) -> Any:
        out = [(m, m * c, I + far(m, c)) for m, c, I in s.bodies]
        for i in range(s.n, 0, -1):
            (m, h, I), (R, p), k = out[i], s.steps(q)[i - 1], s.joints[i - 1].parent
            M, H, T = out[k]
            h = R @ h if turned_h else h
            I = R @ I @ R.T if turned_I else I
            if cross_terms:
                I = I + 2 * (h @ p) * np.eye(3) - np.outer(h, p) - np.outer(p, h)
            out[k] = (M + m, H + h + (m * p if first else 0), T + I + (far(m, p) if steiner else 0))
        return out

    return {"composite": composite}


def _crba(x):
    return {"crba": lambda s, q: x(s, q, Recursive.crba(s, q))}


def _aba(f):
    return {"aba": lambda s, q, v, tau: f(s, q, v, tau)}


PASSES: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "w_unturned": (("angular velocity", "not transformed"), _outward(turned_w=False)),
    "alpha_unturned": (("angular acceleration", "not transformed"), _outward(turned_alpha=False)),
    "own_w_carries": (("carries a link's origin", "link's own"), _outward(own_w=True)),
    "w_in_rate_unturned": (("w x z qd", "not transformed"), _outward(parent_in_rate=True)),
    "arm_in_links_axes": (("arm", "axes"), _outward(arm="back")),
    "acceleration_unturned": (("acceleration", "not transformed"), _outward(origin=False)),
    "alpha_ends_at_slides": (("angular acceleration of a link", "sliding links", "zero"), _outward(over_slides=False)),
    "moment_unturned": (("moment that is handed on", "not transformed"), _inward(turned_n=False)),
    "force_unturned": (("force that is handed on", "not transformed"), _inward(turned_f=False)),
    "force_in_arm_unturned": (("force in r x f", "not transformed"), _inward(turned_in_arm=False)),
    "arm_in_childs_axes": (("arm in r x f", "child's axes"), _inward(arm="child")),
    "felt_along_z": (("feels", "the z axis of the link's frame"), _felt_along(lambda j: np.array([0, 0, 1.0]))),
    "felt_in_the_parents_axes": (("feels", "parent's axes"), _felt_along(lambda j: j.R @ j.axis)),
    "children_overwrite": (("the sum so far", "left out"), _inward(assigned=True)),
    "children_overwrite_under_wrenches": (
        ("the sum so far", "left out"), {**_inward(assigned=True), "rnea_f_ext": _pushed},
    ),
    "arm_in_childs_axes_under_wrenches": (
        ("arm in r x f", "child's axes"), {**_inward(arm="child"), "rnea_f_ext": _pushed},
    ),
    "w_for_alpha": (
        ("w is taken for alpha", "x c"), _of_centre(lambda w, alpha, a, c: a + cross(w, c) + cross(w, cross(w, c)))
    ),
    "one_cross_missing": (
        ("centre of mass", "w x r"), _of_centre(lambda w, alpha, a, c: a + cross(alpha, c) + cross(w, c))
    ),
    "composite_unturned": (("child's inertia", "not transformed"), _composite(turned_I=False)),
    "composite_no_steiner": (("m (p.p 1 - p p^T)", "left out"), _composite(steiner=False)),
    "composite_no_cross": (("2 (h.p) 1", "left out"), _composite(cross_terms=False)),
    "composite_no_moment": (("m p", "left out"), _composite(first=False)),
    "composite_h_unturned": (("first moment", "not transformed"), _composite(turned_h=False)),
    "damped_inverse": (
        ("0.001",),
        _aba(lambda s, q, v, tau: np.linalg.solve(s.crba(q) + 1e-3 * np.eye(s.n), tau - s.bias(q, v))),
    ),
    "no_gravity_in_aba": (
        ("gravity",), _aba(lambda s, q, v, tau: np.linalg.solve(s.crba(q), tau - s.bias(q, v) + s.gravity(q)))
    ),
    "velocity_sign_in_aba": (
        ("Coriolis", "other sign"),
        _aba(lambda s, q, v, tau: np.linalg.solve(s.crba(q), tau + s.bias(q, v) - 2 * s.gravity(q))),
    ),
}  # fmt: skip


def wrong(name: str) -> type[Recursive]:
    """The code with this slip."""
    return type("Wrong", (Recursive,), PASSES[name][1])
