"""Mistakes in the recursive code, each a function in the place of another, and the keys that name them rightly.

The kinds were listed before the hypotheses were read; the results are in `validation/referee/planted.md`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.crosscheck.recursive import Recursive, about, cross, far

E = np.eye(3)
Mistake = tuple[str, dict[str, Any]]


def _read(f: Any) -> dict[str, Any]:
    return {"origin": f, "inertial_origin": Recursive.origin}


def _placed(f: Any) -> Any:
    return lambda s, e: f(*Recursive.origin(s, e))


def _tensor(f: Any) -> dict[str, Any]:
    return {"tensor": lambda s, e: f(Recursive.tensor(s, e))}


def _turns(angles: Any, order: tuple[int, ...]) -> Any:
    R = np.eye(3)
    for k in order:
        R = R @ about(E[k], angles[k])
    return R


def _seen(s: Any, x: Any) -> Any:
    return Recursive.frame_acceleration(s, *x)


def _pose(f: Any) -> dict[str, Any]:
    """Another fk, beside the right Jacobian."""
    return {
        "fk": lambda s, q, frame: f(Recursive.fk(s, q, frame)),
        "jacobian": lambda s, q, frame: s.columns(q, s.at[frame][0], Recursive.fk(s, q, frame)[:3, 3]),
    }


def _tau(f: Any) -> dict[str, Any]:
    return {"rnea": lambda s, q, v, a: f(Recursive.rnea(s, q, v, a))}


def _xyz(s: Any, e: Any, name: str) -> Any:
    return s.numbers(e.get(name, "0 0 0"))


def _numbers(f: Any) -> dict[str, Any]:
    return {"numbers": lambda s, text: f(Recursive.numbers(s, text))}


MISTAKES: dict[str, Mistake] = {
    # reading
    "rpy_xyz": ("rpy_order inertial_rpy_order step_other", {"turned": lambda s, a: _turns(a, (0, 1, 2))}),
    "joint_rpy_yaw_only": ("rpy_part", _read(lambda s, e: (_turns(_xyz(s, e, "rpy"), (2,)), _xyz(s, e, "xyz")))),
    "origin_backwards": ("origin_inverted", _read(_placed(lambda R, p: (R.T, -R.T @ p)))),
    "xyz_turned": ("xyz_after_rpy", _read(_placed(lambda R, p: (R, R @ p)))),
    "z_forgotten": ("xyz_order", _read(_placed(lambda R, p: (R, p * [1, 1, 0])))),
    "inches": ("xyz_units", _read(_placed(lambda R, p: (R, 0.0254 * p)))),
    "inertial_rpy_ignored": ("inertial_rpy", {"in_link": lambda s, I, R: I}),
    "inertial_rpy_inverted": ("inertial_rpy_transposed", {"in_link": lambda s, I, R: R.T @ I @ R}),
    "com_y_negative": ("inertial_xyz_order", {"inertial_origin": _placed(lambda R, c: (R, c * [1, -1, 1]))}),
    "com_turned": ("inertial_xyz_turned", {"inertial_origin": _placed(lambda R, c: (R, R @ c))}),
    "products_negative": ("products_sign", _tensor(lambda I: 2 * np.diag(np.diag(I)) - I)),
    "products_halved": ("products_scale", _tensor(lambda I: (I + np.diag(np.diag(I))) / 2)),
    "axis_in_parent": ("axis_in_parent", {"axis": lambda s, e, R: R.T @ Recursive.axis(s, e, R)}),
    "axis_turned_again": ("axis_turned", {"axis": lambda s, e, R: R @ Recursive.axis(s, e, R)}),
    "axis_y_and_z": ("axis_order", {"axis": lambda s, e, R: Recursive.axis(s, e, R)[[0, 2, 1]]}),
    "three_decimals": ("file_digits", _numbers(lambda x: np.round(x, 3))),
    "float32": ("single_precision", _numbers(lambda x: x.astype(np.float32).astype(float))),
    "fixed_unturned": ("merge_turn", {"carried": lambda s, m, c, I, R, p: (m, p + c, I)}),
    "fixed_tensor_unturned": ("merge_tensor_unturned", {"carried": lambda s, m, c, I, R, p: (m, p + R @ c, I)}),
    "no_steiner": ("merge_steiner", {"steiner": lambda s, m, c: 0 * far(m, c)}),
    "fixed_massless": ("fixed_dropped", {"merged": lambda s, group: Recursive.merged(s, group[:1])}),
    "g_9.8": ("gravity", {"g": np.array([0, 0, -9.8])}),
    "g_along_y": ("gravity", {"g": np.array([0, -9.81, 0])}),
    # the passes
    "no_turning": ("axis_rate", {"turning": lambda s, w, zv: 0 * zv}),
    "turning_backwards": ("axis_rate_sign", {"turning": lambda s, w, zv: cross(zv, w)}),
    "no_sliding": ("slide_coriolis", {"sliding": lambda s, w, zv: 0 * zv}),
    "sliding_once": ("slide_coriolis_half", {"sliding": lambda s, w, zv: cross(w, zv)}),
    "no_centripetal": ("centripetal_link", {"centripetal": lambda s, w, r: 0 * r}),
    "centripetal_backwards": ("centripetal_link_sign", {"centripetal": lambda s, w, r: -cross(w, cross(w, r))}),
    "no_tangential": ("tangential_link", {"tangential": lambda s, alpha, r: 0 * r}),
    "tangential_backwards": ("tangential_link_sign", {"tangential": lambda s, alpha, r: cross(r, alpha)}),
    "no_centripetal_of_centre": ("centripetal_com", {"of_centre": lambda s, w, alpha, a, c: a + cross(alpha, c)}),
    "no_gyroscopic": ("gyroscopic", {"euler": lambda s, I, w, alpha: I @ alpha}),
    "gyroscopic_backwards": ("gyroscopic_sign", {"euler": lambda s, I, w, alpha: I @ alpha + cross(I @ w, w)}),
    "gyroscopic_halved": ("gyroscopic_half", {"euler": lambda s, I, w, alpha: I @ alpha + 0.5 * cross(w, I @ w)}),
    "no_spin": ("no_angular_acceleration", {"euler": lambda s, I, w, alpha: cross(w, I @ w)}),
    "no_arm_of_centre": ("moment_arm", {"moment": lambda s, n, c, f: n}),
    "arm_of_centre_backwards": ("moment_arm_sign", {"moment": lambda s, n, c, f: n + cross(f, c)}),
    "no_arm_of_joint": ("force_moment_link", {"handed": lambda s, R, p, n, f: (R @ n, R @ f)}),
    "arm_of_joint_backwards": (
        "force_moment_link_sign", {"handed": lambda s, R, p, n, f: (R @ n - cross(p, R @ f), R @ f)}
    ),
    "moment_kept": ("moment_not_handed_on", {"handed": lambda s, R, p, n, f: (cross(p, R @ f), R @ f)}),
    "wrench_kept": ("not_handed_on diagonal", {"handed": lambda s, R, p, n, f: (0 * n, 0 * f)}),
    "slide_feels_moment": ("slide_moment", {"felt": lambda s, j, n, f: float(j.axis @ n)}),
    # what follows
    "lever_backwards": ("jacobian_linear_sign column_scale tangential_sign", {"lever": lambda s, z, r: cross(r, z)}),
    "centre_unturned": ("com_frame", {"centre": lambda s, c, W, o: o + c}),
    "tau_plus_h": ("bias_sign", {"aba": lambda s, q, v, tau: np.linalg.solve(s.crba(q), tau + s.bias(q, v))}),
    "aba_diagonal": ("diagonal_inverse", {"aba": lambda s, q, v, tau: (tau - s.bias(q, v)) / np.diag(s.crba(q))}),
    "accelerometer": ("proper_acceleration", {"frame_acceleration": lambda s, *x: _seen(s, x) - np.r_[0, 0, 0, s.g]}),
    "fk_transposed": ("pose_transposed", _pose(lambda H: H.T)),
    "fk_millimetres": ("position_units", _pose(lambda H: H * np.array([[1, 1, 1, 1e3]] * 3 + [[1] * 4]))),
    "tau_float": ("single_precision few_digits", _tau(lambda t: t.astype(np.float32))),
    "saturated": ("saturated", _tau(lambda t: np.clip(t, -9, 9))),
    "gears": ("joint_scale", _tau(lambda t: t * np.r_[np.ones(len(t) - 1), -1])),
}  # fmt: skip
"""The keys are those of which one at least is to be named; `BESIDES` may stand beside them."""

BESIDES = {"follows", "same_cv", "same_product"}

PAIRS = [
    ("inertial_rpy_ignored", "g_9.8"), ("axis_in_parent", "products_negative"), ("no_gyroscopic", "fk_transposed"),
    ("com_y_negative", "no_steiner"), ("z_forgotten", "gears"), ("fixed_unturned", "tau_plus_h"),
    ("no_sliding", "no_gyroscopic"), ("accelerometer", "g_along_y"), ("turning_backwards", "aba_diagonal"),
]  # fmt: skip


def wrong(*names: str) -> type[Recursive]:
    """The code with these mistakes."""
    changes = {k: f for n in names for k, f in MISTAKES[n][1].items()}
    return type("Wrong", (Recursive,), changes)
