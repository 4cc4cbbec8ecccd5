"""The bodies, joints and limits of a model as plain values, to find later what changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf, isclose
from typing import Any

from ..model.robot import Joint, Link, Robot
from ..spatial import from_matrix
from ..spatial.pose import Pose

Model = dict[str, dict[str, dict[str, Any]]]
DIGITS = 9
"""Significant digits kept: few enough to hide the rounding of another reader, more than measured values have."""
SAME = 1e-6
"""Relative difference below which two values are one: what rounding and the order of sums leave."""


def fingerprint(robot: Robot) -> Model:
    """The links and joints of a robot as they were described.

    Returns
    -------
    dict
        "links": name -> "mass" [kg], "com" [m], "inertia" about it [kg m^2] (xx xy xz yy yz zz) in the link's
        frame, "on" (the joint that moves it) and "placement" there; "joints": name -> "kind", "parent",
        "placement" (x y z, w x y z) in the parent joint's frame, "axis", "lower", "upper", "velocity", "effort".
        Robots with symbolic constants have none.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.crosscheck.fingerprint import fingerprint
    >>> fingerprint(dp.load("ur5"))["links"]["shoulder_link"]["mass"]
    3.7
    """
    if robot.numbers == "symbolic":
        return {}
    return {"links": {x.name: _link(x) for x in robot.links}, "joints": {j.name: _joint(j) for j in robot}}


def differences(old: Model, new: Model) -> Iterator[tuple[str, str, str]]:
    """(where, as it was, as it is) of everything that differs between two fingerprints; empty ones say nothing."""
    if not old or not new:
        return
    for what in ("links", "joints"):
        one = what.removesuffix("s")
        before, after = old.get(what, {}), new.get(what, {})
        for name in (n for n in before if n not in after):
            yield f"{one} {name}", "there", "absent"
        for name, facts in after.items():
            if name not in before:
                yield f"{one} {name}", "absent", "there"
                continue
            for key in dict.fromkeys([*before[name], *facts]):
                x, y = before[name].get(key), facts.get(key)
                if not _alike(x, y):
                    yield f"{one} {name}: {key}", _text(x), _text(y)


def _link(link: Link) -> dict[str, Any]:
    com, J = link.inertia.central
    x, y, z = J.rows
    xx, xy, xz, yy, yz, zz = x.x, x.y, x.z, y.y, y.z, z.z
    return {
        "mass": _short(link.inertia.mass),
        "com": _numbers(com),
        "inertia": _numbers((xx, xy, xz, yy, yz, zz)),
        "on": link.joint.name if link.joint else "",
        "placement": _place(link.placement),
    }


def _joint(joint: Joint) -> dict[str, Any]:
    limits = joint.limits
    found: dict[str, Any] = {
        "kind": joint.kind,
        "parent": joint.parent.name if joint.parent else "",
        "placement": _place(joint.placement),
        "axis": _numbers(x for s in joint.model.screws for x in (*s.real, *s.dual)),
        "lower": _numbers(limits.lower),
        "upper": _numbers(limits.upper),
        "velocity": _short(limits.velocity),
        "effort": _short(limits.effort),
    }
    if joint.mimic:
        found["mimic"] = f"{joint.mimic.joint} {_numbers((joint.mimic.multiplier, joint.mimic.offset))}"
    if any(joint.armature):
        found["armature"] = _numbers(joint.armature)
    return found


def _place(pose: Pose) -> str:
    """Position, then the unit quaternion, scalar first and not negative."""
    w, x, y, z = from_matrix(pose.array)[:4]
    sign = -1.0 if w < 0 else 1.0
    return _numbers((*pose.array[:3, 3], *(sign * v for v in (w, x, y, z))))


def _numbers(values: Iterable[Any]) -> str:
    """Numbers in one string: a list would take a line each in JSON."""
    return " ".join(f"{float(x) + 0.0:.{DIGITS}g}" for x in values)


def _short(x: Any) -> float | None:
    """A number of JSON; None where there is no bound."""
    value = float(f"{float(x):.{DIGITS}g}") + 0.0
    return value if abs(value) < inf else None


def _alike(x: Any, y: Any) -> bool:
    """Whether two values are one but for rounding; numbers of a string are measured by its largest."""
    if isinstance(x, str) and isinstance(y, str):
        xs, ys = x.split(), y.split()
        sizes = [abs(v) for v in map(_float, (*xs, *ys)) if v is not None and abs(v) < inf]
        least = SAME * max(sizes, default=0.0)
        return len(xs) == len(ys) and all(
            _near(_float(a), _float(b), least, a == b) for a, b in zip(xs, ys, strict=True)
        )
    return _near(x, y, 0.0, x == y)


def _near(x: Any, y: Any, least: float, same: bool) -> bool:
    if isinstance(x, (int, float)) and isinstance(y, (int, float)):
        return isclose(x, y, rel_tol=SAME, abs_tol=max(least, 1e-12))
    return same


def _float(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _text(x: Any) -> str:
    return "none" if x is None else f"{x:.6g}" if isinstance(x, float) else str(x)
