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

from ...io.remarks import moving_no_mass
from ...spatial.inertia import steiner
from .description import TENSOR, Body
from .findings import ERROR, NOTE, WARNING, Finding
from .rules import Case, Rule, rules

PRINTED = 1e-6  # relative: six printed digits are common
FEW = 0.05  # the largest relative tolerance for a tensor printed with one or two digits
OSMIUM = 22_590.0  # kg/m^3, the densest element
NOTHING = 0.0, np.zeros(3), np.zeros((3, 3))  # mass, centre and tensor of no body
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
        if definite:
            rule = "not-positive-definite"
            about = f"the smallest principal moment is {low:.3g} kg m^2, so turning about its axis has negative energy"
        else:
            rule, share = "triangle-inequality", f"{100 * lacking / 2 / high:.2g} % of that moment"
            about = f"the second moment along the axis of the largest is {-lacking / 2:.3g} kg m^2 ({share}), "
            about += "as if mass there were negative"
        says = f"principal moments {low:.3g}, {middle:.3g}, {high:.3g} kg m^2"
        why = f"{about}; with the nearest tensor that a body can have,"
        yield case.found(rule, b, says, why, _remedy(b, repaired), instead=(b.mass, b.com, repaired))


def _remedy(b: Body, repaired: np.ndarray) -> str:
    """A correction that makes it physical: other signs of the products, Steiner's terms, or the nearest tensor."""
    flipped = np.where(np.eye(3, dtype=bool), b.written, -b.written)
    if b.com.any() and physical(b.tensor - steiner(b.mass, b.com)):
        return (
            "it becomes a body's if it is about the link's origin, not the centre of mass: "
            "subtract m (c c 1 - c c^T), or export it about the centre"
        )
    if not np.array_equal(flipped, b.written) and physical(flipped):
        return "it becomes a body's if ixy, ixz and iyz change their signs: CAD programs count products of inertia so"
    written = b.rotation.T @ repaired @ b.rotation
    values = ", ".join(f"{k}={x:.6g}" for k, x in zip(TENSOR, written[np.triu_indices(3)].tolist(), strict=True))
    return f"export the tensor again; the nearest that a body can have is {values}"


def physical(J: np.ndarray) -> bool:
    """Whether it is physical, within rounding."""
    values = np.linalg.eigvalsh(second_moments(J))
    return bool(values[0] >= -PRINTED * abs(values[-1]) and values[-1] > 0)


@rules(
    Rule(
        "inertia-without-mass", ERROR, "A link turns heavily and weighs nothing.", "give the mass, or remove the tensor"
    ),
    Rule(
        "zero-inertia", NOTE, "A link with mass has no rotational inertia: a point.",
        "export the tensor; a point mass is right only far from the axis",
    ),
)  # fmt: skip
def lacking(case: Case) -> Iterator[Finding]:
    for b in case.about.bodies:
        if b.mass == 0 and b.tensor.any():
            says = f"mass 0, largest moment {b.moments[-1]:.3g} kg m^2"
            why = "a body without mass has no moments either; without them"
            yield case.found("inertia-without-mass", b, says, why, instead=NOTHING)
        elif b.mass > LIGHT and b.given and b.point:
            J = ball(b.mass)
            why = f"as a ball of water (radius {sphere(b.mass):.2g} m) it would have {J[0, 0]:.3g} kg m^2, and"
            yield case.found("zero-inertia", b, f"{b.mass:g} kg in a point", why, instead=(b.mass, b.com, J))


def ball(mass: float) -> np.ndarray:
    """The tensor of a ball of water."""
    return np.asarray(0.4 * mass * sphere(mass) ** 2 * np.eye(3))


def sphere(mass: float, density: float = 1000.0) -> float:
    """The radius of a ball of that mass."""
    return float((3 * mass / (4 * pi * density)) ** (1 / 3))


@rules(
    Rule(
        "placeholder-inertia", WARNING, "The tensor is a power of ten times the identity: a placeholder.",
        "export mass and tensor from CAD, or compute them from the link's shape",
    ),
    Rule(
        "denser-than-matter", WARNING, "No body of this mass and tensor is less dense than the densest element.",
        "the tensor may be a placeholder, or in another unit than kg m^2",
    ),
    Rule(
        "wider-than-robots", ERROR, "The radius of gyration is beyond ten metres: another unit, kg mm^2 for instance.",
        "convert the tensor to kg m^2",
    ),
)  # fmt: skip
def unlikely(case: Case) -> Iterator[Finding]:
    for b in case.about.bodies:
        if b.mass <= LIGHT or b.point or not physical(b.tensor):
            continue
        J, isotropic = b.written, np.array_equal(b.written, b.written[0, 0] * np.eye(3))
        radius = sqrt(float(b.moments[-1]) / b.mass)
        if radius > FAR:
            says, why = f"radius of gyration {radius:.3g} m", "robots are smaller; if the tensor is in kg mm^2,"
            yield case.found("wider-than-robots", b, says, why, instead=(b.mass, b.com, b.tensor * 1e-6))
            continue
        density, water = _density(b), ball(b.mass)
        like_water = b.mass, b.com, water
        if isotropic and _power_of_ten(J[0, 0]) and not 0.2 < J[0, 0] / water[0, 0] < 5:
            says = f"ixx = iyy = izz = {J[0, 0]:g} kg m^2 for {b.mass:g} kg"
            why = f"a ball of this mass and the density of water has {water[0, 0]:.2g} kg m^2; with that,"
            yield case.found("placeholder-inertia", b, says, why, instead=like_water)
        elif density > OSMIUM:
            says = f"{b.mass:g} kg with moments up to {b.moments[-1]:.3g} kg m^2 are {density:.2g} kg/m^3 or more"
            why = f"osmium has {OSMIUM:g} kg/m^3; as a ball of the density of water"
            yield case.found("denser-than-matter", b, says, why, instead=like_water)


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
    Rule("no-mass", WARNING, "Nothing that moves has mass: there are no dynamics.", "give the links their inertials"),
    Rule(
        "massless-joint", WARNING, "A joint moves no mass: the mass matrix is singular.",
        "give what it carries an inertial, or make the joint fixed",
    ),
)  # fmt: skip
def nothing_moves(case: Case) -> Iterator[Finding]:
    robot = case.about.robot
    if not robot.nv:
        return
    if not case.effects.parameters.any():
        says = f"none of the {len(robot.links)} links that move has <mass> or a tensor"
        yield case.found("no-mass", None, says, "M, gravity and torques are 0 and forward dynamics has no answer")
        return
    hinges = {h.name: h for h in case.about.hinges}
    for j in moving_no_mass(robot):
        says = "nothing that it moves has mass or inertia about it"
        why = "its row of M is 0, so forward dynamics has no answer for the whole robot"
        yield case.found("massless-joint", hinges.get(j.name), says, why)
