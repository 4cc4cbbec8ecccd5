"""Rules about several links: limbs that are not mirror images, copied inertials."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from .description import Body
from .findings import NOTE, WARNING, Finding
from .rules import Case, Rule, rules
from .shapes import box
from .tensors import LIGHT, NOTHING

ALIKE = 0.05  # relative difference of lengths up to which two shapes are the same part
SIDES = (("left", "right"), ("l", "r"), ("lf", "rf"), ("lh", "rh"), ("fl", "fr"), ("rl", "rr"), ("bl", "br"))
PLANE = 2e-3  # m: tolerance of the origins of mirrored links
SAME = 0.02  # relative: masses of mirrored links
PARTS = 0.1  # of a link's size: motors are equal, not mirrored, on both sides, which changes centres and tensors


@rules(
    Rule(
        "not-mirrored", WARNING, "A link's mass or tensor is not the mirror image of that of the other side.",
        "a sign of xyz, ixy, ixz or iyz was kept in copying, or one side is wrong",
    ),
)  # fmt: skip
def mirrored(case: Case) -> Iterator[Finding]:
    """Compare in the world frame at zero, independent of the frames of both sides."""
    pairs = list(_pairs(case.about.bodies))
    if not pairs:
        return
    poses = _poses(case)
    plane = _plane([(poses[a.name], poses[b.name]) for a, b in pairs])
    if plane is None:
        return
    for left, right in pairs:
        X, Y = poses[left.name], poses[right.name]
        if not _mirror(X[:3, 3], Y[:3, 3], plane, PLANE) or left.mass <= LIGHT or right.mass <= LIGHT:
            continue
        if _shape(left) and _shape(left) == _shape(right):
            continue  # the same part on both sides need not be a mirror image
        S = np.eye(3)
        S[plane, plane] = -1
        c = S @ (X[:3, :3] @ left.com + X[:3, 3])
        J = S @ X[:3, :3] @ left.tensor @ X[:3, :3].T @ S
        R = Y[:3, :3]
        size = float(np.linalg.norm(right.com) + np.linalg.norm(left.com)) / 2 + np.sqrt(left.moments[-1] / left.mass)
        off = float(np.linalg.norm(R @ right.com + Y[:3, 3] - c))
        mass, tensor = abs(left.mass / right.mass - 1), _relative(R @ right.tensor @ R.T, J)
        shifted = off > 2 * PLANE + PARTS * size
        if mass <= SAME and not shifted and tensor <= 3 * PARTS:
            continue
        if mass > SAME:
            what = f"mass {right.mass:g} kg beside {left.mass:g}"
        else:
            what = f"centre of mass {1e3 * off:.3g} mm off" if shifted else f"tensor {tensor:.0%} off"
        says = f"{what}: not the mirror image of link {left.name!r} (plane {'xyz'[plane]} = const)"
        image = left.mass, R.T @ (c - Y[:3, 3]), R.T @ J @ R
        yield case.found("not-mirrored", right, says, "mirrored from there,", instead=image)


def _pairs(bodies: list[Body]) -> Iterator[tuple[Body, Body]]:
    """Links whose names differ only in their side."""
    names = {b.name: b for b in bodies}
    done: set[str] = set()
    for b in bodies:
        for other in _other_sides(b.name):
            if other in names and b.name not in done and other not in done:
                done |= {b.name, other}
                yield b, names[other]


def _other_sides(name: str) -> Iterator[str]:
    words = re.split(r"([_\-.]|(?<=[a-z])(?=[A-Z]))", name)
    for i, word in enumerate(words):
        for one, other in SIDES:
            if word and word.lower() == one:
                new = other.upper() if word.isupper() else other.capitalize() if word[0].isupper() else other
                yield "".join([*words[:i], new, *words[i + 1 :]])
    if name.lower().startswith(("left", "right")):
        for one, other in (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT")):
            if name.startswith(one):
                yield other + name.removeprefix(one)


def _poses(case: Case) -> dict[str, np.ndarray]:
    from ...functions import fk

    robot = case.about.robot
    return {b.name: fk(robot, robot.neutral, frame=b.name, engine="numpy") for b in case.about.bodies}


def _mirror(x: np.ndarray, y: np.ndarray, plane: int, within: float) -> bool:
    sign = np.ones(3)
    sign[plane] = -1
    return bool(np.abs(sign * x - y).max() <= within) and abs(x[plane]) > within


def _plane(pairs: list[tuple[np.ndarray, np.ndarray]]) -> int | None:
    """The plane through the world's origin in which most of the pairs mirror; None where few do."""
    votes = [sum(_mirror(X[:3, 3], Y[:3, 3], k, PLANE) for X, Y in pairs) for k in range(3)]
    best = int(np.argmax(votes))
    return best if votes[best] > 0 and votes[best] >= 0.5 * len(pairs) else None


