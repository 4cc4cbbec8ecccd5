"""Notes on a robot as read: joints that move no mass, joints that are left free, unlikely units."""

from __future__ import annotations

from math import hypot, inf, pi, sqrt

from lxml import etree

from ..model.robot import Joint, Robot
from .document import Document

FAR = 10.0  # m; the parts of robots are closer together, in millimetres all are farther
TURNS = 8 * pi  # rad; four turns: limits of cables are smaller, 90 degrees are more
MOST_DEGREES = 720.0
MILLIMETRES = "lengths look like millimetres (metres are expected)"
TOO_WIDE = f"inertia does not fit the mass, its radius of gyration is beyond {FAR:g} m (kg mm^2, or a placeholder)"
DEGREES = "angles look like degrees (radians are expected)"


def remark(document: Document, robot: Robot, mimic: bool) -> None:
    """Add notes on the finished robot to those of its document."""
    _masses(document, robot)
    if not mimic:
        _free_mimics(document)
    _units(document)


def _masses(document: Document, robot: Robot) -> None:
    """The mass matrix is singular where a joint moves no mass."""
    if robot.nv and not any(map(_has_inertia, robot)):
        document.notes.add(
            "robot without mass: no moving link has <mass> or <inertia>, so inverse dynamics is zero and forward "
            "dynamics has no answer"
        )
        return
    for j in moving_no_mass(robot):
        document.notes.add("the joint moves no mass, so forward dynamics has no answer", "joint", j.name)


def moving_no_mass(robot: Robot) -> list[Joint]:
    """The joints of which some velocity gives no body any energy; what shares coordinates moves the mass of all."""
    inner: set[int] = set()  # those that carry a joint which moves mass
    for j in reversed(robot):
        if j.parent is not None and (j.index in inner or _has_inertia(j)):
            inner.add(j.parent.index)
    leading = {j.v.start for j in robot if j.mimic is not None}
    return [j for j in robot if j.mimic is None and j.v.start not in leading and j.index not in inner and _is_still(j)]


def _has_inertia(j: Joint) -> bool:
    return any(float(x) for x in j.inertia.parameters)


def _is_still(j: Joint) -> bool:
    """Whether some velocity of the joint gives its own body no energy."""
    return any(float(S.dot(j.inertia(S)).dual) == 0 for S in j.model.screws)


def _free_mimics(document: Document) -> None:
    for name, e in document.joints.items():
        tag = e.find("mimic")
        if tag is not None and e.get("type") != "fixed" and tag.get("joint") in document.joints:
            document.notes.add("<mimic> is not followed, the joint is free (mimic=True makes it follow)", "joint", name)


# --- units -----------------------------------------------------------------------------------------


def _units(document: Document) -> None:
    for name, link in document.links.items():
        inertial = link.find("inertial")
        if inertial is None:
            continue
        if hypot(*_values(inertial.find("origin"), "xyz")) > FAR:
            document.notes.add(MILLIMETRES, "link", name)
        elif (radius := _radius(inertial)) > FAR:
            document.notes.add(TOO_WIDE, "link", name, f"{radius:.3g} m")
    for name, joint in document.joints.items():
        kind = joint.get("type")
        origin, limit = joint.find("origin"), joint.find("limit")
        moves = kind != "fixed"
        if moves and hypot(*_values(origin, "xyz")) > FAR:
            document.notes.add(MILLIMETRES, "joint", name)
        if max(map(abs, _values(origin, "rpy"))) > 2 * pi + 0.01:
            document.notes.add(DEGREES, "joint", name, "rpy")
        bounds = [x for key in ("lower", "upper") for x in _values(limit, key)]
        largest = max(map(abs, bounds))
        # hundreds are placeholders in radians
        if kind == "revolute" and TURNS < largest <= MOST_DEGREES and largest % 100 and all(x % 5 == 0 for x in bounds):
            document.notes.add(DEGREES, "joint", name, "limit")


def _radius(inertial: etree._Element) -> float:
    """The largest radius of gyration about the centre [m]."""
    mass = _values(inertial.find("mass"), "value")[0]
    moment = max(map(abs, (x for key in ("ixx", "iyy", "izz") for x in _values(inertial.find("inertia"), key))))
    return sqrt(moment / mass) if mass > 0 else 0.0


def _values(e: etree._Element | None, attribute: str) -> list[float]:
    """The numbers of a checked attribute; zero where there is none."""
    text = None if e is None else e.get(attribute)
    return [0.0] if text is None else [x for x in map(float, text.split()) if abs(x) < inf] or [0.0]
