"""Spatial (six-vector) algorithms: recursive Newton-Euler, and composite rigid bodies.

    v = X v_p + S qd      a = X a_p + S qdd + v x S qd      f = I a + v x* I v
    tau = S^T f           f_p += X^T f
    I^c_p += X^T I^c X    F = I^c S      H_ii = S^T F       F = X^T F  down to the root,  H_ij = F^T S_j

Six-vectors are [angular; linear], X = [E 0; -E r x  E] brings motions from the parent's axes into the link's.

References: Featherstone, Rigid Body Dynamics Algorithms (2008), tables 5.1 and 6.2, equations 2.24, 2.31 and 2.63.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ....spatial.adjoint import cross_matrix
from ....spatial.inertia import steiner
from ...subjects.layout import product, transposed
from .link_axes import FIRST, RESTING, axes, gathered, own_rates, rate_in_cross, unturned
from .products import crf, crm
from .pushes import Wrenches
from .steps import HAVE, Steps, cross
from .tree import Link, Pose, Tree, spatial


def forces(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
    """tau (runs, samples, nv) of velocities and accelerations, under the gravity g."""
    X = transforms(steps, tree, tree.poses(q))
    vs, accs = _motions(steps, tree, X, q, v, a, gravity(steps, g))
    f = [_needed(steps, tree, k, vs, accs) if k.mass > 0 else 0 * vs[0] for k in tree.links]
    return _inward(steps, tree, X, f, q)


def seen(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, frames: Sequence[str], term: str
) -> np.ndarray:
    """Velocities or accelerations of frames (runs, samples, frames, 6), at their origins in world axes."""
    poses, out = tree.poses(q), []
    vs, accs = _motions(steps, tree, transforms(steps, tree, poses), q, v, a, np.zeros((1, 1, 6)))
    for number, r in (tree.frames[frame] for frame in frames):
        R, (w, u), (alpha, acc) = poses[number].R0, *((x[..., :3], x[..., 3:]) for x in (vs[number], accs[number]))
        speed = steps.add("the velocity of a frame", **{"that of the link's origin": u, "w x r": cross(w, r)})
        if term == "frame_velocity":
            linear, angular, what = speed, w, "the velocity of a frame, in its link's axes"
        else:
            terms = {"the spatial one": acc, "alpha x r": cross(alpha, r), "w x v": cross(w, speed)}
            linear, angular = steps.add("the acceleration of a frame's origin", **terms), alpha
            what = "the acceleration of a frame, in its link's axes"
        halves = ((f"{what}: its angular part", angular), (f"{what}: its linear part", linear))
        out.append(np.concatenate(np.broadcast_arrays(*(steps.turn(site, R, x) for site, x in halves)), -1))
    lead = np.broadcast_shapes(*(x.shape for x in out))
    return np.stack([np.broadcast_to(x, lead) for x in out], axis=2)


def _motions(
    steps: Steps, tree: Tree, X: list[np.ndarray], q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Velocities and accelerations of links, in their own axes."""
    zero = np.zeros((*q.shape[:-1], 6), np.result_type(q, v, a))
    down = g + zero
    if tree.floating:
        up = steps.turn("gravity, in world axes,", X[0], -down)
        speed = v[..., :6] + zero
        # the rate of the base's spatial velocity has no w x v: what is given is the rate of its columns
        acc = steps.add("the acceleration of the base", **{"the given acceleration": a[..., :6], "-g": up})
        halves = {"that with its halves exchanged": speed[..., [3, 4, 5, 0, 1, 2]], RESTING: 0 * speed}
        speed = steps.pick("the velocity of a floating base", speed, **halves)
        turning = np.concatenate([0 * v[..., :3], cross(v[..., :3], v[..., 3:6])], -1)
        halves = {
            "that with its halves exchanged": a[..., [3, 4, 5, 0, 1, 2]] + up, RESTING: up,
            "that of its origin, with w x v": acc + turning,
        }  # fmt: skip
        acc = steps.pick("the acceleration of a floating base", acc, **halves)
    else:
        speed, acc = zero, -down
    vs, accs = [speed], [acc]
    for k in tree.links[1:]:
        v_k, a_k = _next(steps, tree, k, X[k.number], vs, accs, q, v, a)
        vs.append(v_k)
        accs.append(a_k)
    return vs, accs


