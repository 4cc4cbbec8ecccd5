"""Pictures of workspaces, by matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..identification.plots import figure, finished
from .reach import ReachMap

FEW = 0.01
"""Share of the cells that may lie off either end of a scale of colours."""


def slices(reach: ReachMap, path: Any = None, **more: np.ndarray) -> Any:
    """Slices through the middle of the cells that were reached: from above, from the side, from the front.

    Parameters
    ----------
    path : str or path, optional
        Where to write it: .png, .svg, .pdf.
    **more : ndarray, shape (nx, ny, nz)
        Surveys of the same grid, by name.

    Returns
    -------
    matplotlib.figure.Figure
    """
    shown = {"reachability index": np.where(reach.counts > 0, reach.index, np.nan), **more}
    fig, axes = figure(len(shown), 3, width=10.0, height=3.0)
    middle = middles(reach)
    for row, (name, values) in zip(axes, shown.items(), strict=True):
        low, high = ends(values)
        for ax, across in zip(row, (2, 1, 0), strict=True):
            a, b = (k for k in range(3) if k != across)
            extent = [
                c + s * reach.cell / 2 for k in (a, b) for c, s in zip(reach.centres(k)[[0, -1]], (-1, 1), strict=True)
            ]
            cut = np.take(values, middle[across], axis=across).T
            image = ax.imshow(
                cut, origin="lower", extent=extent, vmin=low, vmax=high, cmap="viridis", interpolation="nearest"
            )
            ax.set_xlabel(f"{'xyz'[a]} [m]", fontsize=7)
            ax.set_ylabel(f"{'xyz'[b]} [m]", fontsize=7)
            ax.set_title(f"{name}, {'xyz'[across]} = {reach.centres(across)[middle[across]]:.2f} m", fontsize=7)
            ax.tick_params(labelsize=6)
        fig.colorbar(image, ax=row, shrink=0.8).ax.tick_params(labelsize=6)
    return finished(fig, path)


def ends(values: np.ndarray) -> tuple[float, float]:
    """What a scale of colours goes from and to: few extreme cells do not take it."""
    finite = values[np.isfinite(values)]
    return (float(np.quantile(finite, FEW)), float(np.quantile(finite, 1 - FEW))) if finite.size else (0.0, 1.0)


def middles(reach: ReachMap) -> list[int]:
    """The cell along each axis where most was reached, all cells across it counted."""
    index = reach.index
    return [int(np.argmax(index.sum(axis=tuple(k for k in range(3) if k != across)))) for across in range(3)]
