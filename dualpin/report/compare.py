"""What changed between two results: verdicts, errors, speed."""

from __future__ import annotations

from collections.abc import Iterable

from ..crosscheck.findings import SEARCHED
from ..crosscheck.fingerprint import differences
from ..crosscheck.results import AGREES, DIFFERS, NOT_COMPARED, Report, RobotResult, TermResult
from ..errors import ArgumentError
from .changes import LAST_DIGITS, Change, Comparison
from .compare_studies import studies
from .read import Row, Study


def compare(
    old: Study | Report, new: Study | Report, error_factor: float = 10.0, speed_factor: float = 1.1
) -> Comparison:
    """Say what got worse, better, slower or faster, and which verdicts changed.

    Parameters
    ----------
    old, new : Study or Report
        Two results of the same kind: two validations, two measurements of speed, or two studies of integrators.
    error_factor : float
        An error that grew by more than this, and is above 1e-14, is worse.
    speed_factor : float
        A time that grew by more than this is worse: of the ratio to Pinocchio where both have
        one (measured side by side, so that another machine does not count), of the time else.

    Returns
    -------
    Comparison
        ``.changes``, and ``.worse`` of them.

    Raises
    ------
    ArgumentError
        If the results are of different kinds, or of a kind that cannot be compared.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.report import compare
    >>> old, new = (dp.validate("ur5", samples=2, terms=["rnea"]) for _ in range(2))
    >>> compare(old, new).worse
    []
    """
    old, new = (Study("validation", "", s, header=dict(s.versions)) if isinstance(s, Report) else s for s in (old, new))
    if old.subject != new.subject:
        raise ArgumentError(
            f"report --compare: {old.name} is a {old.subject} result, {new.name} a {new.subject} result"
        )
    found = Comparison(old.header, new.header, error_factor=error_factor, speed_factor=speed_factor)
    if old.report is not None and new.report is not None:
        found.changes += _validations(found, old.report, new.report)
    elif old.subject == "speed":
        found.changes += _speeds(found, old.rows, new.rows)
    elif old.subject == "integrators":
        found.changes += studies(found, old, new)
    else:
        raise ArgumentError(
            f"report --compare: {old.subject} results are not compared; validations, speeds and studies of "
            "integrators are"
        )
    found.changes.sort(key=lambda c: (not c.worse, -abs(c.factor)))
    return found


def _validations(found: Comparison, old: Report, new: Report) -> Iterable[Change]:
    before, after = ({r.label: r for r in report.robots} for report in (old, new))
    for label in sorted(before.keys() - after.keys()):
        yield Change("missing", label, "validated", "absent", True)
    for label in sorted(after.keys() - before.keys()):
        yield Change("new", label, "absent", after[label].verdict, not after[label].passed)
    was, now = ({r.name: r for r in report.refused} for report in (old, new))
    for name in sorted(now.keys() - was.keys()):
        yield Change("verdict", name, "read", f"refused: {now[name].reason}", True)
    for label, robot in after.items():
        if label in before:
            yield from _robots(found, before[label], robot)


def _robots(found: Comparison, old: RobotResult, new: RobotResult) -> Iterable[Change]:
    for where, was, is_ in differences(old.model, new.model):
        yield Change("model", f"{new.label} {where}", was, is_, True)
    before, after = ([n for n in r.notes if not n.startswith(SEARCHED)] for r in (old, new))
    for note in (n for n in after if n not in before):
        yield Change("remark", new.label, "-", note, True)
    for note in (n for n in before if n not in after):
        yield Change("remark", new.label, note, "-", False, 0.5)
    if old.verdict != new.verdict:
        yield Change("verdict", new.label, old.verdict, new.verdict, _rank(new) > _rank(old))
    for name in sorted(old.terms.keys() - new.terms.keys()):
        yield Change("missing", f"{new.label} {name}", "compared", new.error or "absent", True)
    for name, t in new.terms.items():
        then = old.terms.get(name)
        if then is None:
            continue
        if then.verdict != t.verdict and {then.status, t.status} != {AGREES, DIFFERS}:
            # between agreeing and differing the robot's verdict and the error say it
            yield Change("verdict", f"{new.label} {name}", then.verdict, t.verdict, _rank(t) > _rank(then))
        if not (then.compared and t.compared):
            continue
        found.compared += 1
        x, y = then.max_scaled_error or 0.0, t.max_scaled_error or 0.0
        factor = max(y, LAST_DIGITS) / max(x, LAST_DIGITS)
        yield from found.changed("error", f"{new.label} {name}", f"{x:.1e}", f"{y:.1e}", factor)


def _speeds(found: Comparison, old: list[Row], new: list[Row]) -> Iterable[Change]:
    before, after = ({_setting(r): r for r in rows if "us_per_sample" in r} for rows in (old, new))
    for setting in sorted(before.keys() - after.keys()):
        yield Change("missing", setting, "measured", "absent", True)
    for setting, row in after.items():
        if setting not in before:
            continue
        found.compared += 1
        x, y = (_relative(r) for r in (before[setting], row))
        unit = "x Pinocchio's time"
        if x is None or y is None:
            x, y, unit = before[setting]["us_per_sample"], row["us_per_sample"], "us a sample"
        factor = y / x if x else 1.0
        yield from found.changed("speed", setting, f"{x:.3g} {unit}", f"{y:.3g} {unit}", factor)


def _relative(row: Row) -> float | None:
    theirs = row.get("pinocchio_us_per_sample")
    return row["us_per_sample"] / theirs if isinstance(theirs, (int, float)) and theirs else None


def _setting(row: Row) -> str:
    parts = [str(row.get("robot")), str(row.get("term"))]
    parts += [f"{k} {row[k]}" for k in ("batch", "threads", "base", "floating", "engine", "mode") if k in row]
    return ", ".join(parts)


def _rank(of: RobotResult | TermResult) -> int:
    """How bad a verdict is: agreeing, dualpin nearer, not compared, failed."""
    if not of.passed:
        return 3
    return [AGREES, DIFFERS, NOT_COMPARED].index(of.status)