def pushed(steps: Steps, tree: Tree, q: np.ndarray, wrenches: Wrenches) -> np.ndarray:
    """tau (runs, samples, nv) of wrenches on links."""
    poses, zero = tree.poses(q), np.zeros((*q.shape[:-1], 3))

    def of(k: Link) -> np.ndarray:
        force, moment = wrenches.get(k.number, (zero, zero))
        back = transposed(poses[k.number].R0)
        return np.concatenate(np.broadcast_arrays(product(back, moment), product(back, force)), -1)

    return _inward(steps, tree, transforms(steps, tree, poses), [of(k) for k in tree.links], q)


def _inward(steps: Steps, tree: Tree, X: list[np.ndarray], f: list[np.ndarray], q: np.ndarray) -> np.ndarray:
    """From the tips to the base: forces of links."""
    columns, own = dict[int, np.ndarray](), list(f)
    for k in reversed(tree.links):
        if k.moves:
            columns[k.column] = _along(steps, tree, k, f[k.number], own[k.number])
        if k.parent >= 0:
            handed = to_parent(steps, "the force that is handed on, X^T f,", X[k.number], f[k.number])
            handed = steps.summed("the force that children hand on", handed, **tree.alone(k, handed))
            handed = steps.part("the links that hand on their force", handed, k.number - 1, len(tree.links) - 1)
            f[k.parent] = steps.add("the force at a joint", **{HAVE: f[k.parent], "the child's X^T f": handed})
    return gathered(columns, [f[0]] if tree.floating else [], q)


