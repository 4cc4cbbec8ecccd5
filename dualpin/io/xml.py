"""From bytes to XML that can be trusted: parsed without entities, every number and reference checked.

URDFs come from strangers.  Other readers fill gaps silently (a missing mass is zero or one, an axis
of four numbers is cut to three); here each such case is an error that names the element, the
attribute, what was found, what was expected, and the line.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import NoReturn

import numpy as np
from lxml import etree

from ..errors import UrdfError, nearest

MAX_BYTES = 64 << 20
MAX_JOINTS = 100_000
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
RESERVED = ("universe", "root_joint")
_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_BLANKS = re.compile(r"[ \t\r\n]+")  # of XML; others are part of a word
# what a robot's motion depends on; meshes, materials, transmissions and simulator blocks do not
_KEPT = {
    "robot": {"link", "joint"},
    "link": {"inertial"},
    "inertial": {"origin", "mass", "inertia"},
    "joint": {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"},
}


@dataclass
class Document:
    """A checked <robot> element, its links and joints by name, and remarks on what is odd in it."""

    root: etree._Element
    source: str
    notes: list[str] = field(default_factory=list)
    links: dict[str, etree._Element] = field(default_factory=dict)
    joints: dict[str, etree._Element] = field(default_factory=dict)
    base: str = ""
    """The root link."""

    def fail(self, element: etree._Element | None, message: str) -> NoReturn:
        line = f":{element.sourceline}" if element is not None and element.sourceline else ""
        raise UrdfError(f"{self.source}{line}: {message}")

    # reading one element

    def one(self, parent: etree._Element, tag: str, what: str) -> etree._Element | None:
        """The only child of that tag, or None; of several the first, and the others are removed."""
        found = parent.findall(tag)
        if len(found) > 1:
            self.notes.append(
                f"{what} has {len(found)} <{tag}> elements (line {found[1].sourceline}); the first is used"
            )
            for other in found[1:]:
                parent.remove(other)
        return found[0] if found else None

    def numbers(
        self, e: etree._Element, attribute: str, count: int, what: str, default: str | None = None
    ) -> list[float]:
        """`count` finite decimal numbers of an attribute."""
        text = e.get(attribute, default)
        shown = f"{what}: <{e.tag} {attribute}>"
        if text is None:
            self.fail(e, f"{what}: <{e.tag}> without the attribute {attribute!r}; {_counted(count)} expected")
        words = [word for word in _BLANKS.split(text) if word]
        if len(words) != count:
            self.fail(e, f"{shown} is {_short(text)}; {_counted(count)} expected, got {len(words)}")
        values = []
        for word in words:
            if not _NUMBER.fullmatch(word) or not math.isfinite(float(word)):
                self.fail(e, f"{shown} is {_short(text)}; {_short(word)} is not a finite decimal number")
            values.append(float(word))
        if attribute in e.attrib:  # whoever reads it next finds the numbers that were checked
            e.set(attribute, " ".join(map(repr, values)))
        return values

    def number(self, e: etree._Element, attribute: str, what: str, default: str | None = None) -> float:
        return self.numbers(e, attribute, 1, what, default)[0]


def _counted(n: int) -> str:
    return "a number" if n == 1 else f"{n} numbers"


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")


def read(path: Path) -> Document:
    """The checked document of a file."""
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise UrdfError(f"{path.name}: {size >> 20} MiB; files up to {MAX_BYTES >> 20} MiB are read")
        data = path.read_bytes()
    except OSError as e:
        raise UrdfError(f"{path}: cannot be read ({e.strerror or e})") from None
    return parse(data, path.name)


def parse(data: bytes, source: str = "<bytes>") -> Document:
    """The checked document of bytes."""
    document = Document(_root(data, source), source)
    _strip(document.root)
    _read_links(document)
    _read_joints(document)
    _check_mimics(document)
    _check_tree(document)
    return document


def _strip(e: etree._Element) -> None:
    """Remove all that a robot's motion does not depend on, so that nobody has to be able to read it."""
    for child in list(e):
        if child.tag in _KEPT.get(e.tag, ()):
            _strip(child)
        else:
            e.remove(child)


