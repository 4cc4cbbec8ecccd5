"""Tensors as <inertial> gives them, and one body of several links that fixed joints hold together.

    I = R J R^T in the link's axes, Q I Q^T in those of the body
    C = sum m c / sum m,     I_C = sum I + m (d.d 1 - d d^T),  d = c - C      (all at once, or one after another)

References: Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.13; Siciliano et al., Robotics (2009),
appendix B.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import combinations, permutations, product
from typing import NamedTuple

import numpy as np

from ..description import Body, Description, Part, homogeneous
from .steiner import MERGING, outer, square
from .steps import Steps

ONE = np.eye(3)
TURNED = "the tensor of <inertial>, in the axes of its rpy,"
READ = "the tensor of <inertial>"
CARRIED = "a fixed link's tensor, in its own axes,"
PLACEMENT, TURN = "the placement by which a fixed link is merged", "a fixed link's centre"
PLACE = "the place of a fixed link's centre"
OF_LINKS = frozenset({TURNED, READ, CARRIED, PLACEMENT, TURN, PLACE})
"""Steps of single links, before they are merged in one way or another."""


class Piece(NamedTuple):
    """A link of a body: Q and p, how it stands there; mass, centre, R and J of its <inertial>."""

    mass: float
    com: np.ndarray
    R: np.ndarray
    J: np.ndarray
    Q: np.ndarray
    p: np.ndarray

    @property
    def fixed(self) -> bool:
        """Whether it stands on another link."""
        return bool(self.p.any() or (self.Q != ONE).any())


def listed(d: Description) -> list[Part]:
    """The parts, branch by branch, in the order of the file."""
    place = {joint: k for k, joint in enumerate(d.listed)}
    below: dict[str, list[Part]] = {}
    for p in sorted(d.parts, key=lambda p: place.get(p.joint, len(place))):
        below.setdefault(p.parent, []).append(p)
    found, todo = [], below.get(d.root, [])[::-1]
    while todo:
        found.append(todo.pop())
        todo += below.get(found[-1].link, [])[::-1]
    return found


def pieces(d: Description, fused: bool = True, bare: bool = False) -> dict[str, list[Piece]]:
    """Of every link that carries some: what is fixed to it, itself first; or of every link, itself alone.

    Links without <inertial> are pieces without mass, if `bare`.
    """
    where, found = d.carried(), dict[str, list[Piece]]()
    for link, b in [(d.root, d.base), *((p.link, p.body) for p in listed(d))]:
        if b is None and bare:
            b = Body(0.0, np.zeros(3), np.zeros(3), ONE, np.zeros((3, 3)))
        if b is not None:
            carrier, H = where[link] if fused else (link, np.eye(4))
            found.setdefault(carrier, []).append(Piece(b.mass, b.com, b.rotation, b.inertia, H[:3, :3], H[:3, 3]))
    return found


def _copied(to: tuple[int, int], of: tuple[int, int], J: np.ndarray) -> np.ndarray:
    x = J.copy()
    x[..., to[0], to[1]] = x[..., of[0], of[1]]
    return x


def _without(at: tuple[int, int], J: np.ndarray) -> np.ndarray:
    x = J.copy()
    x[..., at[0], at[1]] = 0.0
    return x


MISREAD: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    **{
        f"that without its entry in row {i + 1}, column {j + 1} alone": partial(_without, (i, j))
        for i, j in permutations(range(3), 2)
    },
    "its upper triangle alone": np.triu, "its lower triangle alone": np.tril,
    **{
        f"that with i{'xyz'[k]}{'xyz'[m]} in row {i + 1}, column {j + 1} alone": partial(_copied, (i, j), (k, m))
        for (i, j), (k, m) in product(permutations(range(3), 2), combinations(range(3), 2)) if {i, j} != {k, m}
    },
}  # fmt: skip
"""What may be read in the place of a symmetric tensor."""


def tensor(steps: Steps, piece: Piece) -> np.ndarray:
    """About the piece's centre, in the axes of the body."""
    J = piece.J[None, None]
    J = steps.pick(READ, J, **{words: partial(read, J) for words, read in MISREAD.items()})
    I = steps.congruent(TURNED, piece.R[None, None], J)
    return np.asarray(steps.congruent(CARRIED, piece.Q[None, None], I) if piece.fixed else I)


