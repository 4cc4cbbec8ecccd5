"""One body, or one link, with other inertial parameters: estimated from all terms that are linear in them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from ...call import evaluate as call
from ...spatial.inertia import steiner
from ..subjects.layout import product, transposed
from ..subjects.questions import QUESTIONS
from .case import Case, View
from .description import Body, Description
from .hypothesis import Hypothesis, Story
from .rules.register import INERTIAL, WEIGHED

FITTED_ITEM = 2.6
"""The cost of ten fitted numbers: more than that of any rule about one link."""
LEFT = 1e-9
"""What a fit may leave, relative to the largest residual."""


def residual(case: Case, term: str, story: Story) -> tuple[View, np.ndarray] | None:
    """Residual joint forces in dualpin's columns: tau observed minus tau predicted."""
    view, x, p = case.view(story), case.observed[term], case.predict(term, story)
    if view is None or p is None or not np.isfinite(x).all():
        return None
    r = x - p
    if term == "aba":
        M = case.predict("crba", tuple(h for h in story if h.place in ("word", "edit")))
        if M is None:
            return None
        r = -product(M, r)
    G, _ = view.layout.matrices(view.states["q"], view.states["v"])
    return view, product(transposed(G), r)


# --- one body's ten parameters -------------------------------------------------------------------


def bodies(case: Case, term: str, story: Story, keys: set[str], train: np.ndarray) -> Iterable[Hypothesis]:
    """Other inertial parameters of one body: from this term alone, and from all that it is linear in together."""
    if term not in (*WEIGHED, "crba") or keys & {"one_link"} or case.robot.coupled or len(story) > 1:
        return
    mine = _linear(case, term, story, train)
    if mine is None:
        return
    others = [t for t in ("gravity", "bias", "rnea", "crba") if t in case.observed and t != term]
    together = [mine, *(found for t in others if (found := _linear(case, t, story, train)) is not None)]
    # a body that is another shows in all of them: where one is right, it is not this term alone that tells
    alone = len(together) > 1 and not any(case.score(t).right for t in others)
    for equations in [together, [mine]] if alone else [together]:
        compressed = _compressed(case, equations)
        yield from _links(case, compressed)
        for joint, delta in _solved(case, compressed):
            yield _body(case, joint, delta)


Equations = tuple[np.ndarray, np.ndarray]


def _linear(case: Case, term: str, story: Story, train: np.ndarray) -> Equations | None:
    """(A, b) with A delta = b, for the change of all bodies' parameters that a term needs."""
    story = tuple(h for h in story if term in h.terms)
    if term not in QUESTIONS or not np.isfinite(case.observed[term]).all():
        return None
    if term == "crba":
        view, p = case.view(story), case.predict(term, story)
        if view is None or p is None or case.robot.nv > 12:
            return None
        return _mass_equations(case, view, case.observed[term] - p, train[:4])
    found = residual(case, term, story)
    if found is None:
        return None
    view, r = found
    s, zero = view.states, np.zeros_like(view.states["v"])
    v, a = (zero, zero) if term == "gravity" else (s["v"], zero) if term == "bias" else (s["v"], s["a"])
    if term == "aba":
        G, D = view.layout.matrices(s["q"], s["v"])
        a = np.linalg.solve(G, (case.observed[term] - product(D, s["v"]))[..., None])[..., 0]
    robot = case.robot if view.description is case.description else view.robot
    Y = call(robot, "joint_torque_regressor", {"q": s["q"][train], "v": v[train], "a": a[train]}, engine="numpy")
    return Y.reshape(-1, Y.shape[-1]), r[train].ravel()


