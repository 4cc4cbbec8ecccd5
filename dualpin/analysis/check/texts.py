"""Rules about units, names, and text that parsers read differently."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from ...io.remarks import FAR
from .description import Body, Hinge
from .findings import ERROR, NOTE, WARNING, Effect, Finding
from .rules import Case, Rule, rules
from .tensors import ball

RIGHT = {45.0, 90.0, 135.0, 180.0, 270.0, 360.0}
"""Common angles in degrees, which are improbable in radians."""


@rules(Rule("millimetres", ERROR, "Lengths look like millimetres, metres are expected.", "convert xyz to metres"))
def lengths(case: Case) -> Iterator[Finding]:
    for h in case.about.hinges:
        far = float(np.linalg.norm(h.xyz))
        if far > FAR and h.type != "fixed":
            says = f"in millimetres the joint is {far / 1e3:.3g} m away, not {far:.3g} m"
            effect = Effect("fk", far * (1 - 1e-3), "m", says)
            yield case.found("millimetres", h, f"{far:.4g} m from its parent", effect=effect)
    for b in case.about.bodies:
        far = float(np.linalg.norm(b.com))
        if far > FAR and b.mass > 0:
            says, in_metres = f"centre of mass {far:.4g} m from the link's frame", (b.mass, b.com * 1e-3, b.tensor)
            yield case.found("millimetres", b, says, "in millimetres", instead=in_metres)


@rules(Rule("degrees-in-rpy", ERROR, "Angles of an origin are in degrees, radians are expected."))
def angles(case: Case) -> Iterator[Finding]:
    at: list[Body | Hinge] = [*case.about.hinges, *case.about.bodies]
    for x in at:
        origin = None if x.element is None else x.element.find("origin" if isinstance(x, Hinge) else "inertial/origin")
        words = (origin.get("rpy", "") if origin is not None else "").split()
        values = [float(w) for w in words]
        if len(values) != 3 or max(map(abs, values)) <= 2 * pi + 0.01:
            continue
        sure = all(abs(v) in RIGHT or v == 0 for v in values)
        value = " ".join(repr(float(np.radians(v))) if v else "0" for v in values)
        turns = max(abs(v) for v in values) / (2 * pi)
        off = max(abs((v - np.radians(v) + pi) % (2 * pi) - pi) for v in values)
        effect = Effect("fk", off, "rad", f"the frame is turned by {off:.3g} rad from what is meant")
        why = f"read as radians they turn {turns:.3g} times, and the frame is {off:.3g} rad off what degrees mean"
        edits = case.about.edit(origin, "rpy", value) if sure else ()
        says, fix = f'rpy="{" ".join(words)}"', f'rpy="{value}"'
        yield case.found("degrees-in-rpy", x, says, why, fix, effect=effect, edits=edits)


@rules(
    Rule("name-characters", NOTE, "A name has blanks, slashes or other characters that tools do not take."),
    Rule("name-case", NOTE, "Two names differ only in their case.", "name them apart"),
    Rule(
        "name-shared", NOTE, "A link and a joint have the same name.",
        "name them apart, for instance with _link and _joint",
    ),
    Rule(
        "name-reserved", WARNING, "A name is that of the world or the floating base in other libraries.", "another name"
    ),
)  # fmt: skip
def names(case: Case) -> Iterator[Finding]:
    links = {b.name: b for b in case.about.bodies}
    joints = {h.name: h for h in case.about.hinges}
    for of in (links, joints):
        lower: dict[str, list[str]] = defaultdict(list)
        for name, x in of.items():
            lower[name.lower()].append(name)
            if re.search(r"[^\w.\-]", name, re.ASCII):
                why = "ROS topics and parameters, USD and MATLAB take letters, digits and _: no term changes"
                fix = f"{re.sub(r'[^a-zA-Z0-9_.-]+', '_', name)!r}, where it is referred to as well"
                yield case.found("name-characters", x, f"the name {name!r}", why, fix)
        for same in lower.values():
            if len(same) > 1:
                why = "files and topics named after them are one on some systems: no term changes"
                yield case.found("name-case", of[same[1]], " and ".join(map(repr, same)), why)
    described = case.about.document is not None  # links of robots built in code are named after their joints
    for name in sorted(links.keys() & joints.keys()) if described else ():
        why = "Gazebo refuses equal names, and frames of that name mean one or the other: J and FK of another frame"
        yield case.found("name-shared", joints[name], f"there is also a link {name!r}", why)
    for name in ("universe", "root_joint"):
        if described and name in joints and joints[name].type != "fixed":
            why = "Pinocchio calls the joint of a floating base root_joint, and the world universe: "
            yield case.found("name-reserved", joints[name], f"the name {name!r}", f"{why}such a model is refused")


@dataclass(frozen=True)
class Read:
    """A rule about what the reader noted: how its notes begin, and what other readers do."""

    rule: Rule
    notes: tuple[str, ...]
    why: str


def _read(id: str, severity: str, says: str, notes: str | tuple[str, ...], why: str, fix: str) -> Read:
    return Read(Rule(id, severity, says, fix), (notes,) if isinstance(notes, str) else notes, why)


# the longer of two beginnings comes first
READ = (
    _read("several-elements", WARNING,
          "An element stands twice where one is expected: a second <inertial>, for instance.",
          "several elements of one kind", "the first is used here, others take the last", "keep one"),
    _read("missing-products", WARNING, "A tensor lacks some of its products.", "<inertia> without all products",
          "Pinocchio reads a tensor of zeros, others zero products", "write the products, 0 if they are"),
    _read("missing-tensor", WARNING, "An inertial has a mass and no tensor.", "<inertial> without <inertia>",
          "it is read as zero: a point mass", "write the tensor"),
    _read("missing-limit", WARNING, "A joint that needs limits has none.",
          ("revolute joint without <limit>", "prismatic joint without <limit>"),
          "Pinocchio refuses the file; q has no bounds here", "give <limit>"),
    _read("missing-bound", WARNING, "Limits lack lower or upper.", "<limit> without lower or upper",
          "it is read as 0, so q stops there", "give lower and upper"),
    _read("missing-effort", NOTE, "Limits lack effort or velocity.", "<limit> without",
          "urdfdom refuses the file, others take 0 or infinity", "give effort and velocity"),
    _read("axis-length", NOTE, "An axis is no unit vector.", "<axis> that is no unit vector",
          "it is normalised; libraries that do not scale q and J by its length", "a unit vector"),
    _read("unknown-attribute", WARNING, "An attribute is none of URDF's.", "<origin> has attributes besides",
          "nobody reads it, so what it says is lost", "remove it"),
    _read("wrong-case", WARNING, "A tag is written in capitals.", "elements that no reader knows",
          "tags are lower case, so the element is lost", "write it in lower case"),
    _read("left-xacro", NOTE, "Xacro was left in the file.", "xacro that was not expanded",
          "it is no URDF, and some readers refuse it", "expand the file with xacro"),
    _read("blanks-in-type", WARNING, "The type of a joint has blanks around it.", "blanks around the type",
          "other readers do not know the type", "remove the blanks"),
    _read("quaternion-length", WARNING, "A quaternion is not of unit length.", "quat_xyzw was normalised",
          "others may scale the frame", "a unit quaternion"),
    _read("unnamed", WARNING, "The robot or a link has no name.", ("<robot> without a name", "<link> without a name"),
          "Pinocchio refuses the file", "give it a name"),
)  # fmt: skip


@rules(*(x.rule for x in READ))
def read_otherwise(case: Case) -> Iterator[Finding]:
    """What the reader noted, element by element."""
    document = case.about.document
    if document is None:
        return
    at: dict[tuple[str, str], Body | Hinge] = {("link", b.name): b for b in case.about.bodies}
    at |= {("joint", h.name): h for h in case.about.hinges}
    for kind, tag, name, detail in document.notes.each():
        read = next((r for r in READ if kind.startswith(r.notes)), None)
        if read is None:
            continue
        rule, x, says = read.rule.id, at.get((tag, str(name))), f"{kind}{f' ({detail})' if detail else ''}"
        if rule in ("missing-products", "missing-tensor") and isinstance(x, Body):
            yield _without_tensor(case, x, read, says)
        elif rule == "axis-length" and isinstance(x, Hinge):
            yield _axis(case, x, detail)
        else:
            yield case.found(rule, x, says, read.why)


def _without_tensor(case: Case, b: Body, read: Read, says: str) -> Finding:
    e = None if b.element is None else b.element.find("inertial/inertia")
    diagonal = [0.0 if e is None else float(e.get(k, 0) or 0) for k in ("ixx", "iyy", "izz")]
    J = b.rotation @ np.diag(diagonal) @ b.rotation.T if any(diagonal) else ball(b.mass)
    what = "what is written" if any(diagonal) else f"a ball of water of {b.mass:g} kg"
    return case.found(read.rule.id, b, says, f"{read.why}; with {what},", instead=(b.mass, b.com, J))


def _axis(case: Case, h: Hinge, detail: str) -> Finding:
    e = None if h.element is None else h.element.find("axis")
    words = [] if e is None else e.get("xyz", "").split()
    u = np.array([float(w) for w in words]) if len(words) == 3 else np.zeros(3)
    length = float(np.linalg.norm(u))
    value = " ".join(repr(float(x) + 0.0) for x in u / length) if length else ""
    effect = Effect("fk", abs(length - 1), "", f"where it is not normalised, a coordinate counts {length:.6g} times")
    says, why = f'axis "{" ".join(words)}" ({detail})', f"dualpin and Pinocchio normalise it; {effect.says}"
    edits = case.about.edit(e, "xyz", value) if value and e is not None else ()
    return case.found("axis-length", h, says, why, f'xyz="{value}"', effect=effect, edits=edits)
