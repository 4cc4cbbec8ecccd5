"""Compare every term of one robot with the oracle, sample by sample."""

from __future__ import annotations

import tempfile
import time
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..call import evaluate
from ..errors import DualpinWarning
from ..io.urdf import load
from ..model.robot import Robot
from ..terms import TERMS
from . import tolerance
from .arbiter import arbitrate as _fifty_digits
from .checks import CHECKS, Case, Check
from .oracles.pinocchio import Pinocchio
from .results import AGREES, NOT_COMPARED, RobotResult, TermResult
from .sampling import batches, planar_angles, states
from .tally import Tally, scaled_error
from .tolerance import MassMatrices
from .where import locate

LAST_DIGITS = 1e-13
"""A scaled error from which it is worth knowing who is right."""

WEIGHTLESS = "no moving body has mass"


def compare(
    case: Case, samples: int, seed: int, checks: Sequence[Check], engine: str, arbitrate: bool = False
) -> RobotResult:
    """All checks of one robot."""
    start = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)  # its notes are in the result
        robot = case.robot if isinstance(case.robot, Robot) else load(case.robot, case.floating, case.mimic)
    floating = robot.floating
    coupled = case.mimic or robot.coupled
    with tempfile.TemporaryDirectory() as folder:
        oracle = Pinocchio(robot, robot.source or _written(robot, folder), floating, coupled)
    given = states(robot, samples, seed, engine) | {"sample": np.arange(samples)}
    weightless = robot.mass == 0
    tallies = {c.term: Tally() for c in checks if not (weightless and c.weighs)}
    for together in _groups([CHECKS[term] for term in tallies]):
        largest = max(
            int(np.prod(TERMS[c.term].shape(robot, **c.variants(robot, seed)[0]), dtype=int)) for c in together
        )
        for part in batches(samples, largest):
            batch = {key: x[part] for key, x in given.items()}
            mass = MassMatrices(*oracle.compute("crba", {"q": batch["q"]})) if together[0].solves else None
            for check in together:
                _gather(tallies[check.term], check, robot, oracle, batch, seed, engine, mass)
    results = {c.term: TermResult(status=NOT_COMPARED, reason=WEIGHTLESS) for c in checks}
    results |= {term: tally.result(oracle.source(term), given) for term, tally in tallies.items()}
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
    found = RobotResult(
        case.name, floating, coupled, robot.nv, samples, seed, True, results, notes, engine=used_engine(engine)
    )
    if weightless and found.status == AGREES and any(c.weighs for c in checks):
        found.status, found.reason = NOT_COMPARED, f"{WEIGHTLESS}: only its kinematics can be compared"
    found.seconds = round(time.perf_counter() - start, 3)
    return found


def used_engine(asked: str) -> str:
    """What computes where this engine is asked for."""
    if asked != "auto":
        return asked
    from ..engine.jit.host import CompilerError, this_host

    try:
        this_host()
    except CompilerError:
        return "numpy"
    return "compiled"


def _written(robot: Robot, folder: str) -> str:
    path = str(Path(folder) / "robot.urdf")
    robot.to_urdf(path)
    return path


def _groups(checks: Sequence[Check]) -> list[list[Check]]:
    """Terms by themselves, but those that solve with M together: how well it can be solved with is found once."""
    solving = [c for c in checks if c.solves]
    return [[c] for c in checks if not c.solves] + ([solving] if solving else [])


def _gather(
    tally: Tally, check: Check, robot: Robot, oracle: Pinocchio, batch: dict[str, np.ndarray], seed: int, engine: str,
    mass: MassMatrices | None,
) -> None:  # fmt: skip
    inputs = {name: batch[name] for name in check.inputs.values()}
    named = {key: batch[name] for key, name in check.inputs.items()}
    variants = check.variants(robot, seed)
    answers = oracle.compute(check.term, inputs, variants)
    n = len(batch["q"])
    for variant, (options, theirs) in enumerate(zip(variants, answers, strict=True)):
        ours = evaluate(robot, check.term, named, engine=engine, **options)
        bound = _bound(check.term, robot, oracle, batch, theirs, mass)
        error, where = scaled_error(ours.reshape(n, -1), theirs.reshape(n, -1))
        if mass is not None:
            error[mass.hopeless] = np.nan
        tally.add(error, bound.value, where, batch["sample"], variant)
        tally.reason = bound.reason


def _bound(
    term: str, robot: Robot, oracle: Pinocchio, batch: dict[str, np.ndarray], theirs: np.ndarray,
    mass: MassMatrices | None,
) -> tolerance.Tolerance:  # fmt: skip
    """How far the two may be apart, sample by sample.

    What it depends on comes from the oracle: a wrong M of ours would widen its own bound.
    """
    if term == "difference":
        return tolerance.logarithm(robot, theirs[:, planar_angles(robot)])
    if term == "potential_energy":
        (poses,) = oracle.compute("fk", {"q": batch["q"]})
        return tolerance.weighing(robot, poses[..., :3, 3], theirs)
    if mass is None:
        return tolerance.recursion(robot, len(theirs))
    if term == "minv":
        return tolerance.inverse(robot, mass)
    (bias,) = oracle.compute("bias", {key: batch[key] for key in ("q", "v")})
    forces = np.abs(batch["tau"]) + np.abs(bias)
    if term == "aba_derivatives":
        (a,) = oracle.compute("aba", {key: batch[key] for key in ("q", "v", "tau")})
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