def standing(steps: Steps, piece: Piece) -> Piece:
    """A link where it stands on the body."""
    if not piece.fixed:
        return piece
    H, back = homogeneous(piece.Q, piece.p), homogeneous(piece.Q.T, piece.p)
    wrong = {"the inverse one": np.linalg.inv(H), "that with its rotation transposed": back}
    H = steps.pick(PLACEMENT, H, **wrong)
    return piece._replace(Q=H[:3, :3], p=H[:3, 3])


def centre(steps: Steps, piece: Piece) -> np.ndarray:
    """Of a link, in the axes of the body."""
    if not piece.fixed:
        return piece.com
    turned = steps.turn(TURN, piece.Q, piece.com)
    return np.asarray(steps.add(PLACE, **{"the link's place": piece.p, "R c": turned}))


def at_once(steps: Steps, group: list[Piece]) -> Body:
    """Centre first, then all tensors about it."""
    group = [standing(steps, p) for p in group]
    masses, centres = np.array([p.mass for p in group]), np.array([centre(steps, p) for p in group])
    mass, weighted, several = masses.sum(), masses @ centres, len(group) > 1
    C = steps.pick("the centre of merged links", weighted / (mass or 1.0), **_centres(masses, centres))
    wrong = {
        "that of the first link": masses[0], "that of the last link": masses[-1],
        "that of all but the first link": mass - masses[0], "that of all but the last link": mass - masses[-1],
        "that of all but the first link, where there are several": mass - masses[0] * several,
        "that of all but the last link, where there are several": mass - masses[-1] * several,
    }  # fmt: skip
    total = steps.pick("the mass of merged links", mass, **wrong)
    from_there = {
        "that of the first link": centres[0], "that of the last link": centres[-1],
        "the mean of the links' centres": centres.mean(0), "the body's origin": np.zeros(3),
    }  # fmt: skip
    about = steps.pick("the point about which tensors are merged", C, **from_there)
    tensors = [tensor(steps, p)[0, 0] for p in group]
    I = np.zeros((3, 3))
    for k in range(len(group)):
        d = steps.add("the arm of Steiner's term", **{"the link's centre": centres[k], "the common centre": -about})
        wrong = {"that of all": mass, "that of the first link": masses[0], "that of the last link": masses[-1]}
        m = steps.pick("the mass in Steiner's term", masses[k], **wrong)
        wrong = {"that of the first link": tensors[0], "that of the last link": tensors[-1]}
        own = steps.pick("the tensor that is merged", tensors[k], **wrong)
        terms = {"the link's tensor": own, "Steiner's term": _steiner(steps, m, d)}
        which = "of the link that joints move" if k == 0 else "of links fixed to it"
        I = I + steps.part(
            "the links that are merged", steps.add(f"the inertia of merged links: {which}", **terms), k, len(group)
        )
    return Body(float(total), C, np.zeros(3), ONE, I)


