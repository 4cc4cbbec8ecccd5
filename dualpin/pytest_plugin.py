"""A pytest plugin: `pytest --dualpin my_robot.urdf` makes one test of every term of a robot.

Without ``--dualpin`` only this file is imported.  A robot is read when it is collected, and judged when the first of
its terms runs.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from .crosscheck.results import Report, RobotResult, TermResult

SAMPLES = 100  # states of a validation; for a subject the default of `dualpin.judge`
EXCUSED = ("not offered", "M is singular")
"""Reasons for which a subject's term is skipped; a crash, a refusal or an answer of the wrong shape fails."""


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("dualpin", "robots and dynamics code, compared term by term")
    group.addoption(
        "--dualpin", action="append", default=[], metavar="ROBOT", dest="dualpin",
        help="A URDF, or a name of `dualpin list`: one test a term. May be repeated.",
    )  # fmt: skip
    group.addoption(
        "--dualpin-subject", action="append", default=[], metavar="SUBJECT", dest="dualpin_subjects",
        help="Judge this code (module:attribute, file.py:attribute, a shipped name) instead of asking Pinocchio.",
    )  # fmt: skip
    group.addoption("--dualpin-terms", default="", metavar="TERMS", help="Some terms, between commas.")
    group.addoption("--dualpin-samples", type=int, default=None, metavar="N", help="Random states a robot.")
    group.addoption("--dualpin-seed", type=int, default=0, metavar="SEED", help="Of the states.")
    group.addoption("--dualpin-floating", action="store_true", help="Give the base six degrees of freedom.")
    group.addoption("--dualpin-mimic", action="store_true", help="Let joints with a <mimic> tag follow.")
    group.addoption("--dualpin-strict", action="store_true", help="Fail what was not compared, instead of skipping it.")
    group.addoption(
        "--dualpin-baseline", default=None, metavar="FILE",
        help="A report.json of before: one test more a robot, that its model and its verdicts did not change.",
    )  # fmt: skip
    group.addoption(
        "--dualpin-out", default=None, metavar="FOLDER",
        help="Write report.json, .md, .html, .sarif, junit.xml and badge.svg of what was judged into this folder.",
    )  # fmt: skip


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "dualpin: a term of a robot that `pytest --dualpin` compares")
    config.stash[JUDGED] = {}
    if config.option.dualpin_subjects and not config.option.dualpin:
        raise pytest.UsageError("--dualpin-subject needs a robot: --dualpin my_robot.urdf")
    if config.option.dualpin_baseline:
        config.stash[BEFORE] = _baseline(Path(config.invocation_params.dir, config.option.dualpin_baseline))
    if config.option.dualpin:
        for subject in _subjects(config):
            _terms(config, subject)  # a wrong option ends the run before xdist starts workers


def _baseline(path: Path) -> Report:
    """The report of before; a wrong file ends the run before any test."""
    from .errors import DualpinError
    from .report import read

    try:
        found = read(path).report
    except DualpinError as e:
        raise pytest.UsageError(f"--dualpin-baseline: {e}") from None
    if found is None:
        raise pytest.UsageError(f"--dualpin-baseline: {path} is no report of `dualpin validate` or `dualpin judge`")
    return found


def _subjects(config: pytest.Config) -> list[str]:
    """Each once; "" is dualpin itself, against Pinocchio."""
    return list(dict.fromkeys(config.option.dualpin_subjects)) or [""]


def _chosen(config: pytest.Config) -> list[str] | None:
    """The terms that were named; None is all."""
    return config.option.dualpin_terms.replace(",", " ").split() or None


def _terms(config: pytest.Config, subject: str) -> list[str]:
    """The terms that will be asked."""
    from .crosscheck.checks import chosen
    from .crosscheck.subjects.questions import wanted
    from .crosscheck.subjects.resolve import resolve
    from .errors import ArgumentError

    try:
        if not subject:
            return [c.term for c in chosen(_chosen(config))]
        resolve(subject)  # raises for an unknown name
        return list(wanted(_chosen(config)))
    except ArgumentError as e:
        raise pytest.UsageError(f"--dualpin: {e}") from None


@pytest.hookimpl(tryfirst=True)  # before -k, -m and --deselect select items
def pytest_collection_modifyitems(session: pytest.Session, config: pytest.Config, items: list[pytest.Item]) -> None:
    for name in dict.fromkeys(config.option.dualpin):
        for subject in _subjects(config):
            node = RobotNode.of(session, name, subject)
            found = node.ihook.pytest_make_collect_report(collector=node)
            node.ihook.pytest_collectreport(report=found)  # so that they are counted
            items += found.result


