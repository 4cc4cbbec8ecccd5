"""Where links stand on bodies, and the directions in which joints move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class Placed:
    """Where a link is fixed on a body: its number, and the orientation and position there."""

    body: int
    A: np.ndarray
    p: np.ndarray


@dataclass
class Axis:
    """One direction in which a joint moves: about it, or along it."""

    link: int
    parent: int
    turns: bool
    direction: np.ndarray
    """In the axes of the link."""
    column: int
    """In v."""
    ratio: float = 1.0
    follows: bool = False
    base: bool = False
    world: np.ndarray | None = None
    """The direction in the world, where it was kept when the link was placed."""
