"""The joints of a document, checked: types, axes, limits, and that they make one tree."""

from __future__ import annotations

import math

from lxml import etree

from ..errors import nearest
from .document import Document, Owner, short
from .links import PRINTED, check_origin, named

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
MAX_JOINTS = 100_000
BOUNDED = ("revolute", "prismatic")


def read_joints(document: Document) -> None:
    """Check the joints, and fill `document.joints` and `document.base`."""
    child_of: dict[str, str] = {}
    for owner, joint in named(document, "joint", document.joints):
        if len(document.joints) > MAX_JOINTS:
            document.fail(joint, f"more than {MAX_JOINTS} joints")
        if owner.name == "universe":
            document.fail(joint, f"{owner}: the name is reserved for the world")
        kind = _kind(document, joint, owner)
        _check_ends(document, joint, owner, child_of)
        check_origin(document, joint, owner)
        _check_axis(document, joint, kind, owner)
        _check_limit(document, joint, kind, owner)
        _check_dynamics(document, joint, kind, owner)
    for name, joint in document.joints.items():
        _check_mimic(document, joint, Owner("joint", name))
    _check_tree(document)


def _kind(document: Document, joint: etree._Element, owner: Owner) -> str:
    kind = joint.get("type")
    if kind is not None and kind.strip() in JOINT_TYPES and kind != kind.strip():
        document.note("blanks around the type of a joint", owner, repr(kind))
        kind = kind.strip()
        joint.set("type", kind)
    if kind not in JOINT_TYPES:
        document.fail(joint, f"{owner}: type is {kind!r}; {nearest(str(kind), JOINT_TYPES, 'types')}")
    return kind


def _check_ends(document: Document, joint: etree._Element, owner: Owner, child_of: dict[str, str]) -> None:
    for role in ("parent", "child"):
        e = document.one(joint, role, owner)
        link = None if e is None else e.get("link")
        if not link:
            document.fail(joint, f"{owner}: no {role} link")
        if link not in document.links:
            document.fail(e, f"{owner}: {role} link {link!r} is not defined; {nearest(link, document.links, 'links')}")
    child = joint.find("child").get("link")
    if child in child_of:
        document.fail(
            joint, f"link {child!r} is the child of two joints, {child_of[child]!r} and {owner.name!r}: "
            "a tree is expected, closed loops are not supported"
        )  # fmt: skip
    child_of[child] = owner.name


def _check_axis(document: Document, joint: etree._Element, kind: str, owner: Owner) -> None:
    axis = document.one(joint, "axis", owner)
    if axis is None:
        return
    if kind in ("fixed", "floating"):  # an axis has no meaning there, and is not read
        joint.remove(axis)
        return
    text = axis.get("xyz")
    xyz = document.numbers(axis, "xyz", 3, owner)
    norm = math.hypot(*xyz)
    if kind == "planar":
        if [x / norm if norm else x for x in xyz] != [0, 0, 1]:
            document.note("the axis of a planar joint is ignored; it moves in its own xy-plane", owner)
    elif norm < 1e-6:
        document.fail(axis, f"{owner}: <axis xyz> is {short(text)}; a direction expected, this is zero")
    elif abs(norm - 1) > PRINTED:
        document.note("<axis> that is no unit vector was normalised", owner, f"length {norm:.6g}")


# --- limits ----------------------------------------------------------------------------------------


def _check_limit(document: Document, joint: etree._Element, kind: str, owner: Owner) -> None:
    limit = document.one(joint, "limit", owner)
    if limit is None:
        if kind in BOUNDED:
            document.note(f"{kind} joint without <limit>, read as without limits", owner)
        return
    for key in ("effort", "velocity"):
        value = document.number(limit, key, owner, "inf", unbounded=True)
        if value < 0:
            document.note(f"{key} limit is negative (Pinocchio refuses it)", owner, f"{value:g}")
    missing = [key for key in ("effort", "velocity") if limit.get(key) is None]
    if missing and kind != "fixed":
        document.note(f"<limit> without {' or '.join(missing)}, read as unlimited", owner)
    lower, upper = (document.number(limit, key, owner, "0", unbounded=True) for key in ("lower", "upper"))
    if kind not in BOUNDED:
        return
    if limit.get("lower") is None or limit.get("upper") is None:
        document.note("<limit> without lower or upper, read as 0", owner)
    if lower > upper:
        document.note("lower limit is above the upper one", owner, f"{lower:g} above {upper:g}")
    elif math.isinf(lower) or math.isinf(upper):
        document.note("limits that are infinite or overflow, read as none", owner, f"{lower:g} to {upper:g}")


def _check_dynamics(document: Document, joint: etree._Element, kind: str, owner: Owner) -> None:
    dynamics = document.one(joint, "dynamics", owner)
    if dynamics is None:
        return
    values = {key: document.number(dynamics, key, owner, "0") for key in ("damping", "friction")}
    for key, value in values.items():
        if value < 0:
            document.note(f"negative {key}", owner, f"{value:g}")
    if kind == "fixed":
        return
    if any(values.values()):
        used = ", ".join(f"{key} {value:g}" for key, value in values.items() if value)
        document.note("damping and friction of <dynamics> are kept, but no term contains them", owner, used)
    if dynamics.get("armature") is not None:
        document.note("armature of <dynamics> is no part of URDF, ignored", owner, dynamics.get("armature"))


def _check_mimic(document: Document, joint: etree._Element, owner: Owner) -> None:
    mimic = document.one(joint, "mimic", owner)
    if mimic is None:
        return
    target = mimic.get("joint")
    if not target:
        document.fail(mimic, f"{owner}: <mimic> without a joint")
    document.number(mimic, "multiplier", owner, "1")
    document.number(mimic, "offset", owner, "0")
    if target not in document.joints:
        document.note("<mimic> of a joint which is not defined", owner, repr(target))


# --- the tree --------------------------------------------------------------------------------------


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