def _root(data: bytes, source: str) -> etree._Element:
    # no entities, no network, no recovery: what cannot be read whole is refused whole
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False, huge_tree=False,
        recover=False, remove_comments=True, remove_pis=True,
    )  # fmt: skip
    if not data.strip():
        raise UrdfError(f"{source}: the file is empty")
    try:
        tree = etree.parse(BytesIO(data), parser)
    except etree.XMLSyntaxError as e:
        line = f":{e.lineno}" if e.lineno else ""
        hint = "; run xacro on the file first" if "prefix xacro" in str(e.msg) else ""
        raise UrdfError(f"{source}{line}: not well-formed XML: {str(e.msg).split(', line')[0]}{hint}") from None
    except (ValueError, LookupError) as e:
        raise UrdfError(f"{source}: not well-formed XML: {e}") from None
    if tree.docinfo.doctype or tree.docinfo.internalDTD is not None:
        raise UrdfError(f"{source}: a DOCTYPE (entities) has no place in a URDF and is refused")
    root = tree.getroot()
    name = etree.QName(root)
    if root.tag != "robot":
        if name.namespace and name.localname == "robot":
            raise UrdfError(
                f"{source}:{root.sourceline}: <robot> is in the namespace {name.namespace!r}; a URDF has none"
            )
        hint = {"sdf": " (SDF is not URDF)", "mujoco": " (MJCF is not URDF)"}.get(name.localname, "")
        raise UrdfError(f"{source}:{root.sourceline}: root element is <{name.localname}>, <robot> expected{hint}")
    xacro = next(
        (e for e in root.iter() if isinstance(e.tag, str) and "xacro" in (etree.QName(e).namespace or e.prefix or "")),
        None,
    )
    if xacro is not None:
        raise UrdfError(
            f"{source}:{xacro.sourceline}: <xacro:{etree.QName(xacro).localname}> is not expanded; "
            "run xacro on the file first"
        )
    if not root.get("name"):
        raise UrdfError(f"{source}:{root.sourceline}: <robot> has no name")
    return root


def _named(document: Document, tag: str, into: dict[str, etree._Element]) -> Iterable[tuple[str, str, etree._Element]]:
    for e in document.root.findall(tag):
        name = e.get("name")
        if not name:
            document.fail(e, f"<{tag}> without a name")
        if name in into:
            document.fail(e, f"{tag} {name!r} is defined twice (first on line {into[name].sourceline})")
        into[name] = e
        yield name, f"{tag} {name!r}", e


def _check_origin(document: Document, parent: etree._Element, what: str) -> None:
    origin = document.one(parent, "origin", what)
    if origin is None:
        return
    for attribute in origin.attrib:
        if attribute not in ("xyz", "rpy"):
            document.fail(origin, f"{what}: <origin> has the attribute {attribute!r}; only xyz and rpy are defined")
    document.numbers(origin, "xyz", 3, what, "0 0 0")
    document.numbers(origin, "rpy", 3, what, "0 0 0")


# --- links ---------------------------------------------------------------------------------------


def _read_links(document: Document) -> None:
    indefinite, triangle, weightless = [], [], []
    for name, what, link in _named(document, "link", document.links):
        inertial = document.one(link, "inertial", what)
        if inertial is None:
            continue
        _check_origin(document, inertial, f"{what} <inertial>")
        mass, inertia = (document.one(inertial, tag, f"{what} <inertial>") for tag in ("mass", "inertia"))
        if mass is None:
            document.fail(inertial, f"{what}: <inertial> without <mass>")
        if inertia is None:
            document.fail(inertial, f"{what}: <inertial> without <inertia>")
        m = document.number(mass, "value", what)
        if m < 0:
            document.fail(mass, f"{what}: mass is {m:g} kg; zero or more expected")
        ixx, ixy, ixz, iyy, iyz, izz = (document.number(inertia, k, what) for k in INERTIA)
        matrix = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
        if m == 0 and matrix.any():
            weightless.append(name)
        low, middle, high = np.linalg.eigvalsh(matrix)
        if not matrix.any():
            continue
        if low <= 0:
            indefinite.append(name)
        elif low + middle < high * (1 - 1e-6):  # six printed digits are common
            triangle.append(name)
    if not document.links:
        raise UrdfError(f"{document.source}: no <link> in the robot")
    for links, message in (
        (indefinite, "inertia is not positive definite"),
        (triangle, "inertia breaks the triangle inequality (no body has it)"),
        (weightless, "rotational inertia without mass"),
    ):
        if links:
            document.notes.append(f"{message}: {', '.join(links)}")


# --- joints --------------------------------------------------------------------------------------


