"""What is compared: the terms, in which variants, and what each needs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from typing import Any

from ..algorithms.kinematics import References
from ..errors import ArgumentError, nearest
from ..model.robot import Robot
from ..terms import TERMS
from .sampling import frames


@dataclass(frozen=True)
class Check:
    """A term to compare.

    Attributes
    ----------
    solves : bool
        Whether a linear system with M is solved in it.
    weighs : bool
        Whether it is nothing but zeros (or 0 / 0) on a robot without mass.
    """

    term: str
    solves: bool = False
    weighs: bool = True

    def variants(self, robot: Robot, seed: int) -> list[dict[str, Any]]:
        """The options it is compared with: all combinations, of frames a few; others have their defaults."""
        values = {"frame": frames(robot, seed), "reference": References, "classical": (False, True)}
        names = [option.name for option in TERMS[self.term].options if option.name in values]
        return [dict(zip(names, chosen, strict=True)) for chosen in product(*(values[name] for name in names))]

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
        Check("fk", weighs=False), Check("frame_pose", weighs=False), Check("jacobian", weighs=False),
        Check("jacobian_dot", weighs=False), Check("frame_velocity", weighs=False),
        Check("frame_acceleration", weighs=False),
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
    oracle : str
        Who it is compared with.
    """

    robot: str | Robot
    floating: bool = False
    mimic: bool = False
    against: str | None = None
    engine: str = ""
    title: str = ""
    oracle: str = "pinocchio"

    @property
    def name(self) -> str:
        if self.title:
            return self.title
        return self.robot.name if isinstance(self.robot, Robot) else str(self.robot)
