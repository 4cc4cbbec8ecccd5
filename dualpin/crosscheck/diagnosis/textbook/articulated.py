"""Articulated bodies: forward dynamics in three passes.

    outward:  v = X v_p + S qd     c = v x S qd     I^A = I     p^A = v x* I v
    inward:   U = I^A S     D = S^T U     u = tau - S^T p^A
              I^a = I^A - U D^-1 U^T      p^a = p^A + I^a c + U D^-1 u      (I^A_p += X^T I^a X, p^A_p += X^T p^a)
    outward:  a' = X a_p + c     qdd = D^-1 (u - U^T a')     a = a' + S qdd

References: Featherstone, Rigid Body Dynamics Algorithms (2008), table 7.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .assembly import MOST_STEPS, derivatives, solved
from .in_place import array, repeated
from .link_axes import gathered, of_joint
from .plucker import Coordinates, Model, brought, links, of_others, to_parent, to_parent_inertia
from .products import crf, crm
from .pushes import Wrenches, torques, wrenches
from .spatial import OF_FIXED, at_origins, gravity, hand_on, on_links, start, velocities
from .steps import HANDING, HAVE, Steps
from .sums import DAMPED
from .tree import Link, Tree, tree_of


@dataclass
class Body:
    """What the passes leave of a link: its Coriolis acceleration, and U, D and u of its joint."""

    c: np.ndarray
    U: np.ndarray
    D: np.ndarray
    u: np.ndarray


def forward(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, tau: np.ndarray, g: np.ndarray, of: Coordinates = links,
    pushes: Wrenches | None = None, told: bool = False,
) -> np.ndarray:  # fmt: skip
    """The accelerations (runs, samples, nv) of the torques, under the gravity g and wrenches on links."""
    m = of(steps, tree, q)
    zero = np.zeros((*q.shape[:-1], 6), np.result_type(q, v, tau))
    vs = velocities(Steps(), tree, of(Steps(), tree, q), v, zero) if told else velocities(steps, tree, m, v, zero)
    c, p, I = _first(steps, tree, m, at_origins(steps, tree, q, vs) if m.common else vs, v, zero)
    if pushes:
        p = [own + pushed for own, pushed in zip(p, on_links(steps, tree, m, q, pushes), strict=True)]
    bodies: dict[int, Body] = {}
    for k in reversed(tree.links[1:]):
        _inward(steps, tree, k, m, c[k.number], p, I, tau, bodies)
    return _last(steps, tree, m, bodies, p, I, tau, gravity(steps, g) + zero)


def _first(
    steps: Steps, tree: Tree, m: Model, vs: list[np.ndarray], v: np.ndarray, zero: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray], list[np.ndarray]]:
    c = [zero]
    for k in tree.links[1:]:
        c_k = zero
        if k.moves:
            S_qd = m.S[k.number] * v[..., k.column, None]
            v_c = steps.pick("the velocity in v x S qd", vs[k.number], **{"the parent's, in its axes": vs[k.parent]})
            which = "of sliding joints" if k.slides else "of turning joints"
            c_k = steps.add(
                f"the velocity product of a joint: {which}", **{"v x S qd": crm(steps, "v x S qd", v_c, S_qd)}
            )
        c.append(c_k)
    whole = repeated([c[k.number] for k in tree.links if k.moves])
    c = [steps.pick(array("v x S qd"), x, **whole) for x in c]
    I = [x + np.zeros((*zero.shape[:-1], 6, 6)) for x in m.I]
    p = []
    for k in tree.links:
        others = {"that of the parent": vs[max(0, k.parent)], **tree.near(k, lambda x: vs[x.number])}
        sides = ("its first", "its second")
        first, second = (steps.pick(f"the velocity in v x* I v: {x}", vs[k.number], **others) for x in sides)
        spin = crf(steps, "v x* I v", first, product(I[k.number], second))
        p.append(steps.add("the bias force p^A", **{"v x* I v": spin}))
    return c, p, I


def _inward(
    steps: Steps, tree: Tree, k: Link, m: Model, c: np.ndarray, p: list[np.ndarray], I: list[np.ndarray],
    tau: np.ndarray, bodies: dict[int, Body],
) -> None:  # fmt: skip
    IA, pA, own_inertia, X = I[k.number], p[k.number], m.I[k.number], m.X[k.number]
    Ia, pa = IA, pA
    if not k.moves:
        Ia, pa = (
            steps.pick(f"{OF_FIXED}: its {what}", x, nothing=0 * x)
            for what, x in (("articulated inertia", IA), ("articulated bias force", pA))
        )  # fmt: skip
    else:
        S = m.S[k.number]
        U = product(IA, S)
        D = (S * U).sum(-1)[..., None] + tree.rotors[k.column]
        alone = (S * product(own_inertia, S)).sum(-1)[..., None]
        others = {"S^T I S, of the link alone": alone + 0 * D, "1": 0 * D + 1}
        others |= {f"with {x:g} added": D + x for x in DAMPED}
        D = steps.pick("D of articulated bodies", D, **others)
        torque = of_joint(steps, tree, k, tau, "torque")
        u = steps.add("u of articulated bodies", **{"tau": torque, "-S^T p^A": -(S * pA).sum(-1)[..., None]})
        bodies[k.number] = Body(c, U, D, u)
        square = U[..., :, None] * U[..., None, :]
        outer = steps.pick("U D^-1 U^T", square / D[..., None], **{"not divided by D": square})
        Ia = steps.add("the articulated inertia I^a", **{"I^A": IA, "-U D^-1 U^T": -outer})
        others = {"I^A": IA, "the link's own": own_inertia + 0 * IA, "1": np.eye(6) + 0 * IA}
        I_c = steps.pick("the articulated inertia in I^a c", Ia, **others)
        pa = steps.add(
            "the articulated bias force p^a",
            **{
                "p^A": pA,
                "I^a c": product(I_c, c),
                "U D^-1 u": steps.pick("U D^-1 u", U * u / D, **{"not divided by D": U * u}),
            },
        )
    last, count = k.number - 1, len(tree.links) - 1
    Ia = steps.pick("the articulated inertia that is handed on", Ia, **{"I^A, not reduced": IA + 0 * Ia})
    I_up = to_parent_inertia(steps, "a child's inertia, X^T I^a X,", X, Ia)
    I_up = steps.part("the links that hand on their inertia", I_up, last, count)
    I_up = steps.summed("the inertia that children hand on", I_up, **tree.alone(k, I_up))
    p_up = to_parent(steps, "a child's bias force, X^T p^a,", X, pa, of_others(tree, m, k))
    p_up = steps.summed("the bias force that children hand on", p_up, **tree.alone(k, p_up))
    p_up = steps.part("the links that hand on their bias force", p_up, last, count)
    I_up, p_up = (
        steps.part(HANDING, steps.pick("what a link hands on", x, nothing=0 * x), last, count) for x in (I_up, p_up)
    )
    up = k.parent
    I_whole = steps.add("the articulated inertia I^A of a parent", **{HAVE: I[up], "X^T I^a X": I_up})
    p_whole = steps.add("the articulated bias force p^A of a parent", **{HAVE: p[up], "X^T p^a": p_up})
    hand_on(steps, k, "inertia and bias force", I, I_whole, I_up)
    hand_on(steps, k, "inertia and bias force", p, p_whole, p_up)


def _last(
    steps: Steps, tree: Tree, m: Model, bodies: dict[int, Body], p: list[np.ndarray], I: list[np.ndarray],
    tau: np.ndarray, down: np.ndarray,
) -> np.ndarray:  # fmt: skip
    acc, base = [-down], []
    if tree.floating:
        S = np.eye(6)[None, None] if m.base is None else m.base
        push = steps.add(
            "the force that moves the base", **{"tau": tau[..., :6], "-p^A": -product(transposed(S), p[0])}
        )
        a0 = solved(transposed(S) @ I[0] @ S, push[..., None])[..., 0]
        up = brought(steps, "gravity, in world axes,", m.X[0], -down, plain=True)
        up = up if m.base is None else product(np.linalg.inv(m.base), up)
        acc, base = [product(S, a0)], [steps.add("the base's acceleration", **{"I^-1 (tau - p)": a0, "g": -up})]
    columns: dict[int, np.ndarray] = {}
    for k in tree.links[1:]:
        a_up = start(steps, tree, k, acc, "acceleration")
        a_k = brought(steps, "the parent's acceleration", m.X[k.number], a_up, beside=of_others(tree, m, k))
        if k.moves:
            b = bodies[k.number]
            a_up = a_k
            a_k = steps.add("a' of articulated bodies", **{"X a of the parent": a_k, "c": b.c})
            a_U = steps.pick(
                "the acceleration in U^T a'",
                a_k,
                **{"the parent's, in its own axes": acc[k.parent], "X a_p, without c": a_up},
            )
            needed = steps.add("D qdd of articulated bodies", **{"u": b.u, "-U^T a'": -(b.U * a_U).sum(-1)[..., None]})
            qdd = steps.pick("D^-1 (u - U^T a')", needed / b.D, **{"not divided by D": needed})
            columns[k.column] = qdd[..., 0]
            a_k = steps.add("the acceleration of a link", **{"a'": a_k, "S qdd": m.S[k.number] * qdd})
        acc.append(a_k)
    return gathered(columns, base, tau)


@dataclass(frozen=True)
class Articulated:
    """The terms that forward dynamics answers; `fused` as of `Tree`."""

    fused: bool = False
    of: Coordinates = links
    """In which coordinates."""
    inside: bool = False
    """Whether wrenches are taken from the bias forces of links, not from the torques."""
    told: bool = False
    """Whether velocities of links are told by a recursion of their own: right, whatever the screws are."""

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        return self.answer(view, term, steps, tree_of(view, self.fused))

    def answer(self, view: View, term: str, steps: Steps, tree: Tree) -> np.ndarray | None:
        """The term, of this tree."""
        q, v, tau = (view.states[k][None] for k in ("q", "v", "tau"))
        g = tree.gravity
        solve = partial(forward, of=self.of, told=self.told)
        if term == "aba":
            return solve(steps, tree, q, v, tau, g)
        if term == "minv":
            return tree.columns(solve(steps, tree, *tree.unit(q), np.zeros((1, 1, 3))))
        if term == "aba_f_ext" and self.inside:
            q, pushes = wrenches(steps, tree, view)
            count = len(view.frames)
            x = solve(steps, tree, q, np.repeat(v, count, axis=1), np.repeat(tau, count, axis=1), g, pushes=pushes)
            return x.reshape(len(x), -1, count, tree.nv)
        if term == "aba_f_ext":
            pushed = tau[:, :, None] + torques(tree, view)
            n = pushed.shape[2]
            moved = pushed.reshape(len(pushed), -1, tree.nv)
            x = solve(steps, tree, np.repeat(q, n, axis=1), np.repeat(v, n, axis=1), moved, g)
            return x.reshape(len(x), -1, n, tree.nv)
        if term == "aba_derivatives" and not tree.floating and tree.nv <= MOST_STEPS:
            return derivatives(lambda q, v, tau: solve(steps, tree, q, v, tau, g), q, v, tau)
        return None