class WrongError(Exception):
    """The findings as text."""


JUDGED: pytest.StashKey[dict[str, str]] = pytest.StashKey()
"""The reports of this process as JSON, by robot and subject."""
BEFORE: pytest.StashKey[Report] = pytest.StashKey()
"""What was judged before, where a baseline is given."""


class RobotNode(pytest.Collector):
    """A robot with the subject that is judged, or dualpin itself."""

    robot: str
    subject: str
    told = ""
    """The term that said already why nothing was compared."""

    @classmethod
    def of(cls, session: pytest.Session, robot: str, subject: str) -> RobotNode:
        option = session.config.option
        path = session.config.invocation_params.dir / robot
        words = ["floating"] * option.dualpin_floating + ["mimic"] * option.dualpin_mimic + [subject] * bool(subject)
        where = path.relative_to(session.path).as_posix() if path.is_relative_to(session.path) else robot
        label = " ".join(["dualpin", *words]).translate({ord("["): "(", ord("]"): ")"})  # brackets hold parameters
        name = f"{Path(robot).name}: {label}"
        node: RobotNode = cls.from_parent(session, name=name, path=path, nodeid=f"{where}::{label}")
        node.robot, node.subject = robot, subject
        node.add_marker(pytest.mark.dualpin)
        if session.config.pluginmanager.hasplugin("xdist"):
            node.add_marker(pytest.mark.xdist_group(f"dualpin {node.nodeid}"))  # for --dist loadgroup
        return node

    def collect(self) -> list[pytest.Item]:
        from .crosscheck.pairing import quietly_loaded
        from .errors import DualpinError

        option = self.config.option
        try:
            quietly_loaded(self.robot, option.dualpin_floating, option.dualpin_mimic)
        except DualpinError as e:
            return [RefusedItem.of(self, str(e))]
        terms: list[pytest.Item] = [TermItem.from_parent(self, name=term) for term in _terms(self.config, self.subject)]
        return terms + [BaselineItem.from_parent(self, name="baseline")] * (BEFORE in self.config.stash)

    @cached_property
    def report(self) -> Report | str:
        """The comparison of all terms, made once, or the reason why there is none."""
        from .errors import DualpinError

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # the result contains the notes
                found = self._judged() if self.subject else self._validated()
        except DualpinError as e:
            return str(e)
        self.config.stash[JUDGED][self.nodeid] = found.to_json()
        return found

    @cached_property
    def refused(self) -> bool:
        """Whether a subject answered nothing at all, for one reason, such as a module that is not there."""
        if not self.subject or isinstance(self.report, str):
            return False
        terms = [t for robot in self.report.robots for t in robot.terms.values()]
        reasons = {t.reason for t in terms}
        return len(terms) > 1 and len(reasons) == 1 and all(t.status == "not compared" for t in terms)

    def _judged(self) -> Report:
        from .crosscheck import judge

        option = self.config.option
        return judge(
            self.robot, self.subject, option.dualpin_samples, option.dualpin_seed, terms=_chosen(self.config),
            floating=option.dualpin_floating, mimic=option.dualpin_mimic,
        )  # fmt: skip

    def _validated(self) -> Report:
        from .crosscheck import validate

        option = self.config.option
        samples = SAMPLES if option.dualpin_samples is None else option.dualpin_samples
        return validate(
            self.robot, samples, option.dualpin_seed, terms=_chosen(self.config),
            floating=option.dualpin_floating, mimic=option.dualpin_mimic,
        )  # fmt: skip


class _Item(pytest.Item):
    def reportinfo(self) -> tuple[Path, None, str]:
        return self.path, None, f"{self.parent.name} {self.name}" if self.parent else self.name

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if isinstance(excinfo.value, WrongError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)


class RefusedItem(_Item):
    """A file that did not become a robot."""

    reason: str

    @classmethod
    def of(cls, parent: RobotNode, reason: str) -> RefusedItem:
        item: RefusedItem = cls.from_parent(parent, name="refused")
        item.reason = reason
        return item

    def runtest(self) -> None:
        from .crosscheck.results import Refusal, Report
        from .escape import lines

        node = self.parent
        assert isinstance(node, RobotNode)
        # it fails whether or not Pinocchio reads the file
        self.config.stash[JUDGED][node.nodeid] = Report(refused=[Refusal(node.robot, self.reason, False)]).to_json()
        raise WrongError(f"refused: {lines(self.reason)}")


