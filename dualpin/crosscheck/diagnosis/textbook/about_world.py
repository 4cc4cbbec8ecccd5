"""The mass matrix by composite bodies about the origin of the world: mass, first moment and inertia there.

    m^c = sum m     h^c = sum m c     J^c = sum I + m (c.c 1 - c c^T)                      of what a joint carries
    turning: u = o x z,  f = m^c u + z x h^c,  n = J^c z + h^c x u      sliding: f = m^c z,  n = h^c x z
    M_ij = z_i . (n_j - o_i x f_j)  of a turning joint i,   z_i . f_j  of a sliding one

References: Walker and Orin, Efficient dynamic computer simulation of robotic mechanisms (1982), method 3;
Featherstone, Rigid Body Dynamics Algorithms (2008), section 6.2.
"""

from __future__ import annotations

import numpy as np

from ...subjects.layout import product
from .about_centres import ALONG_MOVING, FELT, own_lump
from .arrays import cross
from .products import wedge
from .references import joined
from .steps import HANDING, HAVE, Steps
from .tree import MOVERS, Link, Pose, Tree, filled, in_turn
from .turns import ONE
from .weighted import steiners

KINDS = ("mass and first moment", "mass and first moment", "inertia")
"""Of what links hand on: codes often sum the first two once, for several uses."""
Lump = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Mass (..., 1), first moment and inertia."""


def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
    """M (runs, samples, nv, nv)."""
    poses = tree.poses(q)
    alone = [own_lump(steps, tree, k, q) for k in tree.links]
    own = [_own(steps, *lump, poses[k.number]) for k, lump in zip(tree.links, alone, strict=True)]
    lumps = _composites(steps, tree, poses, own, [I for _, _, I in alone])
    axes = [(k, _axis(steps, k, poses[k.number]), poses[k.number].p0) for k in tree.links if k.moves]
    entries: dict[tuple[int, int], np.ndarray] = {}
    for k, z, o in axes:
        n, f = in_turn(steps, tree, k, MOVERS, *_unit(steps, k, z, o, lumps[k.number], own[k.number]))
        for at, y, p in axes:
            if at is k or at in tree.joints_of(k):
                x = _felt(steps, at, y, p, n, f, k.slides, z)
                far = at is not k and at is not tree.joints_of(k)[-2]
                wrong = {"left out, so that only neighbours are coupled": x * (not far)}
                x = steps.pick("an entry of H beyond the parent", x, **wrong)
                entries[at.column, k.column] = entries[k.column, at.column] = x
    return filled(entries, tree.nv, q)


def _axis(steps: Steps, k: Link, pose: Pose) -> np.ndarray:
    """Of a joint, in the world; named as in a column of a Jacobian."""
    z = steps.turn(f"the axis of a column: of {'sliding' if k.slides else 'turning'} joints", pose.turns_axis, k.z)
    frame = {f"that of the link's {x} axis": pose.R0[..., i] for i, x in enumerate("xyz")}
    return np.asarray(steps.pick("the direction in a column, of joints,", z, **frame))


def _own(steps: Steps, m: np.ndarray, c: np.ndarray, I: np.ndarray, pose: Pose) -> Lump:
    """Of a link alone, from its mass, its centre and its inertia about that."""
    at = steps.pick("the place of a body, in Steiner's term,", c, **{"its link's origin": pose.p0 + 0 * c})
    outer = at[..., :, None] * at[..., None, :]
    far = {"m c.c 1": m[..., None] * (at * at).sum(-1)[..., None, None] * ONE, "-m c c^T": -m[..., None] * outer}
    terms = {"that about its centre": I, "m (c.c 1 - c c^T)": steps.add("Steiner's term, to the world's origin", **far)}
    places = {"m times the link's origin": lambda: m * pose.p0, "c, without its mass": lambda: c + 0 * m}
    h = steps.pick("the first moment of a body, m c,", m * c, **places)
    return m, h, steps.add("a body's inertia about the world's origin", **terms)


def _composites(
    steps: Steps, tree: Tree, poses: list[Pose], own: list[Lump], central: list[np.ndarray]
) -> list[Lump]:  # fmt: skip
    """Of every link, with all that it carries; `central` are inertias about links' own centres."""
    found = list(own)
    for k in reversed(tree.links[1:]):
        (M, H, T), pose = found[k.parent], poses[k.number]
        m, h, I = (
            steps.part(
                f"{HANDING}: {what}",
                steps.pick(f"what a child hands on: {what}", x, **{"its own alone, not what it carries": alone}),
                k.number - 1, len(tree.links) - 1,
            )
            for what, x, alone in zip(KINDS, found[k.number], own[k.number], strict=True)
        )  # fmt: skip
        others = {
            "the child's own alone": own[k.number][1], "its composite mass at its own centre": (
                lambda m=m, k=k, pose=pose: m * (pose.p0 + product(pose.R0, k.c + 0 * pose.p0))
            ),
        }  # fmt: skip
        h = steps.pick("the first moment that a child hands on", h, **others)
        m, I = (
            steps.pick(f"the {what} that a child hands on", x, **{"the child's own alone": own[k.number][i]})
            for what, x, i in (("mass", m, 0), ("inertia", I, 2))
        )
        m, h, I = (
            steps.part(f"the links that hand on their {what}", x, k.number - 1, len(tree.links) - 1)
            for what, x in (("mass", m), ("first moment", h), ("inertia", I))
        )
        m, h, I = (
            steps.summed(f"the {what} that children hand on", x, **tree.alone(k, x))
            for what, x in (("mass", m), ("first moment", h), ("inertia", I))
        )
        mass = steps.add("the composite mass", **{HAVE: M, "the child's m": m})
        moment = steps.add("the composite first moment", **{HAVE: H, "the child's h": h})
        whole = steps.add("the composite inertia", **{HAVE: T, "the child's I": I})
        lost = {"that about its own centre, and the last child's": central[k.parent] + I}
        found[k.parent] = mass, moment, steps.pick("the composite inertia of a parent", whole, **lost)
    return found


