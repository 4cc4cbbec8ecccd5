"""The papers' figures, computed from their equations and drawn in our own way: SVG files in figures/."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np

import dualpin as dp
from dualpin import Dual

mpl.use("Agg")
from matplotlib import pyplot as plt

from .common import FIGURES

BLUE, ORANGE, GREEN, RED, GREY = "#2a6f97", "#d9822b", "#4f9d69", "#b5443c", "#8a8f98"
AXES = (RED, GREEN, BLUE)  # x, y, z
mpl.rcParams.update({
    "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": GREY,
    "lines.linewidth": 1.4, "svg.fonttype": "path", "svg.hashsalt": "dualpin", "figure.constrained_layout.use": True,
})  # fmt: skip


def save(figure: Any, name: str) -> None:
    FIGURES.mkdir(exist_ok=True)
    path = FIGURES / name
    figure.savefig(path, metadata={"Date": None, "Creator": "dualpin"})
    plt.close(figure)
    path.write_text("\n".join(line.rstrip() for line in path.read_text().splitlines()) + "\n")


def space(figure: Any, place: Any, points: np.ndarray, elevation: float = 22, azimuth: float = -58) -> Any:
    """A picture in three dimensions, the same length along all axes."""
    ax = figure.add_subplot(place, projection="3d")
    lower, upper = points.min(axis=0), points.max(axis=0)
    middle, half = (lower + upper) / 2, max(upper - lower) / 2 * 1.02
    for set_, m in zip((ax.set_xlim, ax.set_ylim, ax.set_zlim), middle, strict=True):
        set_(m - half, m + half)
    ax.set_box_aspect((1, 1, 1), zoom=1.35)
    ax.view_init(elevation, azimuth)
    ax.set_axis_off()
    return ax


def frame(ax: Any, T: np.ndarray, size: float, label: str = "") -> None:
    for axis, color in zip(T[:3, :3].T, AXES, strict=True):
        ax.plot(*np.stack([T[:3, 3], T[:3, 3] + size * axis], axis=-1), color=color, linewidth=1.2)
    if label:
        ax.text(*(T[:3, 3] - 0.25 * size * T[:3, :3].sum(axis=1)), label, fontsize=8, color="#30343a")


# --- the 2C arm -------------------------------------------------------------------------------------


def tapia_herrera() -> None:
    arm = dp.mechanisms.TwoC(100.5, 70.0)
    q = np.array([np.radians(30), 60.0, np.radians(40), 50.0])
    first, tip = dp.fk(arm.robot, q, "link1_end"), dp.fk(arm.robot, q, "tip")
    foot = np.array([0, 0, q[1]])
    elbow = first[:3, 3] + q[3] * first[:3, 2]
    path = np.array([[0, 0, 0], foot, first[:3, 3], elbow, tip[:3, 3]])
    figure = plt.figure(figsize=(5.2, 4.4))
    ax = space(figure, 111, np.vstack([path, path - np.array([40, 40, 20]), path + np.array([30, 30, 40])]))
    ax.plot([0, 0], [0, 0], [-30, 150], "--", color=GREY, linewidth=0.8)
    second = first[:3, 3] + np.outer([-40, 120], first[:3, 2])
    ax.plot(*second.T, "--", color=GREY, linewidth=0.8)
    ax.plot(*path.T, color="#30343a", linewidth=2.6, solid_capstyle="round")
    for T, name in ((np.eye(4), "0"), (first, "1"), (tip, "2")):
        frame(ax, T, 32, name)
    for (a, b), text in zip(pairwise(path), ("d1", "l1", "d2", "l2"), strict=True):
        ax.text(*((a + b) / 2 + [4, 4, 4]), text, fontsize=9)
    save(figure, "two_c_arm.svg")

    figure = plt.figure(figsize=(8.0, 5.2))
    rng = np.random.default_rng(0)
    at = q.copy()
    for place, name in enumerate(("RR", "PR", "RP", "PP", "CR", "CC"), 1):
        t = arm.topology(name, at)
        n = 36
        scale = {0: (-np.pi, np.pi), 1: (0, 120), 2: (-np.pi, np.pi), 3: (0, 120)}
        if len(t.free) == 2:
            grid = np.stack(np.meshgrid(*(np.linspace(*scale[i], n) for i in t.free), indexing="ij"), axis=-1)
            points = t.fk(grid, "tip")[..., :3, 3]
        else:
            points = t.fk(np.stack([rng.uniform(*scale[i], 700) for i in t.free], axis=-1), "tip")[..., :3, 3]
        ax = space(figure, 230 + place, np.vstack([points.reshape(-1, 3), [[0, 0, 0]]]))
        if points.ndim == 3:
            ax.plot_wireframe(*np.moveaxis(points, -1, 0), color=BLUE, linewidth=0.35, rstride=2, cstride=2)
        else:
            ax.scatter(*points.T, s=1.2, color=BLUE, linewidths=0)
        ax.plot(*path.T, color="#30343a", linewidth=1.6)
        ax.set_title(name, fontsize=10, y=0.96)
    save(figure, "two_c_workspace.svg")


# --- progressive dynamics ---------------------------------------------------------------------------


def laus() -> None:
    """The payload swings on its passive joint while the arm is held: three equations, two accelerations given."""
    from .laus import A, L, link, planar_arm

    robot = planar_arm(2).attach(link(2), passive=True)
    held = np.array([0.9, -1.2])

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        q, v = np.array([*held, y[..., 0].item()]), np.array([0, 0, y[..., 1].item()])
        M, h = dp.crba(robot, q), dp.bias(robot, q, v)
        return np.array([v[2], -h[2] / M[2, 2]]).reshape(y.shape)

    start = np.radians(70)
    run = dp.integrators.solve(rate, [start, 0.0], method="rk4", dt=0.005, t_end=3.0)
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.4), width_ratios=(1.05, 1))
    phi = np.cumsum(held)
    joints = np.array([[0, 0], *np.cumsum(np.stack([A * np.cos(phi), A * np.sin(phi)], axis=-1), axis=0)])
    left.plot(*joints.T, "-o", color="#30343a", linewidth=4, markersize=6, solid_capstyle="round")
    for k, i in enumerate(range(0, 181, 18)):
        end = joints[-1] + 2 * L[2] * np.array([np.cos(phi[1] + run.y[i, 0]), np.sin(phi[1] + run.y[i, 0])])
        left.plot(*np.stack([joints[-1], end], axis=-1), "-", color=ORANGE, alpha=1 - 0.07 * k, linewidth=2.2)
    left.set_aspect("equal")
    left.set(xlabel="x in m", ylabel="y in m", xlim=(-0.15, 1.05), ylim=(-0.2, 0.75))
    left.annotate(
        "g", (0.02, 0.35), (0.02, 0.55), arrowprops={"arrowstyle": "->", "color": GREY}, ha="center", color=GREY
    )
    right.plot(run.t, np.degrees(run.y[:, 0] + phi[1]), color=ORANGE)
    right.axhline(-90, color=GREY, linewidth=0.7, linestyle="--")
    right.set(xlabel="t in s", ylabel="payload's angle to the horizontal, degrees")
    save(figure, "swing.svg")


# --- dual linear algebra ----------------------------------------------------------------------------


def pennestri() -> None:
    from .pennestri_linkage import INPUT, LINKAGE

    degrees = np.linspace(0, 360, 361)
    both = LINKAGE.sweep(np.radians(degrees))
    figure, axes = plt.subplots(2, 1, figsize=(6.6, 4.6), sharex=True)
    for joint, color in zip(range(3), (BLUE, ORANGE, GREEN), strict=True):
        for branch, style in ((1, "-"), (0, "--")):
            angle = np.degrees(np.unwrap(both.real[:, branch, joint]))
            angle -= 360 * np.round(angle.mean() / 360)
            axes[0].plot(degrees, angle, style, color=color, label=f"theta{joint + 2}" if branch else None)
            axes[1].plot(degrees, both.dual[:, branch, joint], style, color=color)
    p = LINKAGE.solve(INPUT)[1]
    for t, color in zip((p.theta2, p.theta3, p.theta4), (BLUE, ORANGE, GREEN), strict=True):
        axes[0].plot(40, np.degrees(float(t.real)), "o", color=color, markersize=4)
        axes[1].plot(40, float(t.dual), "o", color=color, markersize=4)
    axes[0].set_ylabel("angles, degrees")
    axes[0].legend(frameon=False, ncols=3, fontsize=8)
    axes[1].set(xlabel="theta1, degrees", ylabel="slides", xticks=range(0, 361, 60))
    save(figure, "rccc.svg")

    a, b = Dual(np.array([0.0, 0, 1]), np.zeros(3)), Dual(np.array([0.0, 1, 0]), np.array([0.0, 0, 1]))
    figure = plt.figure(figsize=(5.0, 4.2))
    angles = np.linspace(0, np.pi, 61)
    sums = [dp.algebra.motor_sum(a * np.cos(t), b * np.sin(t)) for t in angles[1:-1]]
    ends = []
    for m in sums:
        u = m.axis
        ends.append(np.stack([u.point - 1.2 * u.real, u.point + 1.2 * u.real]))
    points = np.array(ends)
    ax = space(figure, 111, np.vstack([points.reshape(-1, 3)]), 18, 35)
    for e, m in zip(points, sums, strict=True):
        ax.plot(*e.T, color=plt.get_cmap("viridis")(0.5 + float(m.pitch)), linewidth=0.8)
    for line, text in ((dp.algebra.line([0, 0, 0], [0, 0, 1]), "A1"), (dp.algebra.line([1.0, 0, 0], [0, 1, 0]), "A2")):
        ends_ = np.stack([line.point - 1.3 * line.real, line.point + 1.3 * line.real])
        ax.plot(*ends_.T, color="#30343a", linewidth=2.2)
        ax.text(*(ends_[1] * 1.02), text)
    save(figure, "cylindroid.svg")


# --- dual quaternions and the PUMA ------------------------------------------------------------------


def gouasmi() -> None:
    from .gouasmi import puma

    X, Y = dp.spatial.exp([np.pi / 2, 0, 0, 1, 0, 0]), dp.spatial.exp([0, np.pi / 2, 0, 0, 1, 0])
    whole = dp.spatial.compose(X, Y)
    s = dp.spatial.screw_parameters(whole)
    twist = dp.spatial.log(whole)
    corners = np.array([[x, y, z] for x in (0.15, 0.55) for y in (0.1, 0.4) for z in (-0.6, -0.4)])
    edges = [(i, j) for i in range(8) for j in range(i) if abs(corners[i] - corners[j]).astype(bool).sum() == 1]
    shares = np.linspace(0, 1, 7)
    boxes = dp.spatial.transform_points(dp.spatial.exp(shares[:, None] * twist), corners)
    curve = dp.spatial.transform_points(dp.spatial.exp(np.linspace(0, 1, 80)[:, None] * twist), corners[:1])[:, 0]
    axis = s.point + np.outer([-0.9, 1.6], s.axis)
    figure = plt.figure(figsize=(5.4, 4.6))
    ax = space(figure, 111, np.vstack([boxes.reshape(-1, 3), axis]), 16, -70)
    ax.plot(*axis.T, "--", color=RED, linewidth=1.2)
    for k, box in enumerate(boxes):
        strong = k in (0, len(boxes) - 1)
        for i, j in edges:
            ax.plot(*box[[i, j]].T, color=BLUE if strong else GREY, linewidth=1.6 if strong else 0.5)
    ax.plot(*curve.T, color=ORANGE)
    ax.scatter(*s.point[:, None], color=RED, s=14)
    ax.text(*(s.point + np.array([0.05, -0.1, -0.1])), "(1/3, -1/3, 0)", fontsize=8)
    frame(ax, np.eye(4), 0.35, "O")
    save(figure, "screw_motion.svg")

    robot = puma()
    q = np.zeros(6)
    T = [np.eye(4), *(dp.fk(robot, q, f"frame_{i}") for i in range(1, 7))]
    # the arm's outline, by its joints' axes and offsets
    points = np.array([t[:3, 3] for t in T])
    figure = plt.figure(figsize=(5.6, 4.8))
    ax = space(figure, 111, np.vstack([points, points + 0.2, points - 0.2]), 20, -60)
    for i in range(6):
        z, o = T[i][:3, 2], T[i][:3, 3]
        ax.plot(*(o + np.outer([-0.18, 0.22], z)).T, ":", color=GREY, linewidth=1.2)
    ax.plot(*points.T, "-o", color="#30343a", linewidth=2.4, markersize=3.5)
    done: list[np.ndarray] = []
    for i, t in enumerate(T):
        crowd = sum(np.linalg.norm(t[:3, 3] - p) < 1e-9 for p in done)
        frame(ax, t, 0.12 - 0.025 * crowd)
        ax.text(*(t[:3, 3] + [0.015, -0.03, 0.03 + 0.05 * crowd]), str(i), fontsize=9)
        done.append(t[:3, 3])
    save(figure, "puma_frames.svg")


# --- integrators ------------------------------------------------------------------------------------


def sariyildiz() -> None:
    from .sariyildiz import NAMES, clock, model, tracked

    colors = dict(zip(NAMES, (RED, ORANGE, GREEN, BLUE), strict=True))
    figure, axes = plt.subplots(2, 2, figsize=(7.6, 4.8), sharex=True, sharey="row")
    for column, dt in enumerate((0.1, 0.01)):
        for m in NAMES:
            run = tracked("A", m, dt)
            every = slice(1, None, max(1, round(0.1 / dt)))
            for row, error in enumerate((run.position_error, run.orientation_error)):
                axes[row, column].semilogy(run.t[every], error[every], color=colors[m], label=NAMES[m], linewidth=1.0)
        axes[0, column].set_title(f"{dt * 1000:g} ms", fontsize=9)
        axes[1, column].set_xlabel("t in s")
    axes[0, 0].set_ylabel("position error, m")
    axes[1, 0].set_ylabel("orientation error, rad")
    axes[0, 0].set_ylim(1e-16, 1)
    axes[1, 0].legend(frameon=False, fontsize=8, ncols=2)
    save(figure, "pa10_errors.svg")

    figure, axes = plt.subplots(1, 2, figsize=(7.6, 3.0), sharex=True)
    for m in NAMES:
        run = tracked("A", m, 1.0)
        for ax, error in zip(axes, (run.position_error, run.orientation_error), strict=True):
            ax.semilogy(run.t[1:], error[1:], color=colors[m], label=NAMES[m])
    euler = tracked("A", "euler", 1.0)
    beyond = ((euler.q > model().upper) | (euler.q < model().lower)).any(axis=-1)
    for ax in axes:
        for t in euler.t[beyond]:
            ax.axvspan(t - 0.5, t + 0.5, color=RED, alpha=0.13, linewidth=0)
        ax.set(xlabel="t in s", ylim=(1e-7, 30))
    axes[0].set_ylabel("position error, m")
    axes[1].set_ylabel("orientation error, rad")
    axes[1].legend(frameon=False, fontsize=8, ncols=2, loc="lower right")
    axes[0].text(0.98, 0.02, "shaded: Euler's joints outside of their limits", transform=axes[0].transAxes, fontsize=7,
                 color=RED, ha="right")  # fmt: skip
    save(figure, "pa10_errors_1s.svg")

    found = clock()
    figure, axes = plt.subplots(1, 3, figsize=(7.6, 2.5))
    for ax, (k, title) in zip(axes, enumerate(("pseudo-inverses a step", "compiled, s", "NumPy, s")), strict=True):
        ax.bar([NAMES[m] for m in NAMES], [found[m][k] for m in NAMES], color=[colors[m] for m in NAMES], width=0.6)
        ax.set_title(title, fontsize=9)
        ax.tick_params(axis="x", labelsize=7)
    save(figure, "pa10_times.svg")


DRAWINGS: dict[str, Callable[[], None]] = {f.__name__: f for f in (tapia_herrera, laus, pennestri, gouasmi, sariyildiz)}


def draw(name: str) -> None:
    """The figures of one paper."""
    DRAWINGS[name]()


def committed() -> list[Path]:
    """All figures that the pages show."""
    return [
        FIGURES / f for name in DRAWINGS for f in importlib.import_module(f"validation.papers.{name}").page().figures
    ]
