"""Maps of the workspace as slices."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..analysis.workspace import ReachMap
from ..analysis.workspace.plots import ends, middles
from .sections import Section

STEPS = 254
"""Shades a quantity is shown in; 0 is where nothing is."""


@dataclass(frozen=True)
class Layer:
    """One quantity over the grid, in steps from `low` to `high`."""

    name: str
    low: float
    high: float
    bytes: str
    """Of (nx, ny, nz) in C order, base64."""

    @classmethod
    def of(cls, name: str, values: np.ndarray) -> Layer:
        finite = np.isfinite(values)
        low, high = ends(values)
        steps = np.zeros(values.shape, np.uint8)
        steps[finite] = 1 + np.round(np.clip((values[finite] - low) / (high - low or 1.0), 0, 1) * STEPS)
        return cls(name, low, high, base64.b64encode(steps.tobytes()).decode())


@dataclass(frozen=True)
class Voxels:
    """What the template of a workspace shows."""

    reach: ReachMap
    layers: list[Layer]
    rows: list[tuple[str, str]]

    @property
    def data(self) -> dict[str, Any]:
        """What the page's script needs, plain."""
        r = self.reach
        layers = [{"name": x.name, "low": x.low, "high": x.high, "bytes": x.bytes} for x in self.layers]
        return {"shape": r.shape, "origin": r.origin.tolist(), "cell": r.cell, "middle": middles(r), "layers": layers}


def workspace_section(reach: ReachMap, surveys: Mapping[str, np.ndarray] | None = None) -> Section:
    """The section of a page that shows a reachability map, and surveys of the same grid by name."""
    shown = {"reachability index": np.where(reach.counts > 0, reach.index, np.nan), **(surveys or {})}
    rows = [
        ("frame", reach.frame.name),
        ("configurations", f"{reach.samples:,}"),
        ("cells", f"{' x '.join(map(str, reach.shape))} of {reach.cell:.3g} m"),
        ("volume reached", f"{reach.volume:.3g} m^3"),
        ("directions told apart", str(reach.seen.shape[-1])),
        ("mean reachability index", f"{reach.mean:.3f}"),
        ("complete to", f"{100 * reach.coverage:.1f} % of further configurations find nothing new"),
    ]
    for name, values in (surveys or {}).items():
        found = values[np.isfinite(values)]
        if found.size:
            rows.append((name, f"{found.min():.3g} to {found.max():.3g}, median {np.median(found):.3g}"))
    return Section("Workspace", "workspace.html.j2", Voxels(reach, [Layer.of(k, x) for k, x in shown.items()], rows))
