"""Results of a comparison, and how they are written."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..delegates import home
from ..errors import ArgumentError, nearest
from ..files import write_text, writing
from .findings import CONVENTIONS, Finding, once

AGREES, DIFFERS, NOT_COMPARED = "agrees", "differs", "not compared"
DUALPIN, ORACLE, NEITHER, UNDECIDED = "dualpin", "oracle", "neither", "undecided"
VERDICTS = {
    DUALPIN: "differs, dualpin nearer",
    ORACLE: "differs, oracle nearer",
    NEITHER: "differs, both far",
    UNDECIDED: "differs, undecided",
}
"""How a difference is named, by who is nearer to the value with 50 digits."""


@dataclass(repr=False)
class TermResult:
    """One term of one robot.

    Attributes
    ----------
    max_scaled_error : float
        The largest of max|x - ref| / max(1, max|ref|) over the samples; 0 where none was compared.
    tolerance : float
        The bound at the sample that comes nearest to its own.
    passed : bool
        True unless something differs and what is judged is not known to be nearer the truth.
    reason : str
        Where nothing was compared, why; where the two differ, what is known about it.
    oracle : str
        What it was compared with.
    compared : int
        How many samples were compared.
    left_out : int
        How many were not, since M is singular to working precision there.
    note : str
        What else is to be known, such as samples that were left out.
    worst : dict
        The sample that comes nearest to its bound (or exceeds it most): ``sample``, ``variant``, ``ratio``,
        ``entry``, ``where`` (the place of the worst entry in words), ``q``, ``v``, ``a``; and, where
        the two differ, ``against_50_digits``: the scaled errors of both against 50 digits.
    quantiles : list of float
        Scaled errors that 5, 25, 50, 75 and 95 % of the samples stay below, and the largest.
    status : str
        "agrees", "differs" or "not compared".
    nearer : str
        Where it differs: "dualpin", "oracle", "neither" or "undecided"; empty elsewhere.
    tolerance_reason : str
        Why the tolerance is what it is.
    findings : list of Finding
        What a diagnosis says about a difference.
    judged : str
        Whose answer is in question: "dualpin"'s (in a validation) or the "oracle"'s (where a subject is judged).
    """

    max_scaled_error: float = 0.0
    tolerance: float = 0.0
    passed: bool = True
    reason: str = ""
    oracle: str = "Pinocchio"
    compared: int = 0
    left_out: int = 0
    note: str = ""
    worst: dict[str, Any] = field(default_factory=dict)
    quantiles: list[float] = field(default_factory=list)
    status: str = ""
    nearer: str = ""
    tolerance_reason: str = ""
    findings: list[Finding] = field(default_factory=list)
    judged: str = DUALPIN

    def __post_init__(self) -> None:
        self.findings = [Finding.of(f) for f in self.findings]
        if self.status:
            self.settle(self.status, self.nearer, self.reason)
        else:
            self._of_version_0_1()

    def __repr__(self) -> str:
        figures = f", error {self.max_scaled_error:.1e} of {self.tolerance:.1e}" if self.compared else ""
        return f"<TermResult: {self.verdict}{figures}, {self.compared} samples>"

    def _of_version_0_1(self) -> None:
        """Records of version 0.1 had two outcomes, and the reason of the tolerance in `reason`."""
        if not (self.compared or self.tolerance):
            self.settle(NOT_COMPARED, reason=self.note or self.reason)
            return
        self.tolerance_reason = self.tolerance_reason or self.reason
        if self.passed:
            self.settle(AGREES)
        else:
            self.settle(DIFFERS, UNDECIDED, "recorded without a decision")

    def settle(self, status: str, nearer: str = "", reason: str = "") -> None:
        """Give the verdict."""
        self.status, self.reason = status, reason
        self.nearer = (nearer or UNDECIDED) if status == DIFFERS else ""
        self.passed = status != DIFFERS or nearer == self.judged

    @property
    def figures(self) -> tuple[str, str]:
        """Error and tolerance as text, dashes where nothing was compared."""
        return (f"{self.max_scaled_error:.1e}", f"{self.tolerance:.1e}") if self.compared else ("-", "-")

    @property
    def verdict(self) -> str:
        """The status in words: with who is nearer or, of a subject that was diagnosed, with the causes' keys."""
        if self.status != DIFFERS:
            return self.status
        if self.judged == DUALPIN:
            return VERDICTS[self.nearer]
        keys = list(dict.fromkeys(f.key for f in self.findings))
        if not keys:
            return VERDICTS[ORACLE].replace("oracle", "subject") if self.nearer == ORACLE else "differs, cause unknown"
        under = all(k in CONVENTIONS for k in keys)
        return f"agrees under another convention: {', '.join(keys)}" if under else f"differs because: {', '.join(keys)}"

    @property
    def remark(self) -> str:
        """Why nothing was compared, what could not be, and how far each is from 50 digits where that was asked."""
        exact = self.worst.get("against_50_digits")
        off = "off 50 digits by: dualpin {dualpin:.1e}, {whom} {oracle:.1e}"
        nearer = off.format(whom=self.oracle, **exact) if exact else ""
        return "; ".join(dict.fromkeys(x for x in (self.reason, self.note, nearer) if x))


