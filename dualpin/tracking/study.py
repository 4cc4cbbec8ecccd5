"""Compare integrators on a circle of any robot: peak errors, cost, measured stability limits."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import pi
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import count
from ..call.arguments import as_array
from ..delegates import home
from ..errors import DualpinWarning
from ..functions import jacobian
from ..model.limits import ranges
from ..model.robot import Frame, Robot
from ..terms import configuration
from .loop import task_jacobian
from .task import POSE, Rows, rows_of
from .track import TrackingResult, track
from .trajectories import Circle

METHODS = ("euler", "trapezoidal", "abm4", "rk4")
STEPS = (0.01, 0.1, 1.0)
GAINS = (0.0, 1.0)


@dataclass(frozen=True)
class Row:
    """One run: what was asked, the largest errors [m, rad], and what it cost.

    ``late`` are the largest errors of the last turn.
    """

    robot: str
    frame: str
    method: str
    dt: float
    gain: float
    feedback: str
    turns: float
    task: str
    plane: str
    position_peak: float
    orientation_peak: float
    position_late: float
    orientation_late: float
    evaluations: int
    seconds: float
    warnings: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """As plain data, for JSON."""
        return asdict(self)


class IntegratorStudy(list[Row]):
    """The runs of a study, and what they have in common.

    Attributes
    ----------
    settings : dict
        "robot", "frame", "radius" [m], "period" [s], "plane", "turns", "task", "start" [rad, m], ...
    """

    settings: dict[str, Any]

    def __init__(self, rows: Sequence[Row] = (), settings: dict[str, Any] | None = None) -> None:
        super().__init__(rows)
        self.settings = settings or {}

    @property
    def title(self) -> str:
        """Robot, circle, start and steps in one sentence."""
        s = self.settings
        q = ", ".join(f"{x:.4g}" for x in s["start"])
        steps = ", ".join(f"{x:g}" for x in dict.fromkeys(r.dt for r in self))
        return (
            f"{s['robot']}: {s['frame']} on a circle of radius {s['radius']:g} m in the {s['plane']} plane, "
            f"{s['turns']} {'turn' if s['turns'] == 1 else 'turns'} of {s['period']:g} s, start q = ({q}), "
            f"dt = {steps} s"
        )

    def __repr__(self) -> str:
        return (
            f"<IntegratorStudy of {len(self)} runs: {self.title}>"
            if self.settings
            else f"<IntegratorStudy of {len(self)} runs>"
        )

    def _repr_html_(self) -> str:
        return home("IntegratorStudy._repr_html_")(self)

    def plot(self, axes: Any = None) -> Any:
        """Draw the peak errors against evaluations and against time; returns the two axes (needs matplotlib)."""
        return home("IntegratorStudy.plot")(self, axes)

    def save(self, path: str | PathLike[str]) -> None:
        """The drawing as a file: .png, .svg or .pdf."""
        home("IntegratorStudy.save")(self, path)


def pa10() -> Robot:
    """The Mitsubishi PA-10 with seven joints, by standard Denavit-Hartenberg rows, a = 0.

    Examples
    --------
    >>> from dualpin.tracking.study import pa10
    >>> pa10().nq
    7
    """
    return _anthropomorphic("pa10", (0.317, 0.450, 0.480, 0.070))


def seven_joint_arm() -> Robot:
    """An arm with the proportions of a KUKA iiwa: shoulder, elbow and wrist of intersecting axes.

    Examples
    --------
    >>> from dualpin.tracking.study import seven_joint_arm
    >>> seven_joint_arm().nv
    7
    """
    return _anthropomorphic("seven_joint_arm", (0.360, 0.420, 0.400, 0.126))


def _anthropomorphic(name: str, lengths: tuple[float, float, float, float]) -> Robot:
    from dataclasses import replace

    from ..forms import from_dh

    base, upper, lower, tool = lengths
    d = (base, 0.0, upper, 0.0, lower, 0.0, tool)
    alpha = (-pi / 2, pi / 2) * 3 + (0.0,)
    robot = from_dh([(0.0, x, 0.0, a) for x, a in zip(d, alpha, strict=True)], joints="R" * 7, convention="standard")
    return replace(robot, name=name)


def comfortable(robot: Robot, frame: Frame, samples: int = 2000, seed: int = 0, rows: Rows = POSE) -> np.ndarray:
    """The configuration with the best conditioned Jacobian among random ones in the middle half of the limits.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.tracking.study import comfortable
    >>> robot = dp.load("ur5")
    >>> comfortable(robot, robot.frame("tool0")).shape
    (6,)
    """
    q, _, _ = robot.sample(samples, seed=seed)
    (lower, upper), bounded = ranges(robot), np.isfinite(robot.lower) & np.isfinite(robot.upper)
    middle = lower / 2 + upper / 2
    inner = np.where(bounded, middle + (q - middle) / 2, q)
    s = np.linalg.svd(task_jacobian(robot, frame, rows, inner), compute_uv=False)
    rank = max(1, int(np.max(np.sum(s > 1e-9 * s[:, :1], axis=-1), initial=0)))
    s = s[:, :rank]
    return np.asarray(inner[int(np.argmax(s[:, -1] / s[:, 0]))])


def run(
    robot: Robot,
    *,
    frame: str | int | Frame | None = None,
    q0: ArrayLike | None = None,
    radius: float = 0.05,
    period: float = 10.0,
    plane: str | None = None,
    turns: int = 2,
    methods: Sequence[str] = METHODS,
    steps: Sequence[float] = STEPS,
    gains: Sequence[float] = GAINS,
    feedback: str = "stage",
    startup: str = "paper",
    task: str | Sequence[int] = "pose",
    unreachable: str = "raise",
    rtol: float = 1e-9,
) -> IntegratorStudy:
    """Follow a circle with every method, step and gain.

    Parameters
    ----------
    frame : optional
        The last frame if not given.
    q0 : array_like, shape (nq,), optional
        Without it, a well conditioned configuration is looked for.
    radius, period : float
        Of the circle [m], [s].
    plane : "yz", "zx" or "xy", optional
        Without it, the first of these in which the robot can move the frame.
    turns : int
    methods, steps, gains : sequences
        Names, dt [s], K [1/s].
    feedback, startup, task, unreachable, rtol
        As of `dualpin.track`.

    Returns
    -------
    IntegratorStudy
        A list of `Row`, with ``.settings``, ``.title`` and ``.plot()``.

    Raises
    ------
    ArgumentError
        Also where the circle cannot be reached.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.tracking.study import run
    >>> rows = run(dp.load("ur5"), frame="tool0", steps=[0.1], gains=[0.0], turns=1)
    >>> [r.method for r in sorted(rows, key=lambda r: r.position_peak)]
    ['rk4', 'abm4', 'trapezoidal', 'euler']
    """
    turns = count("study: turns", turns, 1)
    goal = robot.frame(-1 if frame is None else frame)
    components = rows_of("study", task)
    start = (
        comfortable(robot, goal, rows=components) if q0 is None else as_array(robot, "study", configuration("q0"), q0)
    )
    chosen = plane if plane is not None else plane_of(robot, goal, start)
    path = Circle(radius, period, chosen, start=start)
    name = task if isinstance(task, str) else "".join("01"[i in components] for i in range(6))
    rows = []
    options: dict[str, Any] = {
        "frame": goal, "feedback": feedback, "startup": startup, "task": task, "unreachable": unreachable, "rtol": rtol,
    }  # fmt: skip
    for method in methods:  # what is compiled at a method's first step is not counted as its time
        _followed(robot, path, method=method, dt=steps[0], t_end=steps[0], **options)
    for gain in gains:
        for dt in steps:
            for method in methods:
                found = _followed(robot, path, method=method, dt=dt, t_end=turns * period, gain=gain, **options)
                last = found.t >= (turns - 1) * period - dt / 2
                p, o = found.position_error, found.orientation_error
                peaks = _max(p), _max(o), _max(p[last]), _max(o[last])
                rows.append(
                    Row(robot.name, goal.name, found.method.name, dt, gain, feedback, turns, name, chosen,
                        *peaks,
                        found.cost.evaluations, found.cost.seconds, found.warnings)
                )  # fmt: skip
    settings = {
        "robot": robot.name, "frame": goal.name, "radius": radius, "period": period, "plane": chosen, "turns": turns,
        "task": name, "start": [float(x) for x in start], "feedback": feedback, "startup": startup, "rtol": rtol,
    }  # fmt: skip
    return IntegratorStudy(rows, settings)


def _followed(robot: Robot, path: Circle, **options: Any) -> TrackingResult:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)  # they are in the rows
        return track(robot, path, **options)


def plane_of(robot: Robot, frame: Frame, q: np.ndarray) -> str:
    """The first of yz, zx, xy in both directions of which the frame can move from q; yz if there is none."""
    J = jacobian(robot, q, frame, "local_world_aligned")[3:]
    U, s, _ = np.linalg.svd(J, full_matrices=False)
    reachable = U[:, s > 1e-9 * s.max(initial=0.0)]
    left = np.linalg.norm(np.eye(3) - reachable @ reachable.T, axis=0)
    return next((p for p in ("yz", "zx", "xy") if all(left["xyz".index(c)] < 1e-6 for c in p)), "yz")


def remarks(rows: Sequence[Row]) -> list[str]:
    """What is to be said about a study: one sentence a kind, and why all errors are the same where they are.

    Examples
    --------
    >>> from dualpin.tracking.study import remarks
    >>> remarks([])
    []
    """
    kinds: dict[str, list[str]] = {}
    for text in (note for row in rows for note in row.warnings):
        kinds.setdefault(kind_of(text), []).append(text)
    said = []
    for texts in kinds.values():
        more = f" (and in {len(texts) - 1} more of {len(rows)} runs)" if len(texts) > 1 else ""
        said.append(texts[0] + more)
    for gain in dict.fromkeys(r.gain for r in rows):
        errors = [max(r.position_peak, r.orientation_peak) for r in rows if r.gain == gain]
        if len(errors) > 1 and SAME_ERROR < max(errors) < np.inf and max(errors) - min(errors) < 0.01 * max(errors):
            why = "the robot or its task" if kinds.keys() & {"rank", "unreachable", "singular"} else "the trajectory"
            said.append(f"same error: {len(errors)} runs with K = {gain:g} err by {max(errors):.3g} alike, which is "
                        f"due to {why} and not to the integrators")  # fmt: skip
    return said


SAME_ERROR = 1e-6  # m or rad: smaller ones that agree are rounding
KINDS = ("unreachable", "unstable", "limits", "rank", "singular", "not finite")


def kind_of(text: str) -> str:
    """The kind of a remark of `dualpin.track`: the words before its colon."""
    kind = text.partition(":")[0]
    return kind if kind in KINDS else text


def _max(x: np.ndarray) -> float:
    return float(x.max()) if np.isfinite(x).all() else float("inf")


def table(rows: Sequence[Row]) -> str:
    """The rows as a Markdown table: peak position error / peak orientation error by method.

    Examples
    --------
    >>> from dualpin.tracking.study import table
    >>> table([])
    ''
    """
    if not rows:
        return ""
    methods = list(dict.fromkeys(r.method for r in rows))
    lines = [f"| loop | dt [s] | {' | '.join(methods)} |", f"|---|---|{'---|' * len(methods)}"]
    for key in dict.fromkeys((r.gain, r.feedback, r.dt) for r in rows):
        gain, feedback, dt = key
        same = [r for r in rows if (r.gain, r.feedback, r.dt) == key]
        cells = {r.method: f"{r.position_peak:.1e} / {r.orientation_peak:.1e}{_mark(r)}" for r in same}
        loop = f"K = {gain:g} ({feedback})" if gain else "open"
        lines.append(f"| {loop} | {dt:g} | {' | '.join(cells.get(m, '') for m in methods)} |")
    return "\n".join(lines)


def _mark(row: Row) -> str:
    return " UNSTABLE" if any(kind_of(w) in ("unstable", "not finite") for w in row.warnings) else ""


def measured_stability_limit(
    robot: Robot, q0: ArrayLike, frame: str | int | Frame | None, method: str, rounds: int = 11
) -> float:
    """The largest K dt for which a small error of the robot at rest dies out, by bisection between 0 and 4.

    The frame is asked to stay where it is; the arm starts off by 1e-7 rad, and grows or shrinks
    the error over 300 steps.

    Examples
    --------
    >>> import numpy as np
    >>> from dualpin.tracking.study import measured_stability_limit, pa10
    >>> q0 = np.radians([0, 30, 0, 60, 0, 60, 0])
    >>> abs(measured_stability_limit(pa10(), q0, None, "euler") - 2.0) < 0.02
    True
    """
    start = np.asarray(q0, dtype=float)
    rest, off, dt = Circle(0.0, 1.0, start=start), start + 1e-7 * np.cos(np.arange(len(start))), 0.1
    low, high = 0.0, 4.0
    for _ in range(rounds):
        z = (low + high) / 2
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DualpinWarning)
            found = track(robot, rest, off, frame=frame, method=method, dt=dt, t_end=30.0, gain=z / dt)
        e = found.position_error + found.orientation_error
        late, before = e[-50:].max(), e[100:150].max()
        # shrinking, or dead down to rounding; and not saturated far from where it started
        stable = np.isfinite(e).all() and late < max(before, 1e-13) and late < 1e-5
        low, high = (z, high) if stable else (low, z)
    return (low + high) / 2
