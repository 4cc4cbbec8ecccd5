"""The links of a document, checked: names, masses, inertias."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot

import numpy as np
from lxml import etree

from ..errors import UrdfError
from ..spatial.arrays import to_matrix
from .document import VERSIONS, Document, Owner, short, unused
from .write import roll_pitch_yaw

INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
PRODUCTS = ("ixy", "ixz", "iyz")
PRINTED = 1e-6  # relative: six printed digits are common
ROUNDING = 1e-12  # relative: eigenvalues of a 3 x 3 matrix in double precision


def named(document: Document, tag: str, into: dict[str, etree._Element]) -> Iterator[tuple[Owner, etree._Element]]:
    """Every <tag> with its name; two of one name are refused."""
    for e in document.root.findall(tag):
        name = e.get("name")
        if not name:
            document.fail(e, f"<{tag}> without a name")
        if name in into:
            document.fail(e, f"{tag} {name!r} is defined twice (first on line {into[name].sourceline})")
        into[name] = e
        yield Owner(tag, name), e


def read_links(document: Document) -> None:
    """Check the links, and fill `document.links`."""
    unnamed = "" if document.root.get("name") else "<robot> has no name, and "
    _name_the_nameless(document)
    for owner, link in named(document, "link", document.links):
        inertial = document.one(link, "inertial", owner)
        if inertial is None:
            continue
        if not len(inertial):
            document.note("empty <inertial>, read as no mass", owner)
            link.remove(inertial)
            continue
        check_origin(document, inertial, owner._replace(part=" <inertial>"))
        _read_inertial(document, inertial, owner)
    if not document.links:
        raise UrdfError(f"{document.source}: {unnamed}no <link> in the robot")


def _name_the_nameless(document: Document) -> None:
    """A robot or a link without a name gets the file's name, as no other element can refer to it."""
    stem = document.stem
    if not document.root.get("name"):
        document.root.set("name", stem)
        document.notes.add(f"<robot> without a name; {stem!r} is used")
    links = document.root.findall("link")
    taken = {e.get("name") for e in links}
    for e in links:
        if not e.get("name"):
            name = unused(stem, taken)
            e.set("name", name)
            document.notes.add("<link> without a name, that of the file is used", "link", name, f"line {e.sourceline}")


def _read_inertial(document: Document, inertial: etree._Element, owner: Owner) -> None:
    mass, inertia = (document.one(inertial, tag, owner._replace(part=" <inertial>")) for tag in ("mass", "inertia"))
    if mass is None:
        document.fail(inertial, f"{owner}: <inertial> without <mass>")
    m = document.number(mass, "value", owner)
    if m < 0:
        document.fail(mass, f"{owner}: mass is {m:g} kg; zero or more expected")
    if inertia is None or not inertia.attrib:
        document.note("<inertial> without <inertia>: rotational inertia zero, as Pinocchio reads it", owner)
        _without_rotation(inertial, inertia)
        return
    given = {key: document.number(inertia, key, owner) for key in INERTIA if key in inertia.attrib}
    for key in INERTIA:
        if key not in given and key not in PRODUCTS:
            document.number(inertia, key, owner)  # fails, with the words for it
    missing = [key for key in PRODUCTS if key not in given]
    if missing:
        document.note(
            "<inertia> without all products: rotational inertia zero, as Pinocchio reads it", owner, ", ".join(missing)
        )
        _without_rotation(inertial, inertia)
        return
    ixx, ixy, ixz, iyy, iyz, izz = given.values()
    _judge(document, owner, m, np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]))


def _without_rotation(inertial: etree._Element, inertia: etree._Element | None) -> None:
    if inertia is not None:
        inertial.remove(inertia)
    etree.SubElement(inertial, "inertia", dict.fromkeys(INERTIA, "0.0"))


def _judge(document: Document, owner: Owner, mass: float, inertia: np.ndarray) -> None:
    """Notes on an inertia that no rigid body has.  Zero altogether is a point mass, and fine."""
    if not inertia.any():
        return
    if mass == 0:
        document.note("rotational inertia without mass", owner)
    size = float(np.abs(inertia).max())  # squares of the largest numbers overflow
    low, middle, high = np.linalg.eigvalsh(inertia / size)
    if low < -PRINTED * abs(high):
        document.note("inertia is not positive definite, it has negative eigenvalues", owner, f"{low * size:.3g}")
    elif low <= ROUNDING * high:
        document.note("inertia has zero eigenvalues (no body but a thin rod or a point has them)", owner)
    elif low + middle < high * (1 - PRINTED):
        document.note("inertia breaks the triangle inequality (no body has it)", owner)


# --- places ----------------------------------------------------------------------------------------


def check_origin(document: Document, parent: etree._Element, owner: Owner) -> etree._Element | None:
    """The <origin> of an element, with six numbers; a quaternion of URDF 1.1 becomes roll, pitch and yaw."""
    origin = document.one(parent, "origin", owner)
    if origin is None:
        return None
    for attribute in origin.attrib:
        if attribute == "quat_xyzw":
            _turn(document, origin, owner)
        elif attribute not in ("xyz", "rpy"):
            if "quat" in attribute.lower() or attribute.lower() in ("wxyz", "xyzw", "axis_angle", "axisangle"):
                document.fail(
                    origin, f"{owner}: <origin> has the attribute {attribute!r}; only xyz and rpy, and quat_xyzw "
                    "of URDF 1.1, are defined"
                )  # fmt: skip
            document.note("<origin> has attributes besides xyz and rpy, ignored", owner, attribute)
    document.numbers(origin, "xyz", 3, owner, "0 0 0")
    document.numbers(origin, "rpy", 3, owner, "0 0 0")
    return origin


def _turn(document: Document, origin: etree._Element, owner: Owner) -> None:
    """quat_xyzw of an <origin> to rpy."""
    text = origin.get("quat_xyzw", "")
    if document.root.get("version", VERSIONS[0]) not in VERSIONS[1:]:
        document.fail(
            origin, f"{owner}: <origin quat_xyzw> is of URDF 1.1, and other readers ignore it in a <robot> without "
            f'version="1.1"; only xyz and rpy are defined before'
        )  # fmt: skip
    if origin.get("rpy") is not None:
        document.fail(origin, f"{owner}: <origin> has rpy and quat_xyzw; one orientation expected")
    x, y, z, w = document.numbers(origin, "quat_xyzw", 4, owner)
    norm = hypot(x, y, z, w)
    if norm < PRINTED:
        document.fail(origin, f"{owner}: <origin quat_xyzw> is {short(text)}; a unit quaternion expected, this is zero")
    if abs(norm - 1) > PRINTED:
        document.note("quat_xyzw was normalised", owner, f"length {norm:.6g}")
    R = to_matrix(np.array([w, x, y, z, 0, 0, 0, 0]) / norm)[:3, :3]
    del origin.attrib["quat_xyzw"]
    origin.set("rpy", " ".join(map(repr, roll_pitch_yaw(R))))
