"""Forces that are in the answer, or left out of it: gravity, damping, friction, constraints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.layout import product
from ...subjects.questions import QUESTIONS
from ..case import Case, View
from ..description import Description
from ..hypothesis import Hypothesis
from .register import FORCED, PUSHED, proposer, rule

# --- forces --------------------------------------------------------------------------------------


def _gravity(g: tuple[float, float, float]) -> Callable[..., Description]:
    return lambda d, items: replace(d, gravity=g)


@proposer("no_gravity_in_bias", "gravity is not in it", "add the gravity term, or call it C v")
def no_gravity_in_bias(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, terms=("bias",), place="edit", act=_gravity((0.0, 0.0, 0.0)), cost=0.9)]


def _has(what: str) -> Callable[[Case], bool]:
    return lambda case: any(getattr(p, what) for p, _ in case.parts())


@rule(
    "damping",
    "the file's joint damping is in it",
    "set <dynamics damping> to 0, or subtract D v",
    (*FORCED, *PUSHED, "rnea_derivatives"),
    "force",
    when=_has("damping"),
)
def damping(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.damping) * view.states["v"]


@rule(
    "damping_sign",
    "the file's joint damping is in it with the other sign",
    "damping opposes the motion: tau has + D v",
    (*FORCED, *PUSHED, "rnea_derivatives"),
    "force",
    when=_has("damping"),
)
def damping_sign(view: View) -> np.ndarray:
    return -damping(view)


@rule(
    "friction",
    "the file's joint friction is in it",
    "set <dynamics friction> to 0, or subtract f sign(v)",
    (*FORCED, *PUSHED),
    "force",
    when=_has("friction"),
)
def friction(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.friction) * np.sign(view.states["v"])


@rule(
    "friction_sign",
    "the file's joint friction is in it with the other sign",
    "friction opposes the motion: tau has + f sign(v)",
    (*FORCED, *PUSHED),
    "force",
    when=_has("friction"),
)
def friction_sign(view: View) -> np.ndarray:
    return -friction(view)


@rule(
    "friction_as_damping",
    "the file's friction is used as a viscous coefficient",
    "<dynamics friction> is dry friction: f sign(v)",
    (*FORCED, *PUSHED, "rnea_derivatives"),
    "force",
    when=_has("friction"),
)
def friction_as_damping(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.friction) * view.states["v"]


@rule(
    "damping_as_friction",
    "the file's damping is used as dry friction",
    "<dynamics damping> is viscous: D v",
    (*FORCED, *PUSHED),
    "force",
    when=_has("damping"),
)
def damping_as_friction(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.damping) * np.sign(view.states["v"])


SMOOTH: dict[str, Callable[[np.ndarray, float], np.ndarray]] = {
    "tanh(v / {})": lambda v, e: np.tanh(v / e), "v / (|v| + {})": lambda v, e: v / (np.abs(v) + e),
    "2/pi atan(v / {})": lambda v, e: 2 / np.pi * np.arctan(v / e),
}  # fmt: skip


@proposer("friction_smooth", "the file's friction is in it, smoothed near v = 0", "set <dynamics friction> to 0")
def friction_smooth(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str, width: float) -> Hypothesis:
        def force(view: View) -> np.ndarray:
            return view.case.per_velocity(lambda p: p.friction) * SMOOTH[words](view.states["v"], width)

        return replace(h, place="force", act=force, terms=FORCED, values=words.format(width), cost=1.2)

    if not _has("friction")(case):
        return []
    return [one(words, width) for words in SMOOTH for width in (1.0, 0.5, 0.1, 0.05, 0.01, 0.001)]


@rule("saturated", "forces are cut off at a bound", "give them uncut; what an actuator can do is another question",
      ("bias", "rnea", "gravity"), "relation", cost=1.5)  # fmt: skip
def saturated(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    """The largest value of a row stands in it at least twice, and what is predicted is beyond; 0 is no bound."""
    top = np.abs(observed).max(axis=0)
    at = np.abs(np.abs(observed) - top) <= 1e-12 * top
    cut = ((at & (np.abs(x) > top)).sum(axis=0) >= 2) & (top > 0)
    return np.where(cut, np.clip(x, -top, top), x)


def _allowed(
    view: View, term: str, x: np.ndarray, observed: np.ndarray, f: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """The prediction, and what of the rest is an allowed force; accelerations are turned into forces first."""
    r = np.where(np.isnan(observed), 0.0, observed - x)  # of some frames there may be no answer
    if QUESTIONS[term].source != "aba":
        return x + f(r)
    M = view.layout.answer("matrix", view.compute("crba"), view.states)
    M = M[:, None] if QUESTIONS[term].pushes else M
    return x + np.linalg.solve(M, f(product(M, r))[..., None])[..., 0]


@rule("mimic_force", "a force along the <mimic> constraint (a soft equality)", "switch equality constraints off",
      ("rnea", "aba", *PUSHED), "relation", cost=1.3,
      when=lambda case: not case.floating and not case.robot.coupled and bool(case.description.mimics))  # fmt: skip
def mimic_force(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    names, rows = view.case.how.v, []
    for name, (leader, k, _) in view.case.description.mimics.items():
        row = np.zeros(len(names))
        row[names.index(name)] += 1
        row[names.index(leader)] -= k
        rows.append(row)
    P = np.linalg.pinv(np.array(rows)) @ np.array(rows)
    return _allowed(view, term, x, observed, lambda r: r @ P.T)


SATURATED = 0.3
"""A friction "within its bound" explains anything unless it stands at its bound in this share of the entries."""


@rule(
    "friction_bound",
    "a friction force within the file's bound (not f sign(v))",
    "switch friction off",
    ("rnea", "aba", *PUSHED),
    "relation",
    cost=1.7,
    when=_has("friction"),
)
def friction_bound(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    f = view.case.per_velocity(lambda p: p.friction)[view.layout.to_v] * (1 + 1e-9)

    def within(r: np.ndarray) -> np.ndarray:
        at_bound = (np.abs(np.abs(r) - f) < 1e-6 * f)[~np.isnan(observed).any(axis=-1)][..., f > 0]
        return np.clip(r, -f, f) if at_bound.mean() > SATURATED else 0 * r

    return _allowed(view, term, x, observed, within)
