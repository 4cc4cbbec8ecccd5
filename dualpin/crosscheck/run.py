"""Compare every term of a robot with the oracle, sample by sample."""

from __future__ import annotations

import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..algorithms.kinematics import References
from ..boundary import call
from ..errors import ArgumentError, DualpinError, DualpinWarning, nearest
from ..functions import aba, bias, crba, fk
from ..io.urdf import load
from ..model.robot import Robot
from ..terms import TERMS
from . import tolerance
from .arbiter import arbitrate as _fifty_digits
from .oracles.pinocchio import Pinocchio, build
from .results import Refusal, Report, RobotResult, TermResult, versions
from .sampling import batches, frames, planar_angles, states
from .tolerance import MassMatrices
from .where import locate

LAST_DIGITS = 1e-13
"""A scaled error from which it is worth knowing who is right."""

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Which quantiles of its scaled errors a term keeps."""

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
    """A term to compare: in which variants, whether a linear system is solved in it, and whether it divides by mass."""

    term: str
    variants: Variants = _plain
    solves: bool = False
    weighs: bool = False


CHECKS = {
    c.term: c
    for c in (
        Check("fk"), Check("frame_pose", _frames), Check("jacobian", _seen), Check("jacobian_dot", _seen),
        Check("frame_velocity", _seen), Check("frame_acceleration", _accelerated),
        Check("rnea"), Check("rnea_f_ext"), Check("bias"), Check("gravity"), Check("crba"), Check("coriolis"),
        Check("aba", solves=True), Check("minv", solves=True), Check("kinetic_energy"), Check("potential_energy"),
        Check("com", weighs=True), Check("com_jacobian", weighs=True), Check("centroidal_momentum_matrix", weighs=True),
        Check("joint_torque_regressor"),
        Check("rnea_derivatives"), Check("aba_derivatives", solves=True), Check("difference"),
    )
}  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A robot to validate: by name or path, or itself."""

    robot: str | Robot
    floating: bool = False
    mimic: bool = False

    @property
    def name(self) -> str:
        return self.robot.name if isinstance(self.robot, Robot) else str(self.robot)


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
    report.versions = versions(pinocchio=pinocchio_version())
    return report


def pinocchio_version() -> str:
    from .oracles.pinocchio import import_pinocchio

    return str(import_pinocchio().__version__)


def chosen(terms: Iterable[str] | None) -> list[Check]:
    if terms is None:
        return list(CHECKS.values())
    terms = [terms] if isinstance(terms, str) else list(terms)
    for term in terms:
        if term not in CHECKS:
            raise ArgumentError(f"validate: term {term!r} is not known; {nearest(term, CHECKS, 'terms', most=99)}")
    return [CHECKS[t] for t in terms]


def attempt(
    case: Case, samples: int, seed: int, checks: Sequence[Check], engine: str, arbitrate: bool = False
) -> RobotResult | Refusal:
    """One case; a robot that fails is reported as failed, never skipped."""
    try:
        return compare(case, samples, seed, checks, engine, arbitrate)
    except DualpinError as e:
        if isinstance(case.robot, str) and _loads(case) is None:
            return Refusal(case.name, str(e), by_pinocchio=not _pinocchio_builds(case))
        return RobotResult(case.name, case.floating, case.mimic, 0, samples, seed, False, error=str(e))


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


@dataclass
class _Tally:
    """Errors of one term, gathered batch by batch."""

    errors: list[np.ndarray] = field(default_factory=list)
    bounds: list[np.ndarray] = field(default_factory=list)
    where: list[np.ndarray] = field(default_factory=list)
    samples: list[int] = field(default_factory=list)
    variants: list[int] = field(default_factory=list)
    reason: str = ""


def compare(
    case: Case, samples: int, seed: int, checks: Sequence[Check], engine: str, arbitrate: bool = False
) -> RobotResult:
    """All checks of one robot."""
    start = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)  # its notes are in the result
        robot = case.robot if isinstance(case.robot, Robot) else load(case.robot, case.floating, case.mimic)
    floating = bool(robot.joints) and robot.joints[0].name == "root_joint" and robot.joints[0].kind == "floating"
    coupled = case.mimic or robot.coupled
    with tempfile.TemporaryDirectory() as folder:
        oracle = Pinocchio(robot, robot.source or _written(robot, folder), floating, coupled)
    given = states(robot, samples, seed, engine) | {"sample": np.arange(samples)}
    tallies = {c.term: _Tally() for c in checks if robot.mass > 0 or not c.weighs}
    for together in _groups([CHECKS[term] for term in tallies]):
        largest = max(
            int(np.prod(TERMS[c.term].shape(robot, **c.variants(robot, seed)[0]), dtype=int)) for c in together
        )
        for part in batches(samples, largest):
            batch = {key: x[part] for key, x in given.items()}
            mass = MassMatrices(crba(robot, batch["q"], engine=engine)) if together[0].solves else None
            for check in together:
                _gather(tallies[check.term], check, robot, oracle, batch, seed, engine, mass)
    results = {c.term: TermResult(0.0, 0.0, True, note="no moving body has mass") for c in checks}
    results |= {term: _judged(tally, oracle.source(term), given) for term, tally in tallies.items()}
    for term, result in results.items():
        if result.worst:
            options = CHECKS[term].variants(robot, seed)[result.worst["variant"]]
            result.worst["where"] = locate(robot, term, result.worst["entry"], options)
    if arbitrate:
        for term, result in results.items():
            if result.max_scaled_error > LAST_DIGITS and term != "difference":
                _arbitrate(result, CHECKS[term], robot, oracle, given, seed)
    notes = [
        *robot.notes,
        *([f"mimic: {oracle.refusal}; projected from the uncoupled model"] if oracle.refusal else []),
    ]
    return RobotResult(
        case.name, floating, coupled, robot.nv, samples, seed, all(r.passed for r in results.values()),
        results, notes, seconds=round(time.perf_counter() - start, 3),
    )  # fmt: skip


