"""Terms of the equations of motion that are left out or turned, and parts that are counted another number of times."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.layout import transposed
from ..case import Case, View
from ..hypothesis import Hypothesis
from ..newton_euler import SLIPS, NewtonEuler
from .register import FORCED, WEIGHED, proposer

TANGENTIAL = ("tangential", "tangential_com", "tangential_link", "tangential_sign", "tangential_com_sign",
              "tangential_link_sign")  # fmt: skip
HANDED_ON = ("moment_arm", "moment_arm_sign", "force_moment", "force_moment_link", "force_moment_link_sign",
             "not_handed_on", "moment_not_handed_on", "slide_moment")  # fmt: skip
TURNED = ("slide_radius", "axis_frame", "slide_axis_frame")
IN_MASS = (*TANGENTIAL, *HANDED_ON, *TURNED, "inertia_frame", "inertia_frame_transposed", "inertia_frame_half",
           "no_translational", "no_angular_acceleration", "slide_acceleration")  # fmt: skip
"""Slips that the mass matrix shows too."""
IN_JACOBIANS = (*TANGENTIAL, *TURNED, "inertia_frame", "inertia_frame_transposed", "inertia_frame_half", "moment_arm",
                "no_translational", "no_angular_acceleration")  # fmt: skip
"""Those of them that Jacobians, and the kinetic energy that is made of them, have."""
IN_GRAVITY = (*HANDED_ON, *TURNED, "gravity_at_origin", "gravity_in_base", "gravity_each_link")
SEEN = ("centripetal", "centripetal_sign", "centripetal_link", "centripetal_link_sign", "axis_rate", "axis_rate_sign",
        "slide_coriolis", "slide_coriolis_half", "slide_coriolis_sign", "axis_rate_twice", "slide_acceleration",
        *TANGENTIAL)  # fmt: skip
"""Those that accelerations of frames show."""


Mass = Callable[[NewtonEuler, np.ndarray], np.ndarray]
MASSES: dict[str, Mass] = {
    "": NewtonEuler.mass_matrix, "M from Jacobians": NewtonEuler.energy_matrix,
    "M is right": lambda model, q: NewtonEuler(model.robot, model.d, "").energy_matrix(q),
}  # fmt: skip
"""How codes find the mass matrix: from the equations, from the same slip in the kinetic energy, or rightly."""
UNCHANGED = 1e-10
"""Relative to C v: a slip that changes it by less has nothing to do with it."""
MOST_STEPS = 12
"""Degrees of freedom up to which C is predicted from dM/dq."""


def newton_euler(slip: str, merged: bool, how: str) -> Callable[[View, str], np.ndarray | None]:
    """The prediction of a term by Newton-Euler equations with a slip."""

    def act(view: View, term: str) -> np.ndarray | None:
        s, zero = view.states, np.zeros_like(view.states["v"])
        model, mass = NewtonEuler(view.robot, view.description, slip, merged), MASSES[how]
        g = model.gravity
        if term == "frame_acceleration":
            aligned = view.layout.how.reference == "local_world_aligned"
            return model.accelerations(s["q"], s["v"], s["a"], view.frames) if aligned else None
        if term == "gravity":
            return model.forces(s["q"], zero, zero, g)
        if term == "bias":
            return model.forces(s["q"], s["v"], zero, g)
        if term == "rnea":
            return model.forces(s["q"], s["v"], s["a"], g)
        if term == "coriolis" and (slip not in IN_MASS or how == "M is right"):  # of which nothing is known but C v
            C_v, v = model.forces(s["q"], s["v"], zero, 0 * g), s["v"]
            right = view.compute("bias") - view.compute("gravity")
            if np.abs(C_v - right).max() < UNCHANGED * max(1.0, np.abs(right).max()):
                return None
            return C_v[:, :, None] * v[:, None, :] / (v**2).sum(-1)[:, None, None]
        if term == "coriolis":
            return christoffel(lambda q: mass(model, q), s["q"], s["v"])
        M = mass(model, s["q"])
        if term == "crba":
            return M
        if term == "minv":
            return np.linalg.inv(M)
        if term == "kinetic_energy":
            return np.asarray(0.5 * np.einsum("ni,nij,nj->n", s["v"], M, s["v"]))
        if term == "aba":
            h = model.forces(s["q"], s["v"], zero, g)
            return np.linalg.solve(M, (s["tau"] - h)[..., None])[..., 0]
        return None

    return act


def christoffel(mass: Callable[[np.ndarray], np.ndarray], q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """C from Christoffel's symbols of a mass matrix, whose derivatives are taken by complex steps.

    References: Siciliano et al., Robotics (2009), equation 7.45; Squire and Trapp, SIAM Review 40 (1998).
    """
    h = 1e-30
    dM = np.stack([mass(q + 1j * h * e).imag / h for e in np.eye(q.shape[1])], axis=-1)
    rate, by_q = np.einsum("nijk,nk->nij", dM, v), np.einsum("nijk,nj->nik", dM, v)
    return np.asarray(0.5 * (rate + by_q - transposed(by_q)))


@proposer(
    "gyroscopic, ...", "a term of Newton's or Euler's equations is left out or turned", "write them in full", SLIPS
)  # fmt: skip
def slips(h: Hypothesis, case: Case) -> list[Hypothesis]:
    if case.robot.coupled or any(p.moves and not p.axial for p in case.description.parts):
        return []
    slides = any(p.slides for p in case.description.parts)
    merges = any(not p.moves and p.body is not None and p.body.mass > 0 for p in case.description.parts)
    steps = () if case.floating or case.robot.nv > MOST_STEPS else ("coriolis",)
    out = []
    for slip, says in SLIPS.items():
        if (slip.startswith("slide") and not slides) or (slip == "gravity_in_base" and not case.floating):
            continue
        terms: tuple[str, ...] = (*WEIGHED,) if slip in IN_GRAVITY else FORCED
        if slip in SEEN:
            terms = (*terms, "frame_acceleration")
        if slip in IN_MASS:
            terms = (*terms, "crba", "minv", "kinetic_energy", *steps)
        elif slip not in IN_GRAVITY:
            terms = (*terms, "coriolis")
        for merged, how in itertools.product((False, True)[: 1 + merges], MASSES):
            if how and slip not in (IN_MASS if how == "M is right" else IN_JACOBIANS):
                continue
            touched = (*(t for t in terms if t in WEIGHED), "coriolis") if how == "M is right" else terms
            values = ", ".join(x for x in ("of bodies merged from fixed links" if merged else "", how) if x)
            out.append(
                replace(
                    h, key=slip, says=says, terms=touched, place="formula", act=newton_euler(slip, merged, how),
                    cost=1.1 + 0.05 * bool(how), values=values,
                    fix=f"put it in: {says.replace(' is left out', '')}" if "left out" in says else "turn it round",
                )
            )  # fmt: skip
    return out


# --- parts counted another number of times -------------------------------------------------------

SHARES = {"0": 0.0, "half": 0.5, "twice": 2.0, "with the other sign": -1.0}


def _scaled(k_a: float, k_v: float, k_g: float) -> Callable[[View, str], np.ndarray | None]:
    def act(view: View, term: str) -> np.ndarray | None:
        s, zero = view.states, np.zeros_like(view.states["v"])
        g = view.compute("gravity")
        velocity = view.compute("bias") - g
        if term == "bias":
            return k_v * velocity + k_g * g
        if term == "rnea":
            return k_a * (view.compute("rnea", v=zero) - g) + k_v * velocity + k_g * g
        if term == "aba":
            M = view.compute("crba")
            return np.linalg.solve(M, (k_a * s["tau"] - k_v * velocity - k_g * g)[..., None])[..., 0]
        if term == "coriolis":
            return k_v * view.compute("coriolis")
        return None

    return act


@proposer("velocity_scale", "Coriolis and centrifugal forces are counted another number of times", "count them once")
def velocity_scale(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(h, terms=(*FORCED, "coriolis"), place="formula", act=_scaled(1.0, k, 1.0), values=words, cost=1.05)
        for words, k in SHARES.items() if k
    ]  # fmt: skip


@proposer("inertia_scale", "M a (or, in forward dynamics, tau) is counted another number of times", "count it once")
def inertia_scale(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(h, terms=("rnea", "aba"), place="formula", act=_scaled(k, 1.0, 1.0), values=words, cost=1.05)
        for words, k in SHARES.items()
    ]


@proposer("bias_sign", "velocity and gravity terms have the other sign in forward dynamics", "a = M^-1 (tau - h)")
def bias_sign(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, terms=("aba",), place="formula", act=_scaled(1.0, -1.0, -1.0), cost=1.05)]


def inverse_only(view: View, term: str) -> np.ndarray | None:
    """tau taken through M alone."""
    return np.linalg.solve(view.compute("crba"), view.states["tau"][..., None])[..., 0]


@proposer("bias_ignored", "velocity and gravity terms are left out of forward dynamics", "a = M^-1 (tau - h)")
def bias_ignored(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, terms=("aba",), place="formula", act=inverse_only)]


@proposer("not_inverted", "the matrix itself, not its inverse", "invert it")
def not_inverted(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def act(view: View, term: str) -> np.ndarray:
        return view.compute("crba")

    return [replace(h, terms=("minv",), place="formula", act=act)]


@proposer("diagonal_inverse", "only the diagonal of M is inverted", "factorise all of M")
def diagonal_inverse(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def act(view: View, term: str) -> np.ndarray:
        d = 1.0 / np.einsum("nii->ni", view.compute("crba"))
        if term == "minv":
            return np.asarray(d[:, :, None] * np.eye(d.shape[1]))
        return np.asarray(d * (view.states["tau"] - view.compute("bias")))

    return [replace(h, terms=("minv", "aba"), place="formula", act=act)]


@proposer("coriolis_with_gravity", "gravity is in it as well as velocities", "C holds velocities only")
def bias_in_coriolis(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def act(view: View, term: str) -> np.ndarray:
        C, v, g = view.compute("coriolis"), view.states["v"], view.compute("gravity")
        return C + g[..., None] * v[:, None, :] / (v**2).sum(-1)[:, None, None]

    return [replace(h, terms=("coriolis",), place="formula", act=act, cost=1.3)]


def check(view: View) -> float:
    """How far the textbook's equations without a slip are from dualpin's: nothing but rounding."""
    s = view.states
    model = NewtonEuler(view.robot, view.description, "")
    apart = model.forces(s["q"], s["v"], s["a"], model.gravity) - view.compute("rnea")
    return float(np.abs(apart).max())
