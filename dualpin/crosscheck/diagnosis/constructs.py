"""Constructs of URDF that some readers do not read, and how to rewrite them.

Each construct is an edit of the XML that leaves a file which every reader should read.  Some edits change what
the file says: they serve to find out what a reader refuses, never to compare numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from lxml import etree

from ...io.xml import KEPT

MOVING = ("revolute", "continuous", "prismatic")
MOMENTS = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
PRODUCTS = ("ixy", "ixz", "iyz")
SMALL = {"mass": "1e-3", "moment": "1e-6"}  # of a body that weighs next to nothing, and is possible
LIMIT = {"lower": "-3.2", "upper": "3.2", "effort": "1e3", "velocity": "1e3"}


@dataclass(frozen=True)
class Construct:
    """One thing that a file may hold: what it is, how to write it otherwise, and the edit that does so.

    `edit` changes the <robot> element and returns the links or joints that it changed.
    """

    says: str
    fix: str
    edit: Callable[[Any], list[str]]


CONSTRUCTS: list[Construct] = []


def construct(says: str, fix: str) -> Callable[[Callable[[Any], Iterator[str]]], Callable[[Any], Iterator[str]]]:
    """Register an edit: a generator of the names of what it changed."""

    def register(edit: Callable[[Any], Iterator[str]]) -> Callable[[Any], Iterator[str]]:
        CONSTRUCTS.append(Construct(says, fix, lambda root: list(dict.fromkeys(edit(root)))))
        return edit

    return register


# --- elements ------------------------------------------------------------------------------------


def _joints(root: Any, *types: str) -> list[Any]:
    return [j for j in root.findall("joint") if not types or j.get("type") in types]


def _bodies(root: Any) -> Iterator[tuple[Any, Any]]:
    """Links and their <inertial>."""
    for link in root.findall("link"):
        if (inertial := link.find("inertial")) is not None:
            yield link, inertial


def _filled(owner: Any, tag: str, values: dict[str, str], first: bool = False) -> bool:
    """Whether an element, or one of its attributes, was missing and now is there."""
    e, old = owner.find(tag), None
    if e is None:
        e = etree.Element(tag)
        owner.insert(0, e) if first else owner.append(e)
    else:
        old = dict(e.attrib)
    for key, value in values.items():
        e.set(key, e.get(key) or value)
    return bool(dict(e.attrib) != old)


def _drop(owner: Any, *tags: str) -> bool:
    found = [e for tag in tags for e in owner.findall(tag)]
    for e in found:
        owner.remove(e)
    return bool(found)


def _number(e: Any, key: str) -> float:
    try:
        return float((e.get(key) or "0") if e is not None else 0)
    except ValueError:
        return 0.0


def _vector(e: Any, key: str, default: str) -> np.ndarray:
    return np.array([float(x) for x in (e.get(key) or default).split()])


def _children(root: Any) -> set[str]:
    return {j.find("child").get("link") for j in _joints(root)}


# --- what is missing -----------------------------------------------------------------------------


@construct(
    "an <inertial> without <origin>, or with half of one",
    'write <origin xyz="0 0 0" rpy="0 0 0"/> into each <inertial>',
)
def inertial_origin(root: Any) -> Iterator[str]:
    for link, inertial in _bodies(root):
        if _filled(inertial, "origin", {"xyz": "0 0 0", "rpy": "0 0 0"}, first=True):
            yield link.get("name")


@construct("a <joint> without <origin>, or with half of one", 'write <origin xyz="0 0 0" rpy="0 0 0"/> into each joint')
def joint_origin(root: Any) -> Iterator[str]:
    for j in _joints(root):
        if _filled(j, "origin", {"xyz": "0 0 0", "rpy": "0 0 0"}, first=True):
            yield j.get("name")


@construct("a joint that moves and has no <axis>", 'write <axis xyz="1 0 0"/>, which is the default')
def axis(root: Any) -> Iterator[str]:
    for j in _joints(root, *MOVING):
        if _filled(j, "axis", {"xyz": "1 0 0"}):
            yield j.get("name")


@construct("a joint without <limit>, or with half of one", "write <limit> with lower, upper, effort and velocity")
def limits(root: Any) -> Iterator[str]:
    for j in _joints(root, *MOVING):
        keys = ("effort", "velocity") if j.get("type") == "continuous" else tuple(LIMIT)
        if _filled(j, "limit", {k: LIMIT[k] for k in keys}):
            yield j.get("name")


@construct("a link without <inertial>", "give each link an <inertial>, of zeros where it weighs nothing")
def no_inertial(root: Any) -> Iterator[str]:
    for link in root.findall("link"):
        if link.find("inertial") is None:
            inertial = etree.SubElement(link, "inertial")
            etree.SubElement(inertial, "origin", xyz="0 0 0", rpy="0 0 0")
            etree.SubElement(inertial, "mass", value="0")
            etree.SubElement(inertial, "inertia", dict.fromkeys(MOMENTS, "0"))
            yield link.get("name")


@construct(
    "an <inertia> without all of its six numbers", "write ixx, ixy, ixz, iyy, iyz and izz, also those that are zero"
)
def six_moments(root: Any) -> Iterator[str]:
    for link, inertial in _bodies(root):
        if _filled(inertial, "inertia", dict.fromkeys(MOMENTS, "0")):
            yield link.get("name")


# --- joints --------------------------------------------------------------------------------------


@construct("prismatic joints", "hold them with fixed joints, or judge a robot whose joints turn; the file is correct")
def prismatic(root: Any) -> Iterator[str]:
    for j in _joints(root, "prismatic"):
        j.set("type", "revolute")
        yield j.get("name")


@construct("continuous joints", "write them as revolute, with the limits that you use")
def continuous(root: Any) -> Iterator[str]:
    for j in _joints(root, "continuous"):
        j.set("type", "revolute")
        _filled(j, "limit", LIMIT)
        yield j.get("name")


@construct("planar or floating joints", "write them as a chain of prismatic and revolute joints, or hold them fixed")
def planar(root: Any) -> Iterator[str]:
    for j in _joints(root, "planar", "floating"):
        j.set("type", "fixed")
        _drop(j, "axis", "limit", "dynamics", "mimic")
        yield j.get("name")


@construct(
    "fixed joints with <axis>, <limit>, <dynamics> or <mimic>",
    "remove these elements: a fixed joint has no use for them",
)
def fixed_extras(root: Any) -> Iterator[str]:
    for j in _joints(root, "fixed"):
        if _drop(j, "axis", "limit", "dynamics", "mimic"):
            yield j.get("name")


@construct(
    "continuous joints with lower and upper limits",
    "remove lower and upper of a continuous joint: they mean nothing there",
)
def endless_limits(root: Any) -> Iterator[str]:
    for j in _joints(root, "continuous"):
        limit = j.find("limit")
        if limit is not None and ("lower" in limit.attrib or "upper" in limit.attrib):
            limit.attrib.pop("lower", None), limit.attrib.pop("upper", None)
            yield j.get("name")


@construct("limits of no effort or no velocity", "write the effort and velocity that the joint has")
def zero_effort(root: Any) -> Iterator[str]:
    for j in _joints(root, *MOVING):
        limit = j.find("limit")
        for key in ("effort", "velocity"):
            if limit is not None and key in limit.attrib and _number(limit, key) <= 0:
                limit.set(key, LIMIT[key])
                yield j.get("name")


@construct("limits that leave no room", "write a lower limit that is below the upper one")
def no_room(root: Any) -> Iterator[str]:
    for j in _joints(root, "revolute", "prismatic"):
        limit = j.find("limit")
        if limit is not None and _number(limit, "lower") >= _number(limit, "upper"):
            limit.set("lower", LIMIT["lower"]), limit.set("upper", LIMIT["upper"])
            yield j.get("name")


@construct("<mimic>", "remove it: the joint then moves by itself, and a value can be given that follows")
def mimic(root: Any) -> Iterator[str]:
    for j in _joints(root):
        if _drop(j, "mimic"):
            yield j.get("name")


@construct("<dynamics>", "remove it: damping and friction are no part of what is compared")
def dynamics(root: Any) -> Iterator[str]:
    for j in _joints(root):
        if _drop(j, "dynamics"):
            yield j.get("name")


@construct("an axis that is not +x, +y or +z", "turn the joint's <origin> so that its axis is x, y or z")
def plain_axis(root: Any) -> Iterator[str]:
    for j in _joints(root, *MOVING):
        e = j.find("axis")
        if e is not None and sorted(_vector(e, "xyz", "1 0 0")) != [0, 0, 1]:
            e.set("xyz", "0 0 1")
            yield j.get("name")


# --- bodies --------------------------------------------------------------------------------------


@construct("an <inertial> on the root link", "put a link without mass before it, and fix it there")
def root_inertial(root: Any) -> Iterator[str]:
    carried = _children(root)
    for link in root.findall("link"):
        if link.get("name") not in carried and _drop(link, "inertial"):
            yield link.get("name")


@construct("an <inertial> without mass", "remove the <inertial> of a link that weighs nothing")
def empty_inertial(root: Any) -> Iterator[str]:
    for link, inertial in list(_bodies(root)):
        if _number(inertial.find("mass"), "value") == 0:
            link.remove(inertial)
            yield link.get("name")


@construct("an <inertial> on a link that a fixed joint carries", "merge these bodies into the links that carry them")
def fixed_inertial(root: Any) -> Iterator[str]:
    fixed = {j.find("child").get("link") for j in _joints(root, "fixed")}
    for link in root.findall("link"):
        if link.get("name") in fixed and _drop(link, "inertial"):
            yield link.get("name")


@construct("links without mass", "give each of them a small mass and inertia, or fix it to the next")
def massless(root: Any) -> Iterator[str]:
    for link in root.findall("link"):
        inertial = link.find("inertial")
        if inertial is None or _number(inertial.find("mass"), "value") == 0:
            _drop(link, "inertial")
            inertial = etree.SubElement(link, "inertial")
            etree.SubElement(inertial, "origin", xyz="0 0 0", rpy="0 0 0")
            etree.SubElement(inertial, "mass", value=SMALL["mass"])
            etree.SubElement(
                inertial, "inertia", {k: SMALL["moment"] if i == j else "0" for k, (i, j) in MOMENTS.items()}
            )
            yield link.get("name")


@construct(
    "an inertia that no body can have (a moment that is not positive, or above the sum of the two others)",
    "measure or compute the inertia again: principal moments a, b, c are positive, and a + b >= c",
)
def triangle(root: Any) -> Iterator[str]:
    for link, inertial in _bodies(root):
        e = inertial.find("inertia")
        if e is None or _number(inertial.find("mass"), "value") <= 0:
            continue
        J = np.zeros((3, 3))
        for key, (i, j) in MOMENTS.items():
            J[i, j] = J[j, i] = _number(e, key)
        w, V = np.linalg.eigh(J)
        if w[0] <= 0 or w[0] + w[1] < w[2]:
            J = V @ np.diag(np.maximum(w, max(w[2], 1e-9))) @ V.T
            for key, (i, j) in MOMENTS.items():
                e.set(key, repr(float(J[i, j])))
            yield link.get("name")


@construct("products of inertia", "turn the <inertial> (rpy) so that its axes are the principal ones")
def products(root: Any) -> Iterator[str]:
    for link, inertial in _bodies(root):
        e = inertial.find("inertia")
        if e is not None and any(_number(e, k) for k in PRODUCTS):
            for key in PRODUCTS:
                e.set(key, "0")
            yield link.get("name")


@construct(
    "an <inertial> whose axes are turned (rpy)", "write the inertia in the link's axes, R I R^T, with rpy of zeros"
)
def turned(root: Any) -> Iterator[str]:
    for link, inertial in _bodies(root):
        e = inertial.find("origin")
        if e is not None and _vector(e, "rpy", "0 0 0").any():
            e.set("rpy", "0 0 0")
            yield link.get("name")


# --- writing -------------------------------------------------------------------------------------


@construct("names of other characters than letters, digits and _", "rename them: a letter, then letters, digits and _")
def odd_names(root: Any) -> Iterator[str]:
    yield from _renamed(root, lambda tag, name: bool(re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII)))


@construct("a link and a joint of one name", "give each link and each joint a name of its own")
def shared_names(root: Any) -> Iterator[str]:
    links = {link.get("name") for link in root.findall("link")}
    yield from _renamed(root, lambda tag, name: tag == "link" or name not in links)


def _renamed(root: Any, good: Callable[[str, str], bool]) -> Iterator[str]:
    taken = {e.get("name") for e in root if e.tag in KEPT["robot"]}
    new: dict[tuple[str, str], str] = {}
    for e in root:
        if e.tag in KEPT["robot"] and not good(e.tag, name := e.get("name")):
            plain = f"{e.tag}_{re.sub(r'[^A-Za-z0-9_]', '_', name)}"
            while plain in taken:
                plain += "_"
            taken.add(plain)
            new[e.tag, name] = plain
            e.set("name", plain)
            yield name
    for j in _joints(root):
        for tag, key, kind in (("parent", "link", "link"), ("child", "link", "link"), ("mimic", "joint", "joint")):
            e = j.find(tag)
            if e is not None:
                e.set(key, new.get((kind, e.get(key)), e.get(key)))


@construct("joints that are listed before the joint that carries them", "list links first, then joints, parents first")
def listed_late(root: Any) -> Iterator[str]:
    waiting, reached, ordered = _joints(root), set(), []
    reached = {link.get("name") for link in root.findall("link")} - _children(root)
    while ready := [j for j in waiting if j.find("parent").get("link") in reached]:
        reached |= {j.find("child").get("link") for j in ready}
        ordered += ready
        waiting = [j for j in waiting if j not in ready]
    seen = {link.get("name") for link in root.findall("link")} - _children(root)
    late = []
    for j in _joints(root):
        if j.find("parent").get("link") not in seen:
            late.append(j.get("name"))
        seen.add(j.find("child").get("link"))
    if late:
        for j in ordered:
            root.remove(j)
            root.append(j)
    yield from late


@construct(
    "elements that are no mechanics (<transmission>, <gazebo>, ...)", "remove them from the file that is given to it"
)
def others(root: Any) -> Iterator[str]:
    for owner in [root, *root.iter(*(t for t in KEPT if t != "robot"))]:
        for e in list(owner):
            if not isinstance(e.tag, str) or e.tag not in KEPT[owner.tag]:
                owner.remove(e)
                yield f"<{e.tag}>" if isinstance(e.tag, str) else "comments"