class TermItem(_Item):
    """One term of a robot."""

    def runtest(self) -> None:
        from .escape import lines

        node = self.parent
        assert isinstance(node, RobotNode)
        if isinstance(node.report, str):
            raise WrongError(lines(node.report))
        (result,) = node.report.robots
        if self.name not in result.terms:
            raise WrongError(lines(result.error or result.reason or "no result"))
        t = result.terms[self.name]
        self.user_properties.append(("verdict", t.verdict))
        if not t.passed or t.findings:
            raise WrongError(lines("\n".join(told(self.name, result, t))))
        if t.status == "not compared":
            reason = lines(t.reason or "nothing was compared")
            if node.refused:  # one error for one reason, not one for each term
                if node.told:
                    pytest.skip(f"{self.name} was not compared, see {node.told}")
                node.told = self.name
                raise WrongError(f"nothing was compared: {reason}")
            if self.config.option.dualpin_strict or (result.subject and not reason.startswith(EXCUSED)):
                raise WrongError(f"{self.name} was not compared: {reason}")
            pytest.skip(f"{self.name} was not compared: {reason}")


class BaselineItem(_Item):
    """A robot and its verdicts beside those of before."""

    def runtest(self) -> None:
        from .crosscheck.results import Report
        from .escape import lines
        from .report import compare

        node, before = self.parent, self.config.stash[BEFORE]
        assert isinstance(node, RobotNode)
        if isinstance(node.report, str):
            raise WrongError(lines(node.report))
        labels = {r.label for r in node.report.robots}
        old = [r for r in before.robots if r.label in labels]
        if not old:
            held = ", ".join(r.label for r in before.robots) or "none"
            raise WrongError(lines(f"the baseline has no {', '.join(sorted(labels))}; it has {held}"))
        found = compare(Report(old, versions=before.versions), node.report)
        if not found.passed:
            raise WrongError(lines("\n".join(f"{c.where}: {c.old} -> {c.new}" for c in found.worse)))


def told(term: str, result: RobotResult, t: TermResult) -> Iterator[str]:
    """A failed term as text: the cause, the fix, the worst place, and how to reproduce it."""
    yield f"{term} of {result.label}: {t.verdict}"
    for f in t.findings:
        yield f"  found: {f}"
        if f.alternatives:
            yield f"    as well explained by: {' | '.join(f.alternatives)}"
        if f.fix:
            yield f"    fix: {f.fix}"
    if t.remark and not t.findings:
        yield f"  {t.remark}"
    if t.compared:
        where = f", at {t.worst['where']}" if t.worst.get("where") else ""
        at = f"{where}, in sample {t.worst['sample']} of seed {result.seed}" if "sample" in t.worst else where
        yield f"  worst: scaled error {t.max_scaled_error:.1e}, at most {t.tolerance:.0e} allowed{at}"
    if t.worst.get("reproduce"):
        yield "  to see it again:"
        yield from (f"    {x}" for x in t.worst["reproduce"].splitlines())
    elif t.worst.get("q") is not None:
        yield f"  q = {t.worst['q']}"


# --- reports, written once, also with workers of xdist -----------------------------------------------


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any, error: Any) -> None:
    """Pass the reports of a worker of xdist to the main process."""
    output = getattr(node, "workeroutput", {})  # a crashed worker has none
    judged: dict[str, str] = node.config.stash[JUDGED]
    judged.update(output.get("dualpin", {}))


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    config = session.config
    if hasattr(config, "workeroutput"):
        config.workeroutput["dualpin"] = config.stash[JUDGED].copy()


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """Write the folder; not in a worker, which has no terminal."""
    found, folder = config.stash[JUDGED], config.option.dualpin_out
    if not folder or not found:
        return
    from .crosscheck.results import Report
    from .errors import DualpinError
    from .report.page import available

    report = Report()
    for text in dict(sorted(found.items())).values():
        one = Report.from_dict(json.loads(text))
        report.robots += one.robots
        report.refused += one.refused
        report.versions |= one.versions
    formats = ["json", "md", *["html"] * available(), "junit", "sarif", "badge"]
    try:
        for path in report.write(Path(config.invocation_params.dir, folder), formats):
            terminalreporter.write_line(f"wrote {path}")
    except DualpinError as e:  # the verdicts were printed before
        terminalreporter.write_line(f"--dualpin-out: {e}", red=True)
