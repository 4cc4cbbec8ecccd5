"""Validate a robot: the public function, and what a campaign calls for each of many."""

from __future__ import annotations

from collections.abc import Sequence

from ..arguments import count
from ..errors import DualpinError
from ..machine import versions
from ..model.robot import Robot, expect_numbers
from .checks import CHECKS, Case, Check, chosen
from .compare import compare, used_engine
from .merge import merged
from .oracles import ORACLES, OracleError
from .oracles.pinocchio_model import build
from .pairing import quietly_loaded
from .results import NOT_COMPARED, Refusal, Report, RobotResult
from .tally import scaled_error
from .units import slices

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
    against: str | None = None,
    oracle: str = "pinocchio",
) -> Report:
    """Compare every term of a robot with Pinocchio on random states.

    Parameters
    ----------
    robot : Robot, or name or path of one
        A robot that was read from a file is compared with what Pinocchio makes of the same file; one
        that was changed since (a payload, other gravity, rotors) or built in code, with a Pinocchio
        model put together from the same joints, bodies, rotors and gravity.
    samples, seed : int
        How many states, and the seed they come from.
    terms : sequence of str, optional
        Some of `dualpin.crosscheck.CHECKS`; all by default.
    floating, mimic : bool
        As in `dualpin.load`, where a name or path is given.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        What computes dualpin's side.
    arbitrate : bool
        Where a term differs, its definition in 50 digits always says who is nearer; with this also
        where it agrees and is off by more than 1e-13.  The errors of both are in
        ``worst["against_50_digits"]``.
    against : str, optional
        Name or path of a URDF that the robot is compared with, whatever it came from.  What differs
        in bodies, joints and gravity is in the notes of the result and in the reasons of its terms.
    oracle : str
        Who it is compared with, one of `dualpin.crosscheck.oracles.ORACLES`.

    Returns
    -------
    Report
        ``.passed``, ``.terms[name].max_scaled_error``, ``.write(folder)``.

    Raises
    ------
    UrdfError, ArgumentError, OracleError

    Notes
    -----
    The scaled error of a term is max|x - ref| / max(1, max|ref|) over the entries of a sample.
    Each tolerance carries its reason; 1e-12 is the ceiling of terms without a linear solve.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.validate("panda", samples=3, terms=["rnea", "crba"]).passed
    True
    """
    if isinstance(robot, Robot):
        expect_numbers("validate", robot)
    case = Case(robot, floating, mimic, against, oracle=oracle)
    checks = chosen(terms)
    samples = count("validate: samples", samples, 1)
    parts = slices(case, samples, seed)
    found = [compare(case, u.samples, u.seed, checks, engine, arbitrate) for u in parts]
    report = Report([merged(parts, found, seed)])
    report.versions = provenance(engine, oracle)
    return report


def provenance(engine: str, oracle: str = "pinocchio") -> dict[str, str]:
    """Versions, the machine, and what computes on it."""
    found = versions(**{oracle: ORACLES[oracle].version()}, engine=used_engine(engine))
    if found["engine"] == "compiled":
        from ..engine.jit.host import this_host

        bits = 8 * this_host().width
        found["engine"] += f", vectors of {bits} bits ({bits // 64} doubles)"
    if found["engine"] == "cuda":
        from ..engine.cuda.driver import device

        found["engine"] += f", {device().name}"
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
            reason=str(e) if oracles else "", error="" if oracles else str(e),
            engine=used_engine(case.engine or engine),
        )  # fmt: skip


def _loads(case: Case) -> Robot | None:
    try:
        return case.robot if isinstance(case.robot, Robot) else quietly_loaded(case.robot, case.floating, case.mimic)
    except DualpinError:
        return None


def _pinocchio_builds(case: Case) -> bool:
    from ..io.catalogue import find

    try:
        build(str(find(str(case.robot))), case.floating, case.mimic)
    except DualpinError:
        return False
    return True
