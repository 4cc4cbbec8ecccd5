"""Descriptions from the text of a URDF."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from lxml import etree

from ...errors import DualpinError
from ...io.catalogue import find
from ...io.xml import parse
from ...model.robot import Robot
from ..subjects.asking import Asking
from .description import ENTRIES, Body, Description, Part, fixed_axes


def describe(text: str, robot: Robot) -> Description:
    """The description of a URDF's text, in the order of the robot that was read from it."""
    document = parse(text.encode(), robot.name)
    armature = {j.name: tuple(float(x) for x in j.armature) for j in robot}
    coupled = {j.name: j.mimic for j in robot}
    parts = []
    for frame in robot.frames:
        if frame.role in ("joint", "fixed_joint") and frame.name in document.joints:
            name = frame.name
            part = _part(document.joints[name], document.links)
            parts.append(replace(part, armature=armature.get(name, ()), mimic=coupled.get(name)))
    x, y, z = (float(c) for c in robot.gravity)
    mimics = {name: _mimic(e.find("mimic")) for name, e in document.joints.items() if e.find("mimic") is not None}
    listed, links = (tuple(e.get("name") for e in document.root.findall(tag)) for tag in ("joint", "link"))
    base = _body(document.links[document.base])
    return Description(document.base, base, tuple(parts), (x, y, z), listed, links, mimics)


Origins = dict[str, list[tuple[np.ndarray, np.ndarray]]]
"""Of links: xyz and rpy of some elements."""


def shapes(asked: Asking) -> dict[str, Origins]:
    """Of all <visual> and all <collision>, if there is a file to look at."""
    found: dict[str, Origins] = {"visual": {}, "collision": {}}
    try:
        path = find(asked.robot.source or asked.name)
        whole = parse(path.read_bytes(), str(path)).whole
    except (OSError, DualpinError):
        return found
    for link in () if whole is None else whole.findall("link"):
        for tag, of in found.items():
            origins = [e.find("origin") for e in link.findall(tag)]
            of[link.get("name")] = [(_numbers(e, "xyz", "0 0 0"), _numbers(e, "rpy", "0 0 0")) for e in origins]
    return found


def _mimic(e: Any) -> tuple[str, float, float]:
    return e.get("joint"), float(e.get("multiplier") or 1), float(e.get("offset") or 0)


def _part(e: Any, links: Any) -> Part:
    child = e.find("child").get("link")
    origin, axis, dynamics = e.find("origin"), e.find("axis"), e.find("dynamics")
    rpy = _numbers(origin, "rpy", "0 0 0")
    told = None if axis is None else _numbers(axis, "xyz", "1 0 0")
    damping, friction = (0.0 if dynamics is None else float(dynamics.get(k) or 0) for k in ("damping", "friction"))
    return Part(
        e.get("name"), e.get("type"), e.find("parent").get("link"), child, _numbers(origin, "xyz", "0 0 0"), rpy,
        fixed_axes(rpy), told, _body(links[child]), damping, friction,
    )  # fmt: skip


def _body(link: Any) -> Body | None:
    i = link.find("inertial")
    if i is None or i.find("mass") is None:
        return None
    t, origin = i.find("inertia"), i.find("origin")
    xx, xy, xz, yy, yz, zz = (0.0 if t is None else float(t.get(k) or 0) for k in ENTRIES)
    rpy = _numbers(origin, "rpy", "0 0 0")
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Body(float(i.find("mass").get("value")), _numbers(origin, "xyz", "0 0 0"), rpy, fixed_axes(rpy), inertia)


def _numbers(e: etree._Element | None, key: str, default: str) -> np.ndarray:
    return np.array([float(x) for x in (default if e is None else e.get(key) or default).split()])
