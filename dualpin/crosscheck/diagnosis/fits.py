"""Hypotheses with numbers in them: estimated from every other sample, judged by all of them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from ..subjects.layout import product, transposed
from .bodies import bodies, residual
from .case import Case, View
from .description import Description, Part
from .hypothesis import Hypothesis, Story, ordered
from .placements import placements
from .rules.momentum import about_own_centre
from .rules.register import DERIVED, FORCED, PUSHED, SIX, WEIGHED

TRAIN = slice(0, None, 2)
SNAP = 2e-8
"""A fitted gravity this near to a well-known one is taken for it: float32(9.81) is 3e-8 from 9.81, relatively."""
KNOWN_GRAVITY = {
    9.81: "9.81", 9.80665: "9.80665", 9.8: "9.8", 10.0: "10", 9.82: "9.82", 9.807: "9.807", 9.8067: "9.8067", 0.0: "0",
    float(np.float32(9.80665)): "float32(9.80665)", float(np.float32(9.81)): "float32(9.81)", 19.62: "2 x 9.81",
}  # fmt: skip
KNOWN_SCALE = {
    2.0: "2", 0.5: "1/2", 1e3: "1000", 1e-3: "1/1000", 180 / np.pi: "180/pi", np.pi / 180: "pi/180", 9.81: "9.81",
    1 / 9.81: "1/9.81", 100.0: "100", 0.01: "1/100", 1e6: "1e6", 1e-6: "1e-6", 2 * np.pi: "2 pi",
}  # fmt: skip


def fits(case: Case, term: str, story: Story) -> list[Hypothesis]:
    """What can be estimated from a term's residual under a story."""
    x, p = case.observed[term], case.predict(term, story)
    if p is None or p.shape != x.shape or not np.isfinite(p).all() or len(x) < 2:  # one state cannot judge as well
        return []
    keys = {h.key for h in story}
    found = about_own_centre(case, term, story)
    whole = np.isfinite(x).reshape(len(x), -1).all(axis=1)
    train = np.flatnonzero(whole)[TRAIN]
    if len(train):
        for estimate in (_gravity, _forces, _rotors, _scale, _rows, _halves, _columns, _constants, bodies):
            found += estimate(case, term, story, keys, train)
    try:
        return found + placements(case, term, story)
    except np.linalg.LinAlgError:  # a slip may predict poses that have no inverse
        return found


def _alike(term: str) -> tuple[str, ...]:
    """The terms that a number stands before if it does before this one: it, and forces that are made of it."""
    return ALIKE[ALIKE.index(term) :] if term in ALIKE else (term,)


ALIKE = ("gravity", "bias", "rnea", "rnea_f_ext")


