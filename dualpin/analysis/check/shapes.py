"""Rules that compare masses with shapes: boxes, cylinders and spheres, and meshes whose files exist.

Meshes are read by trimesh (extra "view"); a link counts only where all of its shapes are there.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from itertools import permutations, product
from pathlib import Path
from typing import Any

import numpy as np

from ...io.meshes import Shape, find
from ...spatial.inertia import steiner
from .description import Body
from .findings import ERROR, NOTE, WARNING, Finding
from .rules import Case, Rule, finding, rules
from .tensors import LIGHT, OSMIUM, physical

MARGIN = 0.2  # of a box's diagonal: motors and cables outside of the shape
LEAST_MARGIN = 0.01  # m
DUMMY = 0.01  # m; smaller shapes are placeholders
EMPTY = 5.0  # kg/m^3 over the whole bounding box: lighter than any structure; foam has 20
CLOSE = 0.1  # relative difference below which the tensor is that of the uniform solid
APART = 0.5  # relative difference from which it is another orientation or point, not another density


@rules(
    Rule("missing-mesh", WARNING, "The file of a mesh is not there."),
    Rule("package-not-found", NOTE, "A package of meshes is nowhere: its meshes were not looked at."),
    Rule("mesh-absolute", NOTE, "A mesh is named by an absolute path: it is there on one machine only."),
)
def files(case: Case) -> Iterator[Finding]:
    path = case.about.path
    if path is None or case.about.document is None:
        return
    nowhere: dict[str, list[str]] = {}
    for b in case.about.bodies:
        for mesh in () if b.element is None else b.element.iter("mesh"):
            name = mesh.get("filename") or ""
            absolute = name.startswith(("/", "file:///")) and not name.startswith("file:///tmp")
            if find(path, name) is not None:
                if absolute and not path.name.startswith("stdin"):
                    yield _file(
                        case,
                        "mesh-absolute",
                        b,
                        mesh,
                        f"{name!r}",
                        "elsewhere the link has no shape: no term changes",
                        "a path relative to the file, or package://",
                    )
                continue
            package = name.removeprefix("package://").partition("/")[0] if name.startswith("package://") else ""
            if package and not _is_there(path, package):
                nowhere.setdefault(package, []).append(name)
            elif name:
                yield _file(
                    case,
                    "missing-mesh",
                    b,
                    mesh,
                    f"no file {name!r}",
                    "the link has no shape in "
                    "viewers, contacts "
                    "and planners, and its mass cannot be compared with a volume: 0 shapes instead of 1",
                    "add the file, or correct the name",
                )
    for package, names in nowhere.items():
        yield finding(
            case,
            "package-not-found",
            None,
            f"package {package!r} with {len(names)} meshes",
            why=f"the {len(names)} meshes were not compared with masses, and viewers show none of them",
            fix="put the package beside the file, or its folder into ROS_PACKAGE_PATH",
        )


def _file(case: Case, rule: str, b: Body, mesh: Any, says: str, why: str, fix: str) -> Finding:
    found = finding(case, rule, b, says, why=why, fix=fix)
    found.line = mesh.sourceline
    return found


def _is_there(path: Path, package: str) -> bool:
    return any(folder.name == package or (folder / package).is_dir() for folder in path.resolve().parents)


@rules(
    Rule("com-outside", WARNING, "The centre of mass is outside of the link's shapes."),
    Rule("inertia-beyond-shape", WARNING, "No mass within the link's shapes has this tensor."),
    Rule("too-dense", WARNING, "The mass is more than the shapes' volume of the densest element."),
    Rule("too-light", NOTE, "The mass is less than that of foam in the shapes' volume."),
    Rule("mesh-millimetres", ERROR, "A mesh is a thousand times too large: millimetres without a scale."),
)
def against_shapes(case: Case) -> Iterator[Finding]:
    if case.about.document is None or not find_spec("trimesh"):
        return
    for b in case.about.bodies:
        shapes = case.about.shapes.get(b.name)
        if not shapes:
            continue
        low, high = box(shapes)
        diagonal = float(np.linalg.norm(high - low))
        if diagonal > 20 and not all(s.solid for s in shapes):
            yield finding(
                case,
                "mesh-millimetres",
                b,
                f"its shapes are {diagonal:.3g} m across",
                why=f"as millimetres they are {diagonal / 1e3:.2g} m: contacts and volumes are 1e9 times too large",
                fix='scale="0.001 0.001 0.001"',
            )
            continue
        if b.mass <= LIGHT or diagonal == 0:
            continue
        yield from _masses(case, b, shapes, low, high, diagonal)


def box(shapes: list[Shape]) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the bounding box in the link's axes."""
    points = np.concatenate([_corners(s) for s in shapes])
    return points.min(axis=0), points.max(axis=0)


def _corners(s: Shape) -> np.ndarray:
    corners = np.array(list(product(*np.asarray(s.mesh.bounds).T)))
    return np.asarray(corners @ s.placement[:3, :3].T + s.placement[:3, 3])


