"""Errors and notes about a motion, before and after it is tracked."""

from __future__ import annotations

import warnings

import numpy as np

from ..errors import ArgumentError, DualpinWarning
from ..integrators.methods import Method
from ..integrators.stability import stability_limit
from .ik import ik
from .loop import Loop, whole_steps
from .reach import reach_of
from .task import freedoms, too_few

LOOKS = 400  # instants at which reach is checked before a run, and the Jacobian's condition after it
TRIES = 8  # instants for which a configuration is looked for where joints are few
NEAR_SINGULAR = 1e-3  # ratio of singular values: an error of a millimetre a second becomes radians
SAMPLES = 16  # random configurations: one of full rank shows that the joints have it
NO_RANK = 1e-9  # ratio of singular values that rounding leaves of a direction in which the joints move nothing


def feasible(loop: Loop, start: np.ndarray, t_end: float, unreachable: str) -> list[str]:
    """An error or a note where the trajectory certainly leaves the robot's reach."""
    if unreachable == "ignore" or not loop.n:
        return []
    text = _joints_enough(loop, start, t_end) or _within_reach(loop, t_end)
    if text and unreachable == "raise":
        raise ArgumentError(f"track: {text} (unreachable='warn' or --unreachable warn runs it anyway)")
    return [f"unreachable: {text}"] if text else []


def _joints_enough(loop: Loop, start: np.ndarray, t_end: float) -> str:
    """A note where a robot with fewer joints than task components cannot follow, with the smallest error reached."""
    why = too_few(loop.frame, loop.rows)
    if not why:
        return ""
    times = np.linspace(0.0, t_end, TRIES)
    poses = loop.motion(times)[0].reshape(TRIES * loop.n, 4, 4)
    mask = [i in loop.rows for i in range(6)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        found = ik(loop.robot, poses, loop.frame, q0=np.tile(start, (TRIES, 1)), task=mask, restarts=3,
                   tolerance=1e-6, limits=False, engine=loop.engine)  # fmt: skip
    if found.success.all():
        return ""
    worst = int(np.argmax(np.where(found.success, -1.0, np.linalg.norm(found.error, axis=-1))))
    turn, way = (float(np.linalg.norm(x)) for x in np.split(found.error[worst], 2))
    parts = [f"{x:.3g} {unit}" for x, unit in ((turn, "rad"), (way, "m")) if x > 1e-6]
    return f"{why}; at t = {times[worst // loop.n]:.4g} s they come no nearer than {' and '.join(parts)}"


def _within_reach(loop: Loop, t_end: float) -> str:
    bound = reach_of(loop.robot, loop.frame, loop.rows)
    if bound is None:
        return ""
    times = np.linspace(0.0, t_end, min(LOOKS, max(2, int(4e6 / (18 * loop.n)))))
    rows = loop.desired(times)[0].reshape(-1, 3, 4)
    excess = bound.excess(rows).reshape(len(times), loop.n)
    if not excess.any():
        return ""
    k, member = np.unravel_index(int(np.argmax(excess)), excess.shape)
    d = float(bound.distance(rows.reshape(len(times), loop.n, 3, 4)[k, member]))
    limit = f"reach only {bound.farthest:.4g} m" if d > bound.farthest else f"keep at least {bound.nearest:.4g} m apart"
    return (
        f"the trajectory leaves the workspace of {loop.robot.name}: at t = {times[k]:.4g} s"
        + (f" in member {member} of the batch" if loop.batch else "")
        + f" the point {_point(bound.tip)} of frame {loop.frame.name!r} would be {d:.4g} m from the point "
        f"{_point(bound.base)} on the axis of joint {bound.first!r}, and the links between them {limit}; "
        "a smaller or nearer trajectory is needed"
    )


def _point(x: np.ndarray) -> str:
    return "(" + ", ".join(f"{c:.3g}" for c in np.round(x, 9) + 0.0) + ")"


def unstable(method: Method, gain: float, dt: float, held: bool) -> list[str]:
    """K dt above the limit at which the loop's linear error begins to grow."""
    if not whole_steps(method) or not gain * dt > 0:
        return []
    limit = stability_limit(method, held=True) if held else method.stability_limit
    what = method.name + (" with held feedback" if held else "")
    # bisected to 1e-12: at the limit itself errors stay
    if gain * dt <= limit * (1 + 1e-9):
        return []
    return [f"unstable: K dt = {gain * dt:.4g} exceeds {limit:.4g}, the limit of {what}: errors grow"]


def after(loop: Loop, q: np.ndarray) -> list[str]:
    """What the caller should know about the motion found, q (n + 1, B, nq): one sentence a kind."""
    robot, notes = loop.robot, []
    if not np.isfinite(q).all():
        k = int(np.argwhere(~np.isfinite(q).all(axis=(1, 2)))[0, 0])
        notes.append(
            f"not finite: the motion is not finite from t = {k * loop.dt:.6g} s on; the loop is unstable at this gain "
            "and step"
        )
    passed = []
    for joint in robot:
        if joint.mimic is None and joint.model.additive:
            x, lower, upper = q[..., joint.q], robot.lower[joint.q], robot.upper[joint.q]
            beyond = (((x < lower - 1e-9) | (x > upper + 1e-9)) & (lower <= upper)).any(axis=(1, 2))
            if beyond.any():
                at = int(np.argmax(beyond)) * loop.dt
                span = f"[{lower[0]:.4g}, {upper[0]:.4g}]"
                passed.append(f"joint {joint.name!r} passes its limits {span} at t = {at:.4g} s")
    if passed:
        more = f", and {len(passed) - 1} more joints theirs" if len(passed) > 1 else ""
        notes.append(f"limits: {passed[0]}{more}")
    looks = np.unique(np.linspace(0, len(q) - 1, max(1, min(len(q), LOOKS // max(loop.n, 1)))).astype(int))
    seen = q[looks].reshape(-1, robot.nq)
    seen = seen[np.isfinite(seen).all(axis=-1)]
    if len(seen):
        ratio = _ratios(loop, seen)
        rank = int(np.max(np.sum(_ratios(loop, robot.sample(SAMPLES, seed=0)[0]) > NO_RANK, axis=-1)))
        if rank < min(len(loop.rows), freedoms(loop.frame)):
            notes.append(
                f"rank: the Jacobian of frame {loop.frame.name!r} has rank {rank} in every configuration: "
                f"{rank} of {len(loop.rows)} directions"
            )
        elif (least := float(ratio[:, min(ratio.shape[-1], max(rank, 1)) - 1].min())) < NEAR_SINGULAR:
            notes.append(
                f"singular: near a singularity, the Jacobian's singular values come as close as 1 : {least:.2g}"
            )
    return notes


def _ratios(loop: Loop, q: np.ndarray) -> np.ndarray:
    """Singular values of the task's Jacobian, the largest of each configuration 1."""
    s = np.linalg.svd(loop.jacobian(q), compute_uv=False)
    return s / np.where(s[:, :1] > 0, s[:, :1], 1.0)
