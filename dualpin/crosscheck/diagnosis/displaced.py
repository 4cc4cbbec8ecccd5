"""Frames that stand elsewhere on their links: what is seen of them there."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...spatial.adjoint import cross_matrix
from ..subjects.layout import product
from .case import View


def displaced(view: View, term: str, x: np.ndarray, at: Mapping[int, np.ndarray]) -> np.ndarray:
    """A term of frames, of which frame k stands at the pose at[k] of its own; at the frame, in world axes.

    With r from the frame to there: v_r = v + w x r, and its rate a_r = a + alpha x r + w x (w x r).
    """
    out, R = x.copy(), view.compute("fk")[..., :3, :3]
    w = view.compute("frame_velocity")[..., :3] if term in ("jacobian_dot", "frame_acceleration") else None
    for k, T in at.items():
        if term == "fk":
            out[:, k] = x[:, k] @ T
            continue
        arm = cross_matrix(R[:, k] @ T[:3, 3])
        if term in ("jacobian", "jacobian_dot"):
            out[:, k, 3:] -= arm @ x[:, k, :3]
        else:
            out[:, k, 3:] -= product(arm, x[:, k, :3])
        if w is None:
            continue
        moving = cross_matrix(product(cross_matrix(w[:, k]), R[:, k] @ T[:3, 3]))  # of w x r
        if term == "jacobian_dot":
            out[:, k, 3:] -= moving @ view.compute("jacobian")[:, k, :3]
        else:
            out[:, k, 3:] -= product(moving, w[:, k])
    return out
