"""Bodies of several links, and principal axes, made with a slip."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import permutations, product

import numpy as np

from ...subjects.layout import quaternions, rotations
from ..case import Case
from ..description import Body, Description, merged
from ..hypothesis import Hypothesis
from ..textbook.lumps import OF_LINKS, Piece, about_origin, at_once, from_nothing, one_by_one, pieces
from ..textbook.steps import Slip, Steps
from ..textbook.words import rows
from .register import INERTIAL, MASSIVE, differ, proposer

WAYS: dict[str, Callable[[Steps, list[Piece]], Body]] = {
    "all at once": at_once, "one by one": one_by_one,
    "one by one, from nothing": from_nothing, "about the body's origin": about_origin,
}  # fmt: skip
ALL_LINKS = ", of links without <inertial> too"
FIX = "one body of several links: C = sum m c / sum m, I = sum R I R^T + m (d.d 1 - d d^T) with d = c - C"
TRIANGLES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "the lower triangle is read": lambda I: np.tril(I) + np.tril(I, -1).T,
    "the upper triangle is read": lambda I: np.triu(I) + np.triu(I, 1).T,
}
"""What a code makes of a tensor that is not symmetric, where it does not go on with all of it."""


@proposer("step_left_out, ...", "a step of merging fixed links, or of reading a tensor, is wrong", FIX, rows(), late=2)
def lumping(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return case.shared.once("lumping", lambda: _lumping(h, case))


def _lumping(h: Hypothesis, case: Case) -> list[Hypothesis]:
    found = []
    bare = any(p.body is None for p in case.description.parts)
    for (way, make), all_links in product(WAYS.items(), (False, True)[: 1 + bare]):
        groups = pieces(case.description, bare=all_links)
        fewer = pieces(case.description)
        steps = Steps()
        for group in groups.values():
            make(steps, group)
        right = {link: make(Steps(), group) for link, group in groups.items()}
        for slip in steps.found:
            if slip.site in OF_LINKS and (make is not at_once or all_links):
                continue  # it is the same in all ways, and of links that weigh nothing
            made = {link: make(Steps(slip), group) for link, group in groups.items()}
            if not any(differ(right[link], made[link]) for link in groups):
                continue
            if all_links and not any(differ(make(Steps(slip), fewer[link]), made[link]) for link in fewer):
                continue
            for words, read in _read(made.values()).items():
                edit = _edit(make, slip, read, all_links, (groups, made))
                found.append(
                    replace(
                        h, key=slip.how, says=f"bodies of several links: {slip.says}", place="edit", act=edit, fix=FIX,
                        terms=INERTIAL, values=words, variant=way + ALL_LINKS * all_links,
                        cost=1.1 + 0.05 * bool(words) + 0.02 * all_links,
                    )
                )  # fmt: skip
    return found


Reading = Callable[[np.ndarray], np.ndarray]


def _read(bodies: Iterable[Body]) -> dict[str, Reading]:
    """Which triangles are read where a tensor is not symmetric; all of it where it is."""
    tensors = [b.inertia for b in bodies]
    even = all(np.abs(I - I.T).max() <= 1e-12 * max(1.0, np.abs(I).max()) for I in tensors)
    return {"": lambda I: (I + I.T) / 2} if even else TRIANGLES


Groups = dict[str, list[Piece]]


def _edit(
    make: Callable[..., Body], slip: Slip, read: Reading, all_links: bool, known: tuple[Groups, dict[str, Body]]
) -> Callable[[Description, Sequence[str]], Description]:
    """`known` are the bodies that the slip makes of the links of the file."""

    def edit(d: Description, items: Sequence[str]) -> Description:
        groups, (before, made) = pieces(d, bare=all_links), known
        if not _same(groups, before):
            made = {link: make(Steps(slip), group) for link, group in groups.items()}
        bodies = {link: replace(b, inertia=read(b.inertia)) for link, b in made.items()}
        parts = tuple(replace(p, body=bodies.get(p.link)) for p in d.parts)
        return replace(d, base=bodies.get(d.root), parts=parts)

    return edit


def _same(some: Groups, others: Groups) -> bool:
    """Whether it is the same file."""
    return some.keys() == others.keys() and all(
        len(a) == len(b)
        and all(
            np.array_equal(np.asarray(x), np.asarray(y))
            for p, r in zip(a, b, strict=True)
            for x, y in zip(p, r, strict=True)
        )
        for a, b in zip(some.values(), others.values(), strict=True)
    )


# --- principal axes ------------------------------------------------------------------------------


def _handed(V: np.ndarray, column: int | None) -> np.ndarray:
    """Axes made right-handed, by one of them or by all."""
    if np.linalg.det(V) > 0:
        return V
    V = V.copy()
    if column is None:
        return -V
    V[:, column] *= -1
    return V


def _by_quaternion(unit: bool, V: np.ndarray) -> np.ndarray:
    """What becomes of left-handed axes that are taken for a rotation, by their quaternion (made a unit one or not)."""
    q = quaternions(V)
    squares = 1 + V.diagonal() @ SIGNS.T  # four times those of a rotation's quaternion
    largest = squares.argmax()
    size = 1.0 if unit else np.sqrt(squares[largest]) / 2 / abs(q[largest])
    return np.asarray(rotations(size * q))


SIGNS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])


Axes = Callable[[np.ndarray], np.ndarray]
ASCENDING = (0, 1, 2)


def _principal() -> Iterator[tuple[str, str, Axes, tuple[int, ...]]]:
    """(words, variant, axes, order): what is made of the axes of ascending moments, and the order of these."""
    for column in (0, 1, 2, None):
        by = f"made right-handed by {'all axes' if column is None else f'axis {column + 1}'}"
        yield "the axes are transposed", by, partial(_transposed, column), ASCENDING
        for words, step in (("qx qy qz qw as qw qx qy qz", -1), ("qw qx qy qz as qx qy qz qw", 1)):
            yield (
                f"the quaternion of the axes is read in the other order, {words}",
                by,
                partial(_rolled, column, step),
                ASCENDING,
            )
    for order in permutations(ASCENDING):
        if order != ASCENDING:
            which = ", ".join(str(i + 1) for i in order)
            yield f"the moments belong to other axes: {which} of the ascending ones", "", np.asarray, order
    for unit in (True, False):
        words = "the axes are left-handed, and taken for a rotation"
        yield words, f"unit quaternion: {unit}", partial(_by_quaternion, unit), ASCENDING


def _rolled(column: int | None, step: int, V: np.ndarray) -> np.ndarray:
    return np.asarray(rotations(np.roll(quaternions(_handed(V, column)), step)))


def _transposed(column: int | None, V: np.ndarray) -> np.ndarray:
    return _handed(V, column).T


@proposer(
    "principal_axes", "principal moments and their axes are put together wrongly",
    "I = V D V^T, the columns of V a right-handed set of principal axes in the order of the moments in D", late=2,
)  # fmt: skip
def principal_axes(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str, variant: str, axes: Axes, order: tuple[int, ...], fused: bool) -> Hypothesis:
        def edit(d: Description, items: Sequence[str]) -> Description:
            def body(b: Body) -> Body:
                moments, V = np.linalg.eigh(b.in_link)
                A = axes(V)
                return b.turned(A @ np.diag(moments[list(order)]) @ A.T)

            return (merged(d) if fused else d).with_bodies(body)

        variant += ", of bodies merged from fixed links" * fused
        cost = 1.1 + 0.05 * fused
        return replace(h, place="edit", act=edit, terms=MASSIVE, values=words, variant=variant, cost=cost)

    merges = case.merged is not case.description
    return [one(*way, fused) for way in _principal() for fused in (False, True)[: 1 + merges]]
