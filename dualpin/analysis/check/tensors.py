"""Rules about mass, centre of mass and inertia tensor of single links.

The second moments of a body,  Sigma = tr(J)/2 1 - J = integral of x x^T dm,  are positive semidefinite.  This condition
is complete: J is positive definite and satisfies the triangle inequality J1 + J2 >= J3.

References
----------
Wensing, Kim & Slotine (2018), "Linear matrix inequalities for physically consistent inertial parameter
identification", eq. 13 and 14.
Traversaro, Brossette, Escande & Nori (2016), "Identification of fully physical consistent inertial parameters".
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, sqrt

import numpy as np

from ...spatial.inertia import steiner
from .description import TENSOR, Body
from .findings import ERROR, NOTE, WARNING, Finding
from .rules import Case, Rule, finding, rules

PRINTED = 1e-6  # relative: six printed digits are common
FEW = 0.05  # the largest relative tolerance for a tensor printed with one or two digits
OSMIUM = 22_590.0  # kg/m^3, the densest element
LIGHT = 1e-3  # kg; placeholders below a gram change no torque that matters
FLAT = 0.01  # of the largest second moment: thinner than a tenth of its length, an idealised plate or rod


def second_moments(J: np.ndarray) -> np.ndarray:
    """Sigma = tr(J)/2 1 - J"""
    return np.asarray(np.trace(J) / 2 * np.eye(3) - J)


def nearest_physical(J: np.ndarray) -> np.ndarray:
    """The nearest tensor with non-negative second moments."""
    values, axes = np.linalg.eigh(second_moments(J))
    sigma = (axes * np.maximum(values, 0)) @ axes.T
    return np.asarray(np.trace(sigma) * np.eye(3) - sigma)


@rules(
    Rule("not-positive-definite", ERROR, "The tensor has a negative eigenvalue: turning would give negative energy."),
    Rule("triangle-inequality", ERROR, "One principal moment is larger than the sum of the others: no body has that."),
)
def impossible(case: Case) -> Iterator[Finding]:
    for b in case.about.bodies:
        size = float(np.abs(b.written).max())
        if not size or b.point:
            continue
        low, middle, high = b.moments
        rounding = PRINTED * size + min(b.printed, FEW * size)
        definite = low < -rounding
        lacking = high - low - middle
        if not definite and lacking <= rounding:
            continue
        repaired = nearest_physical(b.tensor)
        effect = case.effects.of_body(b, b.mass, b.com, repaired)
        about = (
            f"the smallest principal moment is {low:.3g} kg m^2, so turning about its axis has negative energy"
            if definite
            else f"the second moment along the axis of the largest is {-lacking / 2:.3g} kg m^2 "
            f"({_share(lacking, high)} of "
            "that moment), as if mass there were negative"
        )
        rule = "not-positive-definite" if definite else "triangle-inequality"
        says = f"principal moments {low:.3g}, {middle:.3g}, {high:.3g} kg m^2"
        yield finding(
            case,
            rule,
            b,
            says,
            effect=effect,
            why=f"{about}; with the nearest tensor that a body can have, {effect.says}",
            fix=_remedy(b, repaired),
        )


def _share(part: float, whole: float) -> str:
    return f"{100 * part / 2 / whole:.2g} %"


def _remedy(b: Body, repaired: np.ndarray) -> str:
    """A correction that makes it physical: other signs of the products, Steiner's terms, or the nearest tensor."""
    flipped = np.where(np.eye(3, dtype=bool), b.written, -b.written)
    c = b.com
    added = steiner(b.mass, c)
    if c.any() and physical(b.tensor - added):
        return (
            "it becomes a body's if it is about the link's origin, not the centre of mass: subtract m (c c 1 - c "
            "c^T), or "
            "export it about the centre"
        )
    if not np.array_equal(flipped, b.written) and physical(flipped):
        return "it becomes a body's if ixy, ixz and iyz change their signs: CAD programs count products of inertia so"
    R = b.rotation.T
    written = R @ repaired @ R.T
    values = ", ".join(f"{k}={float(written[i, j]):.6g}" for k, (i, j) in zip(TENSOR, _ENTRIES, strict=True))
    return f"export the tensor again; the nearest that a body can have is {values}"


_ENTRIES = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def physical(J: np.ndarray) -> bool:
    """Whether it is physical, within rounding."""
    values = np.linalg.eigvalsh(second_moments(J))
    return bool(values[0] >= -PRINTED * abs(values[-1]) and values[-1] > 0)


@rules(
    Rule("inertia-without-mass", ERROR, "A link turns heavily and weighs nothing."),
    Rule("zero-inertia", NOTE, "A link with mass has no rotational inertia: a point."),
)
def lacking(case: Case) -> Iterator[Finding]:
    for b in case.about.bodies:
        if b.mass == 0 and b.tensor.any():
            effect = case.effects.of_body(b, 0.0, np.zeros(3), np.zeros((3, 3)))
            why = f"a body without mass has no moments either; without them {effect.says}"
            yield finding(
                case,
                "inertia-without-mass",
                b,
                f"mass 0, largest moment {b.moments[-1]:.3g} kg m^2",
                effect=effect,
                why=why,
                fix="give the mass, or remove the tensor",
            )
        elif b.mass > LIGHT and b.given and b.point:
            r = sphere(b.mass)
            J = 0.4 * b.mass * r * r * np.eye(3)
            effect = case.effects.of_body(b, b.mass, b.com, J)
            why = f"as a ball of water (radius {r:.2g} m) it would have {J[0, 0]:.3g} kg m^2, and {effect.says}"
            yield finding(
                case,
                "zero-inertia",
                b,
                f"{b.mass:g} kg in a point",
                effect=effect,
                why=why,
                fix="export the tensor; a point mass is right only far from the axis",
            )


