"""The ways in which codes make rotations, each with slips in rotations alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from . import turns
from .attitudes import Quaternions, Ways
from .steps import Steps


def _with(made: Callable[..., np.ndarray], steps: Steps) -> Callable[..., np.ndarray]:
    """A way to make rotations, by these steps alone."""
    return lambda _, *given: made(steps, *given)


WAYS: dict[str, Callable[[Steps], Ways]] = {
    "rotations by axis and angle": lambda steps: Ways(turn=_with(turns.by_outer_product, steps), own=steps),
    "rotations by axis and angle, entry by entry": lambda steps: Ways(
        turn=_with(turns.by_axis_entries, steps), own=steps
    ),
    "rotations by quaternions": lambda steps: Ways(turn=_with(turns.by_quaternion, steps), own=steps),
    "rotations by Rodrigues' formula, of origins too": lambda steps: Ways(
        turn=_with(turns.rodrigues, steps), rpy=_with(turns.rpy_by(turns.rodrigues), steps), own=steps
    ),
    "rotations by axis and angle, of origins too": lambda steps: Ways(
        turn=_with(turns.by_outer_product, steps), rpy=_with(turns.rpy_by(turns.by_outer_product), steps), own=steps
    ),
    "quaternions throughout": lambda steps: Quaternions(own=steps),
    "quaternions throughout, of origins from matrices": lambda steps: Quaternions(own=steps, converted=True),
    "quaternions throughout, vectors by products": lambda steps: Quaternions(own=steps, products=True),
    "quaternions throughout, vectors by products, of origins from matrices": lambda steps: Quaternions(
        own=steps, products=True, converted=True
    ),
    "quaternions to matrices, by [u]^2": lambda steps: Ways(quaternion=_with(turns.by_square, steps), own=steps),
    "quaternions to matrices": lambda steps: Ways(quaternion=_with(turns.entry_by_entry, steps), own=steps),
    "roll, pitch and yaw as a product": lambda steps: Ways(rpy=_with(turns.of_rpy, steps), own=steps),
    "roll, pitch and yaw, entry by entry": lambda steps: Ways(rpy=_with(turns.rpy_entries, steps), own=steps),
}
"""Other ways to make rotations, with slips there alone."""
PLAIN: dict[str, Callable[[Steps], Ways]] = {
    "forward kinematics": lambda steps: Ways(
        turn=_with(turns.rodrigues, steps), quaternion=_with(turns.of_quaternion, steps), own=steps
    )
}
"""The way of poses, alone."""
