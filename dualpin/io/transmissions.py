"""Gears between motors and joints, as a URDF's <transmission> elements state them.

They are not part of the mechanics: a file gives the ratio and nothing about the rotor.  So the ratio is kept
for `Robot.with_rotors`, which adds the rotor's inertia; no term changes without it.
"""

from __future__ import annotations

import math

from lxml import etree

from .notes import Notes

REDUCTION = "mechanicalReduction"


def reductions(root: etree._Element, notes: Notes) -> dict[str, float]:
    """Joint -> how many times faster its motor turns, of transmissions between one joint and one motor.

    The ratio stands in <actuator>, <joint> or <transmission> itself, as formats have had it.  One
    that is not a number, or is zero, is noted and dropped; several joints moved together (differentials)
    have no single ratio.
    """
    found = {}
    for transmission in _children(root, "transmission"):
        joints, motors = _children(transmission, "joint"), _children(transmission, "actuator")
        stated = [e for owner in (*motors, *joints, transmission) for e in _children(owner, REDUCTION)]
        name = joints[0].get("name") if len(joints) == 1 and len(motors) <= 1 and stated else None
        if name is None:
            continue
        text = (stated[0].text or "").strip()
        try:
            ratio = float(text)
        except ValueError:
            ratio = math.nan
        if math.isfinite(ratio) and ratio:
            found[name] = ratio
        else:
            notes.add(f"<{REDUCTION}> is no number other than zero, ignored", "joint", name, repr(text[:40]))
    return found


def _children(e: etree._Element, tag: str) -> list[etree._Element]:
    return [c for c in e if isinstance(c.tag, str) and etree.QName(c).localname == tag]
