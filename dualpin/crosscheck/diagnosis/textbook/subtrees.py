"""The centre of mass's Jacobian and gravity's torques by what each joint carries, handed down from link to link.

    m^c = sum m     h^c = sum m c     of what a joint carries         J_G = z x (h^c / m^c - o) m^c / M   (turning)

References: Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.14.
"""

from __future__ import annotations

import numpy as np

from ...subjects.layout import product, transposed
from .poses import stacked
from .products import wedge
from .steps import HANDING
from .weighted import Sums


def com_jacobian(sums: Sums) -> np.ndarray:
    """Column by column: z x (c - o) m / M, of all bodies that a joint carries together."""
    steps, cols = sums.steps, sums.columns
    whole, alone, near = _subtrees(sums), _subtrees(sums, children=()), _subtrees(sums, near=True)
    whole = tuple(
        steps.pick("what a child hands on", x, **{"its own alone, not what it carries": y})
        for x, y in zip(whole, near, strict=True)
    )
    carried = {
        "its links' own, and of each child all mass at the child's own centre": _subtrees(sums, at_children=True),
        "its links' own, and those of the last child alone": _subtrees(sums, children=(-1,)),
        "its links' own, and those of the first child alone": _subtrees(sums, children=(0,)),
    }  # fmt: skip
    each = "its links' own, and that of each child alone"
    moments = {words: x[1] for words, x in carried.items()} | {each: near[1]}
    moment = steps.pick("the first moment of what a joint carries", whole[1], **moments)
    masses = {words: x[0] for words, x in list(carried.items())[1:]} | {each: near[0]}
    mass, single = steps.pick("the mass that hangs on a joint", whole[0], **masses), alone[0]
    c = steps.pick(
        "the centre of what a joint carries", moment / np.where(mass > 0, mass, 1.0),
        **{"the centre of the whole robot": sums.com[..., None, :] + 0 * moment, "not divided by its mass": moment,
           "the centre of its own link": alone[1] / np.where(single > 0, single, 1.0)},
    )  # fmt: skip
    others = {
        "that of the whole robot": 0 * mass + sums.m.sum(-1)[..., None, None], "that of its own link": single,
        "1": 0 * mass + 1,
    }  # fmt: skip
    m, along = (
        steps.pick(f"the mass of what a joint carries: of {kind} joints", mass, **others)
        for kind in ("turning", "sliding")
    )
    r = steps.add("the lever arm of what a joint carries", **{"its centre": c, "the joint's origin": -cols.o})
    lever = steps.add("the linear velocity of what a joint carries", **{"z x r": wedge(steps, cols.z + 0 * r, r)})
    turns = cols.turns[:, None]
    moved = steps.pick("m r of what a joint carries", m * lever, **{
        "sum m c, less its own link's m times the joint's origin":
            lambda: wedge(steps, cols.z + 0 * r, moment - single * cols.o),
        "sum m c, less the joint's origin without a mass": lambda: wedge(steps, cols.z + 0 * r, moment - cols.o),
    })  # fmt: skip
    J = (turns * moved + (1 - turns) * along * cols.z) / sums.mass[..., None]
    return cols.reduced(transposed(J)[..., None, :, :])[..., 0, :, :]


def gravity(sums: Sums, g: np.ndarray) -> np.ndarray:
    """The torques that hold the robot at rest: -M J_G^T g, M the whole mass."""
    torques = -(com_jacobian(sums) * g[:, None]).sum(-2) * sums.total
    return np.asarray(sums.steps.add("gravity's torques", **{"-M J_G^T g": torques}))


def _subtrees(
    sums: Sums, children: tuple[int, ...] | None = None, at_children: bool = False, near: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Mass (runs, 1 or n, axes, 1) and first moment (runs, n, axes, 3) of what each joint carries.

    Of `children`, those at these places of the list count, by default all; `at_children` says that all that a child
    carries has the child's own centre, `near` that of a child only what is its own counts.
    """
    t = sums.poses
    masses, moments = [0 * sums.m[..., :1]] * len(t.p), [0 * x for x in t.p]
    for i, k in enumerate(sums.links):
        masses[k], moments[k] = sums.m[..., i, None], sums.m[..., i, None] * sums.c[..., i, :]
    own = list(masses), list(moments)
    count = len(t.p) - 1
    shares = [sums.steps.part(HANDING, np.ones((1, 1, 1)), j - 1, count) for j in range(len(t.p))]
    below = [[j for j, up in enumerate(t.parent) if up == k] for k in range(len(t.p))]
    for k in reversed(range(len(t.p))):
        some = below[k] if children is None else [below[k][i] for i in children if below[k]]
        for j in some:
            there = t.p[j] + product(t.R[j], t.centre(j) + 0 * t.p[j])
            mass, moment = (x[j] for x in (own if near else (masses, moments)))
            moments[k] = moments[k] + shares[j] * (mass * there if at_children else moment)
            masses[k] = masses[k] + shares[j] * mass
    links = [a.link for a in t.axes]
    return stacked(masses, links, 1), stacked(moments, links, 1)