def _unit(steps: Steps, k: Link, z: np.ndarray, o: np.ndarray, lump: Lump, own: Lump) -> tuple[np.ndarray, np.ndarray]:
    """Moment about the world's origin, and force, of a unit acceleration of a joint."""
    kind = "of a sliding joint" if k.slides else "of a turning joint"
    m, _, I = parts = [
        steps.pick(f"the composite {what} that a joint moves: {kind}", x, **{"the link's own": y})
        for what, x, y in zip(("mass", "first moment", "inertia"), lump, own, strict=True)
    ]
    n, f = (_of_sliding if k.slides else _of_turning)(steps, z, o, *parts)

    def of_own() -> np.ndarray:
        c = own[1] / np.where(own[0] == 0, 1.0, own[0])
        push = m * (z + 0 * c if k.slides else cross(z + 0 * c, c - o))
        about = 0 * c if k.slides else product(I - steiners(m[..., 0], c), z)
        return joined([about + cross(c, push), push], -1)

    wrong = {"the link's own": of_own}
    both = steps.pick("the centre of a composite that a joint moves", joined([n, f], -1), **wrong)
    return both[..., :3], both[..., 3:]


def _of_sliding(
    steps: Steps, z: np.ndarray, o: np.ndarray, m: np.ndarray, h: np.ndarray, I: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    n = steps.add("the moment of a sliding joint's unit acceleration", **{"h x z": wedge(steps, h, z + 0 * h)})
    return n, steps.add("the force of a sliding joint's unit acceleration", **{"m z": m * z})


def _of_turning(
    steps: Steps, z: np.ndarray, o: np.ndarray, m: np.ndarray, h: np.ndarray, I: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    still = {"0": 0 * h}
    u = steps.pick("the velocity of the world's origin, o x z,", wedge(steps, o + 0 * z, z + 0 * o), **still)
    terms = {"m u": m * u, "z x h": wedge(steps, z + 0 * h, h + 0 * z)}
    f = steps.add("the force of a turning joint's unit acceleration", **terms)
    terms = {"I z": product(I, z), "h x u": wedge(steps, h + 0 * u, u + 0 * h)}
    return steps.add("the moment of a turning joint's unit acceleration", **terms), f


def _felt(
    steps: Steps, k: Link, z: np.ndarray, o: np.ndarray, n: np.ndarray, f: np.ndarray, moved: bool,
    of_moving: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """What a joint feels of it; `moved` says whether the joint that moves slides, whose axis is the last one."""
    moment = steps.add("the moment about a joint", **{"n": n, "-o x f": -wedge(steps, o + 0 * f, f + 0 * o)})
    turning, sliding = (z * moment).sum(-1), (z * f).sum(-1)
    right, other = (sliding, turning) if k.slides else (turning, sliding)
    kind, another = ("sliding", "turning") if k.slides else ("turning", "sliding")
    others = {f"that of a {another} one": other, "of the kind of the joint that moves": sliding if moved else turning}
    others[ALONG_MOVING] = (of_moving * (f if k.slides else moment)).sum(-1)
    return np.asarray(steps.pick(f"{FELT}: of a {kind} one", right, **others))