def _masses(
    case: Case, b: Body, shapes: list[Shape], low: np.ndarray, high: np.ndarray, diagonal: float
) -> Iterator[Finding]:
    margin = MARGIN * diagonal + LEAST_MARGIN
    out = float(np.linalg.norm(np.maximum(np.maximum(low - b.com, b.com - high), 0)))
    middle = (low + high) / 2
    if out > margin:
        effect = case.effects.of_body(b, b.mass, middle, b.tensor)
        yield finding(
            case,
            "com-outside",
            b,
            f"centre of mass {1e3 * out:.3g} mm outside of shapes {1e3 * diagonal:.3g} mm across",
            effect=effect,
            why=f"with the centre in the middle of its shapes, {effect.says}",
            fix="the origin of <inertial> may be in another frame, unit or sign",
        )
        return
    far = np.maximum(high + margin - b.com, b.com - (low - margin))
    most = b.mass * np.array([far[1] ** 2 + far[2] ** 2, far[0] ** 2 + far[2] ** 2, far[0] ** 2 + far[1] ** 2])
    ratio = float((np.diag(b.tensor) / most).max())
    if ratio > 1:
        sides = high - low
        solid = b.mass / 12 * np.diag([(sides**2).sum() - x**2 for x in sides])
        effect = case.effects.of_body(b, b.mass, b.com, solid)
        yield finding(
            case,
            "inertia-beyond-shape",
            b,
            f"a moment is {ratio:.3g} times what all mass at the shapes' edge has",
            effect=effect,
            why=f"as a solid box of its size, {effect.says}",
            fix="export the tensor again, in kg m^2",
        )
    volume = float(np.prod(np.maximum(high - low, 1e-4)))
    if b.mass / volume > OSMIUM and diagonal > DUMMY:
        effect = case.effects.of_body(b, 2700 * volume, b.com, b.tensor)
        yield finding(
            case,
            "too-dense",
            b,
            f"{b.mass:g} kg in a box of {1e6 * volume:.3g} cm^3: {b.mass / volume:.2g} kg/m^3",
            effect=effect,
            why=f"osmium has {OSMIUM:g}; with the density of aluminium, {effect.says}",
            fix="the mass is in grams or a placeholder, or the shape is only part of the link",
        )
    elif b.mass / volume < EMPTY and diagonal > 0.05:
        effect = case.effects.of_body(b, 100 * volume, b.com, b.tensor)
        yield finding(
            case,
            "too-light",
            b,
            f"{b.mass:g} kg in a box of {1e3 * volume:.3g} l: {b.mass / volume:.2g} kg/m^3",
            effect=effect,
            why=f"foam has 20 kg/m^3; with a light structure of 100, {effect.says}",
            fix="the mass is a placeholder, or in tonnes",
        )


@rules(
    Rule(
        "tensor-about-wrong-point", WARNING, "The tensor is that of the shape about the link's origin, not its centre."
    ),
    Rule("tensor-turned", WARNING, "The tensor is that of the shape in other axes."),
)
def wrong_frame(case: Case) -> Iterator[Finding]:
    if case.about.document is None or not find_spec("trimesh"):
        return
    for b in case.about.bodies:
        shapes = case.about.shapes.get(b.name)
        if not shapes or b.mass <= LIGHT or b.point or not physical(b.tensor):
            continue
        solid = uniform(shapes, b.mass)
        if solid is None or _off(b.tensor, solid) < APART:
            continue
        moved = b.tensor - steiner(b.mass, b.com)
        if _off(moved, solid) < CLOSE:
            effect = case.effects.of_body(b, b.mass, b.com, moved)
            yield finding(
                case,
                "tensor-about-wrong-point",
                b,
                f"{_off(b.tensor, solid):.0%} off a uniform solid of its shape, "
                f"{_off(moved, solid):.0%} after Steiner's terms are subtracted",
                effect=effect,
                why=f"about the centre of mass {effect.says}",
                fix="give the tensor about the centre of mass",
            )
            continue
        turned, words = _turned(b, solid)
        if turned is not None:
            effect = case.effects.of_body(b, b.mass, b.com, turned)
            yield finding(
                case,
                "tensor-turned",
                b,
                f"{_off(b.tensor, solid):.0%} off a uniform solid of its shape, {_off(turned, solid):.0%} if {words}",
                effect=effect,
                why=f"then {effect.says}",
                fix=f"{words[0].upper()}{words[1:]}: correct rpy of the inertial, or the entries",
            )


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
    candidates = [
        (b.written, "it is in the link's axes already, and rpy of the inertial turns it"),
        (R.T @ b.written @ R, "rpy of the inertial turns it the other way"),
    ]
    if np.allclose(R, np.eye(3), atol=1e-9):
        candidates = []
    for order in permutations(range(3)):
        if order != (0, 1, 2):
            P = np.eye(3)[list(order)]
            candidates.append(
                (
                    P @ b.tensor @ P.T,
                    "its axes are exchanged: "
                    + ", ".join(f"{'xyz'[i]} is {'xyz'[k]}" for i, k in enumerate(order) if i != k),
                )
            )
    best = min(candidates, key=lambda x: _off(x[0], solid))
    return best if _off(best[0], solid) < CLOSE else (None, "")
