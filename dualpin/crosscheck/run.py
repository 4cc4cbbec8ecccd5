"""Validate a robot: the public function, and what a campaign calls for each of many."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from ..errors import ArgumentError, DualpinError, DualpinWarning
from ..io.urdf import load
from ..machine import versions
from ..model.robot import Robot
from .checks import CHECKS, Case, Check, chosen
from .compare import compare, used_engine
from .oracles.pinocchio import OracleError, build, import_pinocchio
from .results import NOT_COMPARED, Refusal, Report, RobotResult
from .tally import scaled_error

__all__ = ["CHECKS", "Case", "Check", "attempt", "chosen", "compare", "provenance", "scaled_error", "validate"]


def validate(
    robot: str | Robot,
    samples: int = 1000,
    seed: int = 0,
    *,
    terms: Sequence[str] | None = None,
    floating: bool = False,
    mimic: bool = False,
    engine: str = "auto",
    arbitrate: bool = False,
) -> Report:
    """Compare every term of a robot with Pinocchio on random states.

    Parameters
    ----------
    robot : Robot, or name or path of one
        A `Robot` is compared with what Pinocchio makes of the file it came from, or of the URDF it
        writes; so a robot that was changed in code is caught.
    samples, seed : int
        How many states, and the seed they come from.
    terms : sequence of str, optional
        Some of `dualpin.crosscheck.CHECKS`; all by default.
    floating, mimic : bool
        As in `dualpin.load`, where a name or path is given.
    arbitrate : bool
        At the worst sample of every term that is off by more than `LAST_DIGITS`, run the same
        algorithm with 50 digits and record in ``worst`` how far each library is from the truth.

    Returns
    -------
    Report
        ``.passed``, ``.terms[name].max_scaled_error``, ``.write(folder)``.

    Notes
    -----
    The scaled error of a term is max|x - ref| / max(1, max|ref|) over the entries of a sample.
    Each tolerance carries its reason; 1e-12 is the ceiling of terms without a linear solve.

    Raises
    ------
    UrdfError, ArgumentError, OracleError

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.validate("panda", samples=3, terms=["rnea", "crba"]).passed
    True
    """
    case = Case(robot, floating, mimic)
    checks = chosen(terms)
    if not isinstance(samples, (int, np.integer)) or samples < 1:
        raise ArgumentError(f"validate: samples is {samples!r}; a whole number from 1 expected")
    report = Report([compare(case, int(samples), seed, checks, engine, arbitrate)])
    report.versions = provenance(engine)
    return report


def provenance(engine: str) -> dict[str, str]:
    """Versions, the machine, and what computes on it."""
    found = versions(pinocchio=str(import_pinocchio().__version__), engine=used_engine(engine))
    if found["engine"] == "compiled":
        from ..engine.jit.host import this_host

        bits = 8 * this_host().width
        found["engine"] += f", vectors of {bits} bits ({bits // 64} doubles)"
    return found


def attempt(
    case: Case, samples: int, seed: int, checks: Sequence[Check], engine: str, arbitrate: bool = False
) -> RobotResult | Refusal:
    """One case; a robot that cannot be compared is reported with the reason, never skipped."""
    try:
        return compare(case, samples, seed, checks, engine, arbitrate)
    except DualpinError as e:
        robot = _loads(case)
        if robot is None:
            return Refusal(case.name, str(e), by_pinocchio=not _pinocchio_builds(case))
        oracles = isinstance(e, OracleError)  # what it refuses is not compared; what dualpin cannot do fails
        return RobotResult(
            case.name, case.floating, case.mimic, robot.nv, samples, seed, passed=oracles, status=NOT_COMPARED,
            reason=str(e) if oracles else "", error="" if oracles else str(e), engine=used_engine(engine),
        )  # fmt: skip


def _loads(case: Case) -> Robot | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        try:
            return load(case.robot, case.floating, case.mimic) if isinstance(case.robot, str) else case.robot
        except DualpinError:
            return None


def _pinocchio_builds(case: Case) -> bool:
    from ..io.catalogue import find

    try:
        build(str(find(str(case.robot))), case.floating, case.mimic)
    except DualpinError:
        return False
    return True
