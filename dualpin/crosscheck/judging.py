"""Judge any dynamics code: query it, compare every term, and diagnose the differences."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ..arguments import count, flag, real
from ..call import evaluate
from ..errors import ArgumentError, DualpinWarning
from ..functions import fk
from ..machine import versions
from ..model.robot import Robot
from ..terms import TERMS
from . import tolerance
from .adjudicate import Court, nearer
from .checks import CHECKS
from .definitions import UndecidedError
from .extent import Extent
from .findings import Finding
from .fingerprint import fingerprint
from .ledger import Ledger
from .reproduce import program
from .results import AGREES, DIFFERS, NOT_COMPARED, Report, RobotResult, TermResult
from .subjects.answers import Answers
from .subjects.asking import SAMPLES, Asking, asking, expected
from .subjects.convention import parameter_names
from .subjects.kept import Kept, plain, restored
from .subjects.layout import Layout, States
from .subjects.questions import QUESTIONS, wanted
from .subjects.resolve import Asker, resolve
from .tally import QUANTILES, scaled_error
from .tolerance import EPS

LINE = 1e-9
"""Where agreement ends: other algorithms, about other points, round up to 1e-12 or so apart; constants in single
precision are 1e-8 off, and every mistake is more."""
LAST_DIGITS = 1e-13
"""A scaled error from which the definition in 50 digits is evaluated."""
Tick = Callable[[str], None]


def judge(
    robot: str | Path | Robot,
    subject: Any,
    samples: int | None = None,
    seed: int = 0,
    *,
    terms: Sequence[str] | None = None,
    diagnose: bool = True,
    floating: bool = False,
    mimic: bool = False,
    python: str | None = None,
    limit: float = 60.0,
    folder: str | Path | None = None,
    progress: Tick | None = None,
) -> Report:
    """Compare dynamics code with dualpin term by term, and say why what differs differs.

    Parameters
    ----------
    robot : Robot, or name or path of one
    subject : str, Path, object, mapping or Command
        Who is judged: a shipped name ("pinocchio", ...); ``"module:attribute"`` or ``"file.py:attribute"``,
        which runs in a process of its own; an object whose methods are terms (see
        `dualpin.crosscheck.subjects.Subject`); a mapping such as ``{"rnea": f}``, with "writes", a
        `Convention`, where it writes otherwise than dualpin; an exchange folder that a program of any
        language has answered into; or a `dualpin.crosscheck.subjects.Command`.
    samples : int, optional
        How many states; 16 by default.  A slow subject is asked fewer.
    seed : int
        Of the states.
    terms : sequence of str, optional
        Some of `dualpin.crosscheck.subjects.QUESTIONS`; all that the subject has by default.
    diagnose : bool
        Look for the causes.
    floating, mimic : bool
        As in `dualpin.load`, for a name or path; a `Robot` is as it was loaded.
    python : str, optional
        The interpreter of the environment the subject lives in.
    limit : float
        Seconds after which a subject in a process of its own counts as hanging.
    folder : path, optional
        Where answers are kept as they come, until the judgement is done: the same call takes up what an
        interrupted one left.  Of a subject that can be known again: a shipped name, a module's, a file's, a
        command, as long as the files that it names, and those beside them with the same ending, are what they
        were.  Objects and mappings are asked anew: nothing tells whether two of them compute the same.
    progress : callable, optional
        Called with a line that says what is being done.

    Returns
    -------
    Report
        As of `validate`: ``.terms[name].status`` is "agrees", "differs" or "not compared",
        ``.findings`` lists the causes, each with ``.key .says .terms .before .after .items .alternatives
        .fix``; ``.write(folder)``.

    Raises
    ------
    ArgumentError, UrdfError

    Examples
    --------
    A torque that forgets gravity:

    >>> import dualpin as dp
    >>> arm = dp.load("ur5")
    >>> light = arm.with_gravity((0, 0, 0))
    >>> report = dp.judge(arm, {"rnea": lambda q, v, a: dp.rnea(light, q, v, a)})
    >>> report.terms["rnea"].status, report.findings[0].key
    ('differs', 'gravity')
    """
    return judge_all(
        robot, [subject], samples, seed, terms=terms, diagnose=diagnose, floating=floating, mimic=mimic, python=python,
        limit=limit, folder=folder, progress=progress,
    )  # fmt: skip


def judge_all(
    robot: str | Path | Robot, subjects: Sequence[Any], samples: int | None = None, seed: int = 0, *,
    terms: Sequence[str] | None = None, diagnose: bool = True, floating: bool = False, mimic: bool = False,
    python: str | None = None, limit: float = 60.0, folder: str | Path | None = None, progress: Tick | None = None,
    interruptible: bool = False,
) -> Report:  # fmt: skip
    """Several subjects on one robot, as `judge`; with `interruptible`, Ctrl-C ends it with a partial report."""
    tick = progress if progress is not None else (lambda what: None)
    if not callable(tick):
        raise ArgumentError(f"judge: progress = {progress!r}, a function of one line of text expected")
    diagnose, floating, mimic = (
        flag(f"judge: {k}", x) for k, x in (("diagnose", diagnose), ("floating", floating), ("mimic", mimic))
    )
    limit, seed = real("judge: limit", limit, "s", above=0, infinite=True), count("judge: seed", seed)
    n = SAMPLES if samples is None else samples
    n = count("judge: samples (half of them estimate, all judge)", n, 2)
    askers = [resolve(s, python=python, limit=limit) for s in subjects]
    report = Report()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)  # its notes are in the result
        given = asking(robot, int(n), seed, wanted(terms), floating=floating, mimic=mimic)
        settings = {
            "robot": given.text, "floating": floating, "mimic": mimic, "gravity": given.gravity, "samples": n,
            "seed": seed, "terms": given.terms, "diagnose": diagnose, "dualpin": versions()["dualpin"],
        }  # fmt: skip
        ledger = Ledger(None if folder is None else Path(folder), settings)
        try:
            for ask in askers:
                report.robots.append(_one(ask, given, diagnose, tick, ledger))
        except KeyboardInterrupt:
            report.partial = True
            if not interruptible:
                raise
        finally:
            ledger.close(done=len(report.robots) == len(askers))
    said = {r.subject: r.subject_version for r in report.robots if r.subject_version}
    report.versions = versions(**said)
    return report


def _one(ask: Asker, given: Asking, diagnose: bool, tick: Tick, ledger: Ledger) -> RobotResult:
    """One subject: from the ledger where it is finished there, and from its answers where these are."""
    key = ask.identity
    if key and key in ledger.entries:
        return RobotResult.from_dict(ledger.entries[key])
    answered = f"{key}|answers"
    if key and answered in ledger.entries:
        answers = restored(ledger.entries[answered], given)
    else:
        answers = ask(given, tick, Kept(ledger, key) if key else None)
        if key:
            ledger.add(answered, plain(answers))
    result = verdict(answers, given, diagnose, ask.refusal, tick)
    if key:
        ledger.add(key, asdict(result))
    return result


def verdict(
    answers: Answers, given: Asking, diagnose: bool, refusal: Callable[[Asking, float], str] | None, tick: Tick
) -> RobotResult:
    """What is to be said of answers, whenever they were given; a refusal is looked into by asking again."""
    result = judged(answers, given, diagnose, tick)
    if diagnose and answers.refused and refusal:
        _explain_refusal(result, answers, given, refusal, tick)
    return result


def judged(answers: Answers, given: Asking, diagnosing: bool = True, tick: Tick = lambda what: None) -> RobotResult:
    """The result of one subject on one robot."""
    start = time.perf_counter()
    asked = answers.asking
    notes = [r for r in (answers.remarks.get(""),) if r]
    terms: dict[str, TermResult] = {}
    reason = f"refused: {answers.refused}" if answers.refused else ""
    if reason:
        terms = {
            t: TermResult(status=NOT_COMPARED, reason=reason, oracle=answers.name, judged="oracle") for t in given.terms
        }
    else:
        layout = Layout(asked.robot, answers.how)
        court, bounds = Court(answers, layout), _Bounds(asked.robot, asked.states)
        for term in given.terms:
            tick(f"{term}: compared")
            terms[term] = _compared(term, answers, layout, court, bounds)
        if diagnosing:
            notes += _explain(terms, answers, tick)
    return RobotResult(
        given.name, given.floating, given.mimic, asked.robot.nv, asked.samples, asked.seed, True, terms, notes,
        seconds=round(time.perf_counter() - start + answers.seconds, 3), reason=reason, engine="numpy",
        subject=answers.name, subject_version=answers.version, model=fingerprint(asked.robot),
    )  # fmt: skip


def _compared(term: str, answers: Answers, layout: Layout, court: Court, bounds: _Bounds) -> TermResult:
    """One term: the worst sample (and frame), who is right there, and how to see it."""
    note = answers.remarks.get(term, "")
    if term not in answers.terms:
        return TermResult(
            status=NOT_COMPARED,
            reason=answers.silent.get(term, "not offered"),
            oracle=answers.name,
            note=note,
            judged="oracle",
        )
    asked, x = answers.asking, answers.terms[term]
    try:
        ours = expected(asked.robot, layout, term, asked.states, asked.frames)
    except ArgumentError as e:  # what the subject means by it cannot be read
        return TermResult(status=NOT_COMPARED, reason=str(e), oracle=answers.name, note=note, judged="oracle")
    bound = bounds.of(term, ours)
    variants = len(asked.frames) if QUESTIONS[term].framed else 1
    rows = x.reshape(asked.samples * variants, -1)
    reference = ours.reshape(asked.samples * variants, -1)
    silent = np.isnan(rows).all(axis=1)
    error, entry = scaled_error(np.where(np.isnan(rows), reference, rows), reference)
    error[silent | np.repeat(bound.empty | bounds.hopeless(term), variants)] = np.nan
    result = TermResult(
        oracle=answers.name, status=NOT_COMPARED, judged="oracle", note=note, tolerance_reason=bound.reason
    )
    result.compared = int((~np.isnan(error)).sum())
    if not result.compared:
        result.reason = "M is singular to working precision in every sample"
        return result
    ratio = np.where(np.isnan(error), -1.0, error / np.repeat(bound.value, variants))
    worst = int(np.argmax(ratio))
    sample, frame = divmod(worst, variants)
    result.max_scaled_error, result.tolerance = float(np.nanmax(error)), float(np.repeat(bound.value, variants)[worst])
    result.quantiles = np.quantile(error[~np.isnan(error)], QUANTILES, method="lower").tolist()
    unit = bounds.unit(term, sample)
    result.worst = {
        "sample": sample, "variant": frame, "ratio": float(ratio[worst]), "entry": int(entry[worst]),
        "where": _where(term, answers, frame, int(entry[worst])), "n_eps_cond": float(error[worst]) / unit,
        **{k: asked.states[k][sample].tolist() for k in ("q", "v", "a")},
    }  # fmt: skip
    decided = AGREES if ratio[worst] <= 1.0 else DIFFERS
    who = ""
    if result.max_scaled_error > LAST_DIGITS:
        try:
            found = result.worst["against_50_digits"] = court.errors(term, sample, frame)
            who = nearer(found, result.tolerance) if decided == DIFFERS else ""
        except UndecidedError as e:
            result.note = "; ".join(x for x in (note, f"not decided by 50 digits: {e}") if x)
    result.settle(decided, who)
    if decided == DIFFERS:
        result.worst["reproduce"] = program(term, answers, sample, frame, x[sample], ours[sample])
    return result


def _where(term: str, answers: Answers, frame: int, entry: int) -> str:
    """The worst entry in words, in the subject's columns."""
    v, question = list(answers.how.v), QUESTIONS[term]
    of = f"; frame {answers.asking.frames[frame]}" if question.framed else ""
    if term == "fk":
        return f"{entry // 4}, {entry % 4}{of}"
    if question.form == "twist":
        return f"{answers.how.rows[entry]}{of}"
    if term.endswith("_energy"):
        return ""
    if term == "com":
        return "xyz"[entry]
    if question.form == "regressor":
        parameters = answers.how.parameters or parameter_names(answers.asking.robot)
        return f"row {v[entry // len(parameters)]}, column {parameters[entry % len(parameters)]}"
    if question.form == "derivatives":
        block, rest = divmod(entry, len(v) ** 2)
        by = (question.inputs[block] if block else "q", v[rest // len(v)], v[rest % len(v)])
        return f"by {by[0]}: row {by[1]}, column {by[2]}"
    if question.form in ("force", "bias", "acceleration", "pushed_force", "pushed_acceleration"):
        return f"{v[entry]}{of}"
    row, column = divmod(entry, len(v))
    rows = {"com_jacobian": list("xyz"), "six": list(answers.how.rows), "six_rate": list(answers.how.rows)}
    names = rows.get(term) or rows.get(question.form) or v
    return f"row {names[row]}, column {v[column]}{of}"


class _Bounds:
    """How far a right answer may be off, sample by sample, and why."""

    def __init__(self, robot: Robot, states: States) -> None:
        self.robot, self.states, self.n = robot, states, len(states["q"])
        extent = Extent(robot, fk(robot, states["q"], engine="numpy")[..., :3, 3], states)
        self.reference = tolerance.Reference(robot, states, extent, self._ours)

    def _ours(self, term: str) -> np.ndarray:
        return evaluate(self.robot, term, {k: self.states[k] for k in TERMS[term].inputs}, engine="numpy")

    def of(self, term: str, ours: np.ndarray) -> tolerance.Tolerance:
        largest = np.abs(ours).max(axis=1) if QUESTIONS[term].pushes else ours  # of all frames
        found = CHECKS[QUESTIONS[term].source].bound(self.reference, largest)
        value = np.maximum(LINE, found.value)
        return tolerance.Tolerance(
            value, f"{LINE:g}, since the subject's algorithm may be any; or, if that is more, {found.reason}"
        )

    def unit(self, term: str, sample: int) -> float:
        """n eps, times cond(M) where a system is solved with it."""
        unit = max(1, len(self.robot)) * EPS
        return unit * float(self.reference.mass.condition[sample]) if QUESTIONS[term].solves else unit

    def hopeless(self, term: str) -> np.ndarray:
        return self.reference.mass.hopeless if QUESTIONS[term].solves else np.zeros(self.n, bool)


def _explain(terms: dict[str, TermResult], answers: Answers, tick: Tick) -> list[str]:
    """Findings for the terms that differ, and a remark on the search."""
    from .diagnosis import Case, diagnose

    off = [t for t, r in terms.items() if r.status == DIFFERS]
    off += [t for t in answers.history if t not in off]
    if not off:
        return []
    told = diagnose(Case(answers, LINE), tick=tick)
    for finding in told.findings:
        finding.subject = answers.name
    for term in off:
        result = terms[term]
        result.findings = told.of(term)
        located = _not_finite(answers, term) or told.located.get(term, "")
        reason = _cause(result.findings) or f"cause unknown{'; ' if located else ''}{located}"
        if result.status == DIFFERS:
            result.settle(DIFFERS, result.nearer, reason)
    return [f"diagnosis: {told.predictions} answers predicted in {told.seconds:.1f} s"]


def _not_finite(answers: Answers, term: str) -> str:
    """In how many states an answer has entries that are no numbers; none of the causes predicts these."""
    odd = np.isinf(answers.terms[term]).reshape(len(answers.terms[term]), -1).any(axis=1)
    return f"infinite or not a number in {odd.sum()} of {len(odd)} states" if odd.any() else ""


def _explain_refusal(
    result: RobotResult, answers: Answers, given: Asking, refusal: Callable[[Asking, float], str], tick: Tick
) -> None:
    """What in the file keeps the subject from reading it; its terms are not compared."""
    from .diagnosis.repair import repaired

    told = repaired(answers, given, refusal, tick)
    result.notes += [told.remark] if told.remark else []
    result.refusal = told.finding
    if told.finding:
        result.reason = f"refused: {told.finding.says}; to be read: {told.finding.fix}"
        for term in result.terms.values():
            term.reason = result.reason


def _cause(findings: list[Finding]) -> str:
    return "; ".join(f.says for f in findings)
