"""Centres of mass, momentum and heights: what is summed, about which point, and what counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....spatial.adjoint import cross_matrix
from ..case import Case, View
from ..description import Description
from ..hypothesis import Hypothesis, Story
from .register import proposer, rule


@rule(
    "about_origin",
    "the momentum is about the origin of the world",
    "take it about the centre of mass",
    ("centroidal_momentum_matrix",),
    "change",
)
def about_origin(view: View, term: str, x: np.ndarray) -> np.ndarray:
    out = x.copy()
    out[:, :3] += cross_matrix(view.compute("com")) @ x[:, 3:]
    return out


@proposer("about_point", "the momentum is about another point of the world", "take it about the centre of mass")
def about_point(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """h_P = h_G + (G - P) x p, the point P from least squares."""
    term = "centroidal_momentum_matrix"
    x, p, G = case.observed.get(term), case.predict(term), case.predict("com")
    if x is None or p is None or G is None or not np.isfinite(x).all():
        return []
    rows = [case.how.rows.index(r) for r in ("wx", "wy", "wz", "vx", "vy", "vz")]
    apart, linear = (x - p)[:, rows[:3]], p[:, rows[3:]]
    left = cross_matrix(G) @ linear - apart  # P x p
    A, b = -cross_matrix(np.moveaxis(linear, 1, 2)).reshape(-1, 3), np.moveaxis(left, 1, 2).ravel()
    P, *_ = np.linalg.lstsq(A, b, rcond=None)
    if np.abs(A @ P - b).max() > 1e-9 or np.abs(P).max() < 1e-9:
        return []

    def act(view: View, term: str, y: np.ndarray) -> np.ndarray:
        out = y.copy()
        out[:, :3] += cross_matrix(view.compute("com") - P) @ y[:, 3:]
        return out

    words = f"({', '.join(f'{c + 0.0:.6g}' for c in P)})"
    return [replace(h, terms=(term,), place="change", act=act, values=words, cost=1.3)]


def about_own_centre(case: Case, term: str, story: Story) -> list[Hypothesis]:
    """h_P = h_G + (G - P) x p, with P the centre of mass that the subject answers itself."""
    if term != "centroidal_momentum_matrix" or "com" not in case.wrong or any(h.key == "follows" for h in story):
        return []
    G, P = case.predict("com", tuple(h for h in story if "com" in h.terms)), case.observed["com"]
    if G is None or G.shape != P.shape or not np.abs(G - P).max() > case.tolerance:
        return []

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        out = x.copy()
        out[:, :3] += cross_matrix(G - P) @ x[:, 3:]
        return out

    says = "it is about the centre of mass that is answered, which is another, and differs no further"
    return [Hypothesis("follows", says, (term,), "change", act, "repair com first", cost=1.2, made_of=("com",))]


@rule(
    "base_counts", "the mass of what cannot move counts", "leave the links that no joint moves out of it",
    ("com", "com_jacobian", "centroidal_momentum_matrix", "potential_energy"), "change",
    when=lambda case: not case.floating and _ground(case.description)[0] > 0,
)  # fmt: skip
def base_counts(view: View, term: str, x: np.ndarray) -> np.ndarray:
    m, c = _ground(view.description)
    moving = view.robot_mass
    com = view.compute("com")
    whole = moving + m
    if term == "com":
        return (moving * com + m * c) / whole
    if term == "com_jacobian":
        return x * moving / whole
    if term == "potential_energy":
        return x - m * (c @ np.array(view.description.gravity))
    new = (moving * com + m * c) / whole
    out = x.copy()
    out[:, :3] -= cross_matrix(new - com) @ x[:, 3:]
    return out


def _ground(d: Description) -> tuple[float, np.ndarray]:
    """Mass and centre of all links that no joint moves."""
    where = {d.root: np.eye(4)}
    mass, moment = (d.base.mass, d.base.mass * d.base.com) if d.base is not None else (0.0, np.zeros(3))
    for p in d.parts:
        if not p.moves and p.parent in where:
            where[p.link] = where[p.parent] @ p.pose
            if p.body is not None:
                mass += p.body.mass
                moment = moment + p.body.mass * (where[p.link] @ np.append(p.body.com, 1))[:3]
    return mass, moment / mass if mass else moment


@rule(
    "potential_offset",
    "heights are counted from elsewhere",
    "nothing, if only differences are used",
    ("potential_energy",),
    "relation",
    cost=1.2,
)
def potential_offset(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    return x + np.nanmean(observed - x)


@rule(
    "energy_of_base", "all mass is taken at the height of the base", "take the height of the centre of mass",
    ("potential_energy",), "formula", when=lambda case: case.floating,
)  # fmt: skip
def energy_of_base(view: View, term: str) -> np.ndarray:
    return np.asarray(-view.robot_mass * view.states["q"][:, :3] @ np.array(view.description.gravity))