def _read_joints(document: Document) -> None:
    child_of: dict[str, str] = {}
    for name, what, joint in _named(document, "joint", document.joints):
        if len(document.joints) > MAX_JOINTS:
            document.fail(joint, f"more than {MAX_JOINTS} joints")
        if name in RESERVED:
            document.fail(
                joint, f"{what}: the name is reserved for the {'world' if name == 'universe' else 'floating base'}"
            )
        kind = joint.get("type")
        if kind not in JOINT_TYPES:
            document.fail(joint, f"{what}: type is {kind!r}; {nearest(str(kind), JOINT_TYPES, 'types')}")
        for role in ("parent", "child"):
            e = document.one(joint, role, what)
            link = None if e is None else e.get("link")
            if not link:
                document.fail(joint, f"{what}: no {role} link")
            if link not in document.links:
                document.fail(
                    e, f"{what}: {role} link {link!r} is not defined; {nearest(link, document.links, 'links')}"
                )
        child = joint.find("child").get("link")
        if child in child_of:
            document.fail(
                joint, f"link {child!r} is the child of two joints, {child_of[child]!r} and {name!r}: "
                "a tree is expected, closed loops are not supported"
            )  # fmt: skip
        child_of[child] = name
        _check_origin(document, joint, what)
        _check_axis(document, joint, kind, what)
        _check_limit(document, joint, kind, what)
        dynamics = document.one(joint, "dynamics", what)
        if dynamics is not None:
            for key in ("damping", "friction"):
                if document.number(dynamics, key, what, "0") < 0:
                    document.notes.append(f"{what}: negative {key}")


def _check_axis(document: Document, joint: etree._Element, kind: str, what: str) -> None:
    axis = document.one(joint, "axis", what)
    if axis is None:
        return
    if kind in ("fixed", "floating"):  # it means nothing there, and is not read
        joint.remove(axis)
        return
    text = axis.get("xyz")
    xyz = document.numbers(axis, "xyz", 3, what)
    norm = math.hypot(*xyz)
    if kind == "planar":
        if [x / norm if norm else x for x in xyz] != [0, 0, 1]:
            document.notes.append(f"{what}: the axis of a planar joint is ignored; it moves in its own xy-plane")
    elif norm < 1e-6:
        document.fail(axis, f"{what}: <axis xyz> is {_short(text)}; a direction expected, this is zero")
    elif abs(norm - 1) > 1e-6:
        document.notes.append(f"{what}: the axis has length {norm:.6g} and was normalised")


def _check_limit(document: Document, joint: etree._Element, kind: str, what: str) -> None:
    limit = document.one(joint, "limit", what)
    if limit is None:
        if kind in ("revolute", "prismatic"):
            document.fail(joint, f"{what}: a {kind} joint needs a <limit> (a joint without one is of type continuous)")
        return
    needed = kind in ("revolute", "prismatic")
    for key in ("effort", "velocity"):
        document.number(limit, key, what, None if needed else "0")
    lower, upper = (document.number(limit, key, what, "0") for key in ("lower", "upper"))
    if needed and (limit.get("lower") is None or limit.get("upper") is None):
        document.notes.append(f"{what}: <limit> without lower or upper; 0 is used")
    elif needed and lower > upper:
        document.notes.append(f"{what}: lower limit {lower:g} is above the upper one {upper:g}")


def _check_mimics(document: Document) -> None:
    for name, joint in document.joints.items():
        what = f"joint {name!r}"
        mimic = document.one(joint, "mimic", what)
        if mimic is None:
            continue
        if not mimic.get("joint"):
            document.fail(mimic, f"{what}: <mimic> without a joint")
        document.number(mimic, "multiplier", what, "1")
        document.number(mimic, "offset", what, "0")
        target = mimic.get("joint")
        if target not in document.joints:
            document.notes.append(f"{what} mimics {target!r}, which is not defined")


def _check_tree(document: Document) -> None:
    children: dict[str, list[str]] = {}
    for joint in document.joints.values():
        children.setdefault(joint.find("parent").get("link"), []).append(joint.find("child").get("link"))
    moved = {c for cs in children.values() for c in cs}
    roots = [link for link in document.links if link not in moved]
    if len(roots) != 1:
        found = (
            f"{len(roots)} root links ({', '.join(roots[:4])})" if roots else "no root link (the joints form a loop)"
        )
        document.fail(document.links[roots[1]] if roots else None, f"{found}; one tree expected")
    stack, seen = [roots[0]], set()
    while stack:
        link = stack.pop()
        seen.add(link)
        stack.extend(children.get(link, ()))
    lost = [link for link in document.links if link not in seen]
    if lost:
        document.fail(
            document.links[lost[0]],
            f"{len(lost)} links ({', '.join(lost[:4])}) are not connected to {roots[0]!r} (a closed loop)",
        )
    document.base = roots[0]
