"""One random robot: every term against Pinocchio, and the identities."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any
from zlib import crc32

from ..crosscheck.checks import CHECKS, Case, Check
from ..crosscheck.compare import compare
from ..crosscheck.oracles.pinocchio import OracleError
from ..crosscheck.results import DIFFERS, NOT_COMPARED, RobotResult
from ..errors import DualpinError, DualpinWarning
from ..interpret import remembered
from ..model.robot import Robot
from .identities import identities
from .spec import Spec

SAMPLES = 1
"""States of each robot: more robots find more than more states, and one state is computed with plain floats."""


@dataclass(frozen=True)
class Drawn(Check):
    """A term in one of its variants, which the robot's name draws: the next robot shows another."""

    def variants(self, robot: Robot, seed: int) -> list[dict[str, Any]]:
        every = super().variants(robot, seed)
        return [every[crc32(f"{robot.name} {self.term}".encode()) % len(every)]]


DRAWN = [Drawn(**vars(check)) for check in CHECKS.values()]


def examine(spec: Spec, seed: int = 0, samples: int = SAMPLES) -> RobotResult:
    """Compare all terms, and check the identities; an exception becomes the result's error.

    Of a term's frames, references and forms of acceleration the robot's name draws one.

    Terms that differ are decided by their definitions in 50 digits.  A failed identity is dualpin's fault:
    its ``nearer`` is "oracle".

    Parameters
    ----------
    spec : Spec
    seed, samples : int
        Of the random states.

    Returns
    -------
    RobotResult

    Examples
    --------
    >>> from dualpin.fuzz import examine, random_spec
    >>> examine(random_spec(7, 0)).status
    'agrees'
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        try:
            robot = spec.robot()
        except DualpinError as e:
            return RobotResult(spec.name, False, False, 0, samples, seed, True, status=NOT_COMPARED, reason=str(e))
        try:
            with remembered():
                return _examined(robot, seed, samples)
        except Exception as e:  # an error of the package: counted and minimised like a difference
            return RobotResult(
                spec.name, robot.floating, robot.coupled, robot.nv, samples, seed, False, status=DIFFERS,
                error=f"{type(e).__name__}: {e}",
            )  # fmt: skip


def _examined(robot: Robot, seed: int, samples: int) -> RobotResult:
    try:
        found = compare(Case(robot), samples, seed, DRAWN, "numpy")
    except OracleError as e:
        found = RobotResult(
            robot.name, robot.floating, robot.coupled, robot.nv, samples, seed, True, status=NOT_COMPARED, reason=str(e)
        )
    laws = identities(robot, seed)
    found.terms.update(laws)
    if any(t.status == DIFFERS for t in laws.values()):
        found.status, found.passed = DIFFERS, False
    return found