@dataclass(repr=False)
class RobotResult:
    """All terms of one robot, or why there are none.

    Attributes
    ----------
    passed : bool
        Whether every term passed, and nothing failed before.
    status : str
        "differs" if a term does, "agrees" if a term does and none differs, "not compared" if none was
        compared, or, for a robot without moving mass, nothing but its kinematics.
    reason : str
        Why it was not compared.
    error : str
        What went wrong in dualpin itself, so that nothing could be compared; the robot fails.
    engine : str
        What computed dualpin's side: "compiled" or "numpy".
    subject, subject_version : str
        Whose answers are judged; empty in a validation.
    model : dict
        What the robot was: its links, joints and limits (`dualpin.crosscheck.fingerprint`).
    refusal : Finding, optional
        What in the file keeps the subject from reading it; no finding, since it says nothing about answers.
    """

    name: str
    floating: bool
    mimic: bool
    nv: int
    samples: int
    seed: int
    passed: bool
    terms: dict[str, TermResult] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    error: str = ""
    seconds: float = 0.0
    status: str = ""
    reason: str = ""
    engine: str = ""
    subject: str = ""
    subject_version: str = ""
    model: dict[str, Any] = field(default_factory=dict, repr=False)
    refusal: Finding | None = None

    def __post_init__(self) -> None:
        self.refusal = None if self.refusal is None else Finding.of(self.refusal)
        self.passed = self.passed and not self.error and all(t.passed for t in self.terms.values())
        self.status = self.status or overall(t.status for t in self.terms.values())

    def __repr__(self) -> str:
        return f"<RobotResult {self.label!r}: {self.verdict}, {len(self.terms)} terms, {self.samples} samples>"

    @property
    def label(self) -> str:
        said = {"floating": self.floating, "mimic": self.mimic, "numpy": not self.subject and self.engine == "numpy"}
        label = " ".join([self.name, *(word for word, true in said.items() if true)])
        return f"{label}: {self.subject}" if self.subject else label

    @property
    def verdict(self) -> str:
        """The status in words; where terms differ, the worst of their verdicts."""
        if self.status != DIFFERS:
            return self.status
        order = [VERDICTS[k] for k in (ORACLE, NEITHER, UNDECIDED, DUALPIN)]
        found = [t.verdict for t in self.terms.values() if t.status == DIFFERS]
        if self.subject:
            return DIFFERS if any(not v.startswith(AGREES) for v in found) else "agrees under another convention"
        return min(found, key=order.index, default=DIFFERS)

    @property
    def remark(self) -> str:
        """Why it failed or was not compared, and which terms differ or were not compared."""
        lists: dict[str, list[str]] = {}
        for name, t in self.terms.items():
            absent = bool(self.subject) and t.reason.startswith("not offered")  # no subject has all terms
            if t.status != AGREES and not absent and not (t.status == self.status == NOT_COMPARED):
                lists.setdefault(t.verdict, []).append(name)
        return "; ".join(x for x in (self.error, self.reason, *(f"{v}: {', '.join(k)}" for v, k in lists.items())) if x)

    @property
    def findings(self) -> list[Finding]:
        """What a diagnosis said about any term, each finding once."""
        return once(f for t in self.terms.values() for f in t.findings)

    @property
    def worst(self) -> tuple[str, str]:
        """The term with the largest error and that error, as text; dashes where nothing was compared."""
        compared = {k: t for k, t in self.terms.items() if t.compared}
        name = max(compared, key=lambda k: compared[k].max_scaled_error, default="")
        return (name, compared[name].figures[0]) if name else ("-", "-")

    @property
    def worst_error(self) -> float:
        return max((t.max_scaled_error for t in self.terms.values()), default=float("nan"))

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> RobotResult:
        return cls(**{**data, "terms": {k: TermResult(**t) for k, t in data["terms"].items()}})


def overall(statuses: Iterable[str]) -> str:
    """Of several: "differs" if one does, else "agrees" if one does, else "not compared"."""
    found = set(statuses)
    return next((s for s in (DIFFERS, AGREES) if s in found), NOT_COMPARED)


@dataclass
class Refusal:
    """A file that did not become a robot."""

    name: str
    reason: str
    by_pinocchio: bool