def _mass_equations(case: Case, view: View, apart: np.ndarray, train: np.ndarray) -> Equations:
    """M e_k is what unit accelerations need at rest, without gravity."""
    nv, n = case.robot.nv, len(train)
    G, _ = view.layout.matrices(view.states["q"], view.states["v"])
    r = (transposed(G) @ apart @ G)[train]
    q = np.repeat(view.states["q"][train], nv, axis=0)
    robot = case.robot.with_gravity((0.0, 0.0, 0.0))
    inputs = {"q": q, "v": np.zeros((n * nv, nv)), "a": np.tile(np.eye(nv), (n, 1))}
    Y = call(robot, "joint_torque_regressor", inputs, engine="numpy")
    return Y.reshape(-1, Y.shape[-1]), np.swapaxes(r, 1, 2).reshape(-1)


Small = dict[str, tuple[np.ndarray, np.ndarray, float]]


def _compressed(case: Case, equations: Sequence[Equations]) -> Small:
    """For each joint's body: R, y and what no change of it explains, with |A delta - b| = |R delta - y| + that."""
    scale = [max(1.0, float(np.abs(b).max(initial=0.0))) for _, b in equations]
    found = {}
    for i, joint in enumerate(case.robot):
        A = np.vstack([A[:, 10 * i : 10 * i + 10] / k for (A, _), k in zip(equations, scale, strict=True)])
        b = np.concatenate([b / k for (_, b), k in zip(equations, scale, strict=True)])
        Q, R = np.linalg.qr(A)
        y = Q.T @ b
        found[joint.name] = R, y, float(np.abs(b - Q @ y).max(initial=0.0))
    return found


def _solved(case: Case, small: Small) -> list[tuple[str, np.ndarray]]:
    """The bodies whose parameters alone explain what is asked, with the change."""
    out = []
    for joint, (R, y, lost) in small.items():
        delta, *_ = np.linalg.lstsq(R, y, rcond=1e-11)
        if lost < LEFT and np.abs(R @ delta - y).max(initial=0.0) < LEFT and np.abs(delta).max() > 1e-12:
            out.append((joint, delta))
    return out[-3:]  # the outermost first: a change of an inner body can often explain the same


# --- one link: fewer numbers, which say more -----------------------------------------------------


def _mass(b: Body, x: np.ndarray) -> Body:
    return replace(b, mass=b.mass + float(x[0]))


def _density(b: Body, x: np.ndarray) -> Body:
    return replace(b, mass=b.mass * (1 + float(x[0])), inertia=b.inertia * (1 + float(x[0])))


def _centre(b: Body, x: np.ndarray) -> Body:
    return replace(b, com=b.com + x)


