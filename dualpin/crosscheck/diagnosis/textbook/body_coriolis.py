"""The Coriolis matrix by composite bodies, in six-vectors.

    B = (1/2) (v x* I + (I v) bar - I v x)      h bar u = u x* h      Sdot = v x S
    I^C, B^C are summed from the tips:  I^C_p += X^T I^C X,  B^C_p += X^T B^C X
    f1 = I^C Sdot + B^C S     f2 = I^C S     f3 = B^C^T S     C_ii = S^T f1
    f = X^T f  down to the root:   C_ji = S_j^T f1     C_ij = Sdot_j^T f2 + S_j^T f3

References: Echeandia and Wensing, Numerical methods to compute the Coriolis matrix and Christoffel symbols for
rigid-body systems, Journal of Computational and Nonlinear Dynamics 16 (2021), algorithm 1.
"""

from __future__ import annotations

import numpy as np

from ...subjects.layout import product, transposed
from .plucker import Coordinates, Model, links, to_parent, to_parent_inertia
from .products import crf, crm
from .spatial import velocities
from .steps import HAVE, Steps
from .tree import Link, Tree, filled

ONE = np.eye(6)


def matrix(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, of: Coordinates = links) -> np.ndarray:
    """C (runs, samples, nv, nv)."""
    m, zero = of(steps, tree, q), np.zeros((*q.shape[:-1], 6))
    vs = velocities(steps, tree, m, v, zero)
    I = [x + zero[..., None] for x in m.I]
    B = [_of_body(steps, x, u) for x, u in zip(I, vs, strict=True)]
    count = len(tree.links) - 1
    for k in reversed(tree.links[1:]):
        x = to_parent_inertia(steps, "a child's inertia, X^T I X,", m.X[k.number], I[k.number])
        x = steps.summed("the inertia that children hand on", x, **tree.alone(k, x))
        x = steps.part("the links that hand on their inertia", x, k.number - 1, count)
        I[k.parent] = steps.add("the composite inertia", **{HAVE: I[k.parent], "X^T I X of the child": x})
        y = to_parent_inertia(steps, "a child's B, X^T B X,", m.X[k.number], B[k.number])
        y = steps.summed("the B that children hand on", y, **tree.alone(k, y))
        y = steps.part("the links that hand on their B", y, k.number - 1, count)
        B[k.parent] = steps.add("the composite B", **{HAVE: B[k.parent], "X^T B X of the child": y})
    rows: dict[tuple[int, int], np.ndarray] = {}
    rates = {k.number: rate(steps, vs[k.number], m.S[k.number]) for k in tree.links if k.moves}
    own = ONE if m.base is None else transposed(m.base)  # the base's columns, as rows
    for k in (k for k in tree.links if k.moves):
        _column(steps, tree, k, m, I[k.number], B[k.number], rates, vs[0], own, rows)
    if tree.floating:
        S_rate = transposed(rate(steps, vs[0][..., None, :], own))
        S = transposed(own + 0 * I[0])
        block = steps.add("I^C Sdot + B S", **{"I^C Sdot": I[0] @ S_rate, "B S": B[0] @ S})
        block = transposed(S) @ block
        rows |= {(i, j): block[..., i, j] for i in range(6) for j in range(6)}
    return filled(rows, tree.nv, q)


def rate(steps: Steps, v: np.ndarray, S: np.ndarray) -> np.ndarray:
    """Sdot = v x S."""
    return crm(steps, "Sdot = v x S", v, S)


def _of_body(steps: Steps, I: np.ndarray, v: np.ndarray) -> np.ndarray:
    """B of a body, with B v = v x* I v."""
    by_columns = transposed(crf(steps, "B", v[..., None, :], transposed(I)))  # v x* I
    motion = transposed(crm(steps, "B", v[..., None, :], ONE + 0 * I))
    h = product(I, v)
    bar = transposed(crf(Steps(), "", ONE + 0 * I, h[..., None, :]))
    halves = {
        "that with the other sign of the moment": h * np.repeat([-1.0, 1.0], 3),
        "that with the other sign of the force": h * np.repeat([1.0, -1.0], 3),
    }  # fmt: skip
    wrong = {name: transposed(crf(Steps(), "", ONE + 0 * I, x[..., None, :])) for name, x in halves.items()}
    bar = steps.pick("(I v) bar", bar, **wrong)
    terms = {"v x* I": 0.5 * by_columns, "(I v) bar": 0.5 * bar, "-I v x": -0.5 * I @ motion}
    B = steps.add("B of a body", **terms)
    others = {"v x* I, with the same C v": by_columns, "(I v) bar, with the same C v": bar, "not halved": 2 * B}
    return np.asarray(steps.pick("the matrix B", B, **others))


def _column(
    steps: Steps, tree: Tree, k: Link, m: Model, I: np.ndarray, B: np.ndarray, rates: dict[int, np.ndarray],
    v_base: np.ndarray, base: np.ndarray, rows: dict[tuple[int, int], np.ndarray],
) -> None:  # fmt: skip
    """The entries of a joint with itself and with those below it."""
    S = m.S[k.number] + 0 * I[..., 0]
    B_S = product(steps.pick("B in B S", B, **{"its transpose": lambda: transposed(B)}), S)
    forces = {"I^C Sdot": product(I, rates[k.number]), "B S": B_S}
    f1, f2 = steps.add("I^C Sdot + B S", **forces), product(I, S)
    f3 = product(steps.transpose("B in B^T S", B), S)
    rows[k.column, k.column] = (m.S[k.number] * f1).sum(-1)
    at = k
    while at.parent >= 0:
        f1, f2, f3 = (to_parent(steps, f"f, carried down as X^T f: {n}", m.X[at.number], f) for n, f in
                      (("I^C Sdot + B S", f1), ("I^C S", f2), ("B^T S", f3)))  # fmt: skip
        at = tree.links[at.parent]
        if at.moves:
            rows[at.column, k.column] = (m.S[at.number] * f1).sum(-1)
            left = {"Sdot^T I^C S": (rates[at.number] * f2).sum(-1), "S^T B^T S": (m.S[at.number] * f3).sum(-1)}
            rows[k.column, at.column] = steps.add("C below the diagonal", **left)
    if tree.floating:
        S_rate = rate(steps, v_base[..., None, :], base)
        left = {"Sdot^T I^C S": product(S_rate, f2), "S^T B^T S": product(base, f3)}
        below, right = steps.add("C below the diagonal", **left), product(base, f1)
        rows |= {(i, k.column): right[..., i] for i in range(6)} | {(k.column, i): below[..., i] for i in range(6)}
