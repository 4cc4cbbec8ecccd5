"""Rules about units, names, and text that parsers read differently."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from math import pi

import numpy as np

from ...io.remarks import FAR
from .description import Body, Hinge
from .findings import ERROR, NOTE, WARNING, Effect, Finding
from .rules import Case, Rule, finding, rules

RIGHT = {45.0, 90.0, 135.0, 180.0, 270.0, 360.0}
"""Common angles in degrees, which are improbable in radians."""


@rules(Rule("millimetres", ERROR, "Lengths look like millimetres, metres are expected."))
def lengths(case: Case) -> Iterator[Finding]:
    for h in case.about.hinges:
        far = float(np.linalg.norm(h.xyz))
        if far > FAR and h.type != "fixed":
            effect = Effect(
                "fk", far * (1 - 1e-3), "m", f"in millimetres the joint is {far / 1e3:.3g} m away, not {far:.3g} m"
            )
            yield finding(
                case, "millimetres", h, f"{far:.4g} m from its parent", effect=effect, fix="convert xyz to metres"
            )
    for b in case.about.bodies:
        far = float(np.linalg.norm(b.com))
        if far > FAR and b.mass > 0:
            effect = case.effects.of_body(b, b.mass, b.com * 1e-3, b.tensor)
            yield finding(
                case,
                "millimetres",
                b,
                f"centre of mass {far:.4g} m from the link's frame",
                effect=effect,
                why=f"in millimetres {effect.says}",
                fix="convert xyz to metres",
            )


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
        yield finding(
            case,
            "degrees-in-rpy",
            x,
            f'rpy="{" ".join(words)}"',
            effect=Effect("fk", off, "rad", f"the frame is turned by {off:.3g} rad from what is meant"),
            why=f"read as radians they turn {turns:.3g} times, and the frame is {off:.3g} rad off what degrees mean",
            fix=f'rpy="{value}"',
            edits=case.about.edit(origin, "rpy", value) if sure else (),
        )


@rules(
    Rule("name-characters", NOTE, "A name has blanks, slashes or other characters that tools do not take."),
    Rule("name-case", NOTE, "Two names differ only in their case."),
    Rule("name-shared", NOTE, "A link and a joint have the same name."),
    Rule("name-reserved", WARNING, "A name is that of the world or the floating base in other libraries."),
)
def names(case: Case) -> Iterator[Finding]:
    links = {b.name: b for b in case.about.bodies}
    joints = {h.name: h for h in case.about.hinges}
    for of in (links, joints):
        lower: dict[str, list[str]] = defaultdict(list)
        for name, x in of.items():
            lower[name.lower()].append(name)
            if re.search(r"[^\w.\-]", name, re.ASCII):
                yield finding(
                    case,
                    "name-characters",
                    x,
                    f"the name {name!r}",
                    why="ROS topics and parameters, USD and MATLAB take letters, digits and _: no term changes",
                    fix=f"{re.sub(r'[^a-zA-Z0-9_.-]+', '_', name)!r}, where it is referred to as well",
                )
        for same in lower.values():
            if len(same) > 1:
                yield finding(
                    case,
                    "name-case",
                    of[same[1]],
                    f"{' and '.join(map(repr, same))}",
                    why="files and topics named after them are one on some systems: no term changes",
                    fix="name them apart",
                )
    described = case.about.document is not None  # links of robots built in code are named after their joints
    for name in sorted(links.keys() & joints.keys()) if described else ():
        yield finding(
            case,
            "name-shared",
            joints[name],
            f"there is also a link {name!r}",
            why="Gazebo refuses equal names, and frames of that name mean one or the other: J and FK of another frame",
            fix="name them apart, for instance with _link and _joint",
        )
    for name in ("universe", "root_joint"):
        if described and name in joints and joints[name].type != "fixed":
            yield finding(
                case,
                "name-reserved",
                joints[name],
                f"the name {name!r}",
                why="Pinocchio calls the joint of a floating base root_joint, and the world universe: "
                "such a model is "
                "refused",
                fix="another name",
            )


READ = (
    # the reader's note on an element, the rule, and the effect
    ("several elements of one kind", "several-elements", "the first is used here, others take the last", "keep one"),
    (
        "<inertia> without all products",
        "missing-products",
        "Pinocchio reads a tensor of zeros, others zero products",
        "write the products, 0 if they are",
    ),
    ("<inertial> without <inertia>", "missing-tensor", "it is read as zero: a point mass", "write the tensor"),
    (
        "revolute joint without <limit>",
        "missing-limit",
        "Pinocchio refuses the file; q has no bounds here",
        "give <limit>",
    ),
    (
        "prismatic joint without <limit>",
        "missing-limit",
        "Pinocchio refuses the file; q has no bounds here",
        "give <limit>",
    ),
    ("<limit> without lower or upper", "missing-bound", "it is read as 0, so q stops there", "give lower and upper"),
    (
        "<limit> without",
        "missing-effort",
        "urdfdom refuses the file, others take 0 or infinity",
        "give effort and velocity",
    ),
    (
        "<axis> that is no unit vector",
        "axis-length",
        "it is normalised; libraries that do not scale q and J by its length",
        "a unit vector",
    ),
    ("<origin> has attributes besides", "unknown-attribute", "nobody reads it, so what it says is lost", "remove it"),
    (
        "elements that no reader knows",
        "wrong-case",
        "tags are lower case, so the element is lost",
        "write it in lower case",
    ),
    (
        "xacro that was not expanded",
        "left-xacro",
        "it is no URDF, and some readers refuse it",
        "expand the file with xacro",
    ),
    ("blanks around the type", "blanks-in-type", "other readers do not know the type", "remove the blanks"),
    ("quat_xyzw was normalised", "quaternion-length", "others may scale the frame", "a unit quaternion"),
    ("<robot> without a name", "unnamed", "Pinocchio refuses the file", "give the robot a name"),
    ("<link> without a name", "unnamed", "Pinocchio refuses the file", "give the link a name"),
)
SAYS = {
    "several-elements": "An element stands twice where one is expected: a second <inertial>, for instance.",
    "missing-products": "A tensor lacks some of its products.",
    "missing-tensor": "An inertial has a mass and no tensor.",
    "missing-limit": "A joint that needs limits has none.",
    "missing-bound": "Limits lack lower or upper.",
    "missing-effort": "Limits lack effort or velocity.",
    "axis-length": "An axis is no unit vector.",
    "unknown-attribute": "An attribute is none of URDF's.",
    "wrong-case": "A tag is written in capitals.",
    "left-xacro": "Xacro was left in the file.",
    "blanks-in-type": "The type of a joint has blanks around it.",
    "quaternion-length": "A quaternion is not of unit length.",
    "unnamed": "The robot or a link has no name.",
}


@rules(
    *(Rule(k, NOTE if k in ("axis-length", "left-xacro", "missing-effort") else WARNING, s) for k, s in SAYS.items())
)
def read_otherwise(case: Case) -> Iterator[Finding]:
    """What the reader noted, element by element."""
    document = case.about.document
    if document is None:
        return
    at: dict[tuple[str, str], Body | Hinge] = {("link", b.name): b for b in case.about.bodies}
    at |= {("joint", h.name): h for h in case.about.hinges}
    for kind, tag, name, detail in document.notes.each():
        entry = next((e for e in READ if kind.startswith(e[0])), None)
        if entry is None:
            continue
        _, rule, why, fix = entry
        x = at.get((tag, str(name)))
        effect = None
        if rule in ("missing-products", "missing-tensor") and isinstance(x, Body):
            effect, why = _without_tensor(case, x, why)
        elif rule == "axis-length" and isinstance(x, Hinge):
            yield _axis(case, x, detail)
            continue
        yield finding(case, rule, x, f"{kind}{f' ({detail})' if detail else ''}", effect=effect, why=why, fix=fix)


def _without_tensor(case: Case, b: Body, why: str) -> tuple[Effect, str]:
    e = None if b.element is None else b.element.find("inertial/inertia")
    diagonal = [0.0 if e is None else float(e.get(k, 0) or 0) for k in ("ixx", "iyy", "izz")]
    J = b.rotation @ np.diag(diagonal) @ b.rotation.T
    if not any(diagonal):
        from .tensors import sphere

        r = sphere(b.mass)
        J = 0.4 * b.mass * r * r * np.eye(3)
    effect = case.effects.of_body(b, b.mass, b.com, J)
    what = "what is written" if any(diagonal) else f"a ball of water of {b.mass:g} kg"
    return effect, f"{why}; with {what}, {effect.says}"


def _axis(case: Case, h: Hinge, detail: str) -> Finding:
    e = None if h.element is None else h.element.find("axis")
    words = [] if e is None else e.get("xyz", "").split()
    u = np.array([float(w) for w in words]) if len(words) == 3 else np.zeros(3)
    length = float(np.linalg.norm(u))
    value = " ".join(repr(float(x) + 0.0) for x in u / length) if length else ""
    effect = Effect("fk", abs(length - 1), "", f"where it is not normalised, a coordinate counts {length:.6g} times")
    return finding(
        case,
        "axis-length",
        h,
        f'axis "{" ".join(words)}" ({detail})',
        effect=effect,
        why=f"dualpin and Pinocchio normalise it; {effect.says}",
        fix=f'xyz="{value}"',
        edits=case.about.edit(e, "xyz", value) if value and e is not None else (),
    )
