"""A robot and its states in other units: what a code computes of both says which unit every expression has.

Lengths are 4 times as many, times 2, masses 3, so that gravity stays 9.81 where a code holds it as a number, and every
product of them (but accelerations and pure numbers) grows by a factor of its own.
"""

from __future__ import annotations

import warnings
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np

import dualpin as dp
from dualpin.crosscheck.subjects import Asking
from dualpin.errors import DualpinWarning

LENGTH, TIME, MASS = 4.0, 2.0, 3.0
FORCE = MASS * LENGTH / TIME**2
GROWS = {"xyz": LENGTH, "value": MASS, **dict.fromkeys(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), MASS * LENGTH**2)}
"""Attributes of a URDF file; an axis is a direction."""


def rescaled(ask: Asking) -> Asking:
    """The same question in other units; joints of one coordinate on a fixed or floating base."""
    tree = ET.fromstring(ask.text)
    for e in tree.iter():
        for name in GROWS.keys() & e.attrib.keys():
            if e.tag in ("origin", "mass", "inertia"):
                e.set(name, " ".join(repr(float(x) * GROWS[name]) for x in e.get(name, "").split()))
    slides = {e.get("name") for e in tree.iter("joint") if e.get("type") == "prismatic"}
    text = ET.tostring(tree, encoding="unicode")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)  # the question was made with them
        robot = dp.loads(text, floating=ask.floating)
    q, v = np.ones(robot.nq), np.ones(robot.nv)
    if ask.floating:
        q[:3], v[3:6] = LENGTH, LENGTH
    for j in robot:
        if j.name in slides:
            q[j.q], v[j.v] = LENGTH, LENGTH
    force = FORCE * LENGTH / v
    grows = {"q": q, "v": v / TIME, "a": v / TIME**2, "tau": force, "f_ext": np.repeat([FORCE * LENGTH, FORCE], 3)}
    states = {k: x * grows[k] for k, x in ask.states.items()}
    made = replace(ask, robot=robot, text=text, states=states)
    made.__dict__["frames"] = ask.frames
    return made
