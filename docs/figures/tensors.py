"""The figure of docs/check.md: principal moments of all links of example-robot-data.

python docs/figures/tensors.py     writes tensors.svg beside this file
"""

from __future__ import annotations

import warnings
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np

from dualpin.analysis.check.description import described
from dualpin.analysis.check.tensors import LIGHT, physical
from dualpin.io.catalogue import catalogue

plt.switch_backend("Agg")
mpl.rcParams.update({"svg.hashsalt": "dualpin", "svg.fonttype": "none", "font.size": 9, "axes.grid": True})
HERE = Path(__file__).parent


def moments() -> tuple[np.ndarray, np.ndarray]:
    """(I1, I2) / I3 of every link with a tensor, a point for links of one kind; and which are possible."""
    points: dict[tuple[float, float], bool] = {}
    for path in catalogue().values():
        try:
            about = described(path)
        except Exception:  # two of the files cannot be read
            continue
        for b in about.bodies:
            low, middle, high = b.moments
            if b.mass > LIGHT and high > 0 and low > 0:
                points[round(low / high, 3), round(middle / high, 3)] = physical(b.tensor)
    return np.array(list(points)), np.array(list(points.values()))


def main() -> None:
    """Write the figure."""
    warnings.simplefilter("ignore")
    x, good = moments()
    figure, axes = plt.subplots(figsize=(6.2, 4.2))
    axes.fill([0, 0.5, 1], [1, 0.5, 1], color="0.9", zorder=0)
    axes.text(0.5, 0.87, "bodies", ha="center", color="0.35")
    axes.text(0.12, 0.42, r"$I_1 + I_2 < I_3$: no body", color="C3")
    axes.plot(*x[good].T, ".", color="C0", ms=3, alpha=0.5, label=f"{int(good.sum())} links")
    axes.plot(*x[~good].T, "x", color="C3", ms=4, label=f"{int((~good).sum())} that break the inequality")
    axes.set(xlabel=r"$I_1 / I_3$", ylabel=r"$I_2 / I_3$", xlim=(-0.01, 1.02), ylim=(-0.01, 1.02))
    axes.legend(loc="lower right")
    figure.tight_layout()
    figure.savefig(HERE / "tensors.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