def _centres(masses: np.ndarray, centres: np.ndarray) -> dict[str, np.ndarray | Callable[[], np.ndarray]]:
    """What may stand in the place of the common centre."""
    mass, weighted = masses.sum(), masses @ centres
    ends = {"the first link": 0, "the last link": -1}
    found: dict[str, np.ndarray | Callable[[], np.ndarray]] = {
        "the mean of the links' centres": lambda: centres.mean(0), "the sum m c, not divided by the mass": weighted,
        "the mean of the centres of links with mass": (
            lambda: centres[masses > 0].mean(0) if mass else 0 * weighted
        ),
        "the sum of m c, divided by the number of links": lambda: weighted / len(masses),
        "the sum of the links' centres": lambda: centres.sum(0), "the mean weighted by the squares of masses": (
            lambda: masses**2 @ centres / ((masses**2).sum() or 1.0)
        ),
    }  # fmt: skip
    for words, k in ends.items():
        rest = weighted - masses[k] * centres[k]
        less = rest / ((mass - masses[k]) or 1.0)
        several = len(masses) > 1
        found |= {
            f"that of {words}": centres[k], f"the sum without the share of {words}": rest / (mass or 1.0),
            f"that of all but {words}": less,
            f"the sum of m c, divided by the mass of {words}": weighted / (masses[k] or 1.0),
            f"the sum without the share of {words}, where there are several": (
                rest / (mass or 1.0) if several else centres[0]
            ),
            f"that of all but {words}, where there are several": less if several else centres[0],
        }  # fmt: skip
    return found


def one_by_one(steps: Steps, group: list[Piece]) -> Body:
    """Link after link is added to the first one."""
    first, *more = (standing(steps, p) for p in group)
    return _added(steps, np.array(first.mass), centre(steps, first), tensor(steps, first)[0, 0], more)


def from_nothing(steps: Steps, group: list[Piece]) -> Body:
    """Link after link is added to a body without mass."""
    return _added(steps, np.zeros(()), np.zeros(3), np.zeros((3, 3)), [standing(steps, p) for p in group])


def about_origin(steps: Steps, group: list[Piece]) -> Body:
    """First moments and tensors about the body's origin are added up, and brought to the common centre at the end."""
    m, first, about = np.zeros(()), np.zeros(3), np.zeros((3, 3))
    for k, p in enumerate(standing(steps, p) for p in group):
        mass, c = np.array(p.mass), centre(steps, p)
        which = f": {'of the link that joints move' if k == 0 else 'of links fixed to it'}"
        terms = {"the link's tensor": tensor(steps, p)[0, 0], "Steiner's term": _steiner(steps, mass, c, which)}
        added = steps.add(f"the inertia about the body's origin{which}", **terms)
        terms = {"that of what is there": about, "that of the fixed link": added}
        about = steps.add("the inertia of what is there and a fixed link", **terms)
        m, first = _summed(steps, m, first, mass, mass * c)
    by_number = {"the sum of m c, divided by the number of links": first / len(group)}
    not_divided = {"the sum m c, not divided by the mass": first}
    C = steps.pick("the centre of merged links", first / (m or 1.0), **not_divided, **by_number)
    back = _steiner(steps, m, C, ": of all at once, back to the common centre")
    terms = {"the inertia about the body's origin": about, "-Steiner's term of all": -back}
    return Body(float(m), C, np.zeros(3), ONE, steps.add("the inertia about the common centre", **terms))


