"""Figures and tables of docs/dh.md, from the robots themselves.

python docs/figures/dh.py          writes dh-frames.svg and dh-near-parallel.svg beside this file
python docs/figures/dh.py tables   prints the tables of the page
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np

import dualpin as dp

plt.switch_backend("Agg")
mpl.rcParams.update({"svg.hashsalt": "dualpin", "svg.fonttype": "none", "font.size": 9, "axes.grid": True})

HERE = Path(__file__).parent
POSED = np.array([0.0, -0.5, 0.0, -1.9, 0.0, 1.7, 0.0, 0.0, 0.0])  # of the Panda: all axes stay visible
H = np.pi / 2


def tilted(theta: float, d: float, a: float, alpha: float, beta: float) -> list[tuple[float, float, float, float]]:
    """A row and a fixed one: X(alpha, a) Ry(beta) after Z(theta, d)."""
    return [(theta, d, a, alpha - H), (beta, 0.0, 0.0, H)]


def calibrated() -> dp.Robot:
    """A UR5 as a factory calibration may have it: its parallel axes 2, 3, 4 tilted by less than 0.05 degrees."""
    rows = [
        (1e-4, 0.0893, 0.0001, H + 2e-4),
        *tilted(-2e-4, 0.0, -0.42485, 1.9e-4, 7.2e-4),
        *tilted(3e-4, 0.0, -0.3922, -2.6e-4, -6.4e-4),
        (-1e-4, 0.10921, 0.00004, H - 1e-4),
        (2e-4, 0.0947, -0.00003, -H + 3e-4),
        (0.0, 0.0824, 0.0, 0.0),
    ]
    return dp.from_dh(rows, "RRFRFRRR", "standard", name="calibrated_ur5")


def tables() -> dict[str, str]:
    """Every table of the page, as Markdown."""

    def of(name: str, base: str, tip: str, convention: str) -> str:
        return dp.to_dh(dp.load(name), base, tip, convention).export("markdown", digits=6)

    arm = calibrated()
    return {
        "ur5": of("ur5", "base", "tool0", "standard"),
        "panda": of("panda", "panda_link0", "panda_link8", "modified"),
        "xarm7": of("xarm7", "link_base", "link_eef", "standard"),
        "pure": dp.to_dh(arm, near_parallel=0.0).export("markdown", digits=6),
        "fixed": dp.to_dh(arm).export("markdown", digits=6),
    }


def _frame(axes: Any, T: np.ndarray, label: str, size: float) -> None:
    o = T[:3, 3]
    for column, colour in ((0, "tab:red"), (2, "tab:blue")):
        axes.quiver(*o, *(size * T[:3, column]), color=colour, linewidth=1.6, arrow_length_ratio=0.25)
    if label:
        axes.text(*(o + 0.12 * size + 1.15 * size * T[:3, 2]), label, fontsize=8)


def frames() -> plt.Figure:
    """The Panda with its joint axes, and the frames that each convention puts on it."""
    robot = dp.load("panda")
    links = [f"panda_link{i}" for i in range(9)]
    path = np.array([dp.fk(robot, POSED, link)[:3, 3] for link in links])
    figure = plt.figure(figsize=(9.5, 5.2))
    for k, convention in enumerate(("standard", "modified")):
        axes = figure.add_subplot(1, 2, k + 1, projection="3d")
        axes.plot(*path.T, color="0.75", linewidth=6, solid_capstyle="round", zorder=0)
        for joint in robot.joints[:7]:
            T = dp.fk(robot, POSED, joint.name)
            p, z = T[:3, 3], T[:3, :3] @ np.array([float(x) for x in joint.model.axis])
            axes.plot(*np.array([p - 0.12 * z, p + 0.12 * z]).T, color="0.4", linestyle=":", linewidth=1)
        dh = dp.to_dh(robot, "panda_link0", "panda_link8", convention)
        _frame(axes, dh.base.matrix, "0", 0.09)
        q = POSED[:7]
        for i in range(1, 8):
            name = f"frame_{i}" if convention == "standard" else f"link_{i}"
            _frame(axes, dp.fk(dh.robot, q, name), str(i), 0.09)
        axes.set(title=convention, xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        axes.set_yticks([0.0])
        axes.set_aspect("equal")
        axes.view_init(elev=18, azim=-68)
    figure.suptitle("Panda: frames 0 ... 7 of both conventions (x red, z blue), joint axes dotted")
    figure.tight_layout()
    return figure


def near_parallel() -> plt.Figure:
    """What a small tilt between two axes does to d, and to forward kinematics."""
    tilts = np.logspace(-14, -0.7, 55)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (20, 3))
    found: dict[str, list[tuple[float, float]]] = {"pure rows": [], "with a fixed row below 0.02": []}
    for tilt in tilts:
        rows = [*tilted(0.2, 0.1, 0.4, 0.0, tilt), (-0.4, 0.15, 0.3, 1.2), (0.1, 0.2, 0.1, -0.9)]
        arm = dp.from_dh(rows, "RFRR")
        T = dp.fk(arm, q, "tool", engine="numpy")
        for name, near in zip(found, (0.0, 0.02), strict=True):
            dh = dp.to_dh(arm, near_parallel=near)
            error = np.abs(dh.fk(q, engine="numpy") - T).max()
            found[name].append((np.abs(dh.columns[:, 1]).max(), max(error, 1e-17)))
    figure, panels = plt.subplots(1, 2, figsize=(9.5, 3.4))
    for name, values in found.items():
        for panel, column in zip(panels, np.array(values).T, strict=True):
            panel.loglog(tilts, column, label=name)
    panels[0].set(xlabel="angle between two axes [rad]", ylabel="largest abs(d) [m]")
    panels[1].set(xlabel="angle between two axes [rad]", ylabel="error of forward kinematics")
    panels[0].legend()
    figure.tight_layout()
    return figure


def main() -> None:
    if sys.argv[1:] == ["tables"]:
        for name, table in tables().items():
            print(f"{name}\n{table}\n")
        return
    for name, figure in (("dh-frames", frames()), ("dh-near-parallel", near_parallel())):
        figure.savefig(HERE / f"{name}.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