def _next(
    steps: Steps,
    tree: Tree,
    k: Link,
    X: np.ndarray,
    vs: list[np.ndarray],
    accs: list[np.ndarray],
    q: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    known = len(vs)
    v_up, a_up = vs[k.parent], accs[k.parent]
    others = tree.near(k, lambda x: vs[x.number] if x.number < known else v_up)
    v_up = steps.pick("the velocity that a link starts from", v_up, **others)
    others = tree.near(k, lambda x: accs[x.number] if x.number < known else a_up)
    a_up = steps.pick("the acceleration that a link starts from", a_up, **others)
    v_k = next_velocity(steps, k, X, v_up, v)
    a_k = steps.turn("the parent's acceleration", X, a_up, **_inverses(X))
    if k.number in tree.first:
        wrong = unturned(k, tree.poses(q)[k.number], accs[0][..., 3:])
        a_k = steps.pick(FIRST, a_k, **{what: np.concatenate([0 * x, x], -1) for what, x in wrong.items()})
    if not k.moves:
        return v_k, a_k
    S = subspace(steps, k)
    S_qdd = S * own_rates(steps, tree, k, q, v, a)[1]
    S_qd = S * rate_in_cross(steps, tree, k, q, v, a)
    v_c = steps.pick("the velocity in v x S qd", v_k, **{"the parent's, in its axes": v_up})
    turning = crm(steps, "v x S qd", v_c, S_qd)
    terms = {"X a of the parent": a_k, "v x S qd": turning, "S qdd": S_qdd}
    return v_k, steps.add("the acceleration of a link", **terms)


def next_velocity(steps: Steps, k: Link, X: np.ndarray, v_up: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The velocity of a link, of its parent's."""
    v_k = steps.turn("the parent's velocity", X, v_up, **_inverses(X))
    if not k.moves:
        return v_k
    S_qd = subspace(steps, k) * v[..., k.column, None]
    return np.asarray(steps.add("the velocity of a link", **{"X v of the parent": v_k, "S qd": S_qd}))


def _inverses(X: np.ndarray) -> dict[str, Callable[[], np.ndarray]]:
    """What may stand in the place of X."""
    return {"by the inverse": lambda: np.linalg.inv(X), "as a force, by X^-T": lambda: transposed(np.linalg.inv(X))}


def _needed(steps: Steps, tree: Tree, k: Link, vs: list[np.ndarray], accs: list[np.ndarray]) -> np.ndarray:
    I, v_k = inertia(steps, k), vs[k.number]
    v_up = vs[max(0, k.parent)]
    others = {"the parent's": v_up, **tree.near(k, lambda x: vs[x.number])}
    first, second = (steps.pick(f"the velocity in v x* I v: {x}", v_k, **others) for x in ("its first", "its second"))
    first, second = (
        steps.mistaken(f"v in v x* I v: {x}", y, a=accs[k.number])
        for x, y in (("its first", first), ("its second", second))
    )
    spin = crf(steps, "v x* I v", first, product(I, second))
    others = {"the parent's": accs[max(0, k.parent)], **tree.near(k, lambda x: accs[x.number])}
    a_k = steps.pick("the acceleration in I a", accs[k.number], **others)
    a_k = steps.mistaken("a in I a", a_k, v=v_k)
    f = steps.add("the force of a body", **{"I a": product(I, a_k), "v x* I v": spin})
    return np.asarray(steps.part("the forces of bodies", f, tree.bodies.index(k), len(tree.bodies)))


def _along(steps: Steps, tree: Tree, k: Link, f: np.ndarray, own: np.ndarray | None = None) -> np.ndarray:
    """S^T f; `own` is the force that the link itself needs."""
    half, other = (f[..., 3:], f[..., :3]) if k.slides else (f[..., :3], f[..., 3:])
    S = subspace(steps, k)
    right = (S * f).sum(-1)
    others = {"taken from the other half of f": (k.z * other).sum(-1), "zero": 0 * right}
    if own is not None:
        alone = (S * own).sum(-1) + 0 * right
        others |= {"that of the links beyond alone": right - alone, "that of its own link alone": alone}
    site = f"the force along a joint's axis, S^T f: of {'sliding' if k.slides else 'turning'} joints"
    felt = steps.pick(site, right, **others)
    along = {words: (z * half).sum(-1) for words, z in axes(np.eye(3)[None, None], "of the link's frame").items()}
    along |= {f"that of the {which} joint": (j.z * half).sum(-1) for which, j in tree.neighbours(k).items()}
    return np.asarray(steps.pick("the axis along which a joint feels force or moment", felt, **along))


def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
    """H (runs, samples, nv, nv) by composite rigid bodies."""
    X = transforms(steps, tree, tree.poses(q))
    own, I = composites(steps, tree, X, q)
    entries: dict[tuple[int, int], np.ndarray] = {}
    base = I[0]
    for k in (k for k in tree.links if k.moves):
        F = product(
            steps.pick("the composite inertia in F = I S", I[k.number], **{"the link's own": own[k.number]}),
            subspace(steps, k),
        )
        entries[k.column, k.column] = _along(steps, tree, k, F)
        step, at = "of the first step", k
        while at.parent >= 0:
            turned = to_parent(
                steps, f"the force F of composite bodies, carried down as X^T F: {step}", X[at.number], F
            )
            others = {
                "that of the next link down": lambda x=X[at.parent], y=F: _carried(x, y),
                "that of the first link, in every step": lambda x=X[k.number], y=F: _carried(x, y),
            }  # fmt: skip
            F = steps.pick("X in X^T F, by which a force is handed down,", turned, **others)
            far, step, at = step != "of the first step", "of further steps", tree.links[at.parent]
            if at.moves:
                of_column = {"that of the joint whose column it is": subspace(steps, k)}
                S = steps.pick("S in an entry of H, S_j^T F,", subspace(steps, at), **of_column)
                felt = (S * F).sum(-1)
                wrong = {"left out, so that only neighbours are coupled": felt * (not far)}
                felt = steps.pick("an entry of H beyond the parent", felt, **wrong)
                entries[k.column, at.column] = entries[at.column, k.column] = felt
        if tree.floating:
            for i in range(6):
                entries[k.column, i] = entries[i, k.column] = F[..., i]
    if tree.floating:
        entries |= {(i, j): base[..., i, j] for i in range(6) for j in range(6)}
    lead = np.broadcast_shapes(q.shape[:-1], *(x.shape for x in entries.values()))
    H = np.zeros((*lead, tree.nv, tree.nv), np.result_type(q, *entries.values()))
    for (i, j), x in entries.items():
        H[..., i, j] = x
    return H


def composites(
    steps: Steps, tree: Tree, X: list[np.ndarray], q: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray]]:  # fmt: skip
    """Inertias of links, and of each with all that it carries."""
    own = [inertia(steps, k) + np.zeros((*q.shape[:-1], 6, 6)) for k in tree.links]
    I = list(own)
    for k in reversed(tree.links[1:]):
        whole = steps.pick("the inertia of a child", I[k.number], **{"its own, without its children's": own[k.number]})
        x = steps.congruent("a child's inertia, X^T I X,", transposed(X[k.number]), whole)
        x = steps.summed("the inertia that children hand on", x, **tree.alone(k, x))
        x = steps.part("the links that hand on their inertia", x, k.number - 1, len(tree.links) - 1)
        I[k.parent] = steps.add("the composite inertia", **{HAVE: I[k.parent], "X^T I X of the child": x})
    return own, I


def momentum(steps: Steps, tree: Tree, q: np.ndarray, com: np.ndarray) -> np.ndarray:
    """The momentum about the centre of mass, in world axes, of unit velocities: (runs, samples, 6, nv)."""
    tiled, _, unit = tree.unit(q)
    X = transforms(steps, tree, tree.poses(tiled))
    zero = np.zeros((*tiled.shape[:-1], 6))
    vs = [unit[..., :6] + zero if tree.floating else zero]
    for k in tree.links[1:]:
        vs.append(next_velocity(steps, k, X[k.number], vs[k.parent], unit))
    h = [product(inertia(steps, k), v) for k, v in zip(tree.links, vs, strict=True)]
    for k in reversed(tree.links[1:]):
        handed = to_parent(steps, "the momentum that is handed on, X^T h,", X[k.number], h[k.number])
        h[k.parent] = steps.add(
            "the momentum of what a joint moves", **{HAVE: h[k.parent], "the child's X^T h": handed}
        )
    whole = to_parent(steps, "the momentum, in the base's axes,", X[0], h[0])
    n, p = whole[..., :3], whole[..., 3:]
    G = np.repeat(com, tree.nv, axis=1)
    n = steps.add("the momentum about the centre of mass", **{"that about the origin": n, "-c x p": -cross(G, p)})
    return tree.columns(np.concatenate(np.broadcast_arrays(n, p), -1))


def potential(steps: Steps, tree: Tree, q: np.ndarray, g: np.ndarray) -> np.ndarray:
    """-sum m g . c, g being the linear part of a six-vector."""
    down, poses = gravity(steps, g)[..., 3:], tree.poses(q)
    h = sum(k.mass * (poses[k.number].p0 + product(poses[k.number].R0, k.c)) for k in tree.carried)
    return np.asarray(-(down * h).sum(-1))


def _carried(X: np.ndarray, F: np.ndarray) -> np.ndarray:
    return product(transposed(X), F) if X.shape[-1] == F.shape[-1] else F


def gravity(steps: Steps, g: np.ndarray) -> np.ndarray:
    """As a six-vector."""
    others = {"in the angular rows": np.concatenate([g, 0 * g], -1), "in both halves": np.concatenate([g, g], -1)}
    return np.asarray(steps.pick("gravity as a six-vector", np.concatenate([0 * g, g], -1), **others))


# --- what both need ------------------------------------------------------------------------------


def transforms(steps: Steps, tree: Tree, poses: Sequence[Pose]) -> list[np.ndarray]:
    """X of every link, from the parent's axes into its own."""
    return [_transform(steps, k, pose) for k, pose in zip(tree.links, poses, strict=True)]


def _transform(steps: Steps, k: Link, pose: Pose) -> np.ndarray:
    exchanged = "-[r x] E, in the other order, of the joint's motion and of its placement"
    return transform(steps, pose.R, pose.p, "of joints", **{exchanged: lambda: _exchanged(k, pose)})


def transform(
    steps: Steps, R: np.ndarray, p: np.ndarray, which: str = "of frames", **others: Callable[[], np.ndarray]
) -> np.ndarray:  # fmt: skip
    """X to what stands at R, p; `others` are other blocks below."""
    E, r = steps.pick(f"E of X: {which}", transposed(R), **{"R itself, not transposed": R}), cross_matrix(p)
    wrong = {
        "E [r x], with the other sign": E @ r, "-[r x] E, in the other order": -r @ E, "left out": 0 * (E @ r),
        "-[r x], without E": -r + 0 * E, "[r x], without -E": r + 0 * E, "-E^T [r x]": -transposed(E) @ r,
        "-E [r x] with the two multiplied entry by entry": -E * r, **others,
    }  # fmt: skip
    lower = steps.pick(f"the block -E [r x] of X: {which}", -E @ r, **wrong)
    lead = np.broadcast_shapes(E.shape, lower.shape)
    E, lower = np.broadcast_to(E, lead), np.broadcast_to(lower, lead)
    return spatial([[E, 0 * E], [lower, E]])


def _exchanged(k: Link, pose: Pose) -> np.ndarray:
    """The lower block of X_J X_T where both have -[r x] E there."""
    back = transposed(k.R)
    E_J, E_T = transposed(back @ pose.R), back
    r_J, r_T = cross_matrix(product(back, pose.p - k.p)), cross_matrix(k.p)
    return np.asarray(-r_J @ E_J @ E_T - E_J @ r_T @ E_T)


def to_parent(steps: Steps, site: str, X: np.ndarray, f: np.ndarray) -> np.ndarray:
    """X^T f, with what may stand in the place of X^T."""
    others = {
        "by the inverse of X, as a motion": lambda: np.linalg.inv(X),
        "by X^-T, the inverse of what is right": lambda: transposed(np.linalg.inv(X)),
    }
    return steps.turn(site, transposed(X), f, **others)


def subspace(steps: Steps, k: Link) -> np.ndarray:
    """S: [z; 0] of a turning joint, [0; z] of a sliding one."""
    turning, sliding = (np.concatenate(x, -1) for x in ((k.z, 0 * k.z), (0 * k.z, k.z)))
    if k.slides:
        others = {"[z; 0], as of a turning one": turning, "[z; z]": turning + sliding, "-[0; z]": -sliding}
        return np.asarray(steps.pick("S of a sliding joint", sliding, **others))
    others = {"[0; z], as of a sliding one": sliding, "[z; z]": turning + sliding, "-[z; 0]": -turning}
    return np.asarray(steps.pick("S of a turning joint", turning, **others))


def inertia(steps: Steps, k: Link) -> np.ndarray:
    """The spatial inertia about the link's origin."""
    about = k.about_origin - k.I
    I = steps.add(
        "the inertia about a link's origin", **{"I of the centre": k.tensor(steps), "m (c.c 1 - c c^T)": about}
    )
    c = steps.components("the centre of mass of a body, in its link's axes,", k.c)
    h, one = k.mass * cross_matrix(c), cross_matrix(c)
    wrong = {"-m [c x]": -h, "left out": 0 * h, "without the mass": one}
    upper = steps.pick("the block m [c x] of the inertia", h, **wrong)
    wrong = {"m [c x], not transposed": h, "left out": 0 * h, "without the mass": -one}
    lower = steps.pick("the block m [c x]^T of the inertia", -h, **wrong)
    if upper.shape != lower.shape:  # of several runs
        upper, lower = np.broadcast_arrays(upper, lower)
    last = k.mass * np.eye(3)[None, None]
    last = steps.pick(
        "the block m 1 of the inertia", last, **{"1, without the mass": np.eye(3)[None, None], "left out": 0 * last}
    )
    return spatial([[I, upper], [lower, last]]) + _merging(steps, k)


def _merging(steps: Steps, k: Link) -> np.ndarray:
    """What slips in X^T I X of the links that are fixed to a body add to its inertia; X leads from it to them."""
    more = np.zeros((1, 1, 6, 6))
    for p in (p for p in k.pieces if p.fixed):
        h, place = p.mass * cross_matrix(p.com), (p.Q[None, None], p.p[None, None])
        X = transform(steps, *place, "in merging")
        about = p.R @ p.J @ p.R.T + steiner(p.mass, p.com)
        I = np.block([[about, h], [h.T, p.mass * np.eye(3)]])[None, None]
        right = transform(Steps(), *place)
        right = transposed(right) @ I @ right
        more = more + (steps.congruent("a fixed link's spatial inertia, X^T I X,", transposed(X), I) - right)
    return more
