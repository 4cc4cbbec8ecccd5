"""The figures of the study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dualpin.files import replacing


def draw(results: dict[str, Any], where: Path) -> None:
    """work.svg, drift.svg, energy.svg."""
    import matplotlib as mpl

    mpl.use("Agg")
    mpl.rcParams.update({"svg.hashsalt": "dualpin", "svg.fonttype": "none", "font.size": 9, "axes.grid": True,
                         "grid.alpha": 0.3, "axes.spines.top": False, "axes.spines.right": False})  # fmt: skip
    for name, figure in (("work", _work), ("drift", _drift), ("energy", _energy)):
        fig = figure(results)
        with replacing(where / f"{name}.svg") as beside:
            fig.savefig(beside, format="svg", metadata={"Date": None}, bbox_inches="tight")


def _axes(n: int, **shared: Any) -> Any:
    import matplotlib.pyplot as plt

    return plt.subplots(1, n, figsize=(4.4 * n, 3.4), layout="constrained", **shared)


def _work(results: dict[str, Any]) -> Any:
    fig, axes = _axes(2, sharey=True)
    rows = results["work_precision"]
    for method in dict.fromkeys(r["method"] for r in rows):
        mine = [r for r in rows if r["method"] == method]
        for ax, x in zip(axes, ("evaluations", "seconds"), strict=True):
            style = "--" if method in ("rk45", "DOP853", "LSODA") else "-"
            ax.loglog([r[x] for r in mine], [r["position_peak"] for r in mine], style, marker=".", label=method)
    axes[0].set(xlabel="evaluations of the joint rates", ylabel="peak position error [m]")
    axes[1].set(xlabel="wall time [s]")
    axes[1].legend(fontsize=8)
    return fig


def _drift(results: dict[str, Any]) -> Any:
    fig, axes = _axes(2, sharey=True)
    for name, values in results["drift"].items():
        if isinstance(values, dict):
            method, loop = name.split()
            e = np.array(values["by_turn"])
            turns = 1 + np.arange(len(e)) * results["drift"]["turns"] / len(e)
            axes[int(loop != "K=0")].loglog(turns, e, label=method)
    for ax, title in zip(axes, ("open loop", "closed loop, K = 1/s"), strict=True):
        ax.set(xlabel="turn", title=title)
    axes[0].set(ylabel="peak position error of the turn [m]")
    axes[1].legend(fontsize=8)
    return fig


def _energy(results: dict[str, Any]) -> Any:
    fig, ax = _axes(1)
    for name, values in results["energy"].items():
        if isinstance(values, dict):
            e = np.array(values["by_time"], dtype=float)  # null: not finite
            t = (1 + np.arange(len(e))) / len(e) * values["steps"] * results["energy"]["dt"]
            ax.loglog(t, e, label=name)
    ax.set(
        xlabel="time [s]", ylabel="|E - E(0)| [J], largest in the interval", title="free double pendulum, dt = 0.02 s"
    )
    ax.legend(fontsize=8)
    return fig
