"""Figures of docs/gallery.md:  python docs/gallery.py"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import dualpin as dp

FIGURES = Path(__file__).parent / "figures"
mpl.rcParams.update({"font.size": 9, "svg.hashsalt": "dualpin"})


def cylindroid() -> plt.Figure:
    """The ruled surface of all sums of two screws."""
    a, b = dp.algebra.Motor([0, 0, 1.0], [0, 0, 0.6]), dp.algebra.Motor([0, 1.0, 0.2], [0.4, 0.1, 1.0])
    c = dp.algebra.cylindroid(a, b)
    phi = np.linspace(0, np.pi, 121)
    s = c.screw(phi)
    t = np.linspace(-1, 1, 2)
    lines = (c.center + c.height(phi)[:, None] * c.nodal.real)[:, None] + t[:, None] * s.direction[:, None]
    fig = plt.figure(figsize=(5, 4.2))
    ax = fig.add_subplot(projection="3d")
    colours = mpl.colormaps["viridis"]((s.pitch - s.pitch.min()) / np.ptp(s.pitch))
    ax.plot_surface(*np.moveaxis(lines, -1, 0), facecolors=np.repeat(colours[:, None], 2, 1), alpha=0.85, linewidth=0)
    for p, name in zip(c.principal, c.pitches, strict=True):
        ends = c.center + np.array([[-1.2], [1.2]]) * p.direction
        ax.plot(*ends.T, color="black", lw=1.5)
        ax.text(*ends[1], f"pitch {name:.2f}")
    ax.set(xlabel="x", ylabel="y", zlabel="z", title="cylindroid, coloured by pitch")
    return fig


def rccc() -> plt.Figure:
    """Output angles and slides of the RCCC linkage, both branches."""
    linkage = dp.mechanisms.RCCC(dp.Dual(np.radians([30, 55, 45, 60]), [2.0, 4, 3, 5]))
    degrees = np.arange(361.0)
    both = linkage.sweep(np.radians(degrees))
    fig, axes = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
    for branch, style in ((0, "-"), (1, "--")):
        for k in range(3):
            axes[0].plot(degrees, np.degrees(np.unwrap(both.real[:, branch, k])), style, color=f"C{k}")
            axes[1].plot(
                degrees, both.dual[:, branch, k], style, color=f"C{k}", label=f"joint {k + 2}" if not branch else None
            )
    axes[0].set(xlabel="input angle [deg]", ylabel="angle [deg]", xticks=range(0, 361, 90))
    axes[1].set(xlabel="input angle [deg]", ylabel="slide [m]", xticks=range(0, 361, 90))
    axes[1].legend()
    return fig


def screw_axes() -> plt.Figure:
    """Instantaneous screw axes of a robot's tool along a motion."""
    robot = dp.load("ur5")
    q0, q1 = np.array([0.0, -1.2, 1.4, -0.4, -1.5, 0.0]), np.array([1.2, -0.8, 0.9, 0.4, -1.0, 0.8])
    s = np.linspace(0, 1, 25)[:, None]
    q, v = q0 + (q1 - q0) * s**2 * (3 - 2 * s), (q1 - q0) * 6 * s * (1 - s) + 1e-3
    tool = dp.fk(robot, q, "tool0")[:, :3, 3]
    m = dp.mechanisms.instantaneous_screw(robot, q, v, "tool0")
    fig = plt.figure(figsize=(5, 4.2))
    ax = fig.add_subplot(projection="3d")
    ax.plot(*tool.T, color="black", lw=2, label="tool")
    for i in range(len(q)):
        near = m.point[i] + ((tool[i] - m.point[i]) @ m.direction[i]) * m.direction[i]
        ends = near + np.array([[-0.25], [0.25]]) * m.direction[i]
        ax.plot(*ends.T, color=mpl.colormaps["plasma"](i / len(q)), lw=1)
    ax.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title="instantaneous screw axes of the tool")
    ax.legend()
    return fig


def main() -> None:
    FIGURES.mkdir(exist_ok=True)
    for f in (cylindroid, rccc, screw_axes):
        f().savefig(FIGURES / f"{f.__name__}.svg", metadata={"Date": None})
        plt.close("all")


if __name__ == "__main__":
    main()
