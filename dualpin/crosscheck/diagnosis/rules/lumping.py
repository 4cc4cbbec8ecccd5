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
from ..textbook.steiner import MERGING as OF_MERGING
from ..textbook.steps import Slip, Steps
from ..textbook.words import rows
from .formulation import mistake_of
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
Reading = Callable[[np.ndarray], np.ndarray]
READ: dict[str, Reading] = {"": lambda I: (I + I.T) / 2, **TRIANGLES}
MERGING = "merging fixed links"
"""The name under which its slips are kept."""


@proposer("step_left_out, ...", "a step of merging fixed links, or of reading a tensor, is wrong", FIX, rows(), late=2)
def lumping(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return case.shared.once("lumping", lambda: _lumping(h, case))


def _lumping(h: Hypothesis, case: Case) -> list[Hypothesis]:
    found = []
    bare = any(p.body is None for p in case.description.parts)
    kinds = product(WAYS, (False, True)[: 1 + bare], READ)
    for number, (way, all_links, words) in enumerate(kinds):

        def find(way: str = way, all_links: bool = all_links, words: str = words) -> list[Slip]:
            of_all = case.shared.once((MERGING, way, all_links), lambda: _slips(case, way, all_links))
            return of_all[words]

        groups = pieces(case.description, bare=all_links)
        for slip in case.shared.slips.of(number, MERGING, find):
            found.append(
                replace(
                    h, key=slip.how, says=f"bodies of several links: {slip.says}", place="edit",
                    act=_edit(WAYS[way], slip, READ[words], all_links, groups), fix=FIX,
                    terms=INERTIAL, values=words, variant=way + ALL_LINKS * all_links,
                    cost=1.1 + 0.05 * bool(words) + 0.02 * all_links,
                    mistake=mistake_of(slip) if slip.site.endswith(OF_MERGING) else (),
                )
            )  # fmt: skip
    return found


Groups = dict[str, list[Piece]]


def _slips(case: Case, way: str, all_links: bool) -> dict[str, list[Slip]]:
    """Those that change a body, by what is read of tensors that are not symmetric any more."""
    make, groups = WAYS[way], pieces(case.description, bare=all_links)
    fewer, steps = pieces(case.description), Steps()
    right = {link: make(steps, group) for link, group in groups.items()}
    found: dict[str, list[Slip]] = {words: [] for words in READ}
    for slip in steps.found:
        if slip.site in OF_LINKS and (make is not at_once or all_links):
            continue  # it is the same in all ways, and of links that weigh nothing
        made = {link: make(Steps(slip), group) for link, group in groups.items()}
        if not any(differ(right[link], made[link]) for link in groups):
            continue
        if all_links and not any(differ(make(Steps(slip), fewer[link]), made[link]) for link in fewer):
            continue
        for words in [""] if _even(made.values()) else TRIANGLES:
            found[words].append(slip)
    return found


def _even(bodies: Iterable[Body]) -> bool:
    """Whether all tensors are symmetric."""
    return all(np.abs(b.inertia - b.inertia.T).max() <= 1e-12 * max(1.0, np.abs(b.inertia).max()) for b in bodies)


def _edit(
    make: Callable[..., Body], slip: Slip, read: Reading, all_links: bool, of_file: Groups
) -> Callable[[Description, Sequence[str]], Description]:
    """`of_file` are the links of the file, of which bodies are made once."""
    known: dict[str, Body] = {}

    def made(groups: Groups) -> dict[str, Body]:
        return {link: make(Steps(slip), group) for link, group in groups.items()}

    def edit(d: Description, items: Sequence[str]) -> Description:
        groups = pieces(d, bare=all_links)
        same = _same(groups, of_file)
        if same and not known:
            known.update(made(of_file))
        bodies = {k: replace(b, inertia=read(b.inertia)) for k, b in (known if same else made(groups)).items()}
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
