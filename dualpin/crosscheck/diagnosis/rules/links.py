"""Mistakes in reading a link's <inertial>."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ....spatial.adjoint import cross_matrix
from ....spatial.inertia import steiner
from ..case import Case
from ..description import Body, Description, Part, fixed_axes, merged, turn
from ..hypothesis import Hypothesis
from .register import ALL, INERTIAL, MASSIVE, link_rule, proposer

READ = "read <inertial> as URDF means it: mass, centre (xyz), and inertia about that centre in axes turned by rpy"


@link_rule("inertial_rpy", "rpy of <inertial> is ignored", READ, MASSIVE)
def rpy_ignored(b: Body) -> Body:
    return replace(b, rotation=np.eye(3))


@link_rule("inertial_rpy_transposed", "rpy of <inertial> is applied the wrong way round", READ + ": R I R^T", MASSIVE)
def rpy_transposed(b: Body) -> Body:
    return replace(b, rotation=b.rotation.T)


@link_rule("inertial_rpy_order", "rpy of <inertial> is multiplied in the other order", READ + ": Rz Ry Rx", MASSIVE)
def rpy_reversed(b: Body) -> Body:
    return replace(b, rotation=turn(0, b.rpy[0]) @ turn(1, b.rpy[1]) @ turn(2, b.rpy[2]))


@link_rule("inertial_xyz", "xyz of <inertial> is ignored", READ)
def xyz_ignored(b: Body) -> Body:
    return replace(b, com=np.zeros(3))


@link_rule("inertial_origin", "the origin of <inertial> is ignored", READ)
def origin_ignored(b: Body) -> Body:
    return replace(b, com=np.zeros(3), rotation=np.eye(3))


@link_rule("inertial_xyz_turned", "xyz of <inertial> is turned by its rpy", READ + ": xyz is in the link's axes")
def xyz_turned(b: Body) -> Body:
    return replace(b, com=b.rotation @ b.com)


@link_rule("inertial_xyz_turned", "xyz of <inertial> is turned by its rpy, the other way round", READ, cost=1.1)
def xyz_turned_back(b: Body) -> Body:
    return replace(b, com=b.rotation.T @ b.com)


@link_rule("inertial_xyz_sign", "the centre of mass has the other sign", READ, cost=1.1)
def xyz_sign(b: Body) -> Body:
    return replace(b, com=-b.com)


@link_rule(
    "about_link_origin",
    "<inertia> is taken about the link's origin",
    READ + ", so Steiner's term is to be added",
    MASSIVE,
)
def about_link_origin(b: Body) -> Body:
    return b.turned(b.in_link - steiner(b.mass, b.com))


@link_rule("steiner_twice", "Steiner's term is added twice", READ + ", so Steiner's term is added once", MASSIVE)
def steiner_twice(b: Body) -> Body:
    return b.turned(b.in_link + steiner(b.mass, b.com))


WRONG_STEINER = {
    "only its diagonal": lambda m, c: np.diag(np.diag(steiner(m, c))),
    "m c.c 1, without c c^T": lambda m, c: m * (c @ c) * np.eye(3),
    "m c c^T in place of m (c.c 1 - c c^T)": lambda m, c: m * np.outer(c, c),
    "m (c.c 1 + c c^T), with the other sign": lambda m, c: m * (c @ c * np.eye(3) + np.outer(c, c)),
    "subtracted": lambda m, c: -steiner(m, c),
    "m [c] [c]^T, multiplied entry by entry": lambda m, c: m * cross_matrix(c) * cross_matrix(c).T,
}


@proposer("steiner_wrong", "Steiner's term is another", "the parallel axis theorem adds m (c.c 1 - c c^T)")
def steiner_wrong(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str, bodies: bool) -> Hypothesis:
        def edit(d: Description, items: Sequence[str]) -> Description:
            return (merged(d) if bodies else d).with_bodies(
                lambda b: b.turned(b.in_link - steiner(b.mass, b.com) + WRONG_STEINER[words](b.mass, b.com)), items
            )

        variant = "of bodies merged from fixed links" if bodies else ""
        return replace(
            h, place="edit", act=edit, terms=MASSIVE, values=words, variant=variant, cost=1.0 + 0.05 * bodies
        )

    merges = case.merged is not case.description
    return [one(words, bodies) for words in WRONG_STEINER for bodies in (False, True)[: 1 + merges]]


@link_rule("products_dropped", "products of inertia are dropped", "use ixy, ixz and iyz too", MASSIVE)
def products_dropped(b: Body) -> Body:
    return replace(b, inertia=np.diag(np.diag(b.inertia)))


@link_rule(
    "products_sign", "products of inertia have the other sign",
    "URDF's ixy, ixz, iyz are the entries of the matrix, not their negatives", MASSIVE,
)  # fmt: skip
def products_sign(b: Body) -> Body:
    return replace(b, inertia=2 * np.diag(np.diag(b.inertia)) - b.inertia)


@link_rule("moments_swapped", "ixx and izz are swapped", "read ixx, iyy and izz by name", MASSIVE, cost=1.1)
def moments_swapped(b: Body) -> Body:
    I = b.inertia.copy()
    I[0, 0], I[2, 2] = b.inertia[2, 2], b.inertia[0, 0]
    return replace(b, inertia=I)


@link_rule("no_rotational", "links are point masses", "add the rotational inertia about the centre of mass", MASSIVE)
def point_mass(b: Body) -> Body:
    return replace(b, inertia=np.zeros((3, 3)))


@link_rule(
    "principal", "inertia is replaced by its sorted principal moments",
    "keep the axes that belong to the principal moments, or use all six numbers", MASSIVE, cost=1.1,
)  # fmt: skip
def principal(b: Body) -> Body:
    return replace(b, inertia=np.diag(np.linalg.eigvalsh(b.inertia)))


@link_rule("massless", "the link's mass and inertia are left out", "count every link that has an <inertial>", cost=1.2)
def massless(b: Body) -> Body | None:
    return None


WATER = 1000.0  # kg/m^3


def possible(b: Body) -> bool:
    """Whether a body can have it: mass where there is inertia, no negative moment, none above the sum of the others."""
    low, middle, high = np.linalg.eigvalsh(b.inertia)
    rounding = 1e-12 * max(high, -low)
    return bool((b.mass > 0 or high == low == 0) and low >= -rounding and low + middle >= high - rounding)


def _ball(b: Body) -> Body:
    """A solid ball of water, about the same centre."""
    m = b.mass or 1.0
    radius = (3 * m / (4 * np.pi * WATER)) ** (1 / 3)
    return replace(b, mass=m, inertia=2 / 5 * m * radius**2 * np.eye(3))


REPLACED: dict[str, Callable[[Body], Body]] = {
    "by a ball of 1000 kg/m^3, of 1 kg where there is no mass": _ball,
    "each moment by the mean of the three": lambda b: replace(b, inertia=np.trace(b.inertia) / 3 * np.eye(3)),
    "by zero": lambda b: replace(b, inertia=np.zeros((3, 3))),
}


@proposer(
    "impossible_inertia", "an inertia that no body can have is replaced",
    "give <inertial> a mass, and a tensor with positive moments of which none is above the sum of the two others",
)  # fmt: skip
def impossible_inertia(h: Hypothesis, case: Case) -> list[Hypothesis]:
    d = case.description
    bodies = [(d.root, d.base), *((p.link, p.body) for p in d.parts)]
    links = tuple(link for link, b in bodies if b is not None and not possible(b))

    def one(words: str) -> Hypothesis:
        return replace(
            h, place="edit", act=lambda d, items: d.with_bodies(REPLACED[words], items), terms=INERTIAL, items=links,
            values=words,
        )  # fmt: skip

    return [one(words) for words in REPLACED] if links else []


@link_rule(
    "from_shapes", "inertia is computed from collision shapes, not read (here there are none)",
    "ask the loader for the inertia of the file (PyBullet: flags=URDF_USE_INERTIA_FROM_FILE)", MASSIVE, cost=1.1,
)  # fmt: skip
def from_shapes(b: Body) -> Body:
    return replace(b, inertia=b.mass * 2e-6 / 3 * np.eye(3))  # a box with half a millimetre of margin each way


DEFAULTS = ((1.0, 1.0), (1.0, 0.0), (1.0, 0.1), (1.0, 0.01), (1.0, 1e-3), *((m, i) for m in (0.1, 0.01, 1e-3, 1e-6)
            for i in (0.0, m, m * 1e-3)))  # fmt: skip
"""Mass and principal moments that a reader may give to links without <inertial>."""


@proposer(
    "default_mass", "links without <inertial> get a mass, and an inertia", "a link without <inertial> has no mass"
)
def default_mass(h: Hypothesis, case: object) -> list[Hypothesis]:
    def one(m: float, i: float) -> Hypothesis:
        body = Body(m, np.zeros(3), np.zeros(3), np.eye(3), i * np.eye(3))

        def edit(d: Description, items: Sequence[str]) -> Description:
            parts = tuple(replace(p, body=body) if p.body is None else p for p in d.parts)
            return replace(d, base=d.base or body, parts=parts)

        words = f"with inertia {i:g}" if i else "as points without inertia"
        says = f"links without <inertial> weigh {m:g} kg, {words}"
        return replace(h, says=says, place="edit", act=edit, terms=INERTIAL)

    return [one(m, i) for m, i in DEFAULTS]


@proposer(
    "single_precision", "numbers of the file are rounded to single precision",
    "keep the model's constants in double precision",
)  # fmt: skip
def file_in_single_precision(h: Hypothesis, case: object) -> list[Hypothesis]:
    def single(x: np.ndarray) -> np.ndarray:
        return np.asarray(np.asarray(x, np.float32), float)

    def body(b: Body) -> Body:
        rpy = single(b.rpy)
        return Body(float(np.float32(b.mass)), single(b.com), rpy, fixed_axes(rpy), single(b.inertia))

    def part(p: Part, _: Description) -> Part:
        rpy = single(p.rpy)
        axis = None if p.axis is None else single(p.axis)
        return replace(p, position=single(p.position), rpy=rpy, rotation=fixed_axes(rpy), axis=axis)

    def edit(d: Description, items: Sequence[str]) -> Description:
        return d.with_bodies(body).with_parts(part)

    return [replace(h, place="edit", act=edit, terms=ALL)]