def _written(robot: Robot, folder: str) -> str:
    path = str(Path(folder) / "robot.urdf")
    robot.to_urdf(path)
    return path


def _groups(checks: Sequence[Check]) -> list[list[Check]]:
    """Terms by themselves, but those that solve with M together: how well it can be solved with is found once."""
    solving = [c for c in checks if c.solves]
    return [[c] for c in checks if not c.solves] + ([solving] if solving else [])


def _gather(
    tally: _Tally, check: Check, robot: Robot, oracle: Pinocchio, batch: dict[str, np.ndarray], seed: int, engine: str,
    mass: MassMatrices | None,
) -> None:  # fmt: skip
    keys = ["q", "q1"] if check.term == "difference" else list(TERMS[check.term].inputs)
    inputs = {key: batch[key] for key in keys}
    named = {"q0": batch["q"], "q1": batch["q1"]} if check.term == "difference" else inputs
    variants = check.variants(robot, seed)
    answers = oracle.compute(check.term, inputs, variants)
    n = len(batch["q"])
    for variant, (options, theirs) in enumerate(zip(variants, answers, strict=True)):
        ours = call(robot, check.term, named, engine=engine, **options)
        bound = _bound(check.term, robot, batch, ours, theirs, engine, mass)
        error, where = scaled_error(ours.reshape(n, -1), theirs.reshape(n, -1))
        if mass is not None:
            error[mass.hopeless] = np.nan
        tally.errors.append(error)
        tally.bounds.append(bound.value)
        tally.where.append(where)
        tally.samples += batch["sample"].tolist()
        tally.variants += [variant] * n
        tally.reason = bound.reason


def scaled_error(x: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """max|x - ref| / max(1, max|ref|) of each row, infinite where that is no number; and where.  x is overwritten."""
    if x.shape[1] == 0:
        return np.zeros(len(x)), np.zeros(len(x), int)
    with np.errstate(all="ignore"):
        difference = np.abs(np.subtract(x, reference, out=x), out=x)
        where = difference.argmax(axis=1)
        scale = np.maximum(1.0, np.maximum(reference.max(axis=1), -reference.min(axis=1)))
        error = np.take_along_axis(difference, where[:, None], axis=1)[:, 0] / scale
    return np.where(np.isfinite(error), error, np.inf), where


def _bound(
    term: str, robot: Robot, batch: dict[str, np.ndarray], ours: np.ndarray, theirs: np.ndarray, engine: str,
    mass: MassMatrices | None,
) -> tolerance.Tolerance:  # fmt: skip
    """How far the two may be apart, sample by sample."""
    if term == "difference":
        return tolerance.logarithm(robot, ours[:, planar_angles(robot)])
    if term == "potential_energy":
        return tolerance.weighing(robot, fk(robot, batch["q"], engine=engine)[..., :3, 3], theirs)
    if mass is None:
        return tolerance.recursion(robot, len(theirs))
    if term == "minv":
        return tolerance.inverse(robot, mass)
    forces = np.abs(batch["tau"]) + np.abs(bias(robot, batch["q"], batch["v"], engine=engine))
    if term == "aba_derivatives":
        a = aba(robot, batch["q"], batch["v"], batch["tau"], engine=engine)
        return tolerance.derivatives(robot, mass, forces, a, theirs)
    return tolerance.solution(robot, mass, forces, theirs)


def _arbitrate(
    result: TermResult, check: Check, robot: Robot, oracle: Pinocchio, given: dict[str, np.ndarray], seed: int
) -> None:
    """Record how far each library is from 50 digits, at the worst sample and in its variant."""
    one = slice(result.worst["sample"], result.worst["sample"] + 1)
    options = check.variants(robot, seed)[result.worst["variant"]]
    state = {key: given[key][one] for key in TERMS[check.term].inputs}
    (theirs,) = oracle.compute(check.term, state, [options])
    result.worst["against_50_digits"] = _fifty_digits(
        robot, check.term, {k: x[0] for k, x in state.items()}, theirs, **options
    )


def _judged(tally: _Tally, oracle: str, given: dict[str, np.ndarray]) -> TermResult:
    error, bound, where = map(np.concatenate, (tally.errors, tally.bounds, tally.where))
    compared = ~np.isnan(error)
    result = TermResult(0.0, 0.0, True, tally.reason, oracle, int(compared.sum()))
    if not compared.all():
        result.note = f"{int((~compared).sum())} of {len(error)} not compared: M is singular to working precision"
    if not compared.any():
        return result
    ratio = np.where(compared, error / bound, -1.0)
    worst = int(ratio.argmax())
    result.max_scaled_error = float(np.nanmax(error))
    result.quantiles = np.quantile(error[compared], QUANTILES, method="lower").tolist()
    result.tolerance = float(bound[worst])
    result.passed = bool(ratio[worst] <= 1.0)
    sample = tally.samples[worst]
    result.worst = {
        "sample": sample, "variant": tally.variants[worst], "ratio": float(ratio[worst]), "entry": int(where[worst]),
        "q": given["q"][sample].tolist(), "v": given["v"][sample].tolist(), "a": given["a"][sample].tolist(),
    }  # fmt: skip
    return result