def _inertia(b: Body, x: np.ndarray) -> Body:
    xx, xy, xz, yy, yz, zz = x
    return replace(b, inertia=b.inertia + np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


CHANGES: tuple[tuple[str, int, float, Callable[[Body, np.ndarray], Body]], ...] = (
    ("mass", 1, 1.9, _mass), ("mass and inertia", 1, 1.95, _density), ("centre of mass", 3, 2.05, _centre),
    ("inertia", 6, 2.1, _inertia),
)  # fmt: skip
"""What may be another of one link: in words, how many numbers, the cost, and how they change it."""


NOTHING = 1e-9
"""The share of a mass that is left by rounding, where the body is left out."""


def _links(case: Case, small: Small) -> Iterable[Hypothesis]:
    for link, (joint, X, body) in _standing(case).items():
        if joint not in small:
            continue
        for what, n, cost, change in CHANGES:
            x = _newton(small[joint], body, X, n, change)
            new = None if x is None else change(body, x)
            gone = new is not None and abs(new.mass) < NOTHING * body.mass
            if new is not None and not (gone and what == "mass and inertia"):  # that has a rule: it is left out
                yield _link(link, body, replace(new, mass=0.0) if gone else new, what, cost)


def _newton(
    small: tuple[np.ndarray, np.ndarray, float],
    b: Body,
    X: np.ndarray,
    n: int,
    change: Callable[[Body, np.ndarray], Body],
) -> np.ndarray | None:
    """The numbers with which R (pi - pi_0) = y, if there are any; pi is a polynomial in them."""
    R, y, lost = small
    if lost > LEFT:
        return None
    start, x, h = _parameters(b, X), np.zeros(n), 1e-4

    def residual_at(x: np.ndarray) -> np.ndarray:
        return np.asarray(R @ (_parameters(change(b, x), X) - start) - y)

    for _ in range(8):
        slope = np.stack([(residual_at(x + h * e) - residual_at(x - h * e)) / (2 * h) for e in np.eye(n)], axis=1)
        step, *_ = np.linalg.lstsq(slope, residual_at(x), rcond=1e-11)
        x = x - step
    r = residual_at(x)
    return x if np.isfinite(r).all() and np.abs(r).max(initial=0.0) < LEFT and np.abs(x).max() > 1e-9 else None


def _parameters(b: Body, X: np.ndarray) -> np.ndarray:
    """The ten parameters about the joint's frame, of a link that stands there with the pose X."""
    R, c = X[:3, :3], (X @ np.append(b.com, 1.0))[:3]
    J = R @ b.in_link @ R.T + steiner(b.mass, c)
    return np.array([b.mass, *(b.mass * c), J[0, 0], J[0, 1], J[1, 1], J[0, 2], J[1, 2], J[2, 2]])


def _standing(case: Case) -> dict[str, tuple[str, np.ndarray, Body]]:
    """Every link with a body: the joint that moves it, and its pose there."""
    d = case.description
    base = case.robot.joints[0].name if case.floating else ""
    where: dict[str, tuple[str, np.ndarray]] = {d.root: (base, np.eye(4))}
    found = {} if d.base is None else {d.root: (base, np.eye(4), d.base)}
    for p in d.parts:
        joint, X = where[p.parent]
        where[p.link] = (p.joint, np.eye(4)) if p.moves else (joint, X @ p.pose)
        if p.body is not None and p.body.mass > 0:
            found[p.link] = (*where[p.link], p.body)
    return found


def _link(link: str, old: Body, new: Body, what: str, cost: float) -> Hypothesis:
    words = {
        "mass": f"mass {old.mass:.6g} -> {new.mass:.6g}",
        "mass and inertia": f"mass and inertia times {new.mass / old.mass:.6g}",
        "centre of mass": f"centre of mass {_row(old.com)} -> {_row(new.com)}",
        "inertia": f"inertia {_row(old.inertia[np.triu_indices(3)])} -> {_row(new.inertia[np.triu_indices(3)])}",
    }[what]

    def edit(d: Description, items: Sequence[str]) -> Description:
        return d.with_bodies(lambda b: replace(b, mass=new.mass, com=new.com, inertia=new.inertia), (link,))

    fix = f"compare the {what} of {link} with the file"
    return Hypothesis(
        "one_link", "a link has another " + what, INERTIAL, "edit", edit, fix, (link,), words, cost, single=True
    )


def _row(x: np.ndarray) -> str:
    return "(" + ", ".join(f"{v + 0.0:.5g}" for v in x) + ")"


# --- one body: all ten ---------------------------------------------------------------------------


def _body(case: Case, joint: str, delta: np.ndarray) -> Hypothesis:
    old = np.array([float(x) for x in case.robot.joint(joint).inertia.parameters])
    size = max(1e-12, float(np.abs(delta).max()))
    names = ("mass", "m cx", "m cy", "m cz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
    words = [f"{n} {a:.5g} -> {a + d:.5g}" for n, a, d in zip(names, old, delta, strict=True) if abs(d) > 1e-7 * size]

    def edit(d: Description, items: Sequence[str]) -> Description:
        return d.with_parts(lambda p, _: replace(p, more=p.more + delta) if p.joint == joint else p)

    says = "the body has other inertial parameters (about the joint's moving frame)"
    fix = "compare the mass, centre and inertia of the links that this joint moves with the file"
    return Hypothesis(
        "one_link", says, INERTIAL, "edit", edit, fix, (joint,), ", ".join(words), FITTED_ITEM, single=True
    )
