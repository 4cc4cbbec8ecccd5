"""Wrenches from outside and derivatives: what is done otherwise with them alone."""

from __future__ import annotations

import numpy as np

from ...subjects.layout import transposed
from ..case import View
from .register import DERIVED, PUSHED, rule


def _with_wrench(view: View, term: str, k: float | np.ndarray) -> np.ndarray:
    """The term under k times the wrench."""
    return view.compute(term, view.layout.how.reference, f_ext=k * view.states["f_ext"])


@rule(
    "f_ext_sign", "external wrenches push the other way: they are taken for those that the robot exerts",
    "f_ext acts on the robot: tau = M a + h - J^T f_ext", PUSHED, "formula",
)  # fmt: skip
def f_ext_sign(view: View, term: str) -> np.ndarray:
    return _with_wrench(view, term, -1.0)


@rule("f_ext_ignored", "external wrenches are ignored", "subtract J^T f_ext", PUSHED, "formula")
def f_ext_ignored(view: View, term: str) -> np.ndarray:
    return _with_wrench(view, term, 0.0)


@rule(
    "f_ext_moment_ignored", "moments of external wrenches are ignored", "subtract J_angular^T n too", PUSHED, "formula",
    cost=1.1,
)  # fmt: skip
def f_ext_moment_ignored(view: View, term: str) -> np.ndarray:
    return _with_wrench(view, term, np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]))


@rule(
    "derivatives_transposed", "derivatives are transposed", "row i, column j: of force i by coordinate j", DERIVED,
    "answer",
)  # fmt: skip
def derivatives_transposed(view: View, term: str, x: np.ndarray) -> np.ndarray:
    return transposed(x)
