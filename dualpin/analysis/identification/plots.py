"""Pictures of identifications and exciting motions, by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...extras import extra

if TYPE_CHECKING:
    from .excitation import Excitation
    from .fit import Identification

MOST = 12
"""Joints that fit into one figure."""


def figure(rows: int, columns: int = 1, width: float = 8.0, height: float = 1.6) -> tuple[Any, np.ndarray]:
    """A figure that belongs to no window, and its axes (rows, columns)."""
    extra("matplotlib", "figures", "plots")
    from matplotlib.figure import Figure

    fig = Figure(figsize=(width, 0.6 + height * rows), layout="constrained")
    return fig, fig.subplots(rows, columns, squeeze=False)


def finished(fig: Any, path: Any) -> Any:
    """The figure, written too where there is a path; its ending says how."""
    if path is not None:
        fig.savefig(path, dpi=120)
    return fig


def residuals(found: Identification, path: Any = None) -> Any:
    """Measured and predicted torque of each joint, what is left, and three deviations of the noise.

    Parameters
    ----------
    path : str or path, optional
        Where to write it: .png, .svg, .pdf.

    Returns
    -------
    matplotlib.figure.Figure
    """
    robot = found.base.robot
    names = [(b.name, k) for b in robot for k in range(b.v.start, b.v.stop) if b.mimic is None][:MOST]
    fig, axes = figure(max(1, len(names)), 2)
    for (name, k), (left, right) in zip(names, axes, strict=False):
        left.plot(found.measured[:, k], color="0.6", lw=0.8, label="measured")
        left.plot(found.measured[:, k] - found.residuals[:, k], color="C0", lw=0.8, label="predicted")
        left.set_ylabel(name, fontsize=7)
        right.plot(found.residuals[:, k], color="C3", lw=0.6)
        right.axhspan(-3 * found.noise[k], 3 * found.noise[k], color="0.85", zorder=0)
    axes[0, 0].set_title("torque [N m, N]: measured (grey), predicted", fontsize=8)
    axes[0, 1].set_title("residual, and three deviations of the noise", fontsize=8)
    for ax in axes[-1]:
        ax.set_xlabel("sample", fontsize=8)
    for ax in axes.flat:
        ax.tick_params(labelsize=7)
    return finished(fig, path)


def excitation(found: Excitation, path: Any = None) -> Any:
    """Positions, velocities and accelerations of a period, each over its limit.

    Returns
    -------
    matplotlib.figure.Figure
    """
    robot, bounds = found.robot, found.bounds
    t = np.linspace(0, found.period, 400)
    middle, half = (bounds.upper + bounds.lower) / 2, (bounds.upper - bounds.lower) / 2
    q, v, a = found.motion.at(t)
    shown = (
        ("position over its range", (q - middle) / half),
        ("velocity over its limit", v / bounds.velocity),
        ("acceleration over its limit", a / bounds.acceleration),
    )
    fig, axes = figure(3)
    names = [b.name for b in robot if b.mimic is None for _ in range(b.model.nv)]
    for ax, (title, x) in zip(axes[:, 0], shown, strict=True):
        for name, y in list(zip(names, x.T, strict=True))[:MOST]:
            ax.plot(t, y, lw=1.0, label=name)
        ax.axhspan(-1, 1, color="0.93", zorder=0)
        ax.set_title(title, fontsize=8)
        ax.tick_params(labelsize=7)
    axes[0, 0].legend(fontsize=6, ncols=3)
    axes[-1, 0].set_xlabel("t [s]", fontsize=8)
    return finished(fig, path)