@dataclass(repr=False)
class Report:
    """The outcome of a validation.

    Examples
    --------
    >>> import dualpin as dp
    >>> report = dp.validate("ur5", samples=5, seed=0)
    >>> report.passed, report.status, report.terms["rnea"].max_scaled_error < 1e-13
    (True, 'agrees', True)
    """

    robots: list[RobotResult] = field(default_factory=list)
    refused: list[Refusal] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=dict)
    partial: bool = False

    def __repr__(self) -> str:
        refused = f", {len(self.refused)} refused" if self.refused else ""
        keys = dict.fromkeys(f.key for f in self.findings)
        causes = f"; causes: {', '.join(keys)}" if keys else ""
        return f"<Report: {self.verdict}: {self.headline or 'no robots'}{refused}{causes}>"

    @property
    def passed(self) -> bool:
        """Whether there are robots, all passed, no file was refused by dualpin alone, and nothing is missing."""
        read = all(r.by_pinocchio for r in self.refused)
        return not self.partial and read and bool(self.robots) and all(r.passed for r in self.robots)

    @property
    def status(self) -> str:
        """ "differs" if a robot does, else "agrees" if one does, else "not compared"."""
        return overall(r.status for r in self.robots)

    @property
    def complete(self) -> bool:
        """Whether every term of every robot was compared, and every file read."""
        everything = [r.status for r in self.robots] + [t.status for r in self.robots for t in r.terms.values()]
        return NOT_COMPARED not in everything and not self.refused and not self.partial

    @property
    def verdict(self) -> str:
        """One word for a headline: "passed" only where something was compared."""
        if self.partial:
            return "partial"
        if not self.passed:
            return "failed"
        return NOT_COMPARED if self.status == NOT_COMPARED else "passed"

    @property
    def summary(self) -> str:
        """How many robots have which verdict, and how many terms of those that agree were not compared."""
        counts: dict[str, int] = {}
        for r in self.robots:
            counts[r.verdict] = counts.get(r.verdict, 0) + 1
        said = ", ".join(f"{n} {'agree' if v == AGREES and n != 1 else v}" for v, n in counts.items())
        left = sum(t.status == NOT_COMPARED for r in self.robots if r.status == AGREES for t in r.terms.values())
        return said + (f" ({left} {'term' if left == 1 else 'terms'} of them not compared)" if left else "")

    @property
    def remarks(self) -> list[tuple[str, str]]:
        """(robot, remark) of everything that is to be said about the models, each once."""
        return list(dict.fromkeys((r.name, note) for r in self.robots for note in r.notes))

    @property
    def headline(self) -> str:
        """The summary, and how many remarks there are about the models."""
        n, models = len(self.remarks), len({name for name, _ in self.remarks})
        about = "the model" if models == 1 else f"{models} models"
        return self.summary + (f"; {n} {'remark' if n == 1 else 'remarks'} about {about}" if n else "")

    @property
    def engine(self) -> str:
        """What computed dualpin's side."""
        return ", ".join(dict.fromkeys(r.engine for r in self.robots if r.engine))

    @property
    def processor(self) -> str:
        return self.versions.get("machine", "")

    @property
    def findings(self) -> list[Finding]:
        """What a diagnosis said is wrong with a subject, each finding once."""
        return once(f for r in self.robots for f in r.findings)

    @property
    def refusals(self) -> list[Finding]:
        """Why subjects did not read a file, where that was found."""
        return [r.refusal for r in self.robots if r.refusal]

    @property
    def terms(self) -> dict[str, TermResult]:
        """The terms of the only robot; see `robots` where there are several."""
        if (n := len(self.robots)) != 1:
            raise ArgumentError(f"the report holds {n} robots; report.robots[i].terms has the terms of one")
        return self.robots[0].terms

    # writing

    def to_dict(self) -> dict[str, Any]:
        """The document that `to_json` writes."""
        return home("Report.to_dict")(self)

    def to_json(self) -> str:
        """One JSON document; not-a-number and infinities are written as null and a large number."""
        return home("Report.to_json")(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Report:
        """A report from what `to_dict` wrote, in this version or an earlier one."""
        return home("Report.from_dict")(data)

    def to_markdown(self) -> str:
        return home("Report.to_markdown")(self)

    def badge(self, label: str = "dualpin") -> str:
        """A small SVG such as "dualpin: agrees | 23 terms"."""
        return home("Report.badge")(self, label)

    def write(self, folder: str | Path, formats: Iterable[str] = ("json", "md")) -> list[Path]:
        """Write report.json, .md, .html, .sarif, junit.xml, badge.svg into a folder; returns the paths."""
        writers = {
            "json": self.to_json, "md": self.to_markdown, "html": self.to_html,
            "junit": lambda: home("Report.to_junit")(self), "sarif": lambda: home("Report.to_sarif")(self),
            "badge": self.badge,
        }  # fmt: skip
        folder, formats = Path(folder), [formats] if isinstance(formats, str) else list(formats)
        for form in formats:
            if form not in writers:
                raise ArgumentError(f"report format {form!r} is not known; {nearest(form, writers, 'formats')}")
        names = {"junit": "junit.xml", "badge": "badge.svg"}
        paths = [folder / names.get(form, f"report.{form}") for form in formats]
        with writing(f"report: cannot write into {folder}"):
            folder.mkdir(parents=True, exist_ok=True)
            for path, form in zip(paths, formats, strict=True):
                write_text(path, writers[form]())
        return paths

    def to_html(self) -> str:
        """One self-contained page; needs Jinja (``pip install 'dualpin[report]'``)."""
        return home("Report.to_html")(self)

    def plot(self, axes: Any = None) -> Any:
        """Draw the largest error of every term over its tolerance; returns the axes.  Needs the extra `figures`."""
        return home("Report.plot")(self, axes)

    def _repr_html_(self) -> str:
        return home("Report._repr_html_")(self)