def _relative(x: np.ndarray, y: np.ndarray) -> float:
    size = float(np.linalg.norm(y))
    return float(np.linalg.norm(x - y)) / size if size else float(np.linalg.norm(x) > 0)


@rules(
    Rule(
        "duplicate-inertial", NOTE, "Links of different shape have the same mass, centre and tensor, to the digit.",
        "export the inertial of each link",
    ),
)  # fmt: skip
def duplicated(case: Case) -> Iterator[Finding]:
    if case.about.document is None:
        return  # without shapes a copy cannot be distinguished from a second equal part
    same: dict[tuple[float, ...], list[Body]] = defaultdict(list)
    for b in case.about.bodies:
        if b.given and b.mass > LIGHT and not b.point and not _round(b):
            key = (b.mass, *b.com.tolist(), *b.tensor.ravel().tolist())
            same[key].append(b)
    for first, *others in same.values():
        for other in others:
            why = _unlike(case, first, other)
            if not why:
                continue
            says = f"the same {first.mass:g} kg and tensor as link {first.name!r}"
            why = f"{why}, so one is a copy; what is at stake is all of it: without it,"
            yield case.found("duplicate-inertial", other, says, why, instead=NOTHING)
            break


def _unlike(case: Case, one: Body, other: Body) -> str:
    """Why two links are not the same part; empty where they may be."""
    shapes = [case.about.shapes.get(b.name) for b in (one, other)]
    if shapes[0] and shapes[1]:
        sides = [np.sort(np.subtract(*box(s)[::-1])) for s in shapes if s]
        if np.abs(sides[0] - sides[1]).max() > ALIKE * sides[0].max():
            return f"they are {1e3 * sides[0][-1]:.3g} and {1e3 * sides[1][-1]:.3g} mm long"
        return ""
    if _shape(one) and _plain(_shape(one)) == _plain(_shape(other)):
        return ""
    if one.carrier is not None and other.carrier is not None and one.carrier in list(other.carrier.chain)[1:]:
        return "one carries the other" if any(one.com) else ""
    return ""


def _round(b: Body) -> bool:
    """Whether its tensor is a multiple of the identity: a placeholder, which has a rule of its own."""
    return bool(np.array_equal(b.written, b.written[0, 0] * np.eye(3)))


def _shape(b: Body) -> str:
    """The file or the size of its shape."""
    e = None if b.element is None else b.element.find("visual/geometry")
    for shape in () if e is None else e:
        if isinstance(shape.tag, str):
            return str(shape.get("filename") or f"{shape.tag} {sorted(shape.attrib.items())}")
    return ""


def _plain(name: str) -> str:
    """A shape's name without its side and number."""
    stem = name.rpartition("/")[2].partition(".")[0].lower()
    return re.sub(
        r"(?<![a-z])(left|right|l|r|lf|rf|lh|rh|fl|fr|rl|rr|front|rear|back|upper|lower)(?![a-z])|[\d_\-]", "", stem
    )