def _summed(
    steps: Steps, m: np.ndarray, first: np.ndarray, mass: np.ndarray, more: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Mass and first moment of what is there and one link more."""
    terms = {"the mass of what is there": m, "the fixed link's mass": mass}
    whole = steps.add("the mass of what is there and a fixed link", **terms)
    terms = {"m c of what is there": first, "m c of the fixed link": more}
    return whole, steps.add("the sum m c of what is there and a fixed link", **terms)


def _added(steps: Steps, m: np.ndarray, c: np.ndarray, I: np.ndarray, more: list[Piece]) -> Body:
    for p in more:
        mass, new = np.array(p.mass), centre(steps, p)
        whole, moment = _summed(steps, m, m * c, mass, mass * new)
        others = _common(m, c, mass, new)
        C = steps.pick("the centre of what is there and a fixed link", moment / (whole or 1.0), **others)
        others = {
            "the centre before it was added": c, "the body's origin": np.zeros(3), "the link's own centre": new,
            "the mean of the two centres": (c + new) / 2,
        }  # fmt: skip
        about = steps.pick("the point about which a link is merged", C, **others)
        there = _share(steps, "of what is there", I, m, c, about, {"the new link's centre": new})
        added = _share(steps, "of the fixed link", tensor(steps, p)[0, 0], mass, new, about, {"the centre before": c})
        terms = {"that of what is there": there, "that of the fixed link": added}
        I = steps.add("the inertia of what is there and a fixed link", **terms)
        others = {"that of what is there": m, "that of the fixed link": mass, "the sum": m + mass}
        kept = steps.pick("the mass that is kept of what is there and a fixed link", whole, **others)
        before = {"the one before it was added": c if m else C}
        C = steps.pick("the centre that is kept of what is there and a fixed link", C, **before)
        both = np.concatenate([[kept], C, I.ravel()])
        last = {"the last link alone, which replaces it": partial(_alone, p, new)}
        both = steps.pick("what is there with a fixed link", both, **last)
        m, c, I = both[0], both[1:4], both[4:].reshape(3, 3)
    return Body(float(m), c, np.zeros(3), ONE, I)


def _common(
    m: np.ndarray, c: np.ndarray, mass: np.ndarray, new: np.ndarray
) -> dict[str, np.ndarray | Callable[[], np.ndarray]]:
    """What may stand in the place of the centre of what is there and a new link."""
    both = (m + mass) or 1.0
    return {
        "the mean of the two": lambda: (c + new) / 2, "that of what is there": c, "that of the new link": new,
        "the mean of the two, where there is some": lambda: (c + new) / 2 if m > 0 else c,
        "the mean of the two, of the first its own": lambda: (c + new) / 2 if m > 0 else new,
        "the mean weighted by each other's mass": lambda: (mass * c + m * new) / both,
        "the sum of m c, divided by the mass of what is there": lambda: (m * c + mass * new) / (m or mass or 1.0),
        "the sum of m c, divided by the mass of the new link": lambda: (m * c + mass * new) / (mass or 1.0),
        "the sum of m c, not divided": lambda: m * c + mass * new,
        "c of what is there with m c of the new link": lambda: (c + mass * new) / both,
        "m c of what is there with c of the new link": lambda: (m * c + new) / both,
    }  # fmt: skip


def _alone(p: Piece, c: np.ndarray) -> np.ndarray:
    return np.concatenate([[p.mass], c, tensor(Steps(), p)[0, 0].ravel()])


def _share(
    steps: Steps,
    whose: str,
    I: np.ndarray,
    m: np.ndarray,
    c: np.ndarray,
    about: np.ndarray,
    others: dict[str, np.ndarray],
) -> np.ndarray:
    """What one of two bodies adds to the inertia of both; `others` are other points for the arm."""
    site = f"the arm of Steiner's term: {whose}"
    d = steps.add(site, **{"the body's centre": c, "the common centre": -about})
    d = steps.pick(site, d, **{f"counted from {what}": partial(np.subtract, c, x) for what, x in others.items()})
    terms = {"the tensor": I, "Steiner's term": _steiner(steps, m, d, f": {whose}")}
    return np.asarray(steps.add(f"a body's share of the inertia: {whose}", **terms))


def _steiner(steps: Steps, m: np.ndarray, d: np.ndarray, which: str = "") -> np.ndarray:
    m = steps.pick(f"the mass in Steiner's term{which}", m, **{"1": np.ones(())})
    terms = {"m d.d 1": m * square(steps, d, MERGING), "-m d d^T": -m * outer(steps, d, MERGING)}
    return np.asarray(steps.add(f"Steiner's term of merging{which}", **terms))


def products(steps: Steps, group: Sequence[Piece], C: np.ndarray) -> np.ndarray:
    """What slips in the products d d^T of merging add to the tensor about C, which may then be not symmetric."""
    more = np.zeros((1, 1, 3, 3))
    for p in group if len(group) > 1 else ():
        d = p.Q @ p.com + p.p - C
        d = d[None, None]
        more = more - p.mass * (outer(steps, d, MERGING) - outer(Steps(), d))
    return more