def sphere(mass: float, density: float = 1000.0) -> float:
    """The radius of a ball of that mass."""
    return float((3 * mass / (4 * pi * density)) ** (1 / 3))


@rules(
    Rule("placeholder-inertia", WARNING, "The tensor is a power of ten times the identity: a placeholder."),
    Rule("denser-than-matter", WARNING, "No body of this mass and tensor is less dense than the densest element."),
    Rule(
        "wider-than-robots", ERROR, "The radius of gyration is beyond ten metres: another unit, kg mm^2 for instance."
    ),
)
def unlikely(case: Case) -> Iterator[Finding]:
    for b in case.about.bodies:
        if b.mass <= LIGHT or b.point or not physical(b.tensor):
            continue
        J, isotropic = b.written, np.array_equal(b.written, b.written[0, 0] * np.eye(3))
        radius = sqrt(float(b.moments[-1]) / b.mass)
        if radius > FAR:
            scaled = b.tensor * 1e-6
            effect = case.effects.of_body(b, b.mass, b.com, scaled)
            yield finding(
                case,
                "wider-than-robots",
                b,
                f"radius of gyration {radius:.3g} m",
                effect=effect,
                why=f"robots are smaller; if the tensor is in kg mm^2, {effect.says}",
                fix="convert the tensor to kg m^2",
            )
            continue
        density = _density(b)
        r = sphere(b.mass)
        ball = 0.4 * b.mass * r * r * np.eye(3)
        if isotropic and _power_of_ten(J[0, 0]) and not 0.2 < J[0, 0] / ball[0, 0] < 5:
            effect = case.effects.of_body(b, b.mass, b.com, ball)
            yield finding(
                case,
                "placeholder-inertia",
                b,
                f"ixx = iyy = izz = {J[0, 0]:g} kg m^2 for {b.mass:g} kg",
                effect=effect,
                why=f"a ball of this mass and the density of water has {ball[0, 0]:.2g} kg m^2; with that, "
                f"{effect.says}",
                fix="export mass and tensor from CAD, or compute them from the link's shape",
            )
        elif density > OSMIUM:
            effect = case.effects.of_body(b, b.mass, b.com, ball)
            yield finding(
                case,
                "denser-than-matter",
                b,
                f"{b.mass:g} kg with moments up to {b.moments[-1]:.3g} kg m^2 are {density:.2g} kg/m^3 or more",
                effect=effect,
                why=f"osmium has {OSMIUM:g} kg/m^3; as a ball of the density of water {effect.says}",
                fix="the tensor may be a placeholder, or in another unit than kg m^2",
            )


FAR = 10.0  # m; the parts of robots are closer together


def _density(b: Body) -> float:
    """The least density of any body with this mass and tensor: that of the uniform ellipsoid, axes sqrt(5 s / m)."""
    s = np.linalg.eigvalsh(second_moments(b.tensor))
    if s[0] <= FLAT * s[-1] or s[0] <= b.printed:
        return 0.0
    return float(b.mass / (4 / 3 * pi * np.prod(np.sqrt(5 * s / b.mass))))


def _power_of_ten(x: float) -> bool:
    return x > 0 and bool(np.isclose(np.log10(x), round(float(np.log10(x))), atol=1e-9))


@rules(
    Rule("no-mass", WARNING, "Nothing that moves has mass: there are no dynamics."),
    Rule("massless-joint", WARNING, "A joint moves no mass: the mass matrix is singular."),
)
def nothing_moves(case: Case) -> Iterator[Finding]:
    robot = case.about.robot
    if not robot.nv:
        return
    if not case.effects.parameters.any():
        yield finding(
            case,
            "no-mass",
            None,
            f"none of the {len(robot.links)} links that move has <mass> or a tensor",
            why="M, gravity and torques are 0 and forward dynamics has no answer",
            fix="give the links their inertials",
        )
        return
    carried = {j.index: j.inertia for j in robot}
    heavy: dict[int, bool] = {}
    for j in reversed(robot):
        heavy[j.index] = heavy.get(j.index, False) or any(float(x) for x in carried[j.index].parameters)
        if j.parent is not None and heavy[j.index]:
            heavy[j.parent.index] = True
    inner = {j.parent.index for j in robot if j.parent is not None and heavy[j.index]}
    hinges = {h.name: h for h in case.about.hinges}
    for j in robot:
        still = any(float(s.dot(j.inertia(s)).dual) == 0 for s in j.model.screws)
        if j.index not in inner and still:
            yield finding(
                case,
                "massless-joint",
                hinges.get(j.name),
                "nothing that it moves has mass or inertia about it",
                why="its row of M is 0, so forward dynamics has no answer for the whole robot",
                fix="give what it carries an inertial, or make the joint fixed",
            )
