"""Forces that stories add to those of the equations of motion, as a `View` sees them."""

from __future__ import annotations

from typing import Any

import numpy as np

from .hypothesis import Story

STEP = 2.0**-12
"""Of velocities: small beside those at which a force changes its sign, and large beside their rounding."""


def forces_of(story: Story, view: Any, term: str) -> np.ndarray | None:
    """Their sum (samples, nv), of those that show in a term."""
    forces = [h.act(view) for h in story if h.place == "force" and term in h.terms]
    return sum(forces[1:], forces[0]) if forces else None


def by_velocity(story: Story, view: Any) -> np.ndarray | float:
    """What they add to the derivatives of tau; they depend on velocities, piecewise linearly."""
    forces = [h for h in story if h.place == "force"]
    if not forces:
        return 0.0
    n, nv = view.states["v"].shape
    out = np.zeros((n, 3, nv, nv))
    for j, step in enumerate(STEP * np.eye(nv)):
        ahead, behind = (view.at(v=view.states["v"] + s) for s in (step, -step))
        out[:, 1, :, j] = sum((h.act(ahead) - h.act(behind)) / (2 * STEP) for h in forces)
    return out
