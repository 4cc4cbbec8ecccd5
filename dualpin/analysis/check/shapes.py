"""Rules that compare masses with shapes: boxes, cylinders and spheres, and meshes whose files exist.

Meshes are read by trimesh (extra "view"); a link counts only where all of its shapes are there.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from itertools import permutations, product
from pathlib import Path

import numpy as np

from ...io.meshes import Shape, find
from ...spatial.inertia import steiner
from .description import Body
from .findings import ERROR, NOTE, WARNING, Finding
from .rules import Case, Rule, rules
from .tensors import LIGHT, OSMIUM, physical

MARGIN = 0.2  # of a box's diagonal: motors and cables outside of the shape
LEAST_MARGIN = 0.01  # m
DUMMY = 0.01  # m; smaller shapes are placeholders
EMPTY = 5.0  # kg/m^3 over the whole bounding box: lighter than any structure; foam has 20
CLOSE = 0.1  # relative difference below which the tensor is that of the uniform solid
APART = 0.5  # relative difference from which it is another orientation or point, not another density


@rules(
    Rule("missing-mesh", WARNING, "The file of a mesh is not there.", "add the file, or correct the name"),
    Rule(
        "package-not-found", NOTE, "A package of meshes is nowhere: its meshes were not looked at.",
        "put the package beside the file, or its folder into ROS_PACKAGE_PATH",
    ),
    Rule(
        "mesh-absolute", NOTE, "A mesh is named by an absolute path: it is there on one machine only.",
        "a path relative to the file, or package://",
    ),
)  # fmt: skip
def files(case: Case) -> Iterator[Finding]:
    path = case.about.path
    if path is None or case.about.document is None:
        return
    nowhere: dict[str, int] = {}
    for b in case.about.bodies:
        for mesh in () if b.element is None else b.element.iter("mesh"):
            name = mesh.get("filename") or ""
            absolute = name.startswith(("/", "file:///")) and not name.startswith("file:///tmp")
            there = find(path, name) is not None
            package = name.removeprefix("package://").partition("/")[0] if name.startswith("package://") else ""
            if there and absolute and not path.name.startswith("stdin"):
                why = "elsewhere the link has no shape: no term changes"
                found = case.found("mesh-absolute", b, repr(name), why)
            elif there or not name:
                continue
            elif package and not _is_there(path, package):
                nowhere[package] = nowhere.get(package, 0) + 1
                continue
            else:
                why = "the link has no shape in viewers, contacts and planners, and its mass cannot be compared with a "
                found = case.found("missing-mesh", b, f"no file {name!r}", f"{why}volume: 0 shapes instead of 1")
            found.line = mesh.sourceline
            yield found
    for package, count in nowhere.items():
        why = f"the {count} meshes were not compared with masses, and viewers show none of them"
        yield case.found("package-not-found", None, f"package {package!r} with {count} meshes", why)


def _is_there(path: Path, package: str) -> bool:
    return any(folder.name == package or (folder / package).is_dir() for folder in path.resolve().parents)


@rules(
    Rule(
        "com-outside", WARNING, "The centre of mass is outside of the link's shapes.",
        "the origin of <inertial> may be in another frame, unit or sign",
    ),
    Rule(
        "inertia-beyond-shape", WARNING, "No mass within the link's shapes has this tensor.",
        "export the tensor again, in kg m^2",
    ),
    Rule(
        "too-dense", WARNING, "The mass is more than the shapes' volume of the densest element.",
        "the mass is in grams or a placeholder, or the shape is only part of the link",
    ),
    Rule(
        "too-light", NOTE, "The mass is less than that of foam in the shapes' volume.",
        "the mass is a placeholder, or in tonnes",
    ),
    Rule(
        "mesh-millimetres", ERROR, "A mesh is a thousand times too large: millimetres without a scale.",
        'scale="0.001 0.001 0.001"',
    ),
)  # fmt: skip
def against_shapes(case: Case) -> Iterator[Finding]:
    for b, shapes in _shaped(case):
        low, high = box(shapes)
        diagonal = float(np.linalg.norm(high - low))
        if diagonal > 20 and not all(s.solid for s in shapes):
            why = f"as millimetres they are {diagonal / 1e3:.2g} m: contacts and volumes are 1e9 times too large"
            yield case.found("mesh-millimetres", b, f"its shapes are {diagonal:.3g} m across", why)
        elif b.mass > LIGHT and diagonal:
            yield from _masses(case, b, low, high, diagonal)


def _shaped(case: Case) -> Iterator[tuple[Body, list[Shape]]]:
    """Links whose shapes are known."""
    if case.about.document is not None and find_spec("trimesh"):
        yield from ((b, case.about.shapes[b.name]) for b in case.about.bodies if case.about.shapes.get(b.name))


def box(shapes: list[Shape]) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the bounding box in the link's axes."""
    points = np.concatenate([_corners(s) for s in shapes])
    return points.min(axis=0), points.max(axis=0)


def _corners(s: Shape) -> np.ndarray:
    corners = np.array(list(product(*np.asarray(s.mesh.bounds).T)))
    return np.asarray(corners @ s.placement[:3, :3].T + s.placement[:3, 3])


