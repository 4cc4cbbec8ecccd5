"""What is compared: the terms, in which variants, and what each needs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from ..algorithms.kinematics import References
from ..errors import ArgumentError, nearest
from ..model.robot import Robot
from ..terms import TERMS
from .sampling import frames

Variants = Callable[[Robot, int], list[dict[str, Any]]]


def _plain(robot: Robot, seed: int) -> list[dict[str, Any]]:
    return [{}]


def _frames(robot: Robot, seed: int) -> list[dict[str, Any]]:
    return [{"frame": f} for f in frames(robot, seed)]


def _seen(robot: Robot, seed: int) -> list[dict[str, Any]]:
    return [{"frame": f, "reference": r} for f in frames(robot, seed) for r in References]


def _accelerated(robot: Robot, seed: int) -> list[dict[str, Any]]:
    return [{**o, "classical": c} for o in _seen(robot, seed) for c in (False, True)]


@dataclass(frozen=True)
class Check:
    """A term to compare.

    Attributes
    ----------
    variants : callable
        (robot, seed) -> the options it is compared with.
    solves : bool
        Whether a linear system with M is solved in it.
    weighs : bool
        Whether it is nothing but zeros (or 0 / 0) on a robot without mass.
    """

    term: str
    variants: Variants = _plain
    solves: bool = False
    weighs: bool = True

    @property
    def inertial(self) -> bool:
        """Whether inertias enter it."""
        return self.weighs or self.term == "rnea_f_ext"

    @property
    def dynamic(self) -> bool:
        """Whether forces enter it, gravity among them."""
        return self.inertial or self.term == "joint_torque_regressor"

    @property
    def inputs(self) -> dict[str, str]:
        """The term's inputs, each with the sampled quantity that it is given."""
        if self.term == "difference":
            return {"q0": "q", "q1": "q1"}
        return {key: key for key in TERMS[self.term].inputs}


CHECKS = {
    c.term: c
    for c in (
        Check("fk", weighs=False), Check("frame_pose", _frames, weighs=False), Check("jacobian", _seen, weighs=False),
        Check("jacobian_dot", _seen, weighs=False), Check("frame_velocity", _seen, weighs=False),
        Check("frame_acceleration", _accelerated, weighs=False),
        Check("rnea"), Check("rnea_f_ext", weighs=False), Check("joint_wrenches"), Check("bias"), Check("gravity"),
        Check("crba"), Check("coriolis"), Check("aba", solves=True), Check("minv", solves=True),
        Check("kinetic_energy"), Check("potential_energy"), Check("com"), Check("com_jacobian"),
        Check("centroidal_momentum_matrix"), Check("joint_torque_regressor", weighs=False),
        Check("rnea_derivatives"), Check("aba_derivatives", solves=True), Check("difference", weighs=False),
    )
}  # fmt: skip


def chosen(terms: Iterable[str] | None) -> list[Check]:
    """The checks of these terms, or of all; a name that is none is refused with the nearest."""
    if terms is None:
        return list(CHECKS.values())
    terms = [terms] if isinstance(terms, str) else list(terms)
    for term in terms:
        if term not in CHECKS:
            raise ArgumentError(f"validate: term {term!r} is not known; {nearest(term, CHECKS, 'terms', most=99)}")
    return [CHECKS[t] for t in terms]


@dataclass(frozen=True)
class Case:
    """A robot to validate: by name or path, or itself.

    Attributes
    ----------
    against : str, optional
        A file to compare with instead of its own.
    engine : str
        What computes it, where that is not what the whole campaign is computed with.
    title : str
        What to call it, where that is not the name or path.
    """

    robot: str | Robot
    floating: bool = False
    mimic: bool = False
    against: str | None = None
    engine: str = ""
    title: str = ""

    @property
    def name(self) -> str:
        if self.title:
            return self.title
        return self.robot.name if isinstance(self.robot, Robot) else str(self.robot)