def _gravity(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> list[Hypothesis]:
    if term not in LINEAR or keys & {"gravity", "no_gravity_in_bias"}:
        return []

    def under(g: Sequence[float] | np.ndarray) -> Hypothesis:
        return gravity_of(case, g)

    units = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    told = case.predictions(term, [ordered((*story, under(g))) for g in units])
    answers = [y for y in told if y is not None and np.isfinite(y).all()]
    if len(answers) < len(units):
        return []
    nothing = answers[0]
    A = np.stack([y - nothing for y in answers[1:]], -1)[train].reshape(-1, 3)
    g, *_ = np.linalg.lstsq(A, (case.observed[term] - nothing)[train].ravel(), rcond=None)
    blind = np.abs(A).max(axis=0) < 1e-12 * max(1.0, np.abs(A).max())  # gravity along this axis has no effect
    g = np.where(blind, np.array(case.asking.gravity), g)
    snapped, _ = _snapped(g)
    return [] if np.abs(snapped - np.array(case.asking.gravity)).max() < 1e-12 else [under(snapped)]


LINEAR = (*WEIGHED, "potential_energy", "rnea_f_ext", "rnea_derivatives", "joint_torque_regressor")
"""Terms from which gravity is estimated."""
FALLING = (*WEIGHED, *PUSHED, *DERIVED, "joint_torque_regressor", "potential_energy", "frame_acceleration")
"""Terms in which gravity counts; in accelerations beside another cause, where they are those of an accelerometer."""


def gravity_of(case: Case, g: Sequence[float] | np.ndarray) -> Hypothesis:
    """Gravity is g."""
    vector, words = _snapped(np.asarray(g, float))
    here = ", ".join(f"{x:g}" for x in case.asking.gravity)
    return Hypothesis(
        "gravity", "gravity is another", FALLING, "edit",
        lambda d, items: replace(d, gravity=tuple(float(x) for x in vector)), f"pass gravity = ({here})", values=words,
        cost=1.6 if words.startswith("fitted") else 1.0,
    )  # fmt: skip


def _snapped(g: np.ndarray) -> tuple[np.ndarray, str]:
    """The nearest well-known gravity, in words."""
    for axis in range(3):
        for sign in (-1.0, 1.0):
            for value, word in KNOWN_GRAVITY.items():
                e = np.zeros(3)
                e[axis] = sign * value
                if np.abs(g - e).max() < SNAP:
                    return e, f"{'-' if sign < 0 and value else ''}{word} along {'xyz'[axis]}" if value else "0"
    return g, "fitted " + " ".join(f"{x:.7g}" for x in g)


# --- forces at joints ----------------------------------------------------------------------------

SHAPES: dict[str, tuple[str, Callable[[View], np.ndarray], str]] = {
    "damping_fit": ("a force in proportion to v", lambda view: view.states["v"], "take the damping out"),
    "friction_fit": ("a force with the sign of v", lambda view: np.sign(view.states["v"]), "take the friction out"),
    "constant_fit": ("a constant force", lambda view: np.ones_like(view.states["v"]), "take the constant force out"),
    "stiffness_fit": ("a force in proportion to q (a spring)", lambda view: _positions(view), "take the spring out"),
    "drag_fit": ("a force in proportion to v |v|", lambda view: _drag(view), "take the drag out"),
}
RESTING = ("constant_fit", "stiffness_fit")
"""Shapes that do not need a velocity."""


def _positions(view: View) -> np.ndarray:
    out = np.zeros_like(view.states["v"])
    for j in view.case.robot:
        if j.mimic is None and j.model.nq == j.model.nv == 1:
            out[:, j.v.start] = view.states["q"][:, j.q.start]
    return out


def _drag(view: View) -> np.ndarray:
    v = view.states["v"]
    return v * np.abs(v)


def _forces(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> Iterable[Hypothesis]:
    if keys & set(SHAPES):
        return
    found = _felt(case, term, story)
    for key, u in found[1].items() if found else ():
        k = _coefficients([u], found[0], train) if found else np.zeros(0)
        if k.any():
            yield _shaped(case, key, k[0])


def pairs_of_forces(case: Case, term: str) -> list[Story]:
    """Two shapes, estimated together: alone, each takes up part of the other."""
    found = _felt(case, term, ())
    train = np.flatnonzero(np.isfinite(case.observed[term]).reshape(case.asking.samples, -1).all(axis=1))[TRAIN]
    if found is None or len(train) < 3:
        return []
    out = []
    for a, b in itertools.combinations(found[1], 2):
        k = _coefficients([found[1][a], found[1][b]], found[0], train)
        if k.any(axis=1).all():
            out.append(ordered((_shaped(case, a, k[0]), _shaped(case, b, k[1]))))
    return out


def _felt(case: Case, term: str, story: Story) -> tuple[np.ndarray, dict[str, np.ndarray]] | None:
    """Residual joint forces, and the shapes fitted to them."""
    found = residual(case, term, story) if term in (*FORCED, "gravity") else None
    if found is None:
        return None
    view, r = found
    return r, {key: SHAPES[key][1](view) for key in (RESTING if term == "gravity" else SHAPES)}


def _coefficients(shapes: Sequence[np.ndarray], r: np.ndarray, train: np.ndarray) -> np.ndarray:
    """(shapes, nv): each joint's, all shapes fitted together."""
    U, b = np.stack(shapes, -1)[train], r[train]
    A = np.einsum("njs,njt->jst", U, U)
    k = np.einsum("jst,jt->sj", np.linalg.pinv(A, rcond=1e-12), np.einsum("njs,nj->js", U, b))
    return np.where(np.abs(k) < 1e-9 * np.maximum(1.0, np.abs(k).max(axis=1, keepdims=True)), 0.0, k)


def _shaped(case: Case, key: str, k: np.ndarray) -> Hypothesis:
    says, shape, fix = SHAPES[key]
    terms = (*(WEIGHED if key in RESTING else FORCED), *PUSHED)
    return Hypothesis(
        key, says, terms, "force", lambda view: k * shape(view), fix, _names(case, k), _listed(k), 1.5
    )  # fmt: skip


def _names(case: Case, k: np.ndarray) -> tuple[str, ...]:
    """The joints with a number, unless it is all of them."""
    named = {v.start: p.joint for p, v in case.parts()}
    names = tuple(named[i] for i in np.flatnonzero(k) if i in named)
    return () if len(names) == len(named) else names


def _listed(k: np.ndarray) -> str:
    values = [f"{x:.6g}" for x in k[k != 0]]
    return ", ".join(values[:8]) + (", ..." if len(values) > 8 else "")


def _rotors(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> Iterable[Hypothesis]:
    """Armature: a diagonal that the mass matrix has besides."""
    if term not in ("crba", "rnea", "aba") or "rotor_fit" in keys:
        return
    if term == "crba":
        view, p = case.view(story), case.predict(term, story)
        if view is None or p is None:
            return
        G, _ = view.layout.matrices(view.states["q"], view.states["v"])
        k = np.einsum("nii->ni", transposed(G) @ (case.observed[term] - p) @ G)[train].mean(0)
    else:
        found = residual(case, term, story)
        if found is None:
            return
        view, r = found
        a = view.states["a"]
        if term == "aba":
            layout = view.layout
            G, D = layout.matrices(view.states["q"], view.states["v"])
            a = np.linalg.solve(G, (case.observed[term] - product(D, view.states["v"]))[..., None])[..., 0]
        k = (a * r)[train].sum(0) / np.maximum((a * a)[train].sum(0), 1e-300)
    k = np.where(np.abs(k) < 1e-9 * max(1.0, np.abs(k).max()), 0.0, k)
    rotors = {p.joint: float(k[v.start]) for p, v in case.parts() if v.stop - v.start == 1 and k[v.start]}
    if not rotors:
        return

    def edit(d: Description, items: Sequence[str]) -> Description:
        def part(p: Part, _: Description) -> Part:
            more = rotors.get(p.joint)
            return p if more is None else replace(p, armature=((p.armature or (0.0,))[0] + more,))

        return d.with_parts(part)

    terms = ("crba", "rnea", "aba", "minv", "kinetic_energy")
    yield Hypothesis(
        "rotor_fit", "a rotor's inertia (armature)", terms, "edit", edit, "leave it out, or give it to the robot",
        _names(case, np.where(np.abs(k) > 0, k, 0)), _listed(np.array(list(rotors.values()))), 1.5,
    )  # fmt: skip


# --- scales --------------------------------------------------------------------------------------


def _scale(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> list[Hypothesis]:
    """The whole answer in other units, or counted another number of times."""
    if keys & {"scale", "sign"} or term == "fk":
        return []
    x, p = case.observed[term], case.predict(term, story)
    if p is None:
        return []
    a, b = p[train].ravel(), x[train].ravel()
    if not (a @ a > 0 and np.isfinite(b).all()):
        return []
    k = float(a @ b / (a @ a))
    known = next(((y, w) for y, w in KNOWN_SCALE.items() if abs(abs(k) / y - 1) < 1e-9), None)
    if not np.isfinite(k) or abs(k - 1) < 1e-10 or abs(k + 1) < 1e-10 or abs(k) < 1e-12:
        return []
    words = f"{'-' if k < 0 else ''}{known[1]}" if known else f"{k:.10g}"
    factor = np.copysign(known[0], k) if known else k

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        return factor * x

    says = "the answer is multiplied by a number (other units, or counted another number of times)"
    cost = 1.05 if known else 1.6
    return [Hypothesis("scale", says, _alike(term), "answer", act, f"divide by {words}", (), words, cost)]


def _rows(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> list[Hypothesis]:
    """Single rows in other units, or with the other sign: a gear, a sign that only one joint has."""
    x, p = case.observed[term], case.predict(term, story)
    if term not in (*WEIGHED,) or keys & {"joint_scale", "scale", "sign"} or p is None:
        return []
    squares = (p[train] ** 2).sum(0)
    felt = np.abs(p[train]).max(0) > 1e-12 * max(1.0, np.abs(p[train]).max())  # not from rounding
    with np.errstate(all="ignore"):
        k = np.where(felt, (x[train] * p[train]).sum(0) / squares, 1.0)
    near = np.round(k)
    k = np.where(np.abs(k - near) < 1e-9, near, k)
    off = np.flatnonzero(np.abs(k - 1) > 1e-9)
    if not np.isfinite(k).all() or not 0 < len(off) < len(k):
        return []
    names = tuple(case.how.v[i] for i in off)

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        return x * k

    says = "the forces of some joints are multiplied by a number (a gear, a sign)"
    words = ", ".join(f"{k[i]:.8g}" for i in off[:8])
    cost = 1.3 + 0.2 * len(off)
    return [Hypothesis("joint_scale", says, _alike(term), "answer", act, "divide them by it", names, words, cost)]


def _halves(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> list[Hypothesis]:
    """The angular or the linear rows of six-vectors in other units, or counted another number of times."""
    x, p = case.observed[term], case.predict(term, story)
    if term not in (*SIX, "frame_acceleration", "centroidal_momentum_matrix") or keys & {"half_scale", "scale"}:
        return []
    axis = -1 if term in ("frame_velocity", "frame_acceleration") else -2
    assert p is not None  # `fits` has seen to that
    found = []
    for half, names in HALVES.items():
        at = [case.how.rows.index(n) for n in names]
        a, b = (np.take(y[train], at, axis).ravel() for y in (p, x))
        k = float(a @ b / (a @ a)) if a @ a > 0 else 1.0
        if not np.isfinite(k) or abs(k - 1) < 1e-9:
            continue
        k = float(np.round(k)) if abs(k - np.round(k)) < 1e-9 else k
        factors = np.where(np.isin(case.how.rows, names), k, 1.0)

        def act(view: View, term: str, y: np.ndarray, factors: np.ndarray = factors) -> np.ndarray:
            return y * (factors if axis == -1 else factors[:, None])

        says = f"the {half} rows are multiplied by a number (a unit, a sign, rates of quaternions)"
        found.append(Hypothesis("half_scale", says, (term,), "answer", act, "divide by it", (), f"{k:.8g}", 1.2))
    return found


HALVES = {"angular": ("wx", "wy", "wz"), "linear": ("vx", "vy", "vz")}


def _columns(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> list[Hypothesis]:
    """Single columns of a Jacobian with another sign, in other units, or empty."""
    x, p = case.observed[term], case.predict(term, story)
    jacobians = ("jacobian", "jacobian_dot", "com_jacobian", "centroidal_momentum_matrix")
    if term not in jacobians or keys & {"column_scale", "scale"} or p is None:
        return []
    axes = tuple(range(p.ndim - 1))
    a, b = p[train], x[train]
    felt = np.abs(a).max(axes) > 1e-12 * max(1.0, np.abs(a).max())
    with np.errstate(all="ignore"):
        k = np.where(felt, (a * b).sum(axes) / (a * a).sum(axes), 1.0)
    k = np.where(np.abs(k - np.round(k)) < 1e-9, np.round(k), k)
    off = np.flatnonzero(np.abs(k - 1) > 1e-9)
    if not np.isfinite(k).all() or not 0 < len(off) < len(k):
        return []

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        return x * k

    return [
        Hypothesis(
            "column_scale", "columns of some joints are multiplied by a number (a sign, a unit, 0)", _alike(term),
            "answer", act, "look at how these columns are filled", tuple(case.how.v[i] for i in off),
            ", ".join(f"{k[i]:.8g}" for i in off[:8]), 1.3 + 0.2 * len(off),
        )
    ]  # fmt: skip


def _constants(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> list[Hypothesis]:
    """Entries of the mass matrix that are off by a constant, as where a model by hand forgets one."""
    x, p = case.observed[term], case.predict(term, story)
    if term != "crba" or keys & {"constant_entries", "rotor_fit"} or p is None:
        return []
    apart = (x - p)[train]
    K = apart.mean(0)
    K = np.where(np.abs(K) < 1e-10 * max(1.0, np.abs(K).max()), 0.0, K)
    if not K.any() or np.abs(apart - K).max() > 1e-9 * max(1.0, np.abs(p).max()):
        return []
    v = case.how.v
    names = [f"({v[i]}, {v[j]}) by {K[i, j]:.6g}" for i, j in np.argwhere(K) if i <= j or not K[j, i]]

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        return x + K

    says = "entries of the mass matrix are off by constants"
    fix = "look for an inertia that is forgotten or counted twice there"
    return [
        Hypothesis(
            "constant_entries", says, ("crba",), "answer", act, fix, (), ", ".join(names[:6]), 1.7 + 0.1 * len(names)
        )
    ]


FITTED = {
    "gravity": ("gravity is another; the vector is estimated", "pass the robot's gravity"),
    **{key: (says, fix) for key, (says, _, fix) in SHAPES.items()},
    "rotor_fit": (
        "a rotor's inertia (armature) is on the diagonal of M",
        "leave the armature out, or give it to the robot",
    ),
    "column_scale": ("columns of some joints are multiplied by a number", "look at how these columns are filled"),
    "half_scale": ("the angular or the linear rows are multiplied by a number", "divide them by it"),
    "joint_scale": ("the forces of some joints are multiplied by a number", "divide them by it: a gear, a sign"),
    "constant_entries": (
        "entries of the mass matrix are off by constants",
        "look for an inertia that is forgotten there",
    ),
    "scale": ("the answer is multiplied by a number", "divide by it: other units, or counted another number of times"),
    "one_link": (
        "one body has other inertial parameters; they are estimated",
        "compare its mass, centre and inertia with the file",
    ),
    "base_offset": ("the base stands elsewhere", "place the robot's base at the world's origin"),
    "tool_offset": ("frames stand elsewhere on their links", "use the link's own frame, at its joint"),
    "origin_fit": (
        "the origin (or the zero position) of a joint stands elsewhere",
        "compare its <origin> with the file",
    ),
}
"""The keys that are estimated, with what they say and what to do."""