def _masses(case: Case, b: Body, low: np.ndarray, high: np.ndarray, diagonal: float) -> Iterator[Finding]:
    margin, sides = MARGIN * diagonal + LEAST_MARGIN, high - low
    out = float(np.linalg.norm(np.maximum(np.maximum(low - b.com, b.com - high), 0)))
    if out > margin:
        says = f"centre of mass {1e3 * out:.3g} mm outside of shapes {1e3 * diagonal:.3g} mm across"
        middle = b.mass, (low + high) / 2, b.tensor
        yield case.found("com-outside", b, says, "with the centre in the middle of its shapes,", instead=middle)
        return
    far = np.maximum(high + margin - b.com, b.com - (low - margin))
    ratio = float((np.diag(b.tensor) / (b.mass * _others(far))).max())
    if ratio > 1:
        says = f"a moment is {ratio:.3g} times what all mass at the shapes' edge has"
        solid = b.mass, b.com, b.mass / 12 * np.diag(_others(sides))
        yield case.found("inertia-beyond-shape", b, says, "as a solid box of its size,", instead=solid)
    volume = float(np.prod(np.maximum(sides, 1e-4)))
    density = f"{b.mass / volume:.2g} kg/m^3"
    if b.mass / volume > OSMIUM and diagonal > DUMMY:
        says = f"{b.mass:g} kg in a box of {1e6 * volume:.3g} cm^3: {density}"
        why = f"osmium has {OSMIUM:g}; with the density of aluminium,"
        yield case.found("too-dense", b, says, why, instead=(2700 * volume, b.com, b.tensor))
    elif b.mass / volume < EMPTY and diagonal > 0.05:
        says = f"{b.mass:g} kg in a box of {1e3 * volume:.3g} l: {density}"
        why = "foam has 20 kg/m^3; with a light structure of 100,"
        yield case.found("too-light", b, says, why, instead=(100 * volume, b.com, b.tensor))


def _others(x: np.ndarray) -> np.ndarray:
    """The sums of squares of the two other components: (y^2 + z^2, x^2 + z^2, x^2 + y^2)."""
    return np.asarray((x**2).sum() - x**2)


@rules(
    Rule(
        "tensor-about-wrong-point", WARNING, "The tensor is that of the shape about the link's origin, not its centre.",
        "give the tensor about the centre of mass",
    ),
    Rule("tensor-turned", WARNING, "The tensor is that of the shape in other axes."),
)  # fmt: skip
def wrong_frame(case: Case) -> Iterator[Finding]:
    for b, shapes in _shaped(case):
        if b.mass <= LIGHT or b.point or not physical(b.tensor):
            continue
        solid = uniform(shapes, b.mass)
        if solid is None or _off(b.tensor, solid) < APART:
            continue
        moved, off = b.tensor - steiner(b.mass, b.com), f"{_off(b.tensor, solid):.0%} off a uniform solid of its shape"
        if _off(moved, solid) < CLOSE:
            says = f"{off}, {_off(moved, solid):.0%} after Steiner's terms are subtracted"
            centred = b.mass, b.com, moved
            yield case.found("tensor-about-wrong-point", b, says, "about the centre of mass", instead=centred)
            continue
        turned, words = _turned(b, solid)
        if turned is not None:
            says, fix = f"{off}, {_off(turned, solid):.0%} if {words}", f"{words[0].upper()}{words[1:]}"
            fix += ": correct rpy of the inertial, or the entries"
            yield case.found("tensor-turned", b, says, "then", fix, instead=(b.mass, b.com, turned))


def uniform(shapes: list[Shape], mass: float) -> np.ndarray | None:
    """The tensor about its centre, in the link's axes, of shapes filled evenly; None where a mesh is not closed."""
    total, moment, about = 0.0, np.zeros(3), np.zeros((3, 3))
    for s in shapes:
        if not s.mesh.is_volume or s.mesh.volume <= 0:
            return None
        R, p = s.placement[:3, :3], s.placement[:3, 3]
        v, c = float(s.mesh.volume), R @ np.asarray(s.mesh.center_mass) + p
        J = R @ (np.asarray(s.mesh.moment_inertia) / s.mesh.density) @ R.T
        total, moment = total + v, moment + v * c
        about = about + J + steiner(v, c)
    return np.asarray((about - steiner(total, moment / total)) * mass / total)


def _off(J: np.ndarray, solid: np.ndarray) -> float:
    return float(np.linalg.norm(J - solid) / np.linalg.norm(solid))


def _turned(b: Body, solid: np.ndarray) -> tuple[np.ndarray | None, str]:
    """The tensor in axes in which it is close to the solid's, and these axes."""
    R = b.rotation
    candidates = []
    if not np.allclose(R, np.eye(3), atol=1e-9):
        candidates.append((b.written, "it is in the link's axes already, and rpy of the inertial turns it"))
        candidates.append((R.T @ b.written @ R, "rpy of the inertial turns it the other way"))
    for order in permutations(range(3)):
        if order != (0, 1, 2):
            P = np.eye(3)[list(order)]
            exchanged = ", ".join(f"{'xyz'[i]} is {'xyz'[k]}" for i, k in enumerate(order) if i != k)
            candidates.append((P @ b.tensor @ P.T, f"its axes are exchanged: {exchanged}"))
    best = min(candidates, key=lambda x: _off(x[0], solid))
    return best if _off(best[0], solid) < CLOSE else (None, "")
